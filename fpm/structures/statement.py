"""Statements: what can be said about a structure, one function for each kind of thing.

A statement says which keys it takes, with units and ranges, and how it goes into a scene. A new
kind of joint or action is one such function in a file of `statements/`, and one line in its list.
"""

from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

from fpm.errors import did_you_mean, likely
from fpm.structures.builder import Builder
from fpm.structures.keys import REQUIRED, Key, Opening
from fpm.structures.place import Place
from fpm.structures.problems import SkippedError, among
from fpm.structures.reading import Table, Text

SLIDE = "prismatic"
ON_SLIDES = {"moment": "force", "angle": "position", "turn": "travel", "torque": "force",
             "angles": "positions", "moments": "forces"}  # fmt: skip
"""Names of keys of what acts on joints, and those of the same on slides."""

PARTS = ("bars", "bodies")
"""Groups whose things are parts: what joints join, supports hold and loads act on."""


@dataclass(frozen=True)
class Statement:
    """A kind of thing in a group of the file.

    group: the file's key; type: the entry's `type`, "" in groups of one kind; keys: what it takes,
    by name; build(build, it): puts one into the scene of a Builder and returns what others get that
    refer to it, `it` having the full `name` and the values of all keys; SceneError for what cannot
    be. about: what it is, as docs/structures.md says. fields: of `it`, by keys of other names.
    """

    group: str
    type: str
    keys: dict[str, Key]
    build: Callable[[Builder, SimpleNamespace], Any]
    fields: Mapping[str, str] = field(default_factory=dict)

    @property
    def about(self) -> str:
        """The first line of the building function's docstring."""
        return (self.build.__doc__ or "").split("\n")[0]

    def sliding(self, joints: Container[str]) -> "Statement":
        """The statement where `joints`, of its keys, name slides: units and names are others."""
        if not joints:
            return self
        named = {(ON_SLIDES.get(n, n) if "joint" in joints else n): n for n in self.keys}
        keys = {name: self.keys[n].sliding(joints) for name, n in named.items()}
        return replace(self, keys=keys, fields=named)


def statement(group: str, type: str = "", **keys: Key) -> Callable[[Callable], Statement]:
    """Make a kind of statement of the function that builds it."""
    return lambda build: Statement(group, type, keys, build)


@dataclass(frozen=True)
class Entry:
    """A statement as a file makes it. `read`: what its keys' `read` found; `lines` of its keys."""

    statement: Statement
    name: str
    key: str
    line: int
    lines: dict[str, int]
    read: dict[str, Any]

    def values(self, build: Builder) -> SimpleNamespace:
        """The values of all keys in one sample."""
        it = SimpleNamespace(name=self.name, key=self.key)
        for name, kind in self.statement.keys.items():
            given = name in self.read
            value = kind.value(self.read[name], build, name) if given else kind.default
            setattr(it, self.statement.fields.get(name, name), value)
        return it


def read_entry(
    kinds: dict[str, Statement], name: str, node: Any, line: int, place: Place
) -> Entry | None:
    """The entry of a node, or None if it is wrong, or belongs to a neighbour that is not there."""
    problems = place.problems
    if not isinstance(node, Table):
        problems.refuse(line, place.key, getattr(node, "value", "a list"), "a mapping of keys")
        return None
    statement = _statement(kinds, node, place)
    if statement is None:
        return None
    try:
        slides = _slides(statement, node, place)
    except SkippedError:
        return None
    turning, statement = statement, statement.sliding(slides)
    sound, read, meant = True, {}, set()
    for key, entry in node.entries.items():
        if key in statement.keys:
            try:
                read[key] = statement.keys[key].read(entry, place.inside(key))
            except SkippedError:
                sound = False
        elif key != "type" or not statement.type:
            sound = False
            known = [*(["type"] if statement.type else []), *statement.keys]
            other, hint = _meant(key, turning, known)
            meant.add(other)
            problems.say(
                node.lines[key],
                f"{place.key}.{key}: there is no such key{hint}; allowed: {', '.join(known)}",
            )
    for key, kind in statement.keys.items():
        if kind.default is REQUIRED and key not in node.entries:
            if key in meant:
                continue  # told already
            sound = False
            problems.say(line, f"{place.key}.{key}: missing; allowed: {kind.allowed}")
    return Entry(statement, name, place.key, line, node.lines, read) if sound else None


def _meant(key: str, turning: Statement, known: list[str]) -> tuple[str, str]:
    """Which of the known keys of a statement is meant by another, and the hint that says so;
    turning: the statement as it is on hinges."""
    if key in turning.keys:
        return ON_SLIDES[key], f" on a slide, where it is {ON_SLIDES[key]}"
    for name in turning.keys:
        if ON_SLIDES.get(name) == key and "joint" in known:
            return name, f" on a hinge, where it is {name}"
    return likely(key, known), did_you_mean(key, known)


def _slides(statement: Statement, node: Table, place: Place) -> list[str]:
    """The keys of an entry that name slides; SkippedError if one names a joint of which nobody can
    tell what it is."""
    found = []
    for key, kind in statement.keys.items():
        takes = isinstance(kind, Opening) and SLIDE in kind.types
        if takes and isinstance(entry := node.entries.get(key), Text):
            types = place.names.types
            try:
                full = place.context.find(entry.value, types)
            except SkippedError:  # of a neighbour that is not there: as of the unit itself
                full = place.context.prefix + entry.value.partition(".")[2]
            except KeyError:
                continue
            if not types.get(full):
                raise SkippedError(full)
            if types[full] == SLIDE:
                found.append(key)
    return found


def _statement(kinds, node: Table, place: Place) -> Statement | None:
    """Which of the group's kinds the entry is."""
    if "" in kinds:
        return kinds[""]
    given = node.entries.get("type")
    if given is None:
        place.problems.say(node.line, f"{place.key}.type: missing; allowed: {among(kinds)}")
        return None
    name = given.value if isinstance(given, Text) else ""
    if name not in kinds:
        allowed = among(kinds)
        hint = did_you_mean(name, kinds)
        place.problems.say(
            given.line, f"{place.key}.type: {name!r} is not allowed{hint}; allowed: {allowed}"
        )
        return None
    return kinds[name]
