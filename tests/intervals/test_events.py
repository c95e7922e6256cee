"""Polynomials on a bouncing ball, against a dense scan: orders hardly help, and errors are told."""

import numpy as np
import pytest
from datasets_for_tests import ball_reference, ball_samples

from deployable.intervals import bounds_dataset, compare_bounds, make_design


@pytest.fixture(scope="module")
def reference():
    return ball_reference()


def test_orders_hardly_help(reference):
    time, low, high = reference
    ratio = {}
    for order in (3, 33):
        design = make_design("tensor_roots", 1, order)
        bounds = bounds_dataset(ball_samples(design), design, ["v"])
        ends = (bounds[key].values[0] for key in ("lower", "upper"))
        found = compare_bounds(time, *ends, low[1], high[1])
        ratio[order] = found["hausdorff_integrated"]
    assert ratio[3] == pytest.approx(0.132, abs=0.01)
    assert ratio[33] == pytest.approx(0.08, abs=0.01)


def test_the_error_estimate_sees_what_is_wrong(reference):
    _, low, high = reference
    design = make_design("tensor_roots", 1, 3)
    bounds = bounds_dataset(ball_samples(design), design)
    for row, name in enumerate(("z", "v")):
        lower, upper = (bounds[key].sel(response=name).values for key in ("lower", "upper"))
        true = np.maximum(np.abs(lower - low[row]), np.abs(upper - high[row]))
        told = bounds["error"].sel(response=name).values
        assert (true > told + 1e-4).mean() < 0.01
        assert (true > told + 0.02).mean() == 0
    # 0.13 of the width is wrong; the estimate says so
    assert float(bounds["error_share_of_width"].sel(response="v")) > 0.13
