"""Running bounds, and what the extremes of a scan may miss."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from deployable.intervals import Box, IntervalError, bounds_dataset, make_design
from deployable.intervals.estimates import share_outside
from deployable.intervals.samples import RunBounds, quarter_ends

DRAW = np.random.default_rng(3)
VALUES = DRAW.integers(-3, 4, (60, 2, 5)).astype(float)  # many ties
VALUES[::7] *= -0.0


def same(one: RunBounds, other: RunBounds) -> bool:
    keys = ("low", "high", "low_run", "high_run")
    return all(getattr(one, key).tobytes() == getattr(other, key).tobytes() for key in keys)


@pytest.mark.parametrize("size", [1, 7, 59])
def test_neither_order_nor_grouping_changes_a_bit(size):
    whole, runs = RunBounds.from_runs(VALUES, np.arange(60)), np.arange(60)
    parts = [slice(first, first + size) for first in range(0, 60, size)]
    found = None
    for part in DRAW.permutation(len(parts)):
        found = RunBounds.from_runs(VALUES[parts[part]], runs[parts[part]]).merge(found)
    assert same(found, whole)
    np.testing.assert_array_equal(whole.low, VALUES.min(axis=0))
    np.testing.assert_array_equal(whole.high_run, VALUES.argmax(axis=0))  # the first of several


def curves(unit: np.ndarray) -> np.ndarray:
    """Values (R, 1, T) of runs at unit points (R, 2)."""
    time = np.linspace(0, 1, 21)
    return np.sin(3 * time + unit[:, :1] + unit[:, 1:] ** 2)[:, None]


def samples(runs: int) -> tuple[xr.Dataset, xr.Dataset]:
    """A scan with all values, and the same with the running bounds of its quarters."""
    box = Box(["p", "q"], [0.0, 2.0], [1.0, 3.0])
    unit = np.concatenate([np.zeros((1, 2)), make_design("sobol", box, samples=runs - 1).points])
    values, place = curves(unit), ("run", "parameter")
    common = {
        "normalized": (place, unit),
        "value": (place, box.from_unit(unit)),
    }
    coords = {"time": np.linspace(0, 1, 21), "response": ["y"], "parameter": ["p", "q"]}
    role = ["nominal"] + ["node"] * (runs - 1)
    dims = ("run", "response", "time")
    whole = xr.Dataset({**common, "role": ("run", role), "values": (dims, values)}, coords)
    ends, kept = quarter_ends(runs), {}
    for name, key in zip(
        ("lower", "upper", "lower_run", "upper_run"), ("low", "high", "low_run", "high_run"),
        strict=True,
    ):  # fmt: skip
        parts = [RunBounds.from_runs(values[a:b], np.arange(a, b)) for a, b in zip(ends, ends[1:])]  # noqa: B905, RUF007
        kept[name] = (("quarter", *dims[1:]), [getattr(part, key) for part in parts])
    return whole, xr.Dataset({**common, **kept, "nominal": (dims[1:], values[0])}, coords)


@pytest.mark.parametrize("runs", [9, 101])
def test_quarters_give_the_bounds_that_all_values_give(runs):
    whole, kept = samples(runs)
    design = make_design("sobol", 2, samples=runs - 1)
    expected, found = bounds_dataset(whole, design), bounds_dataset(kept, design)
    xr.testing.assert_identical(found, expected)
    values = whole["values"].values
    half = (runs + 1) // 2
    growth = np.maximum(
        values[:half].min(axis=0) - values.min(axis=0),
        values.max(axis=0) - values[:half].max(axis=0),
    )
    np.testing.assert_array_equal(found["error"], growth)
    assert (found["growth_quarter"] <= found["error"]).all()
    assert found.attrs["drawn_runs"] == runs - 5  # without the nominal run and four corners


def test_extremes_fit_no_other_model():
    _, kept = samples(9)
    with pytest.raises(IntervalError, match="responses of every run"):
        bounds_dataset(kept, None, model="spline")


@pytest.mark.parametrize("runs", [2, 5, 40])
def test_share_outside_is_that_of_random_draws(runs):
    drawn = np.sort(DRAW.random((20_000, runs)), axis=1)
    outside = 1.0 - (drawn[:, -1] - drawn[:, 0])
    error = 4 * outside.std() / np.sqrt(len(outside))
    assert share_outside(runs) == pytest.approx(outside.mean(), abs=error)
    kept = (outside <= share_outside(runs, 0.95)).mean()
    assert kept == pytest.approx(0.95, abs=4 * np.sqrt(0.95 * 0.05 / len(outside)))
