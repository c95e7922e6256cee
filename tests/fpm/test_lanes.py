"""Lanes compute what numpy computes, lane by lane."""

import numpy as np
from numba import njit

from fpm.elements.cables.cable_friction_kernels import exponential
from fpm.kernels import rotation, vectors
from fpm.kernels.lanes import any_negative, floor, load, sqrt, store, where_negative


@njit(error_model="numpy")
def arithmetic(a, out, row):
    x, y = load(a, row, 0), load(a, row, 1)
    store(out, row, 0, x + 2.0 * y - 1)
    store(out, row, 1, -x / y)
    store(out, row, 2, sqrt(x * x))
    store(out, row, 3, floor(x))
    store(out, row, 4, where_negative(x, y, 7.0))


def test_arithmetic_is_that_of_numpy():
    rng = np.random.default_rng(1)
    a = rng.normal(size=(3, 2, 8))
    out = np.zeros((3, 5, 8))
    arithmetic(a, out, 1)
    x, y = a[1]
    close = {"rtol": 8 * np.finfo(float).eps, "atol": 4 * np.finfo(float).eps}
    np.testing.assert_allclose(out[1, 0], x + 2 * y - 1, **close)
    np.testing.assert_allclose(out[1, 1], -x / y, **close)
    np.testing.assert_allclose(out[1, 2], np.abs(x), **close)
    np.testing.assert_array_equal(out[1, 3], np.floor(x))
    np.testing.assert_array_equal(out[1, 4], np.where(x < 0, y, 7.0))
    assert not out[[0, 2]].any(), "rows that were not asked for were written"


@njit(error_model="numpy")
def negative(a):
    return any_negative(load(a, 0, 0))


def test_any_negative_looks_at_every_lane_and_not_at_nan():
    a = np.ones((1, 1, 8))
    assert not negative(a)
    a[0, 0, 3] = np.nan
    assert not negative(a)
    for lane in range(8):
        b = np.ones((1, 1, 8))
        b[0, 0, lane] = -1e-300
        assert negative(b)


@njit(error_model="numpy")
def angle(a, out):
    store(out, 0, 0, rotation.arctan2(load(a, 0, 0), load(a, 0, 1)))


def test_arctan2_is_that_of_the_library():
    rng = np.random.default_rng(2)
    exact = np.concatenate([rng.uniform(-np.pi, np.pi, 2000), np.arange(-3.5, 3.6) * np.pi / 4])
    for chunk in np.array_split(exact, len(exact) // 8):
        chunk = np.resize(chunk, 8)
        a = np.zeros((1, 2, 8))
        a[0, 0], a[0, 1] = np.sin(chunk), np.cos(chunk)
        out = np.zeros((1, 1, 8))
        angle(a, out)
        np.testing.assert_allclose(out[0, 0], np.arctan2(a[0, 0], a[0, 1]), rtol=0, atol=5e-16)


@njit(error_model="numpy")
def power(a, out):
    store(out, 0, 0, exponential(load(a, 0, 0)))


def test_the_exponential_of_a_rubbing_cable_is_that_of_the_library():
    a, out = np.array([[[0.0, 1e-3, 0.1, 0.4, 1.5, 4.0, 10.0, 40.0]]]), np.zeros((1, 1, 8))
    power(a, out)
    np.testing.assert_allclose(out[0, 0, :7], np.exp(a[0, 0, :7]), rtol=1e-11)
    np.testing.assert_allclose(out[0, 0, 7], np.exp(30.0), rtol=1e-6)


@njit(error_model="numpy")
def inverse(a, out):
    s = (load(a, 0, 0), load(a, 0, 1), load(a, 0, 2), load(a, 0, 3), load(a, 0, 4), load(a, 0, 5))
    for k, value in enumerate(vectors.invert(s)):
        store(out, 0, k, value)


def test_symmetric_inverse():
    rng = np.random.default_rng(3)
    root = rng.normal(size=(8, 3, 3))
    matrix = root @ root.transpose(0, 2, 1) + np.eye(3)
    pick = lambda m: np.stack(  # noqa: E731
        [m[:, 0, 0], m[:, 1, 1], m[:, 2, 2], m[:, 0, 1], m[:, 0, 2], m[:, 1, 2]]
    )
    out = np.zeros((1, 6, 8))
    inverse(pick(matrix)[None].copy(), out)
    np.testing.assert_allclose(out[0], pick(np.linalg.inv(matrix)), rtol=1e-11, atol=1e-13)
