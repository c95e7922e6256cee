"""Compiling the solver once, before several processes need it."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

from fpm.elements.beam import Material, Section
from fpm.scene import Scene
from fpm.simulate import simulate


def warm_up() -> None:
    """Compile the solver, or load it from the cache on disk, by a run of a few steps.

    numba's cache can break when several processes write it at once, so the first that arrives
    compiles and the others wait for its lock. Compiled code is loaded without waiting.
    """
    from fpm.kernels.compiled import cache_folder

    scene = Scene("warm-up")
    bar = scene.add_link(
        (0, 0, 0), (1, 0, 0), (0, 0, 1), Section.square(0.1), Material(1e9, 0.3, 1e3), 2
    )
    scene.add_point("tip", int(bar.particles[-1]))
    lock = Path(tempfile.gettempdir()) / f"deployable-intervals-{os.getuid()}.lock"
    compiled = any(cache_folder().rglob("*.nbc"))  # numba writes them last
    with nullcontext() if compiled else _one_at_a_time(lock):
        simulate(scene, duration=1e-3, instants=2)


@contextmanager
def _one_at_a_time(path: Path) -> Iterator[None]:
    """Hold an exclusive lock on the file at `path`."""
    import fcntl

    with open(path, "a") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
