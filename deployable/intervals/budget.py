"""One budget of errors: what the surrogate misses, and what else is known to be wrong."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from .estimates import widen

if TYPE_CHECKING:
    import xarray as xr

SURROGATE = "surrogate"


def add_errors(
    bounds: xr.Dataset, parts: Mapping[str, np.ndarray], window: float | None = None
) -> xr.Dataset:
    """Bounds whose ``error`` is the surrogate's and further parts together.

    `parts` (n, T each) are errors by name, such as those of a mesh, in the units of the responses.
    They are widened in time as the surrogate's is (see `estimates.widen`) and added to it. The
    dataset gets ``error_surrogate`` and ``error_<name>`` (response, time), and over response
    ``share_surrogate`` and ``share_<name>``, as shares of the width, both integrated over time;
    the numbers of ``error`` are those of the sum. NaN where a part is not known.
    """
    time = bounds["time"].values
    area = np.trapezoid((bounds["upper"] - bounds["lower"]).values, time)
    axes = ("response", "time")
    curves = {SURROGATE: bounds["error"].values}
    curves |= {name: widen(time, np.abs(values), window) for name, values in parts.items()}
    added = {}
    for name, values in curves.items():
        added[f"error_{name}"] = (axes, values, {"long_name": f"part of the error: {name}"})
        text = f"error of the {name}, as a share of the width"
        told = {"long_name": text, "units": "1"}
        added[f"share_{name}"] = ("response", share_of(values, time, area), told)
    total = np.sum(list(curves.values()), axis=0)
    worst, rows = total.argmax(axis=1), np.arange(len(total))
    numbers = {
        "error": total,
        "largest_error": total[rows, worst],
        "largest_error_time": time[worst],
        "error_share_of_width": share_of(total, time, area),
    }
    for name, values in numbers.items():
        added[name] = (bounds[name].dims, values, bounds[name].attrs)
    return bounds.assign(added).assign_attrs(error_parts=list(curves))


def share_of(error: np.ndarray, time: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Errors (n, T) integrated over time, as shares (n,) of the widths' integrals `area` (n,)."""
    found = np.trapezoid(error, time)
    return np.divide(found, area, out=np.zeros_like(found), where=area > 0)
