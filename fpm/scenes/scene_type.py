"""Structures from which scenes are built, and their parameters."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

from fpm.declare import Number
from fpm.elements import energies_of, kinds_of
from fpm.errors import SceneError, did_you_mean
from fpm.scenes.scene import Scene

LEAST_GROUP = 4
"""Number of samples from which on building together what they have in common takes less time."""


def join_lines(text: str) -> str:
    """Return a text as one line without control characters, as comments and tables need it."""
    return "".join(c for c in " ".join(text.split()) if c.isprintable())


@dataclass(frozen=True)
class Parameter(Number):
    """Definition of a parameter of a structure, as a `Number`; only one that is not whole may be an
    interval.

    Attributes
    ----------
    default: value in `unit`; None: it follows from other parameters.
    text: one line on it.
    unit: as UDUNITS spells it, "1" for pure numbers.
    least, most: bounds of its values, in `unit`.
    is_whole: whether it takes whole numbers only."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "text", join_lines(self.text))

    @property
    def allowed(self) -> str:
        return self.describe(unit=self.unit)

    def check(self, key: str, value: Any, noun: str = "") -> Any:
        """Return a value of the parameter, in its `unit`; None if that is the default."""
        return None if value is self.default is None else super().check(key, value, noun)


@dataclass(frozen=True)
class SceneType:
    """A structure, whose scenes are built from named parameters.

    Attributes
    ----------
    name, description: its name in configs, and one line of text on it.
    parameters: definitions (Parameter) by name.
    points, hinges, cables: names that responses may refer to.
    function: builds the Scene from all parameters, given by keyword.
    values: values of parameters, by name, at which `sample` is built.
    mesh: name of the parameter that sets the mesh, or None.
    digest: of what the structure's text and its curves say, 16 hex digits.
    files: paths of files that a structure's text names, whose content counts in its digest, too.
    prepare: takes values of all parameters by name, of several samples, and returns a function that
    builds the scene of one of them, or returns None where `function` is to build it; None: there is
    none.
    find_turns: takes values of all parameters by name, the name of one, and two values of it, and
    returns those between at which an expression of a text file turns back or bends."""

    name: str
    description: str
    parameters: dict[str, Parameter]
    points: tuple[str, ...]
    hinges: tuple[str, ...]
    function: Callable[..., Scene]
    cables: tuple[str, ...] = ()
    values: Mapping[str, Any] = field(default_factory=dict)
    mesh: str | None = None
    digest: str = ""
    files: tuple[Path, ...] = ()
    prepare: Callable[[Sequence[Mapping]], Callable[[Mapping], Scene | None]] | None = None
    find_turns: Callable[..., list[float]] = lambda *_: []

    @cached_property
    def sample(self) -> Scene:
        """Scene built at `values`, once; no parameter changes its names."""
        return self.build(**self.values)

    @cached_property
    def energies(self) -> tuple[str, ...]:
        """Names of the energies (J) that a run of the structure records: kinetic, those of its
        element types, and balance (the error of the energy balance)."""
        names = (energy.name for energy in energies_of(kinds_of([self.sample])))
        return ("kinetic", *names, "balance")

    def __post_init__(self) -> None:
        object.__setattr__(self, "description", join_lines(self.description))

    def _repr_html_(self) -> str:
        describe = import_module("fpm.structures.describe")  # which knows structures
        return describe.to_html(describe.describe(self))

    def build(self, **parameters) -> Scene:
        """Return the scene at values of parameters, by keyword in their units; others take their
        defaults. Raises SceneError for wrong names and values, and parts that do not fit."""
        values = self._complete(parameters)
        try:
            return self.function(**values)
        except SceneError:
            raise
        except (ArithmeticError, ValueError) as error:  # a quotient by zero, a root of less
            allowed = f"values at which it can be built, not {type(error).__name__}: {error}"
            raise SceneError(f"parameters of scene {self.name}", parameters, allowed) from error

    def build_all(self, samples: Sequence[Mapping[str, Any]]) -> list[Scene]:
        """Return the scenes at several sets of values, as `build` does, to the same bits; what they
        have in common is built once, and must not be written to."""
        values = [self._complete(parameters) for parameters in samples]
        if self.prepare is None or len(samples) < LEAST_GROUP:
            return [self.build(**x) for x in values]
        scenes = map(self.prepare(values), values)
        return [scene or self.build(**x) for scene, x in zip(scenes, values, strict=True)]

    def _complete(self, parameters: Mapping[str, Any]) -> dict[str, Any]:
        """Values of all parameters, checked; those that are not given have their defaults."""
        for name, value in parameters.items():
            if name not in self.parameters:
                allowed, hint = ", ".join(self.parameters), did_you_mean(name, self.parameters)
                text = f"{self.name} has no parameter {name}{hint}; expected one of {allowed}"
                raise SceneError(f"parameter {name}", value, f"one of {allowed}{hint}", text)
            self.parameters[name].check(name, value)
        return {name: p.default for name, p in self.parameters.items()} | dict(parameters)
