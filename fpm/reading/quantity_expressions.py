"""Quantities that are arithmetic of others, as `lag: t1 - t2`."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpm.arithmetic.expressions import ExpressionError, parse
from fpm.arithmetic.units import Dimension, unit
from fpm.files.trajectory import Curves
from fpm.reading.quantities import Quantity

_CALL = re.compile(r"(\w+)\s*\(")
_MONOTONE = {"min", "max", "abs", "sqrt", "exp"}  # of values that are not below 0
_CHOICE = re.compile(r"\b(?:min|max)\s*\(")
_SIZE = re.compile(r"\s*(?:abs|sqrt|exp)\((?:[^()]|\([^()]*\))*\)\s*")
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
        values: dict[str, Any] = {part.name: part.least for part in self.parts}
        if _SIZE.fullmatch(self.text):
            return 0.0
        if None in values.values() or "-" in self.text:
            return None
        if self.is_choice:
            return self.combine(values)
        is_monotone = {*_CALL.findall(self.text)} <= _MONOTONE
        return 0.0 if is_monotone and min(values.values()) >= 0 else None

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
            return parse(self.text).value(values)
        except ExpressionError:
            return float("nan")

    def read(self, number: Callable[[Quantity], float]) -> float:
        return self.combine({part.name: part.read(number) for part in self.parts})

    def read_margin(self, margin: Callable[[Quantity], float]) -> float:
        margins = [part.read_margin(margin) for part in self.parts if not part.always_exists]
        if self.always_exists or not margins:
            return float("nan")
        if self.is_choice:
            return float(np.max(margins))
        return float(np.min(margins)) if not _CHOICE.search(self.text) else float("nan")

    def margin(self, curves: Curves) -> float:
        return self.read_margin(lambda leaf: leaf.margin(curves))

    def evaluate(self, curves: Curves) -> float:
        return self.read(lambda leaf: leaf.evaluate(curves))


def unit_of(text: str, units: Mapping[str, str]) -> str:
    """Return the unit (UDUNITS) of an expression of quantities, from theirs by name. Raises
    ExpressionError for units that cannot be combined so, or where the result is a vector. It is the
    unit of the first quantity of the same dimension, if there is one: N m, not J. Angles count as
    numbers; whether the result is one is told by the powers of rad where these agree."""
    expression = parse(text)
    dimensions = {name: _dimension(symbol) for name, symbol in units.items()}
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


def _dimension(symbol: str) -> Dimension:
    return Dimension(1, 2, -3) if symbol == "W" else unit(symbol).dimension
