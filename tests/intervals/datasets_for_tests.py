"""Samples datasets from closed-form responses."""

from __future__ import annotations

import numpy as np
import xarray as xr

from deployable.intervals import held_out_points


def samples_of(function, box, design, time, held_out=4, names=("response",)):
    """Samples of function(values (k)) -> (names, T) at the design, the centre and held-out runs."""
    extra = held_out_points(box.free, held_out, design.points)
    unit = np.concatenate([design.points, np.zeros((1, box.dimension)), extra])
    value = box.from_unit(unit)
    table = np.array([np.reshape(function(v), (len(names), -1)) for v in value])
    role = ["node"] * design.run_count + ["nominal"] + ["held_out"] * len(extra)
    axes = ("run", "parameter")
    data = {"normalized": (axes, unit), "value": (axes, value), "role": ("run", role)}
    data["values"] = (("run", "response", "time"), table)
    coords = {
        "time": time,
        "parameter": list(box.names),
        "response": list(names),
        "response_units": ("response", ["m"] * len(names)),
    }
    return xr.Dataset(data, coords=coords)
