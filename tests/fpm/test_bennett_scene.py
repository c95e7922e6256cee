"""The Bennett scene: the geometry's numbers in particles, links, hinges, springs and supports."""

import math

import numpy as np
import pytest

from deployable.fpm import scenes
from deployable.fpm.errors import SceneError
from deployable.fpm.scenes.bennett_geometry import HINGES, bennett_geometry

FRAMES = [(45.0, 45.0), (30.0, 60.0), (65.0, 35.0)]  # (lambda, mu) in degrees
EACH_FRAME = pytest.mark.parametrize("angles", FRAMES, ids=lambda a: f"lambda{a[0]:g}-mu{a[1]:g}")


build = scenes.get("bennett").build


def scene_of(angles=(45.0, 45.0), **parameters):
    return build(lambda_deg=angles[0], mu_deg=angles[1], **parameters)


def end_of(scene, beam):
    """World position of a virtual beam's free end."""
    return scene.position[beam.particle] + scene.frame[beam.particle] @ beam.arm


@EACH_FRAME
@pytest.mark.parametrize("start_deg", [0.0, 0.01, 5.0, 40.0])
def test_hinges_start_closed_up_and_open_by_the_pose(angles, start_deg):
    scene = scene_of(angles, start_deg=start_deg, elements_per_link=3)
    geometry = bennett_geometry(0.45, 0.035, *angles)
    pose = geometry.pose(geometry.opening_from_fold(start_deg))
    assert [hinge.name for hinge in scene.hinges] == list(HINGES)
    for i, (hinge, local) in enumerate(zip(scene.hinges, geometry.hinges(), strict=True)):
        # The virtual beams are the short arms at the joined ends, in the frames of the links.
        for beam, arm in zip(hinge.beams, (local.arm1, local.arm2), strict=True):
            np.testing.assert_allclose(beam.arm, arm, rtol=0, atol=1e-14)
        ends = [end_of(scene, beam) for beam in hinge.beams]
        np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-14)
        np.testing.assert_allclose(ends[0], pose.point[i], rtol=0, atol=1e-14)
        frames = [scene.frame[p] for p in hinge.particles]
        axes = [frame @ axis for frame, axis in zip(frames, hinge.axes, strict=True)]
        np.testing.assert_allclose(axes[0], axes[1], rtol=0, atol=1e-14)
        # More than half a turn at A and C: the continuous opening, not the principal angle.
        assert hinge.opening == pytest.approx(pose.opening[i], abs=1e-13)
        point = scene.points[hinge.name]
        np.testing.assert_allclose(end_of(scene, point), pose.point[i], rtol=0, atol=1e-14)


def test_links_have_the_bars_mass_and_length():
    scene = scene_of(elements_per_link=5)
    assert scene.mass.sum() == pytest.approx(4 * 800.0 * 0.035**2 * 0.45)
    assert [beams.length.sum() for beams in scene.beams] == pytest.approx([0.45] * 4)
    assert len(scene.elements) == 4 * 5 + 4 + 4
    assert not scene.velocity.any()
    assert not scene.spin.any()


@EACH_FRAME
def test_stiffnesses_are_per_length_of_hinge_line(angles):
    geometry = bennett_geometry(0.45, 0.035, *angles)
    scene = scene_of(angles, K_F=7.0, K_C=900.0)
    lengths = [geometry.hinge_length_a, geometry.hinge_length_b] * 2
    assert [spring.stiffness for spring in scene.springs] == pytest.approx(7.0 * np.array(lengths))
    assert [contact.stiffness for contact in scene.contacts] == pytest.approx(
        900.0 * np.array(lengths)
    )
    assert [spring.rest for spring in scene.springs] == [0.0] * 4


@pytest.mark.parametrize(
    ("supports", "held"),
    [("plane", ["z", "", "z", ""]), ("pinned", ["xyz", "", "", ""]), ("free", ["", "", "", ""])],
)
def test_supports_hold_hinge_points(supports, held):
    scene = scene_of(supports=supports)
    assert [hinge.support for hinge in scene.hinges] == held
    assert not scene.fixed.any()


def test_the_scene_names_its_hinges_and_points():
    kind, scene = scenes.get("bennett"), scene_of()
    assert kind.hinges == tuple(hinge.name for hinge in scene.hinges)
    assert kind.points == tuple(scene.points)


def test_the_defaults_are_the_square_frame():
    explicit = scene_of((45.0, 45.0), omega_deg=54.7)
    np.testing.assert_array_equal(build().position, explicit.position)
    by_omega = build(omega_deg=math.degrees(math.atan(math.sqrt(2.0))))
    np.testing.assert_allclose(by_omega.position, explicit.position, atol=1e-15)


def test_the_linkage_may_start_deployed():
    scene = scene_of(start_deg=120.0)
    np.testing.assert_allclose([hinge.opening for hinge in scene.hinges], 0.0, atol=1e-12)
    assert np.ptp(scene.position[:, 2]) < 1e-12


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"start_deg": 121.0}, ["start_deg", "121", "120"]),
        ({"start_deg": -1.0}, ["start_deg", "-1", ">= 0"]),
        ({"start_deg": math.nan}, ["start_deg", "nan"]),
        ({"start_deg": 110.0, "lambda_deg": 30.0}, ["start_deg", "110", "104.478"]),
        ({"supports": "hung"}, ["supports", "hung", "plane, pinned, free"]),
        ({"omega_deg": 54.7, "mu_deg": 22.5}, ["omega_deg", "54.7", "30.36", "22.5"]),
        ({"a": -0.035}, ["a", "-0.035"]),
        ({"L": 0.04}, ["L", "0.04", "0.0494975"]),
        ({"elements_per_link": 1}, ["elements_per_link", "1", ">= 2"]),
    ],
)
def test_impossible_parameters_are_refused(parameters, words):
    with pytest.raises(SceneError) as refusal:
        build(**parameters)
    for word in words:
        assert word in str(refusal.value)
