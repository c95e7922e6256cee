"""Forces that are recorded only when asked: in joints, supports, bars and friction."""

import numpy as np

import fpm
from deployable.campaign.config.sections import scene_type
from evidence.verification.bench import Bench
from evidence.verification.joints import ABOUT_HINGE, ARM, MASS, swinging_body
from evidence.verification.relax import settle
from fpm.elements import Friction

AXES = "xyz"


def columns(variable: str, *names: str) -> list[tuple[str, str]]:
    """The components of vectors, to be recorded."""
    return [(variable, f"{name} {axis}") for name in names for axis in AXES]


def vector(outcome: fpm.Outcome, variable: str, name: str) -> np.ndarray:
    """A recorded vector (t, 3)."""
    return np.stack([outcome.columns[variable, f"{name} {axis}"] for axis in AXES], axis=1)


def hinge_force(bench: Bench) -> None:
    """A physical pendulum: the force of its hinge over the swing, and its rate."""
    g, start = 9.81, np.radians(120.0)
    record = [*columns("constraint_force", "O"), ("opening_rate", "O")]
    scenes = swinging_body(start, g)
    (outcome,) = bench.simulate(scenes, duration=4.0, instants=2001, step=1e-3, record=record)
    angle, force = outcome.openings["O"], vector(outcome, "constraint_force", "O")
    square = 2 * MASS * g * ARM * (np.cos(angle) - np.cos(start)) / ABOUT_HINGE
    axial = -(MASS * g * np.cos(angle) + MASS * ARM * square)
    transverse = MASS * g * np.sin(angle) * (1 - MASS * ARM**2 / ABOUT_HINGE)
    radial = np.stack([np.sin(angle), 0 * angle, -np.cos(angle)], axis=1)
    side = np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=1)
    source, weight = "energy, and moments about the hinge", MASS * g
    error = np.abs((force * radial).sum(axis=1) - axial).max()
    bench.check_small("force along the arm", error / weight, 1e-4, source, "m g")
    error = np.abs((force * side).sum(axis=1) - transverse).max()
    bench.check_small("force across it", error / weight, 1e-4, source, "m g")
    rate = outcome.columns["opening_rate", "O"]
    worst = np.abs(rate**2 - square).max() / square.max()
    bench.check_small("square of the rate", worst, 1e-4, "energy", "largest")


def clamped_bar(bench: Bench) -> None:
    """A cantilever under an end load at rest: reaction, section moments, stress."""
    side, height, length = 0.03, 0.02, 0.6
    section, material = fpm.Section.rectangle(side, height), fpm.Material(7e10, 0.33, 2700.0)
    scene = fpm.Scene("cantilever")
    ends, elements = ((0, 0, 0), (length, 0, 0)), 4 if bench.quick else 8
    bar = scene.add_link(*ends, (0, 0, 1), section, material, elements, "bar")
    scene.fix(bar.particles[0])
    force, torque = np.array([500.0, 4.0, -6.0]), 3.0
    scene.add_load(int(bar.particles[-1]), force, (torque, 0, 0))
    scene.add_point("root", int(bar.particles[0]))
    scene.add_point("end", int(bar.particles[-1]))
    record = [
        *columns("reaction_force", "root"),
        *columns("reaction_moment", "root"),
        *(("section_moment", f"bar at 0.5 {c}") for c in ("torsion", "bending_y", "bending_z")),
        ("stress", "bar"),
    ]
    (outcome,) = settle(bench, [scene], record=record)
    middle, end = 0.5 * length, outcome.points["end"][0][-1]
    clamp = np.array([torque, 0.0, 0.0]) + np.cross(end, force)
    reaction = vector(outcome, "reaction_force", "root")[-1]
    moment = vector(outcome, "reaction_moment", "root")[-1]
    error = np.abs(reaction + force).max() / np.linalg.norm(force)
    bench.check_small("reaction", error, 1e-6, "statics", "load")
    error = np.abs(moment + clamp).max() / np.linalg.norm(clamp)
    bench.check_small("moment of the clamp", error, 1e-5, "statics, where the end is", "itself")
    moments = [outcome.columns[column][-1] for column in record if column[0] == "section_moment"]
    # Of small deflections; those of both planes, with what the axial force takes off.
    for name, value, load, second in (
        ("about y", moments[1], -force[2], section.Iy),
        ("about z", moments[2], force[1], section.Iz),
    ):
        stiff = np.sqrt(force[0] / (material.E * second))
        exact = load * np.sinh(stiff * (length - middle)) / (stiff * np.cosh(stiff * length))
        text = f"bending {name} in the middle (N m)"
        bench.check(text, value, exact, 2e-3, "beam-column: Timoshenko")
    bench.check("torsion (N m)", moments[0], torque, 1e-3, "statics")
    y, z = side / 2, height / 2
    corner = force[0] / section.A + abs(clamp[1]) * z / section.Iy + abs(clamp[2]) * y / section.Iz
    top = force[0] / section.A + abs(clamp[1]) * z / section.Iy
    shear = torque / (0.231 * side * height**2)  # 3 : 2
    exact = max(corner, float(np.hypot(top, np.sqrt(3) * shear)))
    source = "σ = N/A + M/W; τ = T/(0.231 b h²), Timoshenko and Goodier § 109; von Mises"
    bench.check("largest stress (Pa)", outcome.columns["stress", "bar"][-1], exact, 5e-3, source)


def balance_of_linkage(bench: Bench) -> None:
    """The Bennett linkage on its supports: reactions make up the change of its momentum."""
    scene = scene_type("bennett").build(elements=2)
    count = len(scene.position)
    for particle in range(count):
        scene.add_point(f"p{particle}", particle)
    names = [f"p{particle}" for particle in range(count)]
    supports = [hinge.name for hinge in scene.hinges if hinge.support]
    record = [*columns("acceleration", *names), *columns("reaction_force", *supports)]
    (outcome,) = bench.simulate(scene, duration=0.4, instants=401, record=record)
    change = sum(
        mass * vector(outcome, "acceleration", name)
        for mass, name in zip(scene.mass, names, strict=True)
    )
    reaction = sum(vector(outcome, "reaction_force", name) for name in supports)
    worst = np.abs(reaction - change).max() / np.abs(reaction).max()
    bench.check_small("reactions less change of momentum", worst, 1e-9, "Newton", "largest")
    ratio = np.abs(reaction[:, :2]).max() / np.abs(reaction).max()
    bench.check_small("reactions across what is held", ratio, 1e-12, "nothing is held", "largest")


def moments_on_hinge(bench: Bench) -> None:
    """A flap on a spring and on dry friction: their moments, and what friction loses."""
    inertia, stiffness, slip = 1 / 3, 0.5, 0.2
    scene = fpm.Scene("flap")
    inertias = [[1.0] * 3, [inertia] * 3]
    ground, flap = (int(p) for p in scene.add_particles([(0, 0, 0)] * 2, 1.0, inertias))
    scene.fix(ground)
    scene.add_hinge("hinge", (ground, flap), (0, 0, 0), (0, 0, 1))
    scene.spin[flap] = (0, 0, 2.0)
    scene.add_torsion_spring(0, stiffness)
    scene.add(Friction(0, slip))
    parts = ("spring", "friction")
    record = [("joint_moment", f"hinge {part}") for part in parts]
    record += [("joint_work", f"hinge {part}") for part in parts]
    (outcome,) = bench.simulate(scene, duration=0.5, instants=501, step=1e-4, record=record)
    opening = outcome.openings["hinge"]
    slides = opening > 2e-3
    spring, friction = (outcome.columns["joint_moment", f"hinge {part}"] for part in parts)
    worst = np.abs(spring + stiffness * opening).max()
    bench.check_small("spring", worst / (stiffness * opening.max()), 1e-12, "-k ψ", "largest")
    worst = np.abs(friction[slides] + slip).max() / slip
    bench.check_small("friction while it slips", worst, 1e-12, "-M", "M")
    loss = -outcome.columns["joint_work", "hinge friction"][slides]
    exact = slip * (opening[slides] - 0.5e-3)  # bent by 1 mrad before it slips
    worst = np.abs(loss - exact).max() / exact.max()
    bench.check_small("work against friction", worst, 1e-3, "M Δψ, less the bristle's", "largest")


PROBLEMS = {
    "force of a pendulum's hinge": hinge_force,
    "forces in a cantilever": clamped_bar,
    "reactions of the Bennett linkage": balance_of_linkage,
    "moments on a hinge": moments_on_hinge,
}
