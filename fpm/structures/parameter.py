"""The parameters of a structure's file: value, unit, range and description side by side."""

import math
from dataclasses import dataclass

from fpm.errors import SceneError
from fpm.scenes.scene_type import Parameter
from fpm.structures.expressions import ExpressionError, parse
from fpm.structures.reading import Node, Problems, check_keys
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


def read_parameters(table: Node, problems: Problems) -> dict[str, Given]:
    """The parameters of a table by name; one that is wrong is left out, and noted."""
    found = {}
    for name, node in table.entries.items():
        key, line = f"parameters.{name}", table.lines[name]
        if not node.is_table:
            problems.refuse(line, key, node.plain, "a mapping with value, unit, description")
        elif given := _parameter(key, line, node, problems):
            found[name] = given
    return found


def _parameter(key: str, line: int, node: Node, problems: Problems) -> Given | None:
    check_keys(node, key, KEYS, problems)
    if "value" not in node.entries:
        problems.say(line, f"{key}.value: missing; allowed: a number")
        return None
    texts = {name: str(entry.plain) for name, entry in node.entries.items()}
    value = _number(f"{key}.value", node.entries["value"], problems)
    if (whole := texts.get("whole", "false")) not in ("true", "false"):
        problems.refuse(node.lines["whole"], f"{key}.whole", whole, "true or false")
    try:
        measured = unit(texts.get("unit", ""))
    except UnitError as error:
        problems.say(node.lines["unit"], f"{key}.unit: {error}")
        measured = None
    ends = _range(f"{key}.range", node.entries.get("range"), problems)
    if value is None or measured is None or ends is None:
        return None
    kind = "integer" if whole == "true" else "real"
    if kind == "integer" and value == round(value):
        value = round(value)
    about = texts.get("description", "")
    parameter = Parameter(value, measured.udunits, about, *ends, kind=kind)
    try:
        parameter.check(key, value)
    except SceneError as error:
        problems.refuse(line, f"{key}.value", value, error.allowed)
        return None
    return Given(parameter, measured, line)


def _number(key: str, node: Node, problems: Problems) -> float | None:
    """Arithmetic of plain numbers; the unit has a key of its own."""
    allowed = "a number without unit; the unit goes to `unit`"
    try:
        expression = parse(node.text)
        if not expression.names and not any(expression.dimension({}).powers):
            return expression.value({})
    except ExpressionError as error:
        allowed = f"{allowed} ({error})" if node.text else allowed
    problems.refuse(node.line, key, node.plain, allowed)
    return None


def _range(key: str, node: Node | None, problems: Problems) -> tuple[float, float] | None:
    """Both ends of a range, infinite without one."""
    if node is None:
        return -math.inf, math.inf
    if len(node.items) != 2:
        problems.refuse(node.line, key, node.plain, "[lowest, highest]")
        return None
    low, high = (_number(key, item, problems) for item in node.items)
    if low is None or high is None:
        return None
    if low > high:
        problems.refuse(node.line, key, node.plain, "the lowest value first")
        return None
    return low, high
