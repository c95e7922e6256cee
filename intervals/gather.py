"""A folder of trajectory files to one samples dataset.

A trajectory file has a dimension time, one variable (time) for each response, and an attribute
``parameter_<name>`` for each parameter: nothing else is asked of the program that wrote it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .box import Box
from .exceptions import IntervalError

if TYPE_CHECKING:
    import xarray as xr

_EVENTS = {
    "event_time": "contact_event_time",
    "event_contact": "contact_event_contact",
    "event_closing": "contact_event_closing",
}


def gather_trajectories(
    source: str | Path | Iterable[str | Path],
    box: Box,
    responses: Sequence[str] | None = None,
    role: str = "node",
) -> xr.Dataset:
    """Read the trajectories in a folder (or a list of files) as a samples dataset.

    Files are taken in the order of their names. `responses` defaults to those that the first file
    names in its attribute ``responses``. Files whose parameters lie outside the box are left out.
    All files must share their instants. Raises IntervalError where a file lacks something.
    """
    import xarray as xr

    if isinstance(source, (str, Path)):
        files = sorted(Path(source).glob("*.nc"))
    else:
        files = [Path(f) for f in source]
    if not files:
        raise IntervalError("trajectories", str(source), "a folder with netCDF files")
    rows, values, events, used = [], [], [], []
    time, attrs = None, {}
    for path in files:
        with xr.open_dataset(path) as file:
            point = _parameters(file, box, path)
            if not _inside(point, box):
                continue
            if time is None:
                time = file["time"].load()
                if responses is None:
                    responses = str(file.attrs.get("responses", "")).split()
                attrs = {n: dict(file[n].attrs) for n in responses if n in file}
                if not responses:
                    raise IntervalError("responses", responses, f"names of variables of {path}")
            for name in responses:
                if name not in file:
                    raise IntervalError("response", name, f"a variable of {path}")
            if not np.array_equal(file["time"].values, time.values):
                raise IntervalError("time", str(path), f"the instants of {used[0]}")
            rows.append(point)
            values.append([file[name].values for name in responses])
            events.append({k: file[v].values for k, v in _EVENTS.items() if v in file})
            used.append(str(path.name))
    if not rows:
        raise IntervalError("trajectories", str(source), f"files with parameters inside {box}")
    stacked = np.array(values, dtype=float)
    data = {
        "unit": (("run", "parameter"), box.to_unit(np.array(rows))),
        "value": (("run", "parameter"), np.array(rows)),
        "role": ("run", np.array([role] * len(rows))),
        "file": ("run", np.array(used)),
    }
    for i, name in enumerate(responses):
        data[name] = (("run", "time"), stacked[:, i], attrs[name])
    for key in _EVENTS:
        if any(key in e for e in events):
            # A file of a run without events may lack their variables.
            none = np.zeros(0)
            data[key] = (("run", "event"), _padded([e.get(key, none) for e in events]))
    return xr.Dataset(
        data,
        coords={"time": time, "parameter": list(box.names)},
        attrs={"responses": " ".join(responses)},
    )


def _parameters(file: xr.Dataset, box: Box, path: Path) -> list[float]:
    missing = [n for n in box.names if f"parameter_{n}" not in file.attrs]
    if missing:
        raise IntervalError("interval", missing[0], f"a parameter recorded in {path}")
    return [float(file.attrs[f"parameter_{n}"]) for n in box.names]


def _inside(point: list[float], box: Box) -> bool:
    slack = 1e-12 * np.maximum(np.abs(box.lower), np.abs(box.upper))
    return bool(((point >= box.lower - slack) & (point <= box.upper + slack)).all())


def _padded(rows: list[np.ndarray]) -> np.ndarray:
    """Rows of different length as one array (R, E), padded with NaN."""
    table = np.full((len(rows), max((len(r) for r in rows), default=0)), np.nan)
    for i, row in enumerate(rows):
        table[i, : len(row)] = row
    return table
