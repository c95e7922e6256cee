"""A structure's file as a whole: its names found, its units checked, its repeats written out.

A model belongs to certain values of the whole-number parameters, since these decide what there is.
"""

import re
from collections.abc import Iterator, Mapping
from keyword import iskeyword
from typing import ClassVar

import numpy as np

from fpm.errors import SceneError
from fpm.structures.expressions import RESERVED, ExpressionError
from fpm.structures.keys import COMMA, Key, Number, Place, Vector, Whole
from fpm.structures.names import NEIGHBOURS, Context, Names
from fpm.structures.names import Number as Named
from fpm.structures.parameters import Given
from fpm.structures.problems import Problems, SkippedError, did_you_mean
from fpm.structures.reading import Items, Node, Table, Text, plain
from fpm.structures.statement import PARTS, Entry, Statement, read_entry
from fpm.structures.statements import GROUPS
from fpm.structures.today import LATER_GROUPS, LATER_KEYS
from fpm.structures.units import NUMBER, is_unit, unit

EMPTY = Table({}, {}, 0)
TEXTS = ("name", "description", "mesh")
ARRANGEMENTS = ("row", "ring")
MOST_ENTRIES = 20_000
"""Most statements of a file, those of all units of a repeat counted."""


class Overall(Statement):
    """What holds for the whole structure."""

    group = ""
    keys: ClassVar[dict[str, Key]] = {
        "gravity": Vector(np.zeros(3), "acceleration of everything", unit="m/s2"),
        "damping": Number(0.0, "mass-proportional damping", unit="1/s", least=0),
    }


KEYS = (*TEXTS, *Overall.keys, "parameters", "let", "points", *GROUPS, "repeat")
UNIT_KEYS = ("count", "arrangement", "index", "let", "points", *GROUPS)


class Model:
    """All statements of a file. `entries` in the order in which they are built; `top`: gravity.

    table: the file; given: its parameters; counts: values of those that are whole numbers. What is
    wrong is noted in `problems`, and left out.
    """

    def __init__(
        self, table: Table, given: Mapping[str, Given], counts: Mapping, problems: Problems
    ):
        self.problems, self.names = problems, Names(problems)
        name = table.entries.get("name")
        self.name = name.value if isinstance(name, Text) else "structure"
        self.points: list[str] = []
        self._parameters(given)
        self._ends: dict[str, str] = {}
        tables = [(Context(self._ends), table, ""), *self._units(table, counts)]
        for context, part, key in tables:
            self._register(context, part, key)
        for context, part, key in tables:
            self._define(context, part, key)
        self.names.sort()
        place = Place("", tables[0][0], self.names)
        top = {k: table.entries[k] for k in Overall.keys if k in table.entries}
        self.top = _top(top, table, place)
        self.entries = list(self._entries(tables))
        self._unused(given)

    def _parameters(self, given: Mapping[str, Given]) -> None:
        for name, one in given.items():
            if self._sound(name, f"parameters.{name}", one.line, number=True):
                self.names.numbers[name] = Named(
                    f"parameters.{name}", one.line, None, one.unit.dimension, one.whole
                )

    def _sound(self, name: str, key: str, line: int, number: bool = False) -> bool:
        """Whether something may be called so."""
        reserved = name in (*NEIGHBOURS, "first", "last", "ground")
        if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or reserved:
            why = "letters, digits and _ after a letter; not ground, next, previous, first, last"
        elif number and is_unit(name):
            why = "a name that is not a unit"
        elif name in RESERVED or iskeyword(name):
            why = "a name that is no function and no word of Python's"
        else:
            return True
        self.problems.say(line, f"{key}: the name {name!r} is not allowed; allowed: {why}")
        return False

    # -- repeats ------------------------------------------------------------------------------

    def _units(self, table: Table, counts: Mapping) -> list[tuple[Context, Table, str]]:
        """Context, table and key of every unit of all repeats."""
        found = []
        repeats = _table(table.entries.get("repeat", EMPTY), "repeat", self.problems)
        for name, node in repeats.entries.items():
            key, line = f"repeat.{name}", repeats.lines[name]
            node = _table(node, key, self.problems)
            self._known(node, key, UNIT_KEYS)
            if name[-1:].isdigit():
                self.problems.say(line, f"{key}: ends with a digit; allowed: names that do not")
            if not self._sound(name, key, line):
                continue
            try:
                count = self._count(node, key, line, counts)
                ring = self._choice(node, "arrangement", key, ARRANGEMENTS) == "ring"
            except SkippedError:
                continue
            self._ends[f"{name}.first"], self._ends[f"{name}.last"] = f"{name}1.", f"{name}{count}."
            for i in range(1, count + 1):
                before, after = i - 1 or (count if ring else None), i + 1
                after = after if after <= count else 1 if ring else None
                around = {
                    side: None if j is None else f"{name}{j}."
                    for side, j in zip(NEIGHBOURS, (after, before), strict=True)
                }
                found.append((Context(self._ends, f"{name}{i}.", around), node, key))
        self.problems.stop()  # without its units, every name in them would be unknown
        return found

    def _count(self, node: Table, key: str, line: int, counts: Mapping) -> int:
        if "count" not in node.entries:
            self.problems.say(line, f"{key}.count: missing; allowed: {Whole().allowed}")
            raise SkippedError(key)
        place = Place(f"{key}.count", Context({}), self.names)
        kind, text = Whole(), node.entries["count"]
        self.names.order = list(self.names.numbers)
        bound = kind.read(text, place)
        self.names.order = []
        entries = sum(len(t.entries) for t in node.entries.values() if isinstance(t, Table))
        try:
            found = bound.value(counts)
        except ExpressionError:
            found = 0
        most = min(kind.most, MOST_ENTRIES // max(entries, 1))
        if found != round(found) or not 1 <= found <= most:
            place.refuse(text, f"a whole number from 1 to {most}")
        return round(found)

    def _choice(self, node: Table, name: str, key: str, choices: tuple[str, ...]) -> str:
        given = node.entries.get(name, Text(choices[0], 0))
        if not isinstance(given, Text) or given.value not in choices:
            self.problems.refuse(given.line, f"{key}.{name}", plain(given), " or ".join(choices))
            raise SkippedError(key)
        return given.value

    # -- names --------------------------------------------------------------------------------

    def _known(self, node: Table, key: str, known: tuple[str, ...]) -> None:
        """Note the keys that mean nothing."""
        dotted = f"{key}." if key else ""
        for name in node.entries:
            line = node.lines[name]
            if not key and name in LATER_GROUPS | LATER_KEYS:
                self.problems.say(line, f"{name}: comes later; allowed: {', '.join(known)}")
            elif name not in known:
                hint = did_you_mean(name, known)
                allowed = ", ".join(known)
                self.problems.say(
                    line, f"{dotted}{name}: there is no such key{hint}; allowed: {allowed}"
                )

    def _register(self, context: Context, table: Table, key: str) -> None:
        """Note which names there are."""
        if not context.prefix:
            self._known(table, "", KEYS)
        numbers, things = self.names.numbers, self.names.things
        if "index" in table.entries and context.prefix:
            self._index(context, table, key)
        for group in ("let", "points", *GROUPS):
            node = _table(table.entries.get(group, EMPTY), _join(key, group), self.problems)
            for name, line in node.lines.items():
                where = _join(key, group, name)
                full = context.prefix + name
                known = numbers if group == "let" else things.setdefault(group, {})
                if not self._sound(name, where, line, group == "let"):
                    continue
                if full in known or (context.prefix and name in known):
                    self.problems.say(
                        line, f"{where}: the name {name} is defined twice; allowed: each name once"
                    )
                elif group == "let":
                    numbers[full] = Named(where, line, None)
                else:
                    known[full] = line
                    if group in PARTS:
                        things["parts"][full] = line
                    if group == "points":
                        self.points.append(full)
                        for axis in "xyz":
                            numbers[f"{full}.{axis}"] = Named(
                                where, line, None, unit("m").dimension
                            )

    def _index(self, context: Context, table: Table, key: str) -> None:
        node = table.entries["index"]
        name = node.value if isinstance(node, Text) else ""
        if name in self.names.numbers:
            self.problems.say(node.line, f"{key}.index: the name {name} is defined twice")
        elif self._sound(name, f"{key}.index", node.line, number=True):
            number = Named(f"{key}.index", node.line, None, NUMBER, whole=True)
            number.given = float(re.search(r"\d+(?=\.$)", context.prefix)[0])
            self.names.numbers[context.prefix + name] = number

    def _define(self, context: Context, table: Table, key: str) -> None:
        """Tie the numbers under `let` and the points' coordinates to their expressions."""
        context = Context(context.ends, context.prefix)  # a neighbour may not be there
        for group in ("let", "points"):
            node = _table(table.entries.get(group, EMPTY), "", self.problems, quiet=True)
            for name, entry in node.entries.items():
                full = context.prefix + name
                place = Place(_join(key, group, name), context, self.names)
                if group == "let":
                    targets, items = [full], [entry]
                else:
                    targets = [f"{full}.{axis}" for axis in "xyz"]
                    items = entry.items if isinstance(entry, Items) else ()
                    if len(items) != 3:
                        self.problems.refuse(
                            node.lines[name], place.key, plain(entry),
                            f"three coordinates [x, y, z]{COMMA}",
                        )  # fmt: skip
                        continue
                for target, item in zip(targets, items, strict=True):
                    if target not in self.names.numbers:
                        continue
                    try:
                        bound = place.bind(item, "an expression")
                    except SkippedError:
                        continue
                    self.names.numbers[target].bound = bound

    # -- statements ---------------------------------------------------------------------------

    def _entries(self, tables: list[tuple[Context, Table, str]]) -> Iterator[Entry]:
        for group, kinds in GROUPS.items():
            for context, table, key in tables:
                node = table.entries.get(group, EMPTY)
                for name, one in node.entries.items() if isinstance(node, Table) else ():
                    full = context.prefix + name
                    if full not in self.names.things.get(group, {}):
                        continue
                    place = Place(_join(key, group, name), context, self.names)
                    entry = read_entry(kinds, full, one, node.lines[name], place)
                    if entry is not None:
                        yield entry
                    else:
                        self.names.absent.add((group, full))
                        if group in PARTS:
                            self.names.absent.add(("parts", full))

    def _unused(self, given: Mapping[str, Given]) -> None:
        """A parameter that nothing depends on is a slip of the pen."""
        if self.problems:
            return
        for name, one in given.items():
            if name not in self.names.used:
                self.problems.say(
                    one.line, f"parameters.{name}: nothing uses it; allowed: parameters in use"
                )


def _top(entries: dict[str, Node], table: Table, place: Place) -> Entry:
    """Gravity and damping as an entry without name."""
    read = {}
    for key, node in entries.items():
        try:
            read[key] = Overall.keys[key].read(node, Place(key, place.context, place.names))
        except SkippedError:
            continue
    return Entry(Overall, "", "", 0, table.lines, read)


def _join(*parts: str) -> str:
    return ".".join(part for part in parts if part)


def _table(node: Node, key: str, problems: Problems, quiet: bool = False) -> Table:
    """The node if it is a table; an empty one, and a problem, if not."""
    if isinstance(node, Table):
        return node
    if not quiet:
        problems.refuse(node.line, key, plain(node), "a mapping from names")
    return EMPTY
