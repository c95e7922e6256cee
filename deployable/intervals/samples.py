"""Reading samples datasets: values of responses at runs that differ in their parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from .errors import IntervalError

if TYPE_CHECKING:
    import xarray as xr

_CHUNK = 1 << 23  # numbers in memory at a time


@dataclass(frozen=True)
class RunBounds:
    """Least and largest values of a stream of runs: `low`, `high` (...), and `low_run`, `high_run`
    (...), the runs that have them, of equal values the first."""

    low: np.ndarray
    high: np.ndarray
    low_run: np.ndarray
    high_run: np.ndarray

    @classmethod
    def from_runs(cls, values: np.ndarray, runs: np.ndarray) -> RunBounds:
        """Make the least and largest values of R runs from their finite values (R, ...); runs (R):
        indices of the runs, increasing."""
        low, high = values.argmin(axis=0)[None], values.argmax(axis=0)[None]
        numbers = np.asarray(runs)
        return cls(
            np.take_along_axis(values, low, axis=0)[0].astype(float),
            np.take_along_axis(values, high, axis=0)[0].astype(float),
            numbers[low[0]],
            numbers[high[0]],
        )

    def merge(self, next_runs: RunBounds | None) -> RunBounds:
        """Return the least and largest values of these runs and of `next_runs`, with the runs that
        have them, the first of several; None: these alone."""
        if next_runs is None:
            return self
        lower, higher = next_runs.low < self.low, next_runs.high > self.high
        return RunBounds(
            np.where(lower, next_runs.low, self.low),
            np.where(higher, next_runs.high, self.high),
            np.where(lower, next_runs.low_run, self.low_run),
            np.where(higher, next_runs.high_run, self.high_run),
        )


def quarter_ends(runs: int) -> list[int]:
    """Five indices, 0 to `runs` (number of runs), where quarters of the runs begin and end."""
    return [-(-runs * quarter // 4) for quarter in range(5)]


@dataclass(frozen=True)
class Samples:
    """R runs with n responses at T instants and k parameters, of a samples dataset (`samples.nc`).
    names (n): of the responses; time (T): instants, s; points (R, k): parameters of the runs,
    normalized to [-1, 1]; nominal: index of the run at nominal parameters, None without one;
    source: the dataset."""

    names: list[str]
    time: np.ndarray
    points: np.ndarray
    nominal: int | None
    source: xr.Dataset

    @cached_property
    def values(self) -> np.ndarray:
        """Responses (R, n, T) of all runs, in double precision, read at first use; IntervalError
        for values that are not finite."""
        values = np.asarray(self.read(slice(None)), dtype=float)
        bad = [n for i, n in enumerate(self.names) if not np.isfinite(values[:, i]).all()]
        if bad:
            raise IntervalError("samples", ", ".join(bad), "finite responses in every run")
        return values

    @cached_property
    def ratios(self) -> np.ndarray:
        """Mask (n) of the responses that are a ratio less one, as torque margins: available over
        required torque, less 1. These are fitted after a transformation."""
        if "response_ratio" not in self.source:
            return np.zeros(len(self.names), bool)
        return self.source["response_ratio"].values > 0

    @property
    def failed_points(self) -> np.ndarray:
        """Points (F, k) of the runs that failed, normalized; these are not among the others."""
        if "failed_normalized" not in self.source:
            return self.points[:0]
        return self.source["failed_normalized"].values

    def read(self, runs: slice) -> np.ndarray:
        """Read the responses (r, n, T) of the r runs that the slice `runs` selects, in the number
        type of the dataset; the values of other runs are not loaded."""
        return self.source["values"][runs].values

    def nominal_curve(self) -> np.ndarray | None:
        """Responses (n, T) of the nominal run; None if there is no nominal run."""
        return None if self.nominal is None else self.read(slice(self.nominal, self.nominal + 1))[0]

    def quarters(self) -> Iterator[RunBounds | None]:
        """Least and largest values (n, T) of each quarter of the runs, None for one without runs.
        IntervalError if a response is not finite."""
        step = max(_CHUNK // (len(self.time) * len(self.names)), 1)
        for first, last in pairwise(quarter_ends(len(self.points))):
            bounds: RunBounds | None = None
            for start in range(first, last, step):
                stop = min(start + step, last)
                values = self.read(slice(start, stop))
                if not np.isfinite(values).all():
                    raise IntervalError("samples", "not finite", "finite responses in every run")
                runs = RunBounds.from_runs(values, np.arange(start, stop))
                bounds = bounds.merge(runs) if bounds else runs
            yield bounds

    def coordinates(self) -> dict:
        """Coordinates of the samples dataset by name, for a new dataset: time, names, units and
        words of responses and parameters, as present."""
        bases, prefixes = ("time", "response", "parameter"), ("response_", "box_")
        names = [n for n in self.source.variables if n in bases or str(n).startswith(prefixes)]
        return {n: self.source[n].variable for n in names}

    def parameters(self) -> Callable[[np.ndarray], np.ndarray]:
        """Function that maps normalized coordinates (..., k) in [-1, 1] to parameter values (...,
        k) in their units: the affine map that the runs' values follow."""
        value = np.asarray(self.source["value"].values, dtype=float)
        middle, half = value.mean(axis=0), np.zeros(self.points.shape[1])
        for j, column in enumerate(self.points.T):
            a, b = column.argmin(), column.argmax()
            if column[b] > column[a]:
                half[j] = (value[b, j] - value[a, j]) / (column[b] - column[a])
                middle[j] = value[a, j] - half[j] * column[a]
        return lambda points: middle + half * points


def add_runs(
    samples: xr.Dataset, points: np.ndarray, values: np.ndarray, curves: np.ndarray,
    events: np.ndarray, event_margins: np.ndarray,
) -> xr.Dataset:  # fmt: skip
    """Samples dataset with r further runs. points, values (r, k): normalized and in units; curves
    (r, n, T); events (r, e, 3): time (s), what, and which way, padded with NaN; event_margins (r,
    c): of the first event of each kind, if the samples have these. Other variables of runs are left
    out."""
    import xarray as xr

    extension = {
        "values": (("run", "response", "time"), curves.astype(samples["values"].dtype)),
        "normalized": (("run", "parameter"), points),
        "value": (("run", "parameter"), values),
        "role": ("run", np.array(["further"] * len(points), dtype=object)),
    }
    if "event_margin" in samples:
        extension["event_margin"] = (("run", "contact"), event_margins)
    for i, name in enumerate(("event_time", "event_contact", "event_closing")):
        extension[name] = (("run", "event"), events[..., i])
    bases = [name for name in samples.coords if name in samples.dims]
    columns = samples.reset_coords()[list(extension)].drop_vars(bases, errors="ignore")
    size = max(samples.sizes["event"], events.shape[1])
    parts = [
        part.pad(event=(0, size - part.sizes["event"]), constant_values=np.nan)
        for part in (columns, xr.Dataset(extension))
    ]
    runs = xr.concat(parts, "run", join="override", coords="minimal", compat="override")
    rest = samples.drop_dims("run")
    return rest.merge(runs).assign_attrs(samples.attrs)


def read_samples(samples: xr.Dataset) -> Samples:
    """Check a samples dataset and return it as `Samples`, whose values are read at first use.
    IntervalError for what is missing.

    Variables ``values`` (run, response, time), ``normalized`` (-1 to 1) and ``value`` (run,
    parameter), perhaps ``role`` (run); coordinates ``time`` (s) and ``response``; perhaps
    ``failed_normalized`` (failed, parameter), points of the design whose runs failed."""
    for name in ("time", "response", "values", "normalized", "value"):
        if name not in samples:
            raise IntervalError("samples", list(samples.variables), f"a dataset with {name}")
    nominal = None
    if "role" in samples:
        nominal_runs = np.flatnonzero(samples["role"].values.astype(str) == "nominal")
        nominal = int(nominal_runs[0]) if len(nominal_runs) else None
    return Samples(
        [str(name) for name in samples["response"].values],
        np.asarray(samples["time"].values, dtype=float),
        np.asarray(samples["normalized"].values, dtype=float),
        nominal,
        samples,
    )
