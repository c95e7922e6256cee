"""The structure that a config asks for: one that we know by its name, or one from a text file."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

# What the scenes call their number of elements; a structure's file says it itself.
_MESH = ("elements_per_link", "elements")


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
    """The `fpm.scenes.SceneType` of a file, or else of a name; raises `fpm.SceneError`."""
    from deployable import fpm

    if not file:
        return fpm.scenes.get(name)
    from deployable.fpm import structures

    if Path(file).suffix != ".py":  # which is run whenever it is read
        with suppress(OSError, UnicodeDecodeError):
            return _of_text(Path(file).read_text(encoding="utf-8"), file)
    return structures.load(file)


@lru_cache(maxsize=8)
def _of_text(text: str, source: str) -> Any:
    """A structure's text is read once, however many stages and rounds want it."""
    from deployable.fpm import structures

    return structures.loads(text, source)


def mesh_of(scene: Mapping) -> str | None:
    """The parameter for the number of elements; None where it or the scene is unknown."""
    from deployable import fpm

    try:
        found = scene_type(scene.get("name", ""), scene.get("file", ""))
    except fpm.SceneError:
        return None
    if "file" in scene:
        return getattr(found, "mesh", None)
    return next((name for name in _MESH if name in found.parameters), None)
