"""Bounds of every response at every instant: from a samples dataset to a bounds dataset."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from . import errors, metrics
from .designs import Design
from .exceptions import IntervalError
from .ranges import surrogate_range
from .surrogate import fit

if TYPE_CHECKING:
    import xarray as xr


def bounds_dataset(
    samples: xr.Dataset,
    design: Design,
    responses: Sequence[str] | None = None,
    *,
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
    import xarray as xr

    names = response_names(samples, responses)
    time = np.asarray(samples["time"].values, dtype=float)
    unit = np.asarray(samples["unit"].values, dtype=float)
    stacked = np.stack([samples[name].values for name in names], axis=1)  # (run, response, time)
    if not np.isfinite(stacked).all():
        bad = [n for i, n in enumerate(names) if not np.isfinite(stacked[:, i]).all()]
        raise IntervalError("samples", ", ".join(bad), "finite responses in every run")
    nominal = nominal_run(samples)
    plain = not len(design.multi_indices)
    if plain:
        low_at, high_at = stacked.argmin(axis=0), stacked.argmax(axis=0)
        lower, upper = stacked.min(axis=0), stacked.max(axis=0)
        inner_lower, inner_upper = lower, upper
        argmin, argmax = unit[low_at], unit[high_at]
        error = None
        centre = None if nominal is None else stacked[nominal]
        tested = np.arange(0)
    else:
        nodes = match_points(design.points, unit)
        surrogate = fit(design, stacked[nodes])
        found = surrogate_range(surrogate, tolerance)
        lower, upper = found.lower, found.upper
        inner_lower, inner_upper = found.inner_lower, found.inner_upper
        argmin, argmax = found.argmin, found.argmax
        tested = other_runs(unit, design.points)
        error = errors.error_estimate(surrogate, time, unit[tested], stacked[tested], window)
        if nominal is None:
            centre = surrogate.evaluate(np.zeros((1, design.dimension)))[0]
        else:
            centre = stacked[nominal]
    to_values = _unit_to_value(samples)

    data = {}
    for i, name in enumerate(names):
        source = samples[name].attrs
        label = source.get("long_name", name)
        units = {"units": source["units"]} if "units" in source else {}

        def put(suffix, values, text, label=label, units=units, name=name):
            attrs = {"long_name": f"{text} {label}", **units}
            data[f"{name}_{suffix}"] = ("time", values, attrs)

        put("lower", lower[i], "lower bound of")
        put("upper", upper[i], "upper bound of")
        put("inner_lower", inner_lower[i], "attained lower bound of")
        put("inner_upper", inner_upper[i], "attained upper bound of")
        if centre is not None:
            source = "nominal run of" if nominal is not None else "surrogate at the centre of"
            put("nominal", centre[i], source)
        for suffix, arguments in (("argmin", argmin), ("argmax", argmax)):
            side = "lower" if suffix == "argmin" else "upper"
            attrs = {"long_name": f"parameters at the {side} bound of {label}"}
            data[f"{name}_{suffix}"] = (("time", "parameter"), to_values(arguments[i]), attrs)
        if error is not None:
            put("error", error.total[i], "estimated error of the bounds of")
            put("error_held_out", error.held_out[i], "largest error at the held-out runs of")
            put("error_decay", error.decay[i], "error foretold by the coefficients of")
            numbers = _numbers(
                time, lower[i], upper[i], inner_lower[i], inner_upper[i], error.total[i]
            )
            numbers |= metrics.compare_runs(lower[i], upper[i], stacked[tested, i])
            data[f"{name}_error"][2].update(numbers, held_out_runs=len(tested))

    attrs = dict(samples.attrs)
    attrs.update(
        responses=" ".join(names),
        design_method=design.method,
        design_order=list(design.order),
        design_runs=design.runs if not plain else len(unit),
        held_out_runs=len(tested),
    )
    coords = {"time": samples["time"]}
    if "parameter" in samples.coords:
        coords["parameter"] = samples["parameter"]
    return xr.Dataset(data, coords=coords, attrs=attrs)


def _numbers(time, lower, upper, inner_lower, inner_upper, error) -> dict[str, float]:
    """Summary numbers of one response: widths, gap and error, with the times of the largest."""
    width = upper - lower
    area = metrics.integral(time, width)
    at, worst = int(np.argmax(width)), int(np.argmax(error))
    gap = metrics.integral(time, (inner_lower - lower) + (upper - inner_upper))
    share = metrics.integral(time, error) / area if area > 0 else 0.0
    return {
        "largest_width": float(width[at]),
        "largest_width_time": float(time[at]),
        "largest_error": float(error[worst]),
        "largest_error_time": float(time[worst]),
        "error_share_of_width": float(share),
        "gap_share_of_width": float(gap / area) if area > 0 else 0.0,
    }


def response_names(samples: xr.Dataset, responses: Sequence[str] | None) -> list[str]:
    """Names of the responses, after checking that the samples have them."""
    known = [str(n) for n, v in samples.data_vars.items() if v.dims == ("run", "time")]
    names = known if responses is None else [str(n) for n in responses]
    for name in names:
        if name not in known:
            raise IntervalError("response", name, "one of " + ", ".join(known))
    if not names:
        raise IntervalError("samples", list(samples.data_vars), "variables over (run, time)")
    return names


def nominal_run(samples: xr.Dataset) -> int | None:
    """Index of the run whose role is nominal, None if there is none."""
    if "role" not in samples:
        return None
    found = np.flatnonzero(samples["role"].values.astype(str) == "nominal")
    return int(found[0]) if len(found) else None


def match_points(points: np.ndarray, unit: np.ndarray, tolerance: float = 1e-8) -> np.ndarray:
    """Index (N) of the run at each design point; runs are known by their coordinates, not place."""
    found = np.full(len(points), -1)
    for i, point in enumerate(points):
        distance = np.abs(unit - point).max(axis=1) if len(unit) else np.array([np.inf])
        at = int(distance.argmin())
        if distance[at] <= tolerance:
            found[i] = at
    missing = np.flatnonzero(found < 0)
    if len(missing):
        first = np.round(points[missing[0]], 6).tolist()
        raise IntervalError(
            "samples",
            f"no run at {len(missing)} of {len(points)} design points, the first at unit {first}",
            "a run at every point of the design",
        )
    return found


def other_runs(unit: np.ndarray, points: np.ndarray, tolerance: float = 1e-8) -> np.ndarray:
    """Indices of the runs that are at none of the design's points."""
    far = np.ones(len(unit), dtype=bool)
    for point in points:
        far &= np.abs(unit - point).max(axis=1) > tolerance
    return np.flatnonzero(far)


def _unit_to_value(samples: xr.Dataset):
    """Function from unit coordinates (..., k) to parameter values, from the runs themselves."""
    unit = np.asarray(samples["unit"].values, dtype=float)
    value = np.asarray(samples["value"].values, dtype=float)
    middle, half = value.mean(axis=0), np.zeros(unit.shape[1])
    for j in range(unit.shape[1]):
        spread = unit[:, j].max() - unit[:, j].min()
        if spread > 0:
            a, b = unit[:, j].argmin(), unit[:, j].argmax()
            half[j] = (value[b, j] - value[a, j]) / spread
            middle[j] = value[a, j] - half[j] * unit[a, j]
    return lambda u: middle + half * u
