"""Arithmetic on names, numbers and units, and nothing else.

A text is parsed by Python's own grammar, its tree is checked against a list of what is allowed, and
turned into a chain of functions: nothing is ever handed to `eval`. Values are single numbers; a
batch is evaluated sample by sample, so that a sample's last digits do not depend on its neighbours
(the vector units of a processor round a sine differently from its scalar ones), and since it takes
less than a hundredth of the time that building the sample's particles does.
"""

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache

from fpm.structures.units import BARE, CHAIN, NUMBER, Dimension, power, product, unit

LONGEST = 500
"""Characters of an expression."""

_SUFFIXED = re.compile(
    rf"(?P<before>(?:\*\*|/)\s*[-+]?\s*)?(?<![\w.])"
    rf"(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(?P<unit>{CHAIN})(?P<after>\s*\*\*)?"
)
_OPERATORS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: math.pow,
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
}
_FUNCTIONS: dict[str, tuple[Callable, int, int]] = {  # with the least and largest number of values
    "sin": (math.sin, 1, 1),
    "cos": (math.cos, 1, 1),
    "tan": (math.tan, 1, 1),
    "asin": (math.asin, 1, 1),
    "acos": (math.acos, 1, 1),
    "atan": (math.atan, 1, 1),
    "atan2": (math.atan2, 2, 2),
    "sqrt": (math.sqrt, 1, 1),
    "abs": (abs, 1, 1),
    "min": (min, 2, 20),
    "max": (max, 2, 20),
}
RESERVED = (*_FUNCTIONS, "pi")
ALLOWED = f"numbers with units, names, + - * / ** ( ), pi and {', '.join(_FUNCTIONS)}"


class ExpressionError(ValueError):
    """An expression that is no arithmetic, or has no value; the text says why."""


class Expression:
    """Arithmetic, read once.

    names: what it refers to, points' coordinates as `P.x`. ExpressionError for anything else.
    """

    def __init__(self, text: str):
        self.text = text
        self.names: set[str] = set()
        self._quantities: dict[str, tuple[float, Dimension]] = {}
        self._divisors: set[str] = set()  # those right behind a slash, but for rad
        if len(text) > LONGEST:
            raise ExpressionError(f"longer than {LONGEST} characters; allowed: several under `let`")
        try:
            tree = ast.parse(_SUFFIXED.sub(self._quantity, text).strip(), mode="eval").body
            self._tree, self._function = tree, self._compile(tree)
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            if isinstance(error, ExpressionError):
                raise
            hint = ""
            if text.count("(") != text.count(")"):
                hint = "; in brackets, put an expression with a comma into quotes or under `let`"
            raise ExpressionError(f"not arithmetic; allowed: {ALLOWED}{hint}") from None

    @cached_property
    def bare(self) -> bool:
        """Whether it is made of plain numbers only."""
        return not self.names and self.dimension({}).bare

    def dimension(self, names: Mapping[str, Dimension]) -> Dimension:
        """The dimension of the value, from those of the names; ExpressionError where they clash."""
        return self._measure(self._tree, names)

    def value(self, names: Mapping[str, float]) -> float:
        """The value in SI units; ExpressionError if it is no finite number."""
        try:
            found = float(self._function(names))
        except (ArithmeticError, ValueError):
            found = math.nan
        if not math.isfinite(found):
            raise ExpressionError("no finite number")
        return found

    def _quantity(self, found: re.Match) -> str:
        """A name for a number with a unit, which what stands beside it must leave together."""
        name = f"_{len(self._quantities)}_"
        before, after = found["before"] or "", found["after"] or ""
        number, chain = found["number"], found["unit"]
        if after:
            raise ExpressionError(
                f"{number} {chain}**: a power right after a unit could be of the number, too; "
                f"allowed: a power of the unit alone as in 3 m2, or brackets as in (3 m)**2"
            )
        if before.startswith("**"):
            raise ExpressionError(f"**{number} {chain}: an exponent is a number without unit")
        measured = unit(chain)
        self._quantities[name] = measured.si(float(number)), measured.dimension
        if before and measured.si(1.0) != 1.0:
            self._divisors.add(name)
        return f"{before} {name} "

    # -- from a tree to functions -------------------------------------------------------------

    def _compile(self, node: ast.AST) -> Callable[[Mapping[str, float]], float]:
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            try:
                value = float(node.value)
            except OverflowError:  # an integer of more than 308 digits
                value = math.inf
            return lambda names: value
        if isinstance(node, ast.Name | ast.Attribute):
            return self._compile_name(_dotted(node))
        if isinstance(node, ast.UnaryOp) and type(node.op) in _OPERATORS:
            sign, one = _OPERATORS[type(node.op)], self._compile(node.operand)
            return lambda names: sign(one(names))
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            join = _OPERATORS[type(node.op)]
            one, two = self._compile(node.left), self._compile(node.right)
            return lambda names: join(one(names), two(names))
        if isinstance(node, ast.Call):
            function, values = self._called(node), [self._compile(a) for a in node.args]
            return lambda names: function(*[value(names) for value in values])
        raise ExpressionError(f"not arithmetic; allowed: {ALLOWED}")

    def _compile_name(self, name: str) -> Callable[[Mapping[str, float]], float]:
        if name == "pi":
            return lambda names: math.pi
        if name in self._quantities:
            value = self._quantities[name][0]
            return lambda names: value
        if name.startswith("_") or name in _FUNCTIONS:
            raise ExpressionError(f"{name} is not a value; allowed: {ALLOWED}")
        self.names.add(name)
        return operator.itemgetter(name)

    def _called(self, node: ast.Call) -> Callable:
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name not in _FUNCTIONS or node.keywords:
            raise ExpressionError(f"not arithmetic; allowed: {ALLOWED}")
        function, least, most = _FUNCTIONS[name]
        if not least <= len(node.args) <= most:
            raise ExpressionError(
                f"{name} takes {least if least == most else f'{least} or more'} "
                f"value{'s' if most > 1 else ''}, not {len(node.args)}"
            )
        return function

    # -- dimensions ---------------------------------------------------------------------------

    def _measure(self, node: ast.AST, names: Mapping[str, Dimension]) -> Dimension:
        if isinstance(node, ast.Constant):
            return BARE
        if isinstance(node, ast.Name | ast.Attribute):
            name = _dotted(node)
            if name == "pi":
                return NUMBER
            return self._quantities[name][1] if name in self._quantities else names[name]
        if isinstance(node, ast.UnaryOp):
            return self._measure(node.operand, names)
        if isinstance(node, ast.Call):
            return self._measure_call(node, names)
        one = self._measure(node.left, names)
        if isinstance(node.op, ast.Pow):
            return self._measure_power(node.right, one, names)
        two = self._measure(node.right, names)
        if isinstance(node.op, ast.Div):
            self._check_quotient(node.right, one, two)
        if isinstance(node.op, ast.Mult | ast.Div):
            return product(one, two, 1 if isinstance(node.op, ast.Mult) else -1)
        return _same((one, two), "added" if isinstance(node.op, ast.Add) else "subtracted")

    def _check_quotient(self, node: ast.AST, one: Dimension, two: Dimension) -> None:
        """Refuse `1/2 deg`, meant as half a degree: other units show by what they are behind."""
        if isinstance(node, ast.UnaryOp):
            node = node.operand
        divides = isinstance(node, ast.Name) and node.id in self._divisors
        if divides and one.bare and not any(two.powers):
            raise ExpressionError(
                "a plain number over an angle could be meant as a fraction of its unit; allowed: "
                "brackets as in (1/2)*(1 deg), a decimal as in 0.5 deg, 1/(2 deg)"
            )

    def _measure_call(self, node: ast.Call, names: Mapping[str, Dimension]) -> Dimension:
        name = node.func.id
        found = [self._measure(argument, names) for argument in node.args]
        if name in ("abs", "min", "max"):
            return _same(found, f"values of one {name}")
        if name == "sqrt":
            return power(found[0], 0.5)
        if name == "atan2":
            _same(found, "values of one atan2")
        elif any(found[0].powers):
            raise ExpressionError(f"{name} takes {NUMBER}, not {found[0]}")
        elif name in ("sin", "cos", "tan") and found[0].bare and not _is_zero(node.args[0]):
            raise ExpressionError(f"{name} takes an angle with a unit, such as 45 deg or 0.5 rad")
        return NUMBER

    def _measure_power(self, node: ast.AST, base: Dimension, names: Mapping) -> Dimension:
        exponent = self._measure(node, names)
        if any(exponent.powers):
            raise ExpressionError(f"an exponent is a number, not {exponent}")
        if not any(base.powers):
            return base if exponent.bare else NUMBER
        if any(isinstance(part, ast.Name | ast.Attribute) for part in ast.walk(node)):
            raise ExpressionError(f"a power of {base} takes a plain number as exponent")
        try:
            return power(base, float(self._compile(node)({})))
        except (ArithmeticError, ValueError):
            raise ExpressionError("an exponent is no finite number") from None


@lru_cache(maxsize=10_000)
def parse(text: str) -> Expression:
    """The expression of a text, read once however often it occurs."""
    return Expression(text)


def _dotted(node: ast.AST) -> str:
    """`bay1.P.x` of names joined by points."""
    parts = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    if not isinstance(node, ast.Name):
        raise ExpressionError(f"not arithmetic; allowed: {ALLOWED}")
    return ".".join([node.id, *reversed(parts)])


def _same(found: list[Dimension], what: str) -> Dimension:
    """The dimension that all have; a bare number goes with numbers only."""
    kinds = {one.powers for one in found}
    if len(kinds) > 1:
        raise ExpressionError(f"{' and '.join(sorted({str(d) for d in found}))} cannot be {what}")
    return min(found, key=lambda one: one.bare)


def _is_zero(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and node.value == 0
