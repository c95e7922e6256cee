"""Hulls of what explains a test, against those that another search finds in closed forms."""

import numpy as np
import pytest
from scipy.optimize import minimize

from deployable.intervals.calibration import Measurement, calibrate

TIMES, INSTANTS, BAND = np.linspace(0.0, 4.0, 401), np.linspace(0.03, 3.95, 41), 0.002
BOX, START = [0.3, -0.4], [-0.4, 0.5]
DELAYED, SCALED = (0.02, 1, 0.002), (0, 1.005, 0.002)
"""Upper ends of delay, gain and offset; lower ones are as far below 0, 1 and 0, of a delay 0."""


def ringing(x, times):
    """A mass of 1 kg on a spring and a damper, from an unknown place and rate."""
    k, c = 20 + 5 * x[0], 0.4 + 0.3 * x[1]
    rate, place, speed = np.sqrt(k - c * c / 4), 1 + 0.1 * x[2], x[3]
    waves = place * np.cos(rate * times) + (speed + c / 2 * place) / rate * np.sin(rate * times)
    return np.exp(-c / 2 * times) * waves


def driven(x, times):
    """The same mass, which sin(5 t) drives as well."""
    k, c = 20 + 5 * x[0], 0.4 + 0.3 * x[1]
    sine, cosine = np.array([k - 25, -5 * c]) / ((k - 25) ** 2 + 25 * c * c)
    rate, place = np.sqrt(k - c * c / 4), 0.02 * x[2] - cosine
    speed = 0.02 * x[3] - 5 * sine + c / 2 * place
    waves = place * np.cos(rate * times) + speed / rate * np.sin(rate * times)
    held = sine * np.sin(5 * times) + cosine * np.cos(5 * times)
    return 5 * (held + np.exp(-c / 2 * times) * waves)


def exact_hull(curve, test):
    """Ends (2, 2) of the box's coordinates within the bands, by SLSQP from five points each."""
    lower, upper = np.concatenate([[-np.ones(4), np.ones(4)], test.limits], axis=1)
    truth = np.concatenate([BOX, START, 0.6 * np.ones(3)])
    free, rng = upper > lower, np.random.default_rng(0)

    def slack(coordinates):
        x = (upper + lower) / 2
        x[free] += (upper - lower)[free] / 2 * coordinates
        values = x[5] * curve(x[:4], INSTANTS - x[4]) + x[6]
        return 1 - np.outer([1, -1], (values - test.values[0]) / BAND).ravel()

    def end(axis, sign):
        spread = np.array([0.02, 0.02, 0.05, 0.05, 0.3, 0.3, 0.3])
        starts = (truth + i * spread * rng.normal(size=7) for i in (0, 1, 1, 1, 1))
        found = [
            minimize(lambda x: -sign * x[axis], start[free], bounds=[(-1, 1)] * free.sum(),
                     constraints={"type": "ineq", "fun": slack}, method="SLSQP")
            for start in starts
        ]  # fmt: skip
        return sign * max(sign * r.x[axis] for r in found if slack(r.x).min() > -1e-5)

    return np.array([[end(axis, sign) for axis in (0, 1)] for sign in (-1, 1)])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("curve", "sensor"),
    [(ringing, SCALED), (driven, DELAYED)],
)
def test_hull_is_at_most_a_third_wider_than_the_exact_one(curve, sensor):
    upper = np.array(sensor, float)
    limits = np.array([[0.0, 2 - upper[1], -upper[2]], upper])
    delay, gain, offset = limits.mean(axis=0) + 0.3 * np.ptp(limits, axis=0)
    values = gain * curve([*BOX, *START], INSTANTS - delay) + offset
    values += 0.8 * BAND * np.random.default_rng(1).uniform(-1, 1, len(INSTANTS))
    bands = np.full((1, len(INSTANTS)), BAND)
    test = Measurement(INSTANTS, values[None], bands, limits, np.arange(2), starts=2)

    def evaluate(t, points, halvings):
        return np.array([[curve(x, TIMES)] for x in points])

    result = calibrate([test], TIMES, evaluate, np.array([[-1.0, -1.0], [1.0, 1.0]]))
    (low, high), (least, largest) = exact_hull(curve, test), result.hull
    assert (least <= low + 1e-6).all() and (high - 1e-6 <= largest).all()
    assert (largest - least <= 1.3 * (high - low)).all()
    assert result.attained - result.least < 0.05 * result.attained
