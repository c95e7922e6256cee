"""The Bennett scene: the rigid linkage's numbers in particles, links, hinges and supports."""

import math

import numpy as np
import pytest

from evidence.linkage.rigid import RigidBennett
from evidence.linkage.runs import build

FRAMES = [(45.0, 45.0), (30.0, 60.0), (65.0, 35.0)]  # (lambda, mu) in degrees
EACH_FRAME = pytest.mark.parametrize("angles", FRAMES, ids=lambda a: f"lambda{a[0]:g}-mu{a[1]:g}")


def scene_of(angles=(45.0, 45.0), **parameters):
    return build(roll=angles[0], mu=angles[1], **parameters)


def end_of(scene, beam):
    """World position of a virtual beam's free end."""
    return scene.position[beam.particle] + scene.frame[beam.particle] @ beam.arm


@EACH_FRAME
@pytest.mark.parametrize("start", [0.01, 5.0, 40.0])
def test_hinges_start_closed_up_and_open_by_the_rigid_linkage(angles, start):
    scene = scene_of(angles, start=start, elements=3)
    rigid = RigidBennett(lambda_deg=angles[0], mu_deg=angles[1])
    motion = rigid.motion(rigid.beta_at(rigid.folded_opening_b - math.radians(start)))
    assert [hinge.name for hinge in scene.hinges] == list("ABCD")
    for hinge, other in zip(scene.hinges, "ABAB", strict=True):
        ends = [end_of(scene, beam) for beam in hinge.beams]
        np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-14)
        # C and D are A and B turned by half a turn about z.
        place = motion[other][0] * ([1, 1, 1] if hinge.name == other else [-1, -1, 1])
        np.testing.assert_allclose(ends[0], place, rtol=0, atol=1e-12)
        frames = [scene.frame[p] for p in hinge.particles]
        axes = [frame @ axis for frame, axis in zip(frames, hinge.axes, strict=True)]
        np.testing.assert_allclose(axes[0], axes[1], rtol=0, atol=1e-14)
        # More than half a turn at A and C: the continuous opening, not the principal angle.
        opening = motion[f"opening_{other.lower()}"][0] % (2 * math.pi)
        assert hinge.opening == pytest.approx(opening, abs=1e-11)
        point = scene.points[hinge.name]
        np.testing.assert_allclose(end_of(scene, point), ends[0], rtol=0, atol=1e-14)


@EACH_FRAME
def test_stiffnesses_are_per_length_of_hinge_line(angles):
    rigid = RigidBennett(lambda_deg=angles[0], mu_deg=angles[1])
    scene = scene_of(angles, K_F=7.0, K_C=900.0)
    lengths = [rigid.hinge_length_a, rigid.hinge_length_b] * 2
    assert [spring.stiffness for spring in scene.springs] == pytest.approx(7.0 * np.array(lengths))
    assert [contact.stiffness for contact in scene.contacts] == pytest.approx(
        900.0 * np.array(lengths)
    )
    assert [spring.rest for spring in scene.springs] == [0.0] * 4
