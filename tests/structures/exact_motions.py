"""Exact motions that structures of the library are compared with."""

import numpy as np
from scipy.integrate import quad, solve_ivp


def crossing(time, values, level):
    """The first time (s) at which values (t,) pass a level, and their rate there.

    A cubic through the four instants around it.
    """
    after = int(np.argmax((values[1:] - level) * (values[0] - level) <= 0)) + 1
    near = slice(max(after - 2, 0), max(after - 2, 0) + 4)
    cubic = np.polynomial.Polynomial.fit(time[near], values[near] - level, 3)
    root = min(cubic.roots().real, key=lambda t: abs(t - time[after]))
    return float(root), float(cubic.deriv()(root))


def scissor(units, k=1.0, gyration=0.0):
    """Time (s) and rate (rad/s) of a rigid planar scissor mast from 85 to 30 degrees to its axis.

    Bars of 1 m and 1 kg; gyration (m): radius of gyration of a bar's section, which turns with it.
    """

    start, end = np.radians([85, 30])

    def mass(q):
        crossed = units / 12 + np.sin(q) ** 2 * units * (4 * units**2 - 1) / 12
        return 2 * (crossed + units * gyration**2)

    def rate(q):
        return np.sqrt(4 * units * k * (start**2 - q**2) / mass(q))

    # With q = start - u², the integrand stays finite where the mast starts from rest.
    def slowness(u):
        q = start - u * u
        return 2 * u / rate(q) if u else 2 / np.sqrt(8 * units * k * start / mass(start))

    return quad(slowness, 0, np.sqrt(start - end), epsabs=1e-13)[0], float(rate(end))


def zfold(k, fold, gyration, times):
    """Tip angles (t, 2) of two rigid panels of 1 m and 1 kg, both from the x axis, in rad.

    The root's spring rests at pi/2, the knee's with the panels folded onto each other.
    """
    turning = 1 / 3 + gyration**2

    def slopes(_, y):
        one, two, rate1, rate2 = y
        cosine, sine = np.cos(one - two) / 2, np.sin(one - two) / 2
        matrix = np.array([[turning + 1, cosine], [cosine, turning]])
        knee = k * (one - two)
        right = [
            -k * (one - np.pi / 2) - knee - sine * rate2**2,
            knee + sine * rate1**2,
        ]
        return [rate1, rate2, *np.linalg.solve(matrix, right)]

    start = [fold, np.pi - fold, 0, 0]
    run = solve_ivp(slopes, (0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-13)
    return run.y[:2].T
