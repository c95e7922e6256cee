"""Lists of points, those of all units of a repeat among them: ways of cables, points on bodies."""

from collections.abc import Iterator
from dataclasses import dataclass

from fpm.structures.builder import Builder
from fpm.structures.keys import Key
from fpm.structures.names import Context
from fpm.structures.place import Place
from fpm.structures.reading import Items, Node, Table, Text


@dataclass(frozen=True)
class Points(Key):
    """A list of points of a kind, and of {each: REPEAT, through: [...]} for those of all units."""

    kind: Key | None = None
    least: int = 1

    @property
    def allowed(self) -> str:
        return (
            f"a list of {self.least} or more, each {self.kind.allowed}; or {{each: a repeat, "
            "through: such a list}, which stands for those of all its units"
        )

    def read(self, node: Node, place: Place) -> list:
        found = list(self._points(node, place))
        if len(found) < self.least:
            place.refuse(node, self.allowed)
        return found

    def _points(self, node: Node, place: Place) -> Iterator:
        if not isinstance(node, Items):
            place.refuse(node, self.allowed)
        for item in node.items:
            if isinstance(item, Table) and item.entries.keys() == {"each", "through"}:
                for context in _units(item.entries["each"], place):
                    inside = Place(f"{place.key}.through", context, place.names)
                    yield from self._points(item.entries["through"], inside)
            else:
                yield self.kind.read(item, place)

    def value(self, read: list, build: Builder, key: str) -> list:
        return [self.kind.value(one, build, key) for one in read]


def _units(node: Node, place: Place) -> Iterator[Context]:
    """The contexts of a repeat's units, in order."""
    ends, name = place.context.ends, node.value if isinstance(node, Text) else ""
    known = [end.removesuffix(".first") for end in ends if end.endswith(".first")]
    if name not in known:
        place.inside("each").refuse(node, f"one of {', '.join(known) or '(there is none)'}")
    count = int(ends[f"{name}.last"].removeprefix(name).rstrip("."))
    for number in range(1, count + 1):
        yield Context(ends, f"{name}{number}.")
