"""The ring truss, the solar array and the telescope of the library: how they are made and open."""

import numpy as np
import pytest
from exact_motions import on_a_line, solar_array
from structures_for_tests import structure

import fpm
from evidence.verification.deployables import crossing


def test_the_cable_has_the_length_of_the_diagonals():
    scene = structure("ring_truss").build(n=2, stow=40.0)
    np.testing.assert_allclose(
        scene.cables[0].lengths(scene), diagonals(np.radians(40.0)), rtol=1e-12
    )


def diagonals(slope):
    """Of a bay (m) whose bars have this slope (rad)."""
    return np.sqrt(0.5**2 + 0.4**2 + 2 * 0.5 * 0.4 * np.sin(slope))


@pytest.fixture(scope="module")
def rings():
    ring = structure("ring_truss")
    scenes = [ring.build(n=2, stow=60.0, mu=mu, c=10.0) for mu in (0.0, 0.1)]
    return fpm.simulate(scenes, duration=3.0, instants=301)


def slopes(outcome) -> np.ndarray:
    return np.stack([outcome.openings[f"pair{i}.bay{k}"] for i in (1, 2) for k in (1, 2)])


@pytest.mark.slow
def test_one_cable_opens_the_ring(rings):
    for outcome in rings:
        assert outcome.failure is None
        found = slopes(outcome)
        np.testing.assert_allclose(np.degrees(found[:, 0]), 60.0)
        assert np.abs(np.degrees(found[:, -1])).max() < 1.0
        assert outcome.select_columns("cable_tension")["hoist"][-1] > 1.0
        length = outcome.records["cable_length"].values[:, 0]
        np.testing.assert_allclose(length, diagonals(found).sum(axis=0), rtol=1e-3)
        # In the end the ring is its polygon: a square of 0.5 m with four bays.
        near, beside = (outcome.points[name][0][-1] for name in ("near", "beside"))
        assert np.linalg.norm(near - beside) == pytest.approx(0.5, rel=1e-3)
        assert np.abs(outcome.energies["balance"]).max() < 1e-3 * outcome.energies["reel"].max()


@pytest.mark.slow
def test_friction_opens_the_bays_at_the_winch_first(rings):
    free, rubbing = (slopes(outcome) for outcome in rings)
    halfway = 120
    spread = [float(np.ptp(found[:, halfway])) for found in (free, rubbing)]
    assert spread[1] > 2 * spread[0]
    assert np.argmin(rubbing[:, halfway]) in (0, 2)
    assert rings[1].energies["cable_friction"][-1] > 0.1 * rings[1].energies["reel"][-1]
    assert abs(rings[0].energies["cable_friction"][-1]) < 1e-9 * rings[0].energies["reel"][-1]


@pytest.fixture(scope="module")
def array():
    return structure("solar_array")


CASES = (
    ({"n": 2, "hub": 1e6, "mass": 1, "thickness": 1, "k": 0.1, "c": 0, "loop": 1e4}, 1e-4),
    ({"n": 3, "c": 0.0, "loop": 1e4}, 3e-4),
    ({"n": 3}, 2e-3),
    ({"n": 5, "k": 1.0, "mass": 2.0}, 2e-3),
)
"""Parameters, and how close (of the time) it is to an array whose loops do not stretch."""


@pytest.mark.slow
@pytest.mark.parametrize(("values", "close"), CASES)
def test_the_array_opens_when_a_rigid_synchronised_array_does(array, values, close):
    """The latches wait beyond; the hub turns back by what the panels turn."""
    exact = {"c": 1.5, "thickness": 25.0, **values}
    exact["thickness"] *= 1e-3
    exact.pop("loop", None)
    time, rate, turn = solar_array(**exact)
    (outcome,) = fpm.simulate(
        array.build(**values, latch=190.0), duration=1.02 * time, instants=2001, step=5e-4
    )
    found, speed = crossing(outcome.time, outcome.openings["root"], np.pi / 2)
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
def test_all_latches_of_the_array_catch_and_hold(array):
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


@pytest.mark.slow
def test_each_tube_latches_when_and_as_fast_as_points_on_a_line_do():
    (outcome,) = fpm.simulate(structure("telescope").build(), duration=2.0, instants=201, step=2e-4)
    assert outcome.failure is None
    times, rates = on_a_line()
    names = [element.name for element in outcome.eventful]
    found = {names[int(e)]: t for t, e, which in outcome.events if names[int(e)][:5] == "latch"}
    wanted = dict(zip([f"latch stage{k}.latch" for k in (1, 2, 3)], times, strict=True))
    assert found == pytest.approx(wanted, abs=2e-4)
    caught = outcome.records["slide_latch_rate"]
    told = dict(zip(caught.labels, caught.values[-1], strict=True))
    assert [told[f"stage{k}.latch"] for k in (1, 2, 3)] == pytest.approx(rates, rel=1e-3)
    assert outcome.points["tip"][0][-1, 2] == pytest.approx(1.05 + 3 * 0.8, abs=1e-9)
