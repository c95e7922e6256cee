"""Cables that rub at points: Eytelwein's law, what friction takes, sticking."""

import numpy as np
import pytest

import fpm

pytestmark = pytest.mark.slow  # a time loop of its own

G = 9.81


def atwood(one: float, two: float, friction: float | None, EA: float = 1e6) -> fpm.Scene:
    """Two masses on a cable over a fixed point."""
    scene = fpm.Scene("atwood", gravity=(0, 0, -G))
    places = [(0.0, 0, 0), (0, 0, -1.0), (0, 0, -4.0)]
    top, left, right = (int(p) for p in scene.add_particles(places, [1.0, one, two], 1.0))
    scene.fix(top)
    points = [(p, None) for p in (left, top, right)]
    scene.add_cable("rope", points, EA, preload=two * G, friction=friction)
    scene.add_point("left", left)
    return scene


def test_a_rubbing_cable_whose_point_is_free_keeps_momentum():
    scene = atwood(3.0, 2.0, 0.3)
    scene.fixed[:] = False
    scene.gravity = (0, 0, 0)
    scene.velocity[1] = (0.3, 0.1, -1.0)
    (outcome,) = fpm.simulate(scene, duration=1.0, instants=11, step=1e-4)
    assert outcome.failure is None
    momenta = [scene.mass @ v for v in (scene.velocity, outcome.final.velocity)]
    np.testing.assert_allclose(*momenta, atol=1e-12)
    assert np.abs(outcome.energies["balance"]).max() < 1e-3 * outcome.energies["kinetic"][0]


def test_the_stable_step_is_that_of_stuck_stretches():
    limit = fpm.find_stable_step(atwood(1.0, 1.0, 0.1, EA=1e6))
    # A mass on its stretch of 1 m, stuck at the point.
    rest = 1.0 / (1 + G / 1e6)
    assert limit.step == pytest.approx(2 / np.sqrt(1e6 / rest), rel=1e-12)
    assert limit.element == "cable rope"


def test_friction_is_part_of_the_topology_and_checked():
    with pytest.raises(fpm.SceneError, match="topology of scene 1"):
        fpm.simulate([atwood(3, 2, None), atwood(3, 2, 0.1)], duration=0.1, instants=2)
    for friction in (-0.1, np.inf):
        with pytest.raises(fpm.SceneError, match="friction of cable rope"):
            atwood(3, 2, friction)


def test_a_cable_without_tension_does_not_slip_whatever_is_beside():
    slack, tight = (fpm.Scene(name) for name in ("slack", "tight"))
    for scene, preload in ((slack, 0.0), (tight, 2.0)):
        places = [(0.0, 0, 0), (0, 0, -1.0), (1.0, 0, 0)]
        top, left, right = (int(p) for p in scene.add_particles(places, 1.0, 1.0))
        scene.fix(top)
        scene.fix(right)
        scene.add_cable("rope", [(p, None) for p in (left, top, right)], 30.0, preload=preload,
                        friction=0.2)  # fmt: skip
        scene.add_point("left", left)
    motion = {"duration": 0.05, "instants": 3, "step": 1e-3}
    alone, beside = (fpm.simulate(scenes, **motion)[0] for scenes in ([slack], [slack, tight]))
    assert len(alone.dataset()["event_time"]) == len(beside.dataset()["event_time"]) == 0
