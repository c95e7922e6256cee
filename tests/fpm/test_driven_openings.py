"""Loops, motors and releases on hinges, each against its closed form, side by side in one scene."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

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


def follows(time, c, k=200.0):
    """How far a body lags behind a motor that turns at 2 rad/s for half a second, and its rate."""
    decay = c / (2 * J)
    fast = np.sqrt(k / J - decay**2)

    def answer(t):
        size, sine, cosine = np.exp(-decay * t) / fast, np.sin(fast * t), np.cos(fast * t)
        return size * sine, size * (fast * cosine - decay * sine)

    before, after = answer(time), answer(np.maximum(time - 0.5, 0.0))
    return [2 * (b - np.where(time > 0.5, a, 0.0)) for b, a in zip(before, after, strict=True)]


@pytest.mark.slow
def test_a_motor_turns_its_hinge_through_its_drive_train(outcomes):
    for outcome, c in zip(outcomes[:2], (2.0, 0.0), strict=True):
        lag = follows(outcome.time, c)[0]
        exact = np.minimum(2 * outcome.time, 1.0) - lag
        np.testing.assert_allclose(outcome.openings["H0"], exact, atol=1e-4)
        stored = outcome.energies["motor"]
        np.testing.assert_allclose(stored, 100.0 * lag**2, atol=2e-3)


@pytest.mark.slow
def test_motors_work_is_moved_stored_or_lost(outcomes):
    """That of both motors; the torque motor's is what its body moves with."""
    time = outcomes[0].time
    lag, rate = follows(time, 2.0)
    moment = 200.0 * lag + 2.0 * rate
    work = cumulative_trapezoid(moment, 2.0 * np.minimum(time, 0.5), initial=0.0)
    torque_work = J / 2 * (2.0 * (1 - np.exp(-time))) ** 2
    found = outcomes[0].energies["motor_work"]
    np.testing.assert_allclose(found, work + torque_work, atol=2e-3 * work.max())
    lost = cumulative_trapezoid(2.0 * rate**2, time, initial=0.0)
    lost += 0.08 * (time > 0.3004) + 0.08 * (time > 0.60263)  # what the releases had stored
    np.testing.assert_allclose(outcomes[0].energies["joint_loss"], lost, atol=1e-2 * lost.max())
    recorded = outcomes[0].records["motor_moment"]
    assert (recorded.dimension, recorded.labels, recorded.unit) == ("motor", ("H0",), "N m")
    np.testing.assert_allclose(recorded.values[10:500, 0], moment[10:500], atol=2e-2)


@pytest.mark.slow
def test_a_torque_motor_comes_up_to_its_no_load_speed(outcomes):
    time = outcomes[0].time
    np.testing.assert_allclose(
        outcomes[0].openings["H1"], 2 * (time - 1 + np.exp(-time)), atol=1e-6
    )
    np.testing.assert_allclose(outcomes[2].openings["H1"], -(time**2), atol=1e-9)
    moment = outcomes[0].records["torque_motor_moment"].values[1:, 0]
    np.testing.assert_allclose(moment, np.exp(-time[1:]), atol=1e-3)


@pytest.mark.slow
def test_releases_hold_until_a_time_or_another_opening(outcomes):
    for outcome, change in zip(outcomes, CHANGES, strict=True):
        time = outcome.time
        opens = np.interp(0.3, 2 * (time - 1 + np.exp(-time)), time)
        due = [change.get("time", 0.3004), opens if "torque" not in change else np.sqrt(0.3)]
        found = [outcome.events[outcome.events[:, 1] == e, 0] for e in _elements(outcome)]
        for hinge, when, told in zip(("H2", "H3"), due, found, strict=True):
            assert told == pytest.approx([when], abs=1e-6)
            swing = 1 - np.cos(4 * np.maximum(time - when, 0.0))
            np.testing.assert_allclose(outcome.openings[hinge], swing, atol=2e-5)
    # Springs of 400 N m/rad that were strained by 0.02 rad; the motor loses nothing here.
    assert outcomes[1].energies["joint_loss"][-1] == pytest.approx(2 * 0.08, rel=1e-3)


def _elements(outcome) -> list[int]:
    names = [element.name for element in outcome.eventful]
    return [names.index(f"release H{k}") for k in (2, 3)]


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
def test_the_energy_balance_has_no_error_of_motors_and_releases(outcomes):
    for outcome, off in zip(outcomes, (1e-12, 1e-4, 1e-12), strict=True):
        most = outcome.energies["kinetic"].max()
        assert np.abs(outcome.energies["balance"]).max() < off * most


@pytest.mark.slow
def test_alone_and_in_a_batch_they_give_the_same_bits(outcomes):
    for change, together in zip(CHANGES[1:], outcomes[1:], strict=True):
        (alone,) = fpm.simulate(everything(**change), duration=DURATION, instants=1001, step=STEP)
        for name, values in alone.openings.items():
            assert np.array_equal(values, together.openings[name])
        for name, values in alone.energies.items():
            assert np.array_equal(values, together.energies[name])
        assert np.array_equal(alone.events, together.events)


def only(scene: fpm.Scene, *kinds) -> fpm.Scene:
    """The scene without what else acts on its hinges."""
    for kind in (Motor, TorqueMotor, Release, SyncLoop, fpm.elements.TorsionSpring):
        if kind not in kinds:
            scene.kinds.pop(kind, None)
    return scene


def test_the_stable_step_of_a_loop_is_exact():
    fast = np.sqrt(1000.0 * (0.01 / J + 0.04 / SMALL))
    limit = fpm.find_stable_step(only(everything(), SyncLoop))
    assert limit.frequency == pytest.approx(fast, rel=1e-12)
    assert limit.element == "loop belt"
    scene = everything()
    scene.fix(scene.hinges[5].particles[1])
    assert fpm.find_stable_step(only(scene, SyncLoop)).frequency == pytest.approx(np.sqrt(10 / J))


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
        (motor(hinge=0), "hinge of motor = 0"),
        (motor(hinge=-1), "hinge of motor = -1"),
        (motor(stiffness=np.inf), "motor stiffness"),
        (motor(damping=-1.0), "damping of motor H1"),
        (motor(turn=np.nan), "opening of motor H1"),
        (motor(curve=3), "curve of motor H1 = 3"),
        (torque(hinge=1), "hinge of torque motor = 1"),
        (torque(torque=np.inf), "torque of torque motor H0"),
        (torque(no_load=0.0), "no-load speed of torque motor H0"),
        (torque(curve=-2), "curve of torque motor H0"),
        (release(hinge=2), "hinge of release = 2"),
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
