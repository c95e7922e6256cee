"""Quantities of curves whose peaks, crossings and events are known."""

import numpy as np
import pytest

from fpm import SceneError
from fpm.elements.kind import Eventful
from fpm.files.trajectory import Curves
from fpm.reading.events import value_at
from fpm.reading.quantities import KINDS, QuantityType, crossing, crossing_margin, peak
from fpm.reading.quantity_definitions import parse, unit_of
from fpm.reading.responses import Response

TIME = np.linspace(0.0, 2.0, 401)
ELEMENTS = [
    Eventful("contact A", ("opens", "closes")),
    Eventful("latch A upper", ("locks",), "knee"),
    Eventful("contact C", ("opens", "closes"), "C"),
    Eventful("latch one", ("latches",), "hip"),
    Eventful("latch two", ("latches",), "hip"),
]
EVENTS = np.array([[0.5, 0, 1], [0.7, 0, 0], [0.9, 2, 1], [1.3, 0, 1], [1.4, 1, 0]])
RESPONSE = Response("x", "position", ("P",), "x", "m", "x-component of the position of P")


def read(
    definition, values, time=TIME, dropped=0, step=TIME[1], events=EVENTS, when=None, of=RESPONSE
) -> float:
    """A quantity of a run whose one response has these values."""
    track = np.zeros((len(time), 3))
    track[:, 0] = values
    curves = Curves(time, {"P": (track, track)}, {}, {}, events, ELEMENTS, dropped, step)
    names = {"q": definition, "shut": {"event": "closes"}, "half": {"crossing": "x", "level": 0.5}}
    names |= {} if when is None else {"when": when}
    (found, *_), problems = parse(names, [of], ELEMENTS)
    assert not problems
    return found.evaluate(curves)


WAVE = np.exp(-TIME) * np.sin(5 * TIME)
TOP = np.arctan(5) / 5  # where the wave is largest


@pytest.mark.parametrize(
    ("definition", "exact"),
    [
        ({"largest": "x"}, np.exp(-TOP) * np.sin(5 * TOP)),
        ({"smallest": "x"}, -np.exp(-TOP - np.pi / 5) * np.sin(5 * TOP)),
        ({"final": "x"}, np.exp(-2) * np.sin(10)),
        ({"crossing": "x", "level": 0}, 0.0),  # it starts on the level, which counts as below
        ({"crossing": "x", "level": 0, "number": 3}, 2 * np.pi / 5),
        ({"crossing": "x", "level": 0, "way": "falling", "number": 2}, 3 * np.pi / 5),
        ({"value": "x", "at": 1.2345}, np.exp(-1.2345) * np.sin(5 * 1.2345)),
        ({"value": "x", "at": "shut"}, np.exp(-0.5) * np.sin(2.5)),
        ({"value": "x", "at": "half"}, 0.5),
    ],
)
def test_numbers_of_a_decaying_wave(definition, exact):
    assert read(definition, WAVE) == pytest.approx(exact, abs=1e-6)


ANY, POSITIVE = (-np.inf, np.inf), (0.0, np.inf)


@pytest.mark.parametrize(
    ("text", "unit", "exact", "is_time", "limits"),
    [
        ("shut - half", "s", 0.5 - np.log(2), False, ANY),
        ("2.2 s - shut", "s", 1.7, False, (-np.inf, 2.2)),
        ("top/(2 + exp(-half/(1 s)))", "m", 1 / 2.5, False, ANY),
        ("3 s + max(shut, 1 s)/(1 + abs(top)/(1 m))", "s", 3.5, False, (3.0, np.inf)),
        ("max(shut, half)", "s", np.log(2), True, POSITIVE),
        ("min(half, never)", "s", np.log(2), True, POSITIVE),  # of those that exist
        ("shut + never", "s", np.nan, False, POSITIVE),
        ("top/(2*half) - 1 m/s", "m s-1", 1 / np.log(4) - 1, False, ANY),
        ("sqrt(abs(shut - half)/(20 ms))", "1", np.sqrt(50 * (np.log(2) - 0.5)), False, POSITIVE),
        ("top/(shut - 0.5 s)", "m s-1", np.nan, False, ANY),
        ("2*(shut - half)**2 + shut**2", "s2", 2 * (0.5 - np.log(2)) ** 2 + 0.25, False, POSITIVE),
        ("sin(half/(1 s))**2", "1", np.sin(np.log(2)) ** 2, False, (0, 1)),
        ("half - abs(top)*(1 s)/(1 m)", "s", np.log(2) - 1, False, ANY),
    ],
)
def test_arithmetic_of_quantities(text, unit, exact, is_time, limits):
    """Units are derived; what is not finite, and what lacks a part, does not exist."""
    names = {"q": text, "half": {"crossing": "x", "level": 0.5}, "shut": {"event": "closes"},
             "never": {"crossing": "x", "level": 9}, "top": {"largest": "x"}}  # fmt: skip
    track = np.zeros((len(TIME), 3))
    track[:, 0] = np.exp(-TIME)
    curves = Curves(TIME, {"P": (track, track)}, {}, {}, EVENTS, ELEMENTS, 0, TIME[1])
    (found, *_), problems = parse(names, [RESPONSE], ELEMENTS)
    assert not problems
    assert (found.unit, found.is_time, found.limits) == (unit, is_time, limits)
    np.testing.assert_allclose(found.evaluate(curves), exact, atol=1e-9)


def test_angles_of_expressions_are_told_from_numbers():
    rates = {"phi": "rad", "omega": "rad s-1", "t": "s", "M": "N m"}
    texts = {"phi/t - omega": "rad s-1", "2*phi - 5 deg": "rad", "phi/(1 rad)": "1", "M*phi": "N m",
             "omega**2": "rad2 s-2", "sin(phi)*t": "s", "1/t": "s-1"}  # fmt: skip
    assert {text: unit_of(text, rates) for text in texts} == texts


def test_every_kind_of_the_table_is_read_and_one_more_takes_a_line_of_it(monkeypatch):
    median = QuantityType(
        lambda q, curves: float(np.median(q.response.evaluate(curves))), "median {about}"
    )
    monkeypatch.setitem(KINDS, "median", median)
    for kind, known in KINDS.items():
        of = {"event": "closes", "event_margin": "half"}.get(kind, "x")
        definition = {kind: of} | dict.fromkeys(known.mandatory, 0.25)
        assert np.isfinite(read(definition, WAVE)), kind
    assert read({"median": "x"}, TIME) == pytest.approx(1.0)


def test_means_and_settling():
    assert read({"mean": "x"}, TIME**2) == pytest.approx(4 / 3, rel=1e-5)
    assert read({"rms": "x"}, np.sin(np.pi * TIME)) == pytest.approx(np.sqrt(0.5), rel=1e-5)
    decay = np.exp(-3 * TIME)
    found = read({"settling": "x", "within": 0.05, "about": 0}, decay)
    assert found == pytest.approx(np.log(20) / 3, abs=1e-7)
    assert np.isnan(read({"settling": "x", "within": 1e-3, "about": 0}, decay))
    assert read({"settling": "x", "within": 2, "about": 0}, decay) == 0


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("rebound", [0.0, 0.5])
@pytest.mark.parametrize("blow", [1.0001, 1.0049])
def test_a_peak_at_an_impact_is_not_that_of_a_parabola_across_it(blow, rebound, sign):
    """What a latch or stop ends goes no farther than it was at the impact."""
    values = sign * np.where(blow > TIME, TIME, blow - rebound * (TIME - blow))
    kind, events = ("largest" if sign > 0 else "smallest"), np.array([[blow, 3, 0]])
    assert read({kind: "x"}, values, step=1e-5, events=events) == pytest.approx(sign * blow, 1e-9)


STEP = TIME[1] - TIME[0]  # an instant is recorded in every step


@pytest.mark.parametrize("blow", [0.9001, 0.9023, 0.9049, 0.91])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_peak_at_a_blow_whose_instants_lie_between_both_sides_is_that_before_it(blow, sign):
    """With a step as long as the instants are apart, the velocity of the instants about a catch
    lies between both sides of it, and nothing goes beyond rest after it."""
    mixed = np.where(blow - STEP < TIME, 0.6 * TIME, TIME)
    mixed = np.where(blow < TIME, 0.3 * TIME, mixed)
    mixed = sign * np.where(blow + STEP < TIME, 0.0, mixed)
    events, rest = np.array([[blow, 3, 0]]), TIME > 0.85
    most, least = ("largest", "smallest")[::sign]
    speed = Response("x", "velocity", ("P",), "x", "m s-1", "x-velocity of P")
    options = {"step": STEP, "events": events, "of": speed}
    assert read({most: "x"}, mixed, **options) == pytest.approx(sign * blow, 1e-9)
    slowed = np.where(rest, mixed, sign * 0.85)
    assert read({least: "x"}, slowed, **options) == pytest.approx(0.0, abs=1e-12)


def test_a_value_at_an_event_is_of_one_side_and_knows_nothing_of_others():
    """The impulse of a blow comes half in the step of the event and half in the next, so that the
    velocities of two or three instants lie between; and what was before another event goes on
    otherwise."""
    blow, other = 0.9025, 1.3
    speed = 1.0 + TIME - TIME**2
    mixed = np.where(blow - STEP < TIME, 0.3 * speed, speed)
    mixed = np.where(blow + STEP < TIME, 5.0 - TIME, mixed)
    mixed = np.where(other - STEP < TIME, 100.0, mixed)
    mixed = np.where(other + 2 * STEP <= TIME, np.exp(TIME), mixed)
    events = EVENTS.copy()
    events[2, 0], events[4, 0] = blow, 1.4
    second, locks = {"event": "closes", "number": 2}, {"event": "locks"}
    for event, exact in ((second, 1.0 + blow - blow**2), (locks, np.exp(1.4))):
        found = read({"value": "x", "at": "when"}, mixed, events=events, when=event)
        assert found == pytest.approx(exact, abs=1e-6)
    # At a time between two events, too.
    found = read({"value": "x", "at": 0.915}, mixed, events=events)
    assert found == pytest.approx(5.0 - 0.915, abs=1e-9)


AT = 0.9185  # of a blow, between two instants
MADE = {
    "position": Response("x", "position", ("P",), "x", "m", ""),
    "distance": Response("x", "distance", ("P", "Q"), "", "m", ""),
    "velocity": Response("x", "velocity", ("P",), "x", "m s-1", ""),
    "opening": Response("x", "opening", ("knee",), "", "rad", "", (("opening", "knee"),)),
}


def just_before(kind: str, instants: int, tremble: float = 0.0) -> float:
    """By how much a response is off at the blow: of a point on a spiral and of an opening, with all
    rates; what comes after the blow is something else. tremble (m/s): of the point, 914 Hz."""
    time, wave = np.linspace(0.0, 2.0, instants), 2 * np.pi * 913.7
    way, still = (0.3 + 6.0j), np.tile([2.0, 1.0, 0.0], (instants, 1))

    def motion(t, order):
        found = way**order * np.exp(way * t)
        return found + tremble * (1j * wave) ** (order - 1) * np.exp(1j * wave * t)

    def track(order):
        found = np.where(time < AT, motion(time, order), 50.0)
        return np.stack([found.real, found.imag, 0 * time], axis=1)

    x, v, a = (track(order) for order in range(3))
    asked = {("acceleration", f"P {axis}"): a[:, k] for k, axis in enumerate("xyz")}
    asked |= {("opening_rate", "knee"): v[:, 0], ("opening", "knee"): x[:, 0]}
    events = np.array([[AT, 0, 1]])
    points = {"P": (x, v), "Q": (still, 0 * still)}
    curves = Curves(time, points, {}, asked, events, ELEMENTS, 0, 1e-3)
    exact = {
        "position": motion(AT, 0).real, "distance": abs(motion(AT, 0) - (2 + 1j)),
        "velocity": motion(AT, 1).real, "opening": motion(AT, 0).real,
    }  # fmt: skip
    return abs(value_at(curves, MADE[kind], AT, True) - exact[kind])


@pytest.mark.parametrize("kind", MADE)
def test_at_an_event_rates_make_up_for_instants_that_are_few(kind):
    """A step of 1 ms errs by some 1e-6 itself; instants twice as far apart change no more."""
    assert just_before(kind, 201) < 1e-8
    assert just_before(kind, 101) < 1e-6


def test_what_trembles_between_instants_is_not_followed_by_its_rates():
    """Rates of it say nothing of the next instant: they would make 100 times of it."""
    assert just_before("velocity", 201, tremble=1e-3) < 0.02


def test_events_a_few_steps_apart_are_one_and_of_more_the_last_instant_before_counts():
    """Two latches that catch one after the other: within five steps, then with one instant between
    them that neither touches, where nothing tells how the response goes on."""
    events = EVENTS[:2].copy()
    when = {"event": "opens"}
    curve = np.where(TIME < 0.5, 2.0 + TIME, 50.0 * TIME)
    for gap, time, exact in ((1e-9, TIME, 2.5), (3 * STEP, TIME, 2.5), (0.035, TIME[::4], 26.0)):
        events[1, 0] = 0.5 + gap
        found = read(
            {"value": "x", "at": "when"}, curve[:: round((len(TIME) - 1) / (len(time) - 1))], time,
            step=STEP, events=events, when=when,
        )  # fmt: skip
        assert found == pytest.approx(exact, abs=1e-9)


@pytest.mark.parametrize(
    ("definition", "time"),
    [
        ({"event": "closes"}, 0.5),
        ({"event": "closes", "number": 3}, 1.3),
        ({"event": "closes", "of": "A", "number": 2}, 1.3),
        ({"event": "closes", "of": "contact C"}, 0.9),
        ({"event": "locks", "of": "A"}, 1.4),
        ({"event": "closes", "number": 4}, np.nan),
        ({"event": "opens", "of": "C"}, np.nan),
    ],
)
def test_events_of_any_kind_are_counted_by_element(definition, time):
    assert read(definition, WAVE) == pytest.approx(time, nan_ok=True)


@pytest.mark.parametrize("way", ["rising", "falling", "either"])
@pytest.mark.parametrize("number", [1, 2, 3])
def test_a_margin_tells_whether_a_level_is_crossed_and_by_how_much_it_might_be_missed(way, number):
    """It is above zero just where there is such a crossing, and moving the level by less than the
    margin changes nothing."""
    rng = np.random.default_rng(number)
    time = np.linspace(0.0, 1.0, 60)
    curves = 0.3 * rng.normal(size=(100, 60)).cumsum(axis=1) + rng.normal(size=(100, 1))
    margins = crossing_margin(curves, way, number)
    assert 10 < (margins > 0).sum() < 100
    for values, margin in zip(curves, margins, strict=True):
        for level in (0.0, 0.99 * margin, -0.99 * margin):
            found = crossing(time, values, level, way, number)
            assert np.isfinite(found) == (margin > 0)


def test_what_does_not_happen_is_no_number():
    assert np.isnan(read({"crossing": "x", "level": 2}, WAVE))
    assert np.isnan(read({"crossing": "x", "level": 0.1, "number": 9}, WAVE))
    assert np.isnan(read({"value": "x", "at": 3.0}, WAVE))
    with pytest.raises(ValueError, match="12 events more than are kept"):
        read({"event": "closes", "number": 9}, WAVE, dropped=12)


@pytest.mark.parametrize(
    ("definition", "words"),
    [
        ({"largest": ["x"]}, "one of x"),
        ({"largest": "x", "level": 1}, "largest alone"),
        ({"crossing": "x", "level": "a"}, r"a number \(m\)"),
        ({"crossing": "x", "level": 1, "way": "up"}, "one of rising"),
        ({"crossing": "x", "level": 1, "number": 0}, "from 1 to 10000"),
        ({"settling": "x", "within": 0}, "above 0"),
        ({"value": "x", "at": "later"}, "a quantity that is a time"),
        ({"event": "close"}, "did you mean closes"),
        ({"event": "closes", "of": "B"}, "one of contact A, contact C"),
    ],
)
def test_wrong_definitions_are_refused(definition, words):
    found, (problem,) = parse({"q": definition}, [RESPONSE], ELEMENTS)
    assert not found
    assert isinstance(problem, SceneError)
    with pytest.raises(SceneError, match=words):
        raise problem


def test_an_element_with_a_name_of_its_own_is_known_by_its_joint_where_it_is_the_only_one():
    assert read({"event": "locks", "of": "knee"}, WAVE) == 1.4
    _, (problem,) = parse({"q": {"event": "latches", "of": "hip"}}, [], ELEMENTS)
    assert problem.allowed == "one of those on it: latch one, latch two"


def test_what_only_follows_from_a_wrong_quantity_is_not_told():
    wrong = {
        "t": {"event": "clozes"},
        "v": {"value": "x", "at": "t"},
        "w": {"value": "x", "at": "u"},
    }
    _, problems = parse(wrong, [RESPONSE], ELEMENTS)
    assert [problem.key for problem in problems] == ["quantities.t.event", "quantities.w.at"]


@pytest.mark.parametrize(
    ("values", "top"),
    [([3.0, 2.0, 0.0, 2.5], 3.0), ([0.0, 2.0, 3.0], 3.0), ([2.5, 0.0, 2.0, 3.0], 3.0),
     ([0.0, 3.0, 1.0], 3.0 + 1.0 / 40), ([1.0, 1.0, 1.0], 1.0)],
)  # fmt: skip
def test_a_peak_at_either_end_is_the_value_there(values, top):
    """The parabola is only where there are neighbours on both sides."""
    assert peak(np.array(values)) == pytest.approx(top, abs=1e-15)
