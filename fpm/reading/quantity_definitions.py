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
    (`fpm.outcome.eventful`). Each definition is one of KINDS with its keys; docs/quantities.md
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
    return _named(Quantity(name, kind, KINDS[kind].unit or response.unit, "", response, **more))


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
    at = quantity.at
    text = KINDS[quantity.kind].text.format(
        about=quantity.response.long_name if quantity.response else "",
        nth="first " if quantity.number == 1 else f"{_ordinal(quantity.number)} ",
        level=quantity.level,
        way="" if quantity.way == "either" else f" {quantity.way}",
        within=quantity.within,
        moment=f"at {at.name}" if isinstance(at, Quantity) else f"at {at or 0.0:.6g} s",
        event=quantity.event,
        whose=f" of {places[0] if len(places) == 1 else of}" if of else "",
    )
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
