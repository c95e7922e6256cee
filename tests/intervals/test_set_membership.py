"""Set-membership calibration, by curves of closed form in place of runs."""

import numpy as np
import pytest

from deployable.intervals.calibration import Measurement, calibrate, calibrate_together

TIMES = np.linspace(0.0, 2.0, 101)
INSTANTS = np.linspace(0.1, 1.9, 46)
BAND = 0.01


def curve(x, start, times, missing=0.0):
    """Decay of the rate 1 + x0 / 2 towards x1 / 2 from 2 + start, with a term that none models."""
    end = x[1] / 2
    return end + (2 + start - end) * np.exp(-(1 + x[0] / 2) * times) + missing * np.sin(9 * times)


def measure(x, start=0.0, sensor=(0.0, 1.0, 0.0), missing=0.0, noise=0.0, limits=None, starts=0):
    """A test of the truth `x`, seen by a sensor with delay, gain and offset."""
    delay, gain, offset = sensor
    values = gain * curve(x, start, INSTANTS - delay, missing) + offset
    values = values + BAND * np.random.default_rng(0).uniform(-noise, noise, len(values))
    limits = [[0.0, 1.0, 0.0]] * 2 if limits is None else limits
    bands = np.full((1, len(values)), BAND)
    return Measurement(INSTANTS, values[None], bands, np.array(limits), np.arange(2), starts)


def find(*tests, hull=((-1.0, -1.0), (1.0, 1.0)), **options):
    """What of the box explains the tests."""

    def evaluate(t, points, halvings):
        starts = points[:, 2] if tests[t].starts else np.zeros(len(points))
        pairs = zip(points, starts, strict=True)
        return np.array([[curve(x, 0.2 * s, TIMES)] for x, s in pairs])

    function = calibrate_together if len(tests) > 1 else calibrate
    return function(tests, TIMES, evaluate, np.array(hull), **options)


def exact(test):
    """Hull of a fine grid about the truth whose points are within the band at all instants."""
    grid = np.stack(np.meshgrid(*[np.linspace(0, 0.6, 301)] * 2), axis=-1).reshape(-1, 2)
    misfits = np.max([np.abs(curve(grid.T, 0.0, t) - m) / BAND
                      for t, m in zip(INSTANTS, test.values[0], strict=True)], axis=0)  # fmt: skip
    inside = grid[misfits <= 1]
    return np.array([inside.min(axis=0), inside.max(axis=0)])


def test_hull_is_that_of_the_points_within_the_band():
    test = measure([0.3, 0.3])
    result, (low, high) = find(test), exact(test)
    assert not result.is_refuted and result.attained < 0.05 and result.runs <= 120
    assert (result.hull[0] <= low + 0.003).all() and (high - 0.003 <= result.hull[1]).all()
    assert np.prod(np.ptp(result.hull, axis=0)) <= 1.3 * np.prod(high - low + 0.002)
    explained, left = result.fractions
    assert 0 < explained <= left <= np.prod(np.ptp(result.hull, axis=0)) / 4


@pytest.mark.slow
def test_truth_is_left_whatever_the_sensor_hides():
    rng = np.random.default_rng(0)
    truth, start = rng.uniform(-0.9, 0.9, 2), rng.uniform(-0.18, 0.18)
    limits = np.array([[0.0, 0.99, -0.02], [0.02, 1.01, 0.02]])
    test = measure(truth, start, rng.uniform(*limits), noise=0.99, limits=limits, starts=1)
    result = find(test)
    assert not result.is_refuted
    assert (result.hull[0] <= truth).all() and (truth <= result.hull[1]).all()
    assert result.starts[0][0] <= start / 0.2 <= result.starts[0][1]


def test_what_the_model_lacks_is_refuted_with_the_least_band():
    result = find(measure([0.3, 0.3], missing=0.05))
    assert result.is_refuted and 1 < result.least <= result.attained < 6
    assert result.attained - result.least < 0.1 * result.attained
    assert result.fractions == (0.0, 0.0)


@pytest.mark.slow
def test_two_tests_never_leave_more_than_one_in_any_order():
    first, second = measure([0.3, 0.3]), measure([0.3, 0.3], noise=0.9)
    (both, singles), (turned, _) = find(first, second), find(second, first)
    assert singles[0].hull.tolist() == find(first).hull.tolist()
    for alone in singles:
        assert (both.hull[0] >= alone.hull[0]).all() and (both.hull[1] <= alone.hull[1]).all()
    assert both.hull == pytest.approx(turned.hull, abs=1e-9)
    assert 0 < both.fractions[1] <= np.prod(np.ptp(both.hull, axis=0)) / 4
    for *point, misfit in both.misfits():
        off = [np.abs(curve(point, 0.0, INSTANTS) - t.values).max() / BAND for t in (first, second)]
        assert misfit == pytest.approx(max(off), rel=0.35, abs=0.3)  # said with one digit


@pytest.mark.slow
def test_tests_that_contradict_each_other_are_each_explained():
    """What they share explains neither."""
    truth = (0.3, 0.2)
    both, singles = find(measure([0.3, 0.3]), measure(truth))
    assert both.is_refuted and not any(single.is_refuted for single in singles)
    grid = np.stack(np.meshgrid(*[np.linspace(-0.2, 0.6, 81)] * 2), axis=-1).reshape(-1, 2)
    misfits = [[np.abs(curve(x, 0.0, INSTANTS) - curve(y, 0.0, INSTANTS)).max() / BAND
                for x in grid] for y in ([0.3, 0.3], truth)]  # fmt: skip
    assert both.least <= np.max(misfits, axis=0).min() and both.least <= both.attained


def test_axis_that_a_test_does_not_see_keeps_its_interval():
    test = measure([0.3, 0.3])
    result = find(test, hull=((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)))
    assert result.hull[:, 2].tolist() == [-1.0, 1.0]
