"""Models of the responses over the box, from which bounds are taken."""

from dataclasses import replace
from typing import Any

import numpy as np
import scipy

from .box import find_other_runs, match_points
from .designs import Design, fit
from .estimates import (
    MAX_DIRECTIONS,
    ErrorEstimate,
    estimate_decay,
    estimate_error,
    limit_decay,
    power_mean,
    share_outside,
)
from .ranges import Range, find_surrogate_range, to_range
from .samples import RunBounds, Samples
from .spline_extremes import spline_range
from .splines import check_spline_runs, fit_spline


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

    def range(self) -> Range:
        """Range of the n responses over the box at T instants: outer bounds (n, T), guaranteed for
        the model where it can be enclosed, else the attained ones; attained bounds (n, T); and the
        points (n, T, k) in [-1, 1]^k where the latter are attained."""
        raise NotImplementedError

    def error(self, bounds: Range, window: float | None) -> ErrorEstimate:
        """Estimated error (n, T) of `bounds`, the result of `range`; window: half width (s) of the
        time in which the largest error counts, None: 0.5 % of the duration."""
        raise NotImplementedError

    def centre(self) -> np.ndarray | None:
        """Values (n, T) of the model at the centre of the box; None for a model without any."""
        return None

    def variables(self) -> dict:
        """Further variables of the bounds dataset by name: (dimensions, values, attributes)."""
        return {}


class PolynomialModel(Model):
    """Chebyshev polynomials fitted to the runs of `samples` at the points of `design`, with an
    enclosed range; all other runs test them: the error is the larger of the residuals there and the
    neglected tail of coefficients. tolerance: gap of enclosure and attained range at
    which to stop, as a fraction of the latter's width."""

    kind = "enclosed range of the polynomial"

    def __init__(self, samples: Samples, design: Design, *, tolerance: float = 1e-3) -> None:
        self.samples, self.tolerance = samples, tolerance
        self.test_rows = find_other_runs(samples.points, design.points)
        self.design = design
        self.surrogate = fit(design, samples.values[match_points(design.points, samples.points)])
        self.attributes = {"design_runs": design.run_count}

    def range(self) -> Range:
        return find_surrogate_range(self.surrogate, self.tolerance)

    def error(self, bounds: Range, window: float | None) -> ErrorEstimate:
        samples, surrogate = self.samples, self.surrogate
        points, time = samples.points[self.test_rows], samples.time
        residuals = samples.values[self.test_rows] - surrogate.evaluate(points)
        decay = estimate_decay(surrogate, time, window)
        decay = limit_decay(surrogate, self.design.points, points, residuals, decay, time, window)
        return estimate_error(time, np.abs(residuals).max(axis=0, initial=0.0), decay, window)

    def centre(self) -> np.ndarray:
        return self.surrogate.evaluate(np.zeros((1, self.samples.points.shape[1])))[0]


class ScanModel(Model):
    """Bounds by all runs, without a fit, whatever the design (ignored); they may exceed the memory.

    The bounds grow with every run and are never wider than the true ones. How much they grew from
    the first half of the runs to all of them is their error: an estimate of what is still missing,
    no limit. How much they grew with the last quarter alone is in the dataset too, and which share
    of the box can be expected to leave the bounds at one instant (`estimates.share_outside`).
    Samples are read in chunks of runs, unless the dataset has the extremes of each quarter."""

    kind = "least and largest sample"

    def __init__(self, samples: Samples, design: Design | None = None) -> None:
        self.points = samples.points
        total: Any = None
        totals = []
        for quarter in samples.quarters():
            total = quarter.merge(total) if quarter else total
            totals.append(total)
        self.total = total
        self.growth, self.growth_quarter = (_growth(part, total) for part in totals[1:3])
        draws = len(self.points) - _count_corners(samples)
        self.attributes = {
            "design_runs": len(self.points),
            "error_kind": "growth of the bounds from the first half of the samples to all",
            "drawn_runs": draws,
            "share_outside": share_outside(draws),
            "share_outside_95": share_outside(draws, 0.95),
        }

    def range(self) -> Range:
        total, points = self.total, self.points
        return to_range(total.low, total.high, points[total.low_run], points[total.high_run])

    def error(self, bounds: Range, window: float | None) -> ErrorEstimate:
        return ErrorEstimate(self.growth, self.growth, np.zeros_like(self.growth))

    def variables(self) -> dict:
        text = "growth of the bounds with the last quarter of the samples"
        return {"growth_quarter": (("response", "time"), self.growth_quarter, {"long_name": text})}


def _growth(previous: RunBounds | None, current: RunBounds) -> np.ndarray:
    """By how much bounds grew, on the side where they grew more."""
    if previous is None:
        return np.zeros_like(current.low)
    return np.maximum(previous.low - current.low, current.high - previous.high)


def _count_corners(samples: Samples) -> int:
    """Runs that were not drawn: the nominal one, and corners of the box."""
    free = np.ptp(samples.points, axis=0) > 0
    corners = (np.abs(samples.points[:, free]) == 1.0).all(axis=1)
    if samples.nominal is not None:
        corners[samples.nominal] = True
    return int(corners.sum())


class SplineModel(Model):
    """One spline through all runs (`samples`), whatever their role, as a model of the responses.

    Its bounds contain every run, and are attained by the spline or a run; they are no enclosure.
    The error is what a run and the spline through all the others differ by (its left-out error):

    - the largest over the runs inside the box and those that `design`, if given, does not contain
      (there the spline need not extrapolate), and in several directions over the runs next to where
      each bound is attained, one more than there are directions;
    - of runs that were sought where the bounds are decided (`design.method` "adaptive"), in up to
      three directions, instead a power mean over all of them (`estimates.power_mean`).

    Added is the largest difference between a run and the spline through all."""

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

    @property
    def _inverse(self) -> np.ndarray:
        """Places of the dataset's parameters among the spline's."""
        return np.argsort(self.order)

    def range(self) -> Range:
        bounds = spline_range(self.spline)
        argmin, argmax = bounds.argmin[..., self._inverse], bounds.argmax[..., self._inverse]
        return replace(bounds, argmin=argmin, argmax=argmax)

    def error(self, bounds: Range, window: float | None) -> ErrorEstimate:
        spline = self.spline
        free = int((spline.scales > 0).sum())
        if self.averages:
            left_out = power_mean(spline.left_out, free)
        else:
            left_out = np.abs(spline.left_out[self.tests_spline]).max(axis=0)
            if free > 1:
                for x in (bounds.argmin, bounds.argmax):
                    left_out = np.maximum(left_out, self._next_to(x[..., self.order], free + 1))
        left_out = left_out + spline.misfit
        return estimate_error(self.samples.time, left_out, np.zeros_like(left_out), window)

    def _next_to(self, points: np.ndarray, count: int) -> np.ndarray:
        """Largest left-out error (n, T) of the `count` runs nearest to unit points at (n, T, k)."""
        scales = self.spline.scales
        tree = scipy.spatial.cKDTree(self.spline.points * scales)
        rows = tree.query(points * scales, k=min(count, len(self.spline.points)))[1]
        places: Any = np.indices(points.shape[:2])
        n, instants = places
        return np.abs(self.spline.left_out[rows, n[..., None], instants[..., None]]).max(axis=-1)

    def centre(self) -> np.ndarray:
        return self.spline.evaluate(np.zeros((1, self.spline.points.shape[1])))[0]


MODELS: dict[str, type[Model]] = {
    "polynomial": PolynomialModel,
    "spline": SplineModel,
    "scan": ScanModel,
}
