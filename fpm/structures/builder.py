"""What statements see of the sample that is being built: its numbers, points, parts and scene."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpm.errors import SceneError
from fpm.scenes.scene import Scene
from fpm.structures.expressions import ExpressionError
from fpm.structures.names import Bound
from fpm.structures.reading import Problems, SkippedError

POINT_TOL = 1e-9
"""Points that differ by less, as a share of the structure's size, are one."""


@dataclass(frozen=True)
class Point:
    """A named point: where it is at the start, (3,) m."""

    name: str
    position: np.ndarray


class Body:
    """A bar or rigid body: the particle that carries each of its points."""

    def __init__(self, name: str, points: Mapping[str, int]):
        self.name, self.points = name, dict(points)
        self.particles: np.ndarray = np.zeros(0, int)

    def particle(self, point: str) -> int:
        """The particle that carries a point; SceneError for a point that is not the part's."""
        if point not in self.points:
            raise SceneError(
                "at", point, f"a point of {self.name}: {', '.join(self.points)} (or let it carry "
                f"{point})"
            )  # fmt: skip
        return self.points[point]


class Ground(Body):
    """The ground, which does not move; every point can be one of its points."""

    def particle(self, point: str) -> int:
        return 0


class Builder:
    """One sample in the making; `sample.build` adds to it statement by statement.

    scene: complete when no problem was found; numbers: all named numbers in SI units; size (m): the
    largest extent of the structure; joints_of: the joints at each particle; hold(builder): hinges
    that are held while parts are forced together, None where they are not.
    """

    hold: Callable[["Builder"], list[int]] | None = None
    scene: Scene
    size: float = 0.0

    def __init__(self, problems: Problems):
        self.problems = problems
        self.numbers: dict[str, float] = {}
        self.joints_of: dict[int, list[str]] = {}
        self._values: dict[tuple[str, str], Any] = {}

    def number(self, bound: Bound, key: str) -> float:
        """The value of an expression; SkippedError if what it refers to has none."""
        try:
            return bound.value(self.numbers)
        except KeyError:
            raise SkippedError(key) from None
        except ExpressionError as error:
            raise SceneError(
                key, bound.expression.text, f"arithmetic that is not {error}"
            ) from None

    def point(self, name: str) -> np.ndarray:
        """Where a point is at the start, (3,) m."""
        return self.get("points", name).position

    def keep(self, group: str, name: str, value: Any) -> None:
        """Keep what was built for a name."""
        self._values[group, name] = value

    def get(self, group: str, name: str) -> Any:
        """What was built for a name; SkippedError if it could not be."""
        try:
            return self._values[group, name]
        except KeyError:
            raise SkippedError(name) from None

    def only_part_with(self, point: str, key: str) -> Body:
        """The part that has a point, and is the only one."""
        parts = [value for (group, _), value in self._values.items() if group == "parts"]
        matches = [part for part in parts if point in part.points]
        if len(matches) != 1:
            allowed = "a point that one part has, or {part: ..., at: " + f"{point}}}"
            if matches:
                allowed += f" with one of {', '.join(part.name for part in matches)}"
            self.refuse(key, point, allowed)
        return matches[0]

    def refuse(self, key: str, value: object, allowed: str) -> None:
        """Raise that a value is not allowed."""
        raise SceneError(key, value, allowed)
