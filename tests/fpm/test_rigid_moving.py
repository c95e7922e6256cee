"""Friction that sticks exactly and motors that prescribe exactly: closed forms, energy, lanes."""

import numpy as np
import pytest
from flaps import J

import fpm
from fpm.elements import Friction, Motor

RUN = {"duration": 3.0, "instants": 3001, "step": 1e-3}
TIMES, VALUES = [0.0, 0.5003, 1.2, 2.0], [0.0, 0.4, 0.1, 0.1]
G = 9.81


def flap(rate=0.0, moment=0.0, load=0.0, ramp=0.0, gravity=1e-300, turn=0.0, angle=0.0):
    """A flap on friction, under a moment (N m) and one that grows (N m/s), and one on a motor.

    Both have their mass 0.5 m from their hinges, weight along -y, and start at an angle to x.
    """
    scene = fpm.Scene("flaps", gravity=(0.0, -gravity, 0.0))
    arm = 0.5 * np.array([np.cos(angle), np.sin(angle), 0.0])
    aside = np.array([0.0, 0.0, 5.0])
    inertias = [[1.0] * 3, *[[0.1, J - 0.25, J - 0.25]] * 2]
    ground, one, two = (
        int(p) for p in scene.add_particles([0 * arm, arm, aside + arm], 1.0, inertias)
    )
    scene.fix(ground)
    z = np.array([0.0, 0.0, 1.0])
    scene.spin[one], scene.velocity[one] = rate * z, rate * np.cross(z, arm)
    scene.add_hinge("hinge", (ground, one), 0 * arm, z, opening=angle)
    scene.add_hinge("driven", (ground, two), aside, z, opening=angle)
    growing = scene.add_curve([0.0, 10.0], [0.0, 10.0])
    scene.add_load(one, moment=load * z)
    scene.add_load(one, moment=ramp * z, curve=growing)
    scene.add(Motor(1, None, 0.0, angle, turn, scene.add_curve(TIMES, VALUES)))
    scene.add(Friction(0, moment, None))
    return scene


CASES = {
    "stops": flap(rate=1.0, moment=0.2),
    "stops late": flap(rate=-0.7, moment=0.05),
    "stops at once": flap(rate=1.0, moment=1e3),
    "sticks": flap(moment=0.2, load=0.2 * 0.999),
    "slips": flap(moment=0.2, load=0.22),
    "begins to slip": flap(moment=0.2, ramp=0.31),
    "swings": flap(moment=0.4, gravity=G, angle=0.3),
    "driven": flap(turn=1.0, gravity=G),
}


def run(cases: dict, **more) -> dict:
    outcomes = fpm.simulate(list(cases.values()), **{**RUN, **more})
    assert not any(outcome.failure for outcome in outcomes)
    return dict(zip(cases, outcomes, strict=True))


@pytest.fixture(scope="module")
def ran():
    return run(CASES)


def opening(outcome) -> np.ndarray:
    return outcome.openings["hinge"]


@pytest.mark.slow
def test_rigid_motors_and_friction_alone_and_in_a_batch_are_the_same_bits(ran):
    for name in ("stops", "begins to slip", "swings", "driven"):
        (alone,) = fpm.simulate(CASES[name], **RUN)
        assert np.array_equal(opening(alone), opening(ran[name]))
        for energy, values in alone.energies.items():
            assert np.array_equal(values, ran[name].energies[energy]), (name, energy)


@pytest.mark.parametrize(
    ("element", "message"),
    [
        (Friction(5, 1.0, None), "hinge of friction"),
        (Friction(0, -1.0, None), "moment of friction"),
        (Motor(1, None, 0.0, 0.0, 1.0, 0), "a hinge without a motor"),
        (Motor(1, 1.0, 0.0, 0.0, 1.0, 0), "a hinge without a motor"),
        (Motor(0, None, 0.0, 0.1, 1.0, 0), "opening of motor hinge at the start"),
        (Motor(0, None, 0.0, 0.0, np.inf, 0), "opening of motor hinge"),
        (Motor(0, None, 0.0, 0.0, 1.0, 7), "curve of motor hinge"),
    ],
)
def test_what_rigid_motors_and_friction_refuse(element, message):
    with pytest.raises(fpm.SceneError, match=message):
        flap().add(element)
