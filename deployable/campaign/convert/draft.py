"""A structure in the making, of a compiled MuJoCo model, and what is the same in both."""

import math
import re
from collections.abc import Iterable
from typing import Any

import numpy as np

from fpm import elements as e
from fpm.structures.names import Names
from fpm.structures.reading import Problems
from fpm.structures.structure import Structure

JOINTS: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "fixed": ("", "", ()), "spherical": ("b", "", ("",)), "revolute": ("h", "", ("",)),
    "prismatic": ("s", "", ("",)), "universal": ("hh", "n", ("_axis", "_other")),
    "cylindrical": ("sh", "p", ("_slide", "_turn")),
    "pin in slot": ("sh", "n", ("_slide", "_turn")),
    "planar": ("ssh", "nnn", ("_x", "_y", "_turn")),
}  # fmt: skip
"""Joints by type: the balls, hinges and slides from the first part to the second, their axes that
are normal (n) or parallel (p), pair by pair, and the suffixes of their openings."""

ACTIONS: dict[str, tuple] = {
    "stiffness": (e.TorsionSpring, "stiffness", "torsion spring", "spring", "N m/rad", "N/m"),
    "damping": (e.Damper, "damping", "damper", "damper", "N m s/rad", "N s/m"),
    "frictionloss": (e.Friction, "moment", "friction", "friction", "N m", "N"),
    "motor": (e.TorqueMotor, "torque", "torque motor", "torque motor", "N m", "N"),
}
"""What acts on a joint, by MuJoCo's word: element, its value, type and unit on angle and slide."""

LINEAR = {"moment": "force", "torque": "force"}  # keys that are called otherwise on a slide

GROUPS = {
    "parameters": "parameter", "points": "point", "bodies": "body", "joints": "joint",
    "actions": "action", "cables": "cable", "struts": "strut",
    "initial_velocities": "initial_velocity", "record": "record",
}  # fmt: skip
"""Groups of a structure's file, in this order, with the methods that add an entry."""


def with_unit(value: float, unit: str) -> str:
    """Return a value with its unit; an angle in degrees, where that is a short number."""
    degrees = f"{math.degrees(value):.6g}"
    is_short = unit == "rad" and abs(math.radians(float(degrees)) - value) < 1e-13
    return f"{degrees} deg" if is_short else f"{value:.12g} {unit}"


def digits(values: Any, size: float = 1.0) -> list[float]:
    """Return numbers with 12 digits, and 0 for those that are rounding beside `size`."""
    return [float(f"{x:.12g}") if abs(x) > 1e-13 * size else 0.0 for x in values]


class Draft:
    """A structure of a compiled model. A part is the index of the body to which others are welded;
    0 is the ground. library: the module `mujoco`; model, data: MjModel, MjData at the start; notes:
    what is not taken, or not as it is; parts: names of parts; openings: of a hinge or slide of the
    model: name, whether it counts up (1.0) or down (-1.0), unit; size: of the model (m)."""

    def __init__(self, library: Any, model: Any, data: Any, name: str):
        self.library, self.model, self.data = library, model, data
        is_free = self.is_disabled("GRAVITY") or not model.opt.gravity.any()
        self.structure = Structure(name, gravity=None if is_free else digits(model.opt.gravity))
        self.structure.table |= {group: {} for group in GROUPS}
        self.notes: list[str] = []
        self.parts = {0: "ground"}
        self.openings: dict[int, tuple[str, float, str]] = {}
        self.size = float(np.abs(data.xpos).max(initial=0.0) + model.stat.extent)
        self._sites: dict[int, dict] = {}
        self._names = Names(Problems(""), {})

    def is_disabled(self, flag: str) -> bool:
        """Return whether a flag of the model's options, as "GRAVITY", is `disable`."""
        bit = getattr(self.library.mjtDisableBit, f"mjDSBL_{flag}")
        return bool(self.model.opt.disableflags & int(bit))

    def name_of(self, kind: str, index: int) -> str:
        """Return the name of a "body", "joint", ... of the model; as "body3" if it has none."""
        code = getattr(self.library.mjtObj, f"mjOBJ_{kind.upper()}")
        return self.library.mj_id2name(self.model, int(code), int(index)) or f"{kind}{index}"

    def add(self, group: str, text: str, **keys: Any) -> str:
        """Add an entry under the allowed name that is nearest to `text`, and return that name."""
        name, entries = re.sub(r"[^A-Za-z0-9_]", "_", text), self.structure.table[group]
        name, room = name if name[:1].isalpha() else f"n{name}", group.replace("parameters", "let")
        while name in entries or not self._names.allows(name, "", 0, room):
            name += "_"
        if name != text and group in ("bodies", "joints", "record"):
            self.notes.append(f"{text} is called {name} among {group}")
        getattr(self.structure, GROUPS[group])(name, **keys)
        return name

    def parameter(self, text: str, value: float, unit: str, owner: str) -> str:
        """Add a parameter with a value of something of the model, and return its name."""
        keys = {"value": digits([value])[0], "unit": unit, "description": f"of {owner}"}
        return self.add("parameters", text, **keys)

    def act(self, joint: int, owner: str, word: str, value: float, **keys: Any) -> None:
        """Add what acts on the opening of a joint, with a parameter for its value: a motor, or
        what is not 0."""
        opening, _, unit = self.openings[joint]
        _, key, *words = ACTIONS[word]
        type_, value_unit = words[unit == "m" :: 2]
        key = LINEAR.get(key, key) if unit == "m" else key
        if value or word == "motor":
            name = f"{owner}_{'friction' if word == 'frictionloss' else key}"
            keys[key] = self.parameter(name, value, value_unit, owner)
            self.add("actions", f"{owner}_{type_.split()[-1]}", type=type_, joint=opening, **keys)

    def point(self, text: str, place: np.ndarray, parts: Iterable[int]) -> str:
        """Add a point (3,), m, of some parts, and return its name."""
        name = self.add("points", text, place=digits(place, self.size))
        for part in filter(None, parts):
            self.structure.table["bodies"][self.parts[part]].setdefault("points", []).append(name)
        return name

    def part(self, body: int) -> int:
        """Return the part to which a body belongs."""
        part = int(self.model.body_weldid[body])
        return 0 if self.model.body_mocapid[part] >= 0 else part

    def site(self, index: int) -> dict:
        """Return the part of a site and its point there, which is added once."""
        if index not in self._sites:
            part, place = self.part(self.model.site_bodyid[index]), self.data.site_xpos[index]
            point = self.point(self.name_of("site", index), place, [part])
            self._sites[index] = {"part": self.parts[part], "at": point}
        return self._sites[index]

    def leave_out(self, subject: str, reason: str = "it has no equivalent") -> None:
        """Note that something is not taken."""
        self.notes.append(f"{subject} is not taken: {reason}")
