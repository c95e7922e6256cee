"""Quantities: numbers that are read off a run, such as its peaks and the times of its events.

A run in which what is asked for does not happen has no number: NaN.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Union

import numpy as np

from fpm.errors import SceneError, did_you_mean
from fpm.responses import Response

if TYPE_CHECKING:
    from fpm.outcome import Eventful
    from fpm.scene import Scene
    from fpm.trajectory import Curves

KEYS = {
    "largest": (),
    "smallest": (),
    "final": (),
    "mean": (),
    "rms": (),
    "value": ("at",),
    "overshoot": ("about",),
    "settling": ("within", "about"),
    "crossing": ("level", "way", "number"),
    "event": ("of", "number"),
}
"""The kinds of quantity, by the key that names what each is of, and the other keys that it takes.
All are of a response, but for an event, which is that of an element."""

NEEDED = {"value": ("at",), "settling": ("within",), "crossing": ("level",)}
WAYS = ("rising", "falling", "either")


@dataclass(frozen=True)
class Quantity:
    """A named number of a run: its `kind`, and what the other keys of its definition say.

    unit (UDUNITS) and long_name are those of the number that `evaluate` returns. `places` are the
    names of the elements whose `event` counts.
    """

    name: str
    kind: str
    unit: str
    long_name: str
    response: Response | None = None
    at: Union["Quantity", float, None] = None
    about: float | None = None
    within: float = 0.0
    level: float = 0.0
    way: str = "either"
    number: int = 1
    event: str = ""
    places: tuple[str, ...] = ()

    @property
    def is_time(self) -> bool:
        """Whether it is a time of the run (s)."""
        return self.kind in ("crossing", "settling", "event")

    def evaluate(self, curves: "Curves") -> float:
        """The number of one run; NaN where what is asked for does not happen in it.

        ValueError where the run had more events than were kept, and it may be among the others.
        """
        if self.kind == "event":
            return self._event(curves)
        time, values = curves.time, self.response.evaluate(curves)
        if self.kind == "crossing":
            return crossing(time, values, self.level, self.way, self.number)
        if self.kind == "settling":
            return settling(time, values, self.within, self.about)
        if self.kind == "value":
            return self._value(curves, time, values)
        if self.kind == "overshoot":
            about = values[-1] if self.about is None else self.about
            way = np.sign(about - values[0])
            return max(0.0, peak(way * (values - about))) if way else 0.0
        if self.kind in ("largest", "smallest"):
            sign = 1.0 if self.kind == "largest" else -1.0
            return sign * peak(sign * values)
        if self.kind == "final":
            return float(values[-1])
        span = time[-1] - time[0]
        if self.kind == "mean":
            return float(np.trapezoid(values, time) / span)
        return float(np.sqrt(np.trapezoid(values**2, time) / span))

    def _event(self, curves: "Curves") -> float:
        found = [curves.happened.get((place, self.event), ()) for place in self.places]
        times = np.sort(np.concatenate([np.zeros(0), *found]))
        if len(times) >= self.number:
            return float(times[self.number - 1])
        if curves.events_dropped:
            raise ValueError(
                f"{self.name}: a run has {curves.events_dropped} events more than are kept; "
                f"{self.long_name} may be among them"
            )
        return float("nan")

    def _value(self, curves: "Curves", time: np.ndarray, values: np.ndarray) -> float:
        at = self.at.evaluate(curves) if isinstance(self.at, Quantity) else self.at
        if not np.isfinite(at) or not time[0] <= at <= time[-1]:
            return float("nan")
        # Forces change at an event, and with them how a response goes on: it is followed up to it.
        event = isinstance(self.at, Quantity) and self.at.kind == "event"
        after = int(np.searchsorted(time, at, side="left"))
        last = max(after - 1, 0) if event else after + 1
        return float(_polynomial(time, values, last)(at))


def peak(values: np.ndarray) -> float:
    """The largest of values (t,) at equal distances, by the parabola through it and its neighbours.

    It is above the largest value by an eighth of the step to a neighbour at most.
    """
    i = int(values.argmax())
    top = float(values[i])
    if 0 < i < len(values) - 1:
        before, after = top - values[i - 1], top - values[i + 1]
        if before + after > 0:
            top += float((before - after) ** 2 / (8 * (before + after)))
    return top


def crossing(
    time: np.ndarray, values: np.ndarray, level: float, way: str = "either", number: int = 1
) -> float:
    """Time (s) at which values (t,) cross a level for the nth time; NaN if they do not.

    By the cubic through the four instants around it. A value on the level counts as below it.
    """
    above = values > level
    places = np.flatnonzero(above[1:] != above[:-1])
    if way != "either":
        places = places[above[places + 1] == (way == "rising")]
    if len(places) < number:
        return float("nan")
    return _root(time, values - level, int(places[number - 1]))


def settling(
    time: np.ndarray, values: np.ndarray, within: float, about: float | None = None
) -> float:
    """Time (s) from which on values (t,) stay within a distance of `about`, or of the last value.

    NaN if they are outside at the end; the first instant if they never are.
    """
    off = values - (values[-1] if about is None else about)
    outside = np.flatnonzero(np.abs(off) > within)
    if not len(outside):
        return float(time[0])
    last = int(outside[-1])
    if last == len(time) - 1:
        return float("nan")
    return _root(time, np.sign(off[last]) * off - within, last)


def _polynomial(time: np.ndarray, values: np.ndarray, last: int) -> np.polynomial.Polynomial:
    """The cubic through the four instants up to `last`, or the nearest four that there are."""
    stop = min(max(last + 1, 4), len(time))
    near = slice(max(stop - 4, 0), stop)
    return np.polynomial.Polynomial.fit(time[near], values[near], len(time[near]) - 1)


def _root(time: np.ndarray, values: np.ndarray, i: int) -> float:
    """Where values (t,) vanish between the instants i and i + 1, at which they differ in sign."""
    cubic = _polynomial(time, values, i + 2)
    low, high = float(time[i]), float(time[i + 1])
    rising = bool(values[i + 1] > 0)
    for _ in range(60):
        middle = 0.5 * (low + high)
        if (cubic(middle) > 0) == rising:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


def eventful(scene: "Scene") -> list["Eventful"]:
    """The elements of a scene that have events."""
    from fpm.kinds import kinds_of
    from fpm.outcome import Eventful

    kinds = [kind for kind in kinds_of([scene]) if kind.events]
    return [Eventful(name, kind.events) for kind in kinds for name in kind.names(scene)]


def parse(
    definitions: Mapping[str, object], responses: Iterable[Response], elements: Iterable["Eventful"]
) -> tuple[list[Quantity], list[SceneError]]:
    """The quantities of a config by their definitions, and what is wrong with the others.

    responses: those of the config; elements: what has events in the scene (`eventful`). Each
    definition is one of KEYS with its keys; docs/quantities.md describes them.
    """
    known, elements = {response.name: response for response in responses}, list(elements)
    found: dict[str, Quantity] = {}
    problems = []
    # Those that others refer to come first.
    for name in sorted(definitions, key=lambda n: _refers(definitions[n])):
        try:
            found[name] = _parse(name, definitions[name], known, elements, found)
        except SceneError as error:
            problems.append(error)
    return [found[name] for name in definitions if name in found], problems


def _refers(definition: object) -> bool:
    return isinstance(definition, Mapping) and isinstance(definition.get("at"), str)


def _parse(name, definition, responses, elements, others) -> Quantity:
    key = f"quantities.{name}"
    if not isinstance(definition, Mapping) or len(set(definition) & set(KEYS)) != 1:
        raise SceneError(key, definition, f"exactly one of {', '.join(KEYS)}")
    kind = next(k for k in KEYS if k in definition)
    for other in definition:
        if other != kind and other not in KEYS[kind]:
            allowed = f"{kind} with {', '.join(KEYS[kind])}" if KEYS[kind] else f"{kind} alone"
            raise SceneError(f"{key}.{other}", definition[other], allowed)
    for needed in NEEDED.get(kind, ()):
        if needed not in definition:
            raise SceneError(key, definition, f"{kind} with {needed}")
    number = definition.get("number", 1)
    if not isinstance(number, int) or isinstance(number, bool) or number < 1:
        raise SceneError(f"{key}.number", number, "a whole number of at least 1")
    if kind == "event":
        return _parse_event(name, definition, number, elements)
    of = definition[kind]
    if not isinstance(of, str) or of not in responses:
        raise SceneError(
            f"{key}.{kind}", of, f"one of {', '.join(responses)}{_hint(of, responses)}"
        )
    response, more = responses[of], {}
    for field in ("level", "about", "within"):
        if field in definition:
            more[field] = _real(f"{key}.{field}", definition[field], response.unit)
    if more.get("within", 1.0) <= 0:
        raise SceneError(f"{key}.within", definition["within"], "a number above 0")
    if kind == "crossing":
        more |= {"number": number, "way": definition.get("way", "either")}
        if more["way"] not in WAYS:
            raise SceneError(f"{key}.way", more["way"], f"one of {', '.join(WAYS)}")
    if kind == "value":
        more["at"] = _moment(key, definition["at"], others)
    time = kind in ("crossing", "settling")
    quantity = Quantity(name, kind, "s" if time else response.unit, "", response, **more)
    return _named(quantity)


def _parse_event(name, definition, number, elements) -> Quantity:
    key, event = f"quantities.{name}", definition["event"]
    events = list(dict.fromkeys(e for element in elements for e in element.events))
    if event not in events:
        allowed = f"one of {', '.join(events)}" if events else "none: this scene has no events"
        raise SceneError(f"{key}.event", event, f"{allowed}{_hint(event, events)}")
    places = [element.name for element in elements if event in element.events]
    if "of" in definition:
        of = definition["of"]
        # An element is known by its whole name, `stop A upper`, or by that of its joint, `A`.
        chosen = [place for place in places if of == place or of in place.split(" ")[1:]]
        if not chosen:
            raise SceneError(f"{key}.of", of, f"one of {', '.join(places)}{_hint(of, places)}")
        places = chosen
    quantity = Quantity(name, "event", "s", "", None, number=number, event=event)
    return _named(quantity, tuple(places), definition.get("of", ""))


def _named(quantity: Quantity, places: tuple[str, ...] = (), of: str = "") -> Quantity:
    """The quantity with its long name, and the elements whose events count."""
    kind, about = quantity.kind, quantity.response.long_name if quantity.response else ""
    nth = "" if quantity.number == 1 else f"{_ordinal(quantity.number)} "
    if kind == "event":
        whose = f" of {places[0] if len(places) == 1 else of}" if of else ""
        text = f"time of the {nth or 'first '}event '{quantity.event}'{whose}"
    elif kind == "crossing":
        way = "" if quantity.way == "either" else f" {quantity.way}"
        text = f"time of the {nth or 'first '}crossing of {quantity.level:.6g}{way} by the {about}"
    elif kind == "settling":
        text = f"time from which the {about} stays within {quantity.within:.6g}"
    elif kind == "value":
        at = quantity.at
        moment = f"at {at.name}" if isinstance(at, Quantity) else f"at {at:.6g} s"
        text = f"{about} {moment}"
    elif kind == "overshoot":
        text = f"overshoot of the {about}"
    else:
        text = f"{kind} {about}"
    return replace(quantity, long_name=text, places=places)


def _ordinal(number: int) -> str:
    ending = {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{'th' if number % 100 in (11, 12, 13) else ending}"


def _moment(key: str, at: object, others: Mapping[str, Quantity]) -> Quantity | float:
    times = [name for name, quantity in others.items() if quantity.is_time]
    if isinstance(at, str):
        if at not in times:
            allowed = f"a time (s), or one of the quantities that are times: {', '.join(times)}"
            raise SceneError(f"{key}.at", at, allowed)
        return others[at]
    return _real(f"{key}.at", at, "s")


def _real(key: str, value: object, unit: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise SceneError(key, value, f"a number ({unit})")
    return float(value)


def _hint(name: object, known: Iterable[str]) -> str:
    return did_you_mean(name, known) if isinstance(name, str) else ""
