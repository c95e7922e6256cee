"""Vector arithmetic and nothing else: the machine's peak, in the width that the kernels use."""

import numpy as np

IN_A_ROUND = 12
"""Independent multiply-adds in a round; two a cycle of four cycles each keep eight under way."""

MIXTURE = {"fma": 240, "multiply": 160, "add": 100, "divide": 3, "root": 2}
"""Operations of a round of `mixture`, in the proportions of a step of the linkage (operations.py):
processors that add where they multiply, or that divide slowly, take longer for it."""


def functions():
    """Compiled loops over n rounds: of 12 independent multiply-adds, of one that depends on the
    last, and of a mixture of operations of which enough are independent."""
    from numba import njit

    from fpm.kernels.lanes import load, sqrt, store

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
        store(a, 0, 2, s0 + s1 + s2 + s3 + s4 + s5 + s6 + s7 + t0 + t1 + t2 + t3)

    @njit(error_model="numpy", nogil=True)
    def dependent(a, n):
        x, c, s = load(a, 0, 0), load(a, 0, 1), load(a, 1, 0)
        for _ in range(n):
            s = s * x + c
        store(a, 0, 2, s)

    @njit(error_model="numpy", nogil=True)
    def mixture(a, n):
        x, unity, zero = load(a, 0, 0), 2.0 * load(a, 0, 1), load(a, 0, 1) - load(a, 0, 0)
        f0, f1, f2, f3, f4, f5 = x, x, x, x, x, x
        m0, m1, m2, m3 = x, x, x, x
        s0, s1, s2, s3, s4 = x, x, x, x, x
        d0, d1, d2, r0, r1 = x, x, x, x, x
        for _ in range(n):
            d0, d1, d2, r0, r1 = d0 / unity, d1 / unity, d2 / unity, sqrt(r0), sqrt(r1)
            for _ in range(20):
                f0, f1, f2 = f0 * x + x, f1 * x + x, f2 * x + x
                m0, m1, m2, m3 = m0 * unity, m1 * unity, m2 * unity, m3 * unity
                f3, f4, f5 = f3 * x + x, f4 * x + x, f5 * x + x
                s0, s1, s2, s3, s4 = s0 + zero, s1 + zero, s2 + zero, s3 + zero, s4 + zero
                f0, f1, f2 = f0 * x + x, f1 * x + x, f2 * x + x
                m0, m1, m2, m3 = m0 * unity, m1 * unity, m2 * unity, m3 * unity
                f3, f4, f5 = f3 * x + x, f4 * x + x, f5 * x + x
        total = f0 + f1 + f2 + f3 + f4 + f5 + m0 + m1 + m2 + m3 + s0 + s1 + s2 + s3 + s4
        store(a, 0, 2, total + d0 + d1 + d2 + r0 + r1)

    return independent, dependent, mixture


def operands() -> np.ndarray:
    """An array for these loops, which write to its last fields only."""
    return np.full((7, 3, 8), 0.5)
