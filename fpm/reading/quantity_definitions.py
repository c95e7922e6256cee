"""Quantities from their definitions in a config."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from fpm.elements.kind import Eventful
from fpm.errors import SceneError, did_you_mean
from fpm.reading.quantities import KINDS, Quantity
from fpm.reading.responses import Response

WAYS = ("rising", "falling", "either")


def parse(
    definitions: Mapping[str, object], responses: Iterable[Response], elements: Iterable[Eventful]
) -> tuple[list[Quantity], list[SceneError]]:
    """The quantities of a config by their definitions, and what is wrong with the others.

    responses: those of the config; elements: what has events in the scene
    (`fpm.files.outcome.eventful`). Each definition is one of KINDS with its keys;
    docs/quantities.md describes them.
    """
    known, elements = {response.name: response for response in responses}, list(elements)
    found: dict[str, Quantity] = {}
    problems = []

    def refers(name: str) -> bool:
        definition = definitions[name]
        return isinstance(definition, Mapping) and isinstance(definition.get("at"), str)

    # Those that others refer to come first; what only follows from a wrong one is not told.
    for name in sorted(definitions, key=refers):
        try:
            found[name] = _parse(name, definitions[name], known, elements, found)
        except SceneError as error:
            at = definitions[name]["at"] if refers(name) else ""
            if at not in definitions or at in found or refers(at):
                problems.append(error)
    return [found[name] for name in definitions if name in found], problems


def _parse(name, definition, responses, elements, others) -> Quantity:
    key = f"quantities.{name}"
    kind = _kind_of(key, definition)
    of = definition[kind]
    if kind == "event":
        number = _whole(f"{key}.number", definition.get("number", 1))
        places = _places(key, of, definition.get("of"), elements)
        quantity = Quantity(name, kind, "s", "", number=number, event=of, places=places)
        return _named(quantity, definition.get("of", ""))
    response = responses[_one_of(f"{key}.{kind}", of, responses)]
    read = {
        **dict.fromkeys(("level", "about"), lambda key, value: _real(key, value, response.unit)),
        "within": lambda key, value: _above_zero(key, value, response.unit),
        "number": _whole,
        "way": lambda key, value: _one_of(key, value, WAYS),
        "at": lambda key, value: _moment(key, value, others),
    }
    fields = {field: read[field](f"{key}.{field}", definition[field])
              for field in KINDS[kind].keys if field in definition}  # fmt: skip
    unit = KINDS[kind].unit or response.unit
    if kind == "smallest_at":
        unit = response.along.unit if response.along else "s"
    if response.along and KINDS[kind].needed:
        allowed = "a response over time, or largest, smallest, smallest_at, mean of this one"
        raise SceneError(f"{key}.{kind}", of, allowed)
    return _named(Quantity(name, kind, unit, "", response, **fields))


def _kind_of(key: str, definition: object) -> str:
    """The kind that a definition is of; SceneError if its keys are not those of one."""
    if not isinstance(definition, Mapping) or len(set(definition) & set(KINDS)) != 1:
        raise SceneError(key, definition, f"exactly one of {', '.join(KINDS)}")
    kind = next(k for k in KINDS if k in definition)
    keys = KINDS[kind].keys
    for other in definition:
        if other != kind and other not in keys:
            allowed = f"{kind} with {', '.join(keys)}" if keys else f"{kind} alone"
            raise SceneError(f"{key}.{other}", definition[other], allowed)
    for needed in KINDS[kind].needed:
        if needed not in definition:
            raise SceneError(key, definition, f"{kind} with {needed}")
    return kind


def _places(key: str, event: object, of: object, elements: list[Eventful]) -> tuple[str, ...]:
    """Names of the elements whose events count: all that have it, or those that are stated."""
    events = list(dict.fromkeys(e for element in elements for e in element.events))
    _one_of(f"{key}.event", event, events, "none: this scene has no events")
    having = [element for element in elements if event in element.events]
    places = [element.name for element in having]
    if of is None:
        return tuple(places)
    # An element is known by its whole name, `stop A upper`, or by that of its joint, `A`; or, of
    # one with a name of its own, by the joint that it is on.
    chosen = [place for place in places if of == place or of in place.split(" ")[1:]]
    on = [element.name for element in having if element.joint == of]
    if not chosen and len(on) > 1:
        raise SceneError(f"{key}.of", of, f"one of those on it: {', '.join(on)}")
    return tuple(chosen or on or [_one_of(f"{key}.of", of, places)])


def _named(quantity: Quantity, of: str = "") -> Quantity:
    """The quantity with its long name."""
    at, places, response = quantity.at, quantity.places, quantity.response
    text = KINDS[quantity.kind].text.format(
        about=response.long_name if response else "",
        nth="first " if quantity.number == 1 else f"{_ordinal(quantity.number)} ",
        level=quantity.level,
        way="" if quantity.way == "either" else f" {quantity.way}",
        within=quantity.within,
        moment=f"at {at.name}" if isinstance(at, Quantity) else f"at {at or 0.0:.6g} s",
        event=quantity.event,
        place=response.along.words if response and response.along else "time",
        whose=f" of {places[0] if len(places) == 1 else of}" if of else "",
    )
    return replace(quantity, long_name=text)


def _ordinal(number: int) -> str:
    ending = {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{'th' if number % 100 in (11, 12, 13) else ending}"


# -- values of keys -------------------------------------------------------------------------------


def _moment(key: str, at: object, others: Mapping[str, Quantity]) -> Quantity | float:
    times = [name for name, quantity in others.items() if quantity.is_time]
    if not isinstance(at, str):
        return _real(key, at, "s")
    if at not in times:
        allowed = f"a time (s), or one of the quantities that are times: {', '.join(times)}"
        raise SceneError(key, at, allowed)
    return others[at]


def _real(key: str, value: object, unit: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise SceneError(key, value, f"a number ({unit})")
    return float(value)


def _above_zero(key: str, value: object, unit: str) -> float:
    if _real(key, value, unit) <= 0:
        raise SceneError(key, value, "a number above 0")
    return float(value)


def _whole(key: str, value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or value < 1:
        raise SceneError(key, value, "a whole number of at least 1")
    return value


def _one_of(key: str, value: object, known: Iterable[str], none: str = "one of ") -> str:
    """The value; SceneError unless it is known, and `none` where nothing is."""
    names = list(known)
    if not isinstance(value, str) or value not in names:
        hint = did_you_mean(value, names) if isinstance(value, str) else ""
        raise SceneError(key, value, f"one of {', '.join(names)}{hint}" if names else none)
    return value
