"""What joints and supports bear, and accelerations of rigid bodies: against closed forms."""

from dataclasses import dataclass

import numpy as np
import pytest
from asking import curves, vector, vectors
from test_joints import GRAVITY, G, Z, on_ground, rod

import fpm
from fpm.elements.particles.gravity_kernels import Weight
from fpm.elements.particles.load import Gravity

pytestmark = pytest.mark.slow  # a time loop of its own

START = np.radians(70.0)  # of pendulums, from the vertical


def hung(angle: float, length: float) -> np.ndarray:
    return length * np.array([np.sin(angle), -np.cos(angle), 0.0])


def everything() -> fpm.Scene:
    """A rod and a heavy bob on hinges of their own, and two rods that are rigidly joined and turn
    about an end as one: one time loop for all."""
    scene, ground = on_ground()
    bodies = {"rod": rod(scene, (0, 0, 0), hung(START, 1.0))}
    bodies["bob"] = int(scene.add_particles(hung(START, 1.0), 2.0, [1e-9] * 3)[0])
    bodies["near"] = rod(scene, (0, 0, 0), hung(START, 1.0))
    bodies["far"] = rod(scene, hung(START, 1.0), hung(START, 2.0))
    for name in ("rod", "bob", "near"):
        scene.add_hinge(name, (ground, bodies[name]), (0, 0, 0), Z)
    scene.add_joint("weld", "fixed", (bodies["near"], bodies["far"]), hung(START, 1.0))
    for name, body in bodies.items():
        scene.add_point(name, body)
    scene.add_point("ground", ground)
    return scene


POINTS = ("rod", "bob", "near", "far")
DEFINITIONS = {
    **{f"a {name}": d for name, d in vectors("acceleration", *POINTS).items()},
    **{f"F {n}": d for n, d in vectors("constraint_force", "rod", "bob", "near", "weld").items()},
    **{f"M {n}": d for n, d in vectors("constraint_moment", "rod", "near", "weld").items()},
    **{f"R {name}": d for name, d in vectors("reaction_force", "ground").items()},
    **{f"T {name}": d for name, d in vectors("reaction_moment", "ground").items()},
}


@pytest.fixture(scope="module")
def run():
    return curves(everything(), DEFINITIONS, duration=1.0, instants=201, step=1e-3)


def angle_of(outcome, name: str) -> np.ndarray:
    """Angle (t,) of a body's middle from the vertical."""
    place = outcome.points[name][0]
    return np.arctan2(place[:, 0], -place[:, 1])


def test_a_falling_column_bends_most_where_it_breaks(run):
    """M = m g sin θ x (L - x)²/(4 L²) at x from the hinge, m and L of the whole (Madsen, Am. J.
    Phys. 45 (1977) 182): at the weld in its middle m g L sin θ/32; 1e-4 of m g L."""
    _, found, outcome = run
    angle = angle_of(outcome, "far")
    size = 2.0 * G * 2.0
    # It turns the far half on, as the near one lags behind.
    moment = vector(found, "M weld")[:, 2]
    np.testing.assert_allclose(np.abs(moment), size * np.abs(np.sin(angle)) / 32, atol=1e-4 * size)
    assert np.abs(vector(found, "M weld")[:, :2]).max() < 1e-6


def test_momentum_and_angular_momentum_of_all_change_by_reaction_and_weight(run):
    """To rounding at every instant: forces of joints are the impulses that moved the bodies."""
    _, found, _ = run
    masses = {"rod": 1.0, "bob": 2.0, "near": 1.0, "far": 1.0}
    change = sum(m * vector(found, f"a {name}") for name, m in masses.items())
    weight = sum(masses.values()) * np.array(GRAVITY)
    np.testing.assert_allclose(vector(found, "R ground"), change - weight, atol=1e-9)
    # What joints do on either side, seen from the ground.
    on_ground_ = -sum(vector(found, f"F {name}") for name in ("rod", "bob", "near"))
    np.testing.assert_allclose(vector(found, "R ground"), -on_ground_, atol=1e-9)
    np.testing.assert_allclose(vector(found, "T ground")[:, 2], 0.0, atol=1e-9)
    far = vector(found, "a far") - np.array(GRAVITY)
    np.testing.assert_allclose(vector(found, "F weld"), far, atol=1e-9)


@dataclass(frozen=True)
class Pull(Gravity):
    """A weight by a user's own kind, of which `Scene.gravity` knows nothing."""

    @classmethod
    def find(cls, scene):
        return scene.kinds.get(cls, [])

    @classmethod
    def weight(cls, scene, particle):
        return scene.mass[particle] * cls.find(scene)[0].acceleration

    @classmethod
    def pack(cls, batch):
        rows = batch.stack(1, 3, lambda scene: cls.find(scene)[0].acceleration[None])
        return Weight(rows, batch.work_account(cls))


def test_the_ground_has_no_weight_whichever_kind_gives_it():
    """The reaction of a pendulum is what its hinge bears, m g (3 cos θ - 2 cos θ0); 1e-4 of m g."""
    scene, ground = on_ground()
    scene.gravity = (0.0, 0.0, 0.0)
    scene.add(Pull(np.array(GRAVITY)))
    bob = int(scene.add_particles(hung(START, 1.0), 2.0, [1e-9] * 3)[0])
    scene.add_hinge("hinge", (ground, bob), (0, 0, 0), Z)
    scene.add_point("bob", bob)
    scene.add_point("ground", ground)
    definition = {"reaction_force": "ground", "component": "norm"}
    _, found, outcome = curves(scene, {"R": definition}, duration=1.0, instants=101, step=1e-3)
    angle = angle_of(outcome, "bob")
    exact = 2.0 * G * (3 * np.cos(angle) - 2 * np.cos(START))
    np.testing.assert_allclose(found["R"], exact, atol=1e-4 * 2.0 * G)
