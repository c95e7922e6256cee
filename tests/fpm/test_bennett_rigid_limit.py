"""The flexible solver against the rigid one-degree-of-freedom linkage, as the links get stiffer."""

import numpy as np
import pytest

import fpm
from evidence.linkage.rigid import RigidBennett
from evidence.linkage.runs import build

# (lambda, mu) in degrees and supports; each closes between 0.26 and 0.39 s.
CASES = [
    ((45.0, 45.0), "plane"),
    pytest.param((45.0, 45.0), "free", marks=pytest.mark.slow),
    ((30.0, 60.0), "plane"),
    pytest.param((45.0, 22.5), "plane", marks=pytest.mark.slow),
    pytest.param((65.0, 35.0), "plane", marks=pytest.mark.slow),
]


def errors_before_closure(angles, supports, moduli):
    """Largest errors of BD and of B's z-velocity, as shares of their ranges, one row per E (Pa)."""
    times = np.linspace(0.0, 0.4, 401)
    rigid = RigidBennett(lambda_deg=angles[0], mu_deg=angles[1], supports=supports)
    curves = rigid.simulate(5.0, times)
    rows = []
    for modulus in moduli:
        scene = build(
            E=modulus,
            roll=angles[0],
            mu=angles[1],
            supports=supports,
            start=5.0,
            K_F=rigid.spring_stiffness,
            elements=2,
        )
        (outcome,) = fpm.simulate(scene, duration=times[-1], instants=times.size)
        assert outcome.failure is None
        assert outcome.events[0, 0] == pytest.approx(curves["closings"][0], rel=2e-3)
        before = times < min(outcome.events[0, 0], curves["closings"][0])
        b, d = outcome.points["B"], outcome.points["D"]
        row = []
        for found, expected in (
            (np.linalg.norm(b[0] - d[0], axis=1), curves["BD"]),
            (b[1][:, 2], curves["velocity_Bz"]),
        ):
            expected = expected[before]
            row.append(np.abs(found[before] - expected).max() / np.ptp(expected))
        rows.append(row)
    return np.array(rows)


@pytest.mark.parametrize(("angles", "supports"), CASES)
def test_stiff_links_move_as_rigid_ones(angles, supports):
    """Within 0.5 % of the range where bending is negligible."""
    assert errors_before_closure(angles, supports, [1e12]).max() < 0.005


@pytest.mark.slow
def test_the_difference_is_the_links_flexibility():
    """Bending goes with 1 / E, and so does the difference to the rigid linkage."""
    errors = errors_before_closure((45.0, 45.0), "plane", [1e11, 1e12])
    ratios = errors[0] / errors[1]
    assert np.all(ratios > 5.0)
    assert np.all(ratios < 20.0)
