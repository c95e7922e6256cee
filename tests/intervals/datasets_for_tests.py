"""Samples datasets from closed-form responses."""

from __future__ import annotations

import numpy as np
import xarray as xr
from ball import ball

from deployable.intervals import Box, held_out_points


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


def ball_samples(design, duration=2.0, held_out=4, instants=1001):
    """Samples of a ball dropped from 1 m, +- 5 %."""
    box = Box(["height"], [0.95], [1.05])
    time = np.linspace(0.0, duration, instants)
    return samples_of(lambda v: np.array(ball(time, v[0])), box, design, time, held_out, ("z", "v"))


def ball_reference(duration=2.0, runs=4001, instants=1001):
    """Bounds (2, T) from below and above of a dense scan of the ball: position and velocity."""
    time = np.linspace(0.0, duration, instants)
    low, high = np.full((2, instants), np.inf), np.full((2, instants), -np.inf)
    for height in np.linspace(0.95, 1.05, runs):
        curves = np.array(ball(time, height))
        low, high = np.minimum(low, curves), np.maximum(high, curves)
    return time, low, high
