"""Running bounds, and what the extremes of a scan may miss."""

from __future__ import annotations

from functools import reduce

import numpy as np
import pytest
import xarray as xr

from deployable.intervals import Box, bounds_dataset, make_design
from deployable.intervals.estimates import share_outside
from deployable.intervals.samples import RunBounds

DRAW = np.random.default_rng(3)
VALUES = DRAW.integers(-3, 4, (60, 2, 5)).astype(float)  # many ties
VALUES[::7] *= -0.0


@pytest.mark.parametrize("size", [1, 7, 59])
def test_grouping_changes_no_value_and_no_run(size):
    whole, runs = RunBounds.from_runs(VALUES, np.arange(60)), np.arange(60)
    parts = [slice(first, first + size) for first in range(0, 60, size)]
    first, *rest = [RunBounds.from_runs(VALUES[part], runs[part]) for part in parts]
    found = reduce(RunBounds.merge, rest, first)
    for key in ("low", "high", "low_run", "high_run"):
        np.testing.assert_array_equal(getattr(found, key), getattr(whole, key))
    np.testing.assert_array_equal(whole.low, VALUES.min(axis=0))
    np.testing.assert_array_equal(whole.high_run, VALUES.argmax(axis=0))  # the first of several


@pytest.mark.parametrize("runs", [9, 101])
def test_growth_is_that_of_the_second_half_of_a_scan(runs):
    box = Box(["p", "q"], [0.0, 2.0], [1.0, 3.0])
    unit = np.concatenate([np.zeros((1, 2)), make_design("sobol", box, samples=runs - 1).points])
    time, place = np.linspace(0, 1, 21), ("run", "parameter")
    values = np.sin(3 * time + unit[:, :1] + unit[:, 1:] ** 2)[:, None]
    variables = {
        "normalized": (place, unit), "value": (place, box.from_unit(unit)),
        "role": ("run", ["nominal"] + ["node"] * (runs - 1)),
        "values": (("run", "response", "time"), values),
    }  # fmt: skip
    samples = xr.Dataset(variables, {"time": time, "response": ["y"], "parameter": ["p", "q"]})
    found = bounds_dataset(samples, make_design("sobol", 2, samples=runs - 1))
    half = (runs + 1) // 2
    growth = np.maximum(
        values[:half].min(axis=0) - values.min(axis=0),
        values.max(axis=0) - values[:half].max(axis=0),
    )
    np.testing.assert_array_equal(found["error"], growth)
    assert (found["growth_quarter"] <= found["error"]).all()
    assert found.attrs["drawn_runs"] == runs - 5  # without the nominal run and four corners


@pytest.mark.parametrize("runs", [2, 5, 40])
def test_share_outside_is_that_of_random_draws(runs):
    drawn = np.sort(DRAW.random((20_000, runs)), axis=1)
    outside = 1.0 - (drawn[:, -1] - drawn[:, 0])
    error = 4 * outside.std() / np.sqrt(len(outside))
    assert share_outside(runs) == pytest.approx(outside.mean(), abs=error)
    kept = (outside <= share_outside(runs, 0.95)).mean()
    assert kept == pytest.approx(0.95, abs=4 * np.sqrt(0.95 * 0.05 / len(outside)))
