"""Backlash of drive trains and loops, against the equations of motion solved by themselves."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fpm
from fpm.elements import Motor, SyncLoop
from fpm.errors import SceneError
from fpm.structures.text_file import loads

INERTIA, STIFFNESS, DAMPING, BACKLASH = 0.5, 200.0, 2.0, 0.1
SWING, SPEED = 0.3, 6.0  # of the drive: SWING sin(SPEED t)
RADII = 0.2, -0.1


def driven(damping: float, backlash: float | None = BACKLASH) -> fpm.Scene:
    scene = fpm.Scene("driven")
    ground, body = (int(p) for p in scene.add_particles(np.zeros((2, 3)), 1.0, INERTIA))
    scene.fix(ground)
    hinge = scene.add_hinge("A", (ground, body), (0, 0, 0), (0, 0, 1.0))
    times = np.linspace(0.0, 2.0, 4001)
    curve = scene.add_curve(times, SWING * np.sin(SPEED * times))
    scene.add(Motor(hinge, STIFFNESS, damping, 0.0, 1.0, curve, backlash=backlash))
    return scene


def geared() -> fpm.Scene:
    scene = fpm.Scene("geared")
    rates = [(0, 0, 0), (0, 0, 3.0), (0, 0, 0)]
    particles = scene.add_particles(np.zeros((3, 3)), 1.0, INERTIA, spin=rates)
    ground, *bodies = (int(p) for p in particles)
    scene.fix(ground)
    hinges = [
        scene.add_hinge(f"H{body}", (ground, body), (0, 0, 0), (0, 0, 1.0)) for body in bodies
    ]
    scene.add(SyncLoop("gear", tuple(hinges), RADII, 5000.0, backlash=0.02))
    return scene


def driven_slope(damping):
    def slope(time, state):
        error = SWING * np.sin(SPEED * time) - state[0]
        rate = SWING * SPEED * np.cos(SPEED * time) - state[1]
        sign, excess = np.sign(error), abs(error) - BACKLASH / 2
        press = max(STIFFNESS * excess + damping * sign * rate, 0.0) if excess > 0 else 0.0
        return state[1], sign * press / INERTIA

    return slope


def geared_slope(_, state):
    slip = RADII[0] * state[0] - RADII[1] * state[1]
    pull = 5000.0 * np.sign(slip) * max(abs(slip) - 0.01, 0.0)
    return *state[2:], -RADII[0] * pull / INERTIA, RADII[1] * pull / INERTIA


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "slope", "start"),
    [
        (driven(0.0), driven_slope(0.0), [0, 0]),
        (driven(DAMPING), driven_slope(DAMPING), [0, 0]),
        (geared(), geared_slope, [0, 0, 3.0, 0]),
    ],
)
def test_motions_with_backlash_are_right_to_the_second_order(scene, slope, start):
    errors = []
    for step in (2e-3, 1e-3):
        (outcome,) = fpm.simulate(scene, duration=2.0, instants=41, step=step)
        assert not outcome.failure
        result = solve_ivp(
            slope, (0, 2), start, t_eval=outcome.time, rtol=1e-9, atol=1e-11, max_step=1e-3
        )
        openings = outcome.records["opening"].values.T
        errors.append(np.abs(openings - result.y[: len(openings)]).max())
        energies = dict(outcome.energies)
        stored = max(np.abs(energy).max() for energy in energies.values())
        assert np.abs(energies["balance"]).max() < 1e-5 * stored
    assert errors[1] < 2e-4
    assert np.log2(errors[0] / errors[1]) > 1.8


@pytest.mark.slow
@pytest.mark.slow
def test_the_first_touch_of_teeth_at_some_microjoules_is_no_instability():
    scene = fpm.Scene("play")
    ground, body = (int(p) for p in scene.add_particles(np.zeros((2, 3)), 1.0, 1.0))
    scene.fix(ground)
    hinge = scene.add_hinge("A", (ground, body), (0, 0, 0), (0, 0, 1.0))
    curve = scene.add_curve([0.0, 1.5], [0.0, 1.0], smooth=True)
    scene.add(Motor(hinge, 20.0, 0.0, 0.0, 1.0, curve, backlash=0.1))

    def slope(time, state):
        u = min(time / 1.5, 1.0)
        error = u * u * (3 - 2 * u) - state[0]
        return [state[1], 20.0 * np.sign(error) * max(abs(error) - 0.05, 0.0)]

    exact = solve_ivp(slope, (0, 2), [0, 0], rtol=1e-9, atol=1e-12, max_step=1e-3).y[0].max()
    for step in (5e-3, 2.5e-3):
        (outcome,) = fpm.simulate(
            scene, duration=2, instants=401, step=step, energy_tolerance=0.005
        )
        assert outcome.failure is None
        assert outcome.openings["A"].max() == pytest.approx(exact, rel=1e-4)


def test_none_is_a_drive_train_without_backlash():
    """To the last digits: with a backlash of 0 the same is computed."""
    first, second = (
        fpm.simulate(driven(DAMPING, b), duration=0.2, instants=21, step=1e-3)[0].records
        for b in (None, 0.0)
    )
    assert first["opening"].values == pytest.approx(second["opening"].values, abs=1e-12)


DRIVE = """
bodies: {lid: {mass: 1 kg, centre: O, inertia: [1, 1, 1], points: [O]}}
points: {O: [0, 0, 0]}
joints: {hinge: {type: revolute, parts: [ground, lid], at: O, axis: z}}
curves: {ramp: {times: [0, 1 s], values: [0, 1]}}
"""


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("backlash: 2 deg", "none without a `stiffness`"),
        ("backlash: -2 deg, stiffness: 1 N m/rad", "an angle of at least 0"),
        ("backlash: 2 mm, stiffness: 1 N m/rad", "an angle"),
    ],
)
def test_what_is_refused(text, words):
    motor = f"actions: {{drive: {{type: motor, joint: hinge, rate: 1 rad/s, curve: ramp, {text}}}}}"
    with pytest.raises(SceneError, match=words):
        loads("name: drive\n" + DRIVE + motor).build()


def test_a_loop_has_a_preload_or_a_backlash():
    scene = geared()
    with pytest.raises(SceneError, match="none, with a backlash"):
        scene.add(SyncLoop("other", (0, 1), RADII, 10.0, preload=1.0, backlash=0.1))
