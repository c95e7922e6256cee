"""Surrogates of numbers as tables: the same function, to less than a millionth of its width."""

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebvander
from scipy.spatial.distance import cdist

from deployable.intervals.scalars import fit_scalar

KERNELS = {
    "cube": lambda d: d**3,
    "fading": lambda d: np.exp(-d),
    "matern": lambda d: (1 + d + d**2 / 3) * np.exp(-d),
}


def evaluated(table, unit):
    """What a table says (P) at unit coordinates (P, k), by its text."""
    products = np.ones((len(unit), len(table.indices)))
    for j, powers in enumerate(table.indices.T):
        products *= chebvander(unit[:, j], powers.max())[:, powers]
    away = cdist(unit * table.scales, table.points * table.scales)
    return products @ table.coefficients + KERNELS[table.kernel](away) @ table.weights


def runs(count, k, seed=1):
    return np.random.default_rng(seed).uniform(-1, 1, (count, k))


def smooth(unit):
    return 3 + unit[:, 0] + 0.3 * unit[:, -1] ** 2


def rough(unit):
    """No polynomial: a corner, which a spline or what fades about the runs takes up."""
    return np.abs(unit[:, 0] - 0.1) + 0.3 * unit.sum(axis=1)


def noisy(unit):
    return smooth(unit) + 0.1 * np.sin(1e4 * unit[:, 0])


@pytest.mark.parametrize("number", [smooth, rough, noisy])
@pytest.mark.parametrize("k", [1, 3])
@pytest.mark.parametrize("border", [-9.0, 3.1])
def test_a_table_is_the_surrogate(number, k, border):
    """Where there is a number everywhere, and where it is missing beyond a border."""
    unit, places = runs(60, k), runs(500, k, seed=2)
    values = np.where(smooth(unit) > border, number(unit), np.nan)
    surrogate = fit_scalar(unit, values)
    value, there = surrogate.formulas()
    inside = there if isinstance(there, bool) else evaluated(there, places) >= 0
    found = np.where(inside, evaluated(value, places), np.nan)
    wanted = surrogate.evaluate(places)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-6 * np.ptp(number(unit)))
    assert np.isnan(wanted).any() == (border > 0)


def test_what_ends_with_the_runs_is_below_their_end():
    unit, places = runs(80, 2), runs(200, 2, seed=3)
    time = 3 + unit[:, 0] + unit[:, 1]
    surrogate = fit_scalar(unit, np.where(time < 4, time, np.nan), latest=4.0)
    _, there = surrogate.formulas()
    assert ((evaluated(there, places) >= 0) == np.isfinite(surrogate.evaluate(places))).all()


def test_a_number_that_no_run_has_is_nowhere():
    assert fit_scalar(runs(9, 2), np.full(9, np.nan)).formulas() == (None, False)
