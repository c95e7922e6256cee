"""Geometry and closed-form motion of the Bennett frame, square and general."""

import math

import numpy as np
import pytest

from evidence.linkage.geometry import HINGES, LINKS, bennett_geometry
from fpm.errors import SceneError

L, SIDE = 0.45, 0.035
# (lambda, mu) in degrees: the paper's, equal and unequal angles, flat and steep ones.
FRAMES = [(45.0, 45.0), (30.0, 30.0), (30.0, 60.0), (45.0, 22.5), (65.0, 35.0), (20.0, 70.0)]
EACH_FRAME = pytest.mark.parametrize("angles", FRAMES, ids=lambda a: f"lambda{a[0]:g}-mu{a[1]:g}")


def frame(angles=(45.0, 45.0)):
    return bennett_geometry(L, SIDE, *angles)


def openings(geometry):
    """Openings at B from a little inside the contact to beyond the bundle."""
    return np.linspace(-0.2, geometry.folded_opening_b + 0.1, 61)


def attached(pose, geometry, hinge):
    """Ends of both virtual beams and both links' hinge axes, in the world."""
    found = []
    for body, arm, axis in (
        (hinge.body1, hinge.arm1, hinge.axis1),
        (hinge.body2, hinge.arm2, hinge.axis2),
    ):
        i = LINKS.index(body)
        along = 0.0 if hinge.at_start else geometry.length
        local = arm + np.array([along, 0.0, 0.0])
        rotation = pose.rotation[..., i, :, :]
        found.append((pose.origin[..., i, :] + rotation @ local, rotation @ axis))
    return found


def test_square_frame_has_the_papers_angles():
    geometry = frame()
    for omega in (geometry.omega_a, geometry.omega_b):
        assert math.degrees(omega) == pytest.approx(math.degrees(math.atan(math.sqrt(2.0))))
    assert geometry.hinge_length_a == pytest.approx(1.2247448713915890 * SIDE)
    assert geometry.hinge_length_b == pytest.approx(1.2247448713915890 * SIDE)
    assert geometry.axis_product == pytest.approx(1.0 / 3.0)


def test_square_frame_hinge_lines_are_the_edges_of_the_mitre_cuts():
    geometry = frame()
    pose = geometry.pose(0.0)
    corner = L / math.sqrt(2.0)
    edges = {
        "A": [(corner + SIDE, 0.0, 0.0), (corner, 0.0, SIDE / math.sqrt(2.0))],
        "B": [(0.0, corner - SIDE, 0.0), (0.0, corner, SIDE / math.sqrt(2.0))],
    }
    for name, length in (("A", geometry.hinge_length_a), ("B", geometry.hinge_length_b)):
        i = HINGES.index(name)
        # The pose puts point A at z = 0, the edges are counted from the bar's axis.
        middle = pose.point[i] + [0.0, 0.0, 0.5 * SIDE / math.sqrt(2.0)]
        half = 0.5 * length * pose.axis[i]
        np.testing.assert_allclose([middle - half, middle + half], edges[name], atol=1e-15)


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
    psi = np.radians(np.linspace(opening_b - 0.1, opening_b + 0.1, 2001))
    pose = frame().pose(psi)
    a, b, c, d = np.moveaxis(pose.point, 1, 0)
    deviations = [
        np.abs(pose.rotation[:, 0, :, 0] - axis).max(axis=-1) / 1e-3,
        np.abs(np.linalg.norm(b - d, axis=-1) - bd) / 1e-4,
        np.abs(np.linalg.norm(a - c, axis=-1) - ac) / 1e-4,
        np.abs(b[:, 2] - a[:, 2] - height) / 1e-3,
        np.abs(np.degrees(psi) - opening_b) / 0.1,
        np.abs(np.degrees(pose.opening[:, 0]) - opening_a) / 0.1,
    ]
    # Units of the last digit.  Rounding allows 0.5; one row was cut (131.05 printed as 131.0).
    assert np.max(deviations, axis=0).min() < 0.6


@EACH_FRAME
def test_hinges_hold_together_through_the_motion(angles):
    geometry = frame(angles)
    pose = geometry.pose(openings(geometry))
    for i, hinge in enumerate(geometry.hinges()):
        (end1, axis1), (end2, axis2) = attached(pose, geometry, hinge)
        np.testing.assert_allclose(end1, end2, rtol=0, atol=1e-14)
        np.testing.assert_allclose(end1, pose.point[:, i], rtol=0, atol=1e-14)
        np.testing.assert_allclose(axis1, axis2, rtol=0, atol=1e-14)
        np.testing.assert_allclose(axis1, pose.axis[:, i], rtol=0, atol=1e-14)


@EACH_FRAME
def test_link_frames_are_proper_rotations(angles):
    rotation = frame(angles).pose(openings(frame(angles))).rotation
    identity = np.broadcast_to(np.eye(3), rotation.shape)
    np.testing.assert_allclose(rotation @ np.swapaxes(rotation, -1, -2), identity, atol=1e-14)
    np.testing.assert_allclose(np.linalg.det(rotation), 1.0, atol=1e-14)


@EACH_FRAME
def test_opening_turns_body_two_against_body_one_about_the_axis(angles):
    geometry = frame(angles)
    pose = geometry.pose(openings(geometry))
    for i, hinge in enumerate(geometry.hinges()):
        assert hinge.axis1 @ hinge.reference1 == pytest.approx(0.0, abs=1e-15)
        rotation1 = pose.rotation[:, LINKS.index(hinge.body1)]
        rotation2 = pose.rotation[:, LINKS.index(hinge.body2)]
        reference1, reference2 = rotation1 @ hinge.reference1, rotation2 @ hinge.reference2
        axis, psi = pose.axis[:, i], pose.opening[:, i, None]
        turned = np.cos(psi) * reference1 + np.sin(psi) * np.cross(axis, reference1)
        np.testing.assert_allclose(turned, reference2, rtol=0, atol=1e-14)


@EACH_FRAME
def test_openings_grow_together_from_shut_to_the_bundle(angles):
    geometry = frame(angles)
    folded = geometry.folded_opening_b
    psi = np.linspace(0.0, folded, 101)
    pose = geometry.pose(psi)
    assert np.all(np.diff(pose.opening, axis=0) > 0.0)
    np.testing.assert_allclose(pose.opening[0], 0.0, atol=1e-15)
    other = 2.0 * math.acos(-math.sin(geometry.lam) * math.sin(geometry.mu))  # more than pi
    np.testing.assert_allclose(pose.opening[-1, 0], other, rtol=1e-14)
    # Bundle: all bars along z, two by two, opposite hinges one section side apart.
    np.testing.assert_allclose(pose.rotation[-1, :, :, 0], [[0, 0, 1]] * 4, atol=1e-14)
    point = pose.point[-1]
    assert np.linalg.norm(point[1] - point[3]) == pytest.approx(SIDE)
    assert np.linalg.norm(point[0] - point[2]) == pytest.approx(SIDE)


def test_square_frame_folds_at_120_and_240_degrees():
    assert math.degrees(frame().folded_opening_b) == pytest.approx(120.0)
    bundle = frame().pose(frame().folded_opening_b)
    assert math.degrees(bundle.opening[0]) == pytest.approx(240.0)
    assert math.degrees(frame().opening_from_fold(5.0)) == pytest.approx(115.0)


@EACH_FRAME
def test_axes_keep_their_product(angles):
    geometry = frame(angles)
    psi = openings(geometry)
    beta, gamma = geometry.axis_angles(psi)
    pose = geometry.pose(psi)
    np.testing.assert_allclose(np.sin(beta) * np.sin(gamma), geometry.axis_product, atol=1e-15)
    np.testing.assert_allclose(
        np.sum(pose.axis[:, 0] * pose.axis[:, 1], axis=-1), geometry.axis_product, atol=1e-15
    )
    np.testing.assert_allclose(
        pose.axis[:, 0], np.stack([np.cos(gamma), 0 * gamma, np.sin(gamma)], -1), atol=1e-14
    )
    # The rises of the deployed hinge lines, as the docs give them.
    lam, mu = np.radians(angles)
    beta, gamma = geometry.axis_angles(0.0)
    assert math.tan(beta) == pytest.approx(math.sin(mu) / math.tan(lam))
    assert math.tan(math.pi - gamma) == pytest.approx(math.cos(mu) * math.tan(lam))
    assert math.cos(geometry.omega_b) == pytest.approx(math.cos(mu) * math.cos(beta))
    assert math.cos(geometry.omega_a) == pytest.approx(-math.sin(mu) * math.cos(gamma))


def test_square_frame_product_is_one_third():
    beta, gamma = frame().axis_angles(np.linspace(0.0, np.radians(120.0), 7))
    np.testing.assert_allclose(np.sin(beta) * np.sin(gamma), 1.0 / 3.0, atol=1e-15)
    # At beta = 90 degrees gamma is largest: the printed 160.5 degrees.
    assert np.degrees(gamma.max()) == pytest.approx(160.5, abs=0.05)


@EACH_FRAME
def test_bars_stay_in_their_quadrant(angles):
    """A mitred bar that crossed a mirror plane would cut into its neighbour."""
    geometry = frame(angles)
    pose = geometry.pose(np.linspace(0.0, geometry.folded_opening_b, 101))
    corners = []
    for y in (-SIDE / 2, SIDE / 2):
        for z in (-SIDE / 2, SIDE / 2):
            height = np.array([0.0, y, z])
            for start, normal in ((0.0, geometry.face_normal_a), (L, geometry.face_normal_b)):
                corners.append([start - height @ normal / normal[0], y, z])
    corners = np.array(corners)
    world = pose.origin[:, None, 0] + corners @ np.swapaxes(pose.rotation[:, 0], -1, -2)
    assert world[..., :2].min() > -1e-15
    edges = corners[1::2, 0] - corners[::2, 0]
    assert np.ptp(edges) > SIDE  # the ends are mitred
    assert edges.min() == pytest.approx(geometry.shortest_edge)


def test_omega_stands_in_for_mu():
    assert math.degrees(bennett_geometry(L, SIDE, 45.0, omega_deg=54.7).mu) == pytest.approx(
        45.0, abs=0.05
    )
    given = bennett_geometry(L, SIDE, 30.0, mu_deg=60.0)
    found = bennett_geometry(L, SIDE, 30.0, omega_deg=math.degrees(given.omega_b))
    assert found.mu == pytest.approx(given.mu, rel=1e-14)


def test_corners_are_square_unless_told():
    assert bennett_geometry(L, SIDE, 45.0) == frame()
    assert bennett_geometry(L, SIDE, 30.0) == frame((30.0, 45.0))


def test_the_papers_omega_agrees_with_the_square_frame():
    assert bennett_geometry(L, SIDE, 45.0, 45.0, 54.7) == frame()


def test_inconsistent_omega_is_refused_with_the_numbers():
    # Table 1 read with mu = 22.5 degrees as the half corner angle at B.
    with pytest.raises(SceneError) as refusal:
        bennett_geometry(L, SIDE, 45.0, 22.5, 54.7)
    message = str(refusal.value)
    for number in ("omega_deg", "54.7", "30.36", "45", "22.5", "73.68", "44.96"):
        assert number in message
    with pytest.raises(SceneError):
        bennett_geometry(L, SIDE, 45.0, 45.0, 54.8)


@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        ((0.0, SIDE, 45.0, 45.0), "L"),
        ((L, -1.0, 45.0, 45.0), "a"),
        ((L, math.nan, 45.0, 45.0), "a"),
        ((L, SIDE, 90.0, 45.0), "lambda_deg"),
        ((L, SIDE, 45.0, 0.0), "mu_deg"),
        ((L, SIDE, 45.0, None, 90.0), "omega_deg"),
        ((0.049, SIDE, 45.0, 45.0), "L"),  # the square frame needs sqrt(2) a = 0.0495 m
    ],
)
def test_frames_that_cannot_be_are_refused(arguments, key):
    with pytest.raises(SceneError, match=key):
        bennett_geometry(*arguments)


def test_shortest_bar_that_exists_is_accepted():
    assert bennett_geometry(0.0496, SIDE, 45.0, 45.0).shortest_edge > 0.0
