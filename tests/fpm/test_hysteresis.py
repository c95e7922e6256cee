"""Tables with two branches: hysteresis of a tape spring and a harness with a set of its own, led
slowly and moving."""

import numpy as np
import pytest
from hinged import hinged
from scipy.optimize import brentq

import fpm
from fpm.elements import Friction
from fpm.errors import SceneError
from fpm.structures import loads
from fpm.travel import sweep
from fpm.travel.components import component_classes

INERTIA = 1.1  # kg m², of the sheet about its hinge
SHEET = """
name: two branches
parameters:
  half: {value: 0.02, unit: N m, range: [-1, 1], description: half of the way between the branches}
  rate: {value: 0.5, unit: rad/s, range: [-9, 9]}
points: {a: [0, 0, 0], b: [1, 0, 0]}
bodies:
  sheet: {mass: 1 kg, centre: b, inertia: [0.1, 0.1, 0.1], points: [a, b]}
joints:
  h: {type: revolute, parts: [ground, sheet], at: a, axis: z}
actions:
  tape:
    type: tabulated spring
    joint: h
    angles: [0, 3 rad]
    moments: [0.03 N m - half, -0.06 N m - 3*half]
    back: [0.03 N m + half, -0.06 N m + 3*half]
initial_velocities:
  go: {part: sheet, about: a, spin: [0, 0, rate]}
record:
  b: {part: sheet, at: b}
"""


def half(angle):
    return 0.02 * (1 + 2 * angle / 3)


@pytest.mark.parametrize(("first", "last"), [(0.0, 2.0), (2.0, 0.5)])
def test_the_mean_is_a_spring_and_the_rest_resists_both_ways(first, last):
    scene = loads(SHEET).build()
    assert component_classes(scene) == {
        "tape (spring h)": "HA",
        "tape (hysteresis h)": "HY",
    }  # no class is stated
    found = sweep(scene, "h", first, last)
    way = np.sign(last - first)
    mean = way * (0.03 - 0.03 * found.opening)
    assert found.work["tape (spring h)"] == pytest.approx(mean, abs=1e-9)
    assert found.work["tape (hysteresis h)"] == pytest.approx(-half(found.opening), rel=1e-6)


def test_a_harness_with_a_set_resists_as_one():
    """It is free of moment at its set, 0.3 rad, and its class is that of both of its parts."""
    harness = SHEET.replace(
        "type: tabulated spring", "type: tabulated spring\n    class: HA"
    ).replace("angles: [0, 3 rad]", "angles: [-0.7 rad, 1.3 rad]")
    harness = harness.replace("[0.03 N m - half, -0.06 N m - 3*half]", "[0.05 N m, -0.05 N m]")
    harness = harness.replace("back: [0.03 N m + half, -0.06 N m + 3*half]",
                              "back: [0.05 N m + 2*half, -0.05 N m + 2*half]")  # fmt: skip
    scene = loads(harness).build()
    assert component_classes(scene) == {"tape (spring h)": "HA", "tape (hysteresis h)": "HA"}
    spring = loads(harness.replace("class: HA", "class: S")).build()
    assert component_classes(spring) == {"tape (spring h)": "S", "tape (hysteresis h)": "HY"}
    found = sweep(scene, "h", 0.0, 1.0)
    both = found.work["tape (spring h)"] + found.work["tape (hysteresis h)"]
    assert both == pytest.approx(0.05 * (0.3 - found.opening), abs=1e-8)
    assert found.work["tape (hysteresis h)"] == pytest.approx(-0.02, rel=1e-6)


@pytest.mark.slow
def test_a_sheet_turns_where_the_branch_has_taken_its_energy_and_sticks_there():
    """J w²/2 against the integral of the branch; there the mean is less than half of the width."""
    made = loads(SHEET)
    runs = [
        fpm.simulate(made.build(), duration=20.0, instants=2001, step=step)[0]
        for step in (2e-3, 1e-3)
    ]
    farthest = brentq(
        lambda x: INERTIA * 0.5**2 / 2 + 0.01 * x - (0.03 + 0.04 / 3) * x**2 / 2, 0.0, 5.0
    )
    assert abs(0.03 - 0.03 * farthest) < half(farthest)
    for run in runs:
        assert run.failure is None
        opening = run.records["opening"].values[:, 0]
        assert opening.max() == pytest.approx(farthest, abs=1e-5)
        assert farthest - 0.05 < opening[-1] < farthest
        assert np.ptp(opening[-20:]) < 1e-6
    balance = [np.abs(run.energies["balance"]).max() for run in runs]
    assert balance[1] < 1e-7
    assert balance[0] / balance[1] == pytest.approx(4.0, rel=0.1)


@pytest.mark.parametrize(
    ("angles", "shares", "said"),
    [((0.0, 1.0), (1.0,), "as many shares"), ((1.0, 0.0), (1.0, 1.0), "increasing angles"),
     ((0.0, 1.0), (1.0, -0.1), "none below 0"), ((), (1.0, 1.0), "as many shares")],
)  # fmt: skip
def test_tables_of_friction_that_are_refused(angles, shares, said):
    with pytest.raises(SceneError, match=said):
        hinged(0.0).add(Friction(0, 0.1, angles=angles, shares=shares))


def test_a_way_back_that_would_give_energy_is_refused():
    with pytest.raises(ValueError, match="none below that on the way there"):
        loads(SHEET).build(half=-0.01)
