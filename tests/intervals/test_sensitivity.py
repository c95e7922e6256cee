"""Which parameter matters: shares that are known in closed form."""

import numpy as np
import pytest
import xarray as xr
from datasets_for_tests import samples_of

from deployable.intervals import (
    Box,
    held_out_points,
    make_design,
    sensitivity_dataset,
)


def test_dataset_per_instant_and_overall():
    time = np.linspace(0, 1, 101)
    box = Box(["a", "b"], [0.0, 0.0], [1.0, 1.0])
    design = make_design("smolyak", box, 2)
    samples = samples_of(lambda v: v[0] * (1 - time) + v[1] * time, box, design, time)
    found = sensitivity_dataset(samples, design)
    np.testing.assert_allclose(found["width"][0].values[0], 1 - time, atol=1e-12)
    np.testing.assert_allclose(found["width"][0].values[1], time, atol=1e-12)
    assert found["width_overall"][0].values == pytest.approx([0.5, 0.5])
    tiny = np.where(time < 0.5, 1e-13, 1.0)  # of the value: rounding
    samples = samples_of(lambda v: 3.0 + (v[0] + v[1]) * tiny, box, design, time)
    found = sensitivity_dataset(samples, design)
    assert ((found["width"][0].values == 0) == (time < 0.5)).all()


def test_the_noise_of_the_fit_is_no_share():
    """Half of the time only the first parameter matters, and the runs tremble by 1e-3."""
    time = np.linspace(0, 1, 401)
    box = Box(["a", "b"], [-1.0, -1.0], [1.0, 1.0])
    design = make_design("smolyak", box, 2)
    held_out = held_out_points(box.free, 6, design.points)
    rng = np.random.default_rng(3)
    points = np.concatenate([design.points, held_out])
    noise = 1e-3 * rng.standard_normal((len(points), len(time)))
    late = np.where(time > 0.5, 1.0, 0.0)
    values = (points[:, :1] + late * points[:, 1:] + noise)[:, None]
    samples = xr.Dataset(
        {"values": (("run", "response", "time"), values),
         "normalized": (("run", "parameter"), points), "value": (("run", "parameter"), points)},
        coords={"time": time, "response": ["y"]},
    )  # fmt: skip
    found = sensitivity_dataset(samples, design)
    before = time < 0.45
    width, error = found["width"].values[0], found["error"].values[0]
    assert (width[1, before] > 0).all()
    # A width is the difference of two ends, which may both be off.
    assert (width[1, before] < error[before]).mean() > 0.8
    assert found["width_overall"].values[0] == pytest.approx([2 / 3, 1 / 3], abs=0.01)
