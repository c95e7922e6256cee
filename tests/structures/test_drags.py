"""Drag of air in structure files: on points, rods and plates of bodies and bars."""

import numpy as np
import pytest
from structures_for_tests import SMALL, changed, refused

import fpm
from fpm.elements import Drag
from fpm.structures import loads
from fpm.structures.describe import describe

AIR = "area: 0.5 m2, coefficient: 1.2, density: 1.2 kg/m3"
BODY = f"""
points: {{c: [0, 0, 0], a: [-0.2, 0, 0], b: [0.2, 0, 0]}}
bodies: {{plate: {{mass: 0.3, centre: c, points: [a, b], inertia: [1e9, 1e9, 1e9]}}}}
drags: {{air: {{part: plate, through: [a, b], {AIR}}}}}
initial_velocities: {{start: {{part: plate, about: c, velocity: [3, 4, 0]}}}}
record: {{c: {{part: plate, at: c}}}}
"""
RATE = 0.5 * 1.2 * 1.2 * 0.5 / 0.3  # 1/m, of u' = -RATE |u| u
BAR = changed(SMALL, ("record:", f"drags:\n  air: {{part: arm, through: [A, B], {AIR}}}\nrecord:"))


def slowed(velocity, time):
    """Velocities (t, 3) of what drag alone slows down."""
    velocity = np.array(velocity, float)
    return velocity / (1 + RATE * np.linalg.norm(velocity) * time[:, None])


def velocities(keys: str):
    """Times (t,) and velocities (t, 3) of the body with other keys of its drag."""
    scene = loads(changed(BODY, ("through: [a, b]", keys))).build()
    (outcome,) = fpm.simulate(scene, duration=0.5, instants=11, step=1e-3)
    assert abs(outcome.energies["balance"]).max() < 1e-12
    return outcome.time, outcome.points["c"][1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("keys", "drags"),
    [("through: [c]", (3, 4, 0)), ("through: [c], normal: [3, 4, 0]", (3, 4, 0)),
     ("through: [c], normal: x", (3, 0, 0)), ("through: [c], normal: z", (0, 0, 0)),
     ("through: [a, b]", (0, 4, 0)), ("through: [b, a], normal: -x", (3, 0, 0)),
     ("through: [c], wind: [3, 4, 0]", (0, 0, 0)), ("through: [c], wind: [13, 0, 0]", (-10, 4, 0))],
)  # fmt: skip
def test_what_of_the_velocity_drags(keys, drags):
    """All of a point's against the wind, that across a rod, that along the normal of a plate."""
    time, found = velocities(keys)
    exact = np.array([3, 4, 0]) - drags + slowed(drags, time)
    np.testing.assert_allclose(found, exact, atol=2e-4)


@pytest.mark.parametrize("n", [2, 5])
def test_a_line_is_shared_by_the_particles_along_it(n):
    """Whatever the mesh: force and moments of a bar that moves as a rigid body, by three points for
    each particle, are those of the line; of one that turns about an end v|v| is exact."""
    scene = loads(BAR).build(n=n, L=2.0)
    drags = Drag.find(scene)
    assert len(drags) == 3 * (n + 1)
    factors = np.array([drag.factor for drag in drags])
    places = [scene.position[d.particle] + scene.frame[d.particle] @ d.arm for d in drags]
    distances = np.linalg.norm(places, axis=1)
    for power in range(4):
        exact = 0.5 * 1.2 * 1.2 * 0.5 * 2.0**power / (power + 1)
        assert factors @ distances**power == pytest.approx(exact, rel=1e-12)
    assert "air (0.36 N at 1 m/s)" in describe(loads(BAR))


def test_the_stable_step_counts_the_speed_at_the_start():
    """Of a point mass: leapfrog with the damping 2 rho/2 Cd A |u| bears m over it."""
    scene = loads(BODY).build()
    assert fpm.find_stable_step(scene).step == pytest.approx(0.3 / (2 * 0.36 * 5.0), rel=0.01)
    assert fpm.find_stable_step(scene).element == "drag air"
    assert Drag.dampings(loads(changed(BODY, ("velocity: [3, 4, 0]", ""))).build()) is None


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [("area: 0.5 m2", "area: -0.5 m2", "is not allowed; allowed: a value in m2 of at least 0"),
     ("area: 0.5 m2, ", "", "drags.air.area: missing"),
     ("coefficient: 1.2", "coefficient: -1", "allowed: a number of at least 0"),
     ("density: 1.2 kg/m3", "density: 1.2 kg", "allowed: a value in kg/m3 of at least 0"),
     ("through: [a, b]", "through: [d]", "there is no point 'd'"),
     ("through: [a, b]", "through: [c, c]", "each once"),
     ("through: [a, b]", "through: [a, c, b]", "a list of 1 to 2"),
     ("points: [a, b]", "points: [a]", "a point of plate"),
     ("b: [0.2, 0, 0]", "b: [-0.2, 0, 0]", "two points that are apart"),
     ("part: plate, through", "part: ground, through", "the name of a bar or body")],
)  # fmt: skip
def test_what_is_refused(old, new, said):
    refused(BODY, old, new, said)
