"""A structure's file as a whole: its names found, its units checked, its repeats written out.

A model belongs to values of the whole-number parameters, which decide what there is."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from fpm.arithmetic.expressions import ExpressionError
from fpm.arithmetic.units import NUMBER, unit
from fpm.declare import Number, Word
from fpm.elements.bars.bar_damping import BarDamping
from fpm.elements.joints.joint_types import SUFFIXES
from fpm.errors import likely
from fpm.scenes.scene import Scene
from fpm.structures.keys import COMMA, COUNT, MOST, AssemblyKey, GravityKey
from fpm.structures.names import NEIGHBOURS, Context, NamedNumber, Names, Place
from fpm.structures.reading import Node, SkippedError, check_keys, join_key, table_at
from fpm.structures.statement import PARTS, Entry, read_entry, statement
from fpm.structures.statements import GROUPS

TEXTS = ("name", "description", "mesh")
UNIT_KEYS = ("count", "arrangement", "index", "let", "points", *GROUPS)
MOST_STATEMENTS = 20_000
"""Number of statements that all units of a repeat may have together."""


@statement(
    "",
    gravity=GravityKey(
        (np.zeros(3), None), "gravitational acceleration; `curve` scales it over time", unit="m/s2"
    ),
    damping=Number(0.0, "mass-proportional damping", unit="1/s", least=0),
    viscosity=Number(
        0.0, "bulk viscosity of bars, as a share of an element's critical damping; 0.2 damps "
             "waves that oscillate in the mesh", least=0,
    ),
    assemble=AssemblyKey(
        None, "whether to force parts together whose points do not meet at their joints; `hold` "
              "names joints that keep their opening"
    ),
    start=Word(
        "as stated", "where the run begins; `equilibrium`: where all forces that act at t = 0 "
                     "balance",
        values=("as stated", "equilibrium"),
    ),
)  # fmt: skip
def overall(build, args):
    """Settings of the whole structure."""
    build.hold, build.is_balanced = args.assemble, args.start == "equilibrium"
    gravity, build.gravity_curve = args.gravity
    scene = Scene(args.name, gravity, args.damping)
    if args.viscosity:
        scene.add(BarDamping(args.viscosity))
    return scene


KEYS = (*TEXTS, *overall.keys, "parameters", "let", "points", *GROUPS, "repeat")


class Sheet(NamedTuple):
    """One table with points, bars and so on of a structure file: its own, or that of one unit
    (copy) of a repeat. context: which names are seen in it; table: its YAML Node; key: its dotted
    path, "" at the top; number: of the unit in its repeat, from 1; 0 at the top of the file."""

    context: Context
    table: Node
    key: str
    number: int


class FileStatements:
    """All statements of a structure file, with a copy for each unit of a repeat. table: the file's
    top Node; inputs: its parameters by name; counts: values of whole ones; names: Names, filled
    here. What is wrong is noted in its problems, and left out. entries: in building order; overall:
    Entry of gravity, damping, ...; points: full names."""

    def __init__(self, table: Node, inputs: Mapping[str, Any], counts: Mapping, names: Names):
        self.problems, self.names = names.problems, names
        self.points: list[str] = []
        for name, p in inputs.items():
            key = f"parameters.{name}"
            if self.names.allows(name, key, p.line, "let"):
                number = NamedNumber(key, p.line, p.unit.dimension, p.parameter.is_whole)
                self.names.numbers[name] = number
        ends: dict[str, str] = {}
        file = Sheet(Context(ends), table, "", 0)
        sheets = [file, *self._units(table, counts, ends)]
        if "repeat" in table.entries:
            self.problems.stop()  # without its units, all names in them would be unknown, too
        for sheet in sheets:
            self._register(sheet)
        for sheet in sheets:
            self._define(sheet)
        self.names.sort()
        start, uses = self.names.collect(partial(self._overall, file))
        self.overall = replace(start, uses=uses)
        self.entries = list(self._entries(sheets))
        for name, p in inputs.items() if not self.problems else ():
            if not self.names.uses[name]:  # probably a typing error
                self.problems.say(p.line, f"parameters.{name}: nothing uses it: use or delete it")

    # -- repeats ------------------------------------------------------------------------------

    def _units(self, table: Node, counts: Mapping, ends: dict[str, str]) -> Iterator[Sheet]:
        """Yield all units of repeats; add prefixes of first and last ones to `ends`."""
        repeats = table_at(table, "repeat", "", self.problems)
        for name, line in repeats.lines.items():
            place = Place(f"repeat.{name}", Context({}), self.names)
            node = table_at(repeats, name, "repeat", self.problems)
            check_keys(node, place.key, UNIT_KEYS, self.problems)
            if name[-1:].isdigit():
                allowed = "ends with a digit; allowed: names that do not"
                self.problems.say(line, f"{place.key}: {allowed}")
            if not self.names.allows(name, place.key, line, "repeat"):
                continue
            try:
                count = self._count(node, place.child("count"), line, counts)
                arrangement = node.entries.get("arrangement", Node("row"))
                if arrangement.text not in ("row", "ring"):
                    place.child("arrangement").refuse(arrangement, "row or ring")
            except SkippedError:
                continue
            ends[f"{name}.first"], ends[f"{name}.last"] = f"{name}1.", f"{name}{count}."
            for i in range(count):
                is_ring = arrangement.text == "ring"
                neighbours = [j % count if is_ring else j for j in (i + 1, i - 1)]
                prefixes = [f"{name}{j + 1}." if 0 <= j < count else None for j in neighbours]
                adjacent = dict(zip(NEIGHBOURS, prefixes, strict=True))
                yield Sheet(Context(ends, f"{name}{i + 1}.", adjacent), node, place.key, i + 1)

    def _count(self, node: Node, place: Place, line: int, counts: Mapping[str, float]) -> int:
        """Return the number of units, from parameters that are whole numbers."""
        if "count" not in node.entries:
            self.problems.say(line, f"{place.key}: missing; allowed: {COUNT.allowed}")
            raise SkippedError(place.key)
        count_node = node.entries["count"]
        size = sum(len(part.entries) for part in node.entries.values())
        most = min(MOST, MOST_STATEMENTS // max(size, 1))
        bound = place.whole(count_node, COUNT.allowed)
        try:
            count = bound.value(counts)
        except ExpressionError:
            count = 0
        if count != round(count) or not 1 <= count <= most:
            place.refuse(count_node, f"a whole number from 1 to {most}")
        return round(count)

    # -- names --------------------------------------------------------------------------------

    def _register(self, sheet: Sheet) -> None:
        """Note which names there are, that of a unit's number first."""
        if "index" in sheet.table.entries and sheet.number:
            index, key = sheet.table.entries["index"], f"{sheet.key}.index"
            name = index.text
            if name in self.names.numbers:
                self.problems.say(index.line, f"{key}: the name {name} is defined twice")
            elif self.names.allows(name, key, index.line, "let"):
                number = NamedNumber(key, index.line, NUMBER, whole=True, count=float(sheet.number))
                self.names.numbers[sheet.context.prefix + name] = number
        for group in ("let", "points", *GROUPS):
            node = table_at(sheet.table, group, sheet.key, self.problems)
            for name, line in node.lines.items():
                key = join_key(sheet.key, group, name)
                if self.names.allows(name, key, line, group):
                    self._name(sheet.context.prefix, name, group, key, node)
                if group == "joints":
                    text = node.entries[name].entries.get("type", Node("")).text
                    type_ = text if text in GROUPS[group] else likely(text, GROUPS[group])
                    full = sheet.context.prefix + name
                    self.names.types[full] = type_
                    for k, suffix in enumerate(SUFFIXES.get(type_, ())):
                        self.names.openings[full + suffix] = full, k

    def _name(self, prefix: str, name: str, group: str, key: str, node: Node) -> None:
        """Note one name of a group, whose table is `node`."""
        numbers, names_of, full = self.names.numbers, self.names.groups, prefix + name
        lines: dict[str, Any] = numbers if group == "let" else names_of.setdefault(group, {})
        line = node.lines[name]
        if full in lines or name in lines:
            sentence = f"the name {name} is defined twice; allowed: each name once"
            self.problems.say(line, f"{key}: {sentence}")
        elif group == "let":
            numbers[full] = NamedNumber(key, line)
        else:
            lines[full] = line
            if group in PARTS:
                names_of["parts"][full] = line
            if group == "points":
                self.points.append(full)
                length = unit("m").dimension
                targets = {f"{full}.{axis}": length for axis in "xyz"}
                if node.entries[name].text:  # of vectors
                    targets = {f"point {full}": length._replace(vector=True)}
                numbers.update({n: NamedNumber(key, line, power) for n, power in targets.items()})

    def _define(self, sheet: Sheet) -> None:
        """Tie the numbers under `let` and the points' coordinates to their expressions."""
        context = Context(sheet.context.ends, sheet.context.prefix)  # neighbours may not be there
        for group in ("let", "points"):
            node = sheet.table.entries.get(group, Node({}))
            for name, entry in node.entries.items():
                full = context.prefix + name
                place = Place(join_key(sheet.key, group, name), context, self.names)
                if group == "let" and len(entry.items) == 3:
                    text = ", ".join(item.text for item in entry.items)
                    self._tie(place, [full], [Node(f"[{text}]", entry.line)])
                elif group == "let" or entry.text:
                    self._tie(place, [full if group == "let" else f"point {full}"], [entry])
                elif len(entry.items) == 3:
                    self._tie(place, [f"{full}.{axis}" for axis in "xyz"], entry.items)
                else:
                    allowed = f"three coordinates [x, y, z]{COMMA}, or a vector as (P + Q)/2"
                    self.problems.refuse(node.lines[name], place.key, entry.plain, allowed)

    def _tie(self, place: Place, targets: list[str], items: list[Node]) -> None:
        for target, item in zip(targets, items, strict=True):
            number = self.names.numbers.get(target)
            if number is not None and number.key == place.key:  # else the name of something else
                try:
                    number.bound = place.bind(item, "an expression")
                except SkippedError:
                    continue

    # -- statements ---------------------------------------------------------------------------

    def _overall(self, file: Sheet) -> Entry:
        """Gravity and damping as an entry; its name is the structure's."""
        read, table = {}, file.table
        for key in overall.keys.keys() & table.entries.keys():
            place = Place(key, file.context, self.names)
            try:
                read[key] = overall.keys[key].read(table.entries[key], place)
            except SkippedError:
                continue
        name = table.entries.get("name", Node("structure")).text
        return Entry(overall, name, "", 0, table, read)

    def _entries(self, sheets: list[Sheet]) -> Iterator[Entry]:
        for group, kinds in GROUPS.items():
            for sheet in sheets:
                node = sheet.table.entries.get(group, Node({}))
                for name, entry_node in node.entries.items():
                    full = sheet.context.prefix + name
                    if full not in self.names.groups.get(group, {}):
                        continue
                    place = Place(join_key(sheet.key, group, name), sheet.context, self.names)
                    values = kinds, full, entry_node, node.lines[name], place
                    entry, uses = self.names.collect(partial(read_entry, *values))
                    if entry is not None:
                        yield replace(entry, uses=uses)
                        continue
                    self.names.absent.add((group, full))
                    if group in PARTS:
                        self.names.absent.add(("parts", full))
