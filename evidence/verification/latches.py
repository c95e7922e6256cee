"""Latches, dampers, friction, stops and springs by tables against closed forms of a rigid flap."""

import numpy as np

import fpm
from evidence.verification.bench import Bench
from evidence.verification.joints import AXIS
from fpm.elements import Damper, Friction, Latch, Stop, TableSpring

J = 1 / 3  # kg m² about the hinge


HUGE = 1e3  # rad, where nothing comes

IDLE = (
    Latch(0, HUGE, 0.0),
    Damper(0, 0.0),
    Friction(0, 0.0),
    Stop(0, HUGE, "above", 0.0),
    TableSpring(0, (0.0, 1.0), (0.0, 0.0)),
)
"""One of each kind that does nothing: all kinds in every scene make one compiled loop."""


def flap(*elements, rate: float = 0.0, spring: tuple[float, float] = (0.0, 0.0)) -> fpm.Scene:
    """A rigid flap on a hinge, with some elements on its opening, turning at a rate (rad/s)."""
    scene = fpm.Scene("flap")
    inertias = [[1.0] * 3, [J] * 3]
    ground, body = (int(p) for p in scene.add_particles([(0, 0, 0)] * 2, 1.0, inertias))
    scene.fix(ground)
    scene.add_hinge("hinge", (ground, body), (0, 0, 0), AXIS)
    scene.add_torsion_spring(0, *spring)
    elements_by_type = {type(element): element for element in elements}
    for idle in IDLE:
        scene.add(elements_by_type.get(type(idle), idle))
    scene.spin[body] = rate * np.asarray(AXIS, float)
    return scene


def latches(bench: Bench) -> None:
    """A panel that a spring opens: t = √(J/k) arccos((ψ - θ)/ψ) to the latch, then a swing."""
    stiffnesses, rest, angle, hold = (0.05, 0.1, 0.2), np.pi, np.pi / 2, 50.0
    scenes = [flap(Latch(0, angle, hold), spring=(k, rest)) for k in stiffnesses]
    scenes.append(flap(Latch(0, angle, hold, max_capture_rate=1.4), spring=(0.1, rest)))
    outcomes = bench.simulate(scenes, duration=4.0, instants=4001, step=2e-4)
    for k, outcome in zip(stiffnesses, outcomes, strict=False):
        name, exact = f"k = {k:g} N m/rad", np.sqrt(J / k) * np.arccos((rest - angle) / rest)
        time, opening = outcome.time, outcome.openings["hinge"]
        bench.check(f"catches at, {name} (s)", outcome.events[0, 0], exact, 1e-6, "closed form",
                    measure="absolute")  # fmt: skip
        fast = np.sqrt(k / J * (rest**2 - (rest - angle) ** 2))
        rate = outcome.records["latch_rate"].values[-1, 0]
        bench.check(f"rate there, {name} (rad/s)", rate, fast, 1e-6, "energy", measure="absolute")
        omega = np.sqrt((hold + k) / J)
        push = k * (rest - angle) / (hold + k)
        swing = angle + push + np.hypot(push, fast / omega)
        bench.check(f"largest opening, {name} (rad)", opening.max(), swing, 1e-5,
                    "θ + p + √(p² + (w/ω)²)")  # fmt: skip
        cycle = exact + 2 * np.pi / omega
        impulse = np.interp(cycle, time, outcome.records["latch_impulse"].values[:, 0])
        reference = -k * (rest - angle - push) * 2 * np.pi / omega
        bench.check(f"impulse over a cycle, {name} (N m s)", impulse, reference, 1e-3,
                    "momentum: minus that of the spring", J * fast, "of J w")  # fmt: skip
        worst = np.abs(outcome.energies["balance"]).max() / (k * rest**2 / 2)
        bench.check_small(f"energy balance, {name}", worst, 1e-5, "no loss", "the spring's energy")
    fly_by = outcomes[-1]
    exact = rest * (1 - np.cos(np.sqrt(0.1 / J) * fly_by.time))
    worst = np.abs(fly_by.openings["hinge"] - exact).max() / rest
    bench.check_small("passed faster than it catches: goes on", worst, 1e-6, "ψ (1 - cos ω t)",
                      "the rest angle")  # fmt: skip


def dampers(bench: Bench) -> None:
    """A flap slowed by a damper: ψ = w J/c (1 - exp(-c t/J)); its energy is lost."""
    dampings = (0.1, 0.5, 2.0)
    scenes = [flap(Damper(0, c), rate=1.0) for c in dampings]
    outcomes = bench.simulate(scenes, duration=2.0, instants=201, step=2e-4)
    for c, outcome in zip(dampings, outcomes, strict=True):
        name, exact = f"c = {c:g} N m s/rad", J / c * (1 - np.exp(-c / J * outcome.time))
        worst = np.abs(outcome.openings["hinge"] - exact).max() / exact[-1]
        bench.check_small(f"opening, {name}", worst, 1e-6, "w J/c (1 - exp(-c t/J))", "the way")
        loss = J / 2 * (1 - np.exp(-2 * c / J * outcome.time[-1]))
        bench.check(f"lost, {name} (J)", outcome.energies["joint_loss"][-1], loss, 1e-6,
                    "J w²/2 (1 - exp(-2 c t/J))")  # fmt: skip


def friction(bench: Bench) -> None:
    """A flap that dry friction stops at J w²/(2 M), and one that a load does not move."""
    moments = (0.05, 0.2, 1.0)
    scenes = [flap(Friction(0, moment), rate=1.0) for moment in moments]
    shares = (0.5, 0.99, 1.1)
    scenes += [flap(Friction(0, 0.2), spring=(1e-9, share * 0.2e9)) for share in shares]
    outcomes = bench.simulate(scenes, duration=12.0, instants=12001, step=2e-4)
    for moment, outcome in zip(moments, outcomes, strict=False):
        name, exact = f"M = {moment:g} N m", J / (2 * moment)
        opening = outcome.openings["hinge"]
        bench.check(f"stops at, {name} (rad)", opening.max(), exact, 1e-5, "J w²/(2 M)")
        bench.check(f"stays at, {name} (rad)", opening[-1], exact - 1e-3, 1e-5,
                    "less the bend of 1 mrad")  # fmt: skip
        motion = np.ptp(opening[-1000:])
        bench.check(f"moves in the last second, {name} (rad)", motion, 0.0, 1e-6, "it sticks",
                    1.0, "absolute")  # fmt: skip
    for share, outcome in zip(shares, outcomes[len(moments) :], strict=True):
        opening = outcome.openings["hinge"]
        if share < 1:
            motion = np.ptp(opening[-1000:])
            bench.check(f"creeps under {share:g} M in a second (rad)", motion, 0.0, 1e-9,
                        "it sticks", 1.0, "absolute")  # fmt: skip
        else:
            mean = float(np.diff(opening[4000::2000], 2).mean()) / 4
            bench.check(f"acceleration under {share:g} M (rad/s²)", mean, (share - 1) * 0.2 / J,
                        1e-4, "(L - M)/J")  # fmt: skip


def stops(bench: Bench) -> None:
    """A flap that hits a stop: time, and the rate with which it comes back."""
    stiffness, ratios = 300.0, (0.0, 0.1, 0.3, 0.6)
    dampings = [2 * ratio * np.sqrt(stiffness * J) for ratio in ratios]
    scenes = [flap(Stop(0, 0.5, "above", stiffness, c), rate=1.0) for c in dampings]
    outcomes = bench.simulate(scenes, duration=1.0, instants=1001, step=1e-4)
    for ratio, outcome in zip(ratios, outcomes, strict=True):
        name, root = f"{ratio:g} of critical", np.sqrt(1 - ratio**2)
        bench.check(f"hit at, {name} (s)", outcome.events[0, 0], 0.5, 1e-8, "free until then")
        opening = outcome.openings["hinge"]
        rebound = -np.polyfit(outcome.time[-100:], opening[-100:], 1)[0]
        # Until its moment is zero: c s' + k s = 0.
        angle = np.pi - np.arctan2(2 * ratio * root, 1 - 2 * ratio**2)
        exact = -np.exp(-ratio * angle / root) * (np.cos(angle) - ratio / root * np.sin(angle))
        bench.check(f"comes back with, {name} (rad/s)", rebound, exact, 1e-4, "damped half swing")
        loss = J / 2 * (1 - exact**2)
        bench.check(f"lost, {name} (J)", outcome.energies["joint_loss"][-1], loss, 1e-4, "energy",
                    J / 2, "of J w²/2")  # fmt: skip


def tables(bench: Bench) -> None:
    """A flap that falls through the table of a tape spring: its energy is that of the table."""
    angles = np.radians([-180, -12, -3, 3, 12, 180])
    moments = (0.2, 0.2, 2.0, -2.0, -0.2, -0.2)
    scene = flap(TableSpring(0, tuple(angles + 1.5), moments))
    (outcome,) = bench.simulate(scene, duration=4.0, instants=8001, step=1e-4)
    opening, kinetic = outcome.openings["hinge"], outcome.energies["kinetic"]
    grid = np.linspace(0.0, 3.0, 30001)
    moment = np.interp(grid - 1.5, angles, moments)
    work = np.concatenate([[0.0], np.cumsum((moment[1:] + moment[:-1]) / 2 * np.diff(grid))])
    worst = np.abs(kinetic - np.interp(opening, grid, work)).max() / work.max()
    bench.check_small("kinetic energy along the way", worst, 1e-5, "integral of the table", "most")
    time = np.sqrt(2 * J * (1.5 - np.radians(12)) / 0.2)
    result = _first(outcome.time, opening, 1.5 - np.radians(12))
    bench.check("enters the peak at (s)", result, time, 1e-6, "√(2 J θ/M)")


def _first(time, values, level) -> float:
    """When values first rise through a level."""
    i = int(np.argmax(values > level))
    share = (level - values[i - 1]) / (values[i] - values[i - 1])
    return float(time[i - 1] + share * (time[i] - time[i - 1]))


PROBLEMS = {
    "panel with a latch": latches,
    "flap on a damper": dampers,
    "flap on dry friction": friction,
    "flap on a stop": stops,
    "flap on a tape spring": tables,
}
