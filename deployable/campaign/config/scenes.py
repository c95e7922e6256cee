"""The structure that a config asks for: one that is shipped, by its name, or one of a file."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

from deployable.campaign import shipped


def anchored(raw: Mapping, folder: str | Path) -> Mapping:
    """`raw` with the path of its scene's file, which is relative to `folder`, as seen from here.

    A path below the working folder stays short; any other becomes absolute.
    """
    scene = raw.get("scene")
    if not isinstance(scene, Mapping) or not isinstance(scene.get("file"), str):
        return raw
    path = Path(folder, scene["file"]).resolve()
    here = Path.cwd().resolve()
    path = path.relative_to(here) if path.is_relative_to(here) else path
    return {**raw, "scene": {**scene, "file": str(path)}}


def scene_type(name: str, file: str = "") -> Any:
    """The `fpm` structure of a file, or else the shipped one of a name; raises `fpm.SceneError`."""
    from fpm import SceneError, structures

    if not file:
        if name not in (known := shipped.structures()):
            raise SceneError("scene.name", name, f"one of {', '.join(known)}")
        file = str(known[name])
    if Path(file).suffix != ".py":  # which is run whenever it is read
        with suppress(OSError, UnicodeDecodeError):
            return _of_text(Path(file).read_text(encoding="utf-8"), file)
    return structures.load(file)


@lru_cache(maxsize=8)
def _of_text(text: str, source: str) -> Any:
    """A structure's text is read once, however many stages and rounds want it."""
    from fpm import structures

    return structures.loads(text, source)
