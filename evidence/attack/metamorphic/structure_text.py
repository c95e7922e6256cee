"""Structures as mappings of plain numbers in SI units, and as text; numbers by their units.

What is known of a number (its unit, and that it is one) is what the language says of its key."""

from collections.abc import Callable
from typing import Any

import yaml

from fpm.declare import Key, Number
from fpm.elements.joints.joint_types import TYPES
from fpm.structures.keys import ListKey, OpeningKey, VectorKey
from fpm.structures.model import overall
from fpm.structures.statements import GROUPS

Structure = dict[str, Any]
Change = Callable[[float, str], Any]
"""Of a number and its unit."""


def keys_of(structure: Structure, group: str, entry: dict) -> dict[str, Key]:
    """The keys that an entry of a group may have, on a slide those of slides."""
    statement = GROUPS[group][entry.get("type", "")]
    slides = [
        key
        for key, kind in statement.keys.items()
        if isinstance(kind, OpeningKey) and is_slide(structure, entry.get(key, ""))
    ]
    return {name: kind for name, (_, kind) in statement.for_slides(slides).items()}


def is_slide(structure: Structure, name: str) -> bool:
    """Whether an opening is a length."""
    return any(
        name == joint + opening.suffix and bool(opening.direction)
        for joint, entry in structure.get("joints", {}).items()
        for opening in TYPES[entry["type"]].openings
    )


def map_numbers(structure: Structure, change: Change) -> Structure:
    """The structure with all its numbers changed; `change` is called with each and its unit."""
    clone = dict(structure)
    for key, kind in overall.keys.items():
        if key in clone:
            clone[key] = _map_value(clone[key], kind, change)
    if "points" in clone:
        clone["points"] = {
            n: point if isinstance(point, str) else [change(x, "m") for x in point]
            for n, point in clone["points"].items()
        }
    for group in clone.keys() & GROUPS.keys():
        clone[group] = {
            name: {
                key: _map_value(value, keys.get(key), change)
                for keys in [keys_of(structure, group, entry)]
                for key, value in entry.items()
            }
            for name, entry in clone[group].items()
        }
    return clone


def _map_value(value: Any, kind: Key | None, change: Change) -> Any:
    if isinstance(kind, ListKey) and isinstance(kind.kind, Number):
        return [change(x, kind.kind.unit) for x in value]
    if isinstance(kind, VectorKey):
        return [change(x, kind.unit) for x in value]
    is_number = isinstance(kind, Number) and not kind.is_whole
    return change(value, kind.unit) if is_number else value


class _Dumper(yaml.SafeDumper):
    """Writes out what stands twice."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def as_text(structure: Structure) -> str:
    """The structure as a file; angles say their unit."""
    numbers = map_numbers(structure, lambda x, unit: f"{x!r} rad" if unit == "rad" else x)
    return yaml.dump(numbers, Dumper=_Dumper, sort_keys=False, default_flow_style=None, width=100)
