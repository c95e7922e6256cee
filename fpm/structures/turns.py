"""Where expressions of a structure file bend or turn back as one parameter varies."""

from collections.abc import Callable

import numpy as np

MOST_VALUES, FINEST, COARSEST = 200_000, 1025, 65
"""Largest number of values of all expressions, and of values of the parameter, most and least."""

SHARP = 10.0
"""By how much the change of slope at a bend exceeds that of both sides."""

ROUNDING = 1e-9
"""Share of an expression's size below which a change is none."""


def find_turns(
    evaluate: Callable[[float], np.ndarray], count: int, lower: float, upper: float
) -> list[float]:
    """Return the values of a parameter between `lower` and `upper` at which any of m expressions
    has an extreme, then those at which the slope of one jumps (a knot of a table), each in order.
    evaluate: function of the parameter's value that returns those of the expressions (m,), NaN
    where there is none; count: m. A feature narrower than a thousandth of the interval is not seen,
    of more than 200 expressions one of up to a 65th."""
    from scipy.optimize import minimize_scalar

    if not count:
        return []
    grid = np.linspace(lower, upper, int(np.clip(MOST_VALUES // count, COARSEST, FINEST)))
    values = np.array([evaluate(x) for x in grid])
    extremes, bends = set(), set()
    for column, (series, size) in enumerate(zip(values.T, np.abs(values).max(axis=0), strict=True)):
        steps = np.diff(series)
        rows = np.flatnonzero(np.abs(steps) > ROUNDING * size)  # not where it is flat
        turns = np.flatnonzero(np.diff(np.sign(steps[rows])))
        for first, last in zip(rows[turns], rows[turns + 1] + 1, strict=True):
            sign, ends = -np.sign(steps[first]), grid[[first, last]]
            loss = lambda x, k=column, s=sign: s * evaluate(x)[k]  # noqa: E731
            options = {"xatol": 1e-9 * (upper - lower)}
            extremes.add(minimize_scalar(loss, bounds=ends, method="bounded", options=options).x)
        change = np.abs(np.diff(steps))
        sides = np.abs(change[:-4]) + np.abs(change[4:])
        sharp = change[2:-2] > SHARP * sides + ROUNDING * size
        bends |= set(grid[np.flatnonzero(sharp & ~np.append(False, sharp[:-1])) + 3])
    places: list[float] = []
    for x in map(float, [*sorted(extremes), *sorted(bends)]):
        if lower < x < upper and all(abs(x - y) > 2 * (grid[1] - grid[0]) for y in places):
            places.append(x)
    return places
