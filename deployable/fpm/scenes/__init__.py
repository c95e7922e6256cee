"""The scenes that a campaign can name, and what may be set in each."""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from typing import Any

from deployable.fpm import sources
from deployable.fpm.errors import SceneError
from deployable.fpm.kinds import energies_of
from deployable.fpm.scene import Scene

LENGTHS, SIDES, MODULI, DENSITIES = (1e-3, 1e4), (1e-5, 10.0), (1e4, 1e13), (0.1, 1e5)
"""What is usual: lengths and sides of sections (m) from parts of a watch to bridges, Young's moduli
(Pa) from foam to diamond, densities (kg/m3) from aerogel to lead and what is lumped."""

_UNITS = {
    "m": {"mm": 1e-3, "cm": 1e-2},
    "Pa": {"GPa": 1e9, "MPa": 1e6, "kPa": 1e3},
    "kg m-3": {"g/cm3": 1e3},
}
"""Units that people have in mind, and how much of ours they are."""


@dataclass(frozen=True)
class Parameter:
    """What a scene's parameter is and which values it takes.

    kind: "real", "integer", "boolean" or "choice"; only real ones may be intervals. The range is
    closed unless `lower_open`, `upper_open`. A default of None means: follows from the others.
    `usual`: what a structure can have; a value far outside was likely meant in another unit.
    """

    default: float | int | bool | str | None
    unit: str
    description: str
    lower: float = float("-inf")
    upper: float = float("inf")
    kind: str = "real"
    choices: tuple[str, ...] = ()
    lower_open: bool = False
    upper_open: bool = False
    usual: tuple[float, float] | None = None

    @property
    def allowed(self) -> str:
        """The allowed values in words."""
        if self.kind == "choice":
            return f"one of {', '.join(self.choices)}"
        if self.kind == "boolean":
            return "true or false"
        what = "a whole number" if self.kind == "integer" else "a number"
        bounds = []
        if self.lower > float("-inf"):
            bounds.append(f"{'>' if self.lower_open else '>='} {self.lower:g}")
        if self.upper < float("inf"):
            bounds.append(f"{'<' if self.upper_open else '<='} {self.upper:g}")
        unit = f" ({self.unit})" if self.unit not in ("", "1") else ""
        return " ".join([what, " and ".join(bounds)]).strip() + unit

    def slip(self, value: float) -> str:
        """What may be wrong with an allowed value that no structure has; nothing if it is usual."""
        if self.usual is None or self.usual[0] <= value <= self.usual[1]:
            return ""
        told = f"{self.usual[0]:g} to {self.usual[1]:g} ({self.unit})"
        for unit, factor in _UNITS.get(self.unit, {}).items():
            if self.usual[0] <= value * factor <= self.usual[1]:
                return f"{told}; {value:.9g} {unit} would be {value * factor:.9g}"
        return told

    def check(self, name: str, value: object) -> None:
        """SceneError unless `value` is allowed."""
        if value is None and self.default is None:
            return
        if self.kind == "choice":
            right = value in self.choices
        elif self.kind == "boolean":
            right = isinstance(value, bool)
        else:
            number = isinstance(value, int | float) and not isinstance(value, bool)
            right = number and float("-inf") < value < float("inf")
            right = right and (self.kind == "real" or int(value) == value)
            if right:
                above = value > self.lower if self.lower_open else value >= self.lower
                below = value < self.upper if self.upper_open else value <= self.upper
                right = above and below
        if not right:
            raise SceneError(name, value, self.allowed)


@dataclass(frozen=True)
class SceneType:
    """A scene that can be built from named parameters."""

    name: str
    description: str
    parameters: dict[str, Parameter]
    points: tuple[str, ...]
    hinges: tuple[str, ...]
    function: Callable[..., Scene]
    cables: tuple[str, ...] = ()
    values: Mapping[str, Any] = field(default_factory=dict)  # of parameters, for its `sample`

    @cached_property
    def sample(self) -> Scene:
        """The scene at `values`: what there is, whatever the other parameters are."""
        return self.build(**self.values)

    @cached_property
    def energies(self) -> tuple[str, ...]:
        """Names of the energies that its runs have."""
        own = (energy.name for energy in energies_of(self.sample.kinds))
        return ("kinetic", *own, "balance")

    @property
    def content(self) -> str:
        """Digest of the structure's own files."""
        return sources.syntax_digest(sources.own_sources(sources.file_of(self.function)))

    @property
    def digest(self) -> str:
        """16 hex digits that change with the code that computes this scene's runs.

        It covers all of the mechanics that can change their numbers, and the structure's content.
        """
        mechanics = sources.syntax_digest(sources.mechanics_sources())
        return hashlib.sha256(f"{mechanics} {self.content}".encode()).hexdigest()[:16]

    def build(self, **parameters) -> Scene:
        """The scene; defaults fill in what is not given. SceneError names what is wrong."""
        for name, value in parameters.items():
            if name not in self.parameters:
                raise SceneError(
                    f"parameter {name} of scene {self.name}", value,
                    f"one of {', '.join(self.parameters)}",
                )  # fmt: skip
            self.parameters[name].check(name, value)
        defaults = {name: p.default for name, p in self.parameters.items()}
        return self.function(**{**defaults, **parameters})


_MODULES = {
    "bennett": "deployable.fpm.scenes.bennett",
    "pendulum": "deployable.fpm.scenes.pendulum",
}


def names() -> tuple[str, ...]:
    """Names of all scenes."""
    return tuple(_MODULES)


def get(name: str) -> SceneType:
    """The scene of that name; SceneError lists the known ones."""
    if name not in _MODULES:
        raise SceneError("scene.name", name, f"one of {', '.join(_MODULES)}")
    return import_module(_MODULES[name]).SCENE
