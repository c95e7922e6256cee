"""Cubic splines through scattered runs: an interpolant that uses every run.

A polynomial answers a vibration that gets out of step with ripples over the whole box. The
polyharmonic spline sum_i w_i |x - x_i|^3 + a + b x, in one dimension the natural cubic spline,
takes its course from the runs nearby; it goes through any set of runs, held-out ones and scans
included. Where the response is smooth, its error falls slower than a polynomial's; next to a jump
it overshoots by a tenth of it. Source: Wendland, Scattered Data Approximation (Cambridge 2005),
chapter 8; left-out errors without refitting: Rippa 1999. How it is solved: spline_equations.py."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from .chebyshev import Formula, cubes
from .errors import IntervalError
from .spline_equations import Polyharmonic, distinct, in_blocks, line_rows, solve_line

MAX_RUNS = 4000  # the spline's matrix is full
_SCALE_RUNS = 400  # runs that choose the scales
CHUNK = 1 << 20  # numbers at a time: memory that is used again is faster than fresh memory
_MISFIT = 1e-6  # of the width of the runs' values at an instant: above it no spline is given
SPACINGS = (1.0, 10.0, 100.0)  # times the least: nearer runs count once where rounding spoils it
_SMALLEST = np.finfo(float).tiny / np.finfo(float).eps  # below it numbers have fewer digits


@dataclass(frozen=True)
class Spline:
    """Cubic (polyharmonic) spline through N runs at points in [-1, 1]^k; (...) is the shape of a
    run's values, such as responses and instants. Made by `fit_spline`.

    points (N, k): those of the runs, no two nearly the same; scales (k): factors of the coordinates
    before distances are taken, 0 for one that is the same in all runs; weights (N + 1 + f, ...): of
    the runs, then the constant and the slopes of the f other coordinates (on a line (2 N, ...):
    values and second derivatives at the runs); left_out (N, ...): value of each run less that of
    the spline through all others, infinite where these give no spline; values (N, ...): of the
    runs; lowest, highest (...) and argmin, argmax (..., k): extreme values of all runs given,
    repeated ones too, and their points; misfit (...): largest difference of the spline and a run,
    by rounding and by runs that are nearly the same."""

    points: np.ndarray
    scales: np.ndarray
    weights: np.ndarray
    left_out: np.ndarray
    values: np.ndarray
    lowest: np.ndarray
    highest: np.ndarray
    argmin: np.ndarray
    argmax: np.ndarray
    misfit: np.ndarray

    @cached_property
    def on_line(self) -> bool:
        """Whether runs differ in one parameter only; `weights` are of another form then."""
        return len(self.points) > 1 and int((self.scales > 0).sum()) == 1

    def line_rows(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights on which a spline whose runs differ in one parameter only depends at points
        `points` (P, k) in [-1, 1]^k: indices (P, 4) into `weights`, and their factors (P, 4)."""
        j = int(np.argmax(self.scales > 0))
        return line_rows(np.asarray(points, dtype=float)[:, j], self.points[:, j])

    def basis(self, points: np.ndarray):
        """Matrix (P, len(weights)) whose product with the weights is the spline's values at points
        `points` (P, k) in [-1, 1]^k; a sparse one where the runs differ in one parameter only."""
        if self.on_line:
            index, factor = self.line_rows(points)
            ends = np.arange(0, 4 * len(index) + 1, 4)
            shape = (len(index), len(self.weights))
            return scipy.sparse.csr_array((factor.ravel(), index.ravel(), ends), shape=shape)
        return _rows(_scale(np.asarray(points, dtype=float), self.scales), self._scaled_points)

    @cached_property
    def _scaled_points(self) -> np.ndarray:
        return _scale(self.points, self.scales)

    def evaluate(self, points: np.ndarray) -> np.ndarray:
        """Values (P, ...) of the spline at `points` (P, k) in [-1, 1]^k."""
        flat = self.weights.reshape(len(self.weights), -1)
        values = in_blocks(
            lambda x: self.basis(x) @ flat, np.asarray(points, dtype=float), len(self.points)
        )
        return values.reshape(len(points), *self.weights.shape[1:])

    def formula(self) -> Formula:
        """Write the spline of a single number (weights (N + 1 + f, 1), on a line (2 N, 1)) as a
        table for other programs. Where runs differ in one parameter, close ones cost digits."""
        count, free = len(self.points), self.scales > 0
        linear = np.zeros(1 + len(free))
        if not self.on_line:
            weights = self.weights[:, 0]
            linear[0], linear[1:][free] = weights[count], weights[count + 1 :] * self.scales[free]
            return cubes(self.points, self.scales, weights[:count], linear)
        j = int(np.argmax(free))
        order = np.argsort(self.points[:, j])
        knots, second = self.points[order, j], self.weights[count:, 0][order]
        third = np.concatenate([[0.0], np.diff(second) / np.diff(knots), [0.0]])
        jumps, weights = np.diff(third) / 12, np.zeros(count)
        weights[order] = jumps
        ends = knots[[0, -1]]
        remainder = self.values[order[[0, -1]], 0] - np.abs(ends[:, None] - knots) ** 3 @ jumps
        linear[1 + j] = (remainder[1] - remainder[0]) / (ends[1] - ends[0])
        linear[0] = remainder[0] - linear[1 + j] * ends[0]
        return cubes(self.points, free.astype(float), weights, linear)


def level_errors(spline: Spline) -> np.ndarray:
    """Return the left-out errors (N, ...) of a spline's runs. Where these are a grid, runs that
    share a value of a parameter are left out together as well (`Polyharmonic.left_out`): the
    others predict a single one, whatever the response does between the values."""
    groups = []
    for column in np.round(spline.points[:, spline.scales > 0], 9).T:
        _, level, counts = np.unique(column, return_inverse=True, return_counts=True)
        if (counts == 1).sum() <= 1:  # the nominal run may be off the grid
            groups += [np.flatnonzero(level == i) for i in np.flatnonzero(counts > 1)]
    if not groups:
        return spline.left_out
    weights = spline.weights.reshape(len(spline.weights), -1)
    errors = _system(spline.points, spline.scales).left_out(weights, groups)
    return errors.reshape(spline.left_out.shape)


def check_spline_runs(points: np.ndarray) -> None:
    """Raise `IntervalError` unless runs at points (N, k) in [-1, 1]^k suffice for a spline and for
    its leave-one-out errors: at most 4000 (`MAX_RUNS`), and two more than directions in which they
    differ, not all but one in one plane. One run will do for a box without width."""
    points = np.asarray(points, dtype=float)
    if len(points) > MAX_RUNS:
        raise IntervalError("runs", len(points), f"at most {MAX_RUNS} runs for a spline")
    if not len(points):
        raise IntervalError("runs", 0, "runs for a spline")
    points = points[distinct(points)]
    if len(points) == 1:
        return
    free = np.ptp(points, axis=0) > 0
    linear = np.concatenate([np.ones((len(points), 1)), points[:, free]], axis=1)
    u, singular, _ = np.linalg.svd(linear, full_matrices=False)
    least = linear.shape[1] + 1
    # a run of leverage 1 is the only one outside a plane that holds all the others
    leverage = (u**2).sum(axis=1)
    if len(points) < least or singular[-1] < 1e-9 * singular[0] or leverage.max() > 1 - 1e-9:
        allowed = f"at least {least} runs for a spline, and no plane that holds all but one"
        raise IntervalError("runs", len(points), allowed)


def fit_spline(points: np.ndarray, values: np.ndarray, scales: np.ndarray | None = None) -> Spline:
    """Fit a spline through the values (N, ...) of runs at points (N, k) in [-1, 1]^k. Runs that are
    nearly the same count once, the first of them; where rounding keeps the spline from going
    through the others, runs that are ten or a hundred times as far apart do, too, and the result's
    `misfit` says what that leaves. scales (k): factors of the coordinates before distances are
    taken; None: those of least leave-one-out errors (`choose_scales`). IntervalError for runs too
    close, in one plane, or not one more of them than directions in which they differ."""
    runs = np.asarray(points, dtype=float)
    for factor in SPACINGS:
        rows = distinct(runs, factor)
        if factor > 1:
            check_spline_runs(runs[rows])
        spline = _spline_of(runs, rows, values, scales)
        if spline is not None:
            return spline
    need = "runs that are farther apart: rounding keeps the spline from going through these"
    raise IntervalError("runs", len(runs), need)


def predict_runs(
    points: np.ndarray, values: np.ndarray, places: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Predict the values (F, ...) at `places` (F, k) by a spline through the nearest runs, at most
    400, and estimate the error (...): the largest left-out error of these. points (N, k),
    values (N, ...): of the runs. Raises IntervalError if they do not suffice for a spline."""
    distances = np.linalg.norm(points[:, None] - places, axis=-1).min(axis=1)
    rows = np.argsort(distances, kind="stable")[:_SCALE_RUNS]
    check_spline_runs(points[rows])
    spline = fit_spline(points[rows], values[rows])
    return spline.evaluate(places), np.abs(spline.left_out).max(axis=0) + spline.misfit


def _spline_of(
    runs: np.ndarray, rows: np.ndarray, values: np.ndarray, scales: np.ndarray | None
) -> Spline | None:
    """Return the spline through the runs of some rows; None where rounding keeps it from that."""
    shape = np.shape(values)[1:]
    samples = np.asarray(values, dtype=float).reshape(len(runs), -1)
    points, flat = runs[rows], samples[rows]
    scales = choose_scales(points, flat) if scales is None else np.where(_spread(points), scales, 0)
    weights, left_out = _solve(points, scales, flat)
    fields: list = [points, scales, weights.reshape(-1, *shape), left_out.reshape(-1, *shape)]
    columns = np.arange(flat.shape[1])
    extremes = samples.argmin(axis=0), samples.argmax(axis=0)
    fields += [flat.reshape(-1, *shape), *(samples[i, columns].reshape(shape) for i in extremes)]
    fields += [runs[i].reshape(*shape, -1) for i in extremes]
    spline = Spline(*[*fields, np.zeros(shape)])
    extra = np.setdiff1d(np.arange(len(runs)), rows)
    misfit = np.abs(_rest(spline, points, flat)).max(axis=0)
    # at an instant at which all runs agree, rounding of their values is all there is
    allowed = _MISFIT * np.ptp(flat, axis=0) + 1e-12 * np.abs(flat).max(axis=0) + _SMALLEST
    if (misfit > allowed).any():
        return None
    if len(extra):
        misfit = np.maximum(misfit, np.abs(_rest(spline, runs[extra], samples[extra])).max(axis=0))
    return replace(spline, misfit=misfit.reshape(shape))


def _rest(spline: Spline, points: np.ndarray, flat: np.ndarray) -> np.ndarray:
    return flat - spline.evaluate(points).reshape(flat.shape)


def _solve(points, scales, flat) -> tuple[np.ndarray, np.ndarray]:
    """Weights and left-out errors (N, T)."""
    free = scales > 0
    if len(points) == 1:
        return flat, np.zeros_like(flat)
    if free.sum() == 1:
        second, left_out = solve_line(points[:, free][:, 0], flat)
        return np.concatenate([flat, second]), left_out
    system = _system(points, scales)
    weights = system.weights(flat)
    return weights, system.left_out(weights)


def choose_scales(points: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Choose scales (k), factors of the coordinates before distances are taken, for a spline
    through values (N, T) at `points` (N, k) in [-1, 1]^k: those of least leave-one-out errors,
    found by doubling and halving each; 0 in directions in which the points do not differ. The
    response may change over a tenth of one interval and hardly over all of another; distances
    should tell. Columns count relative to spread; at most 400 runs, 200 columns are used."""
    spread = _spread(points)
    scales = spread.astype(float)
    if spread.sum() < 2 or not np.ptp(values, axis=0).any():
        return scales
    rows = np.unique(np.linspace(0, len(points) - 1, min(len(points), _SCALE_RUNS)).astype(int))
    columns = np.unique(np.linspace(0, values.shape[1] - 1, 200).astype(int))
    points, values = points[rows], values[rows][:, columns]
    values = values[:, np.ptp(values, axis=0) > 0]
    values = values / np.ptp(values, axis=0)

    def loss(trial):
        system = _system(points, trial)
        return np.abs(system.left_out(system.weights(values))).sum()

    best = loss(scales)
    for _ in range(3):
        last_best = best
        for j in np.flatnonzero(spread):
            for factor in (0.5, 2.0):
                trial = scales.copy()
                trial[j] *= factor
                trial_loss = loss(trial) if 1 / 16 <= trial[j] <= 16 else np.inf
                if trial_loss < 0.98 * best:
                    best, scales = trial_loss, trial
        if best == last_best:
            break
    return scales


def _spread(points: np.ndarray) -> np.ndarray:
    return np.ptp(points, axis=0) > 0


def _scale(points: np.ndarray, scales: np.ndarray) -> np.ndarray:
    return (points * scales)[:, scales > 0]


def _rows(x: np.ndarray, points: np.ndarray) -> np.ndarray:
    if len(points) == 1:
        return np.ones((len(x), 1))
    squares = scipy.spatial.distance.cdist(x, points, "sqeuclidean")
    rows = np.empty((len(x), sum(points.shape) + 1))
    np.multiply(squares, np.sqrt(squares), out=rows[:, : len(points)])
    rows[:, len(points)], rows[:, len(points) + 1 :] = 1.0, x
    return rows


def _system(points, scales) -> Polyharmonic:
    """Equations of the weights that give values at the runs."""
    points = _scale(points, scales)
    rows = _rows(points, points)
    return Polyharmonic(rows[:, : len(points)], rows[:, len(points) :])
