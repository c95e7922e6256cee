"""Error estimates and metrics."""

import numpy as np
import pytest

from deployable.intervals import Surrogate, fit, hausdorff, make_design
from deployable.intervals.box import corner_points, held_out_points
from deployable.intervals.estimates import (
    MAX_TAIL_RATIO,
    estimate_decay,
    limit_decay,
    power_mean,
    widen,
)


@pytest.mark.parametrize("order", [3, 4, 7, 8])
@pytest.mark.parametrize("function", [np.exp, np.cos, np.sin, lambda x: 1 / (2 - x)])
def test_decay_foretells_the_error_of_smooth_functions(function, order):
    design = make_design("tensor_roots", 1, order)
    surrogate = fit(design, function(design.points))
    x = np.linspace(-1, 1, 201)[:, None]
    true = np.abs(surrogate.evaluate(x) - function(x)).max()
    told = estimate_decay(surrogate)[0]
    assert true / 10 < told < 100 * true + 1e-14


@pytest.mark.parametrize("order", [2, 3, 4, 5, 8])
@pytest.mark.parametrize("ratio", [0.1, 0.5])
def test_coefficients_that_fall_by_a_factor_foretell_the_next_ones(order, ratio):
    """One coefficient after order 2, two after higher ones."""
    degrees = np.arange(order + 1)[:, None]
    surrogate = Surrogate(-(ratio**degrees), degrees)
    after = ratio ** (order + 1) + (ratio ** (order + 2) if order > 2 else 0.0)
    assert float(estimate_decay(surrogate)[0]) == pytest.approx(after)


def test_largest_value_in_a_window():
    time = np.array([0.0, 0.1, 0.2, 0.5, 0.6, 1.0])
    error = np.array([[0.0, 3.0, 0.0, 1.0, 0.0, 0.0], [5.0, 0, 0, 0, 0, 2.0]])
    expected = [
        [max(e for t, e in zip(time, row, strict=True) if abs(t - s) <= 0.1001) for s in time]
        for row in error
    ]
    np.testing.assert_array_equal(widen(time, error, 0.1), expected)
    np.testing.assert_array_equal(widen(time, error, 0.0), error)


TIME = np.linspace(0, 1, 3)


def tails(function, method, order, dimension, count):
    """The tail foretold, what `count` held-out runs leave of it, and the true error; curves."""
    design = make_design(method, dimension, order)
    held_out = held_out_points(np.ones(dimension, bool), count, design.points)

    def curves(points):
        return function(points)[:, None] * np.ones(len(TIME))

    surrogate = fit(design, curves(design.points))
    missed = curves(held_out) - surrogate.evaluate(held_out)
    told = estimate_decay(surrogate, TIME)
    left = limit_decay(surrogate, design.points, held_out, missed, told, TIME)
    line = np.linspace(-1, 1, 41)
    dense = np.stack(np.meshgrid(*[line] * dimension), axis=-1).reshape(-1, dimension)
    true = np.abs(surrogate.evaluate(dense) - curves(dense)).max(axis=0)
    return told, left, true


@pytest.mark.parametrize("method", ["tensor_roots", "tensor_lobatto"])
@pytest.mark.parametrize(("dimension", "count"), [(1, 2), (2, 5)])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_an_exact_polynomial_is_known_to_be_exact(method, dimension, count, order):
    """An even one of order 2 or 3, and a linear one of order 1, show no decay."""

    def exact(points):
        return (points**2).sum(axis=1) if order > 1 else points.sum(axis=1)

    told, left, true = tails(exact, method, order, dimension, count)
    assert true.max() < 1e-12
    assert left.max() < 1e-11
    assert (left <= told).all()
    if order < 3:
        assert told.min() > 0.3  # of a width of 1 or 2 in each direction: too few runs to know
        told, left, _ = tails(exact, method, order, dimension, 2 * dimension - 1)
        np.testing.assert_array_equal(left, told)


@pytest.mark.parametrize(
    "function", [np.exp, lambda x: np.sin(3 * x), lambda x: 1 / (3 - x), np.abs]
)
@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("dimension", [1, 2])
def test_a_tail_is_not_overruled_where_it_is_there(function, order, dimension):
    told, left, true = tails(
        lambda points: function(points.sum(axis=1)), "tensor_roots", order, dimension, 5
    )
    assert (left >= np.minimum(true, told)).all()


@pytest.mark.parametrize("degree", [(3, 0), (0, 3), (4, 0), (0, 4)])
def test_the_next_coefficient_of_one_direction_is_told_by_five_runs(degree):
    design = make_design("tensor_roots", 2, 2)

    def curve(points):
        x, y = points.T
        wave = [np.polynomial.Chebyshev.basis(n)(u) for n, u in zip(degree, (x, y), strict=True)]
        return (x + y + 1e-3 * wave[0] * wave[1])[:, None]

    surrogate = fit(design, curve(design.points))
    held_out = held_out_points(np.ones(2, dtype=bool), 5)
    missed = curve(held_out) - surrogate.evaluate(held_out)
    left = limit_decay(surrogate, design.points, held_out, missed, np.ones(1), np.zeros(1))
    largest = max(1e-3, np.abs(missed).max())
    assert left == pytest.approx(MAX_TAIL_RATIO * largest, rel=1e-9)


@pytest.mark.parametrize(
    ("directions", "expected"), [(0, 2.5), (1, 2.5), (2, 7.5**0.5), (3, 25.0 ** (1 / 3)), (4, 4.0)]
)
def test_runs_that_were_sought_count_by_a_mean_in_few_directions(directions, expected):
    left_out = np.array([1.0, -2.0, 3.0, -4.0])
    assert power_mean(left_out, directions) == pytest.approx(expected, rel=1e-12)


def test_the_hausdorff_distance_is_the_larger_of_both_ends():
    assert hausdorff(np.array(0.0), np.array(1.0), np.array(0.2), np.array(3.0)) == 2.0


@pytest.mark.parametrize("free", [[], [False], [True], [True, False, True], [True] * 4])
def test_corners_are_those_of_the_directions_that_are_free(free):
    found, free = corner_points(np.array(free, dtype=bool)), np.array(free, dtype=bool)
    assert found.shape == (2 ** int(free.sum()), len(free))
    assert len(np.unique(found, axis=0)) == len(found)
    assert (np.abs(found) == free).all()
    np.testing.assert_array_equal(found[1::2], -found[: 2 * (len(found) // 2) : 2])
