"""Vector multiply-adds and nothing else: the machine's peak, in the width that the kernels use."""

import numpy as np

IN_A_ROUND = 12
"""Independent multiply-adds in a round; two a cycle of four cycles each keep eight under way."""


def functions():
    """Compiled loops over n rounds of 12 independent, or of one dependent, multiply-add."""
    from numba import njit

    from deployable.fpm.kernels.lanes import load, store

    @njit(error_model="numpy", nogil=True)
    def independent(a, n):
        x, c = load(a, 0, 0), load(a, 0, 1)
        s0, s1, s2, s3 = load(a, 1, 0), load(a, 1, 1), load(a, 2, 0), load(a, 2, 1)
        s4, s5, s6, s7 = load(a, 3, 0), load(a, 3, 1), load(a, 4, 0), load(a, 4, 1)
        t0, t1, t2, t3 = load(a, 5, 0), load(a, 5, 1), load(a, 6, 0), load(a, 6, 1)
        for _ in range(n):
            s0, s1, s2, s3 = s0 * x + c, s1 * x + c, s2 * x + c, s3 * x + c
            s4, s5, s6, s7 = s4 * x + c, s5 * x + c, s6 * x + c, s7 * x + c
            t0, t1, t2, t3 = t0 * x + c, t1 * x + c, t2 * x + c, t3 * x + c
        store(a, 0, 0, s0 + s1 + s2 + s3 + s4 + s5 + s6 + s7 + t0 + t1 + t2 + t3)

    @njit(error_model="numpy", nogil=True)
    def dependent(a, n):
        x, c, s = load(a, 0, 0), load(a, 0, 1), load(a, 1, 0)
        for _ in range(n):
            s = s * x + c
        store(a, 1, 0, s)

    return independent, dependent


def operands() -> np.ndarray:
    """An array for these loops."""
    return np.full((7, 2, 8), 0.5)
