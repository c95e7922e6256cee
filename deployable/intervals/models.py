"""Models of the responses over the box, from which bounds are taken."""

from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import scipy

from .alignment import (
    EVENT_NAMES,
    change_within,
    difference_across,
    first_difference,
    has_groups,
    name_events,
    split_runs,
    unseen_difference,
)
from .box import find_other_runs, match_points
from .designs import Design, complete_runs, fit
from .errors import IntervalError
from .estimates import (
    MAX_DIRECTIONS,
    ErrorEstimate,
    estimate_decay,
    estimate_error,
    limit_decay,
    power_mean,
    share_outside,
    widen,
)
from .ranges import Range, find_surrogate_range, spread_out, to_range
from .samples import Samples
from .spline_extremes import spline_range
from .splines import check_spline_runs, fit_spline, level_errors

AUTO_RUNS = 1000
"""Most runs for which splines are tried where there is a polynomial: they cost their cube."""

_WINDOWS = 0.002, 0.02  # of the duration, of parts: few runs are near their edges at one instant
_PLAIN = {"lowest", "highest", "argmin", "argmax", "misfit"}  # of a spline: not of its runs


class Model:
    """A model of n responses over the box, at T instants, for k parameters; `bounds_dataset` takes
    its bounds, errors and attributes. A new model is a subclass and a line in `MODELS`. Its
    constructor fits it to `samples` of runs; design: the points of those to be fitted, None: all;
    further keyword-only arguments are a user's options. kind: words for its bounds, "enclosed ..."
    or "attained ..." where they are a model's range; test_rows: indices of the runs that were not
    fitted, and test it; attributes: further ones of the bounds dataset, by name."""

    kind: str
    test_rows: np.ndarray = np.zeros(0, dtype=int)
    attributes: dict

    def __init__(self, samples: Samples, design: Design | None) -> None:
        raise NotImplementedError

    def range(self, columns: np.ndarray | None = None) -> Range:
        """Range of the n responses over the box at T instants: outer bounds (n, T), guaranteed for
        the model where it can be enclosed, else the attained ones; attained bounds (n, T); and the
        points (n, T, k) in [-1, 1]^k where the latter are attained. columns (n, T): mask of those
        that are wanted, the others may be anything; None: all."""
        raise NotImplementedError

    def error(self, bounds: Range, columns: np.ndarray | None = None) -> ErrorEstimate:
        """Estimated error (n, T) of `bounds`, the result of `range`; columns (n, T): mask of the
        bounds that are this model's, None: all; errors elsewhere do not count."""
        raise NotImplementedError

    def centre(self) -> np.ndarray | None:
        """Values (n, T) of the model at the centre of the box; None for a model without any."""
        return None

    def variables(self) -> dict:
        """Further variables of the bounds dataset by name: (dimensions, values, attributes)."""
        return {}


class PolynomialModel(Model):
    """Chebyshev polynomials fitted to the runs of `samples` at the points of `design`, with an
    enclosed range; all other runs test them (docs/intervals.md). tolerance: gap of enclosure and
    attained range at which to stop, as a fraction of the latter's width."""

    kind = "enclosed range of the polynomial"

    def __init__(self, samples: Samples, design: Design, *, tolerance: float = 1e-3) -> None:
        self.samples, self.tolerance = samples, tolerance
        self.test_rows = find_other_runs(samples.points, design.points)
        self.design = design
        runs = samples.points, samples.values, samples.failed_points
        values, self.lost_error = complete_runs(design, *runs)
        self.surrogate = fit(design, values)
        self.attributes = {"design_runs": design.run_count}

    def range(self, columns: np.ndarray | None = None) -> Range:
        if columns is None:
            return find_surrogate_range(self.surrogate, self.tolerance)
        selection = replace(self.surrogate, coefficients=self.surrogate.coefficients[:, columns])
        return spread_out(find_surrogate_range(selection, self.tolerance), columns)

    @cached_property
    def left_out(self) -> np.ndarray:
        """Values (R, n, T) of the runs less the polynomial's; NaN for those that are fitted."""
        left_out = np.full(self.samples.values.shape, np.nan)
        points = self.samples.points[self.test_rows]
        left_out[self.test_rows] = self.samples.values[self.test_rows] - self.surrogate.evaluate(
            points
        )
        return left_out

    def error(self, bounds: Range, columns: np.ndarray | None = None) -> ErrorEstimate:
        samples, surrogate = self.samples, self.surrogate
        points, time = samples.points[self.test_rows], samples.time
        values = samples.values[self.test_rows]
        if columns is not None:  # nothing of the other instants counts in a window
            coefficients = np.where(columns, surrogate.coefficients, 0.0)
            surrogate, values = replace(surrogate, coefficients=coefficients), values * columns
        residuals = values - surrogate.evaluate(points)
        decay = estimate_decay(surrogate, time)
        decay = limit_decay(surrogate, self.design.points, points, residuals, decay, time)
        held_out = np.abs(residuals).max(axis=0, initial=0.0)
        error = estimate_error(time, held_out, _errors_within(decay, columns))
        return replace(error, total=error.total + self.lost_error)

    def centre(self) -> np.ndarray:
        return self.surrogate.evaluate(np.zeros((1, self.samples.points.shape[1])))[0]


class ScanModel(Model):
    """Bounds by all runs, without a fit, whatever the design (ignored); they may exceed the memory.

    The error, by how much the bounds grew from the first half of the runs to all, is an estimate of
    what is still missing, no limit (docs/intervals.md). Samples are read in chunks."""

    kind = "least and largest sample"

    def __init__(self, samples: Samples, design: Design | None = None) -> None:
        self.points = samples.points
        total: Any = None
        totals = []
        for quarter in samples.quarters():
            total = total.merge(quarter) if total else quarter
            totals.append(total)
        self.total = total
        self.growth, self.growth_quarter = (  # on the side where they grew more
            np.maximum(part.low - total.low, total.high - part.high) if part
            else np.zeros_like(total.low) for part in totals[1:3]
        )  # fmt: skip
        free = np.ptp(self.points, axis=0) > 0
        is_drawn = (np.abs(self.points[:, free]) != 1.0).any(axis=1)
        is_drawn[slice(0) if samples.nominal is None else samples.nominal] = False
        draws = int(is_drawn.sum())
        self.attributes = {
            "design_runs": len(self.points),
            "error_kind": "growth of the bounds from the first half of the samples to all",
            "drawn_runs": draws,
            "share_outside": share_outside(draws),
            "share_outside_95": share_outside(draws, 0.95),
        }

    def range(self, columns: np.ndarray | None = None) -> Range:
        total, points = self.total, self.points
        return to_range(total.low, total.high, points[total.low_run], points[total.high_run])

    def error(self, bounds: Range, columns: np.ndarray | None = None) -> ErrorEstimate:
        return ErrorEstimate(self.growth, self.growth, np.zeros_like(self.growth))

    def variables(self) -> dict:
        text = "growth of the bounds with the last quarter of the samples"
        return {"growth_quarter": (("response", "time"), self.growth_quarter, {"long_name": text})}


class SplineModel(Model):
    """One spline through all runs (`samples`), whatever their role, as a model of the responses.

    Its bounds contain every run, and are attained by the spline or a run; they are no enclosure.
    The error is that of left-out runs inside the box, of those that `design`, if given, does not
    contain, and in several directions of those next to where each bound is attained; of an
    "adaptive" design in up to three directions a power mean over all (docs/intervals.md). Added is
    the largest difference between a run and the spline."""

    kind = "attained range of a spline through all runs"

    def __init__(self, samples: Samples, design: Design | None = None) -> None:
        check_spline_runs(samples.points)
        # Scales and extremes are looked for in one direction after the other: by name, so that the
        # order in which a dataset has its parameters does not matter.
        self.order = np.argsort(samples.source["parameter"].values, kind="stable")
        normalized = samples.points[:, self.order]
        self.samples, self.spline = samples, fit_spline(normalized, samples.values)
        points = self.spline.points
        tests_spline = (np.abs(points) < 1).all(axis=1)
        if design is not None:
            tests_spline[find_other_runs(points, design.points[:, self.order])] = True
        self.tests_spline = tests_spline if tests_spline.any() else ~tests_spline
        is_adaptive = design is not None and design.method == "adaptive"
        self.averages = is_adaptive and (self.spline.scales > 0).sum() <= MAX_DIRECTIONS
        self.attributes = {
            "design_runs": len(points),
            "error_kind": f"{'mean' if self.averages else 'largest'} difference of a run and the "
            "spline through the others",
            "spline_scales": self.spline.scales[self._inverse].tolist(),
        }

    @cached_property
    def left_out(self) -> np.ndarray:
        """Values (R, n, T) of the runs less those of the spline through all others; NaN for those
        that are nearly the same as another."""
        left_out = np.full(self.samples.values.shape, np.nan)
        rows = match_points(self.spline.points, self.samples.points[:, self.order])
        left_out[rows] = self.spline.left_out
        return left_out

    @cached_property
    def run_errors(self) -> np.ndarray:
        """Sizes of left-out errors (N, n, T) of the spline's runs."""
        return np.abs(level_errors(self.spline))

    @property
    def _inverse(self) -> np.ndarray:
        """Places of the dataset's parameters among the spline's."""
        return np.argsort(self.order)

    def range(self, columns: np.ndarray | None = None) -> Range:
        if columns is None:
            bounds = spline_range(self.spline)
        else:
            names = set(self.spline.__dataclass_fields__) - {"points", "scales"}
            parts = {n: getattr(self.spline, n) for n in names}
            fields = {n: x[columns] if n in _PLAIN else x[:, columns] for n, x in parts.items()}
            bounds = spread_out(spline_range(replace(self.spline, **fields)), columns)
        argmin, argmax = bounds.argmin[..., self._inverse], bounds.argmax[..., self._inverse]
        return replace(bounds, argmin=argmin, argmax=argmax)

    def error(self, bounds: Range, columns: np.ndarray | None = None) -> ErrorEstimate:
        spline = self.spline
        free = int((spline.scales > 0).sum())
        if self.averages:
            left_out = power_mean(self.run_errors, free)
        else:
            left_out = self.run_errors[self.tests_spline].max(axis=0)
            if free > 1:
                for x in (bounds.argmin, bounds.argmax):
                    left_out = np.maximum(left_out, self._next_to(x[..., self.order], free + 1))
        left_out = _errors_within(left_out + spline.misfit, columns)
        return estimate_error(self.samples.time, left_out, np.zeros_like(left_out))

    def _next_to(self, points: np.ndarray, count: int) -> np.ndarray:
        """Largest left-out error (n, T) of the `count` runs nearest to unit points at (n, T, k)."""
        scales = self.spline.scales
        tree = scipy.spatial.cKDTree(self.spline.points * scales)
        rows = tree.query(points * scales, k=min(count, len(self.spline.points)))[1]
        places: Any = np.indices(points.shape[:2])
        n, instants = places
        return self.run_errors[rows, n[..., None], instants[..., None]].max(axis=-1)

    def centre(self) -> np.ndarray:
        return self.spline.evaluate(np.zeros((1, self.spline.points.shape[1])))[0]


class AlignedModel(Model):
    """Splines through all runs (`samples`), aligned at the events that they share (alignment.py).

    Where some runs lack an event, or have two in another order, the runs are split by that if the
    parts predict left-out runs better; bounds are then the hull of the parts, and contain every
    run. Behind `end_time`, where the last stretch of some runs has ended, they are those of the
    runs, and their width is the error. Otherwise what makes up the error is told in
    docs/curves-through-events.md."""

    kind = "attained range of splines through all runs, aligned at their events"

    def __init__(
        self, samples: Samples, design: Design | None = None, with_last: bool = True
    ) -> None:
        check_spline_runs(samples.points)
        # Sorting by name makes the search for extremes independent of the parameters' order.
        self.order = np.argsort(samples.source["parameter"].values, kind="stable")
        self.samples, self.points = samples, samples.points[:, self.order]
        runs: list[dict] = [{} for _ in self.points]
        if all(name in samples.source for name in EVENT_NAMES):
            columns = [samples.source[name].values for name in EVENT_NAMES]
            runs = name_events(np.stack(columns, axis=-1))
        self.parts = split_runs(self.points, samples.values, samples.time, runs, with_last)
        groups = [runs, *([runs[row] for row in part.rows] for part in self.parts)]
        self.has_groups = any(has_groups(group, samples.time) for group in groups)
        self.differ, self.part_error = first_difference(runs), np.zeros(samples.values.shape[1:])
        self.doubts: dict[str, float] = {}  # times (s) from which bounds are in doubt
        if len(self.parts) == 1:
            self.part_error = difference_across(self.points, samples.values, samples.time, runs)
            if self.part_error.any():
                self.doubts["undivided_from"] = self.differ
        if "event_margin" in samples.source:
            margins = samples.source["event_margin"].values
            start = unseen_difference(self.points, margins, samples.time, runs)
            if start < np.inf:  # a run there may be wherever runs are at any time
                self.doubts["unseen_from"] = start
                reach = np.ptp(samples.values, axis=(0, 2))[:, None] * (samples.time >= start)
                self.part_error = np.maximum(self.part_error, reach)
        self.end_time = min(part.curves.end_time for part in self.parts)
        count = max(part.curves.times.shape[1] for part in self.parts)
        self.attributes = {
            "design_runs": len(self.points),
            "error_kind": "difference of a run and the aligned splines through the others",
            "aligned_events": count,
        }

    @cached_property
    def left_out(self) -> np.ndarray:
        """Values (R, n, T) of runs less those of the splines through all others; NaN for those
        that are nearly the same as others, and behind `end_time`."""
        values = np.full(self.samples.values.shape, np.nan)
        for part in self.parts:
            values[part.rows] = part.curves.left_out
        values[:, :, self.samples.time > self.end_time] = np.nan
        return values

    def range(self, columns: np.ndarray | None = None) -> Range:
        values, time = self.samples.values, self.samples.time
        columns = np.ones(values.shape[1:], bool) if columns is None else columns
        columns = columns & (time <= self.end_time)
        sides, window = [], _WINDOWS[len(self.parts) > 1]
        self.model_error = np.zeros(columns.shape)
        for sign in (-1.0, 1.0):
            run = (sign * values).argmax(axis=0)
            best = sign * np.take_along_axis(values, run[None], axis=0)[0]
            x = self.points[run]
            near_values = best.copy()
            for part in self.parts:
                values_of_part, places, border_values = part.maximum(
                    sign, columns, window * (time[-1] - time[0])
                )
                near_values[columns] = np.maximum(near_values[columns], border_values)
                better = values_of_part > best[columns]
                best[columns] = np.where(better, values_of_part, best[columns])
                x[columns] = np.where(better[:, None], places, x[columns])
            self.model_error = np.maximum(self.model_error, near_values - best)
            sides += [sign * best, x[..., np.argsort(self.order)]]
        low, x_low, high, x_high = sides
        return to_range(low, high, x_low, x_high)

    def error(self, bounds: Range, columns: np.ndarray | None = None) -> ErrorEstimate:
        time, total = self.samples.time, self.model_error.copy()
        sides = (bounds.inner_lower, bounds.argmin), (bounds.inner_upper, bounds.argmax)
        for curve, x in sides:
            points, shifts = x[..., self.order].reshape(-1, x.shape[-1]), np.zeros(curve.size)
            for part in self.parts:
                is_inside = part.contains(points)
                shifts[is_inside] = part.curves.shifts(points[is_inside])
            total = total + change_within(time, curve, shifts.reshape(curve.shape))
        is_beyond = time > self.end_time
        width = bounds.inner_upper - bounds.inner_lower
        total[:, is_beyond] = widen(time, width, time[-1] - self.end_time)[:, is_beyond]
        total = np.maximum(total, self.part_error)
        return ErrorEstimate(total, total, np.zeros_like(total))

    def centre(self) -> np.ndarray:
        point = np.zeros((1, self.points.shape[1]))
        part = next((part for part in self.parts if part.contains(point)[0]), self.parts[0])
        return part.curves.evaluate(point, self.samples.time)[0]


class AutoModel(Model):
    """For each response and stretch of time the model that predicts left-out runs best: polynomial,
    spline or aligned splines.

    Stretches end where the first or last of the runs has an event at which curves are aligned. All
    runs decide between spline and aligned splines, those that the polynomial is not fitted to
    between the better one and the polynomial."""

    kind = "attained range of the model that predicts left-out runs best"

    def __init__(self, samples: Samples, design: Design | None = None) -> None:
        self.samples = samples
        self.fits: list[Model] = []
        if design is not None and len(design.multi_indices):
            self.fits.append(PolynomialModel(samples, design))
        alignment = None
        if len(samples.points) <= AUTO_RUNS or not self.fits:
            with suppress(IntervalError):
                self.fits.append(SplineModel(samples, design))
            for with_last in (True, False):
                if alignment is not None and not alignment.has_groups:
                    break  # the second fit would equal the first
                with suppress(IntervalError):
                    fit = AlignedModel(samples, design, with_last)
                    count = fit.attributes["aligned_events"]
                    if alignment is None or count < alignment.attributes["aligned_events"]:
                        self.fits += [fit] if count else []
                        alignment = alignment or fit
        if not self.fits:
            raise IntervalError("runs", len(samples.points), "more runs for a polynomial or spline")
        self.choice = self._choose(alignment)
        self.part_error = np.zeros(1) if alignment is None else alignment.part_error
        self.test_rows = self.fits[0].test_rows
        names = [next(n for n, kind in MODELS.items() if type(fit) is kind) for fit in self.fits]
        self.attributes = {**self.fits[-1].attributes, "models": names}
        self.attributes |= alignment.doubts if alignment else {}

    def _choose(self, alignment: AlignedModel | None) -> np.ndarray:
        """Choose for each response and instant the model with the least left-out error; return
        indices (n, T)."""
        time, choice = self.samples.time, np.zeros(self.samples.values.shape[1:], int)
        step = (time[-1] - time[0]) / (len(time) - 1)  # rates may change one instant early
        errors = [getattr(fit, "left_out") for fit in self.fits]  # noqa: B009  # splines have it
        ends = [time[0], np.inf]
        if alignment is not None:
            ends.append(min(alignment.differ, time[-1]))
        for part in alignment.parts if alignment else ():
            first, last = part.curves.time_ranges()
            ends += [*first - step, *last + step, part.curves.end_time]
        tests = self.fits[0].test_rows
        splines = int(isinstance(self.fits[0], PolynomialModel))  # index of the first spline
        for first, last in pairwise(np.searchsorted(time, np.unique(ends))):
            start = splines
            if alignment and len(alignment.parts) > 1 and time[last - 1] > alignment.differ:
                start += 1  # only aligned splines follow an event in part of the box
            best = np.zeros(len(choice), int)
            if len(errors) > start:
                loss = np.array([_mean_square(e[:, :, first:last]) for e in errors[start:]])
                best = loss.argmin(axis=0) + start
            if splines and start == splines and len(tests):
                loss = np.array([_mean_square(e[tests, :, first:last]) for e in errors])
                # The polynomial is used only if clearly better: the spline also gets these runs.
                best = np.where(2 * loss[0] <= loss[best, np.arange(len(best))], 0, best)
            choice[:, first:last] = np.reshape(best, (-1, 1))
        return choice

    def range(self, columns: np.ndarray | None = None) -> Range:
        ranges = [fit.range(self.choice == i) for i, fit in enumerate(self.fits)]
        return self._join(ranges)

    def error(self, bounds: Range, columns: np.ndarray | None = None) -> ErrorEstimate:
        pairs = enumerate(self.fits)
        error = self._join([fit.error(bounds, self.choice == i) for i, fit in pairs])
        return replace(error, total=np.maximum(error.total, self.part_error))

    def _join(self, results: list) -> Any:
        """Join the models' Ranges or ErrorEstimates into one, with the chosen model's values at
        each instant."""
        arrays_by_name = {}
        for name in results[0].__dataclass_fields__:
            arrays = np.array([getattr(result, name) for result in results])
            choice = self.choice.reshape(1, *self.choice.shape, *[1] * (arrays.ndim - 3))
            arrays_by_name[name] = np.take_along_axis(arrays, choice, axis=0)[0]
        return replace(results[0], **arrays_by_name)

    def centre(self) -> np.ndarray:
        return np.asarray(self.fits[0].centre())

    def variables(self) -> dict:
        text = "model whose bounds these are, by its index in the attribute models"
        return {"model": (("response", "time"), self.choice, {"long_name": text})}


def _errors_within(errors: np.ndarray, columns: np.ndarray | None) -> np.ndarray:
    """Return errors (n, T) with 0 wherever the mask `columns` (n, T), if given, is False."""
    return errors if columns is None else np.where(columns, errors, 0.0)


def _mean_square(errors: np.ndarray) -> np.ndarray:
    """Mean squares (n) of left-out errors (R, n, T), infinite where none is known."""
    is_known = np.isfinite(errors).sum(axis=(0, 2))
    squares = np.where(np.isfinite(errors), errors, 0.0) ** 2
    return np.where(is_known > 0, squares.sum(axis=(0, 2)) / np.maximum(is_known, 1), np.inf)


MODELS: dict[str, type[Model]] = {
    "polynomial": PolynomialModel,
    "spline": SplineModel,
    "scan": ScanModel,
    "aligned": AlignedModel,
    "auto": AutoModel,
}
