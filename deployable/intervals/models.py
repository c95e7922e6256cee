"""Models of the responses over the box, from which bounds are taken."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy

from .box import match_points, other_runs
from .designs import Design, fit
from .estimates import (
    AVERAGED,
    ErrorEstimate,
    decay_estimate,
    error_estimate,
    overruled,
    share_outside,
    usual,
)
from .ranges import Range, attained, surrogate_range
from .samples import Running, Samples
from .spline_extremes import spline_range
from .splines import check_spline_runs, fit_spline


class Model:
    """A model of n responses over the box, at T instants, for k parameters.

    A new model is a subclass and a line in `MODELS`. Its constructor fits it;
    further keyword-only arguments of that are the options that a user has.

    Attributes
    ----------
    kind
        What its bounds are; "enclosed ..." or "attained ..." where they are a model's range.
    tested
        Indices of the runs that were not fitted, and test it.
    attributes
        What else a bounds dataset tells of it.
    """

    kind: str
    tested: np.ndarray = np.zeros(0, dtype=int)
    attributes: dict

    def __init__(self, samples: Samples, design: Design | None) -> None:
        raise NotImplementedError

    def range(self) -> Range:
        """Its range (n, T) over the box, arguments (n, T, k) in unit coordinates."""
        raise NotImplementedError

    def error(self, found: Range, window: float | None) -> ErrorEstimate:
        """Estimated error (n, T) of the bounds that `range` found; `window` as in `widen`."""
        raise NotImplementedError

    def centre(self) -> np.ndarray | None:
        """Its values (n, T) at the centre of the box, if it has any there."""
        return None

    def variables(self) -> dict:
        """Further variables of a bounds dataset, by name."""
        return {}


class PolynomialModel(Model):
    """Chebyshev polynomials, whose range is enclosed. The other runs test them.

    `tolerance` is the gap between outer and inner range at which subdivision stops, as a share of
    the width.
    """

    kind = "enclosed range of the polynomial"

    def __init__(self, samples: Samples, design: Design, *, tolerance: float = 1e-3) -> None:
        self.samples, self.tolerance = samples, tolerance
        self.tested = other_runs(samples.unit, design.points)
        self.design = design
        self.surrogate = fit(design, samples.values[match_points(design.points, samples.unit)])
        self.attributes = {"design_runs": design.runs}

    def range(self) -> Range:
        return surrogate_range(self.surrogate, self.tolerance)

    def error(self, found: Range, window: float | None) -> ErrorEstimate:
        samples, surrogate = self.samples, self.surrogate
        unit, time = samples.unit[self.tested], samples.time
        missed = samples.values[self.tested] - surrogate.evaluate(unit)
        decay = decay_estimate(surrogate, time, window)
        decay = overruled(surrogate, self.design.points, unit, missed, decay, time, window)
        return error_estimate(time, np.abs(missed).max(axis=0, initial=0.0), decay, window)

    def centre(self) -> np.ndarray:
        return self.surrogate.evaluate(np.zeros((1, self.samples.unit.shape[1])))[0]


class ScanModel(Model):
    """No model: the runs themselves, whatever the design; there may be more than memory holds.

    A scan looks from the inside: its bounds grow with every sample and are never wider than the
    truth. How much they grew from the first half of the samples to all of them is its error: of the
    order of what is still missing, neither a bound nor blind, as the samples are not on a grid. How
    much they grew with the last quarter alone is in the dataset too, and which share of the box can
    be expected to leave the bounds at one instant (`estimates.share_outside`). Samples are read run
    by run in chunks, unless the dataset has the running bounds of each quarter (`quarters`).
    """

    kind = "least and largest sample"

    def __init__(self, samples: Samples, design: Design | None = None) -> None:
        self.unit, found = samples.unit, None
        grown = []
        for quarter in samples.quarters():
            found = quarter.merged(found) if quarter else found
            grown.append(found)
        self.found = found
        self.growth, self.growth_quarter = (_growth(before, found) for before in grown[1:3])
        drawn = len(self.unit) - _chosen(samples)
        self.attributes = {
            "design_runs": len(self.unit),
            "error_kind": "growth of the bounds from the first half of the samples to all",
            "drawn_runs": drawn,
            "share_outside": share_outside(drawn),
            "share_outside_95": share_outside(drawn, 0.95),
        }

    def range(self) -> Range:
        found = self.found
        return attained(found.low, found.high, self.unit[found.low_run], self.unit[found.high_run])

    def error(self, found: Range, window: float | None) -> ErrorEstimate:
        return ErrorEstimate(self.growth, self.growth, np.zeros_like(self.growth))

    def variables(self) -> dict:
        text = "growth of the bounds with the last quarter of the samples"
        return {"growth_quarter": (("response", "time"), self.growth_quarter, {"long_name": text})}


def _growth(before: Running | None, after: Running) -> np.ndarray:
    """By how much bounds grew, on the side where they grew more."""
    if before is None:
        return np.zeros_like(after.low)
    return np.maximum(before.low - after.low, after.high - before.high)


def _chosen(samples: Samples) -> int:
    """Runs that were not drawn: the nominal one, and corners of the box."""
    free = np.ptp(samples.unit, axis=0) > 0
    corners = (np.abs(samples.unit[:, free]) == 1.0).all(axis=1)
    if samples.nominal is not None:
        corners[samples.nominal] = True
    return int(corners.sum())


class SplineModel(Model):
    """One spline through all runs, whatever their design and role.

    Its bounds contain every run, and are attained by the spline or a run; they are no enclosure.
    The error is what a run and the spline through all the others differ by (its left-out error):

    - the largest over the runs inside the box and those that `design`, if given, does not contain
      (there the spline need not extrapolate), and in several directions over the runs next to
      where each bound is attained, one more than there are directions;
    - of runs that were sought where the bounds are decided (`design.method` "sought"), in up to
      three directions the mean over all of them, of a power as high as there are directions: any
      of them may be next to a bound. In more directions no run is near most corners, and the
      largest counts as of other runs.

    To it comes the largest difference between a run and the spline through all.
    """

    kind = "attained range of a spline through all runs"

    def __init__(self, samples: Samples, design: Design | None = None) -> None:
        check_spline_runs(samples.unit)
        # Scales and extremes are looked for in one direction after the other: by name, so that the
        # order in which a dataset has its parameters does not matter.
        self.order = np.argsort(samples.source["parameter"].values, kind="stable")
        unit = samples.unit[:, self.order]
        self.samples, self.spline = samples, fit_spline(unit, samples.values)
        points = self.spline.points
        judged = (np.abs(points) < 1).all(axis=1)
        if design is not None:
            judged[other_runs(points, design.points[:, self.order])] = True
        self.judged = judged if judged.any() else ~judged
        sought = design is not None and design.method == "sought"
        self.averages = sought and (self.spline.scales > 0).sum() <= AVERAGED
        self.attributes = {
            "design_runs": len(points),
            "error_kind": f"{'mean' if self.averages else 'largest'} difference of a run and the "
            "spline through the others",
            "spline_scales": self.spline.scales[self._back].tolist(),
        }

    @property
    def _back(self) -> np.ndarray:
        """Places of the dataset's parameters among the spline's."""
        return np.argsort(self.order)

    def range(self) -> Range:
        found = spline_range(self.spline)
        argmin, argmax = found.argmin[..., self._back], found.argmax[..., self._back]
        return replace(found, argmin=argmin, argmax=argmax)

    def error(self, found: Range, window: float | None) -> ErrorEstimate:
        spline = self.spline
        free = int((spline.scales > 0).sum())
        if self.averages:
            left_out = usual(spline.left_out, free)
        else:
            left_out = np.abs(spline.left_out[self.judged]).max(axis=0)
            if free > 1:
                for at in (found.argmin, found.argmax):
                    left_out = np.maximum(left_out, self._next_to(at[..., self.order], free + 1))
        left_out = left_out + spline.misfit
        return error_estimate(self.samples.time, left_out, np.zeros_like(left_out), window)

    def _next_to(self, at: np.ndarray, count: int) -> np.ndarray:
        """Largest left-out error (n, T) of the `count` runs nearest to unit points at (n, T, k)."""
        scales = self.spline.scales
        tree = scipy.spatial.cKDTree(self.spline.points * scales)
        _, near = tree.query(at * scales, k=min(count, len(self.spline.points)))
        n, instants = np.indices(at.shape[:2])
        return np.abs(self.spline.left_out[near, n[..., None], instants[..., None]]).max(axis=-1)

    def centre(self) -> np.ndarray:
        return self.spline.evaluate(np.zeros((1, self.spline.points.shape[1])))[0]


MODELS: dict[str, type[Model]] = {
    "polynomial": PolynomialModel,
    "spline": SplineModel,
    "scan": ScanModel,
}
