"""Joints that are solved together: against equations of motion, published numbers, each other."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fpm
from evidence.verification.mechanisms import (
    GRAVITY,
    Z,
    on_ground,
    rigid_bricard,
    rod,
)

G = -GRAVITY[1]


def double_pendulum(hinge_to=None) -> fpm.Scene:
    """Two rods that hang from the ground, at rest along x; the lower one may be of another type."""
    scene, ground = on_ground()
    upper, lower = rod(scene, (0, 0, 0), (1, 0, 0)), rod(scene, (1, 0, 0), (2, 0, 0))
    scene.add_hinge("upper", (ground, upper), (0, 0, 0), Z)
    (hinge_to or (lambda s, *pair: s.add_hinge("lower", *pair, Z)))(
        scene, (upper, lower), (1, 0, 0)
    )
    scene.add_point("tip", lower, (2, 0, 0))
    return scene


def run(scene, duration=1.0, step=1e-3, instants=101):
    (outcome,) = fpm.simulate(scene, duration=duration, instants=instants, step=step)
    assert outcome.failure is None
    assert outcome.records["joint_gap"].values.max() < 1e-10
    assert outcome.records["joint_axis_gap"].values.max() < 1e-9
    return outcome


def pendulum_ends(time):
    """Tip of the double pendulum by Lagrange's equations (angles from x, downwards)."""

    def rates(_, y):
        one, two, v, w = y
        mass = np.array([[4 / 3, np.cos(one - two) / 2], [np.cos(one - two) / 2, 1 / 3]])
        force = np.array(
            [
                1.5 * G * np.cos(one) - np.sin(one - two) * w * w / 2,
                0.5 * G * np.cos(two) + np.sin(one - two) * v * v / 2,
            ]
        )
        return [v, w, *np.linalg.solve(mass, force)]

    found = solve_ivp(rates, (0, time), [0.0] * 4, method="DOP853", rtol=1e-12, atol=1e-12)
    one, two = found.y[:2, -1]
    return np.array([np.cos(one) + np.cos(two), -np.sin(one) - np.sin(two), 0.0])


@pytest.mark.slow
@pytest.mark.parametrize("type", ["hinge", "revolute", "spherical"])
def test_double_pendulum_moves_by_lagranges_equations(type):
    """Of second order in the step; a spherical joint keeps a plane motion plane."""

    def lower(scene, pair, point):
        if type == "hinge":
            scene.add_hinge("lower", pair, point, Z)
        else:
            scene.add_joint("lower", type, pair, point, Z)

    exact, off = pendulum_ends(1.0), []
    for step in (1e-3, 5e-4):
        outcome = run(double_pendulum(lower), step=step)
        off.append(np.abs(outcome.points["tip"][0][-1] - exact).max())
        assert np.abs(outcome.energies["balance"]).max() < 1e-3 * G
    assert off[0] < 2e-5
    assert off[1] < 0.27 * off[0]


@pytest.mark.slow
def test_a_universal_joint_turns_as_its_angle_says():
    """Two shafts at 30 degrees: tan(out) = tan(in) / cos(30), Cardan's relation, and the energy."""
    bend = np.radians(30.0)
    scene, ground = on_ground(gravity=(0.0, 0.0, 0.0))
    out = np.array([np.cos(bend), np.sin(bend), 0.0])
    axes = np.column_stack([out, [-np.sin(bend), np.cos(bend), 0.0], Z])
    driving = int(scene.add_particles((-0.5, 0, 0), 1.0, (0.2, 0.3, 0.3))[0])
    driven = int(scene.add_particles(0.5 * out, 1.0, (0.1, 0.3, 0.3), axes)[0])
    scene.add_hinge("in", (ground, driving), (-1, 0, 0), (1, 0, 0))
    scene.add_hinge("out", (ground, driven), out, out)
    # The cross stands with one arm normal to both shafts.
    scene.add_joint("cross", "universal", (driving, driven), (0, 0, 0), Z, axes[:, 1])
    # With that arm on the driving shaft, the driven one starts at the rate w cos(30).
    scene.spin[driving] = 3.0, 0.0, 0.0
    scene.spin[driven] = 3.0 * np.cos(bend) * out
    outcome = run(scene)
    angle, turned = outcome.openings["in"], outcome.openings["out"]
    np.testing.assert_allclose(np.tan(angle) * np.cos(bend), np.tan(turned), rtol=1e-5, atol=1e-7)
    assert angle[-1] > 2.0
    energy = outcome.energies["kinetic"]
    assert np.ptp(energy) < 1e-5 * energy[0]


@pytest.mark.slow
def test_a_loop_that_cannot_close_fails_by_name():
    """Rigid rods whose axes do not fit are locked, and bear their weight; driven, a joint gapes."""
    scene = rigid_bricard()
    first, second = scene.frame[list(scene.hinges[2].particles)]
    axis = np.array([np.cos(0.02), np.sin(0.02), 0.0])
    scene.hinges[2].axes[:] = axis @ first, axis @ second
    locked = run(scene, duration=0.5)
    assert np.abs(np.ptp(locked.points["C"][0], axis=0)).max() < 1e-12
    scene.drive(scene.hinges[0].particles[1], spin=(0, 1.0, 0))
    (outcome,) = fpm.simulate(scene, duration=1.0, instants=11, step=1e-3, energy_tolerance=1e9)
    assert "a joint is open" in str(outcome.failure)
    assert outcome.failure.element.startswith("joint pin")


@pytest.mark.slow
def test_momentum_of_free_bodies_is_kept():
    """A chain of five, free in space: its momentum and angular momentum do not change."""
    random = np.random.default_rng(5)
    scene = fpm.Scene("free")
    rods = [rod(scene, (k, 0, 0), (k + 1, 0, 0), 0.2) for k in range(5)]
    scene.add_hinge("j3", rods[3:], (4, 0, 0), random.normal(size=3))
    for k in range(3):
        kind = ("spherical", "universal", "prismatic")[k]
        scene.add_joint(f"j{k}", kind, rods[k : k + 2], (k + 1, 0, 0), random.normal(size=3))
    scene.velocity[:] = random.normal(size=(5, 3))
    scene.spin[:] = random.normal(size=(5, 3))
    for k, p in enumerate(rods):
        scene.add_point(f"p{k}", p)
    outcome = run(scene, duration=0.5, instants=51)
    velocity = np.array([outcome.points[f"p{k}"][1] for k in range(5)])[:, 1:]
    total = velocity.sum(axis=0)
    np.testing.assert_allclose(total, total[:1] + 0 * total, atol=1e-11)
    final = outcome.final
    inertia = np.einsum("nij,nj,nkj->nik", final.frame, scene.inertia, final.frame)
    spins = np.einsum("nij,nj->ni", inertia, final.spin)
    after = (np.cross(final.position, final.velocity) + spins).sum(axis=0)
    # At the start the joints take up what velocities do not fit, with no moment in sum.
    spins = np.einsum("nij,nj,nkj,nk->ni", scene.frame, scene.inertia, scene.frame, scene.spin)
    before = (np.cross(scene.position, scene.velocity) + spins).sum(axis=0)
    np.testing.assert_allclose(after, before, rtol=1e-5, atol=1e-6)


def test_what_a_joint_refuses():
    scene, ground = on_ground()
    bar = rod(scene, (0, 0, 0), (1, 0, 0))
    with pytest.raises(fpm.SceneError, match="type of joint a"):
        scene.add_joint("a", "ball", (ground, bar), (0, 0, 0))
    with pytest.raises(fpm.SceneError, match="two different"):
        scene.add_joint("a", "spherical", (bar, bar), (0, 0, 0))
    with pytest.raises(fpm.SceneError, match="normal to each other"):
        scene.add_joint("a", "universal", (ground, bar), (0, 0, 0), Z, (0, 1, 1))
    with pytest.raises(fpm.SceneError, match="axes of support a"):
        scene.hold_point("a", bar, (0, 0, 0), "w")
    scene.add_joint("a", "spherical", (ground, bar), (0, 0, 0))
    with pytest.raises(fpm.SceneError, match="not yet used"):
        scene.add_joint("a", "spherical", (ground, bar), (1, 0, 0))
