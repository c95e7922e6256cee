"""The solar array of the library: what it is made of, and how it opens."""

from itertools import pairwise

import numpy as np
import pytest
from exact_motions import solar_array
from structures_for_tests import structure

import fpm
from evidence.verification.deployables import crossing
from fpm.elements import Damper, Latch, SyncLoop

OPEN = np.pi / 2


@pytest.fixture(scope="module")
def array():
    return structure("solar_array")


def test_any_number_of_panels_is_joined_into_one_array(array):
    for n in (2, 5):
        scene = array.build(n=n)
        assert len(scene.position) == n + 1
        assert [hinge.opening for hinge in scene.hinges] == [0.0] * n
        assert len(scene.springs) == len(Damper.of(scene)) == len(Latch.of(scene)) == n
        hinges = [[scene.hinges[h].name for h in loop.hinges] for loop in SyncLoop.of(scene)]
        between = [f"panel{i}.hinge" for i in range(1, n)]
        pairs = [["root", between[0]], *map(list, pairwise(between))]
        assert sorted(hinges) == sorted(pairs)
        ratios = {loop.name: loop.radii[0] / loop.radii[1] for loop in SyncLoop.of(scene)}
        assert ratios.pop("root_belt") == 2
        assert set(ratios.values()) <= {1.0}
        assert not scene.fixed.any()


CASES = (
    ({"n": 2, "hub": 1e6, "mass": 1, "thickness": 1, "k": 0.1, "c": 0, "loop": 1e4}, 1e-4),
    ({"n": 3, "c": 0.0, "loop": 1e4}, 3e-4),
    ({"n": 3}, 2e-3),
    ({"n": 5, "k": 1.0, "mass": 2.0}, 2e-3),
)
"""Parameters, and how close (of the time) it is to an array whose loops do not stretch."""


@pytest.mark.slow
@pytest.mark.parametrize(("values", "close"), CASES)
def test_it_opens_when_a_rigid_synchronised_array_does(array, values, close):
    """The latches wait beyond; the hub turns back by what the panels turn."""
    exact = {"c": 1.5, "thickness": 25.0, **values}
    exact["thickness"] *= 1e-3
    exact.pop("loop", None)
    time, rate, turn = solar_array(**exact)
    (outcome,) = fpm.simulate(
        array.build(**values, latch=190.0), duration=1.02 * time, instants=2001, step=5e-4
    )
    found, speed = crossing(outcome.time, outcome.openings["root"], OPEN)
    assert found == pytest.approx(time, rel=close)
    assert speed == pytest.approx(rate, rel=20 * close)
    hub, nose = (outcome.points[name][0][-30] for name in ("hub", "nose"))
    angle = np.arctan2(*(nose - hub)[1::-1])
    if values.get("hub") is None:
        assert angle == pytest.approx(turn, abs=0.01)
    most = outcome.energies["kinetic"].max()
    assert np.abs(outcome.energies["balance"]).max() < 1e-3 * most
    momentum = outcome.scene.mass @ outcome.final.velocity
    assert np.abs(momentum).max() < 1e-9 * outcome.scene.mass.sum()


@pytest.mark.slow
def test_all_latches_catch_and_hold(array):
    outcomes = fpm.simulate([array.build(), array.build(latch=178.0)], duration=8.0, instants=1601,
                            step=1e-3)  # fmt: skip
    for outcome, angle in zip(outcomes, (180.0, 178.0), strict=True):
        names = [outcome.eventful[int(e)].name for _, e, _ in outcome.events]
        assert sorted(names) == ["latch panel1.latch", "latch panel2.latch", "latch root_latch"]
        assert np.ptp(outcome.events[:, 0]) < 0.02
        for name, opening in outcome.openings.items():
            caught = np.radians(angle if name != "root" else angle / 2)
            assert opening[-1] == pytest.approx(caught, abs=np.radians(0.5))
        assert np.abs(outcome.energies["balance"]).max() < 1e-3 * 17.8  # the springs' at the start
