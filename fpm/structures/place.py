"""A place in a structure's file, where values are read: what is known there, what is wrong."""

import re
from dataclasses import dataclass
from keyword import iskeyword

from fpm.errors import did_you_mean, likely
from fpm.structures.expressions import RESERVED, ExpressionError, parse
from fpm.structures.names import NEIGHBOURS, Bound, Context, Names
from fpm.structures.problems import Problems, SkippedError, show
from fpm.structures.reading import Node, Table, Text, plain
from fpm.structures.units import Dimension, is_unit

EMPTY = Table({}, {}, 0)


@dataclass(frozen=True)
class Place:
    """Where a value is written: its key, in sentences, and what is known there."""

    key: str
    context: Context
    names: Names

    @property
    def problems(self) -> Problems:
        """Where to note what is wrong."""
        return self.names.problems

    def inside(self, name: str) -> "Place":
        """The place of a key in this one."""
        return Place(f"{self.key}.{name}", self.context, self.names)

    def refuse(self, node: Node, allowed: str) -> None:
        """Note that this place's value is not allowed, and leave out what it belongs to."""
        self.problems.refuse(node.line, self.key, plain(node), allowed)
        raise SkippedError(self.key)

    def bind(self, node: Node, allowed: str) -> Bound:
        """The expression at this place with its names found."""
        if not isinstance(node, Text) or not node.value:
            self.refuse(node, allowed)
        try:
            expression = parse(node.value)
        except ExpressionError as error:
            self.problems.say(node.line, f"{self.key}: {show(node.value)}: {error}")
            raise SkippedError(self.key) from None
        full = {}
        for name in sorted(expression.names):
            try:
                full[name] = self.context.find(name, self.names.numbers)
            except KeyError:
                known = self.names.numbers
                self.names.unknown(node.line, self.key, name, known, "number called")
        if len(full) < len(expression.names):
            raise SkippedError(self.key)
        self.names.used.update(full.values())
        return Bound(expression, full)

    def number(self, node: Node, wanted: Dimension | None, allowed: str, angle=False) -> Bound:
        """An expression of the dimension that is wanted; an angle's unit must be said."""
        bound = self.bind(node, allowed)
        try:
            found = bound.dimension(self.names.numbers)
            zero = bound.expression.bare and bound.value({}) == 0
        except ExpressionError as error:
            self.problems.say(node.line, f"{self.key}: {show(node.value)}: {error}")
            raise SkippedError(self.key) from None
        if wanted is not None and not found.bare and found.powers != wanted.powers:
            self.problems.say(
                node.line, f"{self.key}: {show(node.value)} is {found}; allowed: {allowed}"
            )
            raise SkippedError(self.key)
        if angle and found.bare and not zero:
            self.refuse(node, f"{allowed}, whose unit must be said, such as 90 deg or 1.5 rad")
        return bound

    def reference(self, node: Node, group: str) -> str:
        """The full name of something in a group."""
        what = group.removesuffix("s")
        if not isinstance(node, Text):
            self.refuse(node, f"the name of a {what}")
        known = self.names.things.get(group, {})
        try:
            full = self.context.find(node.value, known)
        except KeyError:
            self.names.unknown(node.line, self.key, node.value, known, what)
            raise SkippedError(self.key) from None
        if (group, full) in self.names.absent:
            raise SkippedError(full)
        self.names.used.add(f"{group}:{full}")
        return full


def table_at(node: Table, name: str, key: str, problems: Problems) -> Table:
    """The table under a key; an empty one if there is none, or, with a problem, no table."""
    found = node.entries.get(name, EMPTY)
    if isinstance(found, Table):
        return found
    problems.refuse(found.line, joined(key, name), plain(found), "a mapping from names")
    return EMPTY


def joined(*parts: str) -> str:
    """Keys with dots between them."""
    return ".".join(part for part in parts if part)


def as_meant(node: Table, known: tuple[str, ...], problems: Problems) -> Table:
    """The table with keys that are likely others under those: told, but not what follows of it."""
    entries, lines = dict(node.entries), dict(node.lines)
    for name in node.entries.keys() - set(known):
        meant = likely(name, known)
        if meant and meant not in entries:
            check_keys(Table({name: node.entries[name]}, node.lines, 0), "", known, problems)
            entries[meant], lines[meant] = entries.pop(name), lines.pop(name)
    return Table(entries, lines, node.line)


def check_keys(node: Table, key: str, known: tuple[str, ...], problems: Problems) -> None:
    """Note the keys that mean nothing."""
    for name in node.entries.keys() - set(known):
        problems.say(
            node.lines[name],
            f"{joined(key, name)}: there is no such key{did_you_mean(name, known)}; "
            f"allowed: {', '.join(known)}",
        )


def is_name(name: str, key: str, line: int, problems: Problems, number: bool = False) -> bool:
    """Whether something, or a number, may be called so; a problem if not."""
    reserved = name in (*NEIGHBOURS, "first", "last", "ground")
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or reserved:
        why = "letters, digits and _ after a letter; not ground, next, previous, first, last"
    elif number and is_unit(name):
        why = "a name that is not a unit"
    elif name in RESERVED or iskeyword(name):
        why = "a name that is no function and no word of Python's"
    else:
        return True
    problems.say(line, f"{key}: the name {name!r} is not allowed; allowed: {why}")
    return False
