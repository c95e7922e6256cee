"""Bounds datasets: exact, complete, reproducible, and fast."""

import numpy as np
import pytest
import xarray as xr
from datasets_for_tests import samples_of

from deployable.intervals import (
    Box,
    IntervalError,
    RunBounds,
    add_errors,
    bounds_dataset,
    include_runs,
    make_design,
)
from deployable.intervals import samples as samples_module
from deployable.intervals.bounds import hausdorff
from deployable.intervals.samples import Samples

TIME = np.linspace(0.0, 1.0, 201)


def wave(v):
    return np.sin(6 * TIME * v[0]) * np.exp(v[-1])


def test_bounds_agree_with_a_dense_scan_within_the_estimated_error():
    box = Box(["f"], [0.9], [1.1])
    design = make_design("tensor_roots", box, 5)
    bounds = bounds_dataset(samples_of(wave, box, design, TIME), design)
    scan = np.array([wave(v) for v in np.linspace(0.9, 1.1, 2001)[:, None]])
    distance = hausdorff(
        bounds["lower"][0], bounds["upper"][0], scan.min(axis=0), scan.max(axis=0)
    ).values
    # the scan itself misses up to a quarter of its step squared times the curvature
    assert (distance <= bounds["error"][0].values + 1e-5).all()
    assert float(bounds["error_share_of_width"][0]) < 0.02
    assert bounds["response_units"].values.tolist() == ["m"]
    assert bounds.attrs["design_runs"] == 6
    assert bounds.attrs["held_out_runs"] == 5


@pytest.mark.parametrize("parts", [{}, {"step": 1e-3}])
def test_bounds_contain_every_run_and_the_error_what_they_missed(parts):
    """A peak between the runs of the design, on which there is a further run."""

    def peak(v):
        return wave(v) + 2 * np.exp(-(((v[0] - 1.005) / 0.002) ** 2)) * TIME

    box = Box(["f"], [0.9], [1.1])
    design = make_design("tensor_roots", box, 3)
    samples = samples_of(peak, box, design, TIME, held_out=4)
    before = bounds_dataset(samples, design)
    if parts:
        parts = {name: np.full((1, len(TIME)), value) for name, value in parts.items()}
        before = add_errors(before, parts)
    curve, other = peak([1.005])[None], peak([0.95])[None]
    runs = RunBounds.from_runs(np.array([other, curve]), np.arange(2))
    values = np.array([[0.95], [1.005]])
    after = include_runs(before, runs, values)
    missed = (curve - before["upper"]).clip(0)
    assert float((missed - before["error"]).max()) > 0.1  # of 2
    assert (after["lower"] <= curve).all() and (curve <= after["upper"]).all()
    assert (after["argmax"].values[..., 0] == 1.005)[missed > 0].all()
    fit = after["error_surrogate" if parts else "error"]
    assert (fit >= missed).all()
    assert (after["error"] == fit + sum(map(float, [p[0, 0] for p in parts.values()]))).all()
    width = np.trapezoid(after["upper"] - after["lower"], TIME)
    share = np.trapezoid(after["error"], TIME) / width
    assert after["error_share_of_width"].values == pytest.approx(share)
    xr.testing.assert_identical(include_runs(after, runs, values), after)


def test_missing_runs_and_endless_responses_are_refused():
    box = Box(["f"], [0.9], [1.1])
    design = make_design("tensor_roots", box, 3)
    samples = samples_of(wave, box, design, TIME)
    with pytest.raises(IntervalError, match="no run at 1 of 4"):
        bounds_dataset(samples.isel(run=slice(1, None)), design)
    with pytest.raises(IntervalError, match="finite"):
        late = samples["values"].where(samples["time"] < 0.5)
        bounds_dataset(samples.assign(values=late), design)


def test_zero_width_box_gives_the_run_itself():
    box = Box(["f"], [1.0], [1.0])
    design = make_design("tensor_roots", box, 3)
    bounds = bounds_dataset(samples_of(wave, box, design, TIME), design)
    expected = wave(np.array([1.0]))
    for name in ("lower", "upper", "nominal"):
        assert (bounds[name][0].values == expected).all()
    assert (bounds["argmax"][0].values == 1.0).all()


@pytest.mark.parametrize("runs_at_a_time", [1, 10, 1000])
def test_scan_of_a_file_reads_it_in_chunks(tmp_path, monkeypatch, runs_at_a_time):
    box = Box(["f"], [0.9], [1.1])
    design = make_design("sobol", box, samples=64)
    samples = samples_of(wave, box, design, TIME, held_out=0)
    samples.to_netcdf(tmp_path / "samples.nc")
    monkeypatch.setattr(samples_module, "_CHUNK", runs_at_a_time * len(TIME))
    sizes = []
    read = Samples.read

    def record(self, runs):
        sizes.append(runs.stop - runs.start)
        return read(self, runs)

    monkeypatch.setattr(Samples, "read", record)
    with xr.open_dataset(tmp_path / "samples.nc") as file:
        found = bounds_dataset(file, None, model="scan")
    *sizes, nominal = sizes
    assert max(sizes) == min(runs_at_a_time, 17)  # a quarter at a time
    assert (sum(sizes), nominal) == (65, 1)
    values = samples["values"].values[:, 0]
    np.testing.assert_array_equal(found["lower"][0], values.min(axis=0))
    np.testing.assert_array_equal(found["upper"][0], values.max(axis=0))
    best = samples["value"].values[values.argmax(axis=0)]
    np.testing.assert_allclose(found["argmax"][0], best, rtol=1e-12)
