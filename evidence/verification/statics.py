"""Static problems: small and large deflections of cantilevers, in the plane and in space."""

import numpy as np

import fpm
from evidence.verification.bench import Bench, observed_orders
from evidence.verification.relax import settle
from evidence.verification.rod import clamped_rod


def cantilever(elements, section, material, length=1.0, name="cantilever") -> fpm.Scene:
    """A bar along x, clamped at the origin, section axis z up; its point `tip` is the free end."""
    scene = fpm.Scene(name)
    bar = scene.add_link((0, 0, 0), (length, 0, 0), (0, 0, 1), section, material, elements, name)
    scene.fix(bar.particles[0])
    for i, particle in enumerate(bar.particles):
        scene.add_point(str(i), int(particle))
    scene.add_point("tip", int(bar.particles[-1]))
    return scene


def small_tip_load(bench: Bench) -> None:
    """Cantilever under a small load at its tip: P L^3 / (3 E I), in both bending planes."""
    section, material, length, elements = fpm.Section.rectangle(0.05, 0.03), STEEL, 1.0, 8
    cases = {"about z": (section.Iz, (0, 1, 0)), "about y": (section.Iy, (0, 0, 1))}
    scenes, expected = [], []
    for inertia, direction in cases.values():
        deflection = 1e-4 * length
        load = deflection * 3 * material.E * inertia / length**3
        scene = cantilever(elements, section, material, length)
        scene.add_load(elements, force=load * np.array(direction))
        scenes.append(scene)
        expected.append(deflection * np.array(direction))
    for name, outcome, vector in zip(cases, settle(bench, scenes), expected, strict=True):
        displacement = (outcome.points["tip"][0][-1] - (length, 0, 0)) @ vector
        displacement /= np.linalg.norm(vector)
        bench.check(
            f"tip deflection, bending {name} (m)", displacement, np.linalg.norm(vector), 1e-3,
            "P L³ / (3 E I), Euler-Bernoulli",
        )  # fmt: skip


STEEL = fpm.Material(2.1e11, 0.3, 7850.0)


def roll_up(bench: Bench) -> None:
    """An end moment 2 pi E I / L rolls a cantilever up to a full circle."""
    length, material = 1.0, fpm.Material(1e9, 0.3, 1000.0)
    section = fpm.Section.square(0.02)
    meshes, errors, gaps = (20, 40) if bench.quick else (20, 40, 80), [], []
    for elements in meshes:
        scene = cantilever(elements, section, material, length)
        moment = 2 * np.pi * material.E * section.Iz / length
        scene.add_load(elements, moment=(0, 0, moment))
        (outcome,) = settle(bench, [scene])
        nodes = np.array([outcome.points[str(i)][0][-1, :2] for i in range(elements + 1)])
        turn = 2 * np.pi * np.arange(elements + 1) / elements
        circle = length / (2 * np.pi) * np.column_stack([np.sin(turn), 1 - np.cos(turn)])
        errors.append(np.linalg.norm(nodes - circle, axis=1).max() / length)
        gaps.append(np.linalg.norm(nodes[-1]) / length)
    source = "pure bending: closed circle of circumference L"
    bench.check_small("gap of the closed circle, 40 elements", gaps[1], 0.01, source, "L")
    bench.check_small("worst node off the circle, 40 elements", errors[1], 0.01, source, "L")
    for coarse, fine, order in zip(meshes, meshes[1:], observed_orders(errors), strict=False):
        name, source = f"error ratio from {coarse} to {fine} elements", "order 2 makes 4"
        bench.check_at_least(name, 2.0**order, 3.0, f"at least 3, as required; {source}")


BEND_TIP = np.array([-23.48, -13.50, 53.37])
"""Displacement of the tip of the 45° bend along its first tangent, towards its centre and along the
load: Simo and Vu-Quoc 1986, eight straight elements."""

BEND_SOURCE = "Bathe and Bolourchi, IJNME 14 (1979) 961; Simo and Vu-Quoc, CMAME 58 (1986) 79"
ROD = "Kirchhoff rod by shooting (evidence/verification/rod.py)"


def bend_scene(elements: int, torsion: float) -> fpm.Scene:
    """The 45° bend: straight elements along an arc of radius 100, GJ = `torsion`, tip load 600."""
    section = fpm.Section(A=1.0, Iy=1 / 12, Iz=1 / 12, J=torsion / 5e6)
    scene = fpm.Scene("45 degree bend")
    angles = np.linspace(0, np.pi / 4, elements + 1)
    position = 100 * np.column_stack([np.sin(angles), 1 - np.cos(angles), 0 * angles])
    # Statics only, so any masses do: these spare the step.
    length = 100 * np.pi / 4 / elements
    particles = scene.add_particles(position, length, length * max(1.0, length**2 / 12))
    nodes = np.column_stack([particles[:-1], particles[1:]])
    scene.add_beams(nodes, section, fpm.Material(1e7, 0.0, 1.0), (0, 0, 1), "bend")
    scene.fix(particles[0])
    scene.add_load(particles[-1], force=(0, 0, 600.0))
    scene.add_point("tip", int(particles[-1]))
    return scene


def bend(bench: Bench) -> None:
    """45° bend of Bathe and Bolourchi: bending and torsion at once, in space."""
    # The published numbers take the polar moment 1/6 for the torsion constant (OpenFAST's
    # bd_curved_beam lists GJ = EI = 8.333e5); a real square has 0.1406.
    polar, real = 5e6 / 6, 5e6 * fpm.Section.square(1.0).J
    tips = {}
    meshes = (8, 16) if bench.quick else (8, 16, 32)
    for elements in meshes:
        scenes = [bend_scene(elements, torsion) for torsion in (polar, real)]
        start = scenes[0].position[-1]
        tips[elements] = [o.points["tip"][0][-1] - start for o in settle(bench, scenes)]
    tip = tips[8][0]
    for axis, value, expected in zip("xyz", tip, BEND_TIP, strict=True):
        bench.check(f"tip displacement {axis}, 8 elements (m)", value, expected, 0.02, BEND_SOURCE)
    size = np.linalg.norm(BEND_TIP)
    bench.check("tip displacement, norm (m)", np.linalg.norm(tip), size, 0.01, BEND_SOURCE)
    errors = []
    for case, torsion in enumerate((polar, real)):
        straight = np.array([100 * np.sin(np.pi / 4), 100 - 100 * np.cos(np.pi / 4), 0])
        rod = clamped_rod(
            25 * np.pi, (0, 0, 0.01), 1e7, (torsion, 1e7 / 12, 1e7 / 12), (0, 0, 600)
        )[0] - straight  # fmt: skip
        errors.append([np.linalg.norm(tips[n][case] - rod) / np.linalg.norm(rod) for n in meshes])
        bench.check_small(
            f"tip off the rod's, {meshes[-1]} elements, GJ = {torsion:.4g}", errors[case][-1],
            2e-3, ROD, "tip displacement",
        )  # fmt: skip
    for case in errors:
        order = observed_orders(case)[-1]
        bench.check_at_least("order of convergence", order, 1.8, "order 2 of straight elements")


PRINCETON = np.array(
    [
        (0, 16.06423724, 0.0),
        (15, 16.45825752, 64.35812858),
        (30, 16.65873206, 117.735994),
        (45, 15.18618440, 156.467239),
        (60, 11.57837500, 181.861627),
        (75, 6.248967384, 196.097131),
        (90, 0.0, 200.677707),
    ]
)
"""Roll of the load (degrees), tip along the stiff and along the soft axis (mm): ANSYS beam model of
Obrezkov, Finkelshtein, Matikainen, Nonlinear Dyn. 109 (2022) 31, as kept in Exudyn's tests."""


def princeton(bench: Bench) -> None:
    """Princeton beam: large bending and twist; one load, seven roll angles in lanes."""
    length, material, load = 0.508, fpm.Material(71.7e9, 0.31, 2700.0), 13.345
    section = fpm.Section.rectangle(12.3777e-3, 3.2024e-3)
    elements = 12 if bench.quick else 16
    cases = PRINCETON[::2] if bench.quick else PRINCETON
    scenes = []
    for roll in np.radians(cases[:, 0]):
        scene = cantilever(elements, section, material, length)
        scene.add_load(elements, force=load * np.array([0, np.cos(roll), np.sin(roll)]))
        scenes.append(scene)
    tips = np.array([o.points["tip"][0][-1] for o in settle(bench, scenes)]) * 1e3
    source = "ANSYS beams: Obrezkov et al., Nonlinear Dyn. 109 (2022) 31, in Exudyn's tests"
    G, E = material.G, material.E
    stiffness = np.array([G * section.J, E * section.Iy, E * section.Iz])
    rods = []
    for (roll, *expected), tip in zip(cases, tips, strict=True):
        direction = np.array([0, np.cos(np.radians(roll)), np.sin(np.radians(roll))])
        rod = clamped_rod(length, (0, 0, 0), E * section.A, stiffness, load * direction)
        rods.append(1e3 * rod[0])
        large = max(expected)
        for axis, value, reference in zip("yz", tip[1:], expected, strict=True):
            name = f"tip u_{axis} at {roll:.0f}° (mm)"
            if reference == 0:
                bench.check(name, value, 0.0, 1e-6, source, large, "share of the large component")
            else:
                tolerance = 0.01 if reference == large else 0.03
                bench.check(name, value, reference, tolerance, source)
    rods = np.array(rods)
    errors = np.linalg.norm(tips - rods, axis=1)
    errors /= np.linalg.norm(rods - [length * 1e3, 0, 0], axis=1)
    bench.check_small("worst tip off the rod's", errors.max(), 5e-3, ROD, "tip displacement")


PROBLEMS = {
    "small tip load": small_tip_load,
    "roll-up": roll_up,
    "45° bend": bend,
    "Princeton beam": princeton,
}
