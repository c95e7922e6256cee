"""The parameters of a structure's file: value, unit, range and description side by side."""

import math
from dataclasses import dataclass

from fpm.errors import SceneError, did_you_mean
from fpm.scenes.scene_type import Parameter
from fpm.structures.expressions import ExpressionError, parse
from fpm.structures.problems import Problems
from fpm.structures.reading import Items, Node, Table, Text, plain
from fpm.structures.units import Unit, UnitError, unit

KEYS = ("value", "unit", "range", "description", "whole")


@dataclass(frozen=True)
class Given:
    """A parameter with its unit and the line where it stands."""

    parameter: Parameter
    unit: Unit
    line: int

    @property
    def whole(self) -> bool:
        """Whether it takes whole numbers only, and may decide the topology."""
        return self.parameter.kind == "integer"

    def si(self, value: float) -> float:
        """A value in SI units."""
        return self.unit.si(float(value))


def read_parameters(table: Table, problems: Problems) -> dict[str, Given]:
    """The parameters of a table by name; one that is wrong is left out, and noted."""
    found = {}
    for name, node in table.entries.items():
        key, line = f"parameters.{name}", table.lines[name]
        if not isinstance(node, Table):
            problems.refuse(line, key, plain(node), "a mapping with value, unit, description")
            continue
        for other in node.entries.keys() - set(KEYS):
            problems.say(
                node.lines[other],
                f"{key}.{other}: there is no such key{did_you_mean(other, KEYS)}; "
                f"allowed: {', '.join(KEYS)}",
            )
        given = _parameter(key, line, node.entries, problems)
        if given is not None:
            found[name] = given
    return found


def _parameter(key: str, line: int, entries: dict[str, Node], problems: Problems) -> Given | None:
    if "value" not in entries:
        problems.say(line, f"{key}.value: missing; allowed: a number")
        return None
    value = _number(f"{key}.value", entries["value"], problems)
    whole = _text(entries.get("whole"), "false")
    if whole not in ("true", "false"):
        problems.refuse(entries["whole"].line, f"{key}.whole", whole, "true or false")
    measured = None
    try:
        measured = unit(_text(entries.get("unit"), ""))
    except UnitError as error:
        problems.say(entries["unit"].line, f"{key}.unit: {error}")
    ends = _range(f"{key}.range", entries.get("range"), problems)
    if value is None or measured is None or ends is None:
        return None
    description = _text(entries.get("description"), "")
    kind = "integer" if whole == "true" else "real"
    if kind == "integer" and value == round(value):
        value = round(value)
    parameter = Parameter(value, measured.udunits, description, *ends, kind=kind)
    try:
        parameter.check(key, value)
    except SceneError as error:
        problems.refuse(line, f"{key}.value", value, error.allowed)
        return None
    return Given(parameter, measured, line)


def _text(node: Node | None, default: str) -> str:
    """The text of a node; a table or list is no text, and shows as what it is."""
    return default if node is None else node.value if isinstance(node, Text) else str(plain(node))


def _number(key: str, node: Node, problems: Problems) -> float | None:
    """Arithmetic of plain numbers; the unit has a key of its own."""
    allowed = "a number without unit; the unit goes to `unit`"
    if isinstance(node, Text) and node.value:
        try:
            expression = parse(node.value)
            if not expression.names and not any(expression.dimension({}).powers):
                return expression.value({})
        except ExpressionError as error:
            allowed = f"{allowed} ({error})"
    problems.refuse(node.line, key, plain(node), allowed)
    return None


def _range(key: str, node: Node | None, problems: Problems) -> tuple[float, float] | None:
    """Both ends of a range, infinite without one."""
    if node is None:
        return -math.inf, math.inf
    if not isinstance(node, Items) or len(node.items) != 2:
        problems.refuse(node.line, key, plain(node), "[lowest, highest]")
        return None
    low, high = (_number(key, item, problems) for item in node.items)
    if low is None or high is None:
        return None
    if low > high:
        problems.refuse(node.line, key, plain(node), "the lowest value first")
        return None
    return low, high
