"""What joints bear at the first instant, and how bodies accelerate there: against closed forms."""

import numpy as np
import pytest
from asking import curves, vector, vectors

import fpm
from evidence.verification.mechanisms import rod
from evidence.verification.rigid_motors import AXIS as Z
from evidence.verification.rigid_motors import rocker, spatial_four_bar

pytestmark = pytest.mark.slow  # a time loop of its own

RATE, FASTER = 3.0, 20.0  # rad/s, rad/s² of what turns about z
SPIN = np.array([4.0, 1.0, -6.0])  # of the top
ARM, INERTIA = np.array([0.3, 0.1, 0.2]), np.array([0.02, 0.05, 0.06])  # of the top, of 1 kg
BODIES = ("swings", "carried", "top")


def everything() -> fpm.Scene:
    """A rod that turns on a hinge of its own, one on a body that is driven ever faster, a top on a
    ball, and a motor that turns a rocker by a coupler of nearly no mass: one time loop for all."""
    scene = spatial_four_bar(1e-6)
    pivot, hub, base = (int(p) for p in scene.add_particles([9 * Z, 12 * Z, 15 * Z], 1.0, 1.0))
    scene.fix(pivot)
    scene.fix(base)
    faster = scene.add_curve([0.0, 10.0], [1.0, 1.0 + 10.0 * FASTER / RATE])
    scene.drive(hub, spin=RATE * Z, curve=faster)
    swings = rod(scene, 9 * Z, 9 * Z + (1, 0, 0))
    scene.spin[swings], scene.velocity[swings] = RATE * Z, (0.0, RATE / 2, 0.0)
    scene.add_hinge("swings", (pivot, swings), 9 * Z, Z)
    carried = rod(scene, 12 * Z + (0.2, 0, 0), 12 * Z + (1.2, 0, 0))
    scene.add_joint("carried", "fixed", (hub, carried), 12 * Z + (0.2, 0, 0))
    velocity = np.cross(SPIN, ARM)
    (top,) = scene.add_particles(15 * Z + ARM, 1.0, INERTIA, velocity=velocity, spin=SPIN)
    scene.add_joint("top", "spherical", (base, int(top)), 15 * Z)
    for name, body in zip(BODIES, (swings, carried, int(top)), strict=True):
        scene.add_point(name, body)
    return scene


def closed_forms() -> dict[str, np.ndarray]:
    """Forces on bodies of 1 kg, which are the accelerations of their middles, and the moment of the
    motor, which moves the rocker alone."""
    about = np.diag(INERTIA) + ARM @ ARM * np.eye(3) - np.outer(ARM, ARM)
    change = np.linalg.solve(about, -np.cross(SPIN, about @ SPIN))
    by = 1e-3
    before, now, after = rocker(np.array([-by, 0.0, by]))
    power = 0.8 * (after - before) / (2 * by) * (after - 2 * now + before) / by**2 * 100
    return {
        "swings": np.array([-(RATE**2) / 2, 0.0, 0.0]),
        "carried": 0.7 * np.array([-(RATE**2), FASTER, 0.0]),
        "top": np.cross(change, ARM) + np.cross(SPIN, np.cross(SPIN, ARM)),
        "motor": np.array([power]),
    }


def off(step: float) -> dict[str, float]:
    """How far forces and accelerations at the first instant are off, as shares."""
    asked = {
        **{f"a {name}": d for name, d in vectors("acceleration", *BODIES).items()},
        **{f"F {name}": d for name, d in vectors("constraint_force", *BODIES).items()},
        "v": {"velocity": "top", "component": "norm"},
    }
    _, found, outcome = curves(everything(), asked, duration=2 * step, instants=3, step=step)
    assert found["v"][0] == pytest.approx(np.linalg.norm(np.cross(SPIN, ARM)), rel=1e-15)
    first = {
        f"{kind} {name}": vector(found, f"{kind} {name}")[0] for kind in "aF" for name in BODIES
    }
    first["M motor"] = outcome.records["motor_moment"].values[0]
    right = closed_forms()
    return {
        name: float(np.linalg.norm(value - right[name[2:]]) / np.linalg.norm(right[name[2:]]))
        for name, value in first.items()
    }


def test_first_forces_and_accelerations_are_right_to_the_second_order():
    """But for the motor's moment: of so light a coupler a first solution is right to 1 % only."""
    coarse, fine = off(2e-3), off(1e-3)
    assert fine.pop("M motor") < 3e-4
    for name, share in fine.items():
        assert share < 1e-5, name
        assert share < 0.3 * coarse[name], name
