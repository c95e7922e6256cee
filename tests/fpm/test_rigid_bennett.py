"""The rigid reference linkage against published states, and its own energy."""

import math

import numpy as np
import pytest

from evidence.linkage.rigid import RigidBennett

# (lambda, mu) in degrees
FRAMES = [(45.0, 45.0), (30.0, 60.0), (65.0, 35.0)]
EACH_FRAME = pytest.mark.parametrize("angles", FRAMES, ids=lambda a: f"lambda{a[0]:g}-mu{a[1]:g}")


def linkage(angles=(45.0, 45.0), **changes):
    return RigidBennett(lambda_deg=angles[0], mu_deg=angles[1], **changes)


# Bar axis, BD, AC, z_B - z_A, opening B, opening A, with the digits they are printed with.  The two
# openings at B marked so were first published 0.2 and 0.1 degrees off, against their own rows:
# tan(60 deg - psiA / 2) tan(60 deg + psiB / 2) = 3 in the square frame.
TABLE = [
    ((-0.707, 0.707, 0.0), 0.6014, 0.6714, 0.0, 0.0, 0.0),
    ((-0.529, 0.816, 0.233), 0.7153, 0.5155, 0.094, 39.3, 62.6),  # 39.5
    ((-0.385, 0.664, 0.640), 0.6019, 0.3871, 0.274, 63.7, 131.0),  # 63.6
    ((-0.207, 0.287, 0.935), 0.2838, 0.2251, 0.413, 90.7, 198.8),
    ((0.0, 0.0, 1.0), 0.035, 0.035, 0.450, 120.0, 240.0),
]


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"opening{row[4]:g}")
def test_published_states_of_the_square_frame(row):
    """One opening at B must give all the row's numbers at once, to the printed digits."""
    axis, bd, ac, height, opening_b, opening_a = row
    rigid, worst = linkage(), []
    ends = (rigid.beta_at(math.radians(opening_b + off)) for off in (-0.1, 0.1))
    for beta in np.linspace(*ends, 1001):
        motion = rigid.motion(beta)
        a, b, turned = motion["A"][0], motion["B"][0], math.degrees(motion["opening_a"][0])
        deviations = [
            *np.abs(motion["rotation"][0] @ rigid.axis - axis) / 1e-3,
            abs(2 * abs(b[1]) - bd) / 1e-4, abs(2 * abs(a[0]) - ac) / 1e-4,
            abs(b[2] - a[2] - height) / 1e-3,
            abs(math.degrees(motion["opening_b"][0]) - opening_b) / 0.1,
            min(abs(turned + full - opening_a) for full in (0, 360)) / 0.1,
        ]  # fmt: skip
        worst.append(max(deviations))
    # Units of the last digit.  Rounding allows 0.5; one row was cut (131.05 printed as 131.0).
    assert min(worst) < 0.6


def slope_at(function, place, step=1e-4):
    """Derivative by the five-point central difference."""
    near = function(place + step) - function(place - step)
    far = function(place + 2.0 * step) - function(place - 2.0 * step)
    return (8.0 * near - far) / (12.0 * step)


@EACH_FRAME
@pytest.mark.parametrize("supports", ["plane", "free"])
def test_derivatives_are_those_of_the_motion(angles, supports):
    """Finite differences, so that a wrong term of any derivative shows."""
    rigid = linkage(angles, supports=supports)
    for psi in (-0.05, 0.1, 0.7, 1.3):  # the first with the contacts' share
        beta = rigid.beta_at(psi)
        here = rigid.motion(beta)
        for name, values in here.items():
            for order in (0, 1):
                slope = slope_at(lambda b, n=name, o=order: rigid.motion(b)[n][o], beta)
                np.testing.assert_allclose(
                    values[order + 1], slope, rtol=1e-8, atol=1e-8, err_msg=name
                )
        slope = slope_at(lambda b: rigid.inertia(rigid.motion(b))[0], beta)
        assert rigid.inertia(here)[1] == pytest.approx(slope, rel=1e-8, abs=1e-8)
        slope = slope_at(lambda b: sum(rigid.potential(rigid.motion(b))[:2]), beta)
        assert rigid.potential(here)[2] == pytest.approx(slope, rel=1e-8)


@pytest.mark.parametrize(("angles", "supports"), [(FRAMES[1], "plane"), (FRAMES[2], "free")])
def test_energy_is_constant_through_the_contact(angles, supports):
    curves = linkage(angles, supports=supports).simulate(5.0, np.linspace(0.0, 0.5, 51))
    assert len(curves["closings"]) >= 1
    assert len(curves["openings"]) >= 1
    scale = curves["energy"][0]
    assert np.abs(curves["energy"] - scale).max() < 1e-9 * scale
    assert curves["kinetic"].max() > 0.5 * scale  # it did move


def test_small_motion_about_closure_has_the_closed_form_periods():
    """Released a little open: a quarter period of the springs, then a half sine of the contact."""
    rigid = linkage()
    motion = rigid.motion(rigid.beta_deployed)
    per_stiffness = sum(
        2.0 * length * motion[name][1] ** 2
        for name, length in (
            ("opening_a", rigid.hinge_length_a),
            ("opening_b", rigid.hinge_length_b),
        )
    )

    def half_period(stiffness):
        return math.pi * math.sqrt(rigid.inertia(motion)[0] / (stiffness * per_stiffness))

    folded = math.degrees(rigid.folded_opening_b)
    curves = rigid.simulate(folded - 1e-3, np.array([0.0, 0.4]))
    closing, parting = curves["closings"][0], curves["openings"][0]
    assert closing == pytest.approx(0.5 * half_period(rigid.spring_stiffness), rel=1e-4)
    both = rigid.spring_stiffness + rigid.contact_stiffness
    assert parting - closing == pytest.approx(half_period(both), rel=1e-4)
