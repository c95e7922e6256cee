"""Boxes whose curves differ by periods: what polynomials do not resolve excludes nothing."""

import numpy as np
import pytest

from deployable.intervals.calibration import Measurement, calibrate

TIMES = np.linspace(0.0, 3.0, 301)


def vibration(t: int, points: np.ndarray) -> np.ndarray:
    """Curves (N, 1, 301) of a mass of 1 kg that is let go at 1 m, on a spring of k = 500 ± 300."""
    stiffness = 500.0 + 300.0 * points[:, :1]
    return np.cos(np.sqrt(stiffness) * TIMES)[:, None]


@pytest.mark.parametrize("k", [250.0, 400.0, 750.0])
def test_a_true_model_is_not_refuted_though_the_box_spans_periods(k):
    instants = TIMES[::2]
    noise = 0.0045 * np.sin(1e3 * instants)
    values = np.cos(np.sqrt(k) * instants) + noise
    limits = np.array([[0.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    test = Measurement(
        instants, values[None], np.full((1, len(instants)), 0.005), limits, np.arange(1)
    )
    result = calibrate(
        [test], TIMES, vibration, lambda t, point: vibration(t, point[None])[0],
        np.array([[-1.0], [1.0]]),
    )  # fmt: skip
    low, high = 500.0 + 300.0 * result.hull[:, 0]
    assert not result.is_refuted and low <= k <= high
