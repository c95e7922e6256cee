"""Units in a row or a ring: one table that stands for many, each with names of its own."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from fpm.structures.expressions import ExpressionError
from fpm.structures.keys import Whole
from fpm.structures.names import NEIGHBOURS, Context, Names
from fpm.structures.place import Place, check_keys, is_name, table_at
from fpm.structures.problems import SkippedError
from fpm.structures.reading import Table, Text, plain
from fpm.structures.statements import GROUPS

KEYS = ("count", "arrangement", "index", "let", "points", *GROUPS)
ARRANGEMENTS = ("row", "ring")
MOST_STATEMENTS = 20_000
"""Most statements that all units of a repeat may have together."""


class Sheet(NamedTuple):
    """A table with points, bars and so on: the file's, or one unit's. number: of the unit, or 0."""

    context: Context
    table: Table
    key: str
    number: int


def units(table: Table, names: Names, counts: Mapping[str, float], ends: dict) -> Iterator[Sheet]:
    """All units of a file's repeats; `ends` is told the prefixes of the first and last ones."""
    problems = names.problems
    repeats = table_at(table, "repeat", "", problems)
    for name, line in repeats.lines.items():
        key = f"repeat.{name}"
        node = table_at(repeats, name, "repeat", problems)
        check_keys(node, key, KEYS, problems)
        if name[-1:].isdigit():
            problems.say(line, f"{key}: ends with a digit; allowed: names that do not")
        if not is_name(name, key, line, problems):
            continue
        try:
            count = _count(node, Place(f"{key}.count", Context({}), names), line, counts)
            ring = _is_ring(node, Place(f"{key}.arrangement", Context({}), names))
        except SkippedError:
            continue
        ends[f"{name}.first"], ends[f"{name}.last"] = f"{name}1.", f"{name}{count}."
        for i in range(count):
            beside = [j % count if ring else j for j in (i + 1, i - 1)]
            around = {
                side: f"{name}{j + 1}." if 0 <= j < count else None
                for side, j in zip(NEIGHBOURS, beside, strict=True)
            }
            yield Sheet(Context(ends, f"{name}{i + 1}.", around), node, key, i + 1)


def _count(node: Table, place: Place, line: int, counts: Mapping[str, float]) -> int:
    """How many units there are, by parameters that are whole numbers."""
    if "count" not in node.entries:
        place.problems.say(line, f"{place.key}: missing; allowed: {Whole().allowed}")
        raise SkippedError(place.key)
    statements = sum(len(t.entries) for t in node.entries.values() if isinstance(t, Table))
    most = min(Whole().most, MOST_STATEMENTS // max(statements, 1))
    bound = Whole().read(node.entries["count"], place)
    try:
        found = bound.value(counts)
    except ExpressionError:
        found = 0
    if found != round(found) or not 1 <= found <= most:
        place.refuse(node.entries["count"], f"a whole number from 1 to {most}")
    return round(found)


def _is_ring(node: Table, place: Place) -> bool:
    given = node.entries.get("arrangement", Text(ARRANGEMENTS[0], 0))
    if plain(given) not in ARRANGEMENTS:
        place.refuse(given, " or ".join(ARRANGEMENTS))
    return given.value == "ring"
