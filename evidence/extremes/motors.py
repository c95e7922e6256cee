"""Extremes of loops, motors and releases: stiff, soft, slow, light bodies, releases at once.

All cases are scenes of the same kinds, five bodies on hinges of their own, of which one or two do
something. They run at 0.9 of the stable step (releases at 0.03), or at a millisecond where that is
shorter."""

from dataclasses import replace
from functools import partial

import numpy as np

import fpm
from evidence.extremes.attempts import must_refuse
from evidence.extremes.true_limit import disturb, true_limit
from evidence.rows import Row, at_most, refusal
from fpm.elements import Motor, Release, SyncLoop, TorqueMotor

INERTIA = 0.5  # kg m²
TURN = 1e-3
"""Allowed error of an opening, as a share of its turn."""


def bodies(
    inertias=(INERTIA,) * 5, loop=0.0, torque=0.0, no_load=np.inf, torque_body=3, motor=(0.0, 0.0),
    release=(0.0, 0.0, 1.0), spin=0.0, preload=np.inf,
) -> fpm.Scene:  # fmt: skip
    """A loop (N/m) over bodies 0 and 1, a motor (N m/rad, N m s/rad) on 2, a torque motor (N m,
    rad/s) on `torque_body`, a release (N m/rad, rad, s) on 4; body 3 starts with a spin (rad/s)."""
    scene = fpm.Scene("bodies on hinges")
    ground = int(scene.add_particles((0.0, 0, 0), 1.0, 1.0)[0])
    scene.fix(ground)
    for k, inertia in enumerate(inertias):
        vector = (0.0, 0.0, spin if k == 3 else 0.0)
        body = int(scene.add_particles((0.0, k, 0), 1.0, inertia, spin=vector)[0])
        scene.add_hinge(f"H{k}", (ground, body), (0, k, 0), (0, 0, 1))
    ramp = scene.add_curve([0.0, 1.0], [0.0, 1.0])
    scene.add(SyncLoop("belt", (0, 1), (0.1, 0.2), loop, preload=preload))
    scene.add(Motor(2, *motor, 0.0, 2.0, ramp))
    scene.add(TorqueMotor(torque_body, torque, no_load=no_load))
    scene.add(Release(4, release[0], 0.0, release[1], release[2]))
    return scene


def run(scene: fpm.Scene, duration: float = 1.0, share: float = 0.9) -> fpm.Outcome:
    """A run at a share of the stable step; a millisecond at most."""
    step = min(share * fpm.find_stable_step(scene).step, 1e-3)
    (outcome,) = fpm.simulate(scene, duration=duration, instants=101, step=step)
    if outcome.failure is not None:
        raise outcome.failure
    return outcome


def _judge(name, scene, hinge, exact, duration=1.0, allowed=TURN) -> Row:
    """An opening all along a run against `exact` (of time), as a share of its turn."""
    try:
        outcome = run(scene, duration)
    except fpm.InstabilityError as error:
        return refusal(name, error)
    turn = exact(outcome.time)
    error = float(np.abs(outcome.openings[hinge] - turn).max() / np.abs(turn).max())
    imbalance = np.abs(outcome.energies["balance"]).max() / outcome.energies["kinetic"].max()
    note = f"energy {imbalance:.1g} of the kinetic, {outcome.steps} steps"
    return at_most(name, error, allowed, "closed form", note)


def loops() -> list[Row]:
    """Two bodies that a torque on one of them turns together."""
    cases = [(k, INERTIA) for k in (1e4, 1e6, 1e8, 1e10)]
    rows = []
    for stiffness, inertia in [*cases, (1e6, 1e-6), (1e10, 1e3)]:
        total = INERTIA + inertia / 4
        # Before the loop has a steady pull, its bodies swing about it: by the slip over the radius.
        stretch = inertia / 4 / total / (0.1**2 * stiffness)
        scene = bodies((INERTIA, inertia, *[INERTIA] * 3), stiffness, torque=1.0, torque_body=0)
        name = f"loop of {stiffness:g} N/m to a body of {inertia:g} kg m²: turned by a torque"
        exact = lambda t, total=total: t * t / 2 / total  # noqa: E731
        turn = exact(1.0)
        rows.append(_judge(name, scene, "H0", exact, allowed=TURN + 2 * stretch / turn))
    scene = bodies(loop=1e6, torque=1.0, torque_body=0, preload=0.0)
    exact = lambda t: t * t / 2 / (1.25 * INERTIA)  # noqa: E731
    rows.append(_judge("loop without preload, 1e6 N/m: turned by a torque", scene, "H0", exact))
    return rows


def motors() -> list[Row]:
    """Motors that turn a body by 2 rad at an even rate."""
    rows = []
    cases = [(1e5, 0.0, INERTIA), (1e9, 0.0, INERTIA), (1e12, 0.0, INERTIA), (1e5, 1e3, INERTIA),
             (1e5, 1e5, INERTIA), (1e5, 0.0, 1e-6), (0.0, 1e3, INERTIA)]  # fmt: skip
    for stiffness, damping, inertia in cases:
        inertias = [INERTIA] * 2 + [inertia] + [INERTIA] * 2
        scene = bodies(inertias, motor=(stiffness, damping))
        rate = np.sqrt(stiffness / inertia)
        lag = min(2 / rate if rate else np.inf, 2 * inertia / damping if damping else np.inf)
        name = f"motor of {stiffness:g} N m/rad, {damping:g} N m s/rad, {inertia:g} kg m²: opening"
        duration = 0.1 if max(rate, damping / inertia) > 1e5 else 1.0
        allowed = TURN + lag / (2 * duration)
        rows.append(_judge(name, scene, "H2", lambda t: 2 * t, duration, allowed))
    rows.append(_rest("motor without stiffness and damping: stays (rad)", bodies(), "H2"))
    return rows


def torques() -> list[Row]:
    """Torque motors far below and above their speeds."""
    scene = bodies(torque=1.0, no_load=1e-3)
    name = "torque motor of 1 N m, no load at 1e-3 rad/s: creeps"
    rows = [_judge(name, scene, "H3", lambda t: 1e-3 * t, allowed=0.01)]
    scene = bodies(torque=1.0, no_load=1e6)
    name = "torque motor of 1 N m, no load at 1e6 rad/s: accelerates"
    rows.append(_judge(name, scene, "H3", lambda t: t * t / 2 / INERTIA))
    scene = bodies(torque=1.0, no_load=1.0, spin=5.0)
    rows.append(_judge("faster than without load: coasts", scene, "H3", lambda t: 5.0 * t))
    return rows


def _rest(name: str, scene: fpm.Scene, hinge: str) -> Row:
    motion = float(np.abs(run(scene).openings[hinge]).max())
    return at_most(name, motion, 1e-15, "nothing moves it")


def releases() -> list[Row]:
    """At once, never, and of a very stiff spring.

    Leapfrog's energy of a spring that starts strained lacks (ω h)²/4 of it, and so does the loss.
    """
    rows = []
    for stiffness in (1e-3, 1e3, 1e9):
        scene = bodies(release=(stiffness, 1e-3, 1e-12))
        outcome, energy = run(scene, share=0.03), 0.5 * stiffness * 1e-6
        rate = np.abs(np.diff(outcome.openings["H4"][1:])).max() / 0.01
        name = f"release of {stiffness:g} N m/rad after 1e-12 s"
        swing = 1e-3 * np.sqrt(stiffness / INERTIA)
        rows.append(at_most(f"{name}: rate left, of what the spring gives", float(rate / swing),
                            1e-6, "it was never held"))  # fmt: skip
        error = abs(outcome.energies["joint_loss"][-1] / energy - 1)
        rows.append(at_most(f"{name}: loss", float(error), 1e-3, "k x²/2"))
    outcome = run(bodies(release=(1e6, 0.0, 1e9), torque=1.0, torque_body=4))
    motion = float(np.abs(outcome.openings["H4"]).max())
    rows.append(at_most("release after the run, 1e6 N m/rad: gives (rad)", motion, 2.2e-6, "2 M/k"))
    rows.append(at_most("the same: events", float(len(outcome.events)), 0.0, "none"))
    return rows


def steps() -> list[Row]:
    """The stable step that a loop sets, against the true limit."""
    rows = []
    for inertia in (INERTIA, 1e-4):
        scene = disturb(bodies((INERTIA, inertia, *[INERTIA] * 3), 1e6), 1e-6)
        ratio = float(fpm.find_stable_step(scene).step / true_limit(scene))
        row = at_most(f"loop to a body of {inertia:g} kg m²: stable step over true limit", ratio,
                      1.002, "bisection")  # fmt: skip
        rows.append(replace(row, passed=row.passed and ratio >= 0.95))
    return rows


def refusals() -> list[Row]:
    """Numbers that cannot be."""
    cases = {"loop": (-1.0, np.nan), "torque": (np.inf,), "no_load": (0.0, -1.0),
             "motor": ((np.nan, 0.0), (1.0, -1.0)), "preload": (-1.0,),
             "release": ((-1.0, 0.0, 1.0), (1.0, 0.0, 0.0), (1.0, np.inf, 1.0))}  # fmt: skip
    pairs = [(key, value) for key, values in cases.items() for value in values]
    return [must_refuse(f"{key} = {x}", partial(bodies, **{key: x})) for key, x in pairs]


def study() -> list[Row]:
    return loops() + motors() + torques() + releases() + steps() + refusals()
