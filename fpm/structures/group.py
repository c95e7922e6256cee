"""Samples of a structure file whose values differ in what acts only: springs, cables, motions.

All else is built once, for a first sample, and the others share it."""

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
    first (SI units); varied: names of the parameters. Attribute `entries`: what depends on these;
    None: more than what acts does, or the first sample is refused, and `build` returns None."""

    def __init__(self, model: FileStatements, values: Mapping[str, float], varied: Collection[str]):
        names, changed = model.names, {*varied}
        for name in names.order:
            bound = names.numbers[name].bound
            if bound and not changed.isdisjoint(bound.full.values()):
                changed.add(name)
        self._model, self._numbers = model, [name for name in names.order if name in changed]
        self.entries, problems = _dependents(model, changed), Problems("")
        self._first = None if self.entries is None else build_sample(model, values, problems)
        if problems:
            self.entries = None
        for array in vars(self._first.scene).values() if self.entries is not None else ():
            if isinstance(array, np.ndarray):
                array.flags.writeable = False

    def build(self, values: Mapping[str, float]) -> Scene | None:
        """Return the scene at values of the file's parameters by name (SI units), of which those
        that are not varied are the first sample's. Its arrays are those of all samples. None where
        it is to be built on its own, as one that is refused, or has other elements."""
        if self.entries is None:
            return None
        build, problems, shared = copy(self._first), Problems(""), self._first.scene
        build.problems, build.added = problems, {}
        build.numbers, scene = dict(build.numbers), copy(shared)
        build.scene, scene.doubts = scene, list(shared.doubts)
        kinds = {kind: list(elements) for kind, elements in shared.kinds.items()}
        with np.errstate(all="ignore"):
            find_numbers(build, self._model, values, self._numbers)
            is_moved = any(entry.statement.group == MOTIONS for entry in self.entries)
            if is_moved:
                scene.velocity, scene.spin = shared.velocity.copy(), shared.spin.copy()
            for entry in self.entries:
                added = self._first.added[entry.statement.group, entry.name]
                first: dict[type, int] = {}
                for kind, i in added:
                    first.setdefault(kind, i)
                # Without these, and those of their types that come later.
                scene.kinds = {k: x[: first.get(k, len(x))] for k, x in kinds.items()}
                build_entry(build, entry)
                if problems or build.added[entry.statement.group, entry.name] != added:
                    return None
                for kind, i in added:
                    kinds[kind][i] = scene.kinds[kind][i]
            scene.kinds = kinds
            if is_moved:
                finish(build, self._model)
        return None if problems or scene.doubts != shared.doubts else scene


def _dependents(model: FileStatements, changed: set[str]) -> list[Entry] | None:
    """Entries that depend on numbers, in the order in which they are built; None where they are not
    of those that may be built again. changed: names of the numbers."""
    points = {f"{name}.{axis}" for name in model.points for axis in "xyz"}
    points |= {f"point {name}" for name in model.points}
    found, changed = [], set(changed)
    for entry in sorted(model.entries, key=lambda entry: entry.statement.type == "release"):
        if not entry.uses.isdisjoint(changed):
            found.append(entry)
            changed.add(f"{entry.statement.group}:{entry.name}")
    motions = [entry for entry in model.entries if entry.statement.group == MOTIONS]
    acting = [entry for entry in found if entry.statement.group != MOTIONS]
    is_whole = "start" in model.overall.read or not model.overall.uses.isdisjoint(changed)
    has_rates = any(entry.statement.group == "opening_rates" for entry in model.entries)
    if is_whole or has_rates or not points.isdisjoint(changed):
        return None
    if any(e.statement.group not in LATE_GROUPS or e.statement.type == "bearing" for e in acting):
        return None
    return acting + (motions if len(acting) < len(found) else [])
