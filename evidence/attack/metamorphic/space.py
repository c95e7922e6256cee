"""Structures turned, and mirrored, as a whole."""

import copy
import random

import numpy as np
from scipy.spatial.transform import Rotation

from evidence.attack.metamorphic.image import Image, entries
from evidence.attack.metamorphic.openings import turn_actions
from evidence.attack.metamorphic.structure_text import Structure
from fpm.structures.statement import SLIDE
from fpm.structures.statements import GROUPS

POLAR = {"gravity", "force", "velocity", "up", "x", "normal", "wind"}
AXIAL = {"moment", "spin", "axis", "other"}


def rotate(structure: Structure, rng: random.Random) -> Image | None:
    """Turned as a whole, and moved; where some global axes hold it, by a turn of the cube's."""
    supports = entries(structure, "supports").values()
    turns = Rotation.random(random_state=rng.randrange(2**32)).as_matrix()
    if any(
        letters != "xyz"
        for entry in supports
        for letters in (entry["translations"], entry["rotations"])
    ):
        turns = np.round(rng.choice(Rotation.create_group("O").as_matrix()))
    shift = np.array([rng.uniform(-2.0, 2.0) for _ in range(3)])
    return Image(_in_space(structure, turns, shift), turns, shift)


def mirror(structure: Structure, rng: random.Random) -> Image:
    """Its mirror image in a plane normal to a global axis."""
    matrix, maps = np.eye(3), {}
    matrix[(k := rng.randrange(3), k)] = -1.0
    clone = _in_space(structure, matrix, np.zeros(3))
    for name, joint in entries(clone, "joints").items():
        if joint["type"] == "cylindrical":  # whose axis is that of its turn
            maps[f"{name}_slide"] = -1.0, 0.0
            joint["opening_slide"] *= -1.0
        elif joint["type"] == "screw":
            joint["pitch"] *= -1.0
    turn_actions(clone, maps)
    return Image(clone, matrix, opening_maps=maps)


def _in_space(structure: Structure, matrix: np.ndarray, shift: np.ndarray) -> Structure:
    """Every vector times a matrix, those of turns times its determinant as well."""
    clone = copy.deepcopy(structure)
    clone["points"] = {n: (matrix @ point + shift).tolist() for n, point in clone["points"].items()}
    polar, axial = matrix, np.linalg.det(matrix) * matrix
    if "gravity" in clone:
        clone["gravity"] = (polar @ clone["gravity"]).tolist()
    for group in clone.keys() & GROUPS.keys():
        for entry in clone[group].values():
            for key in entry.keys() & (POLAR | AXIAL):
                if isinstance(entry[key], list):
                    is_polar = key in POLAR or (key == "axis" and entry["type"] == SLIDE)
                    entry[key] = ((polar if is_polar else axial) @ entry[key]).tolist()
            for key in entry.keys() & {"translations", "rotations"}:
                entry[key] = _turned_letters(entry[key], matrix)
    return clone


def _turned_letters(letters: str, matrix: np.ndarray) -> str:
    if letters in ("none", "xyz"):
        return letters
    images = ["xyz"[int(np.abs(matrix[:, "xyz".index(letter)]).argmax())] for letter in letters]
    return "".join(sorted(images))
