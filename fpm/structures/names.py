"""Names in a structure's file: what they stand for, where they can be seen, and values of them.

Units of a `repeat` see their own names first, then the file's, and neighbours' as `next.P` and
`previous.P`. From anywhere a unit's name is `bay3.P`, `bay.first.P` or `bay.last.P`."""

import re
import unicodedata
from collections import Counter
from collections.abc import Callable, Container, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from graphlib import CycleError, TopologicalSorter
from keyword import iskeyword
from pathlib import Path
from typing import Any

from fpm.arithmetic.expressions import RESERVED_NAMES, Expression, ExpressionError, Value, parse
from fpm.arithmetic.units import Dimension, is_unit, unit
from fpm.errors import did_you_mean, fold_name
from fpm.structures.curves_file import CurvesFile
from fpm.structures.reading import Node, Problems, SkippedError, commas, join_key, show

NEIGHBOURS = ("next", "previous")
UNIT_VECTORS = {"x": "[1, 0, 0]", "y": "[0, 1, 0]", "z": "[0, 0, 1]"}


@dataclass(frozen=True)
class Context:
    """Where something is written in a structure file, at the top or in one unit (copy) of a repeat,
    which decides which names are seen there. ends: prefix, as "bay1.", of the first and last unit
    of each repeat, by "bay.first" and "bay.last"; prefix: of names in this unit, as "bay3.", "" at
    the top; adjacent: prefixes of the neighbouring units by "next" and "previous", None beyond a
    row's end; empty where neighbours cannot be named."""

    ends: dict[str, str]
    prefix: str = ""
    adjacent: Mapping[str, str | None] = field(default_factory=dict)

    def find(self, name: str, names: Container[str]) -> str:
        """Return the full name, as "bay3.P", of what is called `name` here. names: full names
        known. KeyError if it is none of them; SkippedError for the neighbour beyond a row's end."""
        head, _, rest = (name := fold_name(name)).partition(".")
        if head in self.adjacent:
            neighbour = self.adjacent[head]
            full = (self.prefix if neighbour is None else neighbour) + rest
            if full not in names:
                raise KeyError(name)
            if neighbour is None:
                raise SkippedError(name)
            return full
        second, _, last = rest.partition(".")
        if f"{head}.{second}" in self.ends:
            name = self.ends[f"{head}.{second}"] + last
        for full in (self.prefix + name, name):
            if full in names:
                return full
        raise KeyError(name)

    def visible(self, names: Iterable[str]) -> list[str]:
        """Return those of the full `names` that a message suggests in this context, as they are
        written in it: at the top all, in a unit of a repeat its own and those of no unit."""
        if not self.prefix:
            return list(names)
        units = tuple(unit for units in self.units().values() for unit in units)
        tails = [name.removeprefix(self.prefix) for name in names if name.startswith(self.prefix)]
        return tails + [name for name in names if not name.startswith(units)]

    def units(self) -> dict[str, list[str]]:
        """Return the prefixes ("bay1.", ...) of each repeat's units, in order, by its name."""
        lasts = {end.removesuffix(".last"): u for end, u in self.ends.items() if ".last" in end}
        counts = {name: int(unit.removeprefix(name)[:-1]) for name, unit in lasts.items()}
        return {name: [f"{name}{i + 1}." for i in range(n)] for name, n in counts.items()}


@dataclass(frozen=True)
class Bound:
    """Expression with its names found. expression: as parsed; full: full names by written ones."""

    expression: Expression
    full: dict[str, str]

    def value(self, numbers: Mapping[str, Value]) -> Any:
        """Return the value (SI units), from those of all named numbers by full name."""
        return self.expression.value({name: numbers[full] for name, full in self.full.items()})

    def dimension(self, numbers: Mapping[str, "NamedNumber"]) -> Dimension:
        """Return the dimension of the expression. numbers: each NamedNumber of the file by full
        name. SkippedError if one that it refers to has none, being wrong itself."""
        dimensions: dict[str, Dimension] = {}
        for name, full in self.full.items():
            if (dimension := numbers[full].dimension) is not None:
                dimensions[name] = dimension
        if len(dimensions) < len(self.full):
            raise SkippedError(self.expression.text)
        return self.expression.dimension(dimensions)


@dataclass
class NamedNumber:
    """A number or vector with a name in a file: a parameter, a repeat's index, a coordinate of a
    point, or one derived from others.
    key, line: dotted path and line where it is defined; dimension: None while it is unknown, or if
    it is wrong; whole: whether it depends on whole numbers only, so that counts may depend on it;
    count: value of an index, else None; bound: expression of a derived one, else None."""

    key: str
    line: int
    dimension: Dimension | None = None
    whole: bool = False
    count: float | None = None
    bound: Bound | None = None


class Names:
    """All names of a structure file, filled as it is read. problems: where errors are noted; files:
    content of the files of curves that it names, by path. Attributes: numbers: each NamedNumber
    (parameters, `let`, coordinates of points, vectors as "point P") by full name; groups: by group,
    as "bars", the line of each entry by full name; types: of joints by full name, "" if unknown;
    openings: (joint, number) by name of each opening of joints with several; uses: how often names
    are referred to, of numbers in full, of entries as "bars:AB"; absent: (group, name) of entries
    left out; bounds: all expressions of the file; bad_names: given ones that nothing may have;
    order: full names of numbers, each after those it depends on."""

    def __init__(self, problems: Problems, files: dict[Path, CurvesFile]):
        self.problems, self.files = problems, files
        self.numbers: dict[str, NamedNumber] = {}
        self.groups: dict[str, dict[str, int]] = {"parts": {"ground": 0}}
        self.types: dict[str, str] = {}
        self.openings: dict[str, tuple[str, int]] = {}
        self.uses: Counter[str] = Counter()
        self.absent: set[tuple[str, str]] = set()
        self.bounds: list[Bound] = []
        self.bad_names: set[str] = set()
        self.order: list[str] = []
        self._is_sorted = False

    def collect(self, read: Callable[[], Any]) -> tuple[Any, frozenset[str]]:
        """Return what a function reads and returns, and to which names it refers."""
        all_uses, self.uses = self.uses, Counter()
        value, uses = read(), self.uses
        all_uses.update(uses)
        self.uses = all_uses
        return value, frozenset(uses)

    def dependents(self, parameters: Iterable[str]) -> set[str]:
        """Return full names of `parameters` and of all numbers that depend on any of them."""
        numbers = {*parameters}
        for name in self.order:
            bound = self.numbers[name].bound
            if bound and not numbers.isdisjoint(bound.full.values()):
                numbers.add(name)
        return numbers

    def allows(self, name: str, key: str, line: int, group: str = "") -> bool:
        """Return whether something may be called `name`; else a problem is noted: letters, digits
        and _, no word of the language; a number begins with a letter and is not a unit; what stands
        in expressions is not a function and no word of Python's. group: "let" for numbers,
        "points", ..."""
        is_reserved = name in (*NEIGHBOURS, "first", "last", "ground")
        plain, first = unicodedata.normalize("NFKC", name), r"[^\W\d_]" * (group == "let")
        sound = re.sub(r"\W", "_", plain).lstrip("_") + "_" * is_reserved
        sound = f"n{sound}" if first and not sound[:1].isalpha() else sound
        if not re.fullmatch(rf"{first}\w*", name) or is_reserved or name[:1] == "_":
            start = " after a letter" if first else ""
            start += f", such as {sound}" if sound else ""
            hint = f"letters, digits and _{start}; not ground, next, previous, first, last"
        elif group == "let" and is_unit(name):
            hint = f"a name that is not a unit, such as {name}_"
        elif group in ("let", "points", "repeat") and (name in RESERVED_NAMES or iskeyword(name)):
            hint = f"a name that is not a function and no word of Python's, such as {name}_"
        elif plain != name:
            hint = f"plain letters and digits, such as {sound}"
        else:
            return True
        self.bad_names.add(name)
        self.problems.say(line, f"{key}: the name {name!r} is not allowed; allowed: {hint}")
        return False

    def unknown(self, line: int, key: str, name: str, options: Iterable[str], noun: str) -> None:
        """Note the problem that a name is none of those allowed, with a hint at what may be meant;
        nothing of one that is refused where it is given. key, line: where it stands; noun: what it
        should name, as "bar"."""
        if self.bad_names & {name, name.rpartition(".")[0]}:
            return
        unit_names = [full for full in options if full.endswith(f".{name}")]
        group = next((g for g, names in self.groups.items() if g != "parts" and name in names), "")
        hint = did_you_mean(name, options)
        if unit_names:
            range_text = f" to {unit_names[-1]}" if len(unit_names) > 1 else ""
            hint = f" (each unit has its own: {unit_names[0]}{range_text})"
        elif group:
            hint = f" (it is one of `{group}`)"
        options = commas(options, rest=", ...")
        self.problems.say(line, f"{key}: there is no {noun} {name!r}{hint}; allowed: {options}")

    def find_number(self, name: str, place: "Place", line: int) -> str:
        """Return the full name of a number or vector that is called `name` in an expression: a
        named one, unit vector, point, or component `v.x`. KeyError."""
        with suppress(KeyError):
            return place.context.find(name, self.numbers)
        if name in UNIT_VECTORS:
            return self._derive(f"axis {name}", UNIT_VECTORS[name], {}, place, line)
        points = self.groups.get("points", {})
        with suppress(KeyError):
            point = place.context.find(name, points)
            parts = {axis: f"{point}.{axis}" for axis in UNIT_VECTORS}
            return self._derive(f"point {point}", "[x, y, z]", parts, place, line)
        base, _, axis = name.rpartition(".")
        if not base or axis not in UNIT_VECTORS:
            raise KeyError(name)
        try:  # a number may be called like a point
            full = f"point {place.context.find(base, points)}"
        except KeyError:
            full = self.find_number(base, place, line)
        unit_vector = self._derive(f"axis {axis}", UNIT_VECTORS[axis], {}, place, line)
        names = {axis: unit_vector, base: full}
        return self._derive(f"{full} {axis}", f"dot({base}, {axis})", names, place, line)

    def _derive(self, full: str, text: str, names: dict, place: "Place", line: int) -> str:
        """Note the number or vector `full` of others, unless it is there; returns `full`."""
        if full not in self.numbers:
            self.numbers[full] = NamedNumber(place.key, line, bound=Bound(parse(text), names))
            if self._is_sorted:
                self.order.append(full)
                self._measure(full)
        return full

    def sort(self) -> None:
        """Fill `order`, in which numbers can be computed one after the other, and find dimensions.
        Cycles and clashes of units become problems; what depends on them keeps None."""
        numbers = self.numbers.items()
        needs = {n: tuple(x.bound.full.values()) if x.bound else () for n, x in numbers}
        while True:
            try:
                self.order = [*TopologicalSorter(needs).static_order()]
                break
            except CycleError as error:
                ring = error.args[1][:0:-1]
                start = ring.index(min(ring, key=[*needs].index))
                ring = [*ring[start:], *ring[: start + 1]]
                number, needs[ring[0]] = self.numbers[ring[0]], ()
                allowed = f"({' -> '.join(ring)}); allowed: names that do not lead back"
                self.problems.say(number.line, f"{number.key}: defined by itself {allowed}")
        self._is_sorted = True
        for name in self.order:
            self._measure(name)

    def _measure(self, name: str) -> None:
        number = self.numbers[name]
        if number.bound is None:
            return
        text, target = number.bound.expression.text, number.dimension
        try:
            actual = number.bound.dimension(self.numbers)
        except SkippedError:
            return
        except ExpressionError as error:
            self.problems.say(number.line, f"{number.key}: {text}: {error}")
            number.bound = None
            return
        number.whole = bool(number.bound.full) and self.is_whole(number.bound)
        if target is not None and not actual.fits(target):
            self.problems.say(number.line, f"{number.key}: {text} is {actual}; allowed: {target}")
            number.bound = None
        number.dimension = target or actual
        tail = name.rpartition(".")[2]
        points = (point.rpartition(".")[2] for point in self.groups.get("points", ()))
        is_own = target is None and actual.vector and " " not in name  # stated under `let`
        if is_own and tail in (*UNIT_VECTORS, *points):
            text = f"a vector called {tail}; allowed: a name that no point has, and not x, y or z"
            self.problems.say(number.line, f"{number.key}: {text}")

    def is_whole(self, bound: Bound) -> bool:
        """Return whether all names in the expression `bound` stand for whole numbers."""
        return all(self.numbers[full].whole for full in bound.full.values())


@dataclass(frozen=True)
class Place:
    """Where a value is written in a structure's file, for messages and to find names. key: dotted
    path; context: the top or unit of a repeat in which it stands; names: all names of the file."""

    key: str
    context: Context
    names: Names

    @property
    def problems(self) -> Problems:
        """The file's problems, where what is wrong is noted."""
        return self.names.problems

    def child(self, key: str) -> "Place":
        """Return the place of a key below this one."""
        return replace(self, key=join_key(self.key, key))

    def refuse(self, node: Node, allowed: str) -> None:
        """Note that `node` is not allowed (allowed: in words), and raise SkippedError."""
        self.problems.refuse(node.line, self.key, node.plain, allowed)
        raise SkippedError(self.key)

    def bind(self, node: Node, allowed: str) -> Bound:
        """Resolve the names in `node` and return its expression. If that fails, note the problem
        and raise SkippedError. allowed: the allowed values in words, for the message."""
        if not node.text:
            self.refuse(node, allowed)
        try:
            expression = parse(node.text)
        except ExpressionError as error:
            if self.names.bad_names.intersection(re.findall(r"\w+", node.text)):
                raise SkippedError(self.key) from None
            self._say(node, f": {error}")
        full, numbers = {}, self.names.numbers
        for name in sorted(expression.names):
            try:
                full[name] = self.names.find_number(name, self, node.line)
            except KeyError:
                options = [*numbers, *self.names.groups.get("points", ())]
                options = [n for n in self.context.visible(options) if " " not in n]
                self.names.unknown(node.line, self.key, name, options, "number called")
        if len(full) < len(expression.names):
            raise SkippedError(self.key)
        self.names.uses.update(full.values())
        self.names.bounds.append(Bound(expression, full))
        return self.names.bounds[-1]

    def number(self, node: Node, symbol: str | None, allowed: str, vector=False) -> Bound:
        """Return the expression in `node`, its names found and its dimension checked; else
        SkippedError. symbol: unit of the dimension, as "N m" (None: any); an angle other than 0
        needs a unit; allowed: in words; vector: whether it is a vector."""
        if symbol == "rad/s" and re.search(r"(?<![\w.])Hz\b", node.text):
            self.refuse(node, "a value in rad/s, deg/s or rpm (1 turn a second is 2*pi rad/s)")
        if symbol == "m" and re.search(r"/\s*(rad|deg)\b", node.text):
            self.refuse(node, "a length in m, not one for each radian or degree")
        bound = self.bind(node, allowed)
        try:
            actual = bound.dimension(self.names.numbers)
            zero = symbol == "rad" and bound.expression.bare and bound.value({}) == 0
        except ExpressionError as error:
            self._say(node, f": {error}")
        target = actual if symbol is None else unit(symbol).dimension
        if not actual.fits(target._replace(vector=vector)):
            number = self.names.numbers.get(bound.full.get(node.text, ""))
            source = (
                f" ({number.key} on line {number.line})"
                if number and number.line not in (0, node.line)
                else ""
            )
            kind = "one number" if vector and not actual.vector else actual
            self._say(node, f" is {kind}{source}; allowed: {allowed}")
        if symbol == "rad" and actual.bare and not zero:
            self.refuse(node, f"{allowed}, whose unit must be said, such as 90 deg or 1.5 rad")
        return bound

    def whole(self, node: Node, allowed: str) -> Bound:
        """Return the expression in `node` where a whole number is asked for: it has no unit, and
        all names in it are whole numbers; its value may still be none, as of `n / 2`. Else
        SkippedError. allowed: in words."""
        bound = self.number(node, "", allowed)
        if not self.names.is_whole(bound):
            self.refuse(node, allowed)
        return bound

    def _say(self, node: Node, text: str) -> None:
        """Note the problem with the value at this place, and skip the entry that has it."""
        self.problems.say(node.line, f"{self.key}: {show(node.text)}{text}")
        raise SkippedError(self.key) from None

    def reference(self, node: Node, group: str) -> str:
        """Return the full name of the entry of a `group`, such as "bars", to which `node` refers by
        name; if there is none, a problem is noted, and SkippedError raised."""
        noun = group.removesuffix("s")
        is_place = group == "points" and not re.fullmatch(r"[\w.]+", node.text)
        if not isinstance(node.value, str) or is_place:
            remedy = ", which stands under `points`" if is_place else ""
            self.refuse(node, f"the name of a {noun}{remedy}")
        names = self.names.groups.get(group, {})
        try:
            full = self.context.find(node.text, names)
        except KeyError:
            self.names.unknown(node.line, self.key, node.text, self.context.visible(names), noun)
            raise SkippedError(self.key) from None
        if (group, full) in self.names.absent:
            raise SkippedError(full)
        self.names.uses[f"{group}:{full}"] += 1
        return full
