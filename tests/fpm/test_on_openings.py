"""Latches, dampers, friction, stops and springs by tables on a rigid flap: closed forms, energy."""

import numpy as np
import pytest
from flaps import J, bare, flap

import fpm
from fpm.elements import Damper, Friction, Latch, Stop, TableSpring
from fpm.elements.openings.table_spring import bends
from fpm.reading.responses import parse

PANEL = {"spring": (0.1, np.pi)}  # of the closed form for a panel with a latch
TAPE = ((-0.5, 0.0, 0.1, 0.3, 2.0), (0.1, 0.0, -0.8, -0.2, -0.2))
CONSTANT = (0.5,) * 5  # N m
CASES = {
    "below the table": flap(table=((30.0, 31.0, 32.0, 33.0, 34.0), CONSTANT)),
    "past the table": flap(table=((-34.0, -33.0, -32.0, -31.0, -30.0), CONSTANT)),
    "one-sided": flap(
        rate=1.0, spring=(1.0, 0.0),
        latch={"angle": 0.3, "stiffness": 100.0, "damping": 8.0, "holds": "one way"},
    ),
    "missed": flap(**PANEL, latch={
        "angle": np.pi / 2, "stiffness": 100.0, "max_capture_rate": 1.4}),
    "missed where it ends": flap(**PANEL, latch={  # at the same opening as the one before
        "angle": np.pi / 2 - 0.05, "stiffness": 100.0, "capture_range": 0.05,
        "max_capture_rate": 1.4}),
    "wrong side": flap(
        rate=1.0, spring=(4.0, 0.0), latch={"angle": 0.2, "stiffness": 100.0, "side": "above"}
    ),
}  # fmt: skip
RUN = {"duration": 4.0, "instants": 4001, "step": 2e-4}


@pytest.fixture(scope="module")
def ran():
    outcomes = fpm.simulate(list(CASES.values()), **RUN)
    assert not any(outcome.failure for outcome in outcomes)
    return dict(zip(CASES, outcomes, strict=True))


def opening(outcome) -> np.ndarray:
    return outcome.openings["hinge"]


def events_of(outcome) -> list[str]:
    return [outcome.eventful[int(e)].events[int(which)] for _, e, which in outcome.events]


@pytest.mark.slow
def test_a_one_sided_latch_resists_going_back_only(ran):
    outcome = ran["one-sided"]
    assert events_of(outcome) == ["latches"]
    up = np.argmax(opening(outcome))
    exact = np.sqrt(J) * np.sin(outcome.time / np.sqrt(J))
    np.testing.assert_allclose(opening(outcome)[: up + 1], exact[: up + 1], atol=1e-7)
    moment = outcome.records["latch_moment"].values[:, 0]
    assert moment.min() > -1e-3 * moment.max()  # but for the edge, it never pulls
    assert opening(outcome)[up:].min() > 0.3 - 0.06
    assert opening(outcome)[-1] == pytest.approx(0.3 * 100 / 101, abs=0.01)
    assert outcome.energies["joint_loss"][-1] > 0.9 * (J / 2 - 0.3**2 / 2)


@pytest.mark.slow
def test_a_latch_is_missed_if_it_is_passed_too_fast_or_from_the_other_side(ran):
    for name in ("missed", "missed where it ends"):
        assert events_of(ran[name]) == ["misses"]
        exact = np.pi * (1 - np.cos(np.sqrt(0.3) * ran[name].time))
        np.testing.assert_allclose(opening(ran[name]), exact, atol=1e-6)
    # Upwards it does not look; downwards it catches, at the first crossing with a rate below zero.
    late = ran["wrong side"]
    assert events_of(late) == ["latches"]
    omega = np.sqrt(4 / J)
    assert late.events[0, 0] == pytest.approx((np.pi - np.arcsin(0.2 * omega)) / omega, abs=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [None, 100.0])
def test_within_its_range_a_latch_catches_inside_a_step(stiffness):
    """Where a damped flap is slow enough, and where a swinging one turns into its direction: at
    second order in the step, which no comparison with half the step can tell of an event that
    waits for a step's end."""
    pin = {"stiffness": stiffness, "side": "below"}
    slow = {"angle": 1.0, "capture_range": 0.2, "max_capture_rate": 1.0, **pin}
    turn = {"angle": -0.45, "capture_range": 0.1, **pin}
    scenes = [
        flap(rate=1.5, damper=0.6 * J, latch=slow),
        flap(opening=0.5, spring=(4 * J, 0.0), latch=turn),
    ]
    exact = np.array([[np.log(1.5) / 0.6, 0.5 / 0.6, 1.0], [np.pi / 2, -0.5, 0.0]])
    errors = []
    for step in (0.01, 0.005):
        found = []
        for outcome in fpm.simulate(scenes, duration=1.7, instants=18, step=step):
            assert events_of(outcome) == ["latches"]
            rate = outcome.records["latch_rate"].values[-1, 0]
            moment = outcome.records["latch_moment"].values[-1, 0]
            bend = -moment / stiffness if stiffness else 0.0  # by which a spring lets it go on
            found.append([outcome.events[0, 0], opening(outcome)[-1] - bend, rate])
        errors.append(np.abs(np.array(found) - exact))
    assert errors[0].max() < 1e-4 and errors[1].max() < 0.4 * errors[0].max(), errors


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "stiffness"), [(0.0, 1e6), (0.1, 1e3), (0.6, 1e6)])
def test_what_strikes_a_stop_at_the_step_of_its_own_comes_back_right(ratio, stiffness):
    """To 1 % of its speed, wherever in a step it strikes; its parts have no slack in the bound."""
    rate, omega = 3.0, np.sqrt(stiffness / J)
    stop = {"side": "above", "stiffness": stiffness, "damping": 2 * ratio * np.sqrt(stiffness * J)}
    gaps = (10 + np.linspace(0, 2, 8)) / omega * rate
    scenes = [flap(rate=rate, stop={"angle": gap, **stop}) for gap in gaps]
    root = np.sqrt(1 - ratio**2)
    end = np.pi - np.arctan2(2 * ratio * root, 1 - 2 * ratio**2)  # where c s' + k s = 0
    exact = -np.exp(-ratio * end / root) * (np.cos(end) - ratio / root * np.sin(end))
    record = [("joint_moment", "hinge stop")]
    for outcome in fpm.simulate(scenes, duration=24 / omega, instants=401, record=record):
        assert not outcome.failure
        assert outcome.select_columns("joint_moment")["hinge stop"].max() < 1e-9  # never pulls
        back = -np.diff(opening(outcome))[-1] / np.diff(outcome.time)[-1] / rate
        assert back == pytest.approx(exact, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["below the table", "past the table"])
def test_where_a_constant_moment_has_no_energy_does_not_matter(ran, name):
    """Past the table its energy is below zero, and all that is stored with it."""
    time = np.linspace(0.0, RUN["duration"], RUN["instants"])
    np.testing.assert_allclose(opening(ran[name]), CONSTANT[0] / J / 2 * time**2, atol=1e-9)


def test_the_least_energy_of_a_table_is_zero():
    spring = TableSpring(0, *TAPE)
    grid = np.linspace(-0.5, 2.0, 100001)
    given = np.concatenate([[0.0], np.cumsum(np.diff(grid) * np.interp(grid[1:], *TAPE))])
    assert spring.lift == pytest.approx(given.max(), abs=1e-4)
    assert bends(spring.angles, spring.moments).sum() == pytest.approx(0.0, abs=1e-12)


@pytest.mark.slow
def test_where_a_run_starts_in_its_range_a_latch_catches_at_once():
    """From the start on an oscillator about the place, at the angle, before and behind it."""
    held = {"stiffness": 100.0, "damping": 2.0, "side": "below"}
    ranges = ((0.3, 0.0), (0.33, 0.05), (0.27, 0.05))
    latches = [{**held, "angle": angle, "capture_range": reach} for angle, reach in ranges]
    scenes = [flap(rate=0.5, opening=0.3, latch=latch) for latch in latches]
    scenes.append(flap(rate=-0.5, opening=0.3, latch=latches[0]))
    *outcomes, off = fpm.simulate(scenes, duration=0.4, instants=41, step=5e-4)
    decay = 2.0 / (2 * J)
    fast = np.sqrt(100.0 / J - decay**2)
    for outcome in outcomes:
        swing = 0.5 / fast * np.exp(-decay * outcome.time) * np.sin(fast * outcome.time)
        assert opening(outcome) == pytest.approx(0.3 + swing, abs=1e-6)
        assert outcome.events[0, 0] == 0.0
    assert opening(off)[-1] == pytest.approx(0.1, abs=1e-9), "it comes from above"


def test_a_damper_between_driven_and_free_knows_the_rate_at_the_start():
    scene = bare(rate=0.25)
    scene.drive(0, spin=(0, 0, 1.0))
    from fpm.elements.openings.opening import turning_at_start

    assert turning_at_start(scene, [0]) == [-0.75]


@pytest.mark.parametrize(
    ("element", "message"),
    [
        (Latch(1, 1.0, 1.0), "hinge of latch = 1"),
        (Latch(0, 1.0, -1.0), "latch stiffness = -1"),
        (Latch(0, 1.0, 1.0, capture_range=-1.0), "capture range of latch"),
        (Latch(0, 1.0, 1.0, damping=np.inf), "damping of latch"),
        (Latch(0, 1.0, 1.0, max_capture_rate=0.0), "largest capture rate of latch"),
        (Latch(0, 1.0, 1.0, side="left"), "side of latch"),
        (Damper(0, -0.1), "damping of damper"),
        (Damper(3, 0.1), "hinge of damper"),
        (Friction(0, -1.0), "moment of friction"),
        (Friction(0, 1.0, bristle_deflection=0.0), "bristle deflection of friction"),
        (Friction(0, 1.0, damping=-1.0), "damping of friction"),
        (Friction(5, 1.0, None), "hinge of friction"),
        (Friction(0, -1.0, None), "moment of friction"),
        (Stop(0, np.nan, "above", 1.0), "angle of stop"),
        (Stop(0, 0.0, "up", 1.0), "side of stop"),
        (TableSpring(0, (0.0,), (1.0,)), "angles of spring by a table"),
        (TableSpring(0, (0.0, 0.0), (1.0, 1.0)), "increasing angles"),
        (TableSpring(0, (0.0, 1.0), (1.0, np.nan)), "all finite"),
    ],
)
def test_what_openings_refuse(element, message):
    scene = bare()
    with pytest.raises(fpm.SceneError, match=message):
        scene.add(element)


def test_two_latches_on_a_hinge_need_names():
    scene = bare()
    scene.add(Latch(0, 1.0, 1.0))
    with pytest.raises(fpm.SceneError, match="no other latch"):
        scene.add(Latch(0, 2.0, 1.0))
    scene.add(Latch(0, 2.0, 1.0, name="second"))
    assert Latch.names(scene) == ["latch hinge", "latch second"]


@pytest.mark.parametrize(
    ("opening", "latch", "stop", "ends"),
    [
        (0.0, {"angle": 1.0}, {"angle": 2.0, "side": "above"}, (None, 1.0)),
        (3.0, {"angle": 1.0}, {"angle": 2.0, "side": "below"}, (2.0, None)),
        (0.0, {"angle": 1.0, "holds": "one way"}, {"angle": 2.0, "side": "above"}, (None, 2.0)),
        (
            0.0,
            {"angle": 1.0, "max_capture_rate": 9.0},
            {"angle": 2.0, "side": "above"},
            (None, 2.0),
        ),
        (0.0, {"angle": 1.0, "side": "below"}, {"angle": -1.0, "side": "below"}, (-1.0, 1.0)),
        (3.0, {"angle": 1.0, "side": "above"}, {"angle": 4.0, "side": "above"}, (1.0, 4.0)),
    ],
)
def test_stops_and_latches_end_the_way_of_an_opening(opening, latch, stop, ends):
    parts = {"latch": {"stiffness": 1.0, **latch}, "stop": {"stiffness": 1.0, **stop}}
    scene = flap(opening=opening, **parts)
    assert parse("x", {"opening": "hinge"}, scene).ends == ends
    assert parse("x", {"opening_rate": "hinge"}, scene).ends == (None, None)
