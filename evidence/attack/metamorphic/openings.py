"""Openings counted from another zero, the other way round, or between parts in the other order."""

import copy
import random
from collections.abc import Callable
from typing import Any

import numpy as np

from evidence.attack.metamorphic.image import Image, entries
from evidence.attack.metamorphic.structure_text import Structure
from fpm.elements.joints.joint_types import SUFFIXES, TYPES
from fpm.structures.statement import ON_SLIDES

OPENINGS = {name for name, type in TYPES.items() if type.openings}
FIRST_FIXED = {"planar", "pin in slot"}
"""Types of joints in which parts cannot change places."""


def draw_joints(structure: Structure, types: set[str], rng: random.Random) -> list[str]:
    """Some joints of these types, in any order; at least one where there is one."""
    names = [n for n, joint in entries(structure, "joints").items() if joint["type"] in types]
    return rng.sample(names, rng.randint(1, len(names))) if names else []


def shift_zeros(structure: Structure, rng: random.Random) -> Image | None:
    """Openings counted from another zero, or the other way round."""
    clone, maps = copy.deepcopy(structure), {}
    for name in draw_joints(structure, OPENINGS, rng):
        joint, ends = clone["joints"][name], ends_of(clone["joints"][name])
        if any(
            a["type"] == "contact" and a["joint"] == name
            for a in entries(clone, "actions").values()
        ):
            continue
        sign = rng.choice([1.0, -1.0])
        for key in ("axis", "other", "x"):
            if key in joint:
                joint[key] = (sign * np.array(joint[key])).tolist()
        for end in ends:  # y is normal to both
            maps[name + end] = 1.0 if end == "_y" else sign, rng.uniform(-2.0, 2.0)
        values = [
            s * x + c
            for x, (s, c) in zip(openings_of(joint), (maps[name + e] for e in ends), strict=True)
        ]
        _set_openings(joint, values)
    turn_actions(clone, maps)
    return Image(clone, opening_maps=maps) if maps else None


def ends_of(joint: dict) -> list[str]:
    return SUFFIXES.get(joint["type"], [""])


def openings_of(joint: dict) -> list[float]:
    if joint["type"] == "universal":
        return joint["openings"]
    return [joint[f"opening{end}"] for end in ends_of(joint)]


def _set_openings(joint: dict, values: list[float]) -> None:
    if joint["type"] == "universal":
        joint["openings"] = values
    else:
        joint |= {f"opening{e}": x for e, x in zip(ends_of(joint), values, strict=True)}


def swap_parts(structure: Structure, rng: random.Random) -> Image | None:
    """Parts of joints stated the other way round: with the axis turned round, the opening grows as
    before; else the other way."""
    clone, maps, names = copy.deepcopy(structure), {}, {}
    for name in draw_joints(structure, {*OPENINGS, "spherical", "fixed"} - FIRST_FIXED, rng):
        joint = clone["joints"][name]
        joint["parts"].reverse()
        if joint["type"] == "universal":
            joint["axis"], joint["other"] = [[-x for x in joint[k]] for k in ("other", "axis")]
            joint["openings"].reverse()
            names |= {name + "_axis": name + "_other", name + "_other": name + "_axis"}
        elif joint["type"] in OPENINGS:
            has_contact = any(
                a["type"] == "contact" and a["joint"] == name
                for a in entries(clone, "actions").values()
            )
            if has_contact or rng.random() < 0.5:
                joint["axis"] = [-x for x in joint["axis"]]
            else:
                maps |= {name + end: (-1.0, 0.0) for end in ends_of(joint)}
                _set_openings(joint, [-x for x in openings_of(joint)])
    turn_actions(clone, maps)
    for action in entries(clone, "actions").values():
        for key in action.keys() & {"joint", "watch"}:
            action[key] = names.get(action[key], action[key])
        if "joints" in action:
            action["joints"] = [names.get(joint, joint) for joint in action["joints"]]
    for cable in entries(clone, "cables").values():
        if "drum" in cable:
            cable["drum"] = names.get(cable["drum"], cable["drum"])
    return Image(clone, opening_maps=maps, names=names)


SIDES = {"below": "above", "above": "below", "either": "either"}
AFFINE = {"rest", "lower", "upper", "angle", "angles", "start", "hold"}
ODD = {"preload", "moments", "turn", "rate", "torque"}
HINGE_TYPES = {slide: hinge for hinge, slide in ON_SLIDES.items() if hinge != "torque"}


def turn_actions(structure: Structure, maps: dict[str, tuple[float, float]]) -> None:
    """Restate what acts on openings that are counted otherwise."""
    for cable in entries(structure, "cables").values():
        if "drum" in cable:
            cable["radius"] *= maps.get(cable["drum"], (1.0, 0.0))[0]
    for action in entries(structure, "actions").values():
        if action["type"] == "loop":
            signs = [maps.get(joint, (1.0, 0.0))[0] for joint in action["joints"]]
            action["radii"] = [s * r for s, r in zip(signs, action["radii"], strict=True)]
            continue
        sign, zero = maps.get(action.get("watch"), (1.0, 0.0))
        if "level" in action:
            action["level"] = sign * action["level"] + zero
        sign, zero = maps.get(action["joint"], (1.0, 0.0))
        _turn_action(action, sign, zero)


def _turn_action(action: dict, sign: float, zero: float) -> None:
    for key in list(action):
        role = key
        if action["type"] not in ("torque motor", "friction"):
            role = HINGE_TYPES.get(key, key)
        elif action["type"] == "torque motor" and key == "force":
            role = "torque"
        value = action[key]
        if role in AFFINE:
            action[key] = _apply(value, lambda x: sign * x + zero)
        elif role in ODD:
            action[key] = _apply(value, lambda x: sign * x)
    if sign < 0.0:
        _turnends_of(action)


def _apply(value: Any, change: Callable[[float], float]) -> Any:
    return [change(x) for x in value] if isinstance(value, list) else change(value)


def _turnends_of(action: dict) -> None:
    """What comes first comes last."""
    if action["type"] == "stop":
        ends = {"lower": action.pop("upper", None), "upper": action.pop("lower", None)}
        action |= {key: value for key, value in ends.items() if value is not None}
    if "side" in action:
        action["side"] = SIDES[action["side"]]
    if action["type"] == "tabulated spring":
        for value in action.values():
            if isinstance(value, list):
                value.reverse()
