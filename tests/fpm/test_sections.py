"""Forces in sections, stresses and clearances: from positions alone, against closed forms."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fpm
from fpm.reading import bars, variables

STEEL = fpm.Material(2e11, 0.25, 7800.0)


def cantilever(section: fpm.Section, turned: np.ndarray, elements=3) -> fpm.Scene:
    """A bar of 1 m along x, its height along z, turned as a whole."""
    scene = fpm.Scene("cantilever")
    scene.add_link((0, 0, 0), turned[:, 0], turned[:, 2], section, STEEL, elements, "bar")
    return scene


def bent(scene: fpm.Scene, section, force, moment, turned) -> tuple[np.ndarray, np.ndarray]:
    """Positions (1, n, 3) and frames (1, n, 3, 3) of a cantilever with a force and a moment at its
    end: Euler and Bernoulli's solution for small deflections."""
    x = np.linspace(0, 1, len(scene.position))
    (n, q, p), (t, my, mz) = force, moment  # moments at the end
    z_curve = [STEEL.E * section.Iy, p, -my]
    y_curve = [STEEL.E * section.Iz, q, mz]
    deflections, slopes = [], []
    for stiffness, load, couple in (y_curve, z_curve):
        deflections.append((load * (x**2 / 2 - x**3 / 6) + couple * x**2 / 2) / stiffness)
        slopes.append((load * (x - x**2 / 2) + couple * x) / stiffness)
    # Chords are strained by the force; bending turns them, and so brings their ends nearer.
    chord = np.diff(x) * (1 + n / (STEEL.E * section.A))
    across = np.diff(np.column_stack(deflections), axis=0)
    along = np.concatenate([[0.0], np.cumsum(np.sqrt(chord**2 - (across**2).sum(axis=1)))])
    place = np.column_stack([along, *deflections]) @ turned.T
    twist = t * x / (STEEL.G * section.J)
    turn = Rotation.from_rotvec(np.column_stack([twist, -slopes[1], slopes[0]])).as_matrix()
    return place[None], (turned @ turn)[None]


TURNED = Rotation.from_rotvec([0.4, -1.1, 2.0]).as_matrix()


BENDING = [0.003, -0.2, 0.3], [0.0, -0.07, 0.05]  # what pulls must not bend back
TORSION = [3.0, 0.0, 0.0], [0.04, 0.0, 0.0]


@pytest.mark.parametrize("load", [BENDING, TORSION], ids=["bending", "torsion"])
@pytest.mark.parametrize("turned", [np.eye(3), TURNED], ids=["along x", "turned"])
def test_a_cantilever_bears_its_end_load_in_every_section(turned, load):
    """To 3e-5 of the largest, as sections turn by some 1e-5 rad. Twist and bending are apart, as
    the order of two turns is of that size for the small one."""
    section = fpm.Section.rectangle(0.02, 0.05)
    scene = cantilever(section, turned)
    force, moment = map(np.array, load)
    position, frame = bent(scene, section, force, moment, turned)
    bar = bars.bars_of(scene)["bar"]
    found = bars.sections_of(scene, bar, lambda p: position[:, p], lambda p: frame[:, p])
    for share in (0.0, 0.2, 1 / 3, 0.5, 2 / 3, 1.0):
        here_force, here_moment = bars.at_fraction(bar, found, share)
        arm = np.array([1.0 - share, 0.0, 0.0])
        np.testing.assert_allclose(here_force[0], force, atol=1e-5)
        expected = moment + np.cross(arm, force)
        np.testing.assert_allclose(here_moment[0], expected, atol=1e-5)


def test_torsion_of_rectangles_has_the_stress_of_the_tables():
    """Timoshenko and Goodier, § 109: T/(k b h²) with k = 0.208 (square), 0.246 (2:1), 0.312 (10:1);
    three digits."""
    for ratio, k in ((1, 0.208), (2, 0.246), (10, 0.312)):
        section = fpm.Section.rectangle(0.01 * ratio, 0.01)
        _, at_z = bars.torsion_stresses(section.width, section.height, section.J)
        assert at_z == pytest.approx(1 / (k * 0.01 * ratio * 0.01**2), rel=3e-3)
    square = fpm.Section.square(0.02)
    assert np.ptp(bars.torsion_stresses(0.02, 0.02, square.J)) < 1e-3 / 0.02**3
    # The middle of a short side has less: 0.796 of it at 2:1 (Roark, Formulas for Stress and
    # Strain).
    at_y, at_z = bars.torsion_stresses(0.02, 0.01, fpm.Section.rectangle(0.02, 0.01).J)
    assert at_y / at_z == pytest.approx(0.796, abs=2e-3)


def test_stresses_are_those_of_the_contour():
    force, moment = np.array([100.0, 5.0, 5.0]), np.array([0.0, 3.0, -4.0])
    circle = fpm.Section.circle(0.01)
    bending = 5.0 * 0.01 / circle.Iy
    assert bars.equivalent(circle, force, moment) == pytest.approx(100 / circle.A + bending)
    torsion = np.array([2.0, 0.0, 0.0])
    tube = fpm.Section.tube(0.02, 0.018)
    shear = 2.0 * 0.02 / tube.J
    assert bars.equivalent(tube, 0 * force, torsion) == pytest.approx(np.sqrt(3) * shear)
    box = fpm.Section.rectangle(0.02, 0.04)
    corner = 100 / 8e-4 + 3.0 * 6 / (0.02 * 0.04**2) + 4.0 * 6 / (0.04 * 0.02**2)
    assert bars.equivalent(box, force, moment) == pytest.approx(corner)
    unknown = fpm.Section(box.A, box.Iy, box.Iz, box.J)
    assert bars.equivalent(unknown, force, moment) == pytest.approx(corner)
    # Torsion counts where it acts: much of it governs in the middle of a side.
    much = moment + np.array([100.0, 0, 0])
    at_y, _ = bars.torsion_stresses(0.02, 0.04, box.J)
    side = 100 / 8e-4 + 4.0 * 6 / (0.04 * 0.02**2)
    expected = np.sqrt(side**2 + 3 * (100 * at_y) ** 2)
    assert bars.equivalent(box, force, much) == pytest.approx(expected)


def two_bars(start, end, section=None, elements=2) -> fpm.Scene:
    """A bar from -x to x of 2 m, 20 mm x 40 mm, and another one."""
    scene = fpm.Scene("two")
    box = fpm.Section.rectangle(0.02, 0.04)
    scene.add_link((-1, 0, 0), (1, 0, 0), (0, 0, 1), box, STEEL, elements, "one")
    scene.add_link(start, end, (0, 0, 1), section or box, STEEL, elements, "two")
    return scene


def apart(scene: fpm.Scene) -> float:
    known = bars.bars_of(scene)
    found = variables.find_clearance(
        scene, known["one"], known["two"],
        lambda p: scene.position[None, p], lambda p: scene.frame[None, p],
    )  # fmt: skip
    return float(found[0])


def test_clearances_are_distances_of_surfaces():
    assert apart(two_bars((-1, 0.3, 0), (1, 0.3, 0))) == pytest.approx(0.3 - 0.02)  # widths
    above = two_bars((0.1, -1, 0.5), (0.1, 1, 0.5))
    assert apart(above) == pytest.approx(0.5 - 0.04)  # crossing, height over height
    rod = fpm.Section.circle(0.05)
    assert apart(two_bars((0.1, -1, 0.5), (0.1, 1, 0.5), rod)) == pytest.approx(0.5 - 0.02 - 0.05)
    beyond = two_bars((1.3, 0.4, 0), (2, 0.4, 0), rod)
    way = np.array([0.6, 0.8])  # of the ends, 0.5 m apart
    assert apart(beyond) == pytest.approx(0.5 - 0.05 - 0.01 * way[1])
    assert apart(two_bars((0, 0, 0.01), (0, 1, 0.01))) < 0  # they overlap


def test_the_nearest_points_of_segments_are_those_of_a_search():
    generator = np.random.default_rng(5)
    a, b, c, d = generator.normal(size=(4, 12, 3))
    found = np.linalg.norm(variables.nearest(a, b, c, d), axis=1)
    s, t = np.meshgrid(*[np.linspace(0, 1, 201)] * 2)
    for k in range(12):
        p = a[k] + s[..., None] * (b[k] - a[k])
        q = c[k] + t[..., None] * (d[k] - c[k])
        least = np.linalg.norm(p - q, axis=2).min()
        assert found[k] <= least + 1e-12
        assert least - found[k] < 4e-4 + 8e-5 / max(found[k], 1e-2)
