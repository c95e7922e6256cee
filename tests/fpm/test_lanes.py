"""Lanes compute what numpy computes, lane by lane."""

import numpy as np
from numba import njit

from fpm.kernels import rotation
from fpm.kernels.lanes import any_negative, load, store


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
