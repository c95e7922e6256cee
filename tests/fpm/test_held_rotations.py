"""Supports that hold rotations about some axes: those of the body need not be principal there."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import fpm

INERTIA = np.array([0.02, 0.05, 0.06])
FRAME = Rotation.from_rotvec([0.3, -0.5, np.pi / 4]).as_matrix()
DURATION = 0.4


def body(rotations: str, frame=FRAME, damping=0.0, inertia=INERTIA) -> fpm.Scene:
    """A body held in place and about some axes, with a point off it."""
    scene = fpm.Scene("body", damping=damping)
    particle = scene.add_particles((0.0, 0.0, 0.0), 1.0, inertia, frame)[0]
    scene.fix(particle, "xyz", rotations)
    scene.add_point("tip", particle, (0.3, 0.0, 0.1))
    return scene


def turned(rotations: str, moment, spin, damping: float, times) -> np.ndarray:
    """Where the tip is (t, 3): of w, the components along the free axes f follow from
    f·(J w) = momentum, whatever the others of the momentum are."""
    free = np.eye(3)[["xyz".index(a) for a in "xyz" if a not in rotations]]

    def inertia(frame):
        return free @ frame @ np.diag(INERTIA) @ frame.T @ free.T

    def rate(_, y):
        frame, momentum = y[:9].reshape(3, 3), y[9:]
        w = np.linalg.solve(inertia(frame), momentum) @ free
        change = free @ moment - damping * momentum
        return np.concatenate([np.cross(w, frame, axisb=0, axisc=0).ravel(), change])

    start = np.concatenate([FRAME.ravel(), inertia(FRAME) @ free @ spin])
    found = solve_ivp(rate, (0, times[-1]), start, t_eval=times, rtol=1e-11, atol=1e-12).y.T
    frames = found[:, :9].reshape(-1, 3, 3)
    return frames @ FRAME.T @ [0.3, 0.0, 0.1]


@pytest.mark.slow
@pytest.mark.parametrize("damping", [0.0, 2.0])
@pytest.mark.parametrize("rotations", ["xz", "yz"])
def test_what_is_held_does_not_turn_and_the_rest_does_as_it_should(rotations, damping):
    """The tip stays in its plane to rounding; it is right to the second order, as turns of free
    bodies are: 1e-3 of its way at this step, a quarter at half of it."""
    moment, spin, errors = np.array([0.3, 0.5, -0.4]), np.array([2.0, 3.0, -1.0]), []
    for step in (2e-3, 1e-3):
        scene = body(rotations, damping=damping)
        scene.spin[0] = spin
        scene.add_load(0, moment=moment)
        (outcome,) = fpm.simulate(scene, duration=DURATION, instants=41, step=step)
        assert outcome.failure is None
        tip = outcome.points["tip"][0]
        right = turned(rotations, moment, spin, damping, outcome.time)
        errors.append(np.abs(tip - right).max())
        axis = next(k for k, a in enumerate("xyz") if a not in rotations)
        np.testing.assert_allclose(tip[:, axis], tip[0, axis], atol=1e-13)
    assert np.abs(np.diff(right, axis=0)).sum() > 0.1
    assert errors[0] < 1e-3
    assert errors[1] < 0.27 * errors[0] + 1e-9


def test_the_stable_step_knows_which_own_axes_are_held():
    """A bar along z in a plane is one along x in another."""

    def step(turn: int) -> float:
        scene = fpm.Scene()
        ends, normal = np.roll([[0.0, 0, 0], [1.0, 0, 0]], turn, axis=1), np.roll([0.0, 0, 1], turn)
        shape = fpm.Section.rectangle(0.04, 0.02), fpm.Material(1e9, 0.3, 1000.0)
        bar = scene.add_link(*ends, normal, *shape, 4)
        letters = "".join("xyz"[("xyz".index(a) + turn) % 3] for a in "xz")
        scene.fix(bar.particles, "", letters)
        return fpm.find_stable_step(scene).step

    assert step(1) == pytest.approx(step(0), rel=1e-9)
    assert step(2) == pytest.approx(step(0), rel=1e-9)


def test_a_body_turns_about_two_axes_only_if_its_inertias_are_alike():
    scene = body("x")
    with pytest.raises(fpm.SceneError, match="rotations of particle 0, held about x alone"):
        fpm.find_stable_step(scene)
    scene.inertia[0] = 0.1
    fpm.find_stable_step(scene)
