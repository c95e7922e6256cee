"""Quantities in the words of readers who do not know their names."""

from collections.abc import Callable
from typing import Any

from deployable.campaign.text.numbers import quantity as with_unit
from fpm.reading.quantities import Quantity


def words_of(quantity: Any, shown_unit: Callable | None = None) -> dict[str, str]:
    """Describe a quantity in a dict of two texts: `event`, what must happen for it to exist (`L
    latches`; else `there is a largest ...`), and `words`, what it is (`speed when L latches`).
    shown_unit: of units, the factor and the units of numbers as they are shown; None: as is."""
    if quantity.kind == "expression":
        events = [
            words_of(part, shown_unit)["event"] for part in quantity.parts if not part.always_exists
        ]
        joint = " or " if quantity.is_choice else " and "
        event = joint.join(dict.fromkeys(events)) or f"there is {quantity.text}"
        return {"event": event, "words": quantity.text}
    if quantity.kind == "event_margin":
        return {"event": f"there is an {quantity.long_name}", "words": quantity.long_name}
    name = quantity.response.long_name if quantity.response else ""
    if isinstance(quantity.instant, Quantity):
        happens = words_of(quantity.instant, shown_unit)["event"]
        return {"event": happens, "words": f"{name} when {happens}"}
    suffix = f" (number {quantity.number})" if quantity.number > 1 else ""
    if quantity.kind == "event":
        kind = f"{quantity.event.removesuffix('es')} "  # `latch L latches` says it twice
        is_many = len(quantity.places) != 1
        subject = "something" if is_many else quantity.places[0].removeprefix(kind)
        happens = f"{subject} {quantity.event}{suffix}"
    elif quantity.kind == "crossing":
        units = quantity.response.unit
        scale, units = shown_unit(units) if shown_unit else (1.0, units)
        level = with_unit(quantity.level * scale, units)
        happens = f"the {name} reaches {level}{suffix}"
    elif quantity.kind == "settling":
        happens = f"the {name} settles"
    else:
        return {"event": f"there is a {quantity.long_name}", "words": quantity.long_name}
    return {"event": happens, "words": f"time at which {happens}"}
