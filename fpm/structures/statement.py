"""Statements: what can be said about a structure, one function for each kind of thing.

A statement says which keys it takes, with units and limits, and how it goes into a scene. An
element's keys follow from its fields. A new joint or action is a function in `statements/`."""

import re
from collections.abc import Callable, Collection, Container, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from types import SimpleNamespace
from typing import Any

from fpm.declare import NO_VALUE, Index, Key, Number, Word, specs
from fpm.elements.joints.joint_types import TYPES
from fpm.elements.kind import ElementType
from fpm.errors import SceneError, did_you_mean, likely
from fpm.reading.standards import CLASSES
from fpm.structures.builder import Builder
from fpm.structures.keys import BuildValue, ListKey, OpeningKey, ReferenceKey
from fpm.structures.names import Place
from fpm.structures.reading import Node, Problems, SkippedError, commas, join_key, show

SLIDE = "prismatic"
ON_SLIDES = {"moment": "force", "angle": "position", "turn": "travel", "torque": "force",
             "angles": "positions", "moments": "forces"}  # fmt: skip
"""Names of keys of what acts on joints, and those of the same on slides."""

PARTS = ("bars", "bodies")
"""Groups whose things are parts: what joints join, supports hold and loads act on."""

ORDER = ("materials", "sections", *PARTS, "masses", "supports", "joints", "curves", "actions",
         "loads", "drags", "cables", "struts", "drives", "initial_velocities",
         "opening_rates", "record")  # fmt: skip
"""The groups of a file in the order in which a scene is built of them: a statement may refer to
those of groups further up."""

GROUPS: dict[str, dict[str, "Statement"]] = {group: {} for group in ORDER}
"""All kinds of statements, by group and type (statements/)."""


@dataclass(frozen=True)
class Statement:
    """A kind of thing in a `group` of a structure file, as "revolute" in `joints`. type: the
    entry's `type`, "" in groups of one kind; build(builder, args): adds one to the scene and
    returns what entries that refer to it get; args: its full `name` and the values of all keys in
    SI units (None: left out; of entries what was built); SceneError; text: what it is."""

    group: str
    type: str
    keys: dict[str, Key]
    build: Callable[[Builder, SimpleNamespace], Any]
    text: str

    def for_slides(self, joints: Container[str]) -> dict[str, tuple[str, Key]]:
        """Return the keys that an entry may write, by names as written: (name in `args`, Key); if
        it acts on a slide, `force` stands for `moment`, lengths for angles. joints: those keys of
        the entry, such as "joint", that name a slide; empty: it acts on none."""
        names = ON_SLIDES if "joint" in joints else {}
        return {names.get(n, n): (n, key.for_slides(joints)) for n, key in self.keys.items()}

    @cached_property
    def openings(self) -> dict[str, OpeningKey]:
        """Keys of the statement, by name, whose value may be an opening that is a length."""
        keys = {n: k for n, k in self.keys.items() if isinstance(k, OpeningKey) and not k.types}
        return {name: key for name, key in keys.items() if key.slides is not False}


def statement(group: str, type: str = "", text: str = "", /, **keys: Key) -> Callable:
    """Return a decorator that makes a Statement of a function build(builder, args), in GROUPS.
    text: what it is, "": the first line of the function's docstring; keys: of an entry."""

    def register(build: Callable[[Builder, SimpleNamespace], Any]) -> Statement:
        words = text or (build.__doc__ or "").split("\n")[0]
        result = Statement(group, type, keys, build, words)
        GROUPS.get(group, {})[type] = result
        return result

    return register


# -- keys that are fields of elements --------------------------------------------------------------

JOINT = OpeningKey(text="joint on whose opening it acts")
"""The key of a field `hinge`."""

CLASS = {
    "class": Word(
        None, "class in margins of a standard; default: that of its kind", values=tuple(CLASSES)
    )
}
"""The key of what has a part where an opening is moved quasi-statically (fpm/travel/)."""


def key_of(kind: type[Any], name: str, **changes: Any) -> Key:
    """Return the Key of a structure file for a field of an element type. changes: to it."""
    key = specs(kind)[name]
    if isinstance(key, Index) and key.group == "hinges":
        key = replace(JOINT, types=key.types, slides=False if key.only_angles else None)
    elif isinstance(key, Index):
        key = ReferenceKey(key.default, key.text, group=key.group)
    elif isinstance(key, Number) and key.count > 1:
        item = replace(key, default=NO_VALUE, count=1)
        key = ListKey(key.default, key.text, item, key.count, key.count)
    return replace(key, **changes)


def element(kind: type[Any], args: SimpleNamespace, **extra: Any) -> ElementType:
    """Return an element of type `kind` from an entry's `args`, `joint` standing for `hinge`. extra:
    fields that override; None or missing: defaults."""
    values = {**vars(args), "hinge": getattr(args, "joint", None), **extra}
    arguments = {f.name: values.get(f.name) for f in fields(kind)}
    arguments = {name: tuple(x) if isinstance(x, list) else x for name, x in arguments.items()}
    return kind(**{name: value for name, value in arguments.items() if value is not None})


def connector(kind: type[ElementType], text: str = "", /, **extra: Key) -> Callable:
    """Return a decorator that makes a Statement of `actions` for an element type: keys are the
    fields that have a `text`, required ones first. text: what it is, "": as in `statement`; extra:
    Keys to add or replace."""
    keys_by_field = specs(kind)
    table = {name: key_of(kind, name) for name, key in keys_by_field.items() if key.text}
    keys: dict[str, Key] = {"joint": key_of(kind, "hinge")} if "hinge" in keys_by_field else {}
    keys |= {**{name: key for name, key in extra.items() if name not in table}, **table, **extra}
    keys |= CLASS if kind.resists_as else {}
    required_first = sorted(keys.items(), key=lambda pair: pair[1].default is not NO_VALUE)
    return statement("actions", kind.noun, text, **dict(required_first))


def whole(kind: type[ElementType]) -> Statement:
    """Register and return the Statement of an element type `kind` on a joint; keys: its fields."""
    text = (kind.__doc__ or "").split("\n")[0]
    return connector(kind, text)(lambda build, args: build.scene.add(element(kind, args)))


# -- entries of a file -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Entry:
    """One entry of a structure file. key: dotted path; node: as written; read: for each key that is
    given (as in `args`), a function of the Builder that returns its value (SI units); key_names: as
    written (`force` on a slide), by names in `args`; uses: full names of numbers referred to, and
    of entries as "bars:AB"."""

    statement: Statement
    name: str
    key: str
    line: int
    node: Node
    read: dict[str, BuildValue]
    key_names: Mapping[str, str] = field(default_factory=dict)
    uses: frozenset[str] = frozenset()

    def refuse(self, error: SceneError, problems: Problems) -> None:
        """Note that the entry cannot be built, in the file's own words: a key left out as missing,
        a number with its unit as written. error: of its statement."""
        element_key = re.match(r"(\w+) of ", error.key)  # that of an element's field
        key = element_key[1] if element_key else error.key.removeprefix(f"{self.key}.")
        first, _, rest = key.partition(".")
        name = self.key_names.get(first, first)
        path, value = join_key(self.key, name, rest), show(error.value)
        if error.text:
            return problems.say(self.node.lines.get(name, self.line), f"{path}: {error.text}")
        if value_node := self.node.entries.get(name):
            if isinstance(error.value, float) and re.search("[a-zA-Z]", value_node.text):
                value = f"{value} ({value_node.text!r})"
            sentence = f"{path}: {value} is not allowed"
        elif error.value is None:
            sentence = f"{path}: missing"
        elif first not in self.statement.keys:
            sentence = f"{', '.join(filter(None, (self.key, error.key)))}: {value} is not allowed"
        else:
            sentence = f"{self.key}: `{name}`, left out, is {value}"
        problems.say(self.node.lines.get(name, self.line), f"{sentence}; allowed: {error.allowed}")

    def values(self, build: Builder) -> SimpleNamespace:
        """Return the values of all keys in the sample of `build` (SI units, defaults where left
        out), and `name` and `key` of the entry, as a namespace: `args` of Statement.build."""
        args = SimpleNamespace(name=self.name, key=self.key)
        for name, key in self.statement.keys.items():
            setattr(args, name, self.read[name](build) if name in self.read else key.default)
        return args


def read_entry(
    kinds: dict[str, Statement], name: str, node: Node, line: int, place: Place
) -> Entry | None:
    """Return one entry of a group; None if it is left out: wrong, which is noted, or with a
    neighbour that does not exist. kinds: the group's Statements by type."""
    try:
        if not node.is_table:
            value = node.value if isinstance(node.value, str) else "a list"
            place.problems.refuse(line, place.key, value, "a mapping of keys")
            return None
        keys = {key for kind in kinds.values() for key in ("type", *kind.for_slides(()))}
        deep = [name for name in node.entries if name not in keys and len(node.entries) == 1]
        if deep and keys & node.entries[deep[0]].entries.keys():
            text = f"its keys stand one level too deep; allowed: directly below {place.key}"
            place.problems.say(node.lines[deep[0]], f"{place.key}.{deep[0]}: {text}")
            return None
        plain, types = kinds.get(""), {type: kind for type, kind in kinds.items() if type}
        type_keys = {"type", *(key for kind in types.values() for key in kind.keys)}
        if plain is None or (types and (type_keys - plain.keys.keys()) & node.entries.keys()):
            statement = _statement(types, node, place)
        else:
            statement = plain
        slides = _slides(statement, node, place)
        read = _read_keys(statement, slides, node, line, place)
    except SkippedError:
        return None
    key_names = {name: key for key, (name, _) in statement.for_slides(slides).items()}
    return Entry(statement, name, place.key, line, node, read, key_names)


def _statement(kinds: Mapping[str, Statement], node: Node, place: Place) -> Statement:
    """Return the group's kind to which an entry belongs."""
    type_node, key = node.entries.get("type"), f"{place.key}.type"
    if type_node is None:
        typo = likely("type", node.entries)
        hint = f" (is `{typo}` meant to be `type`?)" if typo else ""
        place.problems.say(node.line, f"{key}: missing{hint}; allowed: {commas(kinds)}")
    elif type_node.text not in kinds:
        allowed = f"is not allowed{did_you_mean(type_node.text, kinds)}; allowed: {commas(kinds)}"
        place.problems.say(type_node.line, f"{key}: {type_node.text!r} {allowed}")
    else:
        return kinds[type_node.text]
    raise SkippedError(key)


def _slides(statement: Statement, node: Node, place: Place) -> list[str]:
    """Keys of an entry that name slides; SkippedError if one names a joint of unknown type."""
    keys, types, openings = [], place.names.types, place.names.openings
    for key in statement.openings.keys() & node.entries.keys():
        text = node.entries[key].text
        try:
            full = place.context.find(text, types.keys() | openings.keys())
        except SkippedError:  # of a neighbour that is not there: as of the unit itself
            full = place.context.prefix + text.partition(".")[2]
        except KeyError:
            continue
        joint, number = openings.get(full, (full, 0))
        if not types.get(joint):
            raise SkippedError(full)
        kinds = TYPES[types[joint]].openings
        keys += [key] * any(kind.direction for kind in kinds[number : number + 1])
    return keys


def _read_keys(
    statement: Statement, slides: list[str], node: Node, line: int, place: Place
) -> dict[str, BuildValue]:
    """Return the values of an entry's keys by name; SkippedError if any is wrong."""
    keys, is_sound = statement.for_slides(slides), True
    read: dict[str, BuildValue] = {}
    corrections: set[str] = set()  # keys that misspelt ones stand for
    allowed = [*(["type"] if statement.type else []), *keys]
    for key, entry in node.entries.items():
        if key in keys:
            name, kind = keys[key]
            try:
                read[name] = kind.read(entry, place.child(key))
            except SkippedError:
                is_sound = False
        elif key not in allowed:
            is_sound = False
            likely_name, hint = _likely_key(key, statement.keys, allowed)
            corrections.add(likely_name)
            place.problems.no_key(node.lines[key], f"{place.key}.{key}", allowed, hint)
    for key, (_, kind) in keys.items():
        if kind.default is NO_VALUE and key not in node.entries and key not in corrections:
            is_sound = False
            options = commas(kind.options(place) if isinstance(kind, OpeningKey) else ())
            words = kind.allowed if "(" in options else options
            place.problems.say(line, f"{place.key}.{key}: missing; allowed: {words}")
    if not is_sound:
        raise SkippedError(place.key)
    return read


def _likely_key(key: str, on_hinges: Collection[str], keys: list[str]) -> tuple[str, str]:
    """Return the known key that an unknown one probably means, and a hint. on_hinges: keys."""
    if key in on_hinges:
        return ON_SLIDES[key], f" on a slide, where it is {ON_SLIDES[key]}"
    for name in on_hinges:
        if ON_SLIDES.get(name) == key and "joint" in keys:
            return name, f" on a hinge, where it is {name}"
    return likely(key, keys), did_you_mean(key, keys)
