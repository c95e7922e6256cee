"""Quantities from their definitions in a config."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from fpm.elements.kind import Eventful
from fpm.errors import SceneError, did_you_mean
from fpm.reading.quantities import Quantity
from fpm.reading.responses import Response

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


def parse(
    definitions: Mapping[str, object], responses: Iterable[Response], elements: Iterable[Eventful]
) -> tuple[list[Quantity], list[SceneError]]:
    """The quantities of a config by their definitions, and what is wrong with the others.

    responses: those of the config; elements: what has events in the scene
    (`fpm.outcome.eventful`). Each definition is one of KEYS with its keys; docs/quantities.md
    describes them.
    """
    known, elements = {response.name: response for response in responses}, list(elements)
    found: dict[str, Quantity] = {}
    problems = []
    # Those that others refer to come first.
    for name in sorted(definitions, key=lambda n: _refers(definitions[n])):
        try:
            found[name] = _parse(name, definitions[name], known, elements, found)
        except SceneError as error:
            if not _follows(definitions, name, found):
                problems.append(error)
    return [found[name] for name in definitions if name in found], problems


def _refers(definition: object) -> bool:
    return isinstance(definition, Mapping) and isinstance(definition.get("at"), str)


def _follows(definitions: Mapping[str, object], name: str, found: Mapping) -> bool:
    """Whether a definition is at a time whose own one is wrong, which is told already."""
    return (
        _refers(definitions[name])
        and (at := definitions[name]["at"]) in definitions
        and (at not in found and not _refers(definitions[at]))
    )


def _parse(name, definition, responses, elements, others) -> Quantity:
    key = f"quantities.{name}"
    kind = _kind_of(key, definition)
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
    response = responses[of]
    more = _numbers(key, definition, response.unit)
    if kind == "crossing":
        more |= {"number": number, "way": definition.get("way", "either")}
        if more["way"] not in WAYS:
            raise SceneError(f"{key}.way", more["way"], f"one of {', '.join(WAYS)}")
    if kind == "value":
        more["at"] = _moment(key, definition["at"], others)
    time = kind in ("crossing", "settling")
    quantity = Quantity(name, kind, "s" if time else response.unit, "", response, **more)
    return _named(quantity)


def _kind_of(key: str, definition: object) -> str:
    """The kind that a definition is of; SceneError if its keys are not those of one."""
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
    return kind


def _numbers(key: str, definition: Mapping, unit: str) -> dict[str, float]:
    """The numbers of a definition that are in the unit of its response."""
    fields = [field for field in ("level", "about", "within") if field in definition]
    found = {field: _real(f"{key}.{field}", definition[field], unit) for field in fields}
    if found.get("within", 1.0) <= 0:
        raise SceneError(f"{key}.within", definition["within"], "a number above 0")
    return found


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
        if not chosen:  # or, of one with a name of its own, by the joint that it is on
            on = [e.name for e in elements if event in e.events and e.joint == of]
            if len(on) > 1:
                raise SceneError(f"{key}.of", of, f"one of those on it: {', '.join(on)}")
            chosen = on
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
