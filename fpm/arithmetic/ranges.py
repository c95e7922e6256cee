"""Ranges of values: what arithmetic gives if each name may have any value between two limits."""

import ast
import itertools
import math
from collections.abc import Callable, Mapping

Range = tuple[float, float]
ALL: Range = (-math.inf, math.inf)
_MONOTONE: dict[str, Callable] = {"sqrt": lambda x: math.sqrt(max(x, 0.0)), "exp": math.exp}


def range_of(node: ast.AST, names: Mapping[str, Range]) -> Range:
    """Return limits (least, largest) of the value of an expression's tree, from those of its names;
    infinite where nothing is known. Names of equal limits are constants; others may be missing in
    `min` and `max`."""
    match node:
        case ast.Constant(value=int() | float() as number):
            return float(number), float(number)
        case ast.Name(id=name):
            return names.get(name, ALL)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            low, high = range_of(operand, names)
            return -high, -low
        case ast.BinOp(left=first, op=op, right=second):
            return _join(op, range_of(first, names), range_of(second, names))
        case ast.Call(func=ast.Name(id=name), args=args):
            return _call(name, [range_of(arg, names) for arg in args])
    return ALL


def _join(op: ast.AST, first: Range, second: Range) -> Range:
    (a, b), (c, d) = first, second
    match op:
        case ast.Add():
            return a + c, b + d
        case ast.Sub():
            return a - d, b - c
        case ast.Div() if c >= 0 or d <= 0:
            return _join(ast.Mult(), first, (1 / d if d else -math.inf, 1 / c if c else math.inf))
        case ast.Mult():
            products = [x * y if x and y else 0.0 for x, y in itertools.product(first, second)]
            return min(products), max(products)
        case ast.Pow() if c == d and c > 0 and (a >= 0 or c % 2 == 0):
            least, largest = _call("abs", [first])
            return least**c, largest**c
    return ALL


def _call(name: str, ranges: list[Range]) -> Range:
    lows, highs = zip(*ranges, strict=True)
    constants = [low for low, high in ranges if low == high]
    if name == "min":
        return min(lows), min([max(highs), *constants])
    if name == "max":
        return max([min(lows), *constants]), max(highs)
    if name == "abs":
        return max(lows[0], -highs[0], 0.0), max(-lows[0], highs[0])
    if function := _MONOTONE.get(name):
        return function(lows[0]), function(highs[0])
    return (-1.0, 1.0) if name in ("sin", "cos") else ALL
