"""Sections, lumped masses, and what the scene refuses."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fpm
from fpm.elements.bars.beam import end_weights, lump

SQUARE, WOOD = fpm.Section.square(0.035), fpm.Material(1e9, 0.3, 800.0)


def test_torsion_constants_are_those_of_the_handbook():
    # Timoshenko and Goodier, table of § 109: J = 0.1406 a^4 and 0.229 a^3 b for b / a = 2.
    assert pytest.approx(0.1406, abs=5e-5) == fpm.Section.square(1.0).J
    assert pytest.approx(2 * 0.229, abs=1e-3) == fpm.Section.rectangle(2.0, 1.0).J
    assert pytest.approx(np.pi / 32, rel=1e-12) == fpm.Section.circle(0.5).J


@pytest.mark.parametrize("elements", [2, 3, 5, 8, 40])
@pytest.mark.parametrize("scale", [1.0, 1.5])
def test_lumped_link_has_the_bar_s_mass_centre_and_inertia(elements, scale):
    length = 0.45
    if scale > 1 and elements > 20:
        pytest.skip("no positive end mass makes up for so much inertia")
    mass, inertia = lump(length, elements, SQUARE, WOOD, scale)
    x = np.linspace(0, length, elements + 1)
    total = WOOD.rho * SQUARE.A * length
    assert mass.min() > 0
    assert mass.sum() == pytest.approx(total, rel=1e-13)
    assert mass @ x == pytest.approx(total * length / 2, rel=1e-13)
    about = inertia.sum(axis=0)
    about[1:] += mass @ (x - length / 2) ** 2
    section = WOOD.rho * length * np.array([SQUARE.Iy + SQUARE.Iz, SQUARE.Iy, SQUARE.Iz])
    exact = section + total * length**2 / 12 * np.array([0, 1, 1])
    np.testing.assert_allclose(about, exact, rtol=1e-12)


def test_masses_of_a_link_are_gregory_s_weights():
    # Hildebrand § 5.9: end corrections with differences up to the fourth; Simpson's rule.
    ends = np.array([95 / 288, 317 / 240, 23 / 30, 793 / 720, 157 / 160, 1.0])
    np.testing.assert_allclose(end_weights(12)[:6], ends, rtol=1e-14)
    np.testing.assert_allclose(end_weights(2), np.array([1, 4, 1]) / 3, rtol=1e-14)
    x = np.linspace(0, 1, 9)
    for power in range(6):
        assert end_weights(8) @ x**power / 8 == pytest.approx(1 / (power + 1), rel=1e-14)


def test_too_much_inertia_is_refused_with_the_largest_that_goes():
    with pytest.raises(fpm.SceneError, match=r"at most 1\.\d+ for 64 elements"):
        lump(0.45, 64, SQUARE, WOOD, 3.0)


@pytest.mark.parametrize(
    ("build", "text"),
    [
        (lambda: fpm.Material(-1.0, 0.3, 1.0), "Young's modulus E = -1.0"),
        (lambda: fpm.Material(1.0, 0.6, 1.0), "-1 < nu <= 0.5"),
        (lambda: fpm.Section.square(0.0), "positive lengths"),
        (lambda: fpm.Scene(damping=-1.0), "damping = -1.0"),
        (lambda: fpm.Scene().add_particles((0, 0, 0), 0.0, 1.0), "positive values"),
        (lambda: fpm.Scene().add_curve([0.0, 0.0], [1.0, 2.0]), "increasing times"),
    ],
)
def test_numbers_that_mean_nothing_are_refused(build, text):
    with pytest.raises(fpm.SceneError, match=text):
        build()


def test_particles_may_have_any_rotations_for_frames_and_nothing_else():
    places, turned = np.eye(3), Rotation.random(3, random_state=1).as_matrix()
    for frame in (turned[0], turned):
        scene = fpm.Scene()
        scene.add_particles(places, 1.0, 1.0, frame)
        np.testing.assert_array_equal(scene.frame, np.broadcast_to(frame, (3, 3, 3)))
    for wrong in (1.01 * turned, -turned, turned[:, :, [1, 0, 2]], np.ones((3, 3))):
        with pytest.raises(fpm.SceneError, match="right-handed orthonormal"):
            fpm.Scene().add_particles(places, 1.0, 1.0, wrong)
