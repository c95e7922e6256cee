"""What can not be negative has no negative bound, and where the model says so is told."""

import numpy as np
import pytest
from datasets_for_tests import samples_of

from deployable.intervals import Box, bounds_dataset, make_design

TIME = np.linspace(0.0, 1.0, 21)
BOX = Box(["a"], [-1.0], [1.0])


def kinked(values):
    """A distance that is zero in a part of the box: no polynomial or spline likes that."""
    return np.maximum(values[0] - 0.3 + 0.1 * TIME, 0.0)


@pytest.mark.parametrize("model", ["polynomial", "spline"])
def test_a_distance_is_bounded_by_what_it_can_be(model):
    design = make_design("tensor_lobatto", BOX, 6)
    samples = samples_of(kinked, BOX, design, TIME)
    free = bounds_dataset(samples, design, model=model)
    assert float(free["lower"].min()) < -0.005
    told = samples.assign_coords(response_least=("response", [0.0]))
    found = bounds_dataset(told, design, model=model)
    assert float(found["lower"].min()) == float(found["inner_lower"].min()) == 0.0
    np.testing.assert_array_equal(found["lower"], np.maximum(free["lower"], 0.0))
    np.testing.assert_array_equal(found["upper"], free["upper"])
    most = -free["inner_lower"].values[0]
    assert float(found["largest_impossible"][0]) == most.max()
    assert float(found["largest_impossible_time"][0]) == TIME[most.argmax()]
    unbounded = samples.assign_coords(response_least=("response", [np.nan]))
    other = bounds_dataset(unbounded, design, model=model)
    np.testing.assert_array_equal(other["lower"], free["lower"])
    assert float(other["largest_impossible"][0]) == 0.0


def stopped(sign, values):
    """An opening that a stop at 1 ends at a time that depends on a; the stop yields by 0.001."""
    time = TIME * (2.0 + 1.5 * values[0])
    return sign * np.where(time < 1.0, time, 1.0 + 0.001 * np.sin(9.0 * time))


@pytest.mark.parametrize(("sign", "end"), [(1, "response_ceiling"), (-1, "response_floor")])
@pytest.mark.parametrize("model", ["polynomial", "spline"])
def test_no_bound_is_beyond_a_stop_by_more_than_twice_what_runs_are(model, sign, end):
    design = make_design("tensor_lobatto", BOX, 6)
    samples = samples_of(lambda values: stopped(sign, values), BOX, design, TIME)
    free = bounds_dataset(samples, design, model=model)
    limit = 1.0 + 2 * (float(np.abs(samples["values"]).max()) - 1.0)
    beyond = float(np.abs([free["lower"], free["upper"]]).max()) - limit
    assert beyond > 0.01
    found = bounds_dataset(samples.assign_coords({end: ("response", [sign])}), design, model=model)
    low, high = (-np.inf, limit) if sign > 0 else (-limit, np.inf)
    for side in ("lower", "upper"):
        np.testing.assert_allclose(found[side], np.clip(free[side], low, high), rtol=1e-12)
    assert float(found["largest_impossible"][0]) == pytest.approx(beyond, abs=1e-3)
