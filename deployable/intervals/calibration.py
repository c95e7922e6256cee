"""Which part of a box explains measured curves within their bands: set-membership calibration.

A point x explains a test if the misfit of its curve y, the largest |g y(t - d; x) + o - m(t)| / b,
is at most 1 for some gain g, offset o and delay d within their limits, and some start s of the
test. Between runs, y is a polynomial with leave-one-out errors e(t): where (|residual| - e) / b > 1
a point is excluded, where (|residual| + e) / b <= 1 at all instants it explains. Waves of runs
follow in the interval hull of the rest (history matching, Craig et al. 1997, with bounded errors in
place of probabilities). Extremes over the hull are found by sequential linear programming with a
trust region and second-order corrections (Fletcher and Sainz de la Maza 1989)."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import comb, inf
from typing import Any, NamedTuple

import numpy as np
import scipy

from .box import corner_points
from .chebyshev import least_squares, product_basis, total_degree
from .designs import scan_points

OUTER, PLAIN, INNER = 1.0, 0.0, -1.0
"""Signs of the surrogate's error in a misfit: what is not excluded, as fitted, what explains."""

_PENALTY = 100.0  # in units of the box for each band beyond the level
_ITERATIONS, _STARTS, _CELLS = 40, 8, 64
_CORNERS = 4  # most directions of whose box the corners are run
_SPREAD_SHARE = 0.05  # of the difference of runs: so far left-out errors tell of those between
_ERROR_CEILING = 1e3  # times the band and the size: an error that is not known
_WIDER = 0.02  # of the hull's width, which is added on each side, and of the level
_PRECISE = 0.05  # of the band, at which the surrogate's error no longer matters
_STATIONARY = 0.8  # of the hull's volume: a wave that leaves more does not pay
_SAMPLES = 128  # points at which the fraction of the hull is counted
_SPOTS = 48  # points of the box and of the hull at which the misfit is found for sliders
_GAP_INSTANTS = 4  # instants on each side over which an error of interpolation counts
_STEP_FACTOR = 2.0  # 4/3 of the second order, for a change at the center of the hull alone
_SPARE = 0.2  # of the band beyond the least misfit, by which errors may widen what is left
_LEAST_SPARE, _HALVINGS = 0.04, 3  # least such part of the band; most halvings of a test's step
_CHECKS, _ATTEMPTS = 96, 3  # runs that may contradict a refutation; how often it is tried
_DEVIATIONS = 2.0  # standard deviations of such a count that are allowed for


class Measurement(NamedTuple):
    """Measured curves of one test, n responses at T instants. times (T) in s; values (n, T); bands
    (n, T): how far from each a curve may be; limits (2, 1 + 2 n), lower and upper: of the delay
    (s), the gain, then the offset of each; axes: coordinates of the box on which the test depends;
    starts: number of unknown values of its own start, further coordinates of its runs."""

    times: np.ndarray
    values: np.ndarray
    bands: np.ndarray
    limits: np.ndarray
    axes: np.ndarray
    starts: int = 0

    @property
    def dimension(self) -> int:
        """Number of coordinates of a run of this test: of the box, then of its start."""
        return len(self.axes) + self.starts


class TestRuns(NamedTuple):
    """Runs of a test. points (N, p): coordinates, -1 to 1, of the box, then s of the test's own
    start; curves (N, n, R) at R instants; starts (2, s): part of the start to look in; halvings:
    how often the time step of these runs was halved."""

    points: np.ndarray
    curves: np.ndarray
    starts: np.ndarray
    halvings: int = 0


class CurveFit(NamedTuple):
    """Polynomials fitted to a test's curves in a part of its box, `center` +- `half` (p). spline:
    of coefficients (terms, n) over time; indices (terms, p): degrees; errors (n, T), estimated."""

    test: Measurement
    center: np.ndarray
    half: np.ndarray
    spline: Any
    indices: np.ndarray
    errors: np.ndarray

    def linearise(self, point: np.ndarray, sensor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return residuals (n T) and their Jacobian (n T, p + 1 + 2 n) at a point (p) and values of
        the sensor (1 + 2 n): delay, gains, offsets."""
        n, p = len(self.test.values), len(point)
        shifts = np.concatenate([np.zeros((1, p)), np.eye(p), -np.eye(p)]) * 1e-4
        basis = product_basis((point - self.center) / self.half + shifts, self.indices)
        coefficients = self.spline(self.test.times - sensor[0])  # (T, terms, n)
        curves = np.einsum("sm,tmn->snt", basis, coefficients)
        rates = np.einsum("m,tmn->nt", basis[0], self.spline(self.test.times - sensor[0], 1))
        gains, offsets = sensor[1 : 1 + n, None], sensor[1 + n :, None]
        slopes = (curves[1 : 1 + p] - curves[1 + p :]) / (2e-4 * self.half[:, None, None])
        columns = np.zeros((p + 1 + 2 * n, *curves[0].shape))
        columns[:p], columns[p] = gains * slopes, -gains * rates
        rows = np.arange(n)
        columns[p + 1 + rows, rows], columns[p + 1 + n + rows, rows] = curves[0], 1.0
        residuals = gains * curves[0] + offsets - self.test.values
        return residuals.ravel(), columns.reshape(len(columns), -1).T


def fit_curves(
    test: Measurement, points: np.ndarray, curves: np.ndarray, times: np.ndarray,
    hull: np.ndarray, run_errors: np.ndarray | float = 0.0,
) -> CurveFit:  # fmt: skip
    """Fit the polynomials of the total degree whose leave-one-out errors are least; its errors are
    the largest of these, with that of interpolation between instants. points, curves: coordinates
    (N, p) of runs, and curves (N, n, R); times: instants (R) in s, at least four; hull (2, p): the
    part that is fitted; run_errors (n, T): of the runs themselves, as by their step."""
    center, half = hull.mean(axis=0), np.maximum(np.ptp(hull, axis=0) / 2, 1e-9)
    x = (points - center) / half
    rows = np.flatnonzero((np.abs(x) <= 1.0 + 2 * _WIDER).all(axis=1))
    rows = rows if len(rows) else np.abs(x).max(axis=1).argmin()[None]
    # A run that is left out must not stand there a second time.
    rows = rows[np.unique(x[rows].round(9), axis=0, return_index=True)[1]]
    x, curves = x[rows], curves[rows]
    middle = test.limits[:, 0].mean()
    samples = scipy.interpolate.CubicSpline(times, curves, axis=2)(test.times - middle)
    flat = samples.reshape(len(rows), -1)
    free = np.ptp(x, axis=0) > 0
    best: Any = None
    least = inf
    for degree in range(9):
        terms = comb(degree + int(free.sum()), degree)
        if degree and (terms > 0.75 * len(rows) or not free.any()):
            break
        indices = total_degree(np.where(free, degree, 0))
        basis = product_basis(x, indices)
        if (solution := least_squares(basis, flat, 1e-7)) is None:
            break
        coefficients, leverage = solution
        rest = np.abs(flat - basis @ coefficients) / np.maximum(1.0 - leverage, 1e-6)[:, None]
        errors = rest.max(axis=0) if len(rows) > 1 else np.zeros(flat.shape[1])
        score = float(np.log(errors / test.bands.ravel() + 1e-3).mean())
        if score < least:
            best, least = (indices, basis, errors), score
    indices, basis, errors = best
    whole: Any = least_squares(basis, curves.reshape(len(rows), -1), 1e-7)
    coefficients = whole[0]
    coefficients = coefficients.reshape(len(indices), *curves.shape[1:])
    spline = scipy.interpolate.CubicSpline(times, coefficients.transpose(2, 0, 1))
    # Left-out errors of runs that hardly resemble each other bound nothing between them.
    bands, size = test.bands.ravel(), np.abs(flat).max(axis=0)
    is_known = errors <= np.maximum(_SPREAD_SHARE * np.ptp(flat, axis=0), _PRECISE * bands)
    errors = np.where(is_known, 3.0 * errors, _ERROR_CEILING * (bands + size))
    gaps = _interpolation_errors(times, curves, np.ptp(test.limits[:, 0]))
    places = np.clip(test.times - middle, times[0], times[-1])
    gaps = np.array([np.interp(places, times, gap) for gap in gaps])
    errors = errors.reshape(samples.shape[1:]) + gaps + run_errors
    return CurveFit(test, center, half, spline, indices, errors)


def _interpolation_errors(times: np.ndarray, curves: np.ndarray, delay: float) -> np.ndarray:
    """Largest error (n, R) of cubics through the instants of any run, near each instant: by those
    through every second and fourth. delay: width of its limits (s), by which errors may shift."""
    width = 2 * _GAP_INSTANTS + 1 + int(2 * delay / (times[1] - times[0]))

    def gaps(stride: int) -> np.ndarray:
        if len(times) < 4 * stride:
            return np.full(curves.shape[1:], inf)
        rows = np.arange(0, len(times), stride)
        coarse = scipy.interpolate.CubicSpline(times[rows], curves[..., rows], axis=2)
        change = np.abs(coarse(times) - curves)
        change[..., rows[-1] + 1 :] = 0.0  # beyond its last instant
        return scipy.ndimage.maximum_filter1d(change.max(axis=0), width, axis=1)

    fine, coarse = gaps(2), gaps(4)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = np.nan_to_num(coarse / fine, nan=2.0, posinf=16.0)
    return np.where(fine > 0, fine / (np.clip(ratio, 2.0, 16.0) - 1.0), 0.0)


def _lobes(change: np.ndarray) -> np.ndarray:
    """Return the largest size (n, R) of a signed change (n, R) between its zeros beside each
    instant, and between the next ones: two oscillations that differ in phase agree wherever they
    cross."""
    result = np.empty_like(change)
    for row, values in enumerate(change):
        starts = np.concatenate([[0], np.flatnonzero(np.diff(values > 0)) + 1])
        peaks = np.maximum.reduceat(np.abs(values), starts)
        peaks = scipy.ndimage.maximum_filter1d(peaks, 3)
        result[row] = np.repeat(peaks, np.diff(np.append(starts, len(values))))
    return result


def _places(tests: Sequence[Measurement], k: int) -> list[np.ndarray]:
    """Indices of each test's variables, of which the first k are the box's: those of its axes, then
    of its starts and its sensor."""
    places, size = [], k
    for test in tests:
        count = test.starts + test.limits.shape[1]
        places.append(np.concatenate([test.axes, size + np.arange(count)]).astype(int))
        size += count
    return places


class _Trial(NamedTuple):
    """A point of a search: its `values` (size), residuals (M) with their Jacobian (M, size), and
    misfit; what it costs, and the penalty for a misfit beyond the level."""

    values: np.ndarray
    residuals: np.ndarray
    jacobian: np.ndarray
    misfit: float
    cost: float
    penalty: float


class _Problem:
    """Residuals of tests over the box's coordinates (k), then each test's starts and sensor."""

    def __init__(self, fits: Sequence[CurveFit], k: int):
        self.fits, self.k, self.places = fits, k, _places([fit.test for fit in fits], k)
        self.size = int(self.places[-1][-1]) + 1
        self.bands = np.concatenate([fit.test.bands.ravel() for fit in fits])
        self.errors = np.concatenate([fit.errors.ravel() for fit in fits])

    def linearise(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (M) in bands, and their Jacobian (M, size)."""
        residuals, rows = [], []
        for fit, places in zip(self.fits, self.places, strict=True):
            p, (low, high) = fit.test.dimension, fit.test.limits
            sensor = (low + high) / 2 + values[places[p:]] * (high - low) / 2
            part, columns = fit.linearise(values[places[:p]], sensor)
            jacobian = np.zeros((len(part), self.size))
            jacobian[:, places[:p]] = columns[:, :p]
            jacobian[:, places[p:]] = columns[:, p:] * (high - low) / 2
            residuals.append(part)
            rows.append(jacobian)
        return (np.concatenate(residuals) / self.bands, np.concatenate(rows) / self.bands[:, None])

    def excess(self, residuals: np.ndarray, sign: float) -> np.ndarray:
        """Return by how many bands each residual (M) deviates, minus or plus the surrogate's
        error."""
        return np.abs(residuals) - sign * self.errors / self.bands

    def search(
        self, start: np.ndarray, hull: np.ndarray, sign: float, cost: np.ndarray | None = None,
        level: float = 0.0, sufficient: float = -inf,
    ) -> tuple[np.ndarray, float]:  # fmt: skip
        """Return values (size), and their misfit: the least one, or with a `cost` (size) that of
        least cost up to `level`. hull (2, size): limits; sufficient: misfit that ends it."""
        cost, penalty = (np.zeros(self.size), 1.0) if cost is None else (cost, _PENALTY)
        half, radius = np.ptp(hull, axis=0) / 2, 1.0

        def find_trial(values: np.ndarray) -> _Trial:
            values = np.clip(values, *hull)
            residuals, jacobian = self.linearise(values)
            misfit = self.excess(residuals, sign).max()
            cost_parts = cost @ values, penalty * max(misfit - level, 0.0)
            return _Trial(values, residuals, jacobian, misfit, *cost_parts)

        best = find_trial(start)
        for _ in range(_ITERATIONS):
            if best.misfit <= sufficient or radius < 1e-6:
                break
            merit = best.cost + best.penalty
            sides = np.clip(hull - best.values, -radius * half, radius * half)
            problem = best.jacobian, sides, half, sign, cost, level
            step, prediction = self._step(best.residuals, *problem)
            gain = merit - best.cost - prediction
            if gain <= 1e-4 * (np.abs(cost) @ half if cost.any() else max(merit, 0.01)):
                break
            trial = find_trial(best.values + step)
            if not (merit - trial.cost - trial.penalty) / gain > 0.3:  # with its curvature
                step, _ = self._step(trial.residuals - best.jacobian @ step, *problem)
                trial = find_trial(best.values + step)
            ratio = (merit - trial.cost - trial.penalty) / gain
            best = trial if ratio > 0.05 else best
            radius = min(1.0, 2 * radius) if ratio > 0.7 else radius if ratio > 0.3 else radius / 3
        return best.values, float(best.misfit)

    def _step(
        self, residuals: np.ndarray, jacobian: np.ndarray, sides: np.ndarray, half: np.ndarray,
        sign: float, cost: np.ndarray, level: float,
    ) -> tuple[np.ndarray, float]:  # fmt: skip
        """Return the best step (size) of the linearised problem within `sides` (2, size), and by
        how much it changes the merit from that of a misfit within `level`."""
        penalty = _PENALTY if cost.any() else 1.0
        excess, reach = self.excess(residuals, sign), np.abs(jacobian) @ np.abs(sides).max(axis=0)
        rows = np.flatnonzero(excess + reach >= max(level, (excess - reach).max()))
        scales = np.where(half > 0, half, 1.0)
        slopes = jacobian[rows] * scales
        limit = self.errors[rows] / self.bands[rows] * sign + level
        column = -np.ones((len(rows), 1))
        matrix = np.block([[slopes, column], [-slopes, column]])
        bound = np.concatenate([limit - residuals[rows], limit + residuals[rows]])
        bounds = [*(sides / scales).T, (0.0, None)]
        costs = np.append(cost * scales, penalty)
        result = scipy.optimize.linprog(costs, matrix, bound, bounds=bounds, method="highs-ds")
        if result.x is None:
            return np.zeros(self.size), inf
        return result.x[:-1] * scales, float(result.fun)


@dataclass(frozen=True)
class Calibration:
    """What of a box explains measured curves.

    Misfits count in bands; up to 1 explains. hull (2, k): lower and upper coordinates, -1 to 1, of
    what is not excluded; or, if the tests are refuted, of what comes within the least band. starts:
    of each test, likewise (2, s). least, attained: least misfit of any point, as it is at least and
    as a run has it; best (k): that run's point. fractions: of the box's volume that surely
    explains, and that is not excluded; samples (S, k): points that are not excluded. runs: number
    made here; worst: (test, response, instant) at which the best run is farthest off; residuals:
    its deviations of each test, (n, T); data: the runs of each test. misfits(): points (N, k + 1)
    spread over the box, with their least misfit last, found when called."""

    hull: np.ndarray
    starts: list[np.ndarray]
    least: float
    attained: float
    best: np.ndarray
    fractions: tuple[float, float]
    samples: np.ndarray
    runs: int
    worst: tuple[int, int, int]
    residuals: list[np.ndarray]
    data: list[TestRuns]
    misfits: Callable[[], np.ndarray]

    @property
    def is_refuted(self) -> bool:
        """Whether no point explains the tests, whatever the errors of surrogate and runs are."""
        return self.least > 1.0


class _Waves:
    """Runs of all tests so far, and the hull (2, size) of what they leave."""

    def __init__(
        self, tests: Sequence[Measurement], times: np.ndarray, evaluate: Callable, hull: np.ndarray,
        data: Sequence[TestRuns], notify: Callable,
    ):  # fmt: skip
        self.tests, self.times, self.evaluate = tests, times, evaluate
        self.k, self.notify, self.runs = hull.shape[1], notify, 0
        self.points, self.curves = [d.points for d in data], [d.curves for d in data]
        self.halvings, self.step_errors = [d.halvings for d in data], [0.0] * len(data)
        self.attained: Any = inf
        self.best: Any = None
        self.residuals: Any = []
        self.problems: list = []
        sides = [hull]
        for test, runs in zip(tests, data, strict=True):
            ends = np.ones(test.limits.shape[1])
            sides += [runs.starts, np.array([-ends, ends])]
        self.hull = self.widest = np.concatenate(sides, axis=1)
        self.places = _places(tests, self.k)
        starts = [p[len(t.axes) : t.dimension] for p, t in zip(self.places, tests, strict=True)]
        # What is narrowed: coordinates of the box, and of starts; the others are the sensors'.
        self.inputs = np.concatenate([np.arange(self.k), *starts])
        self.sensors = np.setdiff1d(np.arange(self.widest.shape[1]), self.inputs)

    def add(self, t: int, points: np.ndarray) -> np.ndarray:
        """Make runs of test `t` at coordinates (N, p), and return their curves (N, n, R), NaN of
        those that failed, which are left out of the fits."""
        curves = self.evaluate(t, points, self.halvings[t])
        is_sound = np.isfinite(curves).all(axis=(1, 2))
        self.points[t] = np.concatenate([self.points[t], points[is_sound]])
        self.curves[t] = np.concatenate([self.curves[t], curves[is_sound]])
        self.runs += len(points)
        return curves

    def fits(self, number: int) -> list[CurveFit]:
        """Curves of all tests in the hull, after further runs there and, at its centre, with half
        the step. number: of the wave."""
        fits = []
        for t, test in enumerate(self.tests):
            hull = self.hull[:, self.places[t][: test.dimension]]
            half, center = np.ptp(hull, axis=0) / 2, hull.mean(axis=0)
            spread = _design(half > 0, comb(test.dimension + 2, 2), number)
            points = np.concatenate([center[None], center + half * spread])
            middle = self.add(t, points)[0]
            finer = self.evaluate(t, center[None], self.halvings[t] + 1)[0]
            change = _STEP_FACTOR * _lobes(np.nan_to_num(finer - middle))
            places = test.times - test.limits[:, 0].mean()
            errors = np.array([np.interp(places, self.times, row) for row in change])
            self.step_errors[t] = float((errors / test.bands).max())
            data = self.points[t], self.curves[t], self.times
            fits.append(fit_curves(test, *data, hull, errors))
        return fits

    def run(self, values: np.ndarray) -> tuple[np.ndarray, float]:
        """Run all tests at the variables `values`, and keep the run if it is the nearest so far.
        Return them with the best values of the sensors, and the misfit, infinite if a run fails."""
        run_fits, points = [], []
        for t, (test, places) in enumerate(zip(self.tests, self.places, strict=True)):
            points.append(values[places[: test.dimension]])
            curves = self.add(t, points[t][None])
            if np.isnan(curves).any():
                return values, np.inf
            hull = np.array([points[t], points[t]])
            run_fits.append(fit_curves(test, points[t][None], curves, self.times, hull))
        run_problem = _Problem(run_fits, self.k)
        hull = np.array([values, values])
        hull[:, self.sensors] = [[-1.0], [1.0]]
        values, misfit = run_problem.search(values, hull, PLAIN)
        if misfit < self.attained:
            self.attained, self.best = misfit, values
            self.residuals = run_problem.linearise(values)[0]
        return values, misfit

    def refine(self, allowed: float) -> bool:
        """Halve the step of each test by which curves err more than `allowed` (bands), and tell
        whether one was. Its runs, which have the errors of the step before, no longer count."""
        rows = [
            t for t, error in enumerate(self.step_errors)
            if error > allowed and self.halvings[t] < _HALVINGS
        ]  # fmt: skip
        for t in rows:
            self.halvings[t] += 1
            self.points[t], self.curves[t] = self.points[t][:0], self.curves[t][:0]
        if rows:
            self.attained = inf
            self.run(self.best)
        return bool(rows)

    def is_contradicted(self, number: int) -> bool:
        """Return whether further runs, spread over all of the box and the starts, come nearer than
        the errors of the first wave allow there: behaviour that few runs show, such as a latch that
        hardly ever catches. number: of the attempt, each with runs of its own."""
        problem = self.problems[0][1]
        free = np.zeros(problem.size, bool)
        free[self.inputs] = np.ptp(self.widest[:, self.inputs], axis=0) > 0
        center, half = self.widest.mean(axis=0), np.ptp(self.widest, axis=0) / 2
        count = _CHECKS // len(self.tests)
        for point in scan_points(free, count * (number + 1), corners=False)[-count:]:
            values, misfit = self.run(center + half * point)
            hull = np.array([values, values])
            hull[:, self.sensors] = self.widest[:, self.sensors]
            if problem.search(values, hull, OUTER)[1] > 1.05 * misfit + 0.05:
                return True
        return False

    def narrow(self, level: float | None, waves: int) -> tuple[_Problem, float, list]:
        """Narrow the hull to misfits up to `level`, None for that of the best run; return the last
        problem, the least misfit that its errors allow, and points (size) that are not excluded.
        waves: number of waves after which only those go on that narrow the hull, to twice it."""
        least, pool, self.hull = 0.0, [], self.widest
        for number in range(2 * waves):
            problem = _Problem(self.fits(number), self.k)
            self.problems = [*(self.problems if number else []), (self.hull, problem)]
            rng = np.random.default_rng(number)
            starts = [rng.uniform(*self.hull) for _ in range(_STARTS)]
            starts += [self.hull.mean(axis=0)] + [self.best] * (self.best is not None)
            outer, misfit = self.approach(problem, starts)
            nearest = min(outer_misfit for _, outer_misfit in outer)
            if nearest > misfit:  # a run there comes nearer: the errors were too small
                continue
            least = max(least, nearest)
            limit = max(self.attained, 1.0) * (1 + _WIDER) if level is None else level
            pool = [v for v, outer_misfit in outer if outer_misfit <= limit]
            pool += self.islands(problem, starts, limit)
            pool += [self.best] * (level is None)
            self.notify(
                f"wave {number + 1}: {self.runs} runs, least misfit {least:.3g} to "
                f"{self.attained:.3g} bands"
            )
            if not pool:
                return problem, least, []
            pool = self.extremes(problem, limit, pool, np.eye(problem.size)[self.inputs])
            error = (problem.errors / problem.bands).max() / limit
            is_steady = self.shrink(pool)
            is_precise = error <= (4 * _PRECISE if is_steady else _PRECISE)
            spare = _SPARE * max(limit - self.attained, _LEAST_SPARE)
            is_met = self.attained - least <= (_PRECISE * limit if level is None else spare)
            is_done = (is_met or is_precise) if level is None else (is_met and is_precise)
            allowed = min(_PRECISE * limit, _SPARE * max(limit - least, _LEAST_SPARE))
            if number + 1 < 2 * waves and self.refine(allowed):
                continue
            if is_done or (is_steady and number + 1 >= waves):
                break
        if not pool and self.attained <= (1.0 if level is None else level):
            pool = [self.best]
        return problem, least, pool

    def approach(
        self, problem: _Problem, starts: Sequence[np.ndarray]
    ) -> tuple[list[tuple[np.ndarray, float]], float]:
        """Search the least misfits from all starts (size), run the best; return values and misfits
        that the errors allow, and the misfit of the best run in the hull, or else of this one."""
        plain = [problem.search(start, self.hull, PLAIN) for start in starts]
        best = min(plain, key=lambda pair: pair[1])[0]
        outer = [problem.search(values, self.hull, OUTER) for values, _ in plain]
        misfit = self.run(best)[1]
        is_inside = (
            self.best is not None
            and (self.best >= self.hull[0]).all()
            and (self.best <= self.hull[1]).all()
        )
        return outer, self.attained if is_inside else misfit

    def shrink(self, pool: Sequence[np.ndarray]) -> bool:
        """Narrow the hull to about the points (size) of a pool, and tell whether that left most of
        its volume."""
        low, high = np.min(pool, axis=0), np.max(pool, axis=0)
        wider = _WIDER * (high - low)
        hull = np.clip([low - wider, high + wider], *self.hull)
        hull[:, self.sensors] = self.hull[:, self.sensors]
        volumes = [np.ptp(side, axis=0).prod() for side in (hull, self.hull)]
        self.hull = hull
        return bool(volumes[0] > _STATIONARY * volumes[1])

    def islands(
        self, problem: _Problem, starts: list[np.ndarray], level: float
    ) -> list[np.ndarray]:
        """Return points (size) that misfits up to the `level` do not exclude, one of each cell of
        the hull that has one: what is left may be in several parts, and a search of the whole ends
        in one of them. starts: points whose variables of the tests are begun with."""
        low, high = self.hull[:, : self.k]
        free = high > low
        count = max(2, round(_CELLS ** (1 / max(free.sum(), 1))))
        lines = [np.arange(count) if is_free else [0] for is_free in free]
        sides = np.where(free, (high - low) / count, 0.0)
        pool = []
        for i, cell in enumerate(itertools.product(*lines)):
            hull, start = self.hull.copy(), starts[i % len(starts)].copy()
            hull[:, : self.k] = low + sides * cell, low + sides * (np.array(cell) + 1.0)
            start[: self.k] = hull[:, : self.k].mean(axis=0)
            values, misfit = problem.search(start, hull, OUTER, sufficient=level)
            pool += [values] * (misfit <= level)
        return pool

    def extremes(
        self, problem: _Problem, level: float, pool: list[np.ndarray], directions: np.ndarray
    ) -> list[np.ndarray]:
        """Return points (size) up to the `level`, the farthest in `directions` (D, size), both
        ways, among them; pool: some, at least one, from which to start."""
        for direction in np.concatenate([-directions, directions] * 2):
            start = max(pool, key=lambda values: direction @ values)
            values, misfit = problem.search(start, self.hull, OUTER, -direction, level)
            if misfit <= level * (1 + _WIDER):
                pool = [*pool, values]
        return pool


def _design(free: np.ndarray, count: int, number: int) -> np.ndarray:
    """Return coordinates (N, p), -1 to 1, of the runs of wave `number`: corners, or with many
    directions the ends of the axes, then `count` points of a sequence. free (p): directions with a
    width."""
    axes = np.eye(len(free))[free]
    ends = corner_points(free) if free.sum() <= _CORNERS else np.concatenate([-axes, axes])
    spread = scan_points(free, (number + 1) * count, corners=False)
    return np.concatenate([ends, spread[-count:]])


def calibrate(
    tests: Sequence[Measurement], times: np.ndarray, evaluate: Callable, hull: np.ndarray,
    data: Sequence[TestRuns] = (), waves: int = 6, notify: Callable = lambda text: None,
) -> Calibration:  # fmt: skip
    """Find what of a box explains all tests, with runs where that is open; if the tests are
    refuted, where the least band is attained.

    tests: at least one; times: recorded instants (R) of runs in s, which span the instants of all
    tests and delays; evaluate: function of the number of a test, coordinates (N, p), -1 to 1 in its
    box and starts, and how often the time step is halved, that returns the curves (N, n, R) of runs
    there; hull: part of the box (2, k) in which to look, -1 to 1; data: runs of each test that were
    made before, none if it is empty; waves: number of waves of runs, up to twice as many while they
    narrow the hull, and as many again where no point explains; notify: called with messages."""
    state = _Waves(tests, times, evaluate, hull, data or no_runs(tests, times), notify)
    for attempt in range(_ATTEMPTS):
        problem, least, pool = state.narrow(1.0, waves)
        is_refuted = least > 1.0
        if not is_refuted or not state.is_contradicted(attempt):
            break
    else:
        is_refuted, pool = False, []
    if is_refuted:
        problem, least, pool = state.narrow(None, waves)
        is_refuted = state.attained > 1.0
        pool = pool if is_refuted else []
    least = min(least, state.attained, inf if is_refuted else 1.0)
    k, level = hull.shape[1], max(1.0, state.attained) * (1 + _WIDER) if is_refuted else 1.0
    if pool or is_refuted:
        samples, fractions = _fractions(state, problem, pool, level)
    else:  # errors that runs contradict exclude nothing
        state.hull, fractions = state.widest, (0.0, 1.0)
        spread = scan_points(np.ptp(hull, axis=0) > 0, _SAMPLES)
        samples = np.vstack([hull.mean(axis=0) + np.ptp(hull, axis=0) / 2 * spread, state.best[:k]])
    ends = np.cumsum([test.values.size for test in tests])
    parts = np.split(state.residuals, ends[:-1])
    residuals = [
        part.reshape(test.values.shape) * test.bands
        for part, test in zip(parts, tests, strict=True)
    ]
    t = int(np.argmax([np.abs(part).max() for part in parts]))
    row = divmod(int(np.abs(parts[t]).argmax()), len(tests[t].times))
    starts = [state.hull[:, places[len(test.axes) : test.dimension]]
              for places, test in zip(state.places, tests, strict=True)]  # fmt: skip
    runs = zip(state.points, state.curves, starts, state.halvings, strict=True)
    data = [TestRuns(*fields) for fields in runs]
    return Calibration(
        state.hull[:, :k], starts, least, state.attained,
        state.best[:k], (0.0, 0.0) if is_refuted else fractions, samples, state.runs,
        (t, *row), residuals, data, partial(_misfits, state),
    )  # fmt: skip


def calibrate_together(
    tests: Sequence[Measurement], times: np.ndarray, evaluate: Callable, hull: np.ndarray,
    waves: int = 6, notify: Callable = lambda indices, text: None,
) -> tuple[Calibration, list[Calibration]]:  # fmt: skip
    """Find what of a box explains all tests, and what each explains alone. The first is looked for
    in what these have in common, or in all of `hull` where that is nothing or one is refuted.
    Arguments as of `calibrate`; `notify` gets indices of tests and a message."""

    def find(indices: Sequence[int], hull: np.ndarray, data: Sequence[TestRuns]) -> Calibration:
        return calibrate(
            [tests[t] for t in indices], times,
            lambda t, points, halvings: evaluate(indices[t], points, halvings), hull, data,
            waves=waves, notify=partial(notify, indices),
        )  # fmt: skip

    indices = range(len(tests))
    singles = [find([t], hull, ()) for t in indices]
    if len(tests) == 1:
        return singles[0], singles
    low, high = np.moveaxis(np.array([single.hull for single in singles]), 0, 1)
    common = np.array([low.max(axis=0), high.min(axis=0)])
    if (common[0] > common[1]).any() or any(single.is_refuted for single in singles):
        # Without the runs so far: where they crowd, left-out errors are too small for the whole.
        return find(indices, hull, ()), singles
    result = find(indices, common, [single.data[0] for single in singles])
    if result.is_refuted:  # outside nothing explains all, but the least band may be there
        whole = find(indices, hull, ())
        least = min(result.least, 1.0 + 1e-9)
        return whole if whole.is_refuted else replace(result, least=least), singles
    free = np.ptp(hull, axis=0) > 0
    ratio = float((np.ptp(common, axis=0)[free] / np.ptp(hull, axis=0)[free]).prod())
    fractions = ratio * result.fractions[0], ratio * result.fractions[1]
    misfits = partial(_common_misfits, result.misfits, [single.misfits for single in singles])
    return replace(result, fractions=fractions, misfits=misfits), singles


def _common_misfits(find: Callable, singles: Sequence[Callable]) -> np.ndarray:
    """Points (N, k + 1) and misfits of all tests: over the box the worst test's misfit, since each
    test's own variables are independent, then in the hull. find, singles: of all, of each test."""
    rows = np.array([find_single() for find_single in singles])
    count = rows.shape[1] // 2
    spread = np.column_stack([rows[0, :count, :-1], rows[:, :count, -1].max(axis=0)])
    hull_rows = find()
    return np.concatenate([spread, hull_rows[len(hull_rows) // 2 :]])


def no_runs(tests: Sequence[Measurement], times: np.ndarray) -> list[TestRuns]:
    """Make empty data of tests, without runs, at the recorded instants `times` (s), for all
    starts."""
    return [
        TestRuns(
            np.zeros((0, test.dimension)),
            np.zeros((0, len(test.values), len(times))),
            np.array([[-1.0], [1.0]]) * np.ones(test.starts),
        )
        for test in tests
    ]


def _misfits(state: _Waves) -> np.ndarray:
    """Return points (N, k) over the box and their least misfit, from the surrogates of the last
    wave."""
    k, rows = state.k, []
    spread = scan_points(np.ptp(state.widest[:, :k], axis=0) > 0, _SPOTS)
    for low, high in (state.widest, state.hull):
        for point in (low + high)[:k] / 2 + (high - low)[:k] / 2 * spread:
            hull, problem = [
                (hull, problem) for hull, problem in state.problems
                if (point >= hull[0, :k] - 1e-9).all() and (point <= hull[1, :k] + 1e-9).all()
            ][-1]  # fmt: skip
            hull = hull.copy()
            hull[:, :k] = point
            rows.append([*point, problem.search(hull.mean(axis=0), hull, PLAIN)[1]])
    return np.array(rows)


def _fractions(
    state: _Waves, problem: _Problem, pool: list[np.ndarray], level: float
) -> tuple[np.ndarray, tuple[float, float]]:
    """Points (S, k) that are not excluded, and the fractions of the box's volume that explain, at
    least, and that are not excluded, at most, each by two standard deviations of the count."""
    widths = np.ptp(state.widest[:, : state.k], axis=0)
    if not pool or not widths.any():
        points = np.array(pool).reshape(-1, problem.size)[:, : state.k]
        is_inner = bool(pool) and state.attained <= 1.0
        return points, (float(is_inner), float(bool(pool)))
    free, cloud = np.flatnonzero(widths > 0), np.array(pool)[:, : state.k]
    scale = np.maximum(np.ptp(state.hull[:, free], axis=0), 1e-12)
    _, _, axes = np.linalg.svd((cloud[:, free] - cloud[:, free].mean(axis=0)) / scale)
    directions = np.zeros((len(free), problem.size))
    directions[:, free] = axes / scale
    pool = state.extremes(problem, level, pool, directions)
    reach = np.array(pool) @ directions.T
    low, high = reach.min(axis=0), reach.max(axis=0)
    wider = _WIDER * (high - low)
    low, high = low - wider, high + wider
    rng = np.random.default_rng(0)
    spots = rng.uniform(low, high, (_SAMPLES, len(free))) @ np.linalg.inv(directions[:, free]).T
    rows = [values[: state.k] for values in pool]
    counts = np.zeros(2)
    for spot in spots:
        values = state.hull[:, : state.k].mean(axis=0)
        values[free] = spot
        if (values < state.hull[0, : state.k]).any() or (values > state.hull[1, : state.k]).any():
            continue
        if _misfit(state, problem, values, pool, OUTER) > level:
            continue
        counts += [_misfit(state, problem, values, pool, INNER) <= level, 1.0]
        rows.append(values)
    scale = np.prod(high - low) / np.prod(widths[free]) / abs(np.linalg.det(directions[:, free]))
    fractions = counts / _SAMPLES
    spread = _DEVIATIONS * np.sqrt(fractions * (1.0 - fractions) / _SAMPLES)
    hull_share = float((np.ptp(state.hull, axis=0)[free] / widths[free]).prod())
    inner, outer = np.clip((fractions + spread * [-1.0, 1.0]) * scale, 0.0, hull_share)
    return np.array(rows), (float(inner), float(outer))


def _misfit(
    state: _Waves, problem: _Problem, point: np.ndarray, pool: list[np.ndarray], sign: float
) -> float:
    """Least misfit at a point (k) of the box, by the tests' own variables, or any below 1."""
    nearest = min(pool, key=lambda values: np.abs(values[: state.k] - point).sum()).copy()
    nearest[: state.k] = point
    hull = state.hull.copy()
    hull[:, : state.k] = point
    return problem.search(nearest, hull, sign, sufficient=1.0)[1]
