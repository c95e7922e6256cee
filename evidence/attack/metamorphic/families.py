"""All ways to say a structure otherwise, by name; those of words, units and time."""

import copy
import random
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from evidence.attack.metamorphic.image import Image, entries, scale
from evidence.attack.metamorphic.openings import (
    OPENINGS,
    ends_of,
    openings_of,
    shift_zeros,
    swap_parts,
)
from evidence.attack.metamorphic.parts import reversed_cables, split, with_inert
from evidence.attack.metamorphic.space import mirror, rotate
from evidence.attack.metamorphic.structure_text import Structure, map_numbers
from fpm.structures.statements import GROUPS


def reorder(structure: Structure, rng: random.Random) -> Image:
    """Everything stated in another order."""
    clone = copy.deepcopy(structure)
    for group in clone.keys() & {"points", *GROUPS}:
        items = list(clone[group].items())
        rng.shuffle(items)
        clone[group] = dict(items)
    for body in entries(clone, "bodies").values():
        rng.shuffle(body["points"])
    return Image(clone)


def rename_all(structure: Structure, rng: random.Random) -> Image:
    """Everything called something else."""
    old = {name for group in ("points", *GROUPS) for name in entries(structure, group)}
    numbers = zip(sorted(old), rng.sample(range(999), len(old)), strict=True)
    names = {name: f"n{k}" for name, k in numbers}
    names |= {
        name + end: names[name] + end
        for name, joint in entries(structure, "joints").items()
        for end in ends_of(joint)
    }

    def rename(value: Any) -> Any:
        if isinstance(value, dict):
            return {names.get(key, key): rename(entry) for key, entry in value.items()}
        if isinstance(value, list):
            return [rename(entry) for entry in value]
        return names.get(value, value) if isinstance(value, str) else value

    clone = {key: rename(value) if key != "name" else value for key, value in structure.items()}
    return Image(clone, names=names)


def change_units(structure: Structure, rng: random.Random) -> Image:
    """In other units: lengths, masses and times in numbers that are some times as large."""
    units = tuple(10.0 ** rng.uniform(-1.0, 1.0) for _ in range(3))
    return Image(map_numbers(structure, lambda x, unit: x * scale(units, unit)), units=units)


def say_in_vectors(structure: Structure, rng: random.Random) -> Image:
    """Points as vectors from each other, and directions as others that are turned."""
    clone = copy.deepcopy(structure)
    names = list(clone["points"])
    for k, name in enumerate(names[1:], start=1):
        start = rng.choice(names[:k])
        arm = np.subtract(structure["points"][name], structure["points"][start]).tolist()
        clone["points"][name] = f"{start} + [{', '.join(f'{x!r} m' for x in arm)}]"
    for group in clone.keys() & GROUPS.keys():
        for entry in clone[group].values():
            for key in entry.keys() & {"axis", "other", "up", "x", "normal"}:
                if isinstance(entry[key], list):
                    angle, axis = rng.uniform(-3.0, 3.0), rng.choice("xyz")
                    turns = Rotation.from_euler(axis, -angle)
                    vector = turns.apply(entry[key]).tolist()
                    entry[key] = f"rotate({vector}, {axis}, {angle!r} rad)"
    return Image(clone)


def is_quiet(structure: Structure) -> bool:
    """Whether nothing happens before a curve or a release."""
    motions = entries(structure, "initial_velocities") or "gravity" in structure
    has_curves = all("curve" in load for load in entries(structure, "loads").values())
    is_slack = all(_is_slack(structure, cable) for cable in entries(structure, "cables").values())
    actions = entries(structure, "actions").values()
    is_at_rest = all(_is_at_rest(structure, action) for action in actions)
    is_calm = not any(np.any(drag["wind"]) for drag in entries(structure, "drags").values())
    struts = entries(structure, "struts").values()
    is_limp = not any(any(strut.get("forces", [1])) for strut in struts)
    return not motions and has_curves and is_slack and is_at_rest and is_calm and is_limp


def _is_slack(structure: Structure, cable: dict) -> bool:
    points = np.array([structure["points"][station["at"]] for station in cable["through"]])
    return cable["rest"] > np.linalg.norm(np.diff(points, axis=0), axis=1).sum()


def _is_at_rest(structure: Structure, action: dict) -> bool:
    kind = action["type"]
    if kind in ("torsion spring", "spring"):
        return action.get("rest") in _all_openings(structure)
    if kind == "tabulated spring":
        return not any(action.get("moments", action.get("forces")))
    return kind != "torque motor" or "curve" in action


def _all_openings(structure: Structure) -> list[float]:
    joints = entries(structure, "joints").values()
    return [x for joint in joints if joint["type"] in OPENINGS for x in openings_of(joint)]


def delay(structure: Structure, rng: random.Random, wait: float) -> Image | None:
    """All that happens a time (s) later, where nothing does before."""
    if not is_quiet(structure):
        return None
    clone = copy.deepcopy(structure)
    for curve in entries(clone, "curves").values():
        curve["times"] = [t + wait for t in curve["times"]]
    for action in entries(clone, "actions").values():
        if "time" in action:
            action["time"] += wait
    # A rate that begins at once is an impact, unless it is there at the start.
    return Image(clone, delay=wait, is_exact=False, omits=frozenset({"energy"}), skips=1)


FAMILIES: dict[str, Callable[[Structure, random.Random], Image | None]] = {
    "rotated": rotate,
    "mirrored": mirror,
    "renamed": rename_all,
    "reordered": reorder,
    "in other units": change_units,
    "in vectors": say_in_vectors,
    "openings from other zeros": shift_zeros,
    "parts of joints swapped": swap_parts,
    "bodies split": split,
    "with inert parts": with_inert,
    "cables reversed": reversed_cables,
}
"""By name."""

DELAY = "later"
"""The name of `delay`, which takes a time besides."""
