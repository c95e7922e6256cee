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


def measure(value: float, unit: str) -> str:
    """Return a value with its unit; an angle in degrees, where that is a short number."""
    degrees = f"{math.degrees(value):.6g}"
    if unit == "rad" and abs(math.radians(float(degrees)) - value) < 1e-13:
        return f"{degrees} deg"
    return f"{value:.12g} {unit}"


def vector(values: Any, size: float = 1.0) -> list[float]:
    """Return numbers rounded to 12 digits, and to 0 what is rounding beside `size`."""
    return [float(f"{x:.12g}") if abs(x) > 1e-13 * size else 0.0 for x in values]


class Sheet:
    """A structure of a compiled model. A part is the index of the body to which others are welded;
    0 is the ground. library: the module `mujoco`; model: MjModel; data: MjData at the start; notes:
    what is not taken, or not as it is; parts: names of parts; openings: name of that of a joint of
    the model, and whether it counts up (1.0) or down (-1.0); size: of the model (m)."""

    def __init__(self, library: Any, model: Any, data: Any, name: str):
        self.library, self.model, self.data = library, model, data
        has_gravity = model.opt.gravity.any() and not self.is_off("GRAVITY")
        self.structure = Structure(name, gravity=vector(model.opt.gravity) if has_gravity else None)
        self.structure.table |= {group: {} for group in GROUPS}
        self.notes: list[str] = []
        self.parts = {0: "ground"}
        self.openings: dict[int, tuple[str, float]] = {}
        self.size = float(np.abs(data.xpos).max(initial=0.0) + model.stat.extent)
        self._sites: dict[int, dict] = {}
        self._names = Names(Problems(""), {})

    def code(self, name: str) -> int:
        """Return the number of a member of one of the library's enumerations: "mjtEq.CONNECT"."""
        group, _, member = name.partition(".")
        prefix = next(iter(getattr(self.library, group).__members__)).partition("_")[0]
        return int(getattr(getattr(self.library, group), f"{prefix}_{member}"))

    def is_off(self, flag: str) -> bool:
        """Return whether an option's flag, as "GRAVITY", is `disable`."""
        return bool(self.model.opt.disableflags & self.code(f"mjtDisableBit.{flag}"))

    def name_of(self, kind: str, index: int) -> str:
        """Return the name of a "body", "joint", ... of the model; as "body3" if it has none."""
        code = self.code(f"mjtObj.{kind.upper()}")
        return self.library.mj_id2name(self.model, code, int(index)) or f"{kind}{index}"

    def add(self, group: str, text: str, **keys: Any) -> str:
        """Add an entry to a group under the allowed name that is nearest to `text`: returned."""
        name = re.sub(r"[^A-Za-z0-9_]", "_", text)
        name = name if name[:1].isalpha() else f"n{name}"
        while name in self.structure.table[group] or not self._names.allows(
            name, "", 0, number=True
        ):
            name += "_"
        if name != text and group in ("bodies", "joints"):
            self.notes.append(f"{text} is called {name} among {group}")
        getattr(self.structure, GROUPS[group])(name, **keys)
        return name

    def parameter(self, text: str, value: float, unit: str, of: str) -> str:
        """Add a parameter with the value of something of the model; returns its name."""
        return self.add("parameters", text, value=vector([value])[0], unit=unit, description=of)

    def point(self, text: str, place: np.ndarray, *parts: int) -> str:
        """Add a point (3,), m, of some parts; returns its name."""
        name = self.add("points", text, place=vector(place, self.size))
        for part in filter(None, parts):
            self.structure.table["bodies"][self.parts[part]].setdefault("points", []).append(name)
        return name

    def part(self, body: int) -> int:
        """Return the part to which a body belongs."""
        part = int(self.model.body_weldid[body])
        return 0 if self.model.body_mocapid[part] >= 0 else part

    def at_site(self, site: int) -> dict:
        """Return the part of a site, and its point there, which is added once."""
        if site not in self._sites:
            part, place = self.part(self.model.site_bodyid[site]), self.data.site_xpos[site]
            point = self.point(self.name_of("site", site), place, part)
            self._sites[site] = {"part": self.parts[part], "at": point}
        return self._sites[site]

    def left(self, what: str, reason: str = "it has no equivalent") -> None:
        """Note that something is not taken."""
        self.notes.append(f"{what} is not taken: {reason}")
