"""Runs chosen where a spline promises wider bounds, against a scan with as many runs."""

import numpy as np
import pytest

from deployable.intervals import make_design, seek_points
from deployable.intervals.bounds import hausdorff

TIME = np.linspace(0.0, 1.0, 60)


def model(unit):
    """Two responses of different size (R, 2, T), with extreme values inside and at the faces."""
    phase = 12 * TIME * (1 + 0.05 * unit[:, :1]) + 2 * unit[:, 1:2]
    first = np.sin(phase)
    second = 1e3 * (unit[:, 2:] * TIME + 0.3 * np.cos(3 * phase))
    return np.stack([first, second], axis=1)


@pytest.mark.slow
def test_sought_runs_widen_the_bounds_more_than_a_scan():
    scan = make_design("sobol", 3, samples=4096).points
    truth = model(make_design("sobol", 3, samples=200_000, max_runs=10**6).points)
    low, high = truth.min(axis=0), truth.max(axis=0)
    width = (high - low).mean(axis=1)

    def error(values):
        return hausdorff(values.min(axis=0), values.max(axis=0), low, high).mean(axis=1) / width

    unit = scan[:64]
    for seed in range(3):
        found, growth = seek_points(unit, model(unit), 64, candidates=4096, seed=seed)
        assert growth.shape == (2,)
        unit = np.concatenate([unit, found])
    assert len(unit) == 256
    assert len(np.unique(unit, axis=0)) == 256
    assert (np.abs(unit) <= 1).all()
    assert (error(model(unit)) < 1e-3).all()
    assert error(model(unit)).max() < 0.1 * error(model(scan[:256])).max()
    assert error(model(unit)).max() < error(model(scan)).max()


def test_nothing_is_sought_where_nothing_varies():
    unit = make_design("sobol", 2, samples=16).points
    values = np.stack([np.ones((16, 5)), unit[:, :1] * np.ones(5)], axis=1)
    found, growth = seek_points(unit, values, 8)  # linear: the corners are among the runs
    assert growth[0] == 0
    assert growth[1] < 1e-6
    assert len(found) <= 8


def test_responses_that_do_not_vary_need_no_points():
    found, growth = seek_points(np.zeros((4, 2)), np.ones((4, 3, 5)), 8)
    assert len(found) == 0 and not growth.any()
