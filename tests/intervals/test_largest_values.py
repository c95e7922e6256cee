"""The largest value of a function over a part of the box, where only some of it has values."""

import numpy as np
import pytest

from deployable.intervals.scalars.fits import Kriging, choose_fit
from deployable.intervals.scalars.surrogate import extreme


@pytest.mark.parametrize("level", [-1000.0, 0.0, 1000.0])
@pytest.mark.parametrize("edge", [0.37, 0.111, -0.2, 0.75])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_search_comes_back_from_where_there_are_no_values(level, edge, sign):
    def rising(points):
        x, y = points.T
        return np.where(x + y > edge, np.nan, sign * (level + x + y))

    value, where = extreme(rising, sign, -np.ones(2), np.ones(2))
    assert sign * value == pytest.approx(level + edge, abs=1e-3)
    assert where.sum() <= edge


def test_what_a_polynomial_leaves_of_runs_fades_between_them():
    """Nowhere more than at the runs, so that noise does not swing beyond them."""
    generator = np.random.default_rng(3)
    points = generator.uniform(-1.0, 1.0, (20, 2))
    fit = choose_fit(points, 1.0 + points[:, 0] + 0.05 * generator.standard_normal(20))
    assert isinstance(fit.function, Kriging)
    np.testing.assert_allclose(fit.evaluate(points), fit.values, atol=1e-9)
    left = np.abs(fit.values - fit.trend.evaluate(points)).max()
    dense = generator.uniform(-1.0, 1.0, (5000, 2))
    away = np.abs(fit.evaluate(dense) - fit.trend.evaluate(dense))
    assert away.max() <= left
    assert np.median(away) < 0.5 * left
