"""What is recorded only when it is asked: what the loop has to keep for it, and the columns.

`fpm.files.variables` has names and units, `fpm.reading.columns` where each comes from.
"""

from collections.abc import Iterable
from copy import copy

import numpy as np

from fpm.elements.joints.hinge import Hinge
from fpm.elements.joints.joint import Joint
from fpm.elements.kind import Recorded
from fpm.elements.openings.opening import PARTS
from fpm.elements.particles.probe import Probe
from fpm.errors import SceneError, did_you_mean
from fpm.files.variables import VARIABLES, Column
from fpm.reading.columns import PLACE, SOURCES
from fpm.reading.kept import Kept
from fpm.scenes.scene import Scene


def prepared(scene: Scene, asked: Iterable[Column]) -> Scene:
    """A copy of a scene with the probe for the columns asked; itself where none is.

    SceneError for a column that it does not have.
    """
    asked = list(asked)
    if not asked:
        return scene
    probes = []
    for variable, label in asked:
        known = labels(scene, variable)
        if variable in ("section_force", "section_moment"):
            bar, _, rest = label.partition(PLACE)
            fits = f"{bar}{PLACE}{rest.partition(' ')[2]}" in known
        else:
            fits = label in known
        if not fits:
            allowed = f"one of {', '.join(known) or '(this scene has none)'}"
            raise SceneError(variable, label, allowed + did_you_mean(label, known))
        probes.append(SOURCES[variable].keeps(scene, label))
    forces = sorted({p for probe in probes for p in probe.forces})
    frames = sorted({p for probe in probes for p in probe.frames} | set(forces))
    probe = Probe(
        tuple(frames),
        tuple(forces),
        any(probe.moments for probe in probes),
        any(probe.impulses for probe in probes),
    )
    out = copy(scene)
    out.kinds = {**scene.kinds, Probe: [probe]}
    return out


def numbers(scene: Scene, asked: Iterable[Column]) -> int:
    """How many numbers of a sample the loop keeps at an instant for the columns asked."""
    from fpm.elements.joints.hinge_arrays import SUMS
    from fpm.elements.particles import probe_kernels

    probe = Probe.asked(prepared(scene, asked))
    kept = probe_kernels.FRAME * len(probe.frames) + probe_kernels.FORCES * len(probe.forces)
    joints = len(Hinge.of(scene)) + len(Joint.of(scene))
    told = 2 * len(PARTS) * len(scene.hinges)
    return kept + SUMS * joints * probe.impulses + told * probe.moments


def recorded(kept: Kept, asked: Iterable[Column]) -> dict[str, Recorded]:
    """The columns asked of a run, as variables of its trajectory file."""
    by_variable: dict[str, list[str]] = {}
    for variable, label in asked:
        by_variable.setdefault(variable, []).append(label)
    found = {}
    for name, own in by_variable.items():
        unit, words, dimension = VARIABLES[name]
        values = np.stack([SOURCES[name].values(kept, label) for label in own], axis=1)
        found[name] = Recorded(values, unit, words, dimension, tuple(own))
    return found


def labels(scene: Scene, variable: str) -> list[str]:
    """The labels that a variable may have in a scene; a place on a bar is left out of them, which
    is a share of its length: "bar at axial" stands for "bar at 0.5 axial"."""
    return list(SOURCES[variable].labels(scene))
