"""What acts on the openings of a drawn structure, and the numbers that it is drawn with."""

import random

import numpy as np

from evidence.attack.metamorphic.structure_text import Structure
from fpm.structures.statement import ON_SLIDES

HINGE_ACTIONS = ["torsion spring", "contact", "damper", "friction", "friction", "stop", "latch",
           "tabulated spring", "motor", "torque motor", "release"]  # fmt: skip
SLIDE_ACTIONS = ["spring", "damper", "friction", "stop", "latch", "tabulated spring", "motor",
           "torque motor", "release"]  # fmt: skip


class StructureDraft:
    """A structure, `structure`, while it is drawn. quiet: nothing moves it before a curve does, and
    curves begin at 0 (of a motor's opening perhaps at once with a rate); flat: all axes are one."""

    def __init__(self, rng: random.Random):
        self.rng, self.quiet = rng, rng.random() < 0.35
        self.flat = self.chance(0.3)
        self.structure: Structure = {"name": "drawn"}
        self.openings: dict[str, float] = {}
        self.slides: dict[str, float] = {}

    # -- numbers ------------------------------------------------------------------------------

    def chance(self, share: float) -> bool:
        return self.rng.random() < share

    def number(self, low: float, high: float) -> float:
        return round(self.rng.uniform(low, high), 4)

    def sign(self) -> float:
        return self.rng.choice([-1.0, 1.0])

    def vector(self, size: float) -> list[float]:
        return [self.number(-size, size) for _ in range(3)]

    def axis(self) -> list[float]:
        """Any direction, or one of the global axes; in a flat structure always the same."""
        if self.flat:
            return [0.0, 0.0, 1.0]
        if self.chance(0.3):
            return (self.sign() * np.eye(3)[self.rng.randrange(3)]).tolist()
        return self.vector(1.0)

    def normal_to(self, axis: list[float]) -> list[float]:
        """A direction normal to another."""
        normal = np.cross(axis, self.vector(1.0))
        return (normal / np.linalg.norm(normal)).tolist()

    # -- names --------------------------------------------------------------------------------

    def add(self, group: str, name: str, **entry) -> str:
        """An entry without the keys that are None."""
        items = {key: value for key, value in entry.items() if value is not None}
        self.structure.setdefault(group, {})[name] = items
        return name

    def point(self, name: str, position) -> str:
        self.structure.setdefault("points", {})[name] = [float(x) for x in position]
        return name

    def position(self, name: str) -> np.ndarray:
        return np.array(self.structure["points"][name])

    def name(self, group: str, letter: str) -> str:
        return f"{letter}{len(self.structure.get(group, {}))}"

    # -- what acts ----------------------------------------------------------------------------

    def curve(self, ends_at_0: bool = False) -> str:
        """A curve that begins at 0, there or a little later; a smooth one through three points."""
        start = self.rng.choice([0.0, 0.0, self.number(0.02, 0.1)])
        count = self.rng.choice([2, 3, 4])
        times = [start]
        for _ in range(count - 1):
            times.append(times[-1] + self.number(0.08, 0.3))
        values = [0.0, *(self.number(-1.0, 1.0) for _ in range(count - 1))]
        if ends_at_0:
            times.append(times[-1] + 0.1)
            values.append(0.0)
        name = self.name("curves", "f")
        smooth = {"smooth": "true"} if count == 3 else {}
        return self.add("curves", name, times=times, values=values, **smooth)

    def act(self, joint: str, opening: float, turns: bool) -> None:
        """Up to three different things on an opening."""
        kinds = HINGE_ACTIONS if turns else SLIDE_ACTIONS
        joint_type = self.structure["joints"].get(joint, {}).get("type")
        if joint_type != "revolute" or opening <= 0.0:
            kinds = [kind for kind in kinds if kind != "contact"]
        for kind in self.rng.sample(kinds, self.rng.choice([0, 1, 1, 2, 3])):
            entry = getattr(self, "_" + kind.replace(" ", "_"))(joint, opening)
            if not turns:
                entry = {ON_SLIDES.get(key, key): value for key, value in entry.items()}
            name = self.name("actions", "a")
            self.add("actions", name, type=kind, joint=joint, **entry)

    def _torsion_spring(self, joint: str, opening: float) -> dict:
        if self.quiet:
            return {"stiffness": self.number(1.0, 30.0), "rest": opening}
        if self.chance(0.3):
            return {"stiffness": self.number(1.0, 30.0), "preload": self.number(-5.0, 5.0)}
        return {"stiffness": self.number(1.0, 30.0), "rest": self.number(-1.0, 1.0)}

    _spring = _torsion_spring

    def _contact(self, joint: str, opening: float) -> dict:
        return {"stiffness": self.number(50.0, 300.0)}

    def _damper(self, joint: str, opening: float) -> dict:
        return {"damping": self.number(0.02, 0.3)}

    def _friction(self, joint: str, opening: float) -> dict:
        moment = self.number(0.02, 2.0)
        if joint not in self.slides and self.chance(0.5):
            return {"moment": moment, "sticks": "exactly"}
        damping = {"damping": self.number(0.0, 0.1)} if self.chance(0.5) else {}
        return {"moment": moment, "bristle_deflection": self.number(0.01, 0.05)} | damping

    def _stop(self, joint: str, opening: float) -> dict:
        lower, upper = opening - self.number(0.02, 0.3), opening + self.number(0.02, 0.3)
        ends = {"lower": lower, "upper": upper}
        if self.chance(0.5):
            del ends[self.rng.choice(list(ends))]
        return ends | {"stiffness": self.number(50.0, 300.0), "damping": self.number(0.0, 0.3)}

    def _latch(self, joint: str, opening: float) -> dict:
        angle = opening + self.sign() * self.number(0.02, 0.3)
        entry = {"angle": angle, "side": self.rng.choice(["below", "above", "either"])}
        if self.chance(0.3):
            entry["capture_range"] = self.number(0.001, 0.015)
        if self.chance(0.2):
            entry["max_capture_rate"] = self.number(0.5, 5.0)
        if self.chance(0.4):
            entry |= {"stiffness": self.number(30.0, 300.0), "damping": self.number(0.0, 0.3)}
            entry |= {"holds": self.rng.choice(["both ways", "one way"])}
        return entry

    def _tabulated_spring(self, joint: str, opening: float) -> dict:
        steps = [self.number(0.05, 0.3) for _ in range(self.rng.choice([2, 3, 4]))]
        angles = [opening - 0.4 + sum(steps[:k]) for k in range(len(steps) + 1)]
        size = 0.0 if self.quiet else 4.0
        return {"angles": angles, "moments": [self.number(-size, size) for _ in angles]}

    def _motor(self, joint: str, opening: float) -> dict:
        if self.chance(0.6):
            entry = {"turn": self.number(-2.0, 2.0), "curve": self.curve()}
        else:
            entry = {"rate": self.number(-3.0, 3.0), "curve": self.curve(ends_at_0=True)}
        if self.chance(0.6):
            return entry
        return entry | {"stiffness": self.number(10.0, 100.0), "damping": self.number(0.0, 0.3)}

    def _torque_motor(self, joint: str, opening: float) -> dict:
        entry = {"torque": self.number(-4.0, 4.0)}
        if self.quiet or self.chance(0.5):
            entry["curve"] = self.curve()
        if self.chance(0.5):
            entry["no_load"] = self.number(0.5, 5.0)
        return entry

    def _release(self, joint: str, opening: float) -> dict:
        entry = {"time": self.number(0.03, 0.3)}
        names = [name for name in self.openings if name != joint]
        if names and self.chance(0.3):
            watch = self.rng.choice(names)
            level = self.openings[watch] + self.sign() * self.number(0.02, 0.2)
            entry |= {"watch": watch, "level": level}
        if self.chance(0.6):
            return entry
        return entry | {"stiffness": self.number(30.0, 300.0), "damping": self.number(0.0, 0.3)}
