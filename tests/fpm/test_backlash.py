"""Backlash of drive trains and loops: none, and what is refused."""

import pytest

import fpm
from evidence.verification.motors import RADII, driven_body, geared_pair
from fpm.elements import SyncLoop
from fpm.errors import SceneError
from fpm.structures.text_file import loads


@pytest.mark.slow
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
