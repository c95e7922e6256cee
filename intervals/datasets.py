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


# Coordinates that every dataset made of a samples dataset takes over, those that are there.
_COORDINATES = (
    "time",
    "response",
    "response_units",
    "response_long_name",
    "parameter",
    "box_units",
    "box_lower",
    "box_upper",
    "box_nominal",
)


@dataclass(frozen=True)
class Samples:
    """The arrays of a samples dataset that the interval side works on.

    `names` (n) of the responses and `rows` (n), their places in the dataset `source`; `time` (T)
    in s, `unit` (R, k), `values` (R, n, T), `nominal` the index of the nominal run or None.
    """

    names: list[str]
    rows: list[int]
    time: np.ndarray
    unit: np.ndarray
    values: np.ndarray
    nominal: int | None
    source: xr.Dataset

    def coordinates(self) -> dict:
        """Coordinates of a dataset of these responses over time and parameter, by name."""
        found = {n: self.source[n].variable for n in _COORDINATES if n in self.source}
        return {n: v.isel(response=self.rows, missing_dims="ignore") for n, v in found.items()}


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
    """Check a samples dataset and take its arrays out; without `values` the responses stay put.

    Variables ``values`` (run, response, time), ``unit`` and ``value`` (run, parameter); coordinates
    ``time`` and ``response``. By default all responses are taken.
    """
    for name in ("time", "response", "values", "unit", "value"):
        if name not in samples:
            raise IntervalError("samples", list(samples.variables), f"a dataset with {name}")
    known = [str(name) for name in samples["response"].values]
    names = known if responses is None else [str(n) for n in responses]
    for name in names:
        if name not in known:
            raise IntervalError("response", name, "one of " + ", ".join(known))
    if not names:
        raise IntervalError("responses", names, "at least one")
    rows = [known.index(name) for name in names]
    unit = np.asarray(samples["unit"].values, dtype=float)
    stacked = np.empty((len(unit), len(names), 0))
    if values:
        stacked = samples["values"].values
        if names != known:
            stacked = stacked[:, rows]
        stacked = np.asarray(stacked, dtype=float)
    bad = [n for i, n in enumerate(names) if not np.isfinite(stacked[:, i]).all()]
    if bad:
        raise IntervalError("samples", ", ".join(bad), "finite responses in every run")
    nominal = None
    if "role" in samples:
        found = np.flatnonzero(samples["role"].values.astype(str) == "nominal")
        nominal = int(found[0]) if len(found) else None
    time = np.asarray(samples["time"].values, dtype=float)
    return Samples(names, rows, time, unit, stacked, nominal, samples)


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
    """Bounds dataset over response, time and parameter.

    `centre` (n, T) is the nominal run, or the model at the centre of the box; `tested` are the
    indices of the runs that did not enter the bounds, `attrs` further attributes.
    """
    import xarray as xr

    text = "nominal run" if samples.nominal is not None else "model at the centre of the box"
    curves = [
        ("lower", bounds.lower, "lower bound"),
        ("upper", bounds.upper, "upper bound"),
        ("inner_lower", bounds.inner_lower, "attained lower bound"),
        ("inner_upper", bounds.inner_upper, "attained upper bound"),
    ]
    if centre is not None:
        curves.append(("nominal", centre, text))
    if error is not None:
        curves += [
            ("error", error.total, "estimated error of the bounds"),
            ("error_held_out", error.held_out, "largest error at the held-out runs"),
            ("error_decay", error.decay, "error foretold by the coefficients"),
        ]
    to_value = unit_to_value(samples.source)
    data: dict = {
        name: (("response", "time"), values, {"long_name": text}) for name, values, text in curves
    }
    for name, unit, side in (
        ("argmin", bounds.argmin, "lower"),
        ("argmax", bounds.argmax, "upper"),
    ):
        axes, text = ("response", "time", "parameter"), f"parameters at the {side} bound"
        data[name] = (axes, to_value(unit), {"long_name": text})
    rows = [_numbers(samples, bounds, error, tested, i) for i in range(len(samples.names))]
    for name in rows[0]:
        long_name, unit = _NUMBERS[name]
        attributes = {"long_name": long_name} | ({"units": unit} if unit else {})
        data[name] = ("response", [row[name] for row in rows], attributes)
    attrs = {**samples.source.attrs, "held_out_runs": len(tested), **attrs}
    return xr.Dataset(data, coords=samples.coordinates(), attrs=attrs)


# Numbers of a response: long name and unit; without one it is that of the response.
_NUMBERS = {
    "largest_width": ("largest difference of the bounds", ""),
    "largest_width_time": ("time of the largest difference of the bounds", "s"),
    "gap_share_of_width": ("gap between outer and attained bounds, as a share of the width", "1"),
    "coverage": ("share of the runs that were not fitted within the bounds", "1"),
    "worst_violation": ("distance by which such runs leave the bounds at most", ""),
    "largest_error": ("largest estimated error of the bounds", ""),
    "largest_error_time": ("time of the largest estimated error of the bounds", "s"),
    "error_share_of_width": ("estimated error of the bounds, as a share of the width", "1"),
}


def _numbers(
    samples: Samples, bounds: Bounds, error: ErrorEstimate | None, tested: np.ndarray, i: int
) -> dict[str, float]:
    """The summary numbers of response `i`."""
    time, width = samples.time, bounds.upper[i] - bounds.lower[i]
    inner = bounds.inner_upper[i] - bounds.inner_lower[i]
    at, area = int(np.argmax(width)), metrics.integral(time, width)
    numbers = {
        "largest_width": float(width[at]),
        "largest_width_time": float(time[at]),
        "gap_share_of_width": metrics.integral(time, width - inner) / area if area > 0 else 0.0,
    }
    if len(tested):
        own = samples.values[tested, i]
        numbers |= metrics.compare_runs(bounds.lower[i], bounds.upper[i], own)
    if error is not None:
        total = error.total[i]
        worst = int(np.argmax(total))
        numbers |= {
            "largest_error": float(total[worst]),
            "largest_error_time": float(time[worst]),
            "error_share_of_width": metrics.integral(time, total) / area if area > 0 else 0.0,
        }
    return numbers
