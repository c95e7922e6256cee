"""Openings that are held exactly: catching, letting go, energies, lanes, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from rigid_holds import FAR, NONE, J, L, M, bars, caught, held, kinetic, motion
from rigid_holds import free as chain

import fpm
from fpm.elements import Hinge, Joint, Latch, Release, RigidLatch, RigidRelease, Turn
from fpm.reading.quantity_definitions import parse
from fpm.reading.responses import Response

G = 9.81
NEVER = {"watch": 1, "level": -FAR}
RUN = {"duration": 2.0, "instants": 2001, "step": 5e-4}
CASES = {
    "caught": bars(rates=(0.3, 1.0), latch=0.4),
    "going down": bars(rates=(0.2, -0.9), latch=-0.4, side="above"),
    "falls": bars(gravity=G, latch=-0.3),
    "swings": bars(angles=(-1.2, -1.2), rates=(0.5, 2.5), gravity=G, latch=0.5),
    "missed": bars(rates=(0.3, 1.0), latch=0.4, max_capture_rate=0.5),
    "wrong side": bars(rates=(0.3, 1.0), latch=0.4, side="above"),
    "tolerant": bars(rates=(0.3, 1.0), latch=0.4, capture_range=0.1),
    "never": bars(rates=(0.3, 1.0)),
}
HELD = {
    "until a time": bars(gravity=G, hold={"time": 0.3217, **NEVER}),
    "until an opening": bars(gravity=G, hold={"watch": 1, "level": -0.6}),
    "and latches": bars(gravity=G, hold={"time": 0.3217, **NEVER}, latch=-0.3),
}


def run(cases: dict, **more) -> dict:
    outcomes = fpm.simulate(list(cases.values()), **{**RUN, **more})
    assert not any(outcome.failure for outcome in outcomes)
    return dict(zip(cases, outcomes, strict=True))


@pytest.fixture(scope="module")
def ran():
    return run(CASES)


@pytest.fixture(scope="module")
def kept():
    return run(HELD)


def start_of(scene) -> np.ndarray:
    angles = [scene.hinges[0].opening, scene.hinges[0].opening + scene.hinges[1].opening]
    return np.array([*angles, *scene.spin[1:3, 2]])


def angles_of(outcome) -> np.ndarray:
    root, knee = outcome.openings["root"], outcome.openings["knee"]
    return np.array([root, root + knee])


@pytest.mark.slow
@pytest.mark.parametrize("reach", [0.0, 0.1])
def test_a_rigid_latch_at_whose_angle_a_run_starts_holds_from_the_start_on(reach):
    found = run({"at": bars(angles=(0.1, 0.1), gravity=G, latch=0.5 * reach, capture_range=reach)})
    assert np.ptp(found["at"].openings["knee"]) < 1e-9 < np.ptp(found["at"].openings["root"])
    assert found["at"].events[0, 0] == 0.0


CATCHES = [
    ("caught", 0.4, NONE), ("going down", -0.4, NONE), ("tolerant", 0.3, NONE),
    ("falls", -0.3, G), ("swings", 0.5, G),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("name", "angle", "gravity"), CATCHES)
def test_a_rigid_latch_stops_its_hinge_at_its_angle_and_keeps_the_momentum(
    ran, name, angle, gravity
):
    """Against the equations of motion in two angles, a jump where it catches, and one angle."""
    outcome = ran[name]
    before = motion(chain, start_of(CASES[name]), (0, 2), gravity, angle)
    at, state = before.t[-1], before.y[:, -1]
    rates, impulse = caught(state[:2], state[2:])
    after = motion(held, [*state[:2], *rates], (at, 2), gravity)
    exact = np.where(outcome.time < at, before.sol(outcome.time), after.sol(outcome.time))
    assert [outcome.events[0, 0], outcome.events.shape[0]] == pytest.approx([at, 1], abs=1e-6)
    assert np.abs(angles_of(outcome) - exact[:2]).max() < 5e-6
    knee = outcome.openings["knee"]
    assert np.abs(knee[outcome.time > at] - angle).max() < 1e-12
    recorded = {n: outcome.records[n].values[-1, 0] for n in ("latch_rate", "latch_impact")}
    assert recorded["latch_rate"] == pytest.approx(state[3] - state[2], rel=1e-5)
    assert recorded["latch_impact"] == pytest.approx(impulse, rel=1e-3)
    lost = kinetic(state[:2], state[2:]) - kinetic(state[:2], rates)
    assert outcome.energies["joint_loss"][-1] == pytest.approx(lost, rel=2e-3)
    assert np.abs(outcome.energies["balance"]).max() < 2e-3 * max(lost, 0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "gravity"), [(n, g) for n, _, g in CATCHES])
def test_a_response_at_a_catch_is_that_just_before_at_any_spacing_of_instants(ran, name, gravity):
    """What moves then, of which the catch takes a fifth to a half: kinetic energies of the exact
    motion, within a thousandth, whether an instant is every second step or every fortieth."""
    outcome, angle = ran[name], next(angle for n, angle, _ in CATCHES if n == name)
    state = motion(chain, start_of(CASES[name]), (0, 2), gravity, angle).y[:, -1]
    response = Response("moving", "energy", ("kinetic",), "", "J", "kinetic energy")
    asked = {"t": {"event": "latches"}, "before": {"value": "moving", "at": "t"}}
    (_, before), _ = parse(asked, [response], outcome.eventful)
    for every in (1, 2, 20):
        energies = {n: values[::every] for n, values in outcome.energies.items()}
        curves = replace(outcome, time=outcome.time[::every], energies=energies)
        assert before.evaluate(curves) == pytest.approx(kinetic(state[:2], state[2:]), rel=1e-3)


@pytest.mark.slow
def test_a_rigid_latch_catches_the_same_openings_as_others(ran):
    """Too fast, or from the wrong side: the motion is that without it, to the last bit."""
    free = ran["never"]
    for name, noted in (("missed", [1.0]), ("wrong side", [])):
        assert ran[name].events[:, 2].tolist() == noted
        assert np.array_equal(angles_of(ran[name]), angles_of(free))
        assert not ran[name].energies["joint_loss"].any()
    assert ran["missed"].events[0, 0] == pytest.approx(ran["caught"].events[0, 0], abs=1e-12)


@pytest.mark.slow
def test_what_is_lost_at_the_latch_and_its_moment_are_of_the_orders_that_are_said():
    """The motion after it and its impulse to the second order, what is lost to the first."""
    found = []
    for step in (4e-3, 2e-3, 1e-3, 5e-4):
        (outcome,) = fpm.simulate(CASES["swings"], duration=0.8, instants=2, step=step)
        found.append([*angles_of(outcome)[:, -1], outcome.energies["joint_loss"][-1]])
    before = motion(chain, start_of(CASES["swings"]), (0, 2), G, 0.5)
    at, state = before.t[-1], before.y[:, -1]
    rates, _ = caught(state[:2], state[2:])
    exact = motion(held, [*state[:2], *rates], (at, 0.8), G).y[:2, -1]
    lost = kinetic(state[:2], state[2:]) - kinetic(state[:2], rates)
    errors = np.abs(np.array(found) - [*exact, lost])
    assert (errors[0, :2] / errors[3, :2] > 40).all(), errors
    assert errors[0, 2] / errors[3, 2] > 5, errors


@pytest.mark.slow
def test_a_rigid_release_holds_exactly_and_lets_go_in_time(kept):
    for name in ("until a time", "until an opening"):
        outcome = kept[name]

        # Only the second bar swings, about the knee.
        def swings(time, state, gravity):
            return [state[1], -gravity * M[1] * L / 2 * np.cos(state[0]) / (J[1] + M[1] * L**2 / 4)]

        level = None if name == "until a time" else -0.6
        event = lambda time, state, gravity: state[0] - (level or FAR)  # noqa: B023, E731
        event.terminal = True
        from scipy.integrate import solve_ivp

        first = solve_ivp(
            swings, (0, 0.3217 if level is None else 2), [0.0, 0.0], args=(G,), events=event,
            rtol=1e-11, atol=1e-12, dense_output=True,
        )  # fmt: skip
        at, (angle, rate) = first.t[-1], first.y[:, -1]
        assert outcome.events[0, 0] == pytest.approx(at, abs=1e-6)
        assert np.abs(outcome.openings["root"][outcome.time <= at]).max() < 1e-12
        after = motion(chain, [0.0, angle, 0.0, rate], (at, 2), G)
        late = outcome.time > at
        exact = after.sol(outcome.time[late])[:2]
        short = outcome.time[late] < 1.2  # the chain is chaotic afterwards
        assert np.abs(angles_of(outcome)[:, late] - exact)[:, short].max() < 5e-5
        assert np.abs(outcome.energies["balance"]).max() < 1e-3
        assert np.abs(outcome.energies["joint_loss"]).max() < 1e-3


@pytest.mark.slow
def test_held_openings_alone_and_in_a_batch_are_the_same_bits(ran, kept):
    cases = {**{n: (CASES[n], ran[n]) for n in ("caught", "swings", "tolerant")},
             "and latches": (HELD["and latches"], kept["and latches"])}  # fmt: skip
    for name, (scene, beside) in cases.items():
        (alone,) = fpm.simulate(scene, **RUN)
        assert np.array_equal(angles_of(alone), angles_of(beside)), name
        assert np.array_equal(alone.events, beside.events)
        for energy, values in alone.energies.items():
            assert np.array_equal(values, beside.energies[energy]), (name, energy)


@pytest.mark.slow
def test_moments_that_hold_are_told_apart_and_reactions_know_them(ran):
    """The latch's moment and work; and, once all is one pendulum, the force of the root on it."""
    asked = [("joint_moment", "knee latch"), ("joint_work", "knee latch"),
             ("constraint_force", "root x"), ("constraint_force", "root y"),
             ("constraint_moment", "knee z")]  # fmt: skip
    (outcome,) = fpm.simulate(CASES["swings"], record=asked, **RUN)
    assert np.array_equal(angles_of(outcome), angles_of(ran["swings"]))
    moment, work, x, y, twist = (outcome.columns[column] for column in asked)
    np.testing.assert_array_equal(moment, outcome.records["latch_moment"].values[:, 0])
    np.testing.assert_allclose(work, -outcome.energies["joint_loss"], atol=1e-14)
    assert np.abs(twist).max() < 1e-9  # about its own axis the hinge itself has none
    late = slice(500, -1)
    angles, step = angles_of(outcome), outcome.time[1]
    way = np.cumsum(L * np.exp(1j * angles), axis=0) - L / 2 * np.exp(1j * angles)
    pulled = M @ np.diff(way, 2, axis=1) / step**2 + 1j * G * M.sum()
    assert np.abs((x + 1j * y)[late] - pulled[late.start - 1 :]).max() < 1e-3 * np.abs(pulled).max()


def test_rigid_holds_cost_no_step_and_make_joints_of_their_hinges():
    scene = bars(latch=0.4, hold={"time": 1.0})
    assert fpm.find_stable_step(scene).step == np.inf
    assert Hinge.find(scene) == []
    assert [joint.type for joint in Joint.find(scene)] == ["revolute"] * 3 + ["opening"] * 3
    assert len(Turn.find(scene)) == 3


@pytest.mark.parametrize(
    ("element", "message"),
    [
        (RigidLatch(7, 1.0), "hinge of latch = 7"),
        (RigidLatch(0, 1.0, capture_range=-1.0), "capture range of latch"),
        (RigidLatch(0, 1.0, max_capture_rate=0.0), "largest capture rate of latch"),
        (RigidLatch(0, np.nan), "angle of latch"),
        (RigidLatch(1, 1.0), "no other latch"),
        (Latch(1, 1.0, 1.0), "no other latch"),
        (RigidRelease(0), "time of release root"),
        (RigidRelease(0, time=-1.0), "time of release root"),
        (RigidRelease(2, time=1.0), "a hinge without a release"),
        (Release(2, 1.0, 0.0, 0.0, time=1.0), "a hinge without a release"),
        (RigidRelease(0, watch=1, level=0.0), "level of release root"),
    ],
)
def test_what_rigid_holds_refuse(element, message):
    with pytest.raises(fpm.SceneError, match=message):
        bars().add(element)
