"""Scenes that can run side by side, as one batch: those that differ in numbers only."""

from collections.abc import Sequence

from fpm.elements import energies_of, kinds_of
from fpm.elements.batch import Batch
from fpm.errors import SceneError
from fpm.scenes.scene import Scene

MOST_EVENTS = 512
"""Room for events of a sample; where there are more, the run is repeated with room for them."""

MOST_ROOM = 1 << 16
"""Events kept per sample at most; more are counted but not kept."""


def topology(scene: Scene) -> tuple:
    """What must be equal in all scenes that run side by side, as a hashable tuple: particles, what
    element types ask for, points, held axes, curves."""
    of_kinds = {kind: kind.topology_of(scene) for kind in kinds_of([scene])}
    return (
        len(scene.position),
        tuple((kind, value) for kind, value in of_kinds.items() if value is not None),
        tuple((name, p.particle) for name, p in scene.points.items()),
        scene.fixed.tobytes(),
        tuple((tuple(t), tuple(v)) for t, v in scene.curves),
    )


def check_topology(scenes: Sequence[Scene]) -> None:
    """Check that scenes can run side by side (differ in numbers only); raises SceneError if not."""
    first = topology(scenes[0])
    for i, scene in enumerate(scenes[1:], start=1):
        if topology(scene) != first:
            allowed = "the same particles, connections and supports as scene 0, and beams along "
            allowed += "their particles' axes where its are; scenes of a batch may differ in "
            raise SceneError(f"topology of scene {i}", scene.name, f"{allowed}numbers only")


def pack(
    scenes: Sequence[Scene], width: int, dtype, instants: int, room: int = MOST_EVENTS
) -> Batch:
    """Batch of scenes that run side by side: packs their numbers into the arrays of the kernels.
    The scenes must pass `check_topology`. width: number of lanes (samples in an array); dtype: of
    the arrays; instants: number of recorded instants; room: for how many events of each scene."""
    kinds = kinds_of(scenes)
    return Batch(scenes, kinds, energies_of(kinds), width, dtype, instants, room)
