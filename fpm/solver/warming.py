"""Compiling the solver once, before it is needed."""

from fpm.scenes.scene import Scene
from fpm.solver.simulate import simulate


def warm_up(scene: Scene, record=()) -> None:
    """Compile the solver for the kinds in a scene, or load it from the cache on disk.

    record: as for `simulate`.
    """
    # One step; a stable one takes a while.
    simulate(scene, duration=1e-9, instants=2, step=1e-9, record=record)
