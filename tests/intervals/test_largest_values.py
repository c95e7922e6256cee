"""The largest value of a function over a part of the box, where only some of it has values."""

import numpy as np
import pytest

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
