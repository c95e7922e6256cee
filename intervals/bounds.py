"""Bounds of every response at every instant: from a samples dataset to a bounds dataset."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from . import errors
from .datasets import Bounds, bounds_to_dataset, match_points, other_runs, read_samples
from .designs import Design
from .exceptions import check_choice
from .partition import SplitDesign, parts_of
from .ranges import surrogate_range
from .scan_bounds import scan_bounds_dataset
from .spline_bounds import spline_bounds_dataset
from .surrogate import fit

if TYPE_CHECKING:
    import xarray as xr

MODELS = ("polynomial", "spline")


def bounds_dataset(
    samples: xr.Dataset,
    design: Design | SplitDesign,
    responses: Sequence[str] | None = None,
    *,
    model: str = "polynomial",
    tolerance: float = 1e-3,
    window: float | None = None,
) -> xr.Dataset:
    """Bounds of the responses over the box, with an error estimate at each instant.

    Parameters
    ----------
    samples
        Dimensions run, time, parameter; variables ``unit`` and ``value`` (run, parameter), ``role``
        (run), and one (run, time) for each response.
    design
        Its points must be among the runs (recognised by their unit coordinates, in any order). All
        other runs, whatever their role, test the surrogate. A scan without order has no surrogate:
        its bounds are the least and the largest sample over all runs.
    responses
        Names; by default every variable over (run, time).
    model
        "polynomial", or "spline": one cubic spline through all runs, those of a scan or held out
        included (see `spline_bounds_dataset`).
    tolerance
        Gap between outer and inner range at which subdivision stops, as a share of the width.
    window
        Half width in s of the window of the error estimate (see `errors.widen`).

    Returns
    -------
    Dataset over time and parameter with, for each response R: ``R_lower``, ``R_upper`` (guaranteed
    for the surrogate), ``R_inner_lower``, ``R_inner_upper`` (attained), ``R_argmin``, ``R_argmax``
    (parameter values where), ``R_nominal``, ``R_error`` (estimate for the bounds). Attributes of
    ``R_error`` hold the numbers of the summary.
    """
    if check_choice("model", model, MODELS) == "spline":
        return spline_bounds_dataset(samples, design, responses, window=window)
    attrs = {"design_method": design.method, "design_order": list(design.order)}
    if isinstance(design, Design) and not len(design.multi_indices):
        return scan_bounds_dataset(samples, responses, attrs)

    data = read_samples(samples, responses)
    tested = other_runs(data.unit, design.points)
    shape = data.values.shape[1:]
    held_out, decay, centre = np.zeros(shape), np.zeros(shape), None
    ranges = []
    for part in parts_of(design):
        surrogate = fit(part.design, data.values[match_points(part.points, data.unit)])
        found = surrogate_range(surrogate, tolerance)
        ranges.append((found, part))
        inside = tested[part.contains(data.unit[tested])]
        local = part.to_local(data.unit[inside])
        seen = errors.held_out_error(surrogate, local, data.values[inside])
        held_out = np.maximum(held_out, seen)
        decay = np.maximum(decay, errors.decay_estimate(surrogate, data.time, window))
        middle = np.zeros((1, design.dimension))
        if centre is None and part.contains(middle)[0]:
            centre = surrogate.evaluate(part.to_local(middle))[0]
    if data.nominal is not None:
        centre = data.values[data.nominal]
    total = errors.widen(data.time, np.maximum(held_out, decay), window)
    error = errors.ErrorEstimate(total, held_out, decay)
    attrs |= {"design_runs": design.runs, "bounds_kind": "enclosed range of the polynomial"}
    return bounds_to_dataset(data, _union(ranges), centre, error, tested, attrs)


def _union(ranges) -> Bounds:
    """Union of the ranges of all parts, arguments in the unit coordinates of the box."""
    first, part = ranges[0]
    union = Bounds(
        first.lower,
        first.upper,
        first.inner_lower,
        first.inner_upper,
        part.to_global(first.argmin),
        part.to_global(first.argmax),
    )
    for found, part in ranges[1:]:
        low, high = found.inner_lower < union.inner_lower, found.inner_upper > union.inner_upper
        union = Bounds(
            np.minimum(union.lower, found.lower),
            np.maximum(union.upper, found.upper),
            np.minimum(union.inner_lower, found.inner_lower),
            np.maximum(union.inner_upper, found.inner_upper),
            np.where(low[..., None], part.to_global(found.argmin), union.argmin),
            np.where(high[..., None], part.to_global(found.argmax), union.argmax),
        )
    return union
