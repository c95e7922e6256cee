"""The rigid reference linkage against the closed-form geometry, and its own energy."""

import math

import numpy as np
import pytest

from evidence.linkage.geometry import bennett_geometry
from evidence.linkage.rigid import RigidBennett

# (lambda, mu) in degrees
FRAMES = [(45.0, 45.0), (30.0, 30.0), (30.0, 60.0), (45.0, 22.5), (65.0, 35.0)]
EACH_FRAME = pytest.mark.parametrize("angles", FRAMES, ids=lambda a: f"lambda{a[0]:g}-mu{a[1]:g}")


def linkage(angles=(45.0, 45.0), **changes):
    return RigidBennett(lambda_deg=angles[0], mu_deg=angles[1], **changes)


@EACH_FRAME
def test_two_independent_kinematics_agree(angles):
    """Angle beta of the hinge axis against the opening at B as coordinate of the motion."""
    rigid = linkage(angles)
    geometry = bennett_geometry(rigid.length, rigid.side, *angles)
    assert rigid.folded_opening_b == pytest.approx(geometry.folded_opening_b, abs=1e-13)
    assert rigid.hinge_length_a == pytest.approx(geometry.hinge_length_a, rel=1e-13)
    assert rigid.hinge_length_b == pytest.approx(geometry.hinge_length_b, rel=1e-13)
    assert rigid.axis_a @ rigid.axis_b == pytest.approx(geometry.axis_product, rel=1e-13)
    for psi in np.linspace(-0.1, geometry.folded_opening_b, 23):
        beta = rigid.beta_at(psi)
        motion, pose = rigid.motion(beta), geometry.pose(psi)
        assert beta == pytest.approx(geometry.axis_angles(psi)[0], abs=1e-13)
        assert motion["opening_a"][0] == pytest.approx(pose.opening[0], abs=1e-12)
        for name, found in (("A", pose.point[0]), ("B", pose.point[1])):
            np.testing.assert_allclose(motion[name][0], found, rtol=0, atol=1e-13)
        middle = pose.origin[0] + 0.5 * rigid.length * pose.rotation[0, :, 0]
        np.testing.assert_allclose(motion["centre"][0], middle, rtol=0, atol=1e-13)


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
    """Sum over a fine cloud of material points of all four bars, moved by the closed-form pose."""
    rigid = linkage(angles)
    geometry = bennett_geometry(rigid.length, rigid.side, *angles)
    # Two-point Gauss rules have the bar's mass, centre and second moments exactly.
    gauss = 0.5 / math.sqrt(3.0)
    cloud = np.array(
        [
            ((0.5 + i) * rigid.length, j * rigid.side, k * rigid.side)
            for i in (-gauss, gauss)
            for j in (-gauss, gauss)
            for k in (-gauss, gauss)
        ]
    )
    psi, step = 0.8, 1e-5

    def places(opening):
        pose = geometry.pose(opening)
        return pose.origin[:, None] + cloud @ np.swapaxes(pose.rotation, -1, -2)

    velocity = (places(psi + step) - places(psi - step)) / (2.0 * step)
    by_opening = rigid.mass / 8.0 * np.sum(velocity**2)
    motion = rigid.motion(rigid.beta_at(psi))
    by_beta = rigid.inertia(motion)[0] / motion["opening_b"][1] ** 2
    assert by_beta == pytest.approx(by_opening, rel=1e-8)


@EACH_FRAME
def test_springs_and_contacts_hold_the_energy_of_four_hinges(angles):
    rigid = linkage(angles, spring_stiffness=7.0, contact_stiffness=900.0)
    geometry = bennett_geometry(rigid.length, rigid.side, *angles)
    lengths = np.array([hinge.length for hinge in geometry.hinges()])
    for psi in (-0.1, 0.9):
        opening = geometry.pose(psi).opening
        spring, contact, _ = rigid.potential(rigid.motion(rigid.beta_at(psi)))
        assert spring == pytest.approx(0.5 * 7.0 * lengths @ opening**2)
        assert contact == pytest.approx(0.5 * 900.0 * lengths @ np.minimum(opening, 0.0) ** 2)


@pytest.mark.parametrize(
    ("angles", "supports"), [*((angles, "plane") for angles in FRAMES), (FRAMES[-1], "free")]
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
