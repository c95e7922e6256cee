"""Scenes that can run side by side, as one batch: those that differ in numbers only."""

from collections.abc import Callable, Hashable, Sequence
from functools import partial
from typing import Any

from fpm.elements import kinds_of
from fpm.elements.batch import Batch
from fpm.elements.reads import SceneList
from fpm.errors import SceneError
from fpm.scenes.scene import Scene

MOST_EVENTS = 512
"""Number of events of a sample for which there is room; with more, the run is repeated."""

MOST_ROOM = 1 << 16
"""Number of events of a sample that are kept, at most; more are only counted."""


def topology(scene: Scene) -> tuple:
    """Return what must be equal in all scenes of a batch, as a hashable tuple: particles, what
    element types ask for, points, held axes, the number of curves."""
    of_kinds = {kind: kind.topology_of(scene) for kind in kinds_of([scene])}
    return (
        *_layout(scene),
        tuple((kind, value) for kind, value in of_kinds.items() if value is not None),
    )


def _of_kind(kind: type[Any], scene: Scene) -> Hashable:
    """Return what must be equal of the elements of one type in scenes that run side by side."""
    return kind.topology_of(scene) if kind.find(scene) else None


def _layout(scene: Scene) -> tuple:
    """Return what else must be equal in scenes that run side by side."""
    return (
        len(scene.position),
        tuple((name, p.particle) for name, p in scene.points.items()),
        scene.fixed.tobytes(),
        len(scene.curves),
    )


def curve_bytes(scene: Scene) -> tuple:
    """Return the content of a scene's curves of time, as a hashable tuple: scenes of a batch whose
    curves differ run one after the other, as curves are one for all lanes."""
    return tuple((c.times.tobytes(), c.values.tobytes(), c.powers.tobytes()) for c in scene.curves)


def check_topology(scenes: Sequence[Scene]) -> None:
    """Check that scenes can run side by side (differ in numbers only); raises SceneError if not."""
    scenes = SceneList(scenes)
    functions: list[Callable] = [
        _layout,
        *(partial(_of_kind, kind) for kind in kinds_of(scenes)),
    ]
    mismatches = []
    for function in functions:
        first, *values = scenes.map(function)
        mismatches += [i for i, value in enumerate(values, start=1) if value != first]
    if mismatches:
        allowed = "the same particles, connections and supports as scene 0, and beams along "
        allowed += "their particles' axes where its are; scenes of a batch may differ in "
        key = f"topology of scene {min(mismatches)}"
        raise SceneError(key, scenes[min(mismatches)].name, f"{allowed}numbers only")


def pack(
    scenes: Sequence[Scene], width: int, dtype, instants: int, room: int = MOST_EVENTS
) -> Batch:
    """Return a Batch of scenes to simulate side by side, which makes the arrays of the kernels.
    scenes: must pass `check_topology`; width: number of lanes (samples in an array), at least that
    of scenes (further lanes repeat the last scene); dtype: of the arrays; instants: number of
    recorded instants; room: number of events of each scene that are kept, more are only counted."""
    return Batch(scenes, kinds_of(scenes), width, dtype, instants, room)
