"""Natural frequencies of bars: bending, axial and torsional, by eigenvalues and from a run; and the
wave that a sudden force sends through one."""

from dataclasses import replace

import numpy as np

import fpm
from evidence.verification.bench import Bench, observed_orders
from evidence.verification.relax import frequencies, mode_shape
from fpm.elements import BarDamping

LENGTH, MATERIAL = 1.0, fpm.Material(1e9, 0.25, 1000.0)
SECTION = fpm.Section.square(0.004)  # slender: rotary inertia changes no bending frequency by 1e-4
THICK = fpm.Section.square(0.1)  # so that damping of low modes leaves the step long
THIN = fpm.Section.square(0.001)  # and here by 1e-5
ROOTS = {
    "cantilever": (1.87510407, 4.69409113),
    "free-free": (4.73004074, 7.85320462),
    "pinned": (np.pi, 2 * np.pi),
}
"""β L of the first two bending modes; Blevins, Formulas for Natural Frequency and Mode Shape."""


def bar(elements: int, support: str, section=SECTION) -> fpm.Scene:
    """A bar along x: "cantilever", "free-free", "pinned" (bending about y only), or of which only
    the axial ("axial") or torsional ("torsion") motion is free, clamped at x = 0."""
    scene = fpm.Scene(support)
    ends = (0, 0, 0), (LENGTH, 0, 0)
    particles = scene.add_link(*ends, (0, 0, 1), section, MATERIAL, elements).particles
    if support == "cantilever":
        scene.fix(particles[0])
    if support in ("cantilever", "free-free", "pinned"):
        scene.fix(particles, "y", "xz")  # one bending plane
    if support == "pinned":
        scene.fix(particles[0], "xyz", "xz")
        scene.fix(particles[-1], "z", "xz")
    if support == "axial":
        scene.fix(particles, "yz", "xyz")
        scene.fix(particles[0])
    if support == "torsion":
        scene.fix(particles, "xyz", "yz")
        scene.fix(particles[0])
    return scene


def references(support: str, section=SECTION) -> np.ndarray:
    """First two angular frequencies (rad/s) of the continuous bar."""
    if support in ROOTS:
        stiffness = MATERIAL.E * section.Iy / (MATERIAL.rho * section.A)
        return np.array(ROOTS[support]) ** 2 / LENGTH**2 * np.sqrt(stiffness)
    stiffness = MATERIAL.E
    if support == "torsion":
        stiffness = MATERIAL.G * SECTION.J / (SECTION.Iy + SECTION.Iz)
    return np.array([0.5, 1.5]) * np.pi / LENGTH * np.sqrt(stiffness / MATERIAL.rho)


def modes(scene: fpm.Scene, support: str) -> np.ndarray:
    """First two angular frequencies (rad/s) above zero of the kind of motion of `support`."""
    values = frequencies(scene)
    values = values[values > 1e-6 * values[-1]]
    if support in ROOTS:  # axial ones are in the same plane, far above
        values = values[values < 0.9 * references("axial")[0]]
    return values[:2]


def eigenvalues(bench: Bench) -> None:
    """Frequencies of the scene, linearised: error at 10 elements and order of convergence."""
    meshes = (5, 10, 20) if bench.quick else (5, 10, 20, 40)
    sources = {
        **dict.fromkeys(ROOTS, "Euler-Bernoulli, Blevins 1979, table 8-1"),
        "axial": "(n − 1/2) π √(E/ρ) / L",
        "torsion": "(n − 1/2) π √(GJ / ρ Ip) / L",
    }
    for support, source in sources.items():
        with bench.time_solver():
            frequencies = np.array([modes(bar(n, support, THIN), support) for n in meshes])
        expected = references(support, THIN)
        errors = np.abs(frequencies / expected - 1)
        for mode, tolerance in ((0, 0.005), (1, 0.02)):
            bench.check(
                f"{support}, mode {mode + 1}, 10 elements (rad/s)", frequencies[1, mode],
                expected[mode], tolerance, source,
            )  # fmt: skip
        # The finest mesh would show the rotary inertia instead of the mesh.
        orders = observed_orders(errors[:, 0])
        bench.check_at_least(f"{support}, order of mode 1, 5 to 20 elements", orders[:2].min(), 1.9,
                             "order 2 (or better) of lumped masses")  # fmt: skip


def check_modal_damping(bench: Bench) -> None:
    """Modes of thick bars that are damped in proportion to stiffness, each as an oscillator with
    the share z = beta w/2 of critical damping: exp(-z w t) sin(w' t)/w', w' = w sqrt(1 - z²)."""
    share, source = 0.05, "Rayleigh: z = beta w/2 for every mode"
    for support, mode in (("cantilever", 0), ("cantilever", 1), ("axial", 0)):
        scene = bar(5, support, THICK)
        linear = modes(scene, support)[mode]
        shape = 1e-5 * linear * mode_shape(scene, linear)
        scene.velocity += shape[:, :3]
        scene.spin += shape[:, 3:]
        scene.add_point("end", int(scene.beams[0].nodes[-1, 1]))
        material = replace(MATERIAL, stiffness_damping=2 * share / linear)
        scene.beams[:] = [replace(beams, material=material) for beams in scene.beams]
        last, interval = np.sqrt(1 - share**2) * linear, 0.1 / linear
        step = interval / np.ceil(interval / (0.5 * fpm.find_stable_step(scene).step))
        errors = []
        for part in (1, 2, 4):
            (outcome,) = bench.simulate(scene, duration=6 / linear, instants=61, step=step / part)
            exact = np.exp(-share * linear * outcome.time) * np.sin(last * outcome.time) / last
            place = outcome.points["end"][0]
            displacement = (place - place[0]) @ shape[-1, :3] / (shape[-1, :3] @ shape[-1, :3])
            errors.append(np.abs(displacement - exact).max() / exact.max())
        name = f"{support}, mode {mode + 1}"
        bench.check_small(f"{name}, largest error of the way", errors[-1], 3e-4, source, "the way")
    order = observed_orders(np.array(errors)).min()
    bench.check_at_least("axial, order in the step", order, 1.95, source)


def check_sudden_pull(bench: Bench) -> None:
    """A bar that a force F pulls at its end from t = 0 on, with bulk viscosity: a wave of F/A,
    twice that where it meets the clamp, and an end that moves to 2 F L/(E A) and back (d'Alembert).
    """
    elements, force = 40, 1.0
    duration = LENGTH / np.sqrt(MATERIAL.E / MATERIAL.rho)
    for share in (0.0, 0.2):
        scene = bar(elements, "axial")
        end = int(scene.beams[0].nodes[-1, 1])
        scene.add_load(end, force=(force, 0.0, 0.0))
        scene.add_point("end", end)
        scene.add(BarDamping(share))
        record = [("stress", "all")]
        (outcome,) = bench.simulate(scene, duration=4 * duration, instants=801, record=record)
        stress = outcome.columns[record[0]] / (force / SECTION.A)
    bench.check("largest stress (F/A)", stress.max(), 2.0, 0.02, "d'Alembert")
    is_middle = (outcome.time > 0.5 * duration) & (outcome.time < 0.9 * duration)
    bench.check("stress of the first wave (F/A)", stress[is_middle].max(), 1.0, 0.05, "d'Alembert")
    displacement = outcome.points["end"][0][:, 0] - LENGTH
    bench.check("largest way of the end (m)", displacement.max(),
                2 * force * LENGTH / (MATERIAL.E * SECTION.A), 0.05, "2 F L/(E A)")  # fmt: skip


PROBLEMS = {
    "frequencies": eigenvalues,
    "pulled at once": check_sudden_pull,
    "damped in proportion to stiffness": check_modal_damping,
}
