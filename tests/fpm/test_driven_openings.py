"""Loops, motors and releases on hinges, each against its closed form, side by side in one scene."""

from types import SimpleNamespace

import numpy as np
import pytest

import fpm
from fpm.elements import Motor, Release, SyncLoop, TorqueMotor

J, SMALL = 0.5, 0.25  # kg m²
STEP, DURATION = 1e-3, 1.0
AXIS = (0.0, 0.0, 1.0)


def bodies(scene: fpm.Scene, inertias, spins=None) -> list[int]:
    """A hinge on the ground for each body, at its centre; their indices."""
    ground = int(scene.add_particles((0.0, 0.0, 0.0), 1.0, 1.0)[0])
    scene.fix(ground)
    hinges = []
    for k, inertia in enumerate(inertias):
        spin = (0.0, 0.0, (spins or {}).get(k, 0.0))
        body = int(scene.add_particles((0, 0, k), 1.0, inertia, spin=spin)[0])
        hinges.append(scene.add_hinge(f"H{k}", (ground, body), (0, 0, k), AXIS))
    return hinges


def everything(**changes) -> fpm.Scene:
    """Six bodies that do not touch: motor, torque motor, two releases on springs, and a loop."""
    p = SimpleNamespace(
        k=200.0, c=2.0, torque=1.0, no_load=2.0, time=0.3004, level=0.3, preload=np.inf, spin=1.0
    )
    vars(p).update(changes)
    scene = fpm.Scene("driven openings")
    hinges = bodies(scene, [J] * 5 + [SMALL], {4: p.spin})
    ramp = scene.add_curve([0.0, 0.5], [0.0, 1.0])
    scene.add(Motor(hinges[0], p.k, p.c, 0.0, 1.0, ramp))
    scene.add(TorqueMotor(hinges[1], p.torque, no_load=p.no_load))
    for hinge, when in ((hinges[2], {"time": p.time}), (hinges[3], {"watch": 1, "level": p.level})):
        scene.add_torsion_spring(hinge, 8.0, rest=1.0)
        scene.add(Release(hinge, 400.0, 0.0, hold=-0.02, **when))
    scene.add(SyncLoop("belt", (4, 5), (0.1, 0.2), 1000.0, preload=p.preload))
    return scene


CHANGES = (
    {},
    {"preload": 2.0, "c": 0.0, "time": 0.61},
    {"no_load": np.inf, "torque": -1.0, "level": -0.3},
)


@pytest.fixture(scope="module")
def outcomes():
    scenes = [everything(**some) for some in CHANGES]
    return fpm.simulate(scenes, duration=DURATION, instants=1001, step=STEP)


@pytest.mark.slow
def test_a_loop_swings_between_its_hinges_and_gets_slack(outcomes):
    time, radii, k = outcomes[0].time, np.array([0.1, 0.2]), 1000.0
    fast = np.sqrt(k * (radii**2 / [J, SMALL]).sum())
    slip = [r * o for r, o in zip(radii, (outcomes[0].openings[n] for n in ("H4", "H5")),
                                  strict=True)]  # fmt: skip
    np.testing.assert_allclose(slip[0] - slip[1], 0.1 / fast * np.sin(fast * time), atol=1e-6)
    pull = outcomes[0].records["loop_force"].values[:, 0]
    np.testing.assert_allclose(pull, k * (slip[0] - slip[1]), atol=1e-9)
    np.testing.assert_allclose(outcomes[0].energies["loop"], pull**2 / (2 * k), atol=1e-12)
    # A strand without tension from the slip of 2 P/k on: half the stiffness is left.
    tight, slower = 2 * 2.0 / k, fast / np.sqrt(2)
    turned = np.arcsin(tight * fast / 0.1) / fast
    size = np.hypot(2 * tight, 0.1 * np.cos(fast * turned) / slower)
    again = turned + 2 / slower * np.arccos(2 * tight / size)
    names = [element.name for element in outcomes[1].eventful]
    events = outcomes[1].events[outcomes[1].events[:, 1] == names.index("loop belt")]
    np.testing.assert_allclose(events[:2, 0], [turned, again], atol=2e-5)
    assert events[:2, 2].tolist() == [1, 0]
    pull = outcomes[1].records["loop_force"].values[:, 0]
    assert pull.max() == pytest.approx(k / 2 * size, rel=1e-3)


@pytest.mark.slow
def test_damping_is_stable_at_the_share_of_the_limit_that_a_run_takes():
    for damping in (1.0, 20.0, 400.0, 8000.0):
        scene = everything(c=damping)
        scene.spin[1, 2] = 5.0
        limit = fpm.find_stable_step(scene)
        assert limit.element == ("motor H0" if damping > 10 else "release H2")
        step = fpm.SAFETY * limit.step
        (outcome,) = fpm.simulate(
            scene, duration=1000 * step, instants=1001, step=step, energy_tolerance=1e9
        )
        assert np.isfinite(outcome.openings["H0"]).all()
        late = np.abs(np.diff(outcome.openings["H0"][-50:]))
        assert late.max() < 3 * step + 1e-9


def loop(**more):
    good = {"name": "two", "hinges": (0, 1), "radii": (1.0, 1.0), "stiffness": 1.0}
    return SyncLoop(**good | more)


def motor(**more):
    good = {"hinge": 1, "stiffness": 1.0, "damping": 0.0, "start": 0.0, "turn": 1.0, "curve": 0}
    return Motor(**good | more)


def torque(**more):
    return TorqueMotor(**{"hinge": 0, "torque": 1.0} | more)


def release(**more):
    good = {"hinge": 0, "stiffness": 1.0, "damping": 0.0, "hold": 0.0, "time": 1.0}
    return Release(**good | more)


@pytest.mark.parametrize(
    ("element", "message"),
    [
        (loop(name="belt"), "loop = 'belt'"),
        (loop(hinges=(0, 9)), "hinge of loop two = 9"),
        (loop(hinges=(1, 1)), "hinges of loop two"),
        (loop(radii=(1.0, 0.0)), "radii of loop two"),
        (loop(stiffness=-1.0), "loop two stiffness"),
        (loop(rest=(0.0, np.nan)), "rest of loop two"),
        (loop(preload=-1.0), "preload of loop two"),
        (motor(hinge=0), "joint of a second motor = 'H0'"),
        (motor(hinge=-1), "hinge of motor = -1"),
        (motor(stiffness=np.inf), "motor stiffness"),
        (motor(damping=-1.0), "damping of motor H1"),
        (motor(turn=np.nan), "opening of motor H1"),
        (motor(curve=3), "curve of motor H1 = 3"),
        (
            motor(hinge=0, stiffness=None),
            "joint of a second motor = .H0. is not allowed; expected one motor on a joint",
        ),
        (motor(stiffness=None, start=0.1), "opening of motor H1 at the start"),
        (motor(stiffness=None, turn=np.inf), "opening of motor H1"),
        (motor(stiffness=None, curve=7), "curve of motor H1"),
        (torque(hinge=1), "joint of a second torque motor = 'H1'"),
        (torque(torque=np.inf), "torque of torque motor H0"),
        (torque(no_load=0.0), "no-load speed of torque motor H0"),
        (torque(curve=-2), "curve of torque motor H0"),
        (release(hinge=2), "joint of a second release = 'H2'"),
        (release(stiffness=np.nan), "release stiffness"),
        (release(damping=np.inf), "damping of release H0"),
        (release(hold=np.inf), "hold of release H0"),
        (release(time=0.0), "time of release H0 = 0"),
        (release(time=np.inf), "time of release H0 = inf"),
        (release(watch=7), "hinge of release to watch = 7"),
        (release(watch=1, level=0.0), "level of release H0 = 0"),
    ],
)
def test_what_is_refused(element, message):
    scene = everything()
    count = len(type(element).find(scene))
    with pytest.raises(fpm.SceneError, match=message):
        scene.add(element)
    assert len(type(element).find(scene)) == count
