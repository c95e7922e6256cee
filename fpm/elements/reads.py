"""Functions of several scenes, called again only where scenes differ in what the function reads."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from operator import is_
from typing import Any

import numpy as np

TYPES = "types of elements"
"""What is read by asking for which element types a scene has a list."""


def map_scenes(function: Callable[[Any], Any], scenes: Sequence[Any]) -> Iterator[Any]:
    """Yield function(scene) for each of `scenes`, and the first value again for those that follow
    and have the same in all that it read of the first, which is found out by giving it a Reader in
    the place of that scene. Once a scene differs it is called for every further one. function: one
    that depends on what it reads of the scene only, and does not keep it."""
    reads: dict[Any, Any] = {}
    is_shared = len(scenes) > 1
    value = function(Reader(scenes[0], reads) if is_shared else scenes[0])
    yield value
    for scene in scenes[1:]:
        is_shared = is_shared and all(_is_same(x, _read(scene, key)) for key, x in reads.items())
        yield value if is_shared else function(scene)


class Reader:
    """A scene that notes what is read of it in `reads`, by attribute or element type."""

    def __init__(self, scene: Any, reads: dict[Any, Any]):
        self._scene, self._reads, self.kinds = scene, reads, Kinds(scene.kinds, reads)

    def __getattr__(self, name: str) -> Any:
        code = getattr(type(self._scene), name, None)
        if isinstance(code, property):
            return code.fget(self)
        if callable(code):
            return code.__get__(self)
        value = self._reads[name] = getattr(self._scene, name)
        return value


class Kinds(Mapping):
    """Elements by type, which notes in `reads` of which types it was asked for."""

    def __init__(self, kinds: dict, reads: dict[Any, Any]):
        self._kinds, self._reads = kinds, reads

    def __getitem__(self, kind: type) -> list:
        self._reads[kind] = self._kinds.get(kind)
        return self._kinds[kind]

    def __iter__(self) -> Iterator[type]:
        self._reads[TYPES] = list(self._kinds)
        return iter(self._kinds)

    def __len__(self) -> int:
        return len(list(iter(self)))

    def setdefault(self, kind: type, default: list) -> list:
        """Return the elements of a type as dict.setdefault does, but do not change the scene."""
        return self.get(kind, default)


def _read(scene: Any, key: Any) -> Any:
    if key == TYPES:
        return list(scene.kinds)
    return getattr(scene, key) if isinstance(key, str) else scene.kinds.get(key)


def _is_same(first: Any, second: Any) -> bool:
    """Whether what was read of two scenes is the same, elements as objects and arrays in bits."""
    if first is second or type(first) is not type(second):
        return first is second
    if isinstance(first, np.ndarray):
        return first.shape == second.shape and first.tobytes() == second.tobytes()
    if isinstance(first, dict):
        first, second = [*first, *first.values()], [*second, *second.values()]
    is_list = isinstance(first, list) and len(first) == len(second)
    return is_list and all(map(is_, first, second))
