"""Quantities from their definitions in a config, also as arithmetic of others: `lag: t1 - t2`."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from graphlib import CycleError, TopologicalSorter
from itertools import chain
from typing import Any

import numpy as np

from fpm.arithmetic import expressions
from fpm.arithmetic.expressions import ExpressionError
from fpm.arithmetic.units import Dimension, unit
from fpm.declare import NumberLimits
from fpm.elements.kind import Eventful
from fpm.errors import SceneError
from fpm.files.trajectory import Curves
from fpm.reading.quantities import KINDS, Quantity
from fpm.reading.responses import Response, check_choice, kind_of

_CALL = re.compile(r"(\w+)\s*\(")
_CHOICE = re.compile(r"\b(?:min|max)\s*\(")
_ANGLE = re.compile(r"\b(?:m?rad|degree|rpm)(-?\d*)")


@dataclass(frozen=True)
class QuantityExpression(Quantity):
    """Quantity that is computed run by run from others. text: the expression, such as `t1 - t2`;
    parts: the quantities that it names. It does not exist in a run in which one of them does not,
    or where the result is not finite; `min` and `max` are of those that exist."""

    text: str = ""
    parts: tuple[Quantity, ...] = ()

    @property
    def is_choice(self) -> bool:
        """Whether the expression is the least or the largest of quantities and nothing else."""
        calls = {*_CALL.findall(self.text)}
        return bool(calls) and calls <= {"min", "max"} and not re.search(r"[-+*/]|\b\d", self.text)

    @property
    def is_instantaneous(self) -> bool:
        return any(part.is_instantaneous for part in self.parts)

    @property
    def is_time(self) -> bool:
        return self.is_choice and all(part.is_time for part in self.parts)

    @property
    def least(self) -> float | None:
        least = self.limits[0]
        return least if np.isfinite(least) else None

    @property
    def limits(self) -> tuple[float, float]:
        return expressions.parse(self.text).range({part.name: part.limits for part in self.parts})

    @property
    def always_exists(self) -> bool:
        parts = (part.always_exists for part in self.parts)
        if self.is_choice:
            return any(parts)
        return (
            all(parts)
            and not re.search(r"/|\*\*", self.text)
            and not ({*_CALL.findall(self.text)} - {"min", "max", "abs"})
        )

    @property
    def leaves(self) -> tuple[Quantity, ...]:
        return tuple(dict.fromkeys(leaf for part in self.parts for leaf in part.leaves))

    def combine(self, values: Mapping[str, float]) -> float:
        """Return the value of the expression in the unit of the quantity; NaN if it has none.
        values: of its parts by name, each in its unit, NaN for one that does not exist."""
        try:
            return expressions.parse(self.text).value(values)
        except ExpressionError:
            return float("nan")

    def read(self, number: Callable[[Quantity], float]) -> float:
        return self.combine({part.name: part.read(number) for part in self.parts})

    def read_margin(self, margin: Callable[[Quantity], float]) -> float:
        """Return the margin by which the expression exists: a sum needs all its parts, so the least
        of their margins; `min` or `max` alone needs one of them; both together have no margin."""
        margins = [part.read_margin(margin) for part in self.parts if not part.always_exists]
        if self.always_exists or not margins:
            return float("nan")
        if self.is_choice:
            return float(np.max(margins))
        has_choice_inside = _CHOICE.search(self.text)
        return float("nan") if has_choice_inside else float(np.min(margins))

    def margin(self, curves: Curves) -> float:
        return self.read_margin(lambda leaf: leaf.margin(curves))

    def evaluate(self, curves: Curves) -> float:
        return self.read(lambda leaf: leaf.evaluate(curves))


def unit_of(text: str, units: Mapping[str, str]) -> str:
    """Return the unit (UDUNITS) of an expression of quantities, from theirs by name. Raises
    ExpressionError for units that cannot be combined so, or where the result is a vector. It is the
    unit of the first quantity of the same dimension, if there is one: N m, not J. Angles count as
    numbers; whether the result is one is told by the powers of rad where these agree."""
    expression = expressions.parse(text)
    watt = Dimension(1, 2, -3)
    dimensions = {name: watt if s == "W" else unit(s).dimension for name, s in units.items()}
    dimension = expression.dimension(dimensions)
    if dimension.vector:
        raise ExpressionError(f"{dimension}, not a number")
    symbols = {**units} | {
        name: constant.udunits for name, (_, constant) in expression.constants.items()
    }
    angles = {
        name: Dimension(sum(int(power or 1) for power in _ANGLE.findall(symbol)))
        for name, symbol in symbols.items()
    }
    try:
        angle = expression.dimension(angles).mass
    except ExpressionError:  # as of sines
        angle = 0
    angle *= not dimension.mass  # a moment times an angle is in N m
    for name, symbol in units.items():
        if dimensions[name].powers == dimension.powers and angles[name].mass == angle:
            return symbol
    parts = [f"rad{'' if angle == 1 else f'{angle:g}'}"] * bool(angle)
    parts += [str(dimension).replace("Hz", "s-1")] * any(dimension.powers)
    return " ".join(parts) or "1"


DIRECTIONS = ("rising", "falling", "either")
_COUNT = NumberLimits(least=1, most=10_000, is_whole=True)


def _count(key: str, value: object) -> int:
    if not isinstance(value, int):
        raise SceneError(key, value, _COUNT.describe())
    return int(_COUNT.check(key, value))


_FIELDS = {"at": "instant", "about": "target", "within": "tolerance", "way": "direction"}
"""Fields of `Quantity` that some keys of a definition are; the others have the key's name."""


def parse(
    definitions: Mapping[str, object], responses: Iterable[Response], elements: Iterable[Eventful]
) -> tuple[list[Quantity], list[SceneError]]:
    """Return the quantities that a config defines, in its order, and a SceneError for each
    definition that is wrong itself. definitions: by name, each a mapping with one key of
    `quantities.KINDS` and its further keys, or an expression of others; responses: of the config;
    elements: of the scene that have events."""
    by_name, elements = {response.name: response for response in responses}, list(elements)
    quantities: dict[str, Quantity] = {}
    problems: list[SceneError] = []
    # Those that others refer to come first; what only follows from a wrong one is not told.
    references = {name: _references(definition) for name, definition in definitions.items()}
    references = {name: names & definitions.keys() for name, names in references.items()}
    for name in _order(references, definitions, problems):
        if references[name] <= quantities.keys():
            try:
                quantities[name] = _parse(name, definitions[name], by_name, elements, quantities)
            except SceneError as error:
                problems.append(error)
    return [quantities[name] for name in definitions if name in quantities], problems


def _references(definition: object) -> set[str]:
    """Names of the quantities that a definition refers to."""
    if isinstance(definition, Mapping):
        definition = definition.get("at", definition.get("event_margin"))
        return {definition} if isinstance(definition, str) else set()
    try:
        return expressions.parse(definition).names if isinstance(definition, str) else set()
    except expressions.ExpressionError:
        return set()


def _order(references: dict[str, set], definitions: Mapping, problems: list) -> list[str]:
    """Names of quantities, each behind those that it needs, without those of a circle."""
    try:
        return [*TopologicalSorter(references).static_order()]
    except CycleError as error:
        circle = error.args[1][::-1]
        allowed = f"one that does not need itself: {' needs '.join(circle)}"
        problems.append(SceneError(f"quantities.{circle[0]}", definitions[circle[0]], allowed))
        rest = {name: names for name, names in references.items() if name not in circle}
        return [name for name in _order(rest, definitions, problems) if name in rest]


def _parse(name, definition, responses, elements, quantities) -> Quantity:
    key = f"quantities.{name}"
    if isinstance(definition, str):
        return _expression(name, definition, quantities)
    kind = kind_of(key, definition, KINDS, ", or an expression such as t1 - t2")
    target = definition[kind]
    if kind == "event":
        number = _count(f"{key}.number", definition.get("number", 1))
        places = _places(key, target, definition.get("of"), elements)
        quantity = Quantity(name, kind, "s", "", number=number, event=target, places=places)
        return _add_long_name(quantity, definition.get("of", ""))
    if kind == "event_margin":
        times = {n: unit for n, q in quantities.items() if (unit := _unit_of_margin(q, elements))}
        text = (
            ": a crossing, settling about a value, or the first time that a latch, stop or contact"
        )
        unit = times[check_choice(f"{key}.{kind}", target, times, text)]
        return _add_long_name(Quantity(name, kind, unit, "", instant=quantities[target]))
    response = responses[check_choice(f"{key}.{kind}", target, responses)]
    read: dict[str, Callable] = {
        **dict.fromkeys(("level", "about"), NumberLimits(unit=response.unit).check),
        "within": NumberLimits(unit=response.unit, above=0).check,
        "number": _count,
        "way": lambda key, value: check_choice(key, value, DIRECTIONS),
        "at": lambda key, value: _moment(key, value, quantities),
    }
    names = [name for name in definition if name != kind]
    fields = {_FIELDS.get(n, n): read[n](f"{key}.{n}", definition[n]) for n in names}
    unit = KINDS[kind].unit or response.unit
    if kind == "smallest_at":
        unit = response.along.unit if response.along else "s"
    if response.along and KINDS[kind].mandatory:
        allowed = "a response over time, or largest, smallest, smallest_at, mean of this one"
        raise SceneError(f"{key}.{kind}", target, allowed)
    return _add_long_name(Quantity(name, kind, unit, "", response, **fields))


def _expression(name: str, text: str, quantities: Mapping[str, Quantity]) -> Quantity:
    """Make a quantity that is arithmetic of others."""
    key = f"quantities.{name}"
    try:
        names = sorted(expressions.parse(text).names)
        parts = [quantities[check_choice(key, name, quantities)] for name in names]
        if not parts:
            raise expressions.ExpressionError("it names none")
        unit = unit_of(text, {part.name: part.unit for part in parts})
    except expressions.ExpressionError as error:
        reason = str(error).replace("; allowed: ", ": ")
        allowed = f"an expression of quantities whose units agree, as t1 - t2 ({reason})"
        raise SceneError(key, text, allowed) from None
    return QuantityExpression(name, "expression", unit, text, text=text, parts=(*parts,))


def _unit_of_margin(quantity: Quantity, elements: list[Eventful]) -> str:
    """Return the unit of a quantity's event margin; "": it has none that is always known."""
    if quantity.kind != "event":
        return quantity.response.unit if quantity.has_margin else ""
    gates: list[Any] = [e.gate for e in elements if e.name in quantity.places]
    if not quantity.has_margin or not all(gate and gate.is_sharp for gate in gates):
        return ""
    return "m2 s-2" if gates[0].slides else "rad2 s-2"


def _places(key: str, event: object, target: object, elements: list[Eventful]) -> tuple[str, ...]:
    """Return the names of the elements whose events count."""
    events = [*dict.fromkeys(chain(*(element.events for element in elements)))]
    check_choice(f"{key}.event", event, events)
    candidates = [element for element in elements if event in element.events]
    places = [element.name for element in candidates]
    if target is None:
        return tuple(places)
    # An element can be named in full, `stop A upper`, or by its joint, `A`, even if it has a name
    # of its own.
    matches = [place for place in places if target == place or target in place.split(" ")[1:]]
    joint_names = [element.name for element in candidates if element.joint == target]
    if not matches and len(joint_names) > 1:
        raise SceneError(f"{key}.of", target, f"one of those on it: {', '.join(joint_names)}")
    return tuple(matches or joint_names or [check_choice(f"{key}.of", target, places)])


def _add_long_name(quantity: Quantity, target: str = "") -> Quantity:
    """Return the quantity with its long name."""
    time, places, response = quantity.instant, quantity.places, quantity.response
    number = quantity.number
    is_teen = number % 100 // 10 == 1  # 11th, 12th, 13th
    suffix = "th" if is_teen else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    text = KINDS[quantity.kind].text.format(
        about=response.long_name if response else "",
        nth="first " if number == 1 else f"{number}{suffix} ",
        level=quantity.level,
        way="" if quantity.direction == "either" else f" {quantity.direction}",
        within=quantity.tolerance,
        moment=f"at {time.name}" if isinstance(time, Quantity) else f"at {time or 0.0:.6g} s",
        event=quantity.event,
        time=time.name if isinstance(time, Quantity) else "",
        place=response.along.words if response and response.along else "time",
        whose=f" of {places[0] if len(places) == 1 else target}" if target else "",
    )
    return replace(quantity, long_name=text)


def _moment(key: str, instant: object, quantities: Mapping[str, Quantity]) -> Quantity | float:
    times = [name for name, quantity in quantities.items() if quantity.is_time]
    if not isinstance(instant, str):
        return NumberLimits(unit="s").check(key, instant)
    if instant not in times:
        allowed = "a time (s), or a quantity that is a time"
        allowed += f": {', '.join(times)}" if times else ", of which there is none yet"
        raise SceneError(key, instant, allowed)
    return quantities[instant]
