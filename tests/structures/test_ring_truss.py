"""The ring truss of the library: one cable opens it, by the geometry of its bays."""

import numpy as np
import pytest
from structures_for_tests import structure

import fpm
from fpm.structures import report


def test_its_mobility_is_that_of_a_closed_chain_of_parallelograms():
    for pairs in (2, 3):
        scene = structure("ring_truss").build(n=pairs)
        assert report.mobility(scene).degrees == 6 + 2 * pairs - 3


def test_the_cable_has_the_length_of_the_diagonals():
    scene = structure("ring_truss").build(n=2, stow=40.0)
    diagonal = np.sqrt(0.5**2 + 0.4**2 + 2 * 0.5 * 0.4 * np.sin(np.radians(40.0)))
    np.testing.assert_allclose(scene.cables[0].lengths(scene), diagonal, rtol=1e-12)


@pytest.fixture(scope="module")
def opened():
    ring = structure("ring_truss")
    scenes = [ring.build(n=2, stow=60.0, mu=mu, c=10.0) for mu in (0.0, 0.1)]
    return fpm.simulate(scenes, duration=3.0, instants=301)


def slopes(outcome) -> np.ndarray:
    return np.stack([outcome.openings[f"pair{i}.bay{k}"] for i in (1, 2) for k in (1, 2)])


@pytest.mark.slow
def test_one_cable_opens_it(opened):
    for outcome in opened:
        assert outcome.failure is None
        found = slopes(outcome)
        np.testing.assert_allclose(np.degrees(found[:, 0]), 60.0)
        assert np.abs(np.degrees(found[:, -1])).max() < 1.0
        assert outcome.tensions["hoist"][-1] > 1.0
        # All along, the cable is as long as the diagonals are.
        diagonals = np.sqrt(0.5**2 + 0.4**2 + 2 * 0.5 * 0.4 * np.sin(found)).sum(axis=0)
        length = outcome.recorded["cable_length"].values[:, 0]
        np.testing.assert_allclose(length, diagonals, rtol=1e-3)
        # In the end the ring is its polygon: a square of 0.5 m with four bays.
        near, beside = (outcome.points[name][0][-1] for name in ("near", "beside"))
        assert np.linalg.norm(near - beside) == pytest.approx(0.5, rel=1e-3)
        assert np.abs(outcome.energies["balance"]).max() < 1e-3 * outcome.energies["reel"].max()


@pytest.mark.slow
def test_friction_opens_the_bays_at_the_winch_first(opened):
    free, rubbing = (slopes(outcome) for outcome in opened)
    halfway = 120
    spread = [float(np.ptp(found[:, halfway])) for found in (free, rubbing)]
    assert spread[1] > 2 * spread[0]
    assert np.argmin(rubbing[:, halfway]) in (0, 2)
    assert opened[1].energies["cable_friction"][-1] > 0.1 * opened[1].energies["reel"][-1]
    assert abs(opened[0].energies["cable_friction"][-1]) < 1e-9 * opened[0].energies["reel"][-1]
