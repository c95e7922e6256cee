"""Bounds from splines through all runs of a samples dataset."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from . import errors
from .datasets import Bounds, bounds_to_dataset, other_runs, read_samples
from .designs import Design
from .exceptions import IntervalError
from .partition import SplitDesign
from .spline_solve import distinct
from .splines import fit_spline, spline_range

if TYPE_CHECKING:
    import xarray as xr

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


def spline_bounds_dataset(
    samples: xr.Dataset,
    design: Design | SplitDesign | None = None,
    responses: Sequence[str] | None = None,
    *,
    window: float | None = None,
) -> xr.Dataset:
    """Bounds of the responses, from one spline through all runs, whatever their design and role.

    They contain every run, and are attained by the spline or a run; they are no enclosure of it.
    The error is the largest difference between a run and the spline through all the others, over
    the runs inside the box and those that `design`, if given, does not contain (there the spline
    need not extrapolate), plus the largest difference between a run and the spline through all,
    widened in time like that of the polynomials (`errors.widen`).
    """
    data = read_samples(samples, responses)
    check_spline_runs(data.unit)
    spline = fit_spline(data.unit, data.values)
    found = spline_range(spline)
    judged = (np.abs(spline.points) < 1).all(axis=1)
    attrs = {}
    if design is not None:
        judged[other_runs(spline.points, design.points)] = True
        attrs = {"design_method": design.method, "design_order": list(design.order)}
    judged = judged if judged.any() else ~judged
    left_out = np.abs(spline.left_out[judged]).max(axis=0) + spline.misfit
    total = errors.widen(data.time, left_out, window)
    error = errors.ErrorEstimate(total, left_out, np.zeros_like(left_out))
    centre = spline.evaluate(np.zeros((1, spline.points.shape[1])))[0]
    if data.nominal is not None:
        centre = data.values[data.nominal]
    bounds = Bounds(
        found.lower,
        found.upper,
        found.inner_lower,
        found.inner_upper,
        found.argmin,
        found.argmax,
    )
    attrs |= {
        "design_runs": len(spline.points),
        "bounds_kind": "attained range of a spline through all runs",
        "error_kind": "largest difference of a run and the spline through the others",
        "spline_scales": spline.scales.tolist(),
    }
    return bounds_to_dataset(data, bounds, centre, error, np.arange(0), attrs)
