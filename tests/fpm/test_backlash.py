"""Backlash of drive trains and loops: none, and what is refused."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fpm
from evidence.verification.motors import RADII, driven_body, geared_pair
from fpm.elements import Motor, SyncLoop
from fpm.errors import SceneError
from fpm.structures.text_file import loads


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
        fpm.simulate(driven_body(2.0, b), duration=0.2, instants=21, step=1e-3)[0].records
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
    scene = geared_pair()
    with pytest.raises(SceneError, match="none, with a backlash"):
        scene.add(SyncLoop("other", (0, 1), RADII, 10.0, preload=1.0, backlash=0.1))
