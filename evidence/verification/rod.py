"""Static cantilever rod under a dead load at its tip: the reference for large deflections.

Nothing here is taken from ``fpm``. A Kirchhoff rod with axial stretch, without shear: with the
constant internal force n and the internal moment m (both in global axes),

    r' = (1 + n . d1 / EA) d1,   R' = R [k],   k = k0 + K^-1 R^T m,   m' = -r' x n,   m(L) = M,

R = (d1, d2, d3), K = diag(GJ, EI2, EI3). Solved by shooting for m(0) with a high-order Runge-Kutta
method, in load steps. Source: Antman, Nonlinear Problems of Elasticity, ch. VIII."""

import numpy as np


def clamped_rod(length, curvature, EA, K, force, load_steps=4):
    """Tip (3,) m and rotation matrix (3, 3) of a rod clamped at the origin, tangent along x.

    length (m); curvature (3,) of the unloaded rod in its own axes (1/m); EA (N); K (3,) N m²:
    torsion, bending about local y and about local z; force (3,) N at the tip."""
    from scipy.integrate import solve_ivp
    from scipy.optimize import root

    curvature, K, force = (np.asarray(x, float) for x in (curvature, K, force))

    def rate(_s, y, n):
        R, m = y[3:12].reshape(3, 3), y[12:]
        k = curvature + R.T @ m / K
        tangent = (1.0 + n @ R[:, 0] / EA) * R[:, 0]
        skew = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
        return np.concatenate([tangent, (R @ skew).ravel(), -np.cross(tangent, n)])

    def shoot(m0, n):
        start = np.concatenate([np.zeros(3), np.eye(3).ravel(), m0])
        options = {"args": (n,), "rtol": 1e-9, "atol": 1e-12}
        return solve_ivp(rate, (0.0, length), start, "DOP853", **options).y[:, -1]

    moment = np.zeros(3)
    scale = np.linalg.norm(force) * length
    for step in range(1, load_steps + 1):
        n = force * step / load_steps
        equilibrium = root(lambda m0: shoot(m0, n)[12:] / scale, moment, tol=1e-9)  # noqa: B023
        if np.abs(equilibrium.fun).max() > 1e-8:
            raise RuntimeError(f"rod: no equilibrium at load step {step}: {equilibrium.message}")
        moment = equilibrium.x
    end = shoot(moment, force)
    return end[:3], end[3:12].reshape(3, 3)
