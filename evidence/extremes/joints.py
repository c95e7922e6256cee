"""Extremes of joints solved together: light on heavy, stiff on soft, long, redundant, flat.

Rods of rigid bodies or bars hang and swing in a plane; each case is judged by the closed form of
its rods. What is refused is tried again with smaller steps, as its message says."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

import fpm
from evidence.extremes import attempts
from evidence.rows import Row, at_most

G = 9.81
WIDE = 0.5  # rad
SMALL = 1e-3  # rad: swings in which the sine is its angle to 2e-7
AXIS = (0.0, -1.0, 0.0)

RIGHT = 1e-3
"""Allowed error of a swing, as a share of it."""

SOFT = 0.01
"""The same of bars that bend."""

MAX_GAP = 1e-9
"""Allowed gap of a joint, as a share of the structure's size."""

STEPS = (1000, 8000, 64000)
"""Steps of the first quarter of a swing that are tried, where nothing else sets the step."""

SIDE = 0.05
"""Side (m) of the rods' square section: bending hardly shows in a swing."""


class Rod(NamedTuple):
    """A rod of a chain: length (m), mass (kg), modulus E (Pa), rigid without one; elements."""

    length: float
    mass: float
    E: float | None = None
    elements: int = 2

    @property
    def inertia(self) -> float:
        """About its centre, across."""
        return self.mass * (self.length**2 + SIDE**2) / 12


def add_rod(scene: fpm.Scene, rod: Rod, start, end) -> tuple[int, int]:
    """Add a rod from start to end (3,); the particles to which its ends belong."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    if rod.E is not None:
        material = fpm.Material(rod.E, 0.3, rod.mass / (rod.length * SIDE**2))
        section = fpm.Section.square(SIDE)
        link = scene.add_link(start, end, (0, 1, 0), section, material, rod.elements)
        return int(link.particles[0]), int(link.particles[-1])
    x = (end - start) / np.linalg.norm(end - start)
    frame = np.column_stack([x, np.cross((0, 1, 0), x), (0, 1, 0)])
    inertia = (rod.mass * SIDE**2 / 6, rod.inertia, rod.inertia)
    body = int(scene.add_particles((start + end) / 2, rod.mass, inertia, frame)[0])
    return body, body


def slowest(rods: Sequence[Rod]) -> tuple[float, np.ndarray]:
    """Angular frequency (rad/s) and shape (n,) of the slowest small swing of rods that hang.

    With the angles of all rods to the vertical: masses by the velocities of the centres, and the
    weights' potential energy."""
    from scipy.linalg import eigh

    lengths, masses = np.array([rod[:2] for rod in rods]).T
    levers = np.tril(np.tile(lengths, (len(rods), 1)), -1) + np.diag(lengths / 2)
    inertia = levers.T @ (masses[:, None] * levers) + np.diag([rod.inertia for rod in rods])
    weight = np.diag(G * masses @ levers)
    squares, shapes = eigh(weight, inertia)
    shape = shapes[:, 0] / np.abs(shapes[:, 0]).max()
    return float(np.sqrt(squares[0])), shape * np.sign(shape[-1])


def chain(rods: Sequence[Rod], size: float = SMALL) -> tuple[fpm.Scene, float]:
    """Rods that hang from the ground, turned by `size` into their slowest swing, and its rate."""
    rate, shape = slowest(rods)
    scene = fpm.Scene("chain", gravity=(0, 0, -G))
    ground = int(scene.add_particles((0, 0, 0), 1.0, 1.0)[0])
    scene.fix(ground)
    previous, place, rotation = ground, np.zeros(3), 0.0
    for number, (rod, angle) in enumerate(zip(rods, size * shape, strict=True)):
        end = place + rod.length * np.array([np.sin(angle), 0, -np.cos(angle)])
        first, last = add_rod(scene, rod, place, end)
        opening = angle - rotation
        scene.add_hinge(f"pin {number}", (previous, first), place, AXIS, opening=opening)
        previous, place, rotation = last, end, angle
    scene.add_point("end", previous, place)
    return scene, rate


def swings(name: str, rods: Sequence[Rod]) -> list[Row]:
    """The end of a chain against the cosine of its slowest swing, for a quarter of it."""
    scene, rate = chain(rods)
    duration = np.pi / 2 / rate
    label, outcome = attempt(rows := [], name, scene, duration)
    if outcome is None:
        return rows
    x = outcome.points["end"][0][:, 0]
    error = np.abs(x - x[0] * np.cos(rate * outcome.time)).max() / abs(x[0])
    size = sum(rod.length for rod in rods)
    note = f"{outcome.steps} steps"
    rows.append(at_most(f"{label}: swing", float(error), RIGHT, "slowest mode of the rods", note))
    rows.append(at_most(f"{label}: gap", widest(outcome) / size, MAX_GAP, "required", note))
    return rows


def attempt(rows: list[Row], name: str, scene: fpm.Scene, duration: float):
    """Name with what helped, and outcome or None, of a run in more and more steps."""
    limit = 0.9 * fpm.find_stable_step(scene).step
    steps = [(", in {steps} steps", min(limit, duration / count)) for count in STEPS]
    options = {"instants": 101, "energy_tolerance": 0.005}
    return attempts.attempt(rows, name, scene, duration, steps, **options)


def widest(outcome: fpm.Outcome) -> float:
    """The largest gap of any joint, m."""
    gaps = [outcome.records[k].values.max() for k in ("joint_gap", "hinge_gap")
             if k in outcome.records]  # fmt: skip
    return float(max(gaps))


def light_and_heavy() -> list[Row]:
    """Two rods, one up to a million times heavier; light rods pull at heavy bars and back.

    What double precision cannot resolve is refused when a run begins (fpm.solver.start)."""
    rows = []
    for top, bottom in ((1, 1), (1, 1e-3), (1, 1e-6), (1e-3, 1), (1e-6, 1)):
        name = f"rod of {bottom:g} kg below one of {top:g} kg"
        rows += swings(name, [Rod(1, top), Rod(1, bottom)])
    for mass in (1e-3, 1e-6):
        name = f"rigid rod of {mass:g} kg below a bar of 0.1 kg, E = 1e9 Pa"
        rows += swings(name, [Rod(1, 0.1, 1e9), Rod(0.5, mass)])
    return rows


def stiff_and_soft() -> list[Row]:
    """Two bars as stiff as nothing is, one of these and a soft one, and two that bend as they fall.

    The last ones have no closed form; they are held against four times as many elements."""
    rows = []
    for top, bottom in ((1e10, 1e10), (1e13, 1e13), (1e13, 1e8), (1e8, 1e13)):
        name = f"bars of E = {top:g} and {bottom:g} Pa"
        rows += swings(name, [Rod(1, 0.1, top), Rod(1, 0.1, bottom)])
    for E in (1e4, 1e5, 1e6):
        name, duration = f"two bars of E = {E:g} Pa", 0.5
        scenes = [chain([Rod(1, 0.1, E, elements)] * 2, WIDE)[0] for elements in (8, 32)]
        label, coarse = attempt(rows, name, scenes[0], duration)
        _, fine = attempt([], name, scenes[1], duration)
        if coarse is None or fine is None:
            continue
        x, finer = (outcome.points["end"][0] for outcome in (coarse, fine))
        error = float(np.abs(x - finer).max() / np.ptp(finer, axis=0).max())
        note = f"gap {widest(coarse):.1g} m"
        rows.append(at_most(f"{label}: motion", error, SOFT, "32 elements for 8", note))
    return rows


def long_chains() -> list[Row]:
    """Chains of up to 300 rods of 1 m and 1 kg."""
    rows = []
    for count in (3, 30, 300):
        rows += swings(f"chain of {count} rods", [Rod(1.0, 1.0)] * count)
    return rows


def parallelogram(cranks: int, angle: float, offset: float = 0.0) -> fpm.Scene:
    """A platform of 1 kg on cranks of 1 m and 1 kg, `angle` (rad) from hanging; all rigid.

    offset (m): by how much the platform's last pin lies beside its crank's end, along the platform.
    """
    scene = fpm.Scene("parallelogram", gravity=(0, 0, -G))
    ground = int(scene.add_particles((0, 0, 0), 1.0, 1.0)[0])
    scene.fix(ground)
    arm = np.array([np.sin(angle), 0, -np.cos(angle)])
    roots = [np.array([x, 0, 0]) for x in np.linspace(0, 2, cranks)]
    platform, _ = add_rod(scene, Rod(2, 1.0), roots[0] + arm, roots[-1] + arm)
    for k, root in enumerate(roots):
        crank, _ = add_rod(scene, Rod(1, 1.0), root, root + arm)
        scene.add_hinge(f"root {k}", (ground, crank), root, AXIS, opening=angle)
        shift = np.array([offset * (k == cranks - 1), 0, 0])
        pins = [root + arm, root + arm + shift]
        scene.add_hinge(f"pin {k}", (crank, platform), pins, AXIS, opening=-angle)
    return scene


def rate2(cranks: int) -> float:
    """g over the length of the simple pendulum that swings as a parallelogram does, 1/s²."""
    return G * (cranks / 2 + 1) / (cranks * (Rod(1, 1.0).inertia + 0.25) + 1)


def pendulum(rate2: float, angle: float, time: np.ndarray) -> np.ndarray:
    """Angles (t,) of a pendulum let go at `angle` (rad): 2 asin(k cd(ω t, k)), k = sin(angle/2)."""
    from scipy.special import ellipj

    k = np.sin(angle / 2)
    _, cn, dn, _ = ellipj(np.sqrt(rate2) * time, k**2)
    return 2 * np.arcsin(k * cn / dn)


def fall(name: str, cranks: int, angle: float, offset: float = 0.0, allowed: float = RIGHT):
    """A parallelogram swings as a pendulum; what contradicts itself is refused."""
    duration = 1.0
    label, outcome = attempt(rows := [], name, parallelogram(cranks, angle, offset), duration)
    if outcome is None:
        return rows
    exact = pendulum(rate2(cranks), angle, outcome.time)
    error = np.abs(outcome.openings["root 0"] - exact).max() / abs(angle)
    note = f"gap {widest(outcome):.1g} m, energy {balance(outcome):.1g}, {outcome.steps} steps"
    return [*rows, at_most(f"{label}: swing", float(error), allowed, "a pendulum's", note)]


def balance(outcome: fpm.Outcome) -> float:
    """The largest imbalance as a share of the largest kinetic energy."""
    energies = outcome.energies
    return float(np.abs(energies["balance"]).max() / energies["kinetic"].max())


def redundant() -> list[Row]:
    """Up to thirty cranks where two do; and three of which one does not quite fit."""
    rows = []
    for cranks in (2, 3, 10, 30):
        rows += fall(f"{cranks} parallel cranks", cranks, np.radians(60))
    for offset in (1e-12, 1e-9, 1e-7, 1e-5, 1e-2):
        rows += fall(f"three cranks, a pin {offset:g} m off", 3, np.radians(60), offset)
    return rows


def flat() -> list[Row]:
    """Cranks that start near the position in which all pins lie on a line, and that go through it.

    There the linkage could go on as a crossed one; its motion decides."""
    rows = []
    for short in (1e-2, 1e-4, 1e-6, 0.0):
        rows += fall(f"two cranks {short:g} rad below flat", 2, np.pi / 2 - short)
    for angle in (0.1, 1.0):
        rows += fall(f"two cranks {angle:g} rad above flat, through it", 2, np.pi / 2 + angle)
    return rows


def far_slides() -> list[Row]:
    """Bodies that slide on a rail, by a hundredth of their size to a thousand times as much."""
    rows = []
    for distance in (0.01, 1.0, 1e3):
        scene = fpm.Scene("slide", gravity=(0, 0, -G))
        ground, body = (int(p) for p in scene.add_particles(np.zeros((2, 3)), 1.0, 0.1))
        scene.fix(ground)
        direction = np.array([0.6, 0, -0.8])
        scene.add_joint("rail", "prismatic", (ground, body), (1, 0, 0), direction)
        scene.add_point("body", body)
        duration = float(np.sqrt(2 * distance / (0.8 * G)))
        label, outcome = attempt(rows, f"slides by {distance:g} m", scene, duration)
        if outcome is None:
            continue
        errors = outcome.points["body"][0] - 0.4 * G * outcome.time[:, None] ** 2 * direction
        error = float(np.abs(errors).max() / distance)
        rows.append(at_most(f"{label}: way", error, 1e-9, "g cos t²/2", f"{outcome.steps} steps"))
    return rows


def study() -> list[Row]:
    """All rows."""
    parts = (light_and_heavy, stiff_and_soft, long_chains, redundant, flat, far_slides)
    return [row for part in parts for row in part()]
