"""Bounds of every response at every instant: from a samples dataset to a bounds dataset."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import errors
from .datasets import Bounds, bounds_to_dataset, match_points, other_runs, read_samples
from .designs import Design
from .events import event_bounds_dataset
from .exceptions import IntervalError, check_choice
from .partition import SplitDesign, parts_of
from .ranges import surrogate_range
from .scan_bounds import scan_bounds_dataset
from .spline_bounds import spline_bounds_dataset
from .surrogate import fit

if TYPE_CHECKING:
    import xarray as xr

MODELS = ("polynomial", "spline", "aligned")


def bounds_dataset(
    samples: xr.Dataset,
    design: Design | SplitDesign,
    responses: Sequence[str] | None = None,
    *,
    model: str = "polynomial",
    tolerance: float = 1e-3,
    window: float | None = None,
    **options: Any,
) -> xr.Dataset:
    """Bounds of the responses over the box, with an error estimate at each instant.

    Parameters
    ----------
    samples
        Dimensions run, response, time, parameter; variables ``values`` (run, response, time),
        ``unit`` and ``value`` (run, parameter), ``role`` (run); coordinates ``time`` (s) and
        ``response`` (names), and ``response_units``, ``response_long_name`` (response) to be
        taken over.
    design
        Its points must be among the runs (recognised by their unit coordinates, in any order). All
        other runs, whatever their role, test the surrogate. A scan without order has no surrogate:
        its bounds are the least and the largest sample over all runs.
    responses
        Names; by default all.
    model
        "polynomial"; "spline": one cubic spline through all runs, those of a scan or held out
        included (see `spline_bounds_dataset`); or "aligned": polynomials in the time between
        events, with further `options` (see `event_bounds_dataset`).
    tolerance
        Gap between outer and inner range at which subdivision stops, as a share of the width.
    window
        Half width in s of the window of the error estimate (see `errors.widen`).

    Returns
    -------
    Dataset with ``lower``, ``upper`` (guaranteed for the surrogate), ``inner_lower``,
    ``inner_upper`` (attained), ``nominal`` and ``error`` (estimate for the bounds, with its parts
    ``error_held_out`` and ``error_decay``), each (response, time) in the units of the response;
    ``argmin``, ``argmax`` (response, time, parameter), the parameter values where; and the numbers
    of the summary over response, such as ``largest_width`` and ``error_share_of_width``.
    """
    if check_choice("model", model, MODELS) == "aligned":
        return event_bounds_dataset(samples, design, responses, window=window, **options)
    for key in options:
        raise IntervalError("option", key, f"none for model {model}")
    if model == "spline":
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
