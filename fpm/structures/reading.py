"""YAML as tables, lists and text that know their lines.

Nothing is converted: whether `1e9` is a number, or `on` a name, is up to the key it belongs to.
A key may be given once; anchors and tags are refused, because names and `let` do their work.
"""

from dataclasses import dataclass

import yaml

from fpm.structures.problems import Problems

DEEPEST = 20
"""Tables and lists may be nested so deep."""


@dataclass(frozen=True)
class Text:
    """A single value, as it is written."""

    value: str
    line: int


@dataclass(frozen=True)
class Items:
    """A list."""

    items: tuple["Node", ...]
    line: int


@dataclass(frozen=True)
class Table:
    """A mapping from names to nodes; `lines` has the line of every key."""

    entries: dict[str, "Node"]
    lines: dict[str, int]
    line: int


Node = Text | Items | Table


def read(text: str, problems: Problems) -> Table:
    """The table that a file's text holds; raises StructureError when it holds none."""
    try:
        root = yaml.compose(text, _Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        what = ", ".join(part for part in (error.context, error.problem) if part)
        problems.say(mark.line + 1 if mark else 0, f"this is not a structure's file: {what}")
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        problems.say(0, f"this is not a structure's file: {str(error).splitlines()[0]}")
    else:
        node = _convert(root, problems, 0) if root else Text("", 0)
        if not isinstance(node, Table):
            problems.say(node.line, "the file is no table; allowed: a mapping of keys")
    problems.stop()
    return node


class _Loader(yaml.BaseLoader):
    """Text stays text; anchors, aliases and tags are refused where they stand."""

    def compose_node(self, parent, index):
        event = self.peek_event()
        marks = [getattr(event, name, None) for name in ("anchor", "tag")]
        if any(marks):
            raise yaml.MarkedYAMLError(
                problem=f"the anchor, alias or tag {marks[0] or marks[1]!r} is not allowed; "
                "allowed: a name under `let`",
                problem_mark=event.start_mark,
            )
        return super().compose_node(parent, index)


def plain(node: Node) -> object:
    """The node as plain dicts, lists and text, without lines."""
    if isinstance(node, Table):
        return {name: plain(entry) for name, entry in node.entries.items()}
    return [plain(item) for item in node.items] if isinstance(node, Items) else node.value


def _convert(node: yaml.Node, problems: Problems, depth: int) -> Node:
    line = node.start_mark.line + 1
    if depth > DEEPEST:
        problems.say(line, f"nested too deep; allowed: {DEEPEST} tables and lists in each other")
        return Text("", line)
    if isinstance(node, yaml.ScalarNode):
        return Text(node.value.strip(), line)
    if isinstance(node, yaml.SequenceNode):
        return Items(tuple(_convert(item, problems, depth + 1) for item in node.value), line)
    entries: dict[str, Node] = {}
    lines: dict[str, int] = {}
    for key_node, value_node in node.value:
        at = key_node.start_mark.line + 1
        if not isinstance(key_node, yaml.ScalarNode):
            problems.say(at, "a key is a table or a list; allowed: a name")
            continue
        key = key_node.value.strip()
        if key in entries:
            problems.say(
                at, f"{key} is defined twice (first on line {lines[key]}); allowed: each name once"
            )
            continue
        entries[key], lines[key] = _convert(value_node, problems, depth + 1), at
    return Table(entries, lines, line)
