"""Boxes whose curves differ by periods: what polynomials do not resolve excludes nothing."""

import numpy as np
import pytest

from deployable.intervals.calibration import Measurement, calibrate

NARROW = 0.4375  # the middle of a thirtieth of the box


def bounce(x, times, step=0.0):
    """Falls of the rate 1 + x / 5 onto the floor at 0, from which it comes back as it came."""
    return np.abs(1.0 - (1.0 + x / 5) * times)


def phase(x, times, step=1.0):
    """Vibration whose frequency a step of the second order makes too large by 0.4 %."""
    return np.cos((31.0 + x) * (1.0 + 0.004 * step**2) * times)


def rare(x, times, step=0.0):
    """Drift that only a thirtieth of the box stops at 1 s."""
    is_caught = np.abs(x - NARROW) < 1 / 30
    return np.where(is_caught, np.minimum(times, 1.0), times) * (1.0 + x / 10)


@pytest.mark.parametrize(
    ("curve", "instants", "truth"),
    [(bounce, 41, 0.3), pytest.param(phase, 401, 0.6, marks=pytest.mark.slow),
     pytest.param(rare, 201, NARROW, marks=pytest.mark.slow)],
)  # fmt: skip
def test_true_models_are_not_refuted_nor_their_truth_excluded(curve, instants, truth):
    """Kinks between recorded instants, errors of the step in phase, behaviour of few runs."""
    times, seen = np.linspace(0.0, 2.0, instants), np.linspace(0.0, 2.0, 151)
    exact = curve(truth, seen, step=0.0)
    values = exact + 0.0019 * np.random.default_rng(1).uniform(-1, 1, len(seen))
    bands = np.full((1, len(seen)), 0.002)
    limits = np.array([[0.0, 1.0, 0.0]] * 2)
    test = Measurement(seen, values[None], bands, limits, np.arange(1))

    def evaluate(t, points, halvings):
        return np.array([[curve(x, times, 0.5**halvings)] for x in points[:, 0]])

    result = calibrate([test], times, evaluate, np.array([[-1.0], [1.0]]))
    (low,), (high,) = result.hull
    assert not result.is_refuted and low <= truth <= high


def test_steps_are_halved_until_they_hardly_widen_what_is_left():
    """Beside 0.9 of the band as noise, with errors of the first step of 0.6 of the band; the hull
    and the least band are those of a fine grid of the exact curves."""
    error = 2e-5
    instants, box = np.linspace(0.0, 2.0, 601), np.array([[-1.0], [1.0]])
    times = instants[::3]
    noise = 0.0018 * np.random.default_rng(3).uniform(-1, 1, len(times))
    limits = np.array([[0.0, 1.0, 0.0]] * 2)
    values = np.cos(31.02 * times) + noise
    test = Measurement(times, values[None], np.full((1, 201), 0.002), limits, np.arange(1))

    def evaluate(t, points, halvings):
        frequencies = (31.0 + 0.1 * points) * (1.0 + error * 0.25**halvings)
        return np.cos(frequencies * instants)[:, None]

    result = calibrate([test], instants, evaluate, box)
    grid = np.linspace(0.19, 0.21, 8001)
    misfits = np.abs(np.cos((31.0 + 0.1 * grid[:, None]) * times) - values).max(axis=1) / 0.002
    (low,), (high,) = result.hull
    exact = grid[misfits <= 1.0]
    assert low <= exact[0] and exact[-1] <= high
    assert high - low <= 1.3 * np.ptp(exact)
    assert result.least <= misfits.min() <= result.attained + 0.02
    assert result.attained - result.least <= 0.04
