"""Surrogates: evaluation, refusals."""

import numpy as np
import pytest

from deployable.intervals import IntervalError, fit, make_design


@pytest.mark.parametrize(("method", "kind"), [("tensor_roots", 2), ("tensor_lobatto", 1)])
def test_coefficients_on_grids_agree_with_the_paper_and_with_a_dct(method, kind):
    from scipy.fft import dct

    values = np.random.default_rng(0).standard_normal(8)
    expected = dct(values[::-1], type=kind) / (8 if kind == 2 else 7)
    expected[[0] if kind == 2 else [0, -1]] /= 2
    found = fit(make_design(method, 1, 7), values).coefficients
    np.testing.assert_allclose(found, expected, atol=1e-14)


def test_trailing_axes_are_kept_and_least_squares_smooths():
    design = make_design("sobol", 2, 2, samples=18)
    values = np.random.default_rng(0).standard_normal((design.run_count, 3, 4))
    surrogate = fit(design, values)
    assert surrogate.evaluate(np.zeros((5, 2))).shape == (5, 3, 4)
    rest = (values - surrogate.evaluate(design.points)).reshape(design.run_count, -1)
    from deployable.intervals.chebyshev import product_basis

    basis = product_basis(design.points, design.multi_indices)
    np.testing.assert_allclose(basis.T @ rest, 0, atol=1e-12)  # normal equations


def test_refusals():
    design = make_design("tensor_roots", 1, 3)
    with pytest.raises(IntervalError, match="rows"):
        fit(design, np.zeros((3, 5)))
    with pytest.raises(IntervalError, match="finite"):
        fit(design, np.full((4, 5), np.nan))
    with pytest.raises(IntervalError, match="order"):
        fit(make_design("sobol", 1, samples=4), np.zeros((4, 5)))
    with pytest.raises(IntervalError, match="shape"):
        fit(design, np.zeros(4)).evaluate(np.zeros((2, 3)))
