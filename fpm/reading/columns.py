"""Columns that are recorded only when asked: where each comes from.

For each variable of `fpm.files.variables` there is a `Source`: which labels a scene has, what a
probe must record for one (elements/particles/probe.py), and how its values follow from that.
"""

from collections.abc import Callable, Iterable
from functools import partial
from itertools import combinations
from typing import NamedTuple

import numpy as np

from fpm.elements.joints.hinge import Hinge
from fpm.elements.joints.joint import Joint
from fpm.elements.kind import AXES
from fpm.elements.openings.opening import PARTS
from fpm.elements.particles.probe import Probe
from fpm.reading import bars
from fpm.reading.clearance import clearance
from fpm.reading.constraint_forces import couple_on_two, joints_of, reaction, reactions_of
from fpm.reading.kept import Kept
from fpm.reading.stress import element_stress
from fpm.scenes.scene import Scene

PLACE = " at "  # between a bar and the share of its length


class Source(NamedTuple):
    """Of a variable: labels(scene); keeps(scene, label) -> Probe; values(kept, label) -> (t,)."""

    labels: Callable[[Scene], Iterable[str]]
    keeps: Callable[[Scene, str], Probe]
    values: Callable[[Kept, str], np.ndarray]


# -- points, bodies, openings ---------------------------------------------------------------------


def _split(label: str) -> tuple[str, int]:
    """What a label is about, and the number of its axis."""
    name, _, axis = label.rpartition(" ")
    return name, AXES.index(axis)


def _along_axes(names: Iterable[str]) -> list[str]:
    return [f"{name} {axis}" for name in names for axis in AXES]


def _turning(scene: Scene) -> dict[str, int]:
    """What has an angular velocity: bodies and named points, with their particles."""
    return {**{name: beam.particle for name, beam in scene.points.items()}, **scene.bodies}


def _acceleration(kept: Kept, label: str) -> np.ndarray:
    name, axis = _split(label)
    beam = kept.scene.points[name]
    change, turning = kept.acceleration(beam.particle)
    spin, arm = kept.spin(beam.particle), kept.arm(beam)
    return (change + np.cross(turning, arm) + np.cross(spin, np.cross(spin, arm)))[:, axis]


def _angular_velocity(kept: Kept, label: str) -> np.ndarray:
    name, axis = _split(label)
    return kept.spin(_turning(kept.scene)[name])[:, axis]


def _hinge(scene: Scene, name: str) -> int:
    return [hinge.name for hinge in scene.hinges].index(name)


def _opening_rate(kept: Kept, label: str) -> np.ndarray:
    hinge = kept.scene.hinges[_hinge(kept.scene, label)]
    one, two = hinge.particles
    axis = kept.axes(one) @ hinge.axes[0]
    if not hinge.slides:
        return np.sum(axis * (kept.spin(two) - kept.spin(one)), axis=1)
    point = kept.place(two) + kept.arm(hinge.beams[1])
    one, two = (
        kept.velocity(p) + np.cross(kept.spin(p), point - kept.place(p)) for p in (one, two)
    )
    return np.sum(axis * (two - one), axis=1)


def _openings(scene: Scene, slides: bool) -> list[str]:
    """Names of the hinges whose openings are lengths, or not."""
    return [hinge.name for hinge in scene.hinges if hinge.slides == slides]


def _acting(scene: Scene, slides: tuple[bool, ...]) -> list[str]:
    """Who may act on openings that are lengths, or not."""
    names = [name for which in slides for name in _openings(scene, which)]
    return [f"{name} {part}" for name in names for part in PARTS]


def _keep_moments(scene: Scene, label: str) -> Probe:
    return Probe(moments=True)


def _told(which: int) -> Callable[[Kept, str], np.ndarray]:
    def values(kept, label):
        name, _, part = label.rpartition(" ")
        return kept.told(_hinge(kept.scene, name), part)[which]

    return values


# -- joints and supports --------------------------------------------------------------------------


def _keep_joint(scene: Scene, label: str) -> Probe:
    joint = joints_of(scene)[_split(label)[0]]
    return Probe(frames=joint.particles, impulses=True)


def _constraint_force(kept: Kept, label: str) -> np.ndarray:
    name, axis = _split(label)
    return next(sides.on_two[:, axis] for joint, sides in kept.joints if joint.name == name)


def _constraint_moment(kept: Kept, label: str) -> np.ndarray:
    name, axis = _split(label)
    joint, sides = next(pair for pair in kept.joints if pair[0].name == name)
    return couple_on_two(kept, joint, sides)[:, axis]


def _keep_reaction(scene: Scene, label: str) -> Probe:
    found = reactions_of(scene)[_split(label)[0]]
    particle = found.beam.particle
    joints = [*Hinge.of(scene), *Joint.of(scene)]
    joined = {p for joint in joints if particle in joint.particles for p in joint.particles}
    frames = tuple(sorted(joined | {particle}))
    return Probe(frames, (particle,) if found.particle else (), impulses=bool(joints))


def _reaction(which: int) -> Callable[[Kept, str], np.ndarray]:
    def values(kept, label):
        name, axis = _split(label)
        return reaction(kept, name)[which][:, axis]

    return values


# -- bars -----------------------------------------------------------------------------------------


def _keep_bars(scene: Scene, names: Iterable[str]) -> Probe:
    known = bars.bars_of(scene)
    return Probe(frames=tuple({p for name in names for p in known[name].particles}))


def _section_labels(components: Iterable[str]) -> Callable[[Scene], list[str]]:
    return lambda scene: [f"{n}{PLACE}{c}" for n in bars.bars_of(scene) for c in components]


def _in_section(which: int, components: dict[str, int]) -> Callable[[Kept, str], np.ndarray]:
    def values(kept, label):
        name, _, rest = label.partition(PLACE)
        share, _, component = rest.partition(" ")
        bar, found = kept.sections(name)
        return bars.at_share(bar, found, float(share))[which][:, components[component]]

    return values


def _stress(kept: Kept, label: str) -> np.ndarray:
    known = bars.bars_of(kept.scene)
    largest = np.zeros(len(kept.time))
    for bar in known.values() if label == "all" else (known[label],):
        stress = element_stress(kept.scene, bar.groups, kept.place, kept.axes)
        largest = np.maximum(largest, stress.max(axis=1))
    return largest


def _stressed(scene: Scene, label: str) -> list[str]:
    return list(bars.bars_of(scene)) if label == "all" else [label]


def _pairs(scene: Scene) -> list[str]:
    return [f"{a} to {b}" for a, b in combinations(bars.bars_of(scene), 2)]


def _clearance(kept: Kept, label: str) -> np.ndarray:
    first, second = (bars.bars_of(kept.scene)[name] for name in label.split(" to "))
    return clearance(kept.scene, first, second, kept.place, kept.axes)


SOURCES = {
    "acceleration": Source(
        lambda scene: _along_axes(scene.points),
        lambda scene, label: Probe(forces=(scene.points[_split(label)[0]].particle,)),
        _acceleration,
    ),
    "angular_velocity": Source(
        lambda scene: _along_axes(_turning(scene)),
        lambda scene, label: Probe(forces=(_turning(scene)[_split(label)[0]],)),
        _angular_velocity,
    ),
    **{
        name: Source(
            partial(_openings, slides=slides),
            lambda scene, label: Probe(forces=scene.hinges[_hinge(scene, label)].particles),
            _opening_rate,
        )
        for name, slides in (("opening_rate", False), ("slide_rate", True))
    },
    **{
        name: Source(partial(_acting, slides=slides), _keep_moments, _told(which))
        for name, slides, which in (
            ("joint_moment", (False,), 0),
            ("joint_force", (True,), 0),
            ("joint_work", (False, True), 1),
        )
    },
    "constraint_force": Source(
        lambda scene: _along_axes(joints_of(scene)), _keep_joint, _constraint_force
    ),
    "constraint_moment": Source(
        lambda scene: _along_axes(joints_of(scene)), _keep_joint, _constraint_moment
    ),
    "reaction_force": Source(
        lambda scene: _along_axes(reactions_of(scene)), _keep_reaction, _reaction(0)
    ),
    "reaction_moment": Source(
        lambda scene: _along_axes(n for n, found in reactions_of(scene).items() if found.turns),
        _keep_reaction,
        _reaction(1),
    ),
    **{
        name: Source(
            _section_labels(components),
            lambda scene, label: _keep_bars(scene, [label.partition(PLACE)[0]]),
            _in_section(which, components),
        )
        for which, (name, components) in enumerate(
            {"section_force": bars.FORCES, "section_moment": bars.MOMENTS}.items()
        )
    },
    "stress": Source(
        lambda scene: ["all", *bars.bars_of(scene)] if scene.beams else [],
        lambda scene, label: _keep_bars(scene, _stressed(scene, label)),
        _stress,
    ),
    "clearance": Source(
        _pairs, lambda scene, label: _keep_bars(scene, label.split(" to ")), _clearance
    ),
}
