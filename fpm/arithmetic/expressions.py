"""Arithmetic on names, numbers, vectors and units, and nothing else.

A text is parsed by Python's own grammar, its tree is checked against a list of what is allowed, and
turned into two chains of functions, for value and dimension: nothing is ever handed to `eval`.
Values are single numbers or vectors (arrays (3,)); a batch is evaluated sample by sample, so that
a sample's last digits do not depend on its neighbours (processors round the sines of a row of
numbers differently from one number's)."""

import ast
import math
import operator
import re
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, lru_cache, partial
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from fpm.arithmetic.ranges import ALL, Range, range_of
from fpm.arithmetic.units import (
    BARE,
    CHAIN,
    NUMBER,
    Dimension,
    Unit,
    UnitError,
    number_hint,
    power,
    product,
    unit,
)

LONGEST = 500
"""Number of characters that an expression may have."""

_SUFFIX = re.compile(
    rf"(?P<before>(?:\*\*|/)\s*[-+]?\s*)?(?<![\w.])"
    rf"(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(?P<unit>{CHAIN})(?P<after>\s*\*\*)?"
)
_OPERATORS: dict[type, Callable] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: math.pow,
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
}
_ANGULAR = ("sin", "cos", "tan")


def _interpolate(x: float, *points: float) -> float:
    """Straight between points x1, y1, x2, y2, ..., and constant beyond them."""
    places, values = points[::2], points[1::2]
    if any(first >= second for first, second in pairwise(places)):
        raise ExpressionError("interpolated between places that do not increase")
    k = min(max(bisect_right(places, x), 1), len(places) - 1)
    weight = min(max((x - places[k - 1]) / (places[k] - places[k - 1]), 0.0), 1.0)
    return (1.0 - weight) * values[k - 1] + weight * values[k]


def _choose(choice: Callable, *values: float) -> float:
    """Return the least or largest of those values that are numbers; NaN without any."""
    return choice((value for value in values if not math.isnan(value)), default=math.nan)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    (a0, a1, a2), (b0, b1, b2) = a.tolist(), b.tolist()
    return np.array([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0])


def _dot(a: np.ndarray, b: np.ndarray) -> float:
    (a0, a1, a2), (b0, b1, b2) = a.tolist(), b.tolist()
    return a0 * b0 + a1 * b1 + a2 * b2


def _unit(vector: np.ndarray) -> np.ndarray:
    if not 0.0 < (size := math.hypot(*vector)) < math.inf:
        raise ExpressionError("the direction of a vector of length 0")
    return vector / size


def _rotate(vector: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotate a vector about an axis by the right-hand rule (Rodrigues' formula)."""
    axis, cosine, sine = _unit(axis), math.cos(angle), math.sin(angle)
    rest = (1.0 - cosine) * _dot(axis, vector)
    return cosine * vector + sine * _cross(axis, vector) + rest * axis


_ROUND = {name: getattr(math, name) for name in (*_ANGULAR, "asin", "acos", "atan")}
_FUNCTIONS: dict[str, tuple[Callable, int, int]] = {  # with the least and largest number of values
    **{name: (function, 1, 1) for name, function in _ROUND.items()},
    "atan2": (math.atan2, 2, 2),
    "sqrt": (math.sqrt, 1, 1),
    "exp": (math.exp, 1, 1),
    "abs": (abs, 1, 1),
    "min": (partial(_choose, min), 2, 20),
    "max": (partial(_choose, max), 2, 20),
    "interpolate": (_interpolate, 5, 41),
}
RESERVED_NAMES = (*_FUNCTIONS, "pi")
_OF_VECTORS: dict[str, tuple[Callable, int, int]] = {  # which names may be called, too
    "cross": (_cross, 2, 2),
    "dot": (_dot, 2, 2),
    "norm": (lambda vector: math.hypot(*vector), 1, 1),
    "unit": (_unit, 1, 1),
    "rotate": (_rotate, 3, 3),
}
_CALLS = _FUNCTIONS | _OF_VECTORS
ALLOWED = f"numbers with units, names, [x, y, z], + - * / ** ( ), pi and {', '.join(_CALLS)}"

Value = float | np.ndarray
Evaluator = Callable[[Mapping[str, Value]], Value]
Measure = Callable[[Mapping[str, Dimension]], Dimension]


class ExpressionError(ValueError):
    """Raised for text that is not arithmetic, or without a finite value; its text says why."""


class Expression:
    """An arithmetic expression with units, parsed once; ExpressionError if `text` is none. names:
    set of those in it (`P.x`: a coordinate of P); dimension(names): its physical dimension from
    theirs; parts: functions of the names' values, inner ones first, for what operations and
    functions in it give, and the borders: differences that vanish where `min`, `max` and
    `interpolate` bend."""

    def __init__(self, text: str):
        self.text = text
        self.names: set[str] = set()
        self.constants: dict[str, tuple[float, Unit]] = {}
        self.parts: list[Evaluator] = []
        self.borders: list[Evaluator] = []
        self._divisors: set[str] = set()  # those right behind a slash, but for rad
        if len(text) > LONGEST:
            raise ExpressionError(f"longer than {LONGEST} characters; allowed: several under `let`")
        try:
            tree = ast.parse(_SUFFIX.sub(self._quantity, text).strip(), mode="eval").body
            self._value, self.dimension = self._compile(tree)
            self._tree = tree
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            if isinstance(error, ExpressionError):
                raise
            raise ExpressionError(_fault(text)) from None

    @cached_property
    def bare(self) -> bool:
        """Whether the expression is made of plain numbers only, without names and units."""
        return not self.names and self.dimension({}).bare

    def value(self, names: Mapping[str, Value]) -> Any:
        """Return the value of the expression in SI units, of vectors an array (3,). names: value in
        SI units of each name in it. ExpressionError if the result is not finite."""
        try:
            number = self._value(names)
            number = number if isinstance(number, np.ndarray) else float(number)
        except ExpressionError:
            raise
        except (ArithmeticError, ValueError):
            number = math.nan
        parts = number.tolist() if isinstance(number, np.ndarray) else (number,)
        if not all(map(math.isfinite, parts)):
            raise ExpressionError("no finite number")
        return number

    def range(self, names: Mapping[str, Range]) -> Range:
        """Return limits (least, largest) of the value in SI units, infinite where none is known,
        from those of each name."""
        constants = {name: (value, value) for name, (value, _) in self.constants.items()}
        try:
            return range_of(self._tree, {**names, **constants, "pi": (math.pi, math.pi)})
        except ArithmeticError:  # too large
            return ALL

    def _quantity(self, match: re.Match) -> str:
        """A name for a number with a unit, which what stands beside it must leave together."""
        name = f"_{len(self.constants)}_"
        prefix, suffix = match["before"] or "", match["after"] or ""
        number, chain = match["number"], match["unit"]
        if suffix:
            raise ExpressionError(
                f"{number} {chain}**: a power right after a unit could be of the number, too; "
                f"allowed: a power of the unit alone as in 3 m2, or brackets as in (3 m)**2"
            )
        if prefix.startswith("**"):
            raise ExpressionError(f"**{number} {chain}: an exponent is a number without unit")
        chain_unit = unit(chain)
        self.constants[name] = chain_unit.si(float(number)), chain_unit
        if prefix and chain_unit.si(1.0) != 1.0:
            self._divisors.add(name)
        return f"{prefix} {name} "

    # -- from a tree to functions of the names ------------------------------------------------

    def _compile(self, node: ast.AST) -> tuple[Evaluator, Measure]:
        evaluator, measure = self._compile_node(node)
        if isinstance(node, ast.BinOp | ast.Call):
            self.parts.append(evaluator)
        return evaluator, measure

    def _compile_node(self, node: ast.AST) -> tuple[Evaluator, Measure]:
        match node:
            case ast.Constant(value=number) if type(number) in (int, float):
                constant = float(str(number))  # infinite where an integer has too many digits
                return (lambda names: constant), (lambda names: BARE)
            case ast.Name() | ast.Attribute():
                return self._name(_join_names(node))
            case ast.UnaryOp(op=op, operand=operand) if type(op) in _OPERATORS:
                sign, (u, measure) = _OPERATORS[type(op)], self._compile(operand)
                return (lambda names: sign(u(names))), measure
            case ast.BinOp(left=lhs, op=op, right=right) if type(op) in _OPERATORS:
                join, sides = _OPERATORS[type(op)], (self._compile(lhs), self._compile(right))
                (u, first), (w, second) = sides
                measure = self._combine(op, right, w)
                return (
                    lambda names: join(u(names), w(names)),
                    lambda names: measure(first(names), second(names)),
                )
            case ast.List(elts=args):
                if len(args) != 3:
                    raise ExpressionError(f"[...] of {len(args)}; allowed: a vector [x, y, z]")
                (x, y, z), measures = zip(*map(self._compile, args), strict=True)
                return (
                    lambda names: np.array([x(names), y(names), z(names)]),
                    lambda names: _vector_dimension([measure(names) for measure in measures]),
                )
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in _CALLS:
                function, least, most = _CALLS[name]
                if name == "interpolate" and len(args) % 2 == 0:
                    raise ExpressionError(f"{name} takes a value, and two for each point")
                if not least <= len(args) <= most:
                    count = f"{least}" if least == most else f"{least} or more"
                    plural = "s" if most > 1 else ""
                    raise ExpressionError(f"{name} takes {count} value{plural}, not {len(args)}")
                values, measures = zip(*map(self._compile, args), strict=True)
                zero = isinstance(args[-1], ast.Constant) and args[-1].value == 0
                if name in ("min", "max", "interpolate"):
                    pairs = list(combinations(values, 2))
                    if name == "interpolate":
                        pairs = [(values[0], place) for place in values[1::2]]
                    borders = [
                        partial(lambda a, b, names: a(names) - b(names), *pair) for pair in pairs
                    ]
                    self.borders += borders
                    self.parts += borders
                return (
                    lambda names: function(*[value(names) for value in values]),
                    lambda names: _call_dimension(
                        name, [measure(names) for measure in measures], zero
                    ),
                )
        raise ExpressionError(f"not arithmetic{number_hint(self.text) or f'; allowed: {ALLOWED}'}")

    def _name(self, name: str) -> tuple[Evaluator, Measure]:
        if name == "pi" or name in self.constants:
            value, constant_unit = self.constants.get(name, (math.pi, None))
            dimension = constant_unit.dimension if constant_unit else NUMBER
            return (lambda names: value), (lambda names: names.get(name, dimension))
        if name.startswith("_") or name in _FUNCTIONS:
            raise ExpressionError(f"{name} is not a value; allowed: {ALLOWED}")
        self.names.add(name)
        return operator.itemgetter(name), operator.itemgetter(name)

    def _combine(self, op: ast.AST, right: ast.AST, value: Evaluator) -> Callable[..., Dimension]:
        """Return the dimension of two values joined, from theirs; value: of the right one."""
        has_name = any(isinstance(part, ast.Name | ast.Attribute) for part in ast.walk(right))
        divisor = right.operand if isinstance(right, ast.UnaryOp) else right
        is_guess = isinstance(divisor, ast.Name) and divisor.id in self._divisors
        match op:
            case ast.Mult():
                return _product
            case ast.Div():
                return lambda u, w: _quotient(u, w, is_guess)
            case ast.Pow():
                return lambda u, w: _power(u, w, None if has_name else value)
        verb = "added" if isinstance(op, ast.Add) else "subtracted"
        return lambda u, w: _common_dimension((u, w), verb)


def _product(first: Dimension, second: Dimension) -> Dimension:
    if first.vector and second.vector:
        raise ExpressionError("two vectors cannot be multiplied; allowed: dot(a, b), cross(a, b)")
    return product(first, second)


def _quotient(first: Dimension, second: Dimension, guess: bool) -> Dimension:
    """Refuse `1/2 deg`, meant as half a degree: other units show by what they are behind."""
    if second.vector:
        raise ExpressionError("nothing can be divided by a vector; allowed: by its norm(v)")
    if guess and first.bare and not any(second.powers):
        raise ExpressionError(
            "a plain number over an angle could be meant as a fraction of its unit; allowed: "
            "brackets as in (1/2)*(1 deg), a decimal as in 0.5 deg, 1/(2 deg)"
        )
    return product(first, second, -1)


def _power(base: Dimension, exponent: Dimension, value: Evaluator | None) -> Dimension:
    if base.vector:
        raise ExpressionError("a vector has no power; allowed: dot(v, v), norm(v)**2")
    if any(exponent.powers) or exponent.vector:
        raise ExpressionError(f"an exponent is a number, not {exponent}")
    if not any(base.powers):
        return base if exponent.bare else NUMBER
    if value is None:
        raise ExpressionError(f"a power of {base} takes a plain number as exponent")
    try:
        return power(base, float(value({})))
    except (ArithmeticError, ValueError):
        raise ExpressionError("an exponent is not a finite number") from None


def _call_dimension(name: str, values: list[Dimension], zero: bool) -> Dimension:
    """Return the dimension of a function's value; zero: its last argument is plainly 0."""
    if name in _OF_VECTORS:
        return _of_vectors(name, values, zero)
    if vector := next((value for value in values if value.vector), None):
        remedy = "; allowed: norm(v), the length of a vector" if name == "abs" else ""
        raise ExpressionError(f"{name} takes numbers, not {vector}{remedy}")
    if name in ("abs", "min", "max"):
        return _common_dimension(values, f"values of one {name}")
    if name == "interpolate":
        _common_dimension([values[0], *values[1::2]], f"places of one {name}")
        return _common_dimension(values[2::2], f"values of one {name}")
    if name == "sqrt":
        return power(values[0], 0.5)
    if name == "atan2":
        _common_dimension(values, "values of one atan2")
    elif any(values[0].powers):
        raise ExpressionError(f"{name} takes {NUMBER}, not {values[0]}")
    elif name in _ANGULAR and values[0].bare and not zero:
        raise ExpressionError(f"{name} takes an angle with a unit, such as 45 deg or 0.5 rad")
    return NUMBER


def _of_vectors(name: str, values: list[Dimension], zero: bool) -> Dimension:
    """Return the dimension of what a function makes of vectors, and of the angle behind them."""
    if number := next((value for value in values[:2] if not value.vector), None):
        raise ExpressionError(f"{name} takes vectors such as [x, y, z] or Q - P, not {number}")
    if name == "rotate" and (any(values[2][:3]) or values[2].vector or values[2].bare > zero):
        raise ExpressionError("rotate turns by an angle with a unit, such as 45 deg or 0.5 rad")
    if name in ("cross", "dot"):
        return product(values[0], values[1])._replace(vector=name == "cross")
    powers = NUMBER if name == "unit" else values[0]
    return powers._replace(vector=name != "norm")


def _vector_dimension(values: list[Dimension]) -> Dimension:
    """Return the dimension of a vector of three numbers; plain ones are in SI units."""
    if vector := next((value for value in values if value.vector), None):
        raise ExpressionError(f"a vector [x, y, z] is of numbers, not of {vector}")
    numbers = [value for value in values if not value.bare] or values
    return _common_dimension(numbers, "in one vector")._replace(vector=True)


def _common_dimension(values: Sequence[Dimension], verb: str) -> Dimension:
    """Return the dimension that all have; a bare number goes with numbers only."""
    if len({(*dimension.powers, dimension.vector) for dimension in values}) > 1:
        raise ExpressionError(f"{' and '.join(sorted({str(d) for d in values}))} cannot be {verb}")
    return min(values, key=lambda dimension: dimension.bare)


_NUMBER_AND_WORD = re.compile(r"(?<![\w.])([\d.]+(?:[eE][-+]?\d+)?)(\s*)([A-Za-z_]\w*)")


def _fault(text: str) -> str:
    """Say why a text is not arithmetic, and what may be meant."""
    if hint := number_hint(text):
        return f"not arithmetic{hint}"
    if text.count("(") != text.count(")"):
        sign = ")" if text.count("(") > text.count(")") else "("
        remedy = "put an expression with a comma into quotes or under `let`"
        return f"not arithmetic (a bracket {sign} is missing; {remedy})"
    if match := _NUMBER_AND_WORD.search(text):
        try:
            unit(match[3])
        except UnitError as error:
            if match[2] or "did you mean" in str(error):
                return str(error)
            return f"not arithmetic (did you mean {match[1]}*{match[3]}?)"
    return f"not arithmetic; allowed: {ALLOWED}"


def _join_names(node: ast.AST) -> str:
    """`bay1.P.x` of names joined by points."""
    parts = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    if not isinstance(node, ast.Name):
        raise ExpressionError(f"not arithmetic; allowed: {ALLOWED}")
    return ".".join([node.id, *reversed(parts)])


@lru_cache(maxsize=10_000)
def parse(text: str) -> Expression:
    """Return the expression of a text, cached; ExpressionError if it is not arithmetic."""
    return Expression(text)
