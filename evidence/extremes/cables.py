"""Extremes of cables: stiff and soft, slack and barely tight, light bodies, points that meet.

Each case runs at the default step; if it is refused, the message must name a remedy, which is
tried: shares of the stable step down to 2 %. Then it is judged by a closed form."""

from dataclasses import replace
from functools import partial

import numpy as np

import fpm
from evidence.extremes import attempts
from evidence.extremes.attempts import must_refuse
from evidence.extremes.true_limit import disturb, true_limit
from evidence.rows import Row, at_most, refusal

G = 9.81
TOLERANCE = 0.005
"""Share of the largest energy by which a balance may deviate, as in campaigns."""

SHARES = (0.9, 0.45, 0.2, 0.1, 0.05, 0.02)

PERIOD = 0.01
"""Allowed error of the time from one tightening to the next."""


def hanging_mass(EA: float, mass: float = 1.0, start: float = 0.9, **options) -> fpm.Scene:
    """A mass let go `start` m below the point from which a cable of 1 m hangs."""
    scene = fpm.Scene("hung", gravity=(0, 0, -G))
    top, body = (int(p) for p in scene.add_particles([(0, 0, 0), (0, 0, -start)], [1, mass], 1.0))
    scene.fix(top)
    scene.add_cable("rope", [(top, None), (body, None)], EA, **(options or {"rest": 1.0}))
    scene.add_point("mass", body)
    return scene


def attempt(rows: list[Row], name: str, scene: fpm.Scene, duration: float):
    """Name with what helped, and outcome or None, of a run at shares of the stable step."""
    limit = fpm.find_stable_step(scene).step
    steps = [(f", at {share:g} of the limit", share * limit) for share in SHARES]
    options = {"instants": 201, "energy_tolerance": TOLERANCE}
    return attempts.attempt(rows, name, scene, duration, steps, **options)


def check_bounces() -> list[Row]:
    """Masses that fall 0.1 m into a cable, from soft to very stiff, light and heavy."""
    rows = []
    cases = [(EA, 1.0) for EA in (30.0, 1e3, 1e5, 1e7, 1e9)] + [(1e4, 1e-6), (1e4, 1e3)]
    for EA, mass in cases:
        name = f"cable of EA = {EA:g} N, mass of {mass:g} kg"
        fall, rate = np.sqrt(0.2 / G), np.sqrt(EA / mass)
        contact = 2 / rate * (np.pi - np.arctan(G * fall * rate / G))
        period = 2 * fall + contact
        name, outcome = attempt(rows, name, hanging_mass(EA, mass), 1.5 * period + fall)
        if outcome is None:
            continue
        tight = outcome.events[outcome.events[:, 2] == 0, 0]
        error = abs((tight[1] - tight[0]) / period - 1)
        energy_error = np.abs(outcome.energies["balance"]).max() / (0.1 * mass * G)
        note = f"energy {energy_error:.1g} of m g d, {outcome.steps} steps"
        rows.append(at_most(f"{name}: period", float(error), PERIOD, "closed form", note))
    return rows


def slack() -> list[Row]:
    """Cables that never come tight do nothing; those just tight without tension stay at rest."""
    (outcome,) = fpm.simulate(hanging_mass(1e9, rest=100.0), duration=0.5, instants=11, step=1e-3)
    z = outcome.points["mass"][0][:, 2]
    error = float(np.abs(z + 0.9 + G * outcome.time**2 / 2).max())
    rows = [at_most("slack cable of 100 m: free fall (m)", error, 1e-12, "z = -g t²/2")]
    scene = hanging_mass(1e6, start=1.0, preload=0.0)
    scene.gravity = (0, 0, 0)
    (outcome,) = fpm.simulate(scene, duration=1.0, instants=11)
    motion = float(np.abs(outcome.points["mass"][0][:, 2] + 1.0).max())
    rows.append(at_most("no tension at the start: stays (m)", motion, 1e-15, "nothing moves"))
    rows.append(at_most("the same: events", float(len(outcome.events)), 0.0, "nothing moves"))
    for preload in (G, 1e5):
        scene = hanging_mass(1e6, start=1.0, mass=preload / G, preload=preload)
        (outcome,) = fpm.simulate(scene, duration=1.0, instants=11)
        motion = float(np.abs(outcome.points["mass"][0][:, 2] + 1.0).max())
        name = f"weight of {preload:g} N hung at its tension: stays (m)"
        rows.append(at_most(name, motion, 1e-12, "statics"))
    return rows


def strings() -> list[Row]:
    """A light bead on a tight string: across, only the tension holds it."""
    rows = []
    for strain in (1e-6, 1e-3, 0.1, 0.9):
        scene = fpm.Scene("string")
        places, masses = [(-1.0, 0, 0), (0, 0, 0), (1, 0, 0)], [1.0, 1e-3, 1.0]
        ends = [int(p) for p in scene.add_particles(places, masses, 1.0)]
        scene.fix([ends[0], ends[2]])
        rest = 2 / (1 + strain)
        scene.add_cable("string", [(p, None) for p in ends], 1e4, rest=rest)
        scene.velocity[1, 2] = 1e-4
        scene.add_point("bead", ends[1])
        tension = 1e4 * strain
        period = 2 * np.pi / np.sqrt(2 * tension / 1e-3)
        step = 0.1 * fpm.find_stable_step(scene).step  # at 0.9 the bead turns within two steps
        (outcome,) = fpm.simulate(scene, duration=10 * period, instants=401, step=step)
        z = outcome.points["bead"][0][:, 2]
        error = abs(_period(outcome.time, z) / period - 1)
        name = f"bead on a string strained by {strain:g}: period"
        rows.append(at_most(name, float(error), PERIOD, "2 π √(m l/2 T)", f"{outcome.steps} steps"))
    return rows


def check_friction() -> list[Row]:
    """No friction is what a pulley has; against much, a weight hangs on its own stretch alone."""
    rows, tracks = [], {}
    for friction in (None, 0.0, 100.0):
        scene = fpm.Scene("over a pin", gravity=(0, 0, -G))
        places = [(-1.0, 0, -1.0), (0, 0, 0), (1, 0, -1.0)]
        points = [int(p) for p in scene.add_particles(places, [1.0, 1.0, 2.0], 1.0)]
        scene.fix(points[:2])
        scene.add_cable("rope", [(p, None) for p in points], 1e4, preload=10.0, friction=friction)
        scene.add_point("mass", points[2])
        (outcome,) = fpm.simulate(scene, duration=1.0, instants=101, step=2e-4)
        tracks[friction] = outcome.points["mass"][0]
    error = float(np.abs(tracks[0.0] - tracks[None]).max())
    rows.append(at_most("friction 0: as without (m)", error, 1e-5, "the kernels without friction"))
    scene = fpm.Scene("on its stretch", gravity=(0, 0, -G))
    top, body = (int(p) for p in scene.add_particles([(0, 0, 0), (1, 0, -1.0)], [1.0, 2.0], 1.0))
    scene.fix(top)
    scene.add_cable("rope", [(top, None), (body, None)], 1e4, preload=10.0)
    scene.add_point("mass", body)
    (outcome,) = fpm.simulate(scene, duration=1.0, instants=101, step=2e-4)
    error = float(np.abs(tracks[100.0] - outcome.points["mass"][0]).max())
    rows.append(at_most("friction 100: as if knotted (m)", error, 1e-9, "a cable to the pin"))
    return rows


def _period(time, z) -> float:
    """Period (s) of an oscillation from its sign changes."""
    rows = np.flatnonzero(z[1:] * z[:-1] < 0)
    times = time[rows] - z[rows] * (time[rows + 1] - time[rows]) / (z[rows + 1] - z[rows])
    return 2 * float(np.polyfit(np.arange(len(times)), times, 1)[0])


def refusals() -> list[Row]:
    """Cables that cannot be: refused when the scene is built, or named when they break down."""
    rows = []
    for options in ({"rest": 0.0}, {"rest": float("nan")}, {"preload": -1.0}, {"preload": np.inf}):
        name = ", ".join(f"{k} = {v:g}" for k, v in options.items())
        rows.append(must_refuse(f"cable, {name}", partial(hanging_mass, 1e4, **options)))
    scene = fpm.Scene("meeting", gravity=(0, 0, -1e-3))
    places = [(0.0, 0, 0), (0.9999, 0, 0), (1, 0, 0)]
    points = [int(p) for p in scene.add_particles(places, 1.0, 1.0)]
    scene.fix(points[0])
    scene.add_cable("rope", [(p, None) for p in points], 1e4, preload=100.0)
    (outcome,) = fpm.simulate(scene, duration=0.1, instants=11)
    if outcome.failure is None:
        rows.append(Row("points that meet under tension", "ran", passed=False))
    else:
        rows.append(refusal("points that meet under tension", outcome.failure))
    return rows


def make_cable_bar(EA: float, is_one: bool) -> fpm.Scene:
    """A bar held at both ends by cables in balance, from all sides or running through them."""
    scene = fpm.Scene("held bar")
    section, material = fpm.Section.circle(0.01), fpm.Material(7e10, 0.3, 2700.0)
    bar = scene.add_link((0, 0, 0), (1, 0, 0), (0, 0, 1), section, material, 4)
    offsets = (-0.3, 0.3) if is_one else (0.0,)
    for end in bar.particles[[0, -1]]:
        for k, axis in enumerate(np.eye(3)[1:] if is_one else np.eye(3)):
            for side in (-1.0, 1.0):
                places = [scene.position[end] + side * axis + [x, 0, 0] for x in offsets]
                anchors = scene.add_particles(places, 1.0, 1.0)
                scene.fix(anchors)
                points = [(int(anchors[0]), None), (int(end), None), (int(anchors[-1]), None)]
                name = f"{end} {k} {side:g}"
                scene.add_cable(name, points if is_one else points[:2], EA, preload=1e-6 * EA)
    return disturb(scene, 1e-9)


def steps() -> list[Row]:
    """The stable step is never above the true limit; where cables set it, it may be below."""
    rows = []
    for is_one in (False, True):
        for EA in (1e5, 1e8, 1e9):
            scene = make_cable_bar(EA, is_one)
            stable = fpm.find_stable_step(scene)
            ratio = float(stable.step / true_limit(scene, 1e-3))
            support = "running through its ends" if is_one else "from all sides"
            name = f"bar held by cables {support}, EA = {EA:g} N: stable step over true limit"
            row = at_most(name, ratio, 1.002, "bisection", f"set by {stable.element}")
            rows.append(replace(row, passed=row.passed and ratio >= 0.5))
    return rows


def study() -> list[Row]:
    return check_bounces() + slack() + strings() + check_friction() + steps() + refusals()
