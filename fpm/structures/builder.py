"""What statements see of the sample that is being built: its numbers, points, parts and scene."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpm.arithmetic.expressions import ExpressionError, Value
from fpm.errors import SceneError
from fpm.scenes.scene import Scene
from fpm.structures.names import Bound
from fpm.structures.reading import Problems, SkippedError

POINT_TOL = 1e-9
"""Points that differ by less, as a share of the structure's size, are one."""


@dataclass(frozen=True)
class Point:
    """A named point of a sample. name: full, as "bay1.P"; position (3,), m: global, at start."""

    name: str
    position: np.ndarray


class Body:
    """A bar or rigid body of a sample. name: full (as "bay1.AB"); points: particle that carries
    each of its points, by full name; particles (k,): all of it, set once it is built."""

    def __init__(self, name: str, points: Mapping[str, int]):
        self.name, self.points = name, dict(points)
        self.particles: np.ndarray = np.zeros(0, int)

    def particle(self, point: str) -> int:
        """Return the index of the particle that carries one of this part's points; SceneError if
        the part does not have it. point: full name, as "bay1.P"."""
        if point not in self.points:
            points = ", ".join(self.points)
            is_bar = len(set(self.points.values())) > 1
            remedy = (
                f"let its `carries` hold {point}" if is_bar else f"list {point} in its `points`"
            )
            allowed = f"a point of {self.name}: {points} (or {remedy})"
            raise SceneError("at", point, allowed)
        return self.points[point]


class Ground(Body):
    """The ground, particle 0, which does not move; every point can be one of its points."""

    def particle(self, point: str) -> int:
        return 0


class Builder:
    """One sample's scene in the making; `sample.build_sample` adds a structure file's statements
    one by one. problems: of the file, where errors are noted; scene: complete when there are none;
    numbers: all named numbers (SI units) by full name, as "bay1.width"; size: largest extent of the
    structure (m); joints_of: names of the joints at each particle, by index; hold: None or, if
    parts are forced together, a function of this Builder: indices of hinges whose openings stay;
    gravity_curve: None or, alike, a function: index of the curve of time that scales gravity;
    is_balanced: whether the run starts in equilibrium; openings: at which releases hold hinges
    exactly then, by index; additions: what each entry of sample.LATE_GROUPS, by group and name, put
    into the scene: pairs of a type and an index among its elements."""

    hold: Callable[["Builder"], list[int]] | None = None
    gravity_curve: Callable[["Builder"], int] | None = None
    is_balanced: bool = False
    scene: Scene
    size: float = 0.0

    def __init__(self, problems: Problems):
        self.problems = problems
        self.numbers: dict[str, Value] = {}
        self.joints_of: dict[int, list[str]] = {}
        self.openings: dict[int, float] = {}
        self.additions: dict[tuple[str, str], list[tuple[type, int]]] = {}
        self._values: dict[tuple[str, str], Any] = {}

    def number(self, bound: Bound, key: str) -> Value:
        """Return the value of an expression (SI units). key: dotted path, for errors. SkippedError
        if a number that it refers to has no value, SceneError if it has none itself."""
        try:
            return bound.value(self.numbers)
        except KeyError:
            raise SkippedError(key) from None
        except ExpressionError as error:
            raise SceneError(
                key, bound.expression.text, f"arithmetic with a finite value ({error})"
            ) from None

    def store(self, group: str, name: str, value: Any) -> None:
        """Store what was built for an entry, by group, as "bars", and full name."""
        self._values[group, name] = value

    def find(self, group: str, name: str) -> Any:
        """Return what `store` kept for an entry (group, as "bars"; full name), or SkippedError."""
        try:
            return self._values[group, name]
        except KeyError:
            raise SkippedError(name) from None

    def find_part(self, point: str, key: str) -> Body:
        """Return the only bar or body that has a point (its full name); SceneError if none or
        several have it. key: dotted path of the key that names the point, for the error."""
        parts = [value for (group, _), value in self._values.items() if group == "parts"]
        matches = [part for part in parts if point in part.points]
        if not matches and self.problems:  # its part may be what could not be built
            raise SkippedError(key)
        if len(matches) != 1:
            allowed = "a point that one part has, or {part: ..., at: " + f"{point}}}"
            if matches:
                allowed += f" with one of {', '.join(part.name for part in matches)}"
            self.refuse(key, point, allowed)
        return matches[0]

    def refuse(self, key: str, value: object, allowed: str) -> None:
        """Raise SceneError: `value` of `key` is not allowed; allowed: what would be, in words."""
        raise SceneError(key, value, allowed)
