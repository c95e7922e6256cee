"""The rigid reference linkage against published states, and its own energy."""

import math
from itertools import product

import numpy as np
import pytest

from evidence.linkage.rigid import RigidBennett

# (lambda, mu) in degrees
FRAMES = [(45.0, 45.0), (30.0, 30.0), (30.0, 60.0), (45.0, 22.5), (65.0, 35.0)]
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


def test_hinge_lines_and_folded_openings_of_the_square_frame():
    rigid = linkage()
    assert rigid.hinge_length_a == pytest.approx(math.sqrt(1.5) * rigid.side)
    assert rigid.hinge_length_b == pytest.approx(math.sqrt(1.5) * rigid.side)
    assert rigid.axis_a @ rigid.axis_b == pytest.approx(1.0 / 3.0)
    assert math.degrees(rigid.folded_opening_b) == pytest.approx(120.0)


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


@EACH_FRAME
def test_inertia_is_that_of_the_moving_bars(angles):
    """Sum over a cloud of points that has the bar's mass, centre and second moments (Gauss)."""
    rigid = linkage(angles)
    beta, step, gauss = rigid.beta_at(0.8), 1e-5, 0.5 / math.sqrt(3.0)
    across = np.linalg.svd(rigid.axis[None])[2][1:]
    frame = np.array([rigid.length * rigid.axis, *(rigid.side * across)])
    cloud = np.array(list(product((-gauss, gauss), repeat=3))) @ frame

    def places(b):
        motion = rigid.motion(b)
        return motion["centre"][0] + cloud @ motion["rotation"][0].T

    velocity = (places(beta + step) - places(beta - step)) / (2.0 * step)
    exact = 4.0 * rigid.mass / 8.0 * np.sum(velocity**2)
    assert rigid.inertia(rigid.motion(beta))[0] == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize(
    ("angles", "supports"), [(FRAMES[0], "plane"), (FRAMES[2], "plane"), (FRAMES[-1], "free")]
)
def test_energy_is_constant_through_the_contact(angles, supports):
    curves = linkage(angles, supports=supports).simulate(5.0, np.linspace(0.0, 0.5, 51))
    assert len(curves["closings"]) >= 1
    assert len(curves["openings"]) >= 1
    scale = curves["energy"][0]
    assert np.abs(curves["energy"] - scale).max() < 1e-9 * scale
    assert curves["kinetic"].max() > 0.5 * scale  # it did move


@EACH_FRAME
def test_velocity_and_distance_belong_together(angles):
    """Height of B differentiated over time, on the plane supports."""
    step = 1e-5
    times = np.concatenate([[0.0], *(t + step * np.array([-1, 0, 1]) for t in (0.05, 0.15, 0.2))])
    curves = linkage(angles).simulate(5.0, times)
    for i in (2, 5, 8):
        slope = (curves["height"][i + 1] - curves["height"][i - 1]) / (2.0 * step)
        assert curves["velocity_Bz"][i] == pytest.approx(slope, abs=1e-6)


@pytest.mark.slow
def test_paper_linkage_closes_first_near_a_third_of_a_second():
    times = np.linspace(0.0, 1.0, 201)
    closings = {k: linkage(spring_stiffness=k).simulate(5.0, times)["closings"] for k in (4.8, 5.0)}
    assert closings[4.8] == pytest.approx([0.3263, 0.9869], abs=2e-4)
    assert closings[5.0] == pytest.approx([0.3197, 0.9671], abs=2e-4)


def test_closure_time_scales_with_the_springs():
    """Before the contact the springs are the only forces: time goes with 1 / sqrt(K^F)."""
    first = [
        linkage(spring_stiffness=k).simulate(5.0, np.array([0.0, 0.5]))["closings"][0]
        for k in (2.5, 10.0)
    ]
    assert first[0] / first[1] == pytest.approx(2.0, rel=1e-9)


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


def test_unknown_supports_are_refused():
    with pytest.raises(ValueError, match="pinned"):
        RigidBennett(supports="pinned")
