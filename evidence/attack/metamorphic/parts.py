"""Structures of other parts that do the same."""

import copy
import random
from typing import Any

import numpy as np

from evidence.attack.metamorphic.image import Image, entries
from evidence.attack.metamorphic.openings import OPENINGS, draw_joints, ends_of
from evidence.attack.metamorphic.random_structures import GROUND
from evidence.attack.metamorphic.structure_text import Structure, is_slide
from fpm.structures.statement import ON_SLIDES


def split(structure: Structure, rng: random.Random) -> Image | None:
    """A body as two that are fixed to each other, each with a share of its mass; together with all
    their points where that share has the same centre, or side by side along x."""
    drives = {entry["part"] for entry in entries(structure, "drives").values()}
    bodies = [name for name in entries(structure, "bodies") if name not in drives]
    if not bodies or any(map(_is_damped_for_its_parts, entries(structure, "actions").values())):
        return None
    name = rng.choice(bodies)
    clone = copy.deepcopy(structure)
    first, second, twin = clone["bodies"][name], copy.deepcopy(clone["bodies"][name]), f"{name}s"
    share = rng.uniform(0.2, 0.8)
    middle, is_apart = first["centre"], "inertia" in first and rng.random() < 0.5
    is_held = any(part["part"] == name for part in entries(clone, "supports").values())
    is_apart = is_apart and not is_held
    if is_apart:
        share = 0.5
        _side_by_side(clone, first, second, middle)
    for body, part in ((first, 1.0 - share), (second, share)):
        body["mass"] *= part
        if "inertia" in body:
            body["inertia"] = [part * x for x in body["inertia"]]
    clone["bodies"][twin] = second
    # The joint is where both have a point that is the centre of neither's particle, or of both.
    clone["joints"] = {
        **entries(clone, "joints"),
        f"{name}s": {"type": "fixed", "parts": [name, twin], "at": middle},
    }
    moved_points = {point for point in first["points"] if point != middle and rng.random() < 0.5}
    for joint_name, joint in clone["joints"].items():
        if joint_name != f"{name}s" and joint["at"] in moved_points:
            joint["parts"] = [twin if part == name else part for part in joint["parts"]]
    stations = {"cables": "through", "struts": "between"}
    for group in ("loads", "record", *stations):
        for entry in entries(clone, group).values():
            for station in entry[stations[group]] if group in stations else [entry]:
                if station["part"] == name and station["at"] in moved_points:
                    station["part"] = twin
    if name_of := [
        key
        for key, motion in entries(clone, "initial_velocities").items()
        if motion["part"] == name
    ]:
        motions = clone["initial_velocities"]
        motions[f"{name}s"] = motions[name_of[0]] | {"part": twin}
    # The work of damping is counted along the step's way of free bodies, at its end of joined ones.
    return Image(clone, is_exact=not is_apart and "damping" not in clone)


def _is_damped_for_its_parts(action: dict) -> bool:
    """Whether it is friction whose damping, left out, follows from the two bodies at the joint."""
    return action["type"] == "friction" and not action.keys() & {"sticks", "damping"}


def _side_by_side(structure: Structure, first: dict, second: dict, middle: str) -> None:
    """Move halves of a body apart along its axis x, by a fifth of what its inertia allows."""
    axis = np.array(first["x"]) / np.linalg.norm(first["x"])
    inertia = np.array(first["inertia"])
    room = max(0.0, min(inertia[1], inertia[2], 0.5 * (inertia[1] + inertia[2] - inertia[0])))
    shift = np.sqrt(0.2 * room / first["mass"])
    for k, (body, sign) in enumerate(((first, 1.0), (second, -1.0))):
        point = f"{middle}{'ab'[k]}"
        place = np.array(structure["points"][middle]) + sign * shift * axis
        structure["points"][point] = place.tolist()
        body["centre"], body["points"] = point, [*body["points"], middle]
        body["inertia"] = (inertia - first["mass"] * shift**2 * np.array([0.0, 1.0, 1.0])).tolist()


def with_inert(structure: Structure, rng: random.Random) -> Image:
    """With what does nothing: springs without stiffness, latches and stops out of reach, slack
    cables, and a body of its own on a hinge to the ground."""
    clone = copy.deepcopy(structure)
    clone["points"] |= {"i0": [3.0, 1.0, 0.0], "i1": [3.0, 1.5, 0.0]}
    actions = clone.setdefault("actions", {})
    joint_names = draw_joints(clone, OPENINGS, rng)
    for k, joint in enumerate(n + end for n in joint_names for end in ends_of(clone["joints"][n])):
        slides = is_slide(clone, joint)
        present = {action["type"] for action in actions.values() if action.get("joint") == joint}
        for kind in rng.sample([kind for kind in INERT if kind.split(",")[0] not in present], 2):
            entry = INERT[kind]
            if slides:
                entry = {ON_SLIDES.get(key, key): value for key, value in entry.items()}
            action = "spring" if slides and kind == "torsion spring" else kind.split(",")[0]
            if not (slides and "sticks" in entry):
                actions[f"i{kind.split()[0][:3]}{k}"] = {"type": action, "joint": joint, **entry}
    if rng.random() < 0.5:
        body = {"mass": 1.0, "centre": "i1", "points": ["i0"], "inertia": [0.1, 0.1, 0.1]}
        clone.setdefault("bodies", {})["ib"] = body
        joint = {"type": "revolute", "parts": [GROUND, "ib"], "at": "i0", "axis": [0.0, 0.0, 1.0]}
        clone.setdefault("joints", {})["ij"] = joint
    part, point = next(iter(entries(clone, "record").values())).values()
    stations = [{"part": part, "at": point}, {"part": GROUND, "at": "i0"}]
    if rng.random() < 0.5:
        clone.setdefault("cables", {})["ik"] = {"through": stations, "EA": 10.0, "rest": 99.0}
    return Image(clone, omits=frozenset({"energy"}))


FAR_OPENING = 40.0
INERT: dict[str, dict[str, Any]] = {
    "torsion spring": {"stiffness": 0.0},
    "damper": {"damping": 0.0},
    "friction, exact": {"moment": 0.0, "sticks": "exactly"},
    "stop": {"upper": FAR_OPENING, "stiffness": 10.0},
    "latch": {"angle": FAR_OPENING, "stiffness": 10.0},
    "latch, exact": {"angle": FAR_OPENING},
    "torque motor": {"torque": 0.0},
    "tabulated spring": {"angles": [0.0, 1.0], "moments": [0.0, 0.0]},
}


def reversed_cables(structure: Structure, rng: random.Random) -> Image | None:
    """Cables without a winch or drum stated from their other ends."""
    clone = copy.deepcopy(structure)
    all_cables = entries(clone, "cables").values()
    cables = [cable for cable in all_cables if not {"reel", "drum"} & cable.keys()]
    for cable in cables:
        cable["through"].reverse()
    # That of a cable which rubs is told at its first point, from which stretches count.
    omits = frozenset({"cable_tension", "stretch_tension", "cable_slip"})
    return Image(clone, is_exact=False, omits=omits) if cables else None
