"""Structures in Python, in the words of their text files, from which a text file can be written.

A method states one entry of the mapping that a YAML file is; the checks and messages are those of a
file, by key instead of line. The methods of groups are made of the table of statements."""

import json
import re
from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import yaml

from fpm.errors import SceneError, fold_name
from fpm.scenes.scene import Scene
from fpm.scenes.scene_type import SceneType
from fpm.structures.reading import Node, Problem, Problems, StructureError, read, read_text
from fpm.structures.statements import GROUPS
from fpm.structures.text_file import build_type, loads


class StatementTable:
    """Statements of a structure, or of the units of one of its repeats, each by a method.

    There is one method for each group of a file, in the singular (`body` of `bodies`, `joint` of
    `joints`, `load` of `loads`): an entry's name, then its keys. Values are numbers (SI units),
    texts (expressions with units), lists, mappings; an angle needs its unit. `class_` is the key
    `class`; None leaves a key out. Attributes: table: the mapping, all values as text; source: what
    messages call the structure, also the path of the file in whose folder curves are sought."""

    def __init__(self, table: dict[str, Any], source: str):
        self.table, self.source = table, source

    def let(self, name: str, value: Any) -> None:
        """State a number with a name. name: its own; value: an expression, such as "2*L", or a
        number (SI units)."""
        self._add("let", name, value)

    def point(self, name: str, place: Any) -> None:
        """State the point `name` at `place`: coordinates, each an expression or a number (m)."""
        self._add("points", name, place)

    def _add(self, group: str, name: str, value: Any) -> Any:
        name = fold_name(str(name))
        entries, key = self.table.setdefault(group, {}), f"{group}.{name}"
        problems = Problems(self.source)
        if not isinstance(entries, dict):
            problems.refuse(0, group, entries, "a mapping from names")
        elif name in entries:
            problems.say(0, f"{key} is defined twice; allowed: each name once")
        problems.stop()
        entries[name] = _plain(value, key)
        return entries[name]


class Structure(StatementTable):
    """A structure stated in Python in the words of a text file (docs/structures.md).

    Nothing is checked before a scene is built, which raises StructureError with all that is wrong,
    each by its key. `write` makes the text file that a campaign's scene can name.

    Parameters
    ----------
    name, description, mesh: as at the top of a file; "": left out.
    overall: further keys of the top of a file, such as `gravity`."""

    def __init__(self, name: str = "", description: str = "", mesh: str = "", **overall: Any):
        texts = {"name": name, "description": description, "mesh": mesh}
        table = {key: text for key, text in texts.items() if text} | overall
        super().__init__(_plain(table, ""), str(name) or "structure")
        self._type: tuple[str, SceneType] | None = None

    @classmethod
    def read(cls, path: str | Path) -> "Structure":
        """Return the structure in the YAML file at `path`, to be changed or added to. Raises
        StructureError for a file that is not a mapping; `build` tells what else is wrong."""
        structure = cls()
        structure.source = str(path)
        table: Any = read(read_text(path), Problems(structure.source)).plain
        structure.table = table
        return structure

    def parameter(self, name: str, value: Any, unit: str = "", description: str = "", **keys: Any):
        """State a parameter.

        Parameters
        ----------
        name: its name.
        value: its default, in `unit`.
        unit: such as "N m/rad", "" for a number without unit.
        description: one line of text.
        keys: `range`, its least and largest value; `whole`, whether it takes whole numbers only."""
        texts = {"unit": unit, "description": description}
        texts = {key: text for key, text in texts.items() if text}
        self._add("parameters", name, {"value": value, **texts, **keys})

    def repeat(self, name: str, count: Any, **keys: Any) -> StatementTable:
        """State a repeat, and return the statements of its units, to be filled by methods.

        Parameters
        ----------
        name: of the repeat.
        count: of its units, a whole number, of parameters with `whole`.
        keys: `index`, the name of a unit's number; `arrangement`, "row" or "ring"."""
        return StatementTable(self._add("repeat", name, {"count": count, **keys}), self.source)

    @property
    def scene_type(self) -> SceneType:
        """Return the structure (SceneType), checked, as if loaded from its text. Raises
        StructureError with a list of all problems."""
        content = json.dumps([self.table, self.source])
        if self._type is None or self._type[0] != content:
            self._type = content, build_type(_node(self.table), Problems(self.source))
        return self._type[1]

    def build(self, **parameters: Any) -> Scene:
        """Return the scene at values of parameters, by keyword in their units; others take their
        defaults. Raises StructureError for a wrong structure, SceneError for wrong values."""
        return self.scene_type.build(**parameters)

    def _repr_html_(self) -> str:
        try:
            return self.scene_type._repr_html_()
        except SceneError as error:  # as of a structure that is not whole yet
            return f"<pre>{escape(str(error))}</pre>"

    def text(self) -> str:
        """Return the structure as the text of a YAML file, which loads to the same scenes."""
        options = {"sort_keys": False, "allow_unicode": True, "default_flow_style": None}
        return yaml.dump(self.table, Dumper=_TextDumper, width=100, **options)

    def write(self, path: str | Path) -> None:
        """Write the structure as a YAML file that loads to the same scenes. StructureError for a
        wrong one, and where curves are not those of the same names in the folder of `path`."""
        if loads(text := self.text(), str(path)).digest != self.scene_type.digest:
            reason = "other files of curves are there; allowed: the folder of the structure"
            raise StructureError(str(path), [Problem(0, reason)])
        Path(path).write_text(text, encoding="utf-8")


def _method(group: str, name: str) -> Callable[..., None]:
    def add(self: StatementTable, name: str, /, **keys: Any) -> None:
        self._add(group, name, {key.removesuffix("_"): value for key, value in keys.items()})

    lines = (f"{kind.type or 'keys'}: {', '.join(kind.keys)}" for kind in GROUPS[group].values())
    types = " of one `type`" if "" not in GROUPS[group] else ""
    text = f"State an entry of `{group}`{types}. name: of the entry; keys: those of a file, by type"
    add.__doc__ = "\n".join([text if types else text.removesuffix(", by type"), "", *lines])
    add.__name__, add.__qualname__ = name, f"StatementTable.{name}"
    return add


def _singular(group: str) -> str:
    """Return the name of one entry of a group: body of bodies, mass of masses, joint of joints."""
    return re.sub(r"(?<=ss|ch|sh)es$|s$", "", re.sub("ies$", "y", group))


for _group in GROUPS:
    setattr(StatementTable, _singular(_group), _method(_group, _singular(_group)))


def _plain(value: Any, key: str) -> Any:
    """Return a copy of a value with texts for numbers, like the nodes of a file."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, Mapping):
        items = ((fold_name(str(name)), x) for name, x in value.items() if x is not None)
        return {name: _plain(entry, f"{key}.{name}") for name, entry in items}
    if isinstance(value, list | tuple):
        return [_plain(entry, key) for entry in value]
    if isinstance(value, bool):
        return str(value).lower()
    if not isinstance(value, str | int | float | Path):
        raise SceneError(key.lstrip("."), value, "a number, a text, a list or a mapping")
    return str(value).strip()


def _node(value: Any) -> Node:
    """Turn a plain value into nodes without lines."""
    if isinstance(value, dict):
        nodes = {name: _node(entry) for name, entry in value.items()}
        return Node(nodes, lines=dict.fromkeys(nodes, 0))
    return Node([_node(entry) for entry in value] if isinstance(value, list) else value)


class _TextDumper(yaml.SafeDumper):
    """Dumper that writes texts without quotes where they are read as these texts by a file."""

    yaml_implicit_resolvers: ClassVar[dict] = {}

    def ignore_aliases(self, data: Any) -> bool:
        return True
