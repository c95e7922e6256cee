"""Samples of a structure file that differ in some parameters: what they have in common, once.

Where values differ in what acts only (springs, cables, motions), all else is built once, for a
first sample, and the others share it. Else each is built on its own."""

from collections.abc import Collection, Mapping
from copy import copy

import numpy as np

from fpm.scenes.scene import Scene
from fpm.structures.model import FileStatements
from fpm.structures.reading import Problems
from fpm.structures.sample import (
    LATE_GROUPS,
    MOTIONS,
    build_entry,
    build_sample,
    find_numbers,
    finish,
)
from fpm.structures.statement import Entry


class SampleGroup:
    """Builds samples of a structure file whose values differ from those of a first in some
    parameters only, to the bits of one by one. model: the file's statements; values: those of the
    first (SI units); parameters: their names."""

    def __init__(
        self, model: FileStatements, values: Mapping[str, float], parameters: Collection[str]
    ):
        names, numbers = model.names, model.names.dependents(parameters)
        self._model, self._numbers = model, [name for name in names.order if name in numbers]
        self._entries = _dependents(model, numbers)
        if self._entries is None:
            return
        self._first = build_sample(model, values, problems := Problems(""))
        self._entries = None if problems else self._entries
        for array in vars(self._first.scene).values():
            if isinstance(array, np.ndarray):
                array.flags.writeable = False

    def build(self, values: Mapping[str, float]) -> Scene | None:
        """Return the scene at values of the file's parameters by name (SI units), of which those
        that are not varied are the first sample's; its arrays are those of all samples. None where
        it is to be built on its own, as one that is refused, or has other elements."""
        if (entries := self._entries) is None:
            return None
        build, problems, first_scene = copy(self._first), Problems(""), self._first.scene
        build.problems, build.additions = problems, {}
        build.numbers, scene = dict(build.numbers), copy(first_scene)
        build.scene, scene.doubts = scene, list(first_scene.doubts)
        kinds = {kind: list(elements) for kind, elements in first_scene.kinds.items()}
        with np.errstate(all="ignore"):
            find_numbers(build, self._model, values, self._numbers)
            is_moved = any(entry.statement.group == MOTIONS for entry in entries)
            if is_moved:
                scene.velocity, scene.spin = first_scene.velocity.copy(), first_scene.spin.copy()
            for entry in entries:
                elements = self._first.additions[entry.statement.group, entry.name]
                first: dict[type, int] = {}
                for kind, i in elements:
                    first.setdefault(kind, i)
                # Without these, and those of their types that come later.
                scene.kinds = {k: x[: first.get(k, len(x))] for k, x in kinds.items()}
                build_entry(build, entry)
                if problems or build.additions[entry.statement.group, entry.name] != elements:
                    return None
                for kind, i in elements:
                    kinds[kind][i] = scene.kinds[kind][i]
            scene.kinds = kinds
            if is_moved:
                finish(build, self._model)
        return None if problems or scene.doubts != first_scene.doubts else scene


def _dependents(model: FileStatements, numbers: set[str]) -> list[Entry] | None:
    """Entries that depend on numbers, in the order in which they are built; None where they are not
    of those that may be built again. numbers: their names."""
    points = {f"{name}.{axis}" for name in model.points for axis in "xyz"}
    points |= {f"point {name}" for name in model.points}
    entries, uses = [], set(numbers)
    for entry in sorted(model.entries, key=lambda entry: entry.statement.type == "release"):
        if not entry.uses.isdisjoint(uses):
            entries.append(entry)
            uses.add(f"{entry.statement.group}:{entry.name}")
    motions = [entry for entry in model.entries if entry.statement.group == MOTIONS]
    actions = [entry for entry in entries if entry.statement.group != MOTIONS]
    is_whole = "start" in model.overall.read or not model.overall.uses.isdisjoint(uses)
    has_rates = any(entry.statement.group == "opening_rates" for entry in model.entries)
    if is_whole or has_rates or not points.isdisjoint(uses):
        return None
    if any(e.statement.group not in LATE_GROUPS or e.statement.type == "bearing" for e in actions):
        return None
    return actions + (motions if len(actions) < len(entries) else [])
