"""The step that is called stable, against the limit that bisection finds."""

import numpy as np
import pytest

import fpm
from evidence.extremes.stable_step import MATERIAL, bar, bennett, study


@pytest.mark.slow
def test_the_estimate_is_just_below_the_true_limit():
    """Bars stubby and slender, the linkage, stiff contact and stiff arms: 0.7 to 1 everywhere."""
    rows = study(fast=True)
    assert len(rows) > 15
    assert [(row.name, row.value) for row in rows if not row.passed] == []


def element_step(slenderness: float, scale: float) -> float:
    """Limit (s) of one free element of 1 m with its share of the masses: the smaller of

    (l/c) / sqrt(12 (r/l)² + 3/f) of antisymmetric bending, k = 12 EI/l on the inertias f rho I l/2
    and masses rho A l/2 of both ends, and l/c of the axial mode; c² = E/rho.
    """
    time = np.sqrt(MATERIAL.rho / MATERIAL.E)
    return time * min(1.0, 1.0 / np.sqrt(12 / slenderness**2 + 3 / scale))


@pytest.mark.parametrize("slenderness", [0.2, 2.0, 20.0, 200.0])
@pytest.mark.parametrize("scale", [1.0, 3.0])
def test_the_element_formula(slenderness, scale):
    """One element: exact. A bar of many: between that and the step of the fastest chain."""
    formula = element_step(slenderness, scale)
    assert fpm.find_stable_step(bar(slenderness, 1, scale)).step == pytest.approx(formula, rel=1e-9)


def test_a_stiff_contact_is_named_and_seen_from_any_start():
    """The limit does not depend on where the linkage starts, shut or far from it."""
    found = [fpm.find_stable_step(bennett(K_C=1e7, start=s)) for s in (5.0, 60.0, 120.0)]
    assert all(f.element.startswith("contact ") for f in found)
    assert np.ptp([f.step for f in found]) < 1e-6 * found[0].step
