"""Which responses tell of forces that mesh and step alone decide, since nothing softens a shock.

Two cases: a latch that holds exactly stops its joint within one step, and what is applied at once
runs through elastic bars as a wave whose front is a few elements long, whatever their length."""

import numpy as np

from fpm.elements.bars.bar_damping import BarDamping
from fpm.elements.openings.latch import Latch
from fpm.elements.particles.load import Load
from fpm.reading.responses import KINDS, Response
from fpm.scenes.scene import Scene

_CONSTRAINTS = ("sum", "latch", "motor", "release")
"""Parts of the moment on a joint by which it may be held, which bear what the motion asks for; all
others follow from openings and their rates."""

USUAL_SHARE = 0.06
"""Share of critical damping of an element that explicit codes take as bulk viscosity, and above."""


def warn(scene: Scene, response: Response) -> str:
    """Return a warning, with the remedy, that peaks of a response do not converge as mesh and step
    are refined in a scene, since a latch or a sudden load gives a shock; "" where they do."""
    has_shock = KINDS[response.kind].shock
    if response.kind in ("joint_moment", "joint_power"):
        has_shock = response.subjects[1] in _CONSTRAINTS
    if not has_shock:
        return ""
    if latches := [latch.label(scene) for latch in Latch.find(scene) if latch.is_exact]:
        return (
            f"{_join(latches)} without `stiffness` stops the joint within one step, an impact "
            "as large as mesh and step make it: state the `stiffness` of the latch, or of what "
            "bears it"
        )
    starts = any(
        scene.curve(load.curve).value(0.0) * max(np.abs([*load.force, *load.moment]))
        for load in Load.find(scene)
    )
    dampings = [  # shares of critical damping, as those of viscosities
        beams.material.stiffness_damping * np.sqrt(beams.material.E / beams.material.rho) / length
        for beams in scene.beams
        for length in beams.length
    ]
    is_damped = BarDamping.viscosity(scene) > 0 or min(dampings, default=0.0) >= USUAL_SHARE
    if scene.beams and starts and not is_damped:
        return (
            "a load begins at once, and the wave that it sends through the bars rings in the last "
            "mode of the mesh, a quarter too high and more the finer it is: state "
            "`viscosity: 0.2`, or let the load rise over a few times that a wave takes through a "
            "bar, by a `curve`"
        )
    return ""


def _join(latches: list[str]) -> str:
    """`latch a`, `latches a and b`, `latches a, b and 4 more`."""
    if len(latches) == 1:
        return f"latch {latches[0]}"
    names = latches if len(latches) == 2 else [", ".join(latches[:2]), f"{len(latches) - 2} more"]
    return f"latches {' and '.join(names)}"
