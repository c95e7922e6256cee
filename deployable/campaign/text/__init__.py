"""Texts for people: quantities in words here, numbers in `numbers`."""

import re
from collections.abc import Callable
from typing import Any

from deployable.campaign.text.numbers import code
from deployable.campaign.text.numbers import quantity as with_unit
from fpm.reading.quantities import Quantity

_KINDS = {"latches": "latch", "misses": "latch", "hits": "stop", "leaves": "stop"}
_KINDS |= {"closes": "contact", "opens": "contact"}
_VERBS = {"hits": "is hit", "leaves": "is left"}


def name_response(response: Any) -> str:
    """Name a response in words, with the names of its subjects in code font: speed of `end`."""
    text = response.long_name.replace("`", "'")
    noun = "the point " if response.kind in ("position", "velocity") else ""
    for subject in filter(None, response.subjects):
        pattern = rf"(.*)(?<![\w`]){re.escape(subject)}(?![\w`])"
        if match := re.match(pattern, text):
            text = match[1] + noun + code(subject) + text[match.end() :]
    text = text.replace(" between `", " between the points `")
    return re.sub(r"\bof (?!the )(\w+ `)", r"of the \1", text)


def words_of(quantity: Any, shown_unit: Callable | None = None) -> dict[str, str]:
    """Describe a quantity in a dict of two texts, with names in code font: `event`, what must
    happen for it to exist (`L latches`; else `there is a largest ...`), and `words`, what it is
    (`speed when L latches`). shown_unit: of units, the factor and the units of numbers as they are
    shown; None: as is."""
    if quantity.kind == "expression":
        events = [
            words_of(part, shown_unit)["event"] for part in quantity.parts if not part.always_exists
        ]
        joint = " or " if quantity.is_choice else " and "
        event = joint.join(dict.fromkeys(events)) or f"there is {quantity.text}"
        return {"event": event, "words": quantity.text}
    if quantity.kind == "event_margin":
        return {"event": f"there is an {quantity.long_name}", "words": quantity.long_name}
    name = name_response(quantity.response) if quantity.response else ""
    if isinstance(quantity.instant, Quantity):
        happens = words_of(quantity.instant, shown_unit)["event"]
        return {"event": happens, "words": f"{name} when {happens}"}
    nth = {1: "first", 2: "second", 3: "third"}.get(quantity.number, f"{quantity.number}th")
    suffix = f" for the {nth} time" if quantity.number > 1 else ""
    if quantity.kind == "event":
        verb = _VERBS.get(quantity.event, quantity.event)
        kind = _KINDS.get(quantity.event, "element")
        if len(quantity.places) == 1:
            place = quantity.places[0]
            noun, _, name = place.partition(" ") if " " in place else (kind, "", place)
            happens = f"the {noun} {code(name)} {verb}{suffix}"
        else:
            happens = f"the {nth} {kind} {verb.replace('latches', 'catches')}"
    elif quantity.kind == "crossing":
        units = quantity.response.unit
        scale, units = shown_unit(units) if shown_unit else (1.0, units)
        level = with_unit(quantity.level * scale, units)
        happens = f"the {name} reaches {level}{suffix}"
    elif quantity.kind == "settling":
        happens = f"the {name} settles"
    else:
        text = quantity.long_name
        text = text.replace(quantity.response.long_name, name) if quantity.response else text
        return {"event": f"there is a {text}", "words": text}
    return {"event": happens, "words": f"time at which {happens}"}


def negate(event: str) -> str:
    """Write that an event (`words_of`) does not happen: `the latch L does not latch`."""
    names, tick, verb = event.rpartition("`")
    text, count = re.subn(r"\bis\b", "is not", verb, count=1)
    if not count:
        text, count = re.subn(r"\b(\w+?)(?:(?<=ch|ss)es|s)\b", r"does not \1", verb, count=1)
    is_plain = count and not re.search(" and | or |^there is", event)
    return names + tick + text if is_plain else f"it does not happen that {event}"
