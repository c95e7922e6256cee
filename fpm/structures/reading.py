"""A YAML file as nodes that know their lines, and all that is wrong with it, told at once.

A key may be given once, and is text. Of structures nothing is converted: whether `1e9` is a number,
or `on` a name, is up to the key it belongs to."""

import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import takewhile
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import yaml

from fpm.errors import SceneError, did_you_mean, fold_name, likely
from fpm.files.seals import DamagedError, read_bytes

DEEPEST, MOST = 20, 20_000
"""Mappings and lists of a file may be nested so deep, and hold so many values."""

EMPTY = "the file is empty; allowed: a mapping of keys, as in a folder that `new` makes"

LARGEST = 1 << 20
"""Size (bytes) that a text file may have."""


class Problem(NamedTuple):
    """What is wrong in a file. line: from 1 (0: unknown); text: sentence starting with the key."""

    line: int
    text: str

    def __str__(self) -> str:
        return f"line {self.line}: {self.text}" if self.line else self.text


class StructureError(SceneError):
    """Raised for a structure that cannot be built. source: name of its file; problems: list of all
    that is wrong, also in the message. As a SceneError it has `key`, `value`, `allowed` too."""

    def __init__(self, source: str, problems: list[Problem]):
        self.source, self.problems = source, list(problems)
        super().__init__("structure", source, "a file without problems")
        count = "1 problem" if len(problems) == 1 else f"{len(problems)} problems"
        self.args = (f"{source} has {count}:\n" + "\n".join(f"  {p}" for p in problems),)

    def __reduce__(self):
        return type(self), (self.source, self.problems)


NO_PROGRAM = (
    "a structure is a text file, and this is a Python file; allowed: a `.yaml` file, which the "
    "method `write` of an `fpm.Structure` makes"
)


def read_text(path: str | Path) -> str:
    """Return the text of the UTF-8 file at `path`, at most 1 MiB; else StructureError."""
    if Path(path).suffix == ".py":
        raise StructureError(str(path), [Problem(0, NO_PROGRAM)])
    try:
        return read_bytes(path, LARGEST).decode("utf-8").replace("\r\n", "\n").replace("\r", "\n")
    except (OSError, ValueError) as error:
        damage = error.reason if isinstance(error, DamagedError) else ""
        reason = damage or getattr(error, "strerror", None) or str(error)
        if isinstance(error, UnicodeDecodeError):
            line = error.object.count(b"\n", 0, error.start) + 1
            reason = f"line {line} is not UTF-8 text; allowed: a YAML file, saved as UTF-8"
        if isinstance(error, FileNotFoundError):  # where it was sought, and a similar name there
            folder = next(p for p in Path(path).absolute().parents if p.is_dir())
            names = map(os.path.relpath, sorted(folder.glob("*.yaml")))
            reason += f" in {folder}{did_you_mean(str(path), names)}"
        if "\n" in str(path):
            lines, path = len(str(path).splitlines()), str(path).splitlines()[0]
            reason = f"{lines} lines of text are not a path; allowed: a path, or a dict of sections"
        elif Path(path).is_dir():
            reason = "it is a folder; allowed: a YAML file"
        problem = Problem(0, f"the file cannot be read: {reason}")
        raise StructureError(repr(path) if "\0" in str(path) else str(path), [problem]) from None


class SkippedError(Exception):
    """Raised to leave out an entry of a structure file, without a message: it refers to something
    that is wrong, which is noted already, or to the neighbour after a row's last unit."""


@dataclass(frozen=True)
class Node:
    """Node of a YAML file. value: text or what YAML means by it, list of Nodes, or dict of Nodes;
    line: from 1 (0: unknown); lines: of a table, line of each key."""

    value: "str | list[Node] | dict[str, Node] | Any"
    line: int = 0
    lines: dict[str, int] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The node's text, its letters spelt as in keys; "" if it is a list or a table."""
        return fold_name(self.value) if isinstance(self.value, str) else ""

    @property
    def items(self) -> "list[Node]":
        """The node's list; [] if it is a text or a table."""
        return self.value if isinstance(self.value, list) else []

    @property
    def entries(self) -> "dict[str, Node]":
        """The node's table, Nodes by key; {} if it is a text or a list."""
        return self.value if isinstance(self.value, dict) else {}

    @property
    def is_table(self) -> bool:
        """Whether the node is a mapping of keys."""
        return isinstance(self.value, dict)

    @property
    def plain(self) -> object:
        """Return the node as plain dicts, lists and values, without lines."""
        if self.is_table:
            return {name: entry.plain for name, entry in self.entries.items()}
        return [item.plain for item in self.items] if isinstance(self.value, list) else self.value


class Problems:
    """Problems noted so far of one file, false if there are none; equal ones of the units of a
    repeat, and those of a name that does not exist, count once. source: name of the file in
    messages."""

    def __init__(self, source: str):
        self.source = source
        self._problems: dict[tuple[int, str], Problem] = {}

    def __bool__(self) -> bool:
        return bool(self._problems)

    def say(self, line: int, sentence: str) -> None:
        """Note a problem on a line (from 1; 0: none); sentence: what is wrong, first its key."""
        text = sentence
        if sentence.startswith("repeat."):  # those of its units differ in numbers only
            text = re.sub(r"\d[\d.e+-]*", "", sentence)
        key, cause = (line, text), text.partition(": ")[2].partition(";")[0]
        if cause.startswith("there is no ") and "'" in cause:  # wherever the name is used
            key = 0, cause
        self._problems.setdefault(key, Problem(line, sentence))

    def refuse(self, line: int, key: str, value: object, allowed: str, hint: str = "") -> None:
        """Note that a key (dotted path) on a line has a value not `allowed` (what is, in words).
        hint: what may be meant, as " (did you mean x?)", or ""."""
        self.say(line, f"{key}: {show(value)} is not allowed{hint}; allowed: {allowed}")

    def no_key(self, line: int, key: str, keys: Iterable[str], hint: str) -> None:
        """Note an unknown key. keys: those allowed; hint: what may be meant, or ""."""
        allowed = commas(keys, 6 if hint else 99)
        self.say(line, f"{key}: there is no such key{hint}; allowed: {allowed}")

    def stop(self) -> None:
        """Raise all problems as one StructureError, sorted by line, if there are any."""
        if self._problems:
            raise StructureError(self.source, sorted(self._problems.values()))


def show(value: object) -> str:
    """Return a value as text for messages, cut to at most 60 characters."""
    text = f"{value:.9g}" if isinstance(value, float) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def commas(names: Iterable[str], most: int = 12, rest: str = ", and {} more") -> str:
    """Return names joined by commas for a sentence, the first `most` of them, "(there is none)"
    without names; rest: text in place of the others, {} their number."""
    names = list(names)
    text = ", ".join(names[:most]) or "(there is none)"
    return text if len(names) <= most else text + rest.format(len(names) - most)


def join_key(*parts: str) -> str:
    """Return `parts` joined by dots, without empty ones: the path of a key, "joints.knee.axis"."""
    return ".".join(part for part in parts if part)


def read(
    text: str, problems: Problems, is_typed: bool = False, names: tuple[str, ...] = ()
) -> Node:
    """Return the top table of a YAML text as a Node; StructureError for what is wrong, with what
    was noted before. is_typed: whether values are what YAML means by their texts, and tags are
    allowed; else all values are text; names: keys whose values are text in any case."""
    loaders = [yaml.BaseLoader]
    if yaml.__with_libyaml__ and not {"\t", "?", "\ufeff"} & {*text}:  # which it reads otherwise
        loaders.insert(0, yaml.CBaseLoader)  # ten times faster; its words are not those below
    for loader in loaders:
        try:
            root = _Reader(yaml.parse(text, loader), problems, is_typed, names).document()
            break
        except StructureError:
            raise
        except (yaml.YAMLError, ValueError, OverflowError) as error:  # as of an escaped character
            if loader is loaders[-1]:
                problems.say(*_why_not_yaml(error, text))
                problems.stop()
    if root.value in ("", None):
        problems.say(0, EMPTY)
    elif not root.is_table:
        problems.say(root.line, "the file is not a mapping; allowed: a mapping of keys")
    problems.stop()
    return root


_NOT_YAML = (  # what PyYAML says, whether it is where that begins, and what to do
    (r"'\\\\?t'", False, "a tab; allowed: spaces"),
    ("expected ':'", True, "a colon is missing; allowed: `key: value`"),
    ("got ':'", False, "this text has a colon; allowed: text with a colon in quotes"),
    ("flow", True, "the bracket that opens here is not closed, a comma is missing behind it, or an "
     "expression with brackets lacks quotes"),
    ("quoted", True, "the quotes that open here are not closed"),
    ("not allowed here", False, "a colon too many; allowed: one key on each line, what belongs to "
     "it indented below, and text with a colon in quotes"),
    ("block", False, "this is indented otherwise than what it belongs to, lacks a colon, or begins "
     "with [ and lacks quotes"),
    ("cannot start|alias", False, "nothing begins with this sign; allowed: text in quotes"),
)  # fmt: skip


def _why_not_yaml(error: Exception, text: str) -> tuple[int, str]:
    """Return the line (from 1; 0: unknown) where a text is not YAML, and why, by PyYAML's error."""
    if isinstance(error, yaml.reader.ReaderError):
        line = text.count("\n", 0, error.position) + 1
        return line, f"the character {chr(error.character)!r} is not text"
    if not isinstance(error, yaml.MarkedYAMLError):
        return 0, f"this is not YAML: {error}"
    mark, words = _reason(error)
    lines = ["", *text.splitlines()]
    line = mark.line + 1 if mark else 0
    if line < len(lines) and (key := re.search(r"[{,]\s*\w+:\s[^,{}]*\s(\w+):", lines[line])):
        return line, f"this is not YAML: a comma is missing before `{key[1]}:`"
    if "colon" in words and line < len(lines):
        indent = re.sub(r"[^ -].*", "", lines[line], flags=re.S)
        previous = max([n for n in range(1, line) if lines[n].strip()], default=line)
        if key := re.fullmatch(r"[ -]*(\w+):[^\s/].*", lines[previous]):
            return previous, f"this is not YAML: a space is missing behind `{key[1]}:`"
        numbers = (previous, line) if "too many" in words else (line,)
        for number in numbers:  # a key and its value without a colon between
            key = re.fullmatch(rf"{indent}(\w+)(| +[^:#]*| *[{{\[].*)", lines[number])
            if key and (number < line or "too many" not in words):
                value = key[2].strip()[:40] + "..." * (len(key[2].strip()) > 40)
                name = key[1][:100] + "..." * (len(key[1]) > 100)
                words = f"a colon is missing; allowed: `{f'{name}: {value}'.strip()}`"
                return number, f"this is not YAML: {words}"
    return line, f"this is not YAML: {words}"


def _reason(error: yaml.MarkedYAMLError) -> tuple[yaml.Mark | None, str]:
    """Describe where and why a text is not YAML, from PyYAML's error."""
    start, end = error.context_mark, error.problem_mark
    problem = ", ".join(part for part in (error.context, error.problem) if part)
    for pattern, is_at_start, words in _NOT_YAML:
        if re.search(pattern, problem):
            return start if start and is_at_start else end, words
    return end or start, problem


class _Types(yaml.constructor.SafeConstructor, yaml.resolver.Resolver):
    """What YAML means by a text; but dates are text, and numbers are those of YAML 1.2, of which
    `1e9` is one, `010` is ten, and `1:30` is none."""

    yaml_implicit_resolvers: ClassVar = {
        first: [(tag, rule) for tag, rule in rules if tag.endswith((":bool", ":null"))]
        for first, rules in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }

    def __init__(self):
        yaml.constructor.SafeConstructor.__init__(self)
        yaml.resolver.Resolver.__init__(self)

    def value(self, event: yaml.ScalarEvent) -> Any:
        """Return the value of a text, by its tag, if it has one."""
        tag = {"!": None}.get(event.tag, event.tag)
        tag = tag or self.resolve(yaml.ScalarNode, event.value, event.implicit)
        node = yaml.ScalarNode(tag, event.value, event.start_mark)
        return self.construct_object(node, deep=True)


_INT = r"[-+]?\d[\d_]*$|0x[\da-fA-F]+$"
_FLOAT = (
    r"[-+]?(\d[\d_]*\.?[\d_]*|\.\d[\d_]*)([eE][-+]?\d+)?$|[-+]?\.(inf|Inf|INF)$|\.(nan|NaN|NAN)$"
)
for _tag, _form in {"int": _INT, "float": _FLOAT}.items():
    _Types.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", re.compile(_form), [*"-+0123456789."])
_Types.add_constructor(
    "tag:yaml.org,2002:int",
    lambda types, node: int(node.value, 16 if node.value.startswith("0x") else 10),
)


_PLAIN = ("!", "tag:yaml.org,2002:map", "tag:yaml.org,2002:seq")
"""Tags of mappings and lists that are those without a tag."""


class _Reader:
    """Makes Nodes of the events of a YAML text, and stops at what is too large."""

    def __init__(
        self, events: Iterator[yaml.Event], problems: Problems, is_typed: bool, names: tuple
    ):
        self.events, self.problems = events, problems
        self.types = _Types() if is_typed else None
        self.anchors: dict[str, Node] = {}
        self.count, self.key, self.names = 0, "", names

    def document(self) -> Node:
        """Return the only document of the text."""
        root = Node("")
        for event in self.events:
            if isinstance(event, yaml.DocumentStartEvent):
                if self.count:
                    problem = "expected a single document in the stream, but found another document"
                    raise yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)
                root = self._node(next(self.events), 0)
        return root

    def _stop(self, line: int, sentence: str) -> None:
        self.problems.say(line, sentence)
        self.problems.stop()

    def _count(self, node: Node, line: int, depth: int) -> None:
        """Count a node, and what is in it already, against the limits."""
        self.count += 1
        if depth > DEEPEST:
            text = f"nested too deep; allowed: {DEEPEST} mappings and lists in each other"
            self._stop(line, text)
        if self.count > MOST:
            self._stop(0, f"the file holds more than {MOST} values; allowed: fewer")
        for child in (*node.items, *node.entries.values()):
            self._count(child, line, depth + 1)

    def _node(self, event: yaml.Event, depth: int, is_key: bool = False) -> Node:
        line, anchor, tag = event.start_mark.line + 1, event.anchor, getattr(event, "tag", None)
        if tag and not self.types:
            self._stop(line, f"the tag {tag!r} is not allowed; allowed: none")
        if tag and not isinstance(event, yaml.ScalarEvent) and tag not in _PLAIN:
            self.problems.say(line, f"the tag {tag!r} is not allowed; allowed: none")
        is_alias = isinstance(event, yaml.AliasEvent)
        if is_alias and anchor not in self.anchors:
            text = f"*{anchor} stands for what &{anchor} marks, and nothing above is marked so"
            self._stop(line, f"{text}; allowed: the value itself, or &{anchor} before one above")
        node = self.anchors[anchor] if is_alias else Node("", line)
        self._count(node, line, depth)
        if isinstance(event, yaml.ScalarEvent):
            node = Node(self._value(event, line, is_key), line)
        elif isinstance(event, yaml.SequenceStartEvent):
            node = Node([self._node(item, depth + 1) for item in self._rest()], line)
        elif isinstance(event, yaml.MappingStartEvent):
            node = self._table(line, depth)
        if anchor:
            self.anchors[anchor] = node
        return node

    def _rest(self) -> Iterator[yaml.Event]:
        """Return the nodes up to the end of a list or mapping."""
        return takewhile(lambda e: not isinstance(e, yaml.CollectionEndEvent), self.events)

    def _value(self, event: yaml.ScalarEvent, line: int, is_key: bool) -> Any:
        """Return a scalar, the value of `self.key` unless it is a key itself: its text if the file
        has no types, or if it is a key or a name without quotes; else what its type makes of it.
        None if it cannot be read, which is a problem."""
        if is_key or (self.types and self.key != "file"):
            event.value = fold_name(event.value)  # names are equal in any spelling of their letters
        is_name = (is_key or self.key in self.names) and event.implicit[0]
        if is_name or not self.types:
            return event.value.strip()
        try:
            return self.types.value(event)
        except (ValueError, ArithmeticError, LookupError, TypeError, AttributeError) as error:
            self.problems.say(line, f"a value cannot be read: {error}")

    def _table(self, line: int, depth: int) -> Node:
        table, bases = Node({}, line), []
        for event in self._rest():
            key, key_line = self._node(event, depth + 1, True), event.start_mark.line + 1
            self.key = key.value if isinstance(key.value, str) else ""
            value, name = self._node(next(self.events), depth + 1), key.value
            items = value.items if isinstance(value.value, list) else [value]
            is_merge = name == "<<" and isinstance(event, yaml.ScalarEvent) and event.implicit[0]
            if isinstance(name, list | dict):
                self.problems.say(key_line, "a key is a mapping or a list; allowed: a name")
            elif not isinstance(name, str):
                self.problems.say(key_line, f"the key {name!r} has a tag; allowed: text")
            elif name in table.entries:
                first = f"(first on line {table.lines[name]})"
                text = f"{name} is defined twice {first}; allowed: each key once"
                self.problems.say(key_line, text)
            elif is_merge and all(item.is_table for item in items):
                bases += items
            else:
                table.entries[name], table.lines[name] = value, key_line
        for base in bases:  # what YAML calls a merge
            for name, line in base.lines.items():
                table.lines.setdefault(name, line)
                table.entries.setdefault(name, base.entries[name])
        return table


def table_at(node: Node, name: str, key: str, problems: Problems) -> Node:
    """Return the table under the key `name` of the table `node`; empty if there is none or, which
    is noted in `problems`, it is not a table. key: dotted path of `node`, for messages."""
    table = node.entries.get(name, Node({}))
    if not table.is_table:
        problems.refuse(table.line, join_key(key, name), table.plain, "a mapping from names")
    return table if table.is_table else Node({})


OF_CAMPAIGNS = {"campaign", "scene", "solver", "intervals", "design", "responses", "quantities",
                "requirements"}  # fmt: skip
"""Keys by which a campaign's file is known, with which people come here."""


PREFIXES = ("x-", ".")
"""Beginnings of keys at the top of a file that are ignored: they hold what anchors mark."""

OTHER_KEYS = {"patternProperties": {r"^(x-|\.)": {}}, "additionalProperties": False}
"""What JSON Schema says of keys that a file does not have: those ignored are allowed."""


def check_keys(node: Node, key: str, keys: tuple[str, ...], problems: Problems) -> None:
    """Note in `problems` each key of the table `node`, of path `key`, that is not allowed."""
    for name in node.entries.keys() - set(keys):
        hint = did_you_mean(name, keys)
        if not hint and not key and name in OF_CAMPAIGNS:
            hint = " (it stands in the file of a campaign)"
        problems.no_key(node.lines[name], join_key(key, name), keys, hint)


def correct_keys(node: Node, keys: tuple[str, ...], problems: Problems) -> Node:
    """Return the file's top table `node` without keys that are ignored, and with misspelt ones
    renamed to those of `keys`, the allowed ones, that are likely meant; each misspelling is noted
    in `problems`."""
    tables = {name: entry for name, entry in node.entries.items() if not name.startswith(PREFIXES)}
    node = Node(tables, node.line, node.lines)
    check_keys(node, "", keys, problems)
    fixes = {name: likely(name, keys) for name in node.entries.keys() - set(keys)}
    names = {n: n if fixes.get(n, n) in node.entries else fixes[n] or n for n in node.entries}
    entries = {names[name]: entry for name, entry in node.entries.items()}
    return Node(entries, node.line, {names[name]: node.lines[name] for name in node.entries})
