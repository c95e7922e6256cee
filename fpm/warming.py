"""Compiling the solver once, before it is needed."""

from fpm.kinds.beam import Material, Section
from fpm.scene import Scene
from fpm.simulate import simulate


def warm_up(scene: Scene | None = None) -> None:
    """Compile the solver for the kinds in a scene, or load it from the cache on disk.

    Without a scene for the least that most have: for a single bar.
    """
    if scene is None:
        scene = Scene("warm-up")
        section, material = Section.square(0.1), Material(1e9, 0.3, 1e3)
        scene.add_link((0, 0, 0), (1, 0, 0), (0, 0, 1), section, material, 2)
    simulate(scene, duration=1e-3, instants=2)
