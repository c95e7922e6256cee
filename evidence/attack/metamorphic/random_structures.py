"""Structures drawn at random: chains, trees and loops of rigid bodies and bars.

All sizes are of the order of one, in metres, kilograms and seconds, so that what is drawn moves by
tenths of a radian in `DURATION`. What the language refuses is drawn again by the caller."""

import random
from itertools import pairwise

import numpy as np

from evidence.attack.metamorphic.joint_actions import StructureDraft
from evidence.attack.metamorphic.structure_text import Structure
from fpm.elements.joints.joint_types import SUFFIXES, TYPES

DURATION = 0.4
"""Time (s) in which a drawn structure is to show what it does."""

GROUND = "ground"
FLAT_SLIDERS, SLIDERS = ("planar", "pin in slot"), ("cylindrical", "screw")
"""Joints whose second part slides and turns: in a plane, and in space."""


class Draw(StructureDraft):
    """A whole structure."""

    def __init__(self, rng: random.Random):
        super().__init__(rng)
        self.parts: list[str] = []

    # -- the whole ----------------------------------------------------------------------------

    def draw(self) -> Structure:
        with_bars = self.chance(0.2)
        for _ in range(self.rng.choice([1, 2, 2, 3, 3, 4])):
            self.part(with_bars)
        if self.chance(0.3) and len(self.parts) > 2:
            self.close()
        for name, opening in self.openings.items():
            self.act(name, opening, turns=True)
        for name, opening in self.slides.items():
            self.act(name, opening, turns=False)
        if len(self.openings) > 1 and self.chance(0.25):
            self.loop()
        for _ in range(self.rng.choice([0, 0, 1, 2])):
            self.load()
        for _ in range(self.rng.choice([0, 0, 1, 2])):
            self.cable()
        self.world()
        prescribed_parts = {drive["part"] for drive in self.structure.get("drives", {}).values()}
        parts = [part for part in self.parts if part not in prescribed_parts]
        if parts and self.chance(0.3):
            self.drag(self.rng.choice(parts))
        if parts and self.chance(0.3):
            self.strut(self.rng.choice(parts))
        if "cables" in self.structure and self.openings and self.chance(0.5):
            self.drum()
        return self.structure

    def part(self, with_bars: bool) -> None:
        """A further part on one that is there, or the first, on the ground or free."""
        k, is_first = len(self.parts), not self.parts
        is_free = is_first and self.chance(0.25)
        parent = GROUND if is_first or self.chance(0.2) else self.rng.choice(self.parts)
        start = np.zeros(3) if parent == GROUND else self.position(f"t{parent[1:]}")
        p = self.point(f"p{k}", start + self.vector(0.3))
        c = self.point(f"c{k}", self.position(p) + self.flatten(self.vector(0.4)))
        t = self.point(f"t{k}", self.position(c) + self.flatten(self.vector(0.4)))
        if parent != GROUND:
            self.give(parent, p)
        name = f"b{k}"
        if with_bars and not is_free and self.chance(0.5):
            self.bar(name, [p, c, t])
        else:
            self.body(name, c, [p, t])
        self.parts.append(name)
        for point in (c, t):
            self.add("record", point, part=name, at=point)
        if is_free:
            self.hold_or_move(name, c)
        else:
            self.joint(parent, name, p)

    def flatten(self, vector: list[float]) -> list[float]:
        return [*vector[:2], 0.0] if self.flat else vector

    def give(self, part: str, point: str) -> None:
        """Let a part have a point."""
        if part in self.structure.get("bodies", {}):
            self.structure["bodies"][part]["points"].append(point)
        else:
            bar = self.structure["bars"][part]
            bar.setdefault("carries", {})[point] = bar["through"][-1]

    def body(self, name: str, centre: str, points: list[str]) -> None:
        x = self.axis()
        edges = [self.number(0.2, 0.6) for _ in range(3)]
        mass = self.number(0.5, 3.0)
        moments = [mass * (edges[k - 1] ** 2 + edges[k - 2] ** 2) / 12 for k in range(3)]
        shape = {"box": edges} if self.chance(0.3) else {"inertia": moments}
        self.add("bodies", name, mass=mass, centre=centre, points=points, x=x,
                 up=self.normal_to(x), **shape)  # fmt: skip

    def bar(self, name: str, points: list[str]) -> None:
        """A bar of so light and soft a material that the stable step is some milliseconds."""
        self.add("materials", "foam", E=self.number(5e4, 2e5), rho=100.0)
        self.add("sections", "round", type="tube", diameter=0.2, thickness=0.02)
        self.add("sections", "flat", type="rectangle", width=0.2, height=0.12)
        section = self.rng.choice(["round", "flat"])
        line = self.position(points[2]) - self.position(points[0])
        self.add("bars", name, through=points, section=section, material="foam", elements=1,
                 up=self.normal_to(line.tolist()), inertia_scale=20.0)  # fmt: skip
        self.add("masses", f"m{name}", part=name, at=points[2], mass=0.5, inertia=0.02)

    def joint(self, parent: str, part: str, point: str) -> None:
        kinds = ["revolute"] * (6 if self.flat else 4) + ["prismatic"]
        kinds += [] if self.flat else ["universal", "spherical"]
        type, name, parts = self.rng.choice(kinds), f"j{part[1:]}", [parent, part]
        opening = self.number(0.1, 0.6) * (1.0 if self.chance(0.5) else self.sign())
        if self.chance(0.5):
            parts.reverse()
        axis = self.axis()
        if type == "prismatic":
            type = self.rng.choice(["prismatic", *FLAT_SLIDERS, *([] if self.flat else SLIDERS)])
        if type == "revolute":
            self.add("joints", name, type=type, parts=parts, at=point, axis=axis, opening=opening)
            self.openings[name] = opening
        elif type == "prismatic":
            axis = self.normal_to(axis) if self.flat else axis
            self.add("joints", name, type=type, parts=parts, at=point, axis=axis, opening=opening)
            self.slides[name] = opening
        elif type == "universal":
            openings = [opening, self.number(-0.5, 0.5)]
            self.add("joints", name, type=type, parts=parts, at=point, axis=axis,
                     other=self.normal_to(axis), openings=openings)  # fmt: skip
            ends = SUFFIXES["universal"]
            self.openings |= {name + end: value for end, value in zip(ends, openings, strict=True)}
        elif type in (*FLAT_SLIDERS, *SLIDERS):
            self.slider(name, parts, point, axis, type)
        else:
            self.add("joints", name, type=type, parts=parts, at=point)

    def slider(self, name: str, parts: list[str], point: str, axis: list[float], type: str) -> None:
        """A joint whose second part slides and turns."""
        values = {}
        for suffix, direction in TYPES[type].openings:
            values[f"opening{suffix}"] = opening = self.number(-0.5, 0.5)
            (self.slides if direction else self.openings)[name + suffix] = opening
        if type in FLAT_SLIDERS:
            values["x"] = self.normal_to(axis)
        if type == "screw":
            values["pitch"] = self.sign() * self.number(0.2, 2.0)
        self.add("joints", name, type=type, parts=parts, at=point, axis=axis, **values)

    def close(self) -> None:
        """Tie the last part's end to an earlier part, or to the ground, by a ball."""
        last = self.parts[-1]
        partner = self.rng.choice([GROUND, *self.parts[:-1]])
        point = f"t{last[1:]}"
        if partner != GROUND:
            self.give(partner, point)
        self.add("joints", "j_ball", type="spherical", parts=[last, partner], at=point)

    def hold_or_move(self, name: str, centre: str) -> None:
        """Of a first part without a joint: free and perhaps moving, driven, or held."""
        state = self.rng.choice(["free", "driven", "held"])
        if state == "driven":
            self.add("drives", "d0", part=name, at=centre, velocity=self.vector(1.0),
                     spin=self.vector(1.0), curve=self.curve())  # fmt: skip
        elif state == "held":
            loose = self.chance(0.5)
            self.add("supports", "s0", part=name, at=centre,
                     translations=self.rng.choice(["xy", "z", "none"]) if loose else "xyz",
                     rotations=self.rng.choice(["yz", "none"]) if loose else "xyz"
                     )  # fmt: skip

    def loop(self) -> None:
        """A cable over pulleys on two openings."""
        joints = self.rng.sample(list(self.openings), 2)
        preload = self.number(1.0, 10.0) if self.chance(0.5) else None
        radii = [self.number(0.05, 0.2), self.sign() * self.number(0.05, 0.2)]
        self.add("actions", "belt", type="loop", joints=joints, radii=radii,
                 stiffness=self.number(500.0, 3000.0), preload=preload)  # fmt: skip

    def load(self) -> None:
        part = self.rng.choice(self.parts)
        curve = self.curve() if self.quiet or self.chance(0.5) else None
        self.add("loads", self.name("loads", "l"), part=part, at=self.end_of(part),
                 force=self.vector(5.0), moment=self.vector(1.0), curve=curve)  # fmt: skip

    def drag(self, part: str) -> None:
        """Air around a part: on a rod, a plate along which its line is, or at a point. Not on one
        that is driven: where nothing else moves, no energy is held to which errors are relative."""
        wind = [0.0] * 3 if self.quiet else self.vector(2.0)
        ends = [f"{letter}{part[1:]}" for letter in self.rng.choice(["c", "ct", "pt"])]
        plate = {"normal": self.axis()} if self.chance(0.4) else {}
        self.add("drags", self.name("drags", "w"), part=part, through=ends, wind=wind, **plate,
                 area=self.number(0.1, 1.0), coefficient=1.2, density=1.2)  # fmt: skip

    def strut(self, part: str) -> None:
        """A strut from the ground to the end of a part that is not driven, as for drag; a damper
        only where nothing may move."""
        hook = self.point(self.name("points", "g"), [2.0, 1.0, 0.5])
        end = self.end_of(part)
        length = float(np.linalg.norm(self.position(hook) - self.position(end)))
        spring = {
            "type": "spring",
            "stiffness": self.number(5.0, 50.0),
            "rest": length * self.number(0.7, 1.3),
            "acts": self.rng.choice(["both ways", "push", "pull"]),
        }
        table = {
            "type": "tabulated spring",
            "lengths": [0.8 * length, length, 1.2 * length],
            "forces": [0.0, 0.0, 0.0] if self.quiet else [self.number(-5.0, 5.0) for _ in range(3)],
            "damping": self.number(0.0, 2.0),
        }
        ends = [{"part": GROUND, "at": hook}, {"part": part, "at": end}]
        self.add(
            "struts",
            self.name("struts", "s"),
            between=ends,
            **(table if self.quiet else self.rng.choice([spring, table])),
        )

    def end_of(self, part: str) -> str:
        return self.rng.choice("ct") + part[1:]

    def cable(self) -> None:
        """A cable between points of parts, and perhaps of the ground."""
        stations = [{"part": part, "at": self.end_of(part)} for part in self.parts]
        for _ in range(2):
            hook = self.point(self.name("points", "g"), self.vector(1.5))
            stations.append({"part": GROUND, "at": hook})
        self.rng.shuffle(stations)
        path = stations[: self.rng.choice([2, 3, 3, 4])]
        length = sum(
            float(np.linalg.norm(self.position(start["at"]) - self.position(stop["at"])))
            for start, stop in pairwise(path)
        )
        rest = length * self.number(1.001 if self.quiet else 0.9, 1.05)
        friction = self.number(0.02, 0.3) if self.chance(0.6) else None
        reel = {"reel": self.number(0.0, 0.3), "curve": self.curve()} if self.chance(0.4) else {}
        self.add("cables", self.name("cables", "k"), through=path, EA=self.number(20.0, 300.0),
                 rest=rest, friction=friction if path[2:] else None, **reel)  # fmt: skip

    def drum(self) -> None:
        """A drum on the opening of a joint for a cable without a winch."""
        cables = [c for c in self.structure["cables"].values() if "reel" not in c]
        if cables:
            radius = self.rng.choice([-1, 1]) * self.number(0.01, 0.1)
            self.rng.choice(cables).update(drum=self.rng.choice([*self.openings]), radius=radius)

    def world(self) -> None:
        """Gravity, damping, and motions at the start that no joint forbids."""
        if not self.quiet and self.chance(0.6):
            self.structure["gravity"] = self.flatten(self.vector(10.0))
        if "bars" in self.structure and self.chance(0.3):
            self.structure["viscosity"] = self.number(0.05, 0.5)
        if "bars" in self.structure and self.chance(0.3):
            self.structure["materials"]["foam"]["stiffness_damping"] = self.number(1e-4, 5e-4)
        if self.chance(0.2):
            self.structure["damping"] = self.number(0.1, 1.0)
        supports = {"supports", "drives"} & self.structure.keys()
        if not (self.quiet or supports or self.chance(0.4)):
            self.move()

    def move(self) -> None:
        """All parts as one where nothing is on the ground, or the last one on its hinge."""
        joints, last = self.structure.get("joints", {}), self.parts[-1]
        if not any(GROUND in joint["parts"] for joint in joints.values()):
            motion = {"velocity": self.vector(1.0), "spin": self.vector(2.0)}
            for part in self.parts:
                self.add("initial_velocities", f"v{part}", part=part, about="c0", **motion)
        elif "j_ball" not in joints and joints[f"j{last[1:]}"]["type"] == "revolute":
            axis = np.array(joints[f"j{last[1:]}"]["axis"])
            spin = (self.number(-3.0, 3.0) * axis / np.linalg.norm(axis)).tolist()
            self.add("initial_velocities", f"v{last}", part=last, about=f"p{last[1:]}", spin=spin)
