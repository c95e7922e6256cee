"""Reading samples datasets and writing bounds datasets: names, units, attributes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import metrics
from .errors import ErrorEstimate
from .exceptions import IntervalError

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Samples:
    """The arrays of a samples dataset that the interval side works on.

    `time` (T) in s, `unit` (R, k), `values` (R, n, T) for n responses `names`, `nominal` the index
    of the nominal run or None, `source` the dataset itself.
    """

    names: list[str]
    time: np.ndarray
    unit: np.ndarray
    values: np.ndarray
    nominal: int | None
    source: xr.Dataset


@dataclass(frozen=True)
class Bounds:
    """Bounds of n responses: values (n, T), arguments (n, T, k) in unit coordinates."""

    lower: np.ndarray
    upper: np.ndarray
    inner_lower: np.ndarray
    inner_upper: np.ndarray
    argmin: np.ndarray
    argmax: np.ndarray


def read_samples(
    samples: xr.Dataset, responses: Sequence[str] | None = None, values: bool = True
) -> Samples:
    """Check a samples dataset and take its arrays out; without `values` the responses stay put."""
    for name in ("time", "unit", "value"):
        if name not in samples:
            raise IntervalError("samples", list(samples.variables), f"a dataset with {name}")
    known = [str(n) for n, v in samples.data_vars.items() if v.dims == ("run", "time")]
    names = known if responses is None else [str(n) for n in responses]
    for name in names:
        if name not in known:
            raise IntervalError("response", name, "one of " + ", ".join(known))
    if not names:
        raise IntervalError("samples", list(samples.data_vars), "variables over (run, time)")
    stacked = np.empty((len(samples["unit"]), len(names), 0))
    if values:
        stacked = np.stack([samples[name].values for name in names], axis=1).astype(float)
    bad = [n for i, n in enumerate(names) if not np.isfinite(stacked[:, i]).all()]
    if bad:
        raise IntervalError("samples", ", ".join(bad), "finite responses in every run")
    nominal = None
    if "role" in samples:
        found = np.flatnonzero(samples["role"].values.astype(str) == "nominal")
        nominal = int(found[0]) if len(found) else None
    return Samples(
        names,
        np.asarray(samples["time"].values, dtype=float),
        np.asarray(samples["unit"].values, dtype=float),
        stacked,
        nominal,
        samples,
    )


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


def unit_to_value(samples: xr.Dataset) -> Callable[[np.ndarray], np.ndarray]:
    """Function from unit coordinates (..., k) to parameter values, told by the runs themselves."""
    unit = np.asarray(samples["unit"].values, dtype=float)
    value = np.asarray(samples["value"].values, dtype=float)
    middle, half = value.mean(axis=0), np.zeros(unit.shape[1])
    for j in range(unit.shape[1]):
        a, b = unit[:, j].argmin(), unit[:, j].argmax()
        if unit[b, j] > unit[a, j]:
            half[j] = (value[b, j] - value[a, j]) / (unit[b, j] - unit[a, j])
            middle[j] = value[a, j] - half[j] * unit[a, j]
    return lambda u: middle + half * u


def bounds_to_dataset(
    samples: Samples,
    bounds: Bounds,
    centre: np.ndarray | None,
    error: ErrorEstimate | None,
    tested: np.ndarray,
    attrs: dict,
) -> xr.Dataset:
    """Bounds dataset over time and parameter.

    `centre` (n, T) is the nominal run, or the model at the centre of the box; `tested` are the
    indices of the runs that did not enter the bounds, `attrs` further attributes.
    """
    import xarray as xr

    to_value = unit_to_value(samples.source)
    data: dict = {}
    for i, name in enumerate(samples.names):
        own = samples.source[name].attrs
        label = own.get("long_name", name)
        units = {"units": own["units"]} if "units" in own else {}
        curves = {
            "lower": ("lower bound of", bounds.lower[i]),
            "upper": ("upper bound of", bounds.upper[i]),
            "inner_lower": ("attained lower bound of", bounds.inner_lower[i]),
            "inner_upper": ("attained upper bound of", bounds.inner_upper[i]),
        }
        if centre is not None:
            text = "nominal run of" if samples.nominal is not None else "model at the centre of"
            curves["nominal"] = (text, centre[i])
        if error is not None:
            curves["error"] = ("estimated error of the bounds of", error.total[i])
            curves["error_held_out"] = ("largest error at the held-out runs of", error.held_out[i])
            curves["error_decay"] = ("error foretold by the coefficients of", error.decay[i])
        for suffix, (text, values) in curves.items():
            data[f"{name}_{suffix}"] = ("time", values, {"long_name": f"{text} {label}", **units})
        for suffix, side, unit in (
            ("argmin", "lower", bounds.argmin[i]),
            ("argmax", "upper", bounds.argmax[i]),
        ):
            text = {"long_name": f"parameters at the {side} bound of {label}"}
            data[f"{name}_{suffix}"] = (("time", "parameter"), to_value(unit), text)
        numbers = _numbers(samples.time, bounds, i)
        if len(tested):
            own_runs = samples.values[tested, i]
            numbers |= metrics.compare_runs(bounds.lower[i], bounds.upper[i], own_runs)
        data[f"{name}_lower"][2].update(numbers)
        data[f"{name}_upper"][2].update(numbers)
        if error is not None:
            told = _error_numbers(samples.time, bounds.upper[i] - bounds.lower[i], error.total[i])
            data[f"{name}_error"][2].update(numbers | told)
    coords = {"time": samples.source["time"]}
    if "parameter" in samples.source.coords:
        coords["parameter"] = samples.source["parameter"]
    attrs = {
        **samples.source.attrs,
        "responses": " ".join(samples.names),
        "held_out_runs": len(tested),
        **attrs,
    }
    return xr.Dataset(data, coords=coords, attrs=attrs)


def _numbers(time, bounds, i) -> dict[str, float]:
    """Summary numbers of one response: largest width, when, and the gap of the enclosure."""
    width = bounds.upper[i] - bounds.lower[i]
    inner = bounds.inner_upper[i] - bounds.inner_lower[i]
    at, area = int(np.argmax(width)), metrics.integral(time, width)
    gap = metrics.integral(time, width - inner)
    return {
        "largest_width": float(width[at]),
        "largest_width_time": float(time[at]),
        "gap_share_of_width": gap / area if area > 0 else 0.0,
    }


def _error_numbers(time, width, error) -> dict[str, float]:
    area, worst = metrics.integral(time, width), int(np.argmax(error))
    return {
        "largest_error": float(error[worst]),
        "largest_error_time": float(time[worst]),
        "error_share_of_width": metrics.integral(time, error) / area if area > 0 else 0.0,
    }
