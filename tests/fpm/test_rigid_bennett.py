"""The rigid reference linkage against published states, and its own energy."""

import math

import numpy as np
import pytest

from evidence.linkage.rigid import RigidBennett

# (lambda, mu) in degrees
FRAMES = [(45.0, 45.0), (30.0, 30.0), (30.0, 60.0), (45.0, 22.5), (65.0, 35.0)]


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


def test_unknown_supports_are_refused():
    with pytest.raises(ValueError, match="pinned"):
        RigidBennett(supports="pinned")
