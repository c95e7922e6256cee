"""A folder of trajectories becomes a samples dataset."""

import numpy as np
import pytest
import xarray as xr

from intervals import Box, IntervalError, bounds_dataset, gather_trajectories, make_design

TIME = np.linspace(0, 1, 21)


def write(folder, name, value, time=TIME, **attrs):
    file = xr.Dataset(
        {"BD": ("time", value * time, {"units": "m", "long_name": "distance B to D"})},
        coords={"time": time},
        attrs={"parameter_a": value, "parameter_supports": "fixed", "responses": "BD", **attrs},
    )
    if value > 1:  # a run without events may have no variables of them
        file["contact_event_time"] = ("event", [0.25, value])
    file.to_netcdf(folder / f"{name}.nc")


def test_folder_to_bounds(tmp_path):
    box = Box(["a"], [0.5], [1.5])
    design = make_design("tensor_roots", box, 3)
    for i, value in enumerate(box.from_unit(design.points)[:, 0]):
        write(tmp_path, f"run{9 - i}", value)
    write(tmp_path, "elsewhere", 7.0)
    samples = gather_trajectories(tmp_path, box)
    assert samples.sizes["run"] == 4
    assert samples["BD"].attrs["units"] == "m"
    assert samples["event_time"].dims == ("run", "event")
    happened = np.isfinite(samples["event_time"]).sum("event")
    np.testing.assert_array_equal(happened, 2 * (samples["value"][:, 0] > 1))
    bounds = bounds_dataset(samples, design)
    np.testing.assert_allclose(bounds["BD_upper"], 1.5 * TIME, atol=1e-14)


def test_refusals(tmp_path):
    box = Box(["a"], [0.5], [1.5])
    with pytest.raises(IntervalError, match="folder"):
        gather_trajectories(tmp_path, box)
    write(tmp_path, "one", 1.0)
    with pytest.raises(IntervalError, match="'b'"):
        gather_trajectories(tmp_path, Box(["b"], [0.0], [1.0]))
    with pytest.raises(IntervalError, match="'vBz'"):
        gather_trajectories(tmp_path, box, ["vBz"])
    write(tmp_path, "two", 1.1, time=TIME[:-1])
    with pytest.raises(IntervalError, match="instants"):
        gather_trajectories(tmp_path, box)
