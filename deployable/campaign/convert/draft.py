"""A structure in the making, of a compiled MuJoCo model."""

import math
import re
from typing import Any

import numpy as np

from fpm.structures.names import Names
from fpm.structures.reading import Problems
from fpm.structures.structure import Structure

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
    what is not taken, or not as it is; parts: names of parts; openings: of a joint of the
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

    def code(self, name: str) -> int:
        """Return the number of a member of an enumeration of the library: "mjtEq.mjEQ_WELD"."""
        group, _, member = name.partition(".")
        return int(getattr(getattr(self.library, group), member))

    def is_disabled(self, flag: str) -> bool:
        """Return whether a flag of the model's options, as "GRAVITY", is `disable`."""
        return bool(self.model.opt.disableflags & self.code(f"mjtDisableBit.mjDSBL_{flag}"))

    def name_of(self, kind: str, index: int) -> str:
        """Return the name of a "body", "joint", ... of the model; as "body3" if it has none."""
        code = self.code(f"mjtObj.mjOBJ_{kind.upper()}")
        return self.library.mj_id2name(self.model, code, int(index)) or f"{kind}{index}"

    def add(self, group: str, text: str, **keys: Any) -> str:
        """Add an entry under the allowed name that is nearest to `text`, and return that name."""
        name = re.sub(r"[^A-Za-z0-9_]", "_", text)
        name, entries = name if name[:1].isalpha() else f"n{name}", self.structure.table[group]
        while name in entries or not self._names.allows(
            name, "", 0, {"parameters": "let"}.get(group, group)
        ):
            name += "_"
        if name != text and group in ("bodies", "joints", "record"):
            self.notes.append(f"{text} is called {name} among {group}")
        getattr(self.structure, GROUPS[group])(name, **keys)
        return name

    def parameter(self, text: str, value: float, unit: str, owner: str) -> str:
        """Add a parameter with a value of something of the model, and return its name."""
        keys = {"value": digits([value])[0], "unit": unit, "description": f"of {owner}"}
        return self.add("parameters", text, **keys)

    def point(self, text: str, place: np.ndarray, *parts: int) -> str:
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
            point = self.point(self.name_of("site", index), place, part)
            self._sites[index] = {"part": self.parts[part], "at": point}
        return self._sites[index]

    def leave_out(self, subject: str, reason: str = "it has no equivalent") -> None:
        """Note that something is not taken."""
        self.notes.append(f"{subject} is not taken: {reason}")
