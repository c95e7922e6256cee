"""Ranges: exact in one dimension, enclosures with a known gap in several."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import chebyshev

from deployable.intervals import Surrogate, find_surrogate_range
from deployable.intervals.chebyshev import tensor, total_degree
from deployable.intervals.enclosures import effects_enclosure, grid_enclosure, tighten
from deployable.intervals.line_range import line_range
from deployable.intervals.ranges import find_inner_range


def colleague_range(c):
    """Range of one Chebyshev sum by the roots of its derivative."""
    roots = chebyshev.chebroots(chebyshev.chebder(c)) if len(c) > 2 else np.zeros(0)
    real = roots.real[(np.abs(roots.imag) < 1e-6) & (np.abs(roots.real) <= 1)]
    values = chebyshev.chebval(np.concatenate([[-1.0, 1.0], real]), c)
    return values.min(), values.max()


@pytest.mark.parametrize("order", [1, 2, 3, 5, 9, 20, 40, 64])
def test_one_dimension_agrees_with_the_colleague_matrix(order):
    c = np.random.default_rng(order).standard_normal((order + 1, 60))
    low, high, x_low, x_high, slack = line_range(c)
    expected = np.array([colleague_range(column) for column in c.T]).T
    scale = np.abs(c).sum(axis=0)
    assert (np.abs(low - expected[0]) <= 1e-13 * scale).all()
    assert (np.abs(high - expected[1]) <= 1e-13 * scale).all()
    assert (np.abs(chebyshev.chebval(x_low, c, tensor=False) - low) <= 1e-13 * scale).all()
    assert (np.abs(chebyshev.chebval(x_high, c, tensor=False) - high) <= 1e-13 * scale).all()
    assert (slack <= 1e-12 * scale).all()


@pytest.mark.parametrize(
    ("function", "order", "low", "high"),
    [
        (lambda x: 0 * x + 0.3, 5, 0.3, 0.3),
        (lambda x: 1 + 1e-12 * x, 9, 1 - 1e-12, 1 + 1e-12),
        (lambda x: (x - 0.3) ** 4, 4, 0.0, 1.3**4),
        (lambda x: (x - 0.3) ** 16, 20, 0.0, 1.3**16),
        (lambda x: x**10, 10, 0.0, 1.0),
        (lambda x: (x - 0.3) ** 3, 3, -(1.3**3), 0.7**3),
    ],
)
def test_one_dimension_with_flat_extremes_and_constants(function, order, low, high):
    c = chebyshev.chebinterpolate(function, order)[:, None]
    found = line_range(c)
    size = np.abs(c).sum()
    assert found[0][0] == pytest.approx(low, abs=2e-14 * size)
    assert found[1][0] == pytest.approx(high, abs=2e-14 * size)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(
    st.integers(2, 4),
    st.integers(1, 4),
    st.sampled_from([tensor, total_degree]),
    st.sampled_from([1.0, 0.3]),
    st.integers(0, 10**6),
)
def test_enclosures_hold_on_random_tensors(k, order, kind, decay, seed):
    order = min(order, 2) if k == 4 else order
    generator = np.random.default_rng(seed)
    indices = kind([order] * k)
    c = generator.standard_normal((len(indices), 4)) * decay ** indices.sum(axis=1)[:, None]
    surrogate = Surrogate(c, indices)
    points = np.concatenate(
        [generator.uniform(-1, 1, (400, k)), generator.choice([-1.0, 0.0, 1.0], (100, k))]
    )
    values = surrogate.evaluate(points)
    found = find_surrogate_range(surrogate)
    enclosures = [effects_enclosure(c, indices), grid_enclosure(c, indices)]
    enclosures += [grid_enclosure(c, indices, density=2), (found.lower, found.upper)]
    for lower, upper in enclosures:
        assert (values >= lower).all()
        assert (values <= upper).all()
    low, high, _, _ = find_inner_range(c, indices)
    bernstein, _, _ = tighten(surrogate.dense(), high, np.full(4, np.inf), np.zeros(4))
    assert (values <= bernstein).all()
    assert (low >= found.lower).all()
    assert (high <= found.upper).all()
    # what is called attained is attained
    at = surrogate.evaluate(found.argmax)[np.arange(4), np.arange(4)]
    np.testing.assert_allclose(at, found.inner_upper, atol=1e-12 * np.abs(c).sum())
    at = surrogate.evaluate(found.argmin)[np.arange(4), np.arange(4)]
    np.testing.assert_allclose(at, found.inner_lower, atol=1e-12 * np.abs(c).sum())
    assert (np.abs(found.argmax) <= 1).all()
    # and nothing that was sampled lies outside the inner range by more than the gap
    gap = found.gap
    assert (values.max(axis=0) <= found.inner_upper + gap).all()
    assert (gap <= 0.06 * (found.inner_upper - found.inner_lower)).all()


def exact_value(c, indices, x):
    """The polynomial at x in rational numbers."""
    total = Fraction(0)
    powers = []
    for value, degree in zip(x, indices.max(axis=0), strict=True):
        value, terms = Fraction(float(value)), [Fraction(1), Fraction(float(value))]
        for _ in range(2, degree + 1):
            terms.append(2 * value * terms[-1] - terms[-2])
        powers.append(terms)
    for coefficient, row in zip(c, indices, strict=True):
        product = Fraction(float(coefficient))
        for terms, i in zip(powers, row, strict=True):
            product *= terms[int(i)]
        total += product
    return total


@settings(max_examples=30, deadline=None)
@given(
    st.integers(1, 3),
    st.integers(1, 4),
    st.sampled_from([0.0, 1e3, -1e6, 1e8]),
    st.sampled_from([1.0, 1e-8, 1e-12]),
    st.integers(0, 10**6),
)
def test_rounding_is_within_the_outer_range(k, order, constant, size, seed):
    generator = np.random.default_rng(seed)
    indices = tensor([order] * k)
    c = size * generator.standard_normal((len(indices), 1))
    c[0] += constant
    found = find_surrogate_range(Surrogate(c, indices))
    points = [found.argmin[0], found.argmax[0], *generator.choice([-1.0, 0.3, 1.0], (4, k))]
    for x in points:
        value = exact_value(c[:, 0], indices, x)
        assert Fraction(float(found.lower[0])) <= value <= Fraction(float(found.upper[0]))
    rounding = 100 * np.finfo(float).eps * np.abs(c).sum() * len(c)
    assert found.gap[0] <= 0.06 * (found.inner_upper[0] - found.inner_lower[0]) + rounding


@pytest.mark.parametrize(("order", "density"), [(200, 8), (200, 4), (60, 2)])
def test_a_grid_encloses_no_wider_than_its_density_foretells(order, density):
    """By Ehlich and Zeller each end lies 1 / cos(pi / (2 density)) - 1 of half the width beyond."""
    indices = np.arange(order + 1)[:, None]
    c = np.random.default_rng(5).standard_normal((order + 1, 10))
    values = np.polynomial.chebyshev.chebval(np.cos(np.linspace(0, np.pi, 200 * order)), c)
    low, high = values.min(axis=1), values.max(axis=1)
    beyond = (1 / np.cos(np.pi / (2 * density)) - 1) * (high - low) / 2 + 1e-9
    lower, upper = grid_enclosure(c, indices, density)
    assert (lower <= low).all() and (lower >= low - beyond).all()
    assert (upper >= high).all() and (upper <= high + beyond).all()
    found = grid_enclosure(2.0**70 * c, indices, density)
    np.testing.assert_array_equal(found, 2.0**70 * np.array([lower, upper]))


def test_shape_and_directions_without_width():
    indices = np.array([[0, 0], [0, 1], [0, 2]])
    c = np.random.default_rng(0).standard_normal((3, 2, 5))
    found = find_surrogate_range(Surrogate(c, indices))
    assert found.lower.shape == (2, 5)
    assert found.argmin.shape == (2, 5, 2)
    expected = np.array([colleague_range(x) for x in c.reshape(3, -1).T])
    np.testing.assert_allclose(found.lower.ravel(), expected[:, 0], atol=1e-13)
    np.testing.assert_allclose(found.upper.ravel(), expected[:, 1], atol=1e-13)
