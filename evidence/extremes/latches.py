"""Extremes of what acts on openings: stiff latches, hard stops, huge and tiny friction and damping.

A rigid flap on a hinge, or a block on a slide, at the default step; what is refused is tried again
with smaller shares of the stable step, as its message says. Then it is judged by closed forms."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

import fpm
from evidence.extremes.attempts import must_refuse
from evidence.extremes.cables import attempt
from evidence.rows import Row, at_most
from evidence.verification.latches import IDLE, J, flap
from fpm.elements import Damper, Friction, Latch, Stop, TableSpring

RIGHT = 0.01
"""Allowed error of times, rates and angles, as a share."""


class Rig(NamedTuple):
    """What all acts on: scene(*elements, rate) of a body on a hinge or slide, and its units."""

    scene: Callable[..., fpm.Scene]
    unit: str
    force: str


def stiff_latches(rig: Rig) -> list[Row]:
    """Latches that hold a panel of 1 rad/s, from soft to very stiff: the swing is w √(J/k)."""
    rows = []
    for stiffness in (1.0, 1e2, 1e4, 1e6, 1e8):
        scene = rig.scene(Latch(0, 0.5, stiffness), rate=1.0)
        swing = np.sqrt(J / stiffness)
        name = f"latch of {stiffness:g} {rig.force}/{rig.unit}"
        name, outcome = attempt(rows, name, scene, 0.5 + 2 * np.pi * swing * 3)
        if outcome is None:
            continue
        error = float(abs(outcome.events[0, 0] / 0.5 - 1))
        note = f"{outcome.steps} steps"
        rows.append(at_most(f"{name}: catches in time", error, RIGHT, "0.5 s", note))
        energy = outcome.energies["latch"] + outcome.energies["kinetic"]
        worst = float(np.abs(energy / (J / 2) - 1).max())
        rows.append(at_most(f"{name}: keeps energy", worst, RIGHT, "J w²/2", note))
    return rows


def hard_stops(rig: Rig) -> list[Row]:
    """Stops without and with far too much damping."""
    rows = []
    for stiffness in (1.0, 1e3, 1e6, 1e9):
        for ratio in (0.0, 100.0):
            damping = 2 * ratio * np.sqrt(stiffness * J)
            scene = rig.scene(Stop(0, 0.1, "above", stiffness, damping), rate=1.0)
            name = f"stop of {stiffness:g} {rig.force}/{rig.unit}, {ratio:g} of critical damping"
            long = 0.1 + 4 * np.pi * np.sqrt(J / stiffness) * (1 if ratio == 0 else 0.1)
            name, outcome = attempt(rows, name, scene, long)
            if outcome is None:
                continue
            kinetic = float(outcome.energies["kinetic"][-1]) / (J / 2)
            ideal = 1.0 - (ratio > 0)
            rows.append(
                at_most(f"{name}: energy left", abs(kinetic - ideal), RIGHT, f"{ideal:g} of it",
                        f"{outcome.steps} steps")
            )  # fmt: skip
    return rows


def friction(rig: Rig) -> list[Row]:
    """Friction that stops a flap within its bend at once, and friction that is hardly there."""
    rows = []
    for moment in (1e-6, 1.0, 1e3, 1e6):
        exact = J / (2 * moment)
        duration = min(2.0, J / moment + 2.0)
        name = f"friction of {moment:g} {rig.force}"
        name, outcome = attempt(rows, name, rig.scene(Friction(0, moment), rate=1.0), duration)
        if outcome is None:
            continue
        opening = outcome.openings["hinge"]
        if J / moment > duration:
            exact = duration - moment / J * duration**2 / 2
        error = float(abs(opening[-1] - exact))
        rows.append(at_most(f"{name}: is at ({rig.unit})", error, 1.1e-3,
                            "J w²/2M, within its bend", f"{outcome.steps} steps"))  # fmt: skip
    return rows


def dampers(rig: Rig) -> list[Row]:
    """Dampers from one that is hardly there to one that stops the flap in a microsecond."""
    rows = []
    for damping in (1e-6, 1.0, 1e3, 1e6):
        duration = 1.0 if damping < 10 else 100 * J / damping
        name = f"damper of {damping:g} {rig.force} s/{rig.unit}"
        name, outcome = attempt(rows, name, rig.scene(Damper(0, damping), rate=1.0), duration)
        if outcome is None:
            continue
        distance = J / damping * -np.expm1(-damping / J * duration)
        error = float(abs(outcome.openings["hinge"][-1] / distance - 1))
        rows.append(at_most(f"{name}: way", error, RIGHT, "w J/c (1 - exp(-c t/J))",
                            f"{outcome.steps} steps"))  # fmt: skip
    return rows


def tables(rig: Rig) -> list[Row]:
    """Tables with a step that is nearly a jump, and with slopes from flat to very steep."""
    rows = []
    for width in (1.0, 1e-2, 1e-4):
        table = (0.5 - width / 2, 0.5 + width / 2), (0.5, -0.5)
        scene = rig.scene(TableSpring(0, *table))
        name = f"table that turns over in {width:g} {rig.unit}"
        name, outcome = attempt(rows, name, scene, 8.0)
        if outcome is None:
            continue
        total = outcome.energies["table_spring"] + outcome.energies["kinetic"]
        worst = float(np.abs(total / total[0] - 1).max())
        rows.append(at_most(f"{name}: keeps energy", worst, RIGHT, "no loss",
                            f"{outcome.steps} steps"))  # fmt: skip
    return rows


def refusals() -> list[Row]:
    """What cannot be is refused when the scene is built."""
    wrong = {
        "latch of -1 N m/rad": Latch(0, 0.5, -1.0),
        "latch of infinite stiffness": Latch(0, 0.5, np.inf),
        "stop of infinite damping": Stop(0, 0.5, "above", 1.0, np.inf),
        "friction without bend": Friction(0, 1.0, bristle_deflection=0.0),
        "damper of -1 N m s/rad": Damper(0, -1.0),
        "table with a jump": TableSpring(0, (0.0, 0.5, 0.5, 1.0), (1.0, 1.0, -1.0, -1.0)),
    }
    return [must_refuse(name, partial(flap, element)) for name, element in wrong.items()]


def block(*elements, rate: float = 0.0) -> fpm.Scene:
    """A block on a slide with what a flap has on its hinge, sliding at a rate (m/s)."""
    scene = fpm.Scene("block")
    ground, body = (int(p) for p in scene.add_particles([(0, 0, 0)] * 2, [1.0, J], 1.0))
    scene.fix(ground)
    scene.add_slide("hinge", (ground, body), (0, 0, 0), (1, 0, 0))
    scene.add_torsion_spring(0, 0.0, 0.0)
    elements_by_type = {type(element): element for element in elements}
    for idle in IDLE:
        scene.add(elements_by_type.get(type(idle), idle))
    scene.velocity[body] = (rate, 0.0, 0.0)
    return scene


HINGE, SLIDE = Rig(flap, "rad", "N m"), Rig(block, "m", "N")


def study(rig: Rig = HINGE) -> list[Row]:
    """All rows."""
    parts = (stiff_latches, hard_stops, friction, dampers, tables)
    return [row for part in parts for row in part(rig)] + (refusals() if rig is HINGE else [])
