"""Splines through all runs as a model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...designs import Design
from ...errors import IntervalError
from ...estimates import AVERAGED, ErrorEstimate, error_estimate, usual
from ...points import other_runs
from ...ranges import Range
from ...samples import Samples
from ..model import Model
from .search import spline_range
from .solve import distinct
from .spline import fit_spline

MAX_RUNS = 4000  # the spline's matrix is full


def check_spline_runs(points: np.ndarray) -> None:
    """Raise `IntervalError` unless runs at unit points (N, k) give a spline's bounds and error.

    There must be at most `MAX_RUNS`, and there must be a spline through all of them but any one,
    which takes runs that are not in one plane. One run will do for a box without width.
    """
    points = np.asarray(points, dtype=float)
    if len(points) > MAX_RUNS:
        raise IntervalError("runs", len(points), f"at most {MAX_RUNS} runs for a spline")
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
        # Scales and extremes are sought one direction after the other: by name, so that the order
        # in which a dataset has its parameters does not matter.
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
        from scipy.spatial import cKDTree

        scales = self.spline.scales
        tree = cKDTree(self.spline.points * scales)
        _, near = tree.query(at * scales, k=min(count, len(self.spline.points)))
        n, instants = np.indices(at.shape[:2])
        return np.abs(self.spline.left_out[near, n[..., None], instants[..., None]]).max(axis=-1)

    def centre(self) -> np.ndarray:
        return self.spline.evaluate(np.zeros((1, self.spline.points.shape[1])))[0]
