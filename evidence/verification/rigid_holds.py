"""Latches and releases that hold exactly: impacts and swings of rigid rods, an elastic panel."""

import numpy as np
from scipy.special import ellipk

import fpm
from evidence.verification.bench import Bench, observed_orders
from fpm.elements import Latch, Release
from fpm.elements.bars.beam import Material, Section
from fpm.reading.quantity_definitions import parse
from fpm.reading.responses import Response

M, L, G = np.array([2.0, 1.0]), 1.0, 9.81  # kg, m, m/s²
J = M * L**2 / 12  # slender rods
NEGLIGIBLE = 1e-300  # m/s²: weight is there, and does nothing
AXIS = np.array([0.0, 0.0, 1.0])
ROOTS = np.array([1.8751040687, 4.6940911330, 7.8547574382, 10.9955407349, 14.1371683910])
"""Of cos z cosh z = -1: wave numbers of a cantilever, times its length."""


def rods(angles, rates, latch: float, gravity=NEGLIGIBLE, release=1.0) -> fpm.Scene:
    """Two rods in a chain at angles (rad) to x, turning at rates (rad/s); weight along -y.

    A latch at the knee; and a third rod, held along x by a release until a time (s)."""
    scene = fpm.Scene("rods", gravity=(0.0, -gravity, 0.0))
    axes = np.array([[np.cos(a), np.sin(a), 0.0] for a in angles])
    knee, offset = L * axes[0], np.array([0.0, 0.0, 5.0])
    places = [0 * knee, knee / 2, knee + L * axes[1] / 2, offset + np.array([L / 2, 0.0, 0.0])]
    inertias = [[1.0] * 3, *([0.1, j, j] for j in (*J, J[1]))]
    ground, first, second, third = scene.add_particles(places, [1.0, *M, M[1]], inertias)
    scene.fix(ground)
    turn = np.cross(AXIS, axes)
    scene.spin[[first, second]] = np.outer(rates, AXIS)
    scene.velocity[first] = rates[0] * L / 2 * turn[0]
    scene.velocity[second] = rates[0] * L * turn[0] + rates[1] * L / 2 * turn[1]
    scene.add_hinge("root", (ground, first), 0 * knee, AXIS, opening=angles[0])
    scene.add_hinge("knee", (first, second), knee, AXIS, opening=angles[1] - angles[0])
    scene.add_hinge("third", (ground, third), offset, AXIS)
    scene.add(Release(2, time=release))
    scene.add(Latch(1, latch))
    return scene


def masses(knee: float) -> np.ndarray:
    """Mass matrix of the two angles (2, 2), at an opening of the knee."""
    couple = M[1] * L * L / 2 * np.cos(knee)
    diagonal = J + M * L**2 / 4 + [M[1] * L**2, 0.0]
    return np.array([[diagonal[0], couple], [couple, diagonal[1]]])


def just_before(outcome: fpm.Outcome) -> float:
    """The kinetic energy (J) as the first latch catches, as a campaign asks for it."""
    moving = Response("moving", "energy", ("kinetic",), "", "J", "kinetic energy")
    quantities = {"t": {"event": "latches"}, "before": {"value": "moving", "at": "t"}}
    (_, energy), _ = parse(quantities, [moving], outcome.eventful)
    return energy.evaluate(outcome)


def impacts(bench: Bench) -> None:
    """Rods without weight: momentum and energy give the rates at the latch, and those after it."""
    cases = {0.4: (0.3, 1.0), 1.2: (-0.5, 1.5), -0.6: (0.2, -1.0)}
    scenes = [rods((0.0, 0.0), rates, latch) for latch, rates in cases.items()]
    outcomes = bench.simulate(scenes, duration=3.0, instants=3001, step=2e-4)
    for (latch, rates), outcome in zip(cases.items(), outcomes, strict=True):
        name = f"latch at {latch:g} rad"
        momentum = masses(0.0).sum(axis=0) @ rates
        energy = rates @ masses(0.0) @ rates / 2
        outer, total = masses(latch)[1, 1], masses(latch).sum()
        # With the mean w and the rate r of the knee: both (w + r b)² / 2 + r² c / 2 = energy.
        share = masses(latch).sum(axis=0)[1] / total
        rest = outer - share**2 * total
        fast = np.copysign(np.sqrt((2 * energy - momentum**2 / total) / rest), latch)
        records = {k: outcome.records[k].values[-1, 0] for k in ("latch_rate", "latch_impact")}
        bench.check(f"{name}: rate of the knee (rad/s)", records["latch_rate"], fast, 1e-5,
                    "momentum and energy")  # fmt: skip
        bench.check(f"{name}: kinetic energy just before it (J)", just_before(outcome), energy,
                    1e-4, "energy")  # fmt: skip
        is_caught = outcome.time > outcome.events[0, 0] + 0.1
        knee, root = outcome.openings["knee"][is_caught], outcome.openings["root"][is_caught]
        bench.check_small(f"{name}: opening held (rad)", np.abs(knee - latch).max(), 1e-12,
                          "ψ = ψ_c", "1 rad")  # fmt: skip
        slope = (root[-1] - root[0]) / (outcome.time[is_caught][-1] - outcome.time[is_caught][0])
        bench.check(f"{name}: rate of both after it (rad/s)", slope, momentum / total, 1e-6,
                    "momentum")  # fmt: skip
        bench.check(f"{name}: impulse (N m s)", records["latch_impact"], -fast * rest, 1e-3,
                    "-ψ'/(B·M⁻¹B)")  # fmt: skip
        bench.check(f"{name}: lost (J)", outcome.energies["joint_loss"][-1],
                    energy - momentum**2 / (2 * total), 2e-3, "energy")  # fmt: skip


def swings(bench: Bench) -> None:
    """Rods that swing as one pendulum once they are caught; a rod that is let go between steps."""
    times = (0.5, 0.5001234, 0.7319)
    scenes = [rods((-1.4, -1.5), (0.0, 1.0), 0.2, G, release) for release in times]
    outcomes = bench.simulate(scenes, duration=6.0, instants=12001, step=1e-4)
    lever = np.array([M[0] / 2 + M[1], M[1] / 2]) * L
    pull = np.hypot(lever[0] + lever[1] * np.cos(0.2), lever[1] * np.sin(0.2))
    level = -np.pi / 2 - np.arctan2(lever[1] * np.sin(0.2), lever[0] + lever[1] * np.cos(0.2))
    outcome = outcomes[0]
    is_caught = outcome.time > outcome.events[:, 0].min() + 0.01
    time, angle = outcome.time[is_caught], outcome.openings["root"][is_caught] - level
    wide, inertia = np.abs(angle).max(), masses(0.2).sum()
    exact = 4 * np.sqrt(inertia / (G * pull)) * ellipk(np.sin(wide / 2) ** 2)
    ups = np.flatnonzero((angle[:-1] < 0) & (angle[1:] >= 0))
    crossings = time[ups] - angle[ups] * (time[ups + 1] - time[ups]) / (angle[ups + 1] - angle[ups])
    bench.check("period of the rods as one (s)", np.diff(crossings).mean(), exact, 1e-6,
                "4 √(I/(m g d)) K(sin²(A/2))")  # fmt: skip
    worst = np.abs(outcome.energies["balance"]).max() / outcome.energies["kinetic"].max()
    bench.check_small("energy balance", worst, 1e-3, "no loss but the latch's", "most kinetic")
    for release, outcome in zip(times, outcomes, strict=True):
        name, angle = f"let go at {release:g} s", outcome.openings["third"]
        motion = np.abs(angle[outcome.time <= release]).max()
        bench.check_small(f"{name}: held (rad)", motion, 1e-12, "ψ = ψ₀", "1 rad")
        row = int(np.argmax(angle < -np.pi / 2))
        share = (angle[row - 1] + np.pi / 2) / (angle[row - 1] - angle[row])
        instant = outcome.time[row - 1] + share * (outcome.time[1] - outcome.time[0])
        exact = release + np.sqrt(2 * L / (3 * G)) * ellipk(0.5)
        bench.check(f"{name}: hangs at (s)", instant, exact, 1e-6, "t + √(2 l/(3 g)) K(1/2)",
                    measure="absolute")  # fmt: skip


def elastic(bench: Bench) -> None:
    """A turning elastic panel that is caught: it vibrates as a cantilever does.

    Its tip moves by the sum over the modes φ of w φ(l) sin(ω t)/ω ∫x φ/∫φ²."""
    width, height, rate, angle = 0.2, 0.01, 0.5, 0.2  # width along the hinge
    material = Material(E=70e9, nu=0.3, rho=2700.0)
    section = Section.rectangle(height, width)
    stiff, heavy = 70e9 * width * height**3 / 12, 2700 * width * height
    x = np.linspace(0.0, 1.0, 4001)
    first = 2 * np.pi * L**2 / ROOTS[0] ** 2 * np.sqrt(heavy / stiff)
    losses, tips = [], []
    for elements in (8, 16, 32):
        scene = fpm.Scene("panel")
        (ground,) = scene.add_particles((0.0, 0.0, 0.0), 1.0, 1.0)
        scene.fix(ground)
        link = scene.add_link((0, 0, 0), (L, 0, 0), AXIS, section, material, elements)
        scene.velocity[link.particles, 1] = rate * scene.position[link.particles, 0]
        scene.spin[link.particles] = rate * AXIS
        scene.add_hinge("root", (ground, link.particles[0]), (0, 0, 0), AXIS)
        scene.add_point("tip", link.particles[-1])
        scene.add(Latch(0, angle))
        (outcome,) = bench.simulate(scene, duration=angle / rate + first, instants=2001)
        losses.append(outcome.energies["joint_loss"][-1] / outcome.energies["kinetic"][0])
        place = outcome.points["tip"][0]
        tips.append(place[:, 1] * np.cos(angle) - place[:, 0] * np.sin(angle))
    bench.check_small("energy lost with 32 elements", losses[-1], 1e-3, "all is vibration", "all")
    bench.check_at_least("order in the mesh", observed_orders(losses).min(), 0.9, "lumped inertia")
    duration, series = outcome.time - outcome.events[0, 0], np.zeros(len(outcome.time))
    for z in ROOTS:
        ratio = (np.cosh(z) + np.cos(z)) / (np.sinh(z) + np.sin(z))
        mode = np.cosh(z * x) - np.cos(z * x) - ratio * (np.sinh(z * x) - np.sin(z * x))
        share = np.trapezoid(x * mode, x) / np.trapezoid(mode**2, x)
        omega = z**2 / L**2 * np.sqrt(stiff / heavy)
        series += rate * L * share * mode[-1] * np.sin(omega * duration) / omega
    series[duration < 0] = 0.0
    is_caught = duration >= 0
    worst = np.abs(tips[-1] - series)[is_caught].max() / np.abs(series).max()
    bench.check_small("deflection of the tip over a period", worst, 0.01, "modes of a cantilever",
                      "the largest")  # fmt: skip


PROBLEMS = {
    "rods that a rigid latch catches": impacts,
    "rods caught and let go": swings,
    "elastic panel that a rigid latch catches": elastic,
}
