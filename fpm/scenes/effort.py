"""What a run costs: seconds of a core for its steps and instants, from what a scene has.

Costs are those of eight runs side by side, in nanoseconds, as measured where a register holds 256
bits (an AMD EPYC without 512), and right to a factor of two or so; `machine` is what they have to
be multiplied with here. Joints that are solved together are counted out, as it depends on how they
are coupled: twenty joints on one body cost far more than twenty in a chain."""

from __future__ import annotations

from functools import cache

import numpy as np

from fpm.elements import Beams, Cable, Joint, kinds_of
from fpm.elements.kind import ElementType
from fpm.scenes.scene import Scene

STEP = 400.0
"""Cost (ns) of a step, whatever is in it."""

INSTANT = 4000.0
"""Cost (ns) of an instant that is recorded, with the check of the balance."""

PARTICLE, ELEMENT, DAMPED, VISCOUS = 25.0, 105.0, 6.0, 20.0
"""Of a particle, as a rigid body; of a beam element with one of its particles; of the damping of a
particle in proportion to its mass; of the bulk viscosity of a beam element."""

KIND_COSTS: dict[str, float] = {
    "Gravity": 5.0, "Opening": 30.0, "Hinge": 390.0, "TorsionSpring": 70.0, "Contact": 70.0,
    "Load": 100.0, "SyncLoop": 100.0, "Motor": 100.0, "TorqueMotor": 100.0, "Release": 100.0,
    "Latch": 100.0, "Damper": 70.0, "Friction": 100.0, "Stop": 100.0, "TableSpring": 100.0,
    "Drive": 100.0, "Support": 60.0, "Turn": 200.0, "RigidLatch": 100.0, "RigidRelease": 100.0,
    "RigidMotor": 100.0, "RigidFriction": 100.0,
}  # fmt: skip
"""Cost (ns) of an element by its type: hinges solved alone, what acts on an opening."""

DEFAULT_COST = 100.0
"""Cost (ns) of an element of a type that is not among them."""

STRETCH, RUBBING = 60.0, 300.0
"""Of a cable's stretch between two points; the same with friction at its points."""

CONDITION, MULTIPLY_ADD = 240.0, 1.5
"""Of a condition of joints that are solved together, and of each multiply-add of the elimination:
from chains, pairs, and platforms on 2 to 30 cranks."""

PACKING, PER_STATEMENT = 0.4e-3, 0.05e-3
"""Seconds to pack a run and hand it back, and more for each thing that the scene states: a bar, a
hinge, a spring on it."""


COMPILE, COMPILE_KIND, COMPILE_JOINTS = 4.0, 1.0, 4.0
"""Seconds to compile the time loop, more for each kind in it, and for joints solved together: 6 to
19 s were measured of 13 sets of kinds beside other work, 0.76 to 1.34 times what is told."""


def compile_seconds(scene: Scene) -> float:
    """Return an estimate of the time (s) to compile a scene's time loop, once on a machine for its
    set of element types."""
    return COMPILE + sum(COMPILE_JOINTS if k is Joint else COMPILE_KIND for k in kinds_of([scene]))


def step_seconds(scene: Scene) -> float:
    """Return an estimate of the core time (s) of one time step of eight runs of a scene side by
    side, on a machine with 256-bit vector units; times `machine()` on this one."""
    cost = STEP
    elements = sum(len(beams.length) for beams in scene.beams)
    on_beams = {int(p) for beams in scene.beams for p in np.unique(beams.nodes)}
    cost += ELEMENT * elements + PARTICLE * (len(scene.position) - len(on_beams))
    for kind in kinds_of([scene]):
        cost += _of_kind(kind, scene)
    return 1e-9 * cost


def run_seconds(scene: Scene, steps: int, instants: int) -> float:
    """Return an estimate of the core time (s) of one run of a scene, an eighth of eight computed
    side by side, on a machine with 256-bit vector units; times `machine()` on this one. steps,
    instants: numbers of time steps and of recorded instants."""
    packing = PACKING + PER_STATEMENT * sum(map(len, scene.kinds.values()))
    return (steps * step_seconds(scene) + instants * 1e-9 * INSTANT) / 8 + packing


def _of_kind(kind: type[ElementType], scene: Scene) -> float:
    """Nanoseconds of a step for all elements of a type; of beams apart from this."""
    if kind.__name__ == "Damping":
        return DAMPED * len(scene.position)
    if kind.__name__ == "Viscosity":
        return VISCOUS * sum(len(beams.length) for beams in scene.beams)
    if kind is Beams or kind.__name__ == "Probe":
        return 0.0
    if kind is Cable:
        return sum(
            (STRETCH if cable.friction is None else RUBBING) * (len(cable.beams) - 1)
            for cable in scene.cables
        )
    if kind is Joint:
        conditions, operations = elimination_of(scene)
        return CONDITION * conditions + MULTIPLY_ADD * operations
    share = len(scene.position) if kind.__name__ == "Gravity" else len(kind.of(scene))
    return KIND_COSTS.get(kind.__name__, DEFAULT_COST) * share


def elimination_of(scene: Scene) -> tuple[int, float]:
    """Return the number of scalar constraints of all joints of a scene that are solved together,
    and of multiply-adds to eliminate them in one time step. A joint of c constraints takes c³/6 for
    its own block, c² d/2 for those below it and c d²/2 for those of the d constraints of joints
    that it is coupled to when its turn comes."""
    from fpm.elements.joints.joint_pattern import elimination, neighbours

    joints = Joint.of(scene)
    particles = sorted({p for joint in joints for p in joint.particles})
    slot = {particle: number for number, particle in enumerate(particles)}
    slots = np.array([[*(slot[p] for p in joint.particles), -1][:2] for joint in joints])
    order, neighbour_sets = elimination(neighbours(slots, ~scene.fixed[particles].all(axis=1)))
    counts = np.array([joints[j].conditions for j in order])
    coupled = np.array([counts[members].sum() for members in neighbour_sets])
    operations = counts**3 / 6 + counts**2 * coupled / 2 + counts * coupled**2 / 2
    return int(counts.sum()), float(operations.sum())


@cache
def machine() -> float:
    """Return the factor from core times on a machine with 256-bit vector units to those on this
    one: 1/2.9 (measured) with 512 bits, 2 below 256."""
    from llvmlite.binding import get_host_cpu_features

    has = get_host_cpu_features()
    if has.get("avx512f"):
        return 1 / 2.9
    return 1.0 if has.get("avx2") else 2.0  # 128 bits: twice the instructions
