"""Cables that rub at points: Eytelwein's law, what friction takes, sticking."""

import numpy as np
import pytest

import fpm

pytestmark = pytest.mark.slow  # a time loop of its own

G = 9.81
FRICTION = (0.2, 0.05, 1e-6)


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


def capstan(friction: float, factors=(0, 1), pins: int = 4) -> fpm.Scene:
    """A weight hung on a cable over pins on a half circle, by which it turns, to a winch."""
    scene = fpm.Scene("capstan", gravity=(0, 0, -G), damping=5.0)
    angles = np.linspace(0, np.pi, pins)
    places = [(-np.cos(a), 0, np.sin(a)) for a in angles]
    winch, weight = (-1.0, 0, -1.0), (1.0, 0, -1.0)
    held = scene.add_particles([winch, *places], 1.0, 1.0)
    scene.fix(held)
    mass = int(scene.add_particles(weight, 2.0, 1.0)[0])
    curve = scene.add_curve([0.2, 2.2], factors)
    points = [(int(p), None) for p in (*held, mass)]
    scene.add_cable("rope", points, 1e4, preload=2 * G, reel=0.2, curve=curve, friction=friction)
    scene.add_point("weight", mass)
    return scene


@pytest.fixture(scope="module")
def lifted():
    """Lifted and lowered, with two coefficients of friction and as good as none."""
    found = []
    for factors in ((0, 1), (0, -1)):
        scenes = [capstan(mu, factors) for mu in FRICTION]
        found.append(fpm.simulate(scenes, duration=2.2, instants=221, step=2e-4))
    return found


def test_what_the_winch_gives_lifts_and_rubs(lifted):
    for outcomes in lifted:
        for outcome in outcomes:
            energies = outcome.energies
            scale = np.abs(energies["reel"]).max()
            assert np.abs(energies["balance"]).max() < 1e-6 * scale
            assert (np.diff(energies["cable_friction"]) > -1e-9 * scale).all()
    for outcome, mu in zip(lifted[0], FRICTION, strict=True):
        # All but the pull of the weight is rubbed off, over the length that is reeled.
        lost = np.diff(outcome.energies["cable_friction"][[150, 220]])[0]
        exact = 2 * (G + 0.5) * (np.exp(mu * np.pi) - 1) * 0.1 * 0.7
        assert lost == pytest.approx(exact, rel=0.01, abs=1e-5)


def test_masses_slide_or_stick_on_a_rubbing_cable():
    ratio = np.exp(0.1 * np.pi)
    heavy = [2 * ratio * share for share in (1.5, 1.01, 0.99)]
    scenes = [atwood(one, 2.0, 0.1) for one in heavy]
    outcomes = fpm.simulate(scenes, duration=0.5, instants=501, step=5e-5)
    for one, outcome in zip(heavy, outcomes, strict=True):
        drop = -1.0 - outcome.points["left"][0][:, 2]
        fall = np.polyfit(outcome.time[100:], drop[100:], 2)[0] * 2
        exact = max(G * (one - 2 * ratio) / (one + 2 * ratio), 0.0)
        assert fall == pytest.approx(exact, rel=2e-3, abs=1e-3)
        assert np.abs(outcome.energies["balance"]).max() < 1e-6
    assert np.ptp(drop[250:]) < 2e-5  # it only swings as it is stretched


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
