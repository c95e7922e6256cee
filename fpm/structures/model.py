"""A structure's file as a whole: its names found, its units checked, its repeats written out.

A model belongs to certain values of the whole-number parameters, since these decide what there is.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from fpm.elements.bars.viscosity import Viscosity
from fpm.errors import likely
from fpm.scenes.scene import Scene
from fpm.structures import repeat
from fpm.structures.keys import COMMA, Assembled, Number, Vector
from fpm.structures.names import Context, Names
from fpm.structures.names import Number as Named
from fpm.structures.parameters import Given
from fpm.structures.place import Place, check_keys, is_name, joined, table_at
from fpm.structures.problems import Problems, SkippedError
from fpm.structures.reading import Items, Table, Text, plain
from fpm.structures.repeat import Sheet
from fpm.structures.statement import PARTS, Entry, read_entry, statement
from fpm.structures.statements import GROUPS
from fpm.structures.units import NUMBER, unit

TEXTS = ("name", "description", "mesh")


@statement(
    "",
    gravity=Vector(np.zeros(3), "acceleration of everything", unit="m/s2"),
    damping=Number(0.0, "mass-proportional damping", unit="1/s", least=0),
    viscosity=Number(
        0.0, "bulk viscosity of bars, a share of critical damping of an element: 0.2 against waves "
        "that ring in the mesh", least=0,
    ),
    assemble=Assembled(
        None, "whether parts are forced together whose points do not meet at their joints; `hold`: "
        "joints that keep their opening"
    ),
)  # fmt: skip
def overall(build, it):
    """What holds for the whole structure."""
    build.hold = it.assemble
    scene = Scene(it.name, it.gravity, it.damping)
    if it.viscosity:
        scene.add(Viscosity(it.viscosity))
    return scene


KEYS = (*TEXTS, *overall.keys, "parameters", "let", "points", *GROUPS, "repeat")


class Model:
    """All statements of a file. `entries`: in the order in which they are built; `points`: names.

    table: the file; given: its parameters; counts: values of those that are whole numbers. What is
    wrong is noted in `problems`, and left out.
    """

    def __init__(
        self, table: Table, given: Mapping[str, Given], counts: Mapping, problems: Problems
    ):
        self.problems, self.names = problems, Names(problems)
        self.points: list[str] = []
        check_keys(table, "", KEYS, problems)
        for name, one in given.items():
            key = f"parameters.{name}"
            if is_name(name, key, one.line, problems, number=True):
                number = Named(key, one.line, None, one.unit.dimension, one.whole)
                self.names.give(name, number)
        ends: dict[str, str] = {}
        file = Sheet(Context(ends), table, "", 0)
        sheets = [file, *repeat.units(table, self.names, counts, ends)]
        if "repeat" in table.entries:
            problems.stop()  # without its units, every name in them would be unknown
        for sheet in sheets:
            self._register(sheet)
        for sheet in sheets:
            self._define(sheet)
        self.names.sort()
        self.overall = self._overall(file)
        self.entries = list(self._entries(sheets))
        if not problems:
            self._unused(given)

    # -- names --------------------------------------------------------------------------------

    def _register(self, sheet: Sheet) -> None:
        """Note which names there are."""
        if sheet.number:
            self._index(sheet)
        for group in ("let", "points", *GROUPS):
            node = table_at(sheet.table, group, sheet.key, self.problems)
            for name, line in node.lines.items():
                key = joined(sheet.key, group, name)
                if is_name(name, key, line, self.problems, number=group == "let"):
                    self._name(sheet.context.prefix, name, group, key, line)
                if group == "joints":
                    type = getattr(node.entries[name], "entries", {}).get("type")
                    given = type.value if isinstance(type, Text) else ""
                    meant = given if given in GROUPS[group] else likely(given, GROUPS[group])
                    self.names.types[sheet.context.prefix + name] = meant

    def _name(self, prefix: str, name: str, group: str, key: str, line: int) -> None:
        """Note one name of a group."""
        numbers, things, full = self.names.numbers, self.names.things, prefix + name
        known = numbers if group == "let" else things.setdefault(group, {})
        if full in known or name in known:
            self.problems.say(
                line, f"{key}: the name {name} is defined twice; allowed: each name once"
            )
        elif group == "let":
            numbers[full] = Named(key, line, None)
        else:
            known[full] = line
            if group in PARTS:
                things["parts"][full] = line
            if group == "points":
                self.points.append(full)
                length = unit("m").dimension
                numbers.update({f"{full}.{axis}": Named(key, line, None, length) for axis in "xyz"})

    def _index(self, sheet: Sheet) -> None:
        """The number of a unit under the name that the file gives it."""
        node = sheet.table.entries.get("index")
        if node is None:
            return
        name, key = node.value if isinstance(node, Text) else "", f"{sheet.key}.index"
        if name in self.names.numbers:
            self.problems.say(node.line, f"{key}: the name {name} is defined twice")
        elif is_name(name, key, node.line, self.problems, number=True):
            number = Named(key, node.line, None, NUMBER, whole=True, given=float(sheet.number))
            self.names.give(sheet.context.prefix + name, number)

    def _define(self, sheet: Sheet) -> None:
        """Tie the numbers under `let` and the points' coordinates to their expressions."""
        context = Context(sheet.context.ends, sheet.context.prefix)  # neighbours may not be there
        for group in ("let", "points"):
            node = sheet.table.entries.get(group)
            for name, entry in node.entries.items() if isinstance(node, Table) else ():
                full = context.prefix + name
                place = Place(joined(sheet.key, group, name), context, self.names)
                if group == "let":
                    self._tie(place, [full], [entry])
                elif isinstance(entry, Items) and len(entry.items) == 3:
                    self._tie(place, [f"{full}.{axis}" for axis in "xyz"], entry.items)
                else:
                    allowed = f"three coordinates [x, y, z]{COMMA}"
                    self.problems.refuse(node.lines[name], place.key, plain(entry), allowed)

    def _tie(self, place: Place, targets, items) -> None:
        for target, item in zip(targets, items, strict=True):
            number = self.names.numbers.get(target)
            if number is None or number.given is not None or target in self.names.order:
                continue  # the name of something else
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
        name = table.entries.get("name")
        name = name.value if isinstance(name, Text) else "structure"
        return Entry(overall, name, "", 0, table.lines, read)

    def _entries(self, sheets: list[Sheet]) -> Iterator[Entry]:
        for group, kinds in GROUPS.items():
            for sheet in sheets:
                node = sheet.table.entries.get(group)
                for name, one in node.entries.items() if isinstance(node, Table) else ():
                    full = sheet.context.prefix + name
                    if full not in self.names.things.get(group, {}):
                        continue
                    place = Place(joined(sheet.key, group, name), sheet.context, self.names)
                    entry = read_entry(kinds, full, one, node.lines[name], place)
                    if entry is not None:
                        yield entry
                        continue
                    self.names.absent.add((group, full))
                    if group in PARTS:
                        self.names.absent.add(("parts", full))

    def _unused(self, given: Mapping[str, Given]) -> None:
        """A parameter that nothing depends on is a slip of the pen."""
        for name, one in given.items():
            if name not in self.names.used:
                self.problems.say(
                    one.line, f"parameters.{name}: nothing uses it; allowed: parameters in use"
                )
