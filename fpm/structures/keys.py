"""Kinds of values that the keys of a statement take: each reads its node, and finds its value.

`read` is called once for a file and notes what is wrong with the text; `value` is called for every
sample and raises SceneError for numbers that are not allowed. A further kind of value goes here.
"""

from collections.abc import Container
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fpm.elements.joints.hinge import ANGLES
from fpm.elements.openings.opening import SLIDING
from fpm.errors import SceneError
from fpm.structures.builder import Builder
from fpm.structures.names import Bound
from fpm.structures.place import Place
from fpm.structures.problems import SkippedError
from fpm.structures.reading import Items, Node, Table, Text
from fpm.structures.units import NUMBER, unit

AXES = "xyz"
REQUIRED = object()
COMMA = " (an expression with a comma stands in quotes)"
MOST = 1000
"""Largest count, or number of elements between two points."""


@dataclass(frozen=True)
class Key:
    """One key of a statement. `default`: its value when it is left out, or REQUIRED."""

    default: Any = REQUIRED
    about: str = ""

    @property
    def allowed(self) -> str:
        """What is allowed, in words."""
        raise NotImplementedError

    def sliding(self, joints: Container[str]) -> "Key":
        """The key where `joints`, keys of the statement, name slides: with units of lengths."""
        return self

    def read(self, node: Node, place: Place) -> Any:
        """What the node means; what is wrong is noted, and SkippedError raised."""
        raise NotImplementedError

    def value(self, read: Any, build: Builder, key: str) -> Any:
        """Its value in one sample, SI units; SceneError if that is not allowed."""
        return read


@dataclass(frozen=True)
class Number(Key):
    """A number in a unit; `least` (allowed) or `above` (not allowed) is its lower end. joint: the
    key that names the joint whose opening it may be about.
    """

    unit: str = ""
    least: float | None = None
    above: float | None = None
    joint: str = "joint"

    @property
    def allowed(self) -> str:
        what = {"": "a number", "rad": "an angle"}.get(self.unit, f"a value in {self.unit}")
        end = f" >= {self.least:g}" if self.least is not None else ""
        return what + (f" > {self.above:g}" if self.above is not None else end)

    def sliding(self, joints: Container[str]) -> "Number":
        return (
            replace(self, unit=SLIDING.get(self.unit, self.unit)) if self.joint in joints else self
        )

    def read(self, node: Node, place: Place) -> Bound:
        return place.number(node, unit(self.unit).dimension, self.allowed, self.unit == "rad")

    def value(self, read: Bound, build: Builder, key: str) -> float:
        found = build.number(read, key)
        low = self.least is not None and found < self.least
        if low or (self.above is not None and found <= self.above):
            raise SceneError(key, found, self.allowed)
        return found


@dataclass(frozen=True)
class Whole(Key):
    """A whole number, which decides the structure's topology."""

    least: int = 1
    most: int = MOST

    @property
    def allowed(self) -> str:
        return f"a whole number from {self.least} to {self.most}, of parameters with `whole: true`"

    def read(self, node: Node, place: Place) -> Bound:
        bound = place.number(node, NUMBER, self.allowed)
        if not place.names.is_whole(bound):
            place.refuse(node, self.allowed)
        return bound

    def value(self, read: Bound, build: Builder, key: str) -> int:
        found = build.number(read, key)
        if found != round(found) or not self.least <= found <= self.most:
            raise SceneError(key, found, self.allowed)
        return round(found)


@dataclass(frozen=True)
class Vector(Key):
    """Three numbers in a unit, along x, y and z."""

    unit: str = ""

    @property
    def allowed(self) -> str:
        return f"three numbers [x, y, z]{f' in {self.unit}' if self.unit else ''}{COMMA}"

    def read(self, node: Node, place: Place) -> tuple[Bound, ...]:
        if not isinstance(node, Items) or len(node.items) != 3:
            place.refuse(node, self.allowed)
        wanted = unit(self.unit).dimension
        return tuple(place.number(item, wanted, self.allowed) for item in node.items)

    def value(self, read: tuple[Bound, ...], build: Builder, key: str) -> np.ndarray:
        return np.array([build.number(bound, key) for bound in read])


@dataclass(frozen=True)
class Direction(Key):
    """A direction: a letter, three numbers of one dimension, or from one point to another."""

    allowed = "x, y, z, -x, -y, -z, [x, y, z], or {from: P, to: Q} with two points"

    def read(self, node: Node, place: Place) -> tuple:
        if isinstance(node, Text) and node.value.lstrip("-") in (*AXES,) and len(node.value) < 3:
            sign = -1.0 if node.value.startswith("-") else 1.0
            return "letter", sign * np.eye(3)[AXES.index(node.value[-1])]
        if isinstance(node, Items) and len(node.items) == 3:
            bounds = [place.number(item, None, self.allowed) for item in node.items]
            found = [b.dimension(place.names.numbers) for b in bounds]
            if len({d.powers for d in found if not d.bare}) > 1:
                place.refuse(node, "three numbers of one unit")
            return "numbers", bounds
        if isinstance(node, Table) and node.entries.keys() == {"from", "to"}:
            return "points", [
                place.inside(end).reference(node.entries[end], "points") for end in ("from", "to")
            ]
        return place.refuse(node, self.allowed)

    def value(self, read: tuple, build: Builder, key: str) -> np.ndarray:
        how, what = read
        if how == "numbers":
            what = np.array([build.number(bound, key) for bound in what])
        elif how == "points":
            what = build.point(what[1]) - build.point(what[0])
        size = np.linalg.norm(what)
        if not 0 < size < np.inf:
            raise SceneError(key, what.tolist(), "a direction that is not zero")
        return what if how == "letter" else what / size


@dataclass(frozen=True)
class Reference(Key):
    """The name of something in a group; its value is what was built for it."""

    group: str = ""

    @property
    def allowed(self) -> str:
        return f"the name of one of `{self.group}`"

    def read(self, node: Node, place: Place) -> str:
        return place.reference(node, self.group)

    def value(self, read: str, build: Builder, key: str) -> Any:
        return build.made(self.group, read)


@dataclass(frozen=True)
class Opening(Key):
    """The opening of a joint, of one of some types: its value is the index of the hinge."""

    types: tuple[str, ...] = ("revolute", "prismatic", "universal")
    hint: str = ""

    @property
    def allowed(self) -> str:
        one = " or ".join(type for type in self.types if type != "universal")
        more = f", or of a universal one with {' or '.join(ANGLES)} behind it"
        return f"the name of a {one} joint{more if 'universal' in self.types else ''}{self.hint}"

    def read(self, node: Node, place: Place) -> tuple[str, int]:
        names, text = place.names, node.value if isinstance(node, Text) else ""
        for k, end in enumerate(ANGLES):
            known = [n for n, type in names.types.items() if type == "universal"]
            try:
                place.context.find(text.removesuffix(end), known if text.endswith(end) else ())
            except KeyError:
                continue
            full = place.reference(Text(text.removesuffix(end), node.line), "joints")
            self._check(node, place, full, "universal")
            return full, k
        full = place.reference(node, "joints")
        type = names.types.get(full, "")
        if not type:  # which is told of the joint
            raise SkippedError(full)
        self._check(node, place, full, "" if type == "universal" else type)
        return full, 0

    def _check(self, node: Node, place: Place, full: str, type: str) -> None:
        if type not in self.types:
            if place.names.types.get(full) == "universal" and "universal" in self.types:
                place.refuse(
                    node, f"one of its two angles, {' or '.join(full + e for e in ANGLES)}"
                )
            place.refuse(node, self.allowed)

    def value(self, read: tuple[str, int], build: Builder, key: str) -> int:
        return build.made("joints", read[0]) + read[1]


@dataclass(frozen=True)
class Part(Reference):
    """The name of a part. ground: whether that is one here."""

    group: str = "parts"
    ground: bool = False

    @property
    def allowed(self) -> str:
        return "the name of a bar or body" + (", or ground" if self.ground else "")

    def read(self, node: Node, place: Place) -> str:
        full = place.reference(node, self.group)
        if full == "ground" and not self.ground:
            place.refuse(node, self.allowed)
        return full


@dataclass(frozen=True)
class PointOfPart(Key):
    """A point of a part: both names, or the point's alone where only one part has it."""

    ground: bool = False

    @property
    def allowed(self) -> str:
        part = Part(ground=self.ground).allowed
        return f"{{part: {part}, at: one of its points}}, or a point that only one part has"

    def read(self, node: Node, place: Place) -> tuple[str, str]:
        if isinstance(node, Table) and node.entries.keys() == {"part", "at"}:
            part = Part(ground=self.ground).read(node.entries["part"], place.inside("part"))
            return part, place.inside("at").reference(node.entries["at"], "points")
        if not isinstance(node, Text):
            place.refuse(node, self.allowed)
        return "", place.reference(node, "points")

    def value(self, read: tuple[str, str], build: Builder, key: str) -> tuple:
        part, point = read
        if part:
            return build.made("parts", part), build.made("points", point)
        return build.only_part_with(point, key), build.made("points", point)


@dataclass(frozen=True)
class Many(Key):
    """A list of values of one kind, `least` to `most` of them, no two the same name."""

    kind: Key | None = None
    least: int = 1
    most: int = MOST

    @property
    def allowed(self) -> str:
        count = f"{self.least}" if self.least == self.most else f"{self.least} or more"
        return f"a list of {count}, each {self.kind.allowed}"

    def sliding(self, joints: Container[str]) -> "Many":
        return replace(self, kind=self.kind.sliding(joints))

    def read(self, node: Node, place: Place) -> list:
        if not isinstance(node, Items) or not self.least <= len(node.items) <= self.most:
            place.refuse(node, self.allowed)
        found = [self.kind.read(item, place) for item in node.items]
        if isinstance(self.kind, Reference | Opening) and len(set(found)) < len(found):
            place.refuse(node, f"{self.allowed}, each once")
        return found

    def value(self, read: list, build: Builder, key: str) -> list:
        return [self.kind.value(one, build, key) for one in read]


@dataclass(frozen=True)
class Each(Key):
    """A mapping from names of a group to values of one kind; its value is keyed by full names."""

    group: str = ""
    kind: Key | None = None

    @property
    def allowed(self) -> str:
        names = "its parts" if self.group == "parts" else f"names of `{self.group}`"
        return f"a mapping from {names}, each to {self.kind.allowed}"

    def read(self, node: Node, place: Place) -> dict:
        if not isinstance(node, Table):
            place.refuse(node, self.allowed)
        found = {}
        for name, entry in node.entries.items():
            inside = place.inside(name)
            full = inside.reference(Text(name, node.lines[name]), self.group)
            found[full] = self.kind.read(entry, inside)
        return found

    def value(self, read: dict, build: Builder, key: str) -> dict:
        return {n: self.kind.value(one, build, f"{key}.{n}") for n, one in read.items()}


@dataclass(frozen=True)
class Either(Key):
    """One value for all, or a mapping for each."""

    kind: Key | None = None
    each: Each | None = None

    @property
    def allowed(self) -> str:
        return f"{self.kind.allowed}, or {self.each.allowed}"

    def read(self, node: Node, place: Place) -> tuple[Key, Any]:
        is_each = isinstance(node, Table) and node.entries.keys() != {"from", "to"}
        kind = self.each if is_each else self.kind
        return kind, kind.read(node, place)

    def value(self, read: tuple[Key, Any], build: Builder, key: str) -> Any:
        return read[0].value(read[1], build, key)


@dataclass(frozen=True)
class Assembled(Key):
    """Whether parts are forced together: None, or the names of the joints that are held then."""

    allowed = "true, false, or {hold: [joints]}"

    def read(self, node: Node, place: Place) -> list[tuple[str, int]] | None:
        if isinstance(node, Text) and node.value in ("true", "false"):
            return [] if node.value == "true" else None
        if not isinstance(node, Table) or node.entries.keys() != {"hold"}:
            place.refuse(node, self.allowed)
        joints = Many(kind=Opening())
        return joints.read(node.entries["hold"], place.inside("hold"))


@dataclass(frozen=True)
class Choice(Key):
    """One of a few words."""

    options: tuple[str, ...] = ()

    @property
    def allowed(self) -> str:
        return ", ".join(self.options)

    def read(self, node: Node, place: Place) -> str:
        if not isinstance(node, Text) or node.value not in self.options:
            place.refuse(node, self.allowed)
        return node.value


@dataclass(frozen=True)
class Letters(Key):
    """Global axes."""

    allowed = "letters out of xyz, or none"

    def read(self, node: Node, place: Place) -> str:
        text = node.value if isinstance(node, Text) else "?"
        if text == "none":
            return ""
        if not text or set(text) - set(AXES) or len(set(text)) < len(text):
            place.refuse(node, self.allowed)
        return text
