"""The study of scaling tells growth that is too fast, and joints that gape."""

from dataclasses import replace

import pytest

from evidence.scaling import masts
from evidence.scaling.study import growth, mast_rows

LINEAR = [
    masts.Size(n, 8 * max(n, 6), n, 1e-5, 8000, 1e-6 * max(n, 6), 0.1, 1e-8, 1e-16, 0.0)
    for n in (0, 1, 10, 20, 50, 100)
]


def failed(rows) -> list[str]:
    return [row.name for row in rows if row.is_failed]


def test_the_exponent_of_the_cost_is_found():
    square = [replace(size, cost=size.units**2 * 1e-6) for size in LINEAR]
    assert growth(LINEAR) == pytest.approx(1)
    assert growth(square) == pytest.approx(2)
    assert failed(mast_rows(LINEAR)) == []
    assert failed(mast_rows(square)) == ["exponent of the cost of a step, 10 to 100 units"]
