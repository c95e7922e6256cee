"""Functions of several scenes, called again only where scenes differ in what the function reads."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from operator import is_
from typing import Any

import numpy as np

TYPES = "types of elements"
"""What is read by asking for which element types a scene has a list."""


class SceneList(list):
    """Scenes in a list, of which functions are found; scenes that are not changed meanwhile. That
    two of them are the same in something is found out once."""

    def __init__(self, scenes):
        super().__init__(scenes)
        self._counts: dict[Any, int] = {}

    def share(self, function: Callable[[Any], Any]) -> tuple[Any, int]:
        """Return function(scene) of the first scene, and how many scenes from the first on have the
        same value, as they agree in all that the function read of the first. function: depends only
        on what it reads of the scene."""
        if len(self) == 1:
            return function(self[0]), 1
        reads: set[Any] = set()
        value = function(Reader(self[0], reads))
        return value, self.count_same(reads)

    def map(self, function: Callable[[Any], Any]) -> Iterator[Any]:
        """Yield function(scene) for each of the scenes, of which those that `share` counts have one
        value. function: as there."""
        if self:
            value, count = self.share(function)
            yield from [value] * count
            yield from map(function, self[count:])

    def count_same(self, keys: Iterable) -> int:
        """Return how many scenes, counted from the first, agree in all `keys`: attributes, or
        element types."""
        return min(map(self._count, keys), default=len(self))

    def _count(self, key: Any) -> int:
        """Return how many scenes, from the first on, have the same under a key of what is read."""
        if key not in self._counts:
            first = _read(self[0], key)
            rest = enumerate(self[1:], start=1)
            changes = (i for i, scene in rest if not _is_same(first, _read(scene, key)))
            self._counts[key] = next(changes, len(self))
        return self._counts[key]


class Reader:
    """A scene that notes what is read of it in `reads`, by attribute or element type."""

    def __init__(self, scene: Any, reads: set[Any]):
        self._scene, self._reads, self.kinds = scene, reads, Kinds(scene.kinds, reads)

    def __getattr__(self, name: str) -> Any:
        code = getattr(type(self._scene), name, None)
        if isinstance(code, property):
            return code.__get__(self)
        if callable(code):
            return code.__get__(self)
        self._reads.add(name)
        return getattr(self._scene, name)


class Kinds(Mapping):
    """Elements by type, which notes in `reads` of which types it was asked for."""

    def __init__(self, kinds: dict, reads: set[Any]):
        self._kinds, self._reads = kinds, reads

    def __getitem__(self, kind: type) -> list:
        self._reads.add(kind)
        return self._kinds[kind]

    def __iter__(self) -> Iterator[type]:
        self._reads.add(TYPES)
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
    """Return whether what was read of two scenes is the same, elements as objects and arrays in
    bits."""
    if first is second or type(first) is not type(second):
        return first is second
    if isinstance(first, np.ndarray):
        return first.shape == second.shape and first.tobytes() == second.tobytes()
    if isinstance(first, dict):
        first, second = [*first, *first.values()], [*second, *second.values()]
    is_list = isinstance(first, list) and len(first) == len(second)
    return is_list and all(map(is_, first, second))
