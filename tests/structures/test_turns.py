"""Where expressions of a structure file turn back or bend as one parameter varies."""

import numpy as np
import pytest

from fpm import structures

TEXT = """
name: weights
parameters: {{T: {{value: 20}}, w: {{value: 2}}, drop: {{value: 1}}}}
let: {{n: "{}", more: 3*n}}
points: {{a: [0, 0, 0], b: [1, 0, 0]}}
bodies: {{one: {{mass: 2 kg + drop*(1 kg), centre: b, box: [1, 1, 1], points: [a]}}}}
joints: {{h: {{type: revolute, parts: [ground, one], at: a, axis: z}}}}
actions: {{rub: {{type: friction, joint: h, moment: "(1 N m)*(10 + n)/w"}}}}
"""
TABLE = "interpolate(T, 10, 0, 30, 1, 40, 3, 41, 1)"


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("exp(-((T - 45)/0.7)**2)", [45.0]),
        ("sin(0.1 rad*T)", (np.arange(-3, 3) + 0.5) * 10 * np.pi),
        # Of a product that is next to nothing at the other one's value.
        ("exp(-((T - 45)/0.7)**2)*exp(-((w - 9)/0.1)**2) + T/100", [45.0]),
        ("(T/100)**3", []),
        ("0*T", []),
        (TABLE, [10.0, 30.0, 40.0, 41.0]),
        ("max(T, 33)/100", [33.0]),
    ],
)
def test_extremes_and_knots_are_found(text, places):
    structure = structures.loads(TEXT.format(text))
    values = {"T": 20.0, "w": 2.0, "drop": 1.0}
    found = structure.find_turns(values, "T", -100.0, 100.0)
    assert sorted(found) == pytest.approx(sorted(places), abs=0.4), found  # two of 1025 values
    assert structure.find_turns(values, "drop", 0.0, 2.0) == []


def test_extremes_come_first_and_are_exact():
    structure = structures.loads(TEXT.format(TABLE))
    first, *_ = structure.find_turns({"T": 20.0, "w": 2.0, "drop": 1.0}, "T", -100.0, 100.0)
    assert first == pytest.approx(40.0, abs=1e-6)
