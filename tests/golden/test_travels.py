"""Travels of shipped structures are those of before: virtual work of every part, and inertia."""

import json
from pathlib import Path

import numpy as np
import pytest

from fpm import structures
from fpm.travel import sweep
from fpm.travel.components import classes_of_kinds, component_classes, springs_of

ROOT = Path(__file__).parents[2]
BEFORE = Path(__file__).parent / "travels.json"
FREE = """
name: free
points: {a: [0, 0, 0], b: [1, 0, 0], c: [0.5, 0, 0], d: [1, 0.5, 0]}
bodies:
  hub: {mass: 2 kg, centre: c, box: [1, 0.2, 0.1], points: [a, b]}
  flap: {mass: 1 kg, centre: d, box: [0.2, 1, 0.1], points: [b]}
joints:
  hinge: {type: revolute, parts: [hub, flap], at: b, axis: z}
actions:
  spring: {type: torsion spring, joint: hinge, stiffness: 0.1, rest: 90 deg}
  rub: {type: friction, joint: hinge, moment: 0.01}
  wires: {type: tabulated spring, class: S, joint: hinge, angles: [0, 3 rad],
          moments: [0, -0.1 N m]}
"""
CASES = {
    "free": (FREE, "hinge", 0.2, 0.9, {}),
    "panel": ("panel", "hinge", 0.3, 1.2, {}),
    "panel back": ("panel", "hinge", 1.3, 0.4, {}),
    "solar array": ("solar_array", None, 0.5, 1.1, {}),
    "Bennett": ("bennett", "B", 0.1, 0.3, {"elements": 2}),
    "scissor": ("scissor", None, 0.0, -0.2, {}),
    "umbrella": ("umbrella", None, 0.0, 0.1, {}),
}
"""Structure, or its text; opening; from and to (rad), where that is None of the first opening, from
its start on; parameters."""


def travel_of(file, name, first, last, parameters):
    """A travel: the openings at its ends, work by part and inertia at three places between them;
    and the parts' classes."""
    path = ROOT / f"config/structures/{file}.yaml"
    structure = structures.loads(file) if file == FREE else structures.load(path)
    scene = structure.build(**parameters)
    hinge = next(hinge for hinge in scene.hinges if name in (None, hinge.name))
    start = 0.0 if name else float(hinge.opening)
    travel = sweep(scene, hinge.name, start + first, start + last, positions=5)

    def at_places(values):
        return values[1:-1].tolist()

    return {
        "ends": travel.opening[[0, -1]].tolist(),
        "work": {part: at_places(work) for part, work in sorted(travel.work.items())},
        "inertia": at_places(travel.inertia),
        "classes": [component_classes(scene), classes_of_kinds(scene), springs_of(scene)],
    }


@pytest.mark.parametrize("case", CASES)
def test_a_travel_is_that_of_before(case):
    """`PYTHONPATH=. python tests/golden/test_travels.py` writes them anew, where a change is meant.
    To 1e-6 of the largest."""
    before, now = json.loads(BEFORE.read_text(encoding="utf-8"))[case], travel_of(*CASES[case])
    assert now["classes"] == before["classes"] and now["work"].keys() == before["work"].keys()
    assert now["ends"] == pytest.approx(before["ends"], rel=1e-9)
    largest = max(np.abs(work).max() for work in before["work"].values())
    for part, work in before["work"].items():
        assert now["work"][part] == pytest.approx(work, abs=1e-6 * largest, rel=1e-6), part
    assert now["inertia"] == pytest.approx(before["inertia"], rel=1e-6)


if __name__ == "__main__":
    text = json.dumps({case: travel_of(*CASES[case]) for case in CASES}, indent=1)
    BEFORE.write_text(f"{text}\n", encoding="utf-8")
