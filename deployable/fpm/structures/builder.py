"""One sample of a structure: the values of its parameters become a scene."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from deployable.fpm.assembly import MisfitError, assemble
from deployable.fpm.errors import SceneError
from deployable.fpm.scene import Scene
from deployable.fpm.structures.expressions import ExpressionError
from deployable.fpm.structures.names import Bound
from deployable.fpm.structures.problems import Problems, SkippedError
from deployable.fpm.structures.statement import PARTS

if TYPE_CHECKING:
    from deployable.fpm.structures.model import Model


BEFORE = ("materials", "sections", *PARTS, "masses", "supports", "joints")
"""Groups that are built before parts are forced together."""

APART = 1e-9
"""Points that differ by less, as a share of the structure's size, are one."""


@dataclass(frozen=True)
class Point:
    """A named point: where it is at the start, (3,) m."""

    name: str
    position: np.ndarray


class Part:
    """A bar or a body: which particle carries each of its points."""

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


class Ground(Part):
    """What does not move; every point can be one of it."""

    def particle(self, point: str) -> int:
        return 0


class RefusedError(SceneError):
    """A value that a statement refuses. `size`: how far it is off, to tell the worst sample."""

    size: float = 0.0


class Builder:
    """Builds the scene of a model at given values; `scene` is complete when no problem was found.

    numbers: all named numbers in SI units; size (m): the largest extent of the structure; joined:
    the joints at each particle; hold: joints that are held while parts are forced together, None
    where they are not.
    """

    hold: list[tuple[str, int]] | None = None

    def __init__(self, model: "Model", values: Mapping[str, float], problems: Problems):
        self.problems = problems
        self.numbers: dict[str, float] = {}
        self.joined: dict[int, list[str]] = {}
        self._made: dict[tuple[str, str], Any] = {}
        with np.errstate(all="ignore"):
            self._number(model, values)
            self._place(model)
            self.scene = self._scene(model)
            for entry in model.entries:
                if entry.statement.group in BEFORE:
                    self._build(entry)
            self._assemble(model)
            for entry in model.entries:
                if entry.statement.group not in BEFORE:
                    self._build(entry)
            self._finish(model)

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
        return self.made("points", name).position

    def made(self, group: str, name: str) -> Any:
        """What was built for a name; SkippedError if it could not be."""
        try:
            return self._made[group, name]
        except KeyError:
            raise SkippedError(name) from None

    def only_part_with(self, point: str, key: str) -> Part:
        """The part that has a point, and is the only one."""
        parts = [made for (group, _), made in self._made.items() if group == "parts"]
        found = [part for part in parts if point in part.points]
        if len(found) != 1:
            allowed = "a point that one part has, or {part: ..., at: " + f"{point}}}"
            if found:
                allowed += f" with one of {', '.join(part.name for part in found)}"
            self.refuse(key, point, allowed)
        return found[0]

    def refuse(self, key: str, value: object, allowed: str, size: float = 0.0) -> None:
        """Raise that a value is not allowed. size: how far it is off."""
        error = RefusedError(key, value, allowed)
        error.size = size
        raise error

    # -- steps --------------------------------------------------------------------------------

    def _number(self, model: "Model", values: Mapping[str, float]) -> None:
        for name in model.names.order:
            number = model.names.numbers[name]
            if name in values:
                self.numbers[name] = float(values[name])
            elif number.given is not None:
                self.numbers[name] = number.given
            elif number.bound is not None:
                try:
                    self.numbers[name] = self.number(number.bound, number.key)
                except SceneError as error:
                    self._note(number.line, number.key, error)
                except SkippedError:
                    pass

    def _place(self, model: "Model") -> None:
        for name in model.points:
            axes = [self.numbers.get(f"{name}.{axis}") for axis in "xyz"]
            if None not in axes:
                self._made["points", name] = Point(name, np.array(axes))
        placed = [p.position for (group, _), p in self._made.items() if group == "points"]
        self.size = float(np.ptp(placed, axis=0).max()) if placed else 0.0

    def _scene(self, model: "Model") -> Scene:
        try:
            scene = model.overall.statement.build(self, model.overall.values(self))
        except SkippedError:
            scene = Scene(model.overall.name)
        except SceneError as error:
            self._note(model.overall.lines.get(error.key, 0), error.key, error)
            scene = Scene(model.overall.name)
        if "parts:ground" in model.names.used:
            ground = int(scene.add_particles((0.0, 0.0, 0.0), 1.0, 1.0)[0])
            scene.fix(ground)
            self._made["parts", "ground"] = Ground("ground", {})
        return scene

    def _build(self, entry) -> None:
        before = len(self.scene.position)
        try:
            made = entry.statement.build(self, entry.values(self))
        except SkippedError:
            return
        except SceneError as error:
            key = error.key.split(".")[0]
            joint = "." if key in entry.statement.keys else ", "
            line = entry.lines.get(key, entry.line)
            self._note(line, f"{entry.key}{joint}{error.key}", error)
            return
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            self._note(entry.line, entry.key, SceneError("", str(error), "possible numbers"))
            return
        if isinstance(made, Part):
            made.particles = np.arange(before, len(self.scene.position))
            self._made["parts", entry.name] = made
        self._made[entry.statement.group, entry.name] = made

    def _assemble(self, model: "Model") -> None:
        """Force parts together that do not meet, if the file asks for it."""
        if self.hold is None or self.problems:
            return
        line = model.overall.lines.get("assemble", 0)
        held = [self._made["joints", name] + which for name, which in self.hold]
        try:
            assemble(self.scene, [self.scene.hinges[hinge].name for hinge in held])
        except MisfitError as error:
            self._note(line, f"assemble: {error.key}", error)
        except SceneError as error:
            self._note(line, error.key, error)

    def _finish(self, model: "Model") -> None:
        scene = self.scene
        numbers = (scene.position, scene.mass, scene.inertia, scene.velocity, scene.gravity)
        if not all(np.isfinite(x).all() for x in numbers):
            self.problems.say(0, "the structure has masses or lengths that are not finite")
        if self.problems:
            return
        parts = [entry for entry in model.entries if entry.statement.group in PARTS]
        for entry in parts if len(parts) > 1 else ():
            particles = self._made["parts", entry.name].particles
            if not (np.isin(particles, list(self.joined)).any() or scene.fixed[particles].any()):
                self.problems.say(
                    entry.line, f"{entry.key}: nothing joins it to anything; allowed: parts with a "
                    "joint, a cable, a support or a drive"
                )  # fmt: skip

    def _note(self, line: int, key: str, error: SceneError) -> None:
        """Turn an error into a problem of the file."""
        self.problems.refuse(line, key, error.value, error.allowed, getattr(error, "size", 0.0))
