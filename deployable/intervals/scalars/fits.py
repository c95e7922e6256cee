"""What is fitted to a number of runs: the polynomial or spline that predicts left-out runs best.

Every run is left out in turn, without a second fit: for least squares its error is e / (1 - h), h
the leverage (Allen 1974, the PRESS statistic); for a spline see `splines`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import comb
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from ..box import FEW_PARAMETERS, MOST_FULL, ROUNDING, is_general, keys
from ..chebyshev import Formula, Surrogate, least_squares, polynomial, product_basis, total_degree
from ..errors import IntervalError
from ..estimates import power_mean
from ..spline_equations import distinct, in_blocks, remember, remember_latest, stands_alone
from ..splines import MAX_RUNS, Spline, check_spline_runs, fit_spline

if TYPE_CHECKING:
    from .occurrence import Occurrence

_LEAST_RUNS = 4  # below them one more coordinate is not tested
_HIGHEST = 12  # degree of a polynomial
_RESIDUAL = 1e-3  # of the width, by which a polynomial may miss a run
_MAX_KRIGING_RUNS = 2000  # runs for which that is corrected
_MOST_TERMS, _FOLDS = 24, 5  # products and higher degrees of many parameters; folds to test them
_INDEPENDENT = 1.0  # least norm of a further term beyond those so far
_LEVERAGE = 1 - 1e-8  # above it a run alone decides a coefficient, and nothing tests it


@dataclass(frozen=True)
class Kriging:
    """A polynomial `trend` plus a correction through the runs at points (N, k) in [-1, 1]^k:
    kriging of the residuals with covariance exp(-distance / length), whose extreme values are at
    runs, so that noise does not swing beyond. weights (N, 1): of the runs; length: normalized."""

    trend: Surrogate
    points: np.ndarray
    weights: np.ndarray
    length: float

    def evaluate(self, points: np.ndarray) -> np.ndarray:
        """Values (P, 1) of the corrected polynomial at `points` (P, k) in [-1, 1]^k."""
        count = len(self.points)
        rest = in_blocks(
            lambda x: _decay(x, self.points, self.length) @ self.weights, points, count
        )
        return self.trend.evaluate(points) + rest

    def formula(self) -> Formula:
        """Write the corrected polynomial as a table that other programs can evaluate."""
        scales = np.full(self.points.shape[1], 1 / self.length)
        formula, weights = polynomial(self.trend), self.weights[:, 0]
        return replace(formula, kernel="fading", points=self.points, scales=scales, weights=weights)


@dataclass(frozen=True)
class RootFunction:
    """A time (or another value) of an event as a function of the k normalized parameters and of the
    root of a decision function, which is above 0 where the event occurs and 0 on the border of that
    part of the box: near the border the time goes like a root. function: of k + 1 coordinates, the
    last one 2 sqrt(decision / scale) - 1; border: gives the decision function (P) at points (P, k);
    scale: largest decision value of a run."""

    function: Surrogate | Spline | Kriging
    border: Occurrence
    scale: float

    def evaluate(self, points: np.ndarray) -> np.ndarray:
        """Values (P, 1) of the function at points `points` (P, k) in [-1, 1]^k, with its own
        decision values; those below 0 count as 0."""
        roots = root_coordinates(self.border.decision(points), self.scale)
        return self.function.evaluate(np.column_stack([points, roots]))

    @property
    def trend(self) -> RootFunction:
        """Copy without the kriging correction, which makes a polynomial pass through every run, to
        compare parts of the box with each other; itself where there is none."""
        function = getattr(self.function, "trend", self.function)
        return self if function is self.function else replace(self, function=function)

    def formula(self) -> Formula:
        """Write the function of parameters alone as a table that other programs can evaluate."""
        return replace(_formula(self.function), root=self.border.formula(), root_scale=self.scale)


def root_coordinates(margins: np.ndarray, scale: float) -> np.ndarray:
    """Map event margins (P), which are above 0 where an event occurs, to coordinates (P) in [-1,
    1], 2 sqrt(margin / scale) - 1: -1 at margins up to 0, 1 from `scale` (in their unit) on."""
    return 2.0 * np.sqrt(np.clip(margins / scale, 0.0, 1.0)) - 1.0


def root_fit(points: np.ndarray, values: np.ndarray, border: Occurrence) -> Fit | None:
    """Fit values (N) of runs at `points` (N, k) in [-1, 1]^k as a function of the points and of the
    roots of event margins, above 0 where an event occurs: a `Fit` of a `RootFunction`; None where
    no margin is positive, or for at most 4 runs. border: of the event, whose decision function
    gives the margin at any points. Leave-one-out errors include those of the margins."""
    margins = border.run_margins(points)[0]
    scale = float(margins.max(initial=0.0))
    if not scale > 0 or len(values) <= _LEAST_RUNS:
        return None
    fit = choose_fit(np.column_stack([points, root_coordinates(margins, scale)]), values)

    def add_root(fit: Fit | None) -> Fit | None:
        if fit is None:
            return None
        kind, x = f"{fit.kind}, with a root at its border", fit.points[:, :-1]
        function: Any = fit.function
        roots = root_coordinates(border.run_margins(x)[1], scale)
        drift = fit.evaluate(fit.points) - fit.evaluate(np.column_stack([x, roots]))
        return Fit(x, fit.values, fit.left_out + drift, kind,
                   RootFunction(function, border, scale), add_root(fit.rival))  # fmt: skip

    return add_root(fit)


def _decay(x: np.ndarray, points: np.ndarray, length: float) -> np.ndarray:
    return np.exp(-scipy.spatial.distance.cdist(x, points) / length)


@dataclass(frozen=True)
class Fit:
    """A function fitted to the values (N) of runs at `points` (N, k) in [-1, 1]^k. left_out (N):
    leave-one-out errors, the value of each run less that of the function fitted to all others,
    infinite for a run that no others predict; kind: its type in words; function: returns (P, 1);
    alternative: the best fit of the other kind, polynomial or spline, if there is one."""

    points: np.ndarray
    values: np.ndarray
    left_out: np.ndarray
    kind: str
    function: Surrogate | Spline | Kriging | RootFunction
    alternative: Fit | None = None

    @cached_property
    def rival(self) -> Fit | None:
        """The alternative with a correction through the runs, whose difference from this fit tells
        what the choice between them decides; None without one that runs test."""
        fit = self.alternative
        if fit is None or not np.isfinite(fit.mean_error):
            return None
        return _through_runs(fit) if isinstance(fit.function, Surrogate) else fit

    @property
    def error(self) -> float:
        """Estimated error: the largest leave-one-out error; infinite where no run tests it."""
        return float(np.abs(self.left_out).max(initial=0.0))

    @property
    def usual_error(self) -> float:
        """Estimated error, in the unit of the values, near the bounds where runs were sampled
        adaptively: a mean of the sizes of the leave-one-out errors, the largest in more than 3
        directions (`estimates.power_mean`). For other runs see `error`."""
        return float(power_mean(self.left_out, int((np.ptp(self.points, axis=0) > 0).sum())))

    @property
    def trend(self) -> Fit:
        """Copy without the kriging correction, which makes a polynomial pass through every run, to
        compare parts of the box with each other; the fit itself where there is none."""
        function = getattr(self.function, "trend", self.function)
        return self if function is self.function else replace(self, function=function)

    @remember_latest
    def evaluate(self, points: np.ndarray) -> np.ndarray:
        """Values (P) of the function at `points` (P, k) in [-1, 1]^k."""
        return self.function.evaluate(points)[:, 0]

    def evaluate_border(self, points: np.ndarray) -> np.ndarray:
        """Values (P) that the function has at `points` (P, k) in [-1, 1]^k if the border of where
        the event occurs passes there; those of `evaluate` unless it is a `RootFunction`."""
        if not isinstance(self.function, RootFunction):
            return self.evaluate(points)
        return self.function.function.evaluate(np.insert(points, points.shape[1], -1.0, axis=1))[
            :, 0
        ]

    @property
    def mean_error(self) -> float:
        """Root mean square of the leave-one-out errors."""
        return float(np.sqrt(np.mean(self.left_out**2)))

    def usual_errors(self, points: np.ndarray) -> np.ndarray:
        """Errors (P) at `points` (P, k) in [-1, 1]^k by which volume fractions of the box are
        uncertain: the root mean square of the leave-one-out errors of the runs near by, or the
        median size of all if larger. Along a limit-state surface errors of both signs cancel, so
        that the largest tells too much; beside a kink or jump the median of those near by, of which
        some lie on its other side, too little. Runs next to which others were made are predicted
        better than the rest of the box, and do not count, as long as others do. In many directions
        runs that vary one or two parameters, as those of grids, do not either."""
        tree, sizes = self._lone_runs
        count = min(2 * int((np.ptp(self.points, axis=0) > 0).sum()) + 3, len(sizes))
        rows = tree.query(points, count)[1].reshape(len(points), count)
        return np.maximum(np.sqrt(np.mean(sizes[rows] ** 2, axis=1)), np.median(sizes))

    @cached_property
    def _lone_runs(self) -> tuple[scipy.spatial.KDTree, np.ndarray]:
        """Runs that stand alone, as a tree, and the sizes of their leave-one-out errors."""
        is_lone, least = stands_alone(self.points), 2 * self.points.shape[1] + 3
        masks = [is_lone & is_general(self.points), is_lone]
        masks = [mask for mask in masks if mask.sum() >= least]
        rows = np.flatnonzero(masks[0]) if masks else np.arange(len(self.points))
        return scipy.spatial.KDTree(self.points[rows]), np.abs(self.left_out[rows])

    def formula(self) -> Formula:
        """Write the fitted function as a table that other programs can evaluate."""
        return _formula(self.function)


def _formula(function: Surrogate | Spline | Kriging | RootFunction) -> Formula:
    return polynomial(function) if isinstance(function, Surrogate) else function.formula()


def level(values: np.ndarray) -> np.ndarray:
    """Values (N) of runs, NaN where a run has none, all as their mean if only rounding varies."""
    numbers = values[np.isfinite(values)]
    varies = np.ptp(numbers) > ROUNDING * np.abs(numbers).max() if len(numbers) else True
    return values if varies else np.where(np.isfinite(values), numbers.mean(), np.nan)


@remember
def choose_fit(points: np.ndarray, values: np.ndarray) -> Fit:
    """Fit the function with the least leave-one-out errors (root mean square) to values (N) of runs
    at `points` (N, k) in [-1, 1]^k; IntervalError without values, or if one is not finite. Tried
    are polynomials by least squares, of every total degree that the runs can test, and the spline
    through all runs; a polynomial that misses runs gets a correction through them (`Kriging`). Runs
    that are nearly the same count once."""
    points, values = np.asarray(points, dtype=float), np.asarray(values, dtype=float)
    if not len(values) or not np.isfinite(values).all():
        raise IntervalError("values", "none or not finite", "a finite number for at least one run")
    rows = distinct(points)
    points, values = points[rows], level(values[rows])
    directions = (np.ptp(points, axis=0) > 0).sum()
    spline = None if directions > MOST_FULL else _spline(points, values)
    sparse = _sparse(points, values) if directions > FEW_PARAMETERS else None
    fits = [fit for fit in (*_polynomials(points, values), spline, sparse) if fit]
    best = min(fits, key=lambda fit: fit.mean_error)
    rivals = [fit for fit in fits if (fit is spline) != (best is spline)]
    best = replace(best, alternative=min(rivals, key=lambda fit: fit.mean_error, default=None))
    return best if isinstance(best.function, Spline) else _through_runs(best)


def _through_runs(fit: Fit) -> Fit:
    """Add a correction through the runs to a polynomial, if it misses them by enough."""
    points, rest = fit.points, fit.values - fit.evaluate(fit.points)
    correctable = len(points) <= _MAX_KRIGING_RUNS
    if not correctable or np.abs(rest).max() <= _RESIDUAL * np.ptp(fit.values):
        return fit
    directions = max(int((np.ptp(points, axis=0) > 0).sum()), 1)
    length = 2.0 * len(points) ** (-1.0 / directions)  # about how far apart runs are
    weights = np.linalg.solve(_decay(points, points, length), rest[:, None])
    trend: Any = fit.function
    return replace(fit, function=Kriging(trend, points, weights, length))


def _polynomials(points: np.ndarray, values: np.ndarray) -> list[Fit]:
    """Polynomials of every total degree that leaves runs to test them, the constant among them."""
    free = np.ptp(points, axis=0) > 0
    fits = []
    for degree in range(_HIGHEST + 1):
        terms = comb(degree + int(free.sum()), degree)
        if degree and (not free.any() or terms >= len(points)):
            break
        indices = total_degree(np.where(free, degree, 0))
        basis = product_basis(points, indices)
        if (solution := least_squares(basis, values, 1e-9)) is None:
            break
        coefficients, leverage = solution
        is_tested = leverage < _LEVERAGE
        rest = values - basis @ coefficients
        left_out = np.where(is_tested, rest / np.where(is_tested, 1 - leverage, 1.0), np.inf)
        if len(points) == 1 and not free.any():
            left_out = np.zeros(1)  # a box without width has one run, and nothing to be tested
        kind = f"polynomial of degree {degree}"
        fits.append(Fit(points, values, left_out, kind, Surrogate(coefficients[:, None], indices)))
    return fits


def _sparse(points: np.ndarray, values: np.ndarray) -> Fit | None:
    """Fit a sum of quadratic polynomials of one parameter each, with the products of two parameters
    and the higher degrees that the residuals suggest (`_pursue`). Their number is the one that
    predicts folds of runs best. Each run is left out together with the run at the opposite point,
    which has the same products."""
    axes = np.eye(points.shape[1], dtype=int)[np.ptp(points, axis=0) > 0]
    first, second = np.triu_indices(len(axes), 1)
    groups = [0 * axes[:1], axes, 2 * axes, axes[first] + axes[second], 3 * axes, 4 * axes]
    indices, count = np.concatenate(groups), 2 * len(axes) + 1
    columns = product_basis(points, indices)
    if len(points) <= count or least_squares(columns[:, :count], values, 1e-9) is None:
        return None
    rows = {key: row for row, key in enumerate(keys(-points))}
    pairs = [min(row, rows.get(key, row)) for row, key in enumerate(keys(points))]
    folds = np.unique(pairs, return_inverse=True)[1] % _FOLDS
    folds[(points != 0).sum(axis=1) <= 1] = -1  # alone at the end of an interval: not left out
    errors = np.zeros((_MOST_TERMS + 1, len(points)))
    for fold in range(_FOLDS):
        is_fitted = folds != fold
        errors[:, ~is_fitted] = _pursue(columns, values, count, is_fitted)[0][:, ~is_fitted]
    number = int((errors**2).sum(axis=1).argmin())
    picks = _pursue(columns, values, count, folds < _FOLDS)[1][:number]
    terms = [*dict.fromkeys([*range(count), *picks])]
    solution: Any = least_squares(columns[:, terms], values, 0.0)
    coefficients, leverage = solution
    rest, spare = values - columns[:, terms] @ coefficients, 1 - leverage
    end_errors = np.where(spare > 1 - _LEVERAGE, rest / np.maximum(spare, 1 - _LEVERAGE), np.inf)
    left_out = np.where(folds < 0, end_errors, errors[number])
    function = Surrogate(coefficients[:, None], indices[terms])
    return Fit(points, values, left_out, "polynomial of each parameter and of pairs", function)


def _pursue(
    columns: np.ndarray, values: np.ndarray, count: int, is_fitted: np.ndarray
) -> tuple[np.ndarray, list[int]]:
    """Residuals (_MOST_TERMS + 1, N) of values (N) fitted by the first `count` of the `columns` (N,
    M) and 0, 1, 2, ... others, and which, by orthogonal matching pursuit (Pati et al. 1993).
    is_fitted (N): runs that are fitted."""
    root: Any = np.linalg.qr(columns[is_fitted, :count], mode="r")
    basis = np.linalg.lstsq(root.T, columns[:, :count].T, rcond=1e-9)[0].T
    rest = values - basis @ (basis[is_fitted].T @ values[is_fitted])
    columns = columns - basis @ (basis[is_fitted].T @ columns[is_fitted])
    path, picks = [rest], []
    while len(path) <= _MOST_TERMS:
        sizes = np.linalg.norm(columns[is_fitted], axis=0)
        sizes[sizes < _INDEPENDENT] = np.inf
        gains = np.abs(rest[is_fitted] @ columns[is_fitted]) / sizes
        picks.append(int(gains.argmax()))
        unit = columns[:, picks[-1]] / sizes[picks[-1]]
        rest = rest - unit * (unit[is_fitted] @ rest[is_fitted])
        columns = columns - unit[:, None] * (unit[is_fitted] @ columns[is_fitted])
        path.append(rest)
    return np.array(path), picks


def _spline(points: np.ndarray, values: np.ndarray) -> Fit | None:
    if len(points) == 1 or len(points) > MAX_RUNS:
        return None
    try:
        check_spline_runs(points)
        spline = fit_spline(points, values[:, None])
    except IntervalError:  # too few runs, or in one plane
        return None
    left_out = spline.left_out[:, 0]
    return Fit(spline.points, spline.values[:, 0], left_out, "spline through all runs", spline)
