"""Names in a structure's file: what they stand for, and where they can be seen.

Units of a `repeat` see their own names first, then those of the file, and their neighbours' as
`next.P` and `previous.P`. From anywhere a unit's name is `bay3.P`, `bay.first.P` or `bay.last.P`.
"""

from collections.abc import Container, Iterable
from dataclasses import dataclass, field
from functools import cached_property

from fpm.errors import did_you_mean
from fpm.structures.expressions import Expression, ExpressionError
from fpm.structures.problems import Problems, SkippedError
from fpm.structures.units import Dimension

NEIGHBOURS = ("next", "previous")


@dataclass(frozen=True)
class Context:
    """Where something is written: in the file, or in one unit of a repeat.

    prefix: "" or `bay3.`; around: the prefixes of the neighbours, None at a row's end; ends: the
    prefixes of all repeats' first and last units, by `bay.first` and `bay.last`.
    """

    ends: dict[str, str]
    prefix: str = ""
    around: dict[str, str | None] = field(default_factory=dict)

    def find(self, name: str, known: Container[str]) -> str:
        """The full name of what `name` means here; KeyError if there is no such thing.

        SkippedError for the neighbour of a row's last unit.
        """
        head, _, rest = name.partition(".")
        if head in self.around:
            neighbour = self.around[head]
            full = (self.prefix if neighbour is None else neighbour) + rest
            if full not in known:
                raise KeyError(name)
            if neighbour is None:
                raise SkippedError(name)
            return full
        second, _, last = rest.partition(".")
        if f"{head}.{second}" in self.ends:
            name = self.ends[f"{head}.{second}"] + last
        for full in (self.prefix + name, name):
            if full in known:
                return full
        raise KeyError(name)


@dataclass(frozen=True)
class Bound:
    """An expression whose names are tied to full names."""

    expression: Expression
    full: dict[str, str]

    def value(self, numbers: dict[str, float]) -> float:
        """Its value in SI units, from those of the full names."""
        if not self._is_full:
            numbers = {name: numbers[full] for name, full in self.full.items()}
        return self.expression.value(numbers)

    @cached_property
    def _is_full(self) -> bool:
        """Whether the expression has full names itself, as outside of repeats."""
        return all(name == full for name, full in self.full.items())

    def dimension(self, numbers: dict[str, "Number"]) -> Dimension:
        """Its dimension; SkippedError if one of its names has none, being wrong itself."""
        found = {name: numbers[full].dimension for name, full in self.full.items()}
        if None in found.values():
            raise SkippedError(self.expression.text)
        return self.expression.dimension(found)


@dataclass
class Number:
    """A named number: given, or derived by `bound`.

    given: the value of a repeat's index; dimension: None while it is unknown, or if it is wrong;
    whole: it depends on whole numbers only, so that counts may depend on it.
    """

    key: str
    line: int
    bound: Bound | None
    dimension: Dimension | None = None
    whole: bool = False
    given: float | None = None


class Names:
    """All names of a file: numbers (parameters, let, coordinates of points), and what is built."""

    def __init__(self, problems: Problems):
        self.problems = problems
        self.numbers: dict[str, Number] = {}
        self.things: dict[str, dict[str, int]] = {"parts": {"ground": 0}}
        self.types: dict[str, str] = {}  # of joints, by name; "" where nobody can tell
        self.used: set[str] = set()
        self.absent: set[tuple[str, str]] = set()  # (group, name): wrong, or at a row's end
        self.order: list[str] = []

    def give(self, name: str, number: "Number") -> None:
        """Note a number whose value is given, not derived."""
        self.numbers[name] = number
        self.order.append(name)

    def unknown(self, line: int, key: str, name: str, known: Iterable[str], what: str) -> None:
        """Note that a name means nothing."""
        known = list(known)
        shown = ", ".join(known[:12]) + (", ..." if len(known) > 12 else "")
        self.problems.say(
            line,
            f"{key}: there is no {what} {name!r}{did_you_mean(name, known)}; "
            f"allowed: {shown or '(there is none)'}",
        )

    def sort(self) -> None:
        """Put the numbers into an order in which they can be computed, and find their dimensions.

        Cycles and clashes become problems; what depends on them is left without dimension.
        """
        done = dict.fromkeys(self.order, True)  # False: being visited
        for start in self.numbers:
            stack = [(start, iter(self._needs(start)))] if start not in done else []
            done.setdefault(start, False)
            while stack:
                name, needs = stack[-1]
                following = next(needs, None)
                if following is None:
                    stack.pop()
                    done[name] = True
                    self.order.append(name)
                    self._measure(name)
                elif following not in done:
                    done[following] = False
                    stack.append((following, iter(self._needs(following))))
                elif not done[following]:
                    self._cycle([n for n, _ in stack], following)

    def _needs(self, name: str) -> list[str]:
        bound = self.numbers[name].bound
        return list(bound.full.values()) if bound else []

    def _cycle(self, visited: list[str], again: str) -> None:
        ring = [*visited[visited.index(again) :], again]
        number = self.numbers[again]
        self.problems.say(
            number.line,
            f"{number.key}: defined by itself ({' -> '.join(ring)}); allowed: names that do not "
            "lead back",
        )

    def _measure(self, name: str) -> None:
        number = self.numbers[name]
        if number.bound is None:
            return
        try:
            found = number.bound.dimension(self.numbers)
        except SkippedError:
            return
        except ExpressionError as error:
            self.problems.say(number.line, f"{number.key}: {number.bound.expression.text}: {error}")
            return
        number.whole = bool(number.bound.full) and self.is_whole(number.bound)
        wanted = number.dimension
        if wanted is not None and not found.bare and found.powers != wanted.powers:
            self.problems.say(
                number.line,
                f"{number.key}: {number.bound.expression.text} is {found}; allowed: {wanted}",
            )
        number.dimension = wanted or found

    def is_whole(self, bound: Bound) -> bool:
        """Whether an expression depends on nothing but whole numbers."""
        return all(self.numbers[full].whole for full in bound.full.values())
