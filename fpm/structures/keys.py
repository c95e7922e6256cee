"""Keys of a statement, by the type of their values.

`read` is called once for a file and notes what is wrong with the text; it returns a function of the
Builder of every sample, which returns the value there or raises SceneError for numbers that are not
allowed. A further type of value goes here."""

from collections import ChainMap
from collections.abc import Callable, Iterator
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

from fpm.arithmetic.expressions import Expression
from fpm.arithmetic.units import NUMBER, unit
from fpm.declare import Key, Number
from fpm.elements.cross import length
from fpm.elements.joints.joint_types import SUFFIXES, TYPES
from fpm.elements.kind import AXES
from fpm.errors import SceneError
from fpm.structures.builder import Builder
from fpm.structures.curves_file import CurvesFile, CurvesFileError
from fpm.structures.names import Context, NamedNumber, Place
from fpm.structures.reading import Node, SkippedError, commas

COMMA = " (an expression with a comma stands in quotes)"
MOST = 1000
"""Largest count of units, or number of elements between two points."""

STRING = {"type": "string"}
"""What JSON Schema says of names and texts."""

BuildValue = Callable[[Builder], Any]
"""Function of a sample's Builder: a key's value in SI units; raises SceneError if it is not
allowed."""

COUNT = Number(least=1, most=MOST, is_whole=True)
"""A count of units or elements, of whole-number parameters alone, as it decides what there is."""


@dataclass(frozen=True)
class VectorKey(Key):
    """Key of three numbers along x, y, z, (3,) in SI units; unit: of their dimension, as "m/s2"."""

    schema: ClassVar[Any] = {"type": ["array", "string"], "minItems": 3, "maxItems": 3}
    unit: str = ""

    @property
    def allowed(self) -> str:
        suffix = f" in {self.unit}" if self.unit else ""
        return f"three numbers [x, y, z]{suffix}{COMMA}, or a vector"

    def read(self, node, place):
        if node.text:
            vector = place.number(node, self.unit, self.allowed, vector=True)
            return lambda build: build.number(vector, place.key)
        if len(node.items) != 3:
            place.refuse(node, self.allowed)
        bounds = [place.number(item, self.unit, self.allowed) for item in node.items]
        return lambda build: np.array([build.number(bound, place.key) for bound in bounds])


@dataclass(frozen=True)
class GravityKey(VectorKey):
    """Key of an acceleration of gravity: a pair of its vector, (3,) m/s², and None or a function of
    the Builder that returns the index of its curve of time, once curves are built."""

    schema = VectorKey.schema | {"type": ["array", "string", "object"]}

    @property
    def allowed(self) -> str:
        return f"{super().allowed}, or {{acceleration: such numbers, curve: one of `curves`}}"

    def read(self, node, place):
        if not node.is_table:
            vector = super().read(node, place)
            return lambda build: (vector(build), None)
        if node.entries.keys() != {"acceleration", "curve"}:
            place.refuse(node, self.allowed)
        vector = super().read(node.entries["acceleration"], place.child("acceleration"))
        full = place.child("curve").reference(node.entries["curve"], "curves")
        return lambda build: (vector(build), GroupMember("curves", full))


@dataclass(frozen=True)
class DirectionKey(Key):
    """Key of a unit vector (3,): a letter (x, -x, ...), three numbers of one unit, two points, or
    an expression of vectors."""

    allowed = "x, y, z, -x, -y, -z, [x, y, z], {from: P, to: Q}, or a vector as Q - P"

    def read(self, node, place):
        if (letter := node.text.removeprefix("-")) in (*AXES,):
            axis = (1.0 - 2.0 * (letter != node.text)) * np.eye(3)[AXES.index(letter)]
            return lambda build: axis
        if node.text.isidentifier():
            try:
                place.names.find_number(node.text, place, node.line)
            except KeyError:
                place.refuse(node, self.allowed)
        if node.text:
            vector = place.number(node, None, self.allowed, vector=True)
            if vector.full.get(node.text, "").startswith("point "):
                place.refuse(node, f"{self.allowed}: one point is not a direction")
            return lambda build: self._unit_vector(build.number(vector, place.key), place)
        if len(node.items) == 3:
            bounds = [place.number(item, None, self.allowed) for item in node.items]
            dimensions = [bound.dimension(place.names.numbers) for bound in bounds]
            if len({d.powers for d in dimensions if not d.bare}) > 1:
                place.refuse(node, "three numbers of one unit")
            return lambda build: self._unit_vector(
                np.array([build.number(bound, place.key) for bound in bounds]), place
            )
        if node.entries.keys() == {"from", "to"}:
            ends = ((end, node.entries[end]) for end in ("from", "to"))
            names = [place.child(end).reference(end_node, "points") for end, end_node in ends]

            def from_to(build: Builder) -> np.ndarray:
                start, stop = (build.find("points", name).position for name in names)
                return self._unit_vector(stop - start, place)

            return from_to
        return place.refuse(node, self.allowed)

    def _unit_vector(self, vector: np.ndarray, place: Place) -> np.ndarray:
        size = length(vector)
        if not 0 < size < np.inf:
            raise SceneError(place.key, vector.tolist(), "a direction that is not zero")
        return vector / size


class GroupMember(NamedTuple):
    """Reference to an entry of a structure file; called with a Builder, it returns what was built
    for it. group: section of the file, as "bars"; name: full name; number: added to that, if it is
    an index (1 for the second of a joint's openings), None: nothing."""

    group: str
    name: str
    number: int | None = None

    def __call__(self, build: Builder) -> Any:
        value = build.find(self.group, self.name)
        return value if self.number is None else value + self.number


@dataclass(frozen=True)
class ReferenceKey(Key):
    """Key whose value is what was built for an entry, given by its name, of `group`, as "bars".
    ground: whether `ground` is allowed too, in the group "parts"."""

    schema = STRING
    group: str = ""
    ground: bool = False

    @property
    def allowed(self) -> str:
        if self.group == "parts":
            return "the name of a bar or body" + (", or ground" if self.ground else "")
        return f"the name of one of `{self.group}`"

    def read(self, node, place):
        full = place.reference(node, self.group)
        if full == "ground" and not self.ground:
            place.refuse(node, self.allowed)
        return GroupMember(self.group, full)


@dataclass(frozen=True)
class OpeningKey(Key):
    """Key whose value is the index of a hinge, given by the name of an opening. types: of joints
    that are allowed, (): all; slides: whether it must be a length, or must not, None: either; hint:
    text to add to `allowed`, for messages."""

    schema = STRING
    types: tuple[str, ...] = ()
    slides: bool | None = None
    hint: str = ""

    def _fits(self, type: str, number: int) -> bool:
        opening = TYPES[type].openings[number]
        is_allowed = type in (self.types or TYPES)
        return is_allowed and self.slides in (None, bool(opening.direction))

    @property
    def allowed(self) -> str:
        types: list[str] = []  # whose name is that of their opening
        suffixes: dict[str, None] = {}  # by which others name theirs
        for type, joint_type in TYPES.items():
            for k, (suffix, _) in enumerate(joint_type.openings):
                if self._fits(type, k) and suffix:
                    suffixes[suffix] = None
                elif self._fits(type, k):
                    types.append(type)
        text = f", or of a joint of several openings with {' or '.join(suffixes)} behind it"
        return f"the name of a {' or '.join(types)} joint{text if suffixes else ''}{self.hint}"

    def options(self, place: Place) -> list[str]:
        """Names of joints with one opening, seen at a place of a file, that are allowed."""
        types = place.names.types
        joints = [n for n, type in types.items() if type and len(TYPES[type].openings) == 1]
        return [*place.context.visible([n for n in joints if self._fits(types[n], 0)])]

    def read(self, node, place):
        names, joint, number = place.names, node, None
        with suppress(KeyError):  # the name of one of a joint's openings
            name, number = names.openings[place.context.find(node.text, names.openings)]
            joint = Node(name, node.line)
        full = place.reference(joint, "joints")
        type = names.types.get(full, "")
        if not type:  # the joint itself has a problem, already reported
            raise SkippedError(full)
        fits = [k for k in range(len(TYPES[type].openings)) if self._fits(type, k)]
        if type in SUFFIXES and number is None and fits:
            options = " or ".join(full + SUFFIXES[type][k] for k in fits)
            place.refuse(node, f"one of its openings, {options}")
        if (number or 0) not in fits:
            place.refuse(node, self.allowed)
        return GroupMember("joints", full, number or 0)


@dataclass(frozen=True)
class WatchKey(OpeningKey):
    """Key whose value is the index of a hinge, given by the name of a joint with an opening, or the
    full name of a latch, which no joint has."""

    hint: str = ", or that of a latch"

    def read(self, node, place):
        names = place.names
        actions = names.groups.get("actions", {}).keys() - names.types.keys()
        with suppress(KeyError):
            place.context.find(node.text, actions)
            latch = place.reference(node, "actions")
            return lambda build: latch
        with suppress(KeyError):
            place.context.find(node.text, names.types.keys() | names.openings.keys())
            return super().read(node, place)
        options = place.context.visible([*names.types, *actions])
        names.unknown(node.line, place.key, node.text, options, "joint or latch")
        raise SkippedError(place.key)


@dataclass(frozen=True)
class PointKey(Key):
    """Key whose value is (Body, Point), a point of a part or the ground, given by both names, or by
    the point's where only one part has it."""

    part = ReferenceKey(group="parts", ground=True)
    allowed = f"{{part: {part.allowed}, at: one of its points}}, or a point that only one part has"

    def read(self, node, place):
        if node.entries.keys() == {"part", "at"}:
            part = self.part.read(node.entries["part"], place.child("part"))
            point = place.child("at").reference(node.entries["at"], "points")
            return lambda build: (part(build), build.find("points", point))
        if not isinstance(node.value, str):
            place.refuse(node, self.allowed)
        point = place.reference(node, "points")
        return lambda build: (build.find_part(point, place.key), build.find("points", point))


@dataclass(frozen=True)
class ListKey(Key):
    """Key of a list of `least` to `most` values of the Key `kind`, no two alike. units: whether
    {each: REPEAT, through: [...]} may stand for the values in all units of a repeat."""

    kind: Key = field(default_factory=Key)
    least: int = 1
    most: int = MOST
    units: bool = False

    @property
    def schema(self) -> dict[str, Any]:  # type: ignore[override]
        items = {} if self.units else self.kind.schema
        return {"type": "array", "items": items, "maxItems": self.most}

    @property
    def allowed(self) -> str:
        count = f"{self.least}" if self.least == self.most else f"{self.least} to {self.most}"
        suffix = (
            "; or {each: a repeat, through: such a list}, which stands for those of all its units"
        )
        return f"a list of {count}, each {self.kind.allowed}{suffix if self.units else ''}"

    def for_slides(self, joints):
        return replace(self, kind=self.kind.for_slides(joints))

    def read(self, node, place):
        right = self.units or self.least <= len(node.items) <= self.most
        if not isinstance(node.value, list) or not right:
            place.refuse(node, self.allowed)
        values = list(self._values(node, place))
        if len(values) < self.least:
            place.refuse(node, self.allowed)
        if len({*values}) < len(values) and not self.units:
            place.refuse(node, f"{self.allowed}, each once")
        return lambda build: [value(build) for value in values]

    def _values(self, node: Node, place: Place) -> Iterator[BuildValue]:
        if not isinstance(node.value, list):
            place.refuse(node, self.allowed)
        for item in node.items:
            if self.units and item.entries.keys() == {"each", "through"}:
                units, name_node = place.context.units(), item.entries["each"]
                if name_node.text not in units:
                    place.child("each").refuse(name_node, f"one of {commas(units)}")
                for prefix in units[name_node.text]:
                    unit_place = replace(place, context=Context(place.context.ends, prefix))
                    yield from self._values(item.entries["through"], unit_place)
            else:
                yield self.kind.read(item, place)


@dataclass(frozen=True)
class MapKey(Key):
    """Key whose value is a dict from full names of entries in `group` (as "bars") to values of
    `kind`. single: whether one such value may be given for all; it is the key's value then."""

    group: str = "parts"
    kind: Key = field(default_factory=Key)
    single: bool = False

    @property
    def allowed(self) -> str:
        names = "its parts" if self.group == "parts" else f"names of `{self.group}`"
        prefix = f"{self.kind.allowed}, or " if self.single else ""
        return f"{prefix}a mapping from {names}, each to {self.kind.allowed}"

    def read(self, node, place):
        if self.single and not (node.is_table and node.entries.keys() != {"from", "to"}):
            return self.kind.read(node, place)
        if not node.is_table:
            place.refuse(node, self.allowed)
        values = {}
        for name, entry in node.entries.items():
            entry_place = place.child(name)
            full = entry_place.reference(Node(name, node.lines[name]), self.group)
            values[full] = self.kind.read(entry, entry_place)
        return lambda build: {name: value(build) for name, value in values.items()}


@dataclass(frozen=True)
class AssemblyKey(Key):
    """Key whose value tells whether parts are forced together: None, or a function of the Builder
    that returns the indices of hinges whose openings are kept then."""

    allowed = "true, false, or {hold: [joints]}"

    def read(self, node, place):
        if node.text in ("true", "false"):
            return lambda build: (lambda model: []) if node.text == "true" else None
        if node.entries.keys() != {"hold"}:
            place.refuse(node, self.allowed)
        hinges = ListKey(kind=OpeningKey()).read(node.entries["hold"], place.child("hold"))
        return lambda build: hinges


@dataclass(frozen=True)
class TextKey(Key):
    """Key whose value is text."""

    schema = STRING
    allowed = "text"

    def read(self, node, place):
        if not node.text:
            place.refuse(node, self.allowed)
        return lambda build: node.text


@dataclass(frozen=True)
class CurvesKey(TextKey):
    """Key whose value is a CurvesFile, given by its path from the structure's folder."""

    allowed = "the path of a CSV file, from the structure's folder"

    def read(self, node, place):
        super().read(node, place)
        path, files = Path(place.problems.source).parent / node.value, place.names.files
        try:
            files[path] = file = files.get(path) or CurvesFile.read(path)
        except CurvesFileError as error:
            place.problems.say(node.line, f"{place.key}: {error}")
            raise SkippedError(place.key) from None
        return lambda build: file


CURVE_INPUTS = {"t": unit("s").dimension, "u": NUMBER}
"""Names that an expression of a curve has of its own, with their dimensions."""


@dataclass(frozen=True)
class CurveExpressionKey(Key):
    """Key whose value is (Expression, numbers): arithmetic with t and u, which is a number, and the
    values of all other names in it."""

    allowed = "a number, by arithmetic with u (0 to 1 over `over`) and t (time, s)"

    def read(self, node, place):
        names, inputs = copy(place.names), CURVE_INPUTS.items()
        numbers = {name: NamedNumber(place.key, node.line, dimension) for name, dimension in inputs}
        names.numbers = ChainMap(place.names.numbers, numbers)  # vectors are added to the first
        bound = replace(place, names=names).number(node, "", self.allowed)
        full = {name: n for name, n in bound.full.items() if name not in CURVE_INPUTS}
        for name in CURVE_INPUTS.keys() & bound.full.keys():
            if bound.full[name] in place.names.numbers:
                hint = f"without the structure's own number {name}, which needs another name"
                place.refuse(node, f"{self.allowed}, {hint}")

        def value(build: Builder) -> tuple[Expression, dict[str, Any]]:
            if missing := [n for n in full.values() if n not in build.numbers]:
                raise SkippedError(missing[0])
            return bound.expression, {name: build.numbers[n] for name, n in full.items()}

        return value


@dataclass(frozen=True)
class LettersKey(Key):
    """Key whose value is a set of global axes, as text such as "xz"; "" where `none` is given."""

    schema = STRING
    allowed = "letters out of xyz, or none"

    def read(self, node, place):
        text = node.text
        if text != "none" and (not text or set(text) - {*AXES} or len({*text}) < len(text)):
            place.refuse(node, self.allowed)
        return lambda build: "" if text == "none" else text
