"""Masses of the particles of a straight link.

Theory: docs/mechanics.md, "Masses of a link": the trapezium rule with Gregory's end corrections
(Hildebrand, Introduction to Numerical Analysis, 2nd ed., § 5.9), in differences up to the fourth,
or as many as find room on half of the link, but two at least; more do not pay, as elements are of
fourth order. The excess (f - 1) rho I L of a factor f on the inertia of sections is taken back by
moving a further ``(f - 1) (r/l)² n / (2 (n - 1))`` from the ends, as long as the end particle keeps
some mass."""

import math
from functools import lru_cache

import numpy as np

from fpm.errors import SceneError

GREGORY = (1 / 12, 1 / 24, 19 / 720, 3 / 160)
"""Coefficients of the differences in Gregory's end corrections of the trapezium rule."""

SMALLEST_END = 0.1
"""Least share of an element's mass that an end particle may keep."""


def end_weights(elements: int, order: int | None = None) -> np.ndarray:
    """Return the masses (n+1,) of the particles of a slender link, as fractions of the mass of one
    element. elements: their number n, at least 1; order: highest order of differences in Gregory's
    end corrections, 0 (the trapezium rule) to 4; None: n/2, but 2 to 4 (0 for one element)."""
    return np.array(_end_weights(elements, order))


@lru_cache(64)
def _end_weights(elements: int, order: int | None) -> tuple[float, ...]:
    weights = np.ones(elements + 1)
    weights[[0, -1]] = 0.5
    if order is None:
        order = min(max(elements // 2, 2), len(GREGORY)) if elements >= 2 else 0
    for k in range(1, order + 1):
        for j in range(k + 1):
            # The share of particle j in the difference of order k, whose sign alternates.
            weight = -GREGORY[k - 1] * (-1) ** j * math.comb(k, j)
            weights[j] += weight
            weights[-1 - j] += weight
    return tuple(weights.tolist())


def lump(length: float, elements: int, section, material, scale: float = 1.0):
    """Return particle masses (n+1,) kg and principal inertias (n+1, 3) kg m² (about x, y, z) of a
    straight uniform link. length (m): of it; elements: their number n; section (Section), material
    (Material); scale: factor on the section's transverse rotational inertia, above 1 to allow
    longer time steps. For n >= 2 mass, centre and inertia tensor are exactly those of a uniform
    bar; for n = 1 mass, centre and polar inertia. SceneError if `elements` is no whole number above
    0, or `scale` below 1 or too large for positive end masses."""
    if elements < 1 or int(elements) != elements:
        raise SceneError("elements", elements, "a whole number, at least 1")
    if not scale >= 1.0:
        raise SceneError("rotational inertia scale", scale, "a number >= 1")
    n, l = int(elements), length / elements
    weights = end_weights(n)
    if n >= 2 and scale > 1:
        radius2 = max(section.Iy, section.Iz) / section.A
        shift = n / (n - 1) * (scale - 1) / 2 * radius2 / l**2
        if weights[0] - shift < SMALLEST_END:
            spare = (weights[0] - SMALLEST_END) * (n - 1) / n
            largest = 1 + 2 * l**2 / radius2 * spare
            allowed = f"at most {largest:.4g} for {n} elements"
            raise SceneError("rotational inertia scale", scale, allowed)
        weights[[0, -1]] -= shift
        weights[1] += shift
        weights[-2] += shift
    mass = material.rho * section.A * l * weights
    weight = np.ones(n + 1)
    weight[[0, -1]] = 0.5
    principal = np.array([section.Iy + section.Iz, scale * section.Iy, scale * section.Iz])
    inertia = material.rho * l * weight[:, None] * principal
    return mass, inertia
