"""Extremes of what holds openings exactly: light and heavy bodies, impacts, steps far too long.

Two rods in a chain on a pin, of which the second turns. Nothing is elastic, so that a step is what
is asked for: the turn in one is told."""

import numpy as np

import fpm
from evidence.rows import Row, at_most, refusal
from fpm.elements import RigidFriction, RigidLatch, RigidMotor, RigidRelease

AXIS = np.array([0.0, 0.0, 1.0])
HUGE = 1e6  # rad, where nothing comes, or s
RIGHT = 0.01
"""Allowed error of angles, rates and losses, as a share."""
MAX_MOTION = 1e-12
"""How far (rad) what is held may move."""


def chain(
    masses=(1.0, 1.0),
    rate=1.0,
    latch=HUGE,
    moment=0.0,
    release=1e-9,
    times=(0.0, 1.0),
    turns=(0, 0),
) -> fpm.Scene:
    """Rods of 1 m and masses (kg) along x. The second turns against the first at a rate (rad/s),
    up to a latch (rad), or until friction of a moment (N m) has stopped it; the first is held until
    a time (s). A third rod is on a motor along a curve (s, rad)."""
    scene = fpm.Scene("chain")
    m1, m2 = masses
    places = [(0, 0, 0), (0.5, 0, 0), (1.5, 0, 0), (0.5, 0, 5)]
    inertias = [[m, m / 12, m / 12] for m in (1.0, m1, m2, m1)]
    ground, a, b, c = scene.add_particles(np.array(places, float), [1.0, m1, m2, m1], inertias)
    scene.fix(ground)
    scene.spin[b], scene.velocity[b] = rate * AXIS, (0.0, rate / 2, 0.0)
    scene.add_hinge("root", (ground, a), (0, 0, 0), AXIS)
    scene.add_hinge("knee", (a, b), (1, 0, 0), AXIS)
    scene.add_hinge("third", (ground, c), (0, 0, 5), AXIS)
    scene.add(RigidMotor(2, 0.0, 1.0, scene.add_curve(times, turns)))
    scene.add(RigidRelease(0, time=release))
    scene.add(RigidLatch(1, latch))
    scene.add(RigidFriction(1, moment))
    return scene


def simulate(rows: list[Row], name: str, scene: fpm.Scene, duration: float, step: float):
    """The outcome of a run; None where it was refused, which is a row."""
    instants = min(201, round(duration / step) + 1)
    try:
        (outcome,) = fpm.simulate(scene, duration=duration, instants=instants, step=step)
    except fpm.SceneError as error:  # of masses too far apart
        rows.append(refusal(name, error))
        return None
    if outcome.failure is None:
        return outcome
    rows.append(refusal(name, outcome.failure))
    return None


def impact_rows() -> list[Row]:
    """A rod caught against one that is held, light and heavy; and turning far in a step."""
    rows = []
    cases = [(mass, 1.0, 1e-3) for mass in (1e-9, 1e-3, 1.0, 1e3, 1e9)]
    cases += [(1.0, 1.0, turn) for turn in (1e-2, 1e-1)] + [(1.0, 1e-6, 1e-3), (1.0, 1e6, 1e-3)]
    for mass, rate, turn in cases:
        name = f"rod of {mass:g} kg at {rate:g} rad/s, {turn:g} rad a step"
        scene = chain((1.0, mass), rate, 0.5, release=HUGE)
        if (outcome := simulate(rows, name, scene, 1.0 / rate, turn / rate)) is None:
            continue
        energy = mass * rate**2 / 6
        error = abs(outcome.events[0, 0] * rate / 0.5 - 1)
        rows.append(at_most(f"{name}: catches in time", error, RIGHT, "ψ/w"))
        loss = abs(outcome.energies["joint_loss"][-1] / energy - 1)
        rows.append(at_most(f"{name}: lost", loss, RIGHT, "J w²/2"))
        motion = np.abs(outcome.openings["knee"][outcome.time * rate > 0.75] - 0.5).max()
        rows.append(at_most(f"{name}: is held (rad)", float(motion), MAX_MOTION, "ψ = ψ_c"))
    return rows


def shares() -> list[Row]:
    """Rods of very different masses that become one: rate by momentum about the pin."""
    rows = []
    for masses in ((1.0, 1e-6), (1.0, 1e-3), (1e-3, 1.0), (1e-6, 1.0)):
        name = f"rods of {masses[0]:g} and {masses[1]:g} kg become one"
        if (outcome := simulate(rows, name, chain(masses, 1.0, 0.3), 1.0, 1e-3)) is None:
            continue
        first, second = masses
        momentum = second * (1 / 12 + 0.5 * 1.5)
        total = first / 3 + second * (4 / 12 + 1 + np.cos(0.3))
        is_caught = outcome.time > outcome.events[-1, 0] + 0.01
        root = outcome.openings["root"][is_caught]
        rate = (root[-1] - root[0]) / np.ptp(outcome.time[is_caught])
        rows.append(at_most(f"{name}: rate", float(abs(rate / (momentum / total) - 1)), RIGHT,
                            "momentum about the pin"))  # fmt: skip
        motion = np.abs(outcome.openings["knee"][is_caught] - 0.3).max()
        rows.append(at_most(f"{name}: is held (rad)", float(motion), MAX_MOTION, "ψ = ψ_c"))
    return rows


def friction() -> list[Row]:
    """Friction from next to nothing to what stops a rod within a thousandth of a step."""
    rows = []
    for moment in (1e-9, 1e-3, 0.3, 10.0, 1e3, 1e6):
        name, inertia = f"friction of {moment:g} N m", 1 / 3
        scene = chain(moment=moment, release=HUGE)
        if (outcome := simulate(rows, name, scene, 1.0, 1e-3)) is None:
            continue
        time = outcome.time
        slip_time = np.minimum(time, inertia / moment)
        angle = slip_time - moment / inertia * slip_time**2 / 2
        worst = float(np.abs(outcome.openings["knee"] - angle).max())
        rows.append(at_most(f"{name}: way (rad)", worst, 1e-5, "w t - M t²/(2 J), to the stop"))
        if inertia / moment < 0.9:
            motion = float(np.ptp(outcome.openings["knee"][time > inertia / moment + 5e-3]))
            rows.append(at_most(f"{name}: moves afterwards (rad)", motion, MAX_MOTION, "it sticks"))
    return rows


def motors() -> list[Row]:
    """Light and heavy bodies along a curve that goes 1 rad within twenty steps."""
    rows = []
    for mass in (1e-9, 1.0, 1e9):
        name = f"motor on {mass:g} kg, 1 rad in 20 steps"
        scene = chain((mass, 1.0), 0.0, release=HUGE, times=(0.0, 0.5, 0.52), turns=(0.0, 0.0, 1.0))
        if (outcome := simulate(rows, name, scene, 1.0, 1e-3)) is None:
            continue
        expected = scene.curve(0).value(outcome.time)
        worst = float(np.abs(outcome.openings["third"] - expected).max())
        rows.append(at_most(f"{name}: opening (rad)", worst, MAX_MOTION, "that prescribed"))
        work = float(abs(outcome.energies["motor_work"][-1]) / (mass / 6 * 50.0**2))
        rows.append(at_most(f"{name}: work left", work, RIGHT, "none, of J w²/2: it stands again"))
    return rows


def contradictions() -> list[Row]:
    """Two that hold one opening: at one angle they share the impulse, at two the run is refused."""
    scene = chain(rate=0.0, release=HUGE)
    scene.spin[:], scene.velocity[:] = 0.0, 0.0
    scene.add(RigidMotor(0, 0.0, 0.0, -1))
    rows: list[Row] = []
    name = "release and motor on one hinge: moves (rad)"
    if outcome := simulate(rows, name, scene, 0.1, 1e-3):
        motion = float(np.abs(outcome.openings["root"]).max())
        rows.append(at_most(name, motion, MAX_MOTION, "both hold it"))
    scene = chain(rate=0.0, release=HUGE)
    scene.add(RigidMotor(0, 0.0, 1.0, scene.add_curve((0.0, 0.1), (0.0, 0.1))))
    name = "motor that turns what a release holds"
    if simulate(rows, name, scene, 0.1, 1e-3):
        rows.append(Row(name, "ran", passed=False))
    return rows


def study() -> list[Row]:
    """All rows."""
    parts = impact_rows, shares, friction, motors, contradictions
    return [row for part in parts for row in part()]
