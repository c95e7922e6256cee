"""Responses that are recorded only when they are asked: their definitions, and what they need.

Each kind has the keys of its definition here, the columns (`fpm.files.variables`) that it needs,
and how its curve follows from them.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from fpm.elements import kinds_of
from fpm.errors import SceneError, did_you_mean
from fpm.files.variables import VARIABLES, Column
from fpm.reading.recording import labels
from fpm.scenes.scene import Scene

AXES = ("x", "y", "z")
FORCES = {"axial": ("axial",), "shear_y": ("shear_y",), "shear_z": ("shear_z",),
          "shear": ("shear_y", "shear_z")}  # fmt: skip
MOMENTS = {"torsion": ("torsion",), "bending_y": ("bending_y",), "bending_z": ("bending_z",),
           "bending": ("bending_y", "bending_z")}  # fmt: skip
"""Components of forces and moments in a section; of two axes it is the size of both together."""

STORES = {"damper": None, "friction": "friction", "stop": "stop", "latch": "latch",
          "release": "release", "motor": "motor"}  # fmt: skip
"""Parts of the moment on openings that lose energy, and the energy that each stores."""

TAKEN = {"damping": "damping_work", "cables": "cable_friction"}
"""Losses that are energies of the balance, always recorded."""


class Found(NamedTuple):
    """What a definition means: what it is `about`, unit and words, the columns that it needs."""

    about: tuple[str, ...]
    component: str
    unit: str
    long_name: str
    needs: tuple[Column, ...]


class Definition(NamedTuple):
    """A definition in a config: the name of its response, its kind, its keys, the scene."""

    name: str
    kind: str
    data: Mapping[str, Any]
    scene: Scene

    def one_of(self, value: object, known, key: str = "") -> Any:
        """The value; SceneError unless it is a known name. key: of another key than the kind."""
        if not isinstance(value, str) or value not in known:
            names = list(known)
            allowed = f"one of {', '.join(names) or '(this scene has none)'}"
            hint = did_you_mean(value, names) if isinstance(value, str) else ""
            raise SceneError(f"responses.{self.name}.{key or self.kind}", value, allowed + hint)
        return value

    @property
    def labels(self) -> list[str]:
        """The labels that the variable of this kind may have in the scene."""
        return labels(self.scene, self.kind)


def _vector(it: Definition) -> Found:
    """A vector of something along or about global axes."""
    names = dict.fromkeys(label.rpartition(" ")[0] for label in it.labels)
    name = it.one_of(it.data[it.kind], names)
    component = it.one_of(it.data["component"], (*AXES, "norm"), "component")
    own = AXES if component == "norm" else (component,)
    what = "magnitude of the " if component == "norm" else f"{component}-component of the "
    text = f"{what}{it.kind.replace('_', ' ')} of {name}"
    needs = tuple((it.kind, f"{name} {axis}") for axis in own)
    return Found((name,), component, VARIABLES[it.kind].unit, text, needs)


def _one(it: Definition) -> Found:
    """One column."""
    name = it.one_of(it.data[it.kind], it.labels)
    text = f"equivalent stress in {'all bars' if name == 'all' else name}"
    return Found((name,), "", VARIABLES[it.kind].unit, text, ((it.kind, name),))


def _hinge(it: Definition) -> tuple[str, bool]:
    """The hinge that a definition is about, and whether it is a slide."""
    slides = {hinge.name: hinge.slides for hinge in it.scene.hinges}
    name = it.one_of(it.data[it.kind], slides)
    return name, slides[name]


def _rate(it: Definition) -> Found:
    """The rate of an opening."""
    name, slides = _hinge(it)
    variable = "slide_rate" if slides else "opening_rate"
    text = f"rate of the opening of {'slide' if slides else 'hinge'} {name}"
    return Found((name,), "", VARIABLES[variable].unit, text, ((variable, name),))


def parts_on(scene: Scene, hinge: str) -> list[str]:
    """The parts of the moment on a hinge that something in the scene has."""
    index = [h.name for h in scene.hinges].index(hinge)
    found: dict[str, None] = {}
    for kind in kinds_of([scene]):
        for element in kind.of(scene) if kind.acts_as else ():
            if index in element.acts_on():
                found[kind.acts_as] = None
    return list(found)


def _moment(it: Definition) -> Found:
    """The moment on a hinge, or force on a slide, by one part, or by all, or its power."""
    name, slides = _hinge(it)
    variable, rate = ("joint_force", "slide_rate") if slides else ("joint_moment", "opening_rate")
    on = f"{'slide' if slides else 'hinge'} {name}"
    acting = parts_on(it.scene, name)
    part = it.one_of(it.data.get("part", "sum"), [*acting, "sum"], "part")
    own = acting if part == "sum" else [part]
    needs = tuple((variable, f"{name} {each}") for each in own)
    who = "all that acts" if part == "sum" else part
    if it.kind == "joint_power":
        return Found((name, part), "", "W", f"power of {who} on {on}", ((rate, name), *needs))
    what = "force" if slides else "moment"
    return Found((name, part), "", VARIABLES[variable].unit, f"{what} of {who} on {on}", needs)


def _section(it: Definition) -> Found:
    """A component of what a section of a bar bears."""
    bars = dict.fromkeys(label.partition(" at ")[0] for label in it.labels)
    name = it.one_of(it.data[it.kind], bars)
    share = it.data["at"]
    real = isinstance(share, int | float) and not isinstance(share, bool)
    if not (real and 0 <= share <= 1):
        allowed = "a share of the bar's length, from 0 to 1"
        raise SceneError(f"responses.{it.name}.at", share, allowed)
    components = FORCES if it.kind == "section_force" else MOMENTS
    component = it.one_of(it.data["component"], components, "component")
    own = components[component]
    text = f"{component.replace('_', ' along ' if it.kind == 'section_force' else ' about ')} "
    what = "force" if it.kind == "section_force" else "moment"
    needs = tuple((it.kind, f"{name} at {share:g} {each}") for each in own)
    unit = VARIABLES[it.kind].unit
    about = (name, f"{share:g}")
    kind = "norm" if len(own) > 1 else component
    return Found(about, kind, unit, f"{text}{what} of {name} at {share:g} of its length", needs)


def _clearance(it: Definition) -> Found:
    """The distance of two bars."""
    value = it.data[it.kind]
    known = list(dict.fromkeys(name for label in it.labels for name in label.split(" to ")))
    if not isinstance(value, list | tuple) or len(value) != 2 or value[0] == value[1]:
        raise SceneError(f"responses.{it.name}.clearance", value, "two different bars")
    first, second = sorted((it.one_of(name, known) for name in value), key=known.index)
    text = f"clearance between {first} and {second}"
    return Found((first, second), "", "m", text, (("clearance", f"{first} to {second}"),))


def _loss(it: Definition) -> Found:
    """Energy lost so far by one kind of element, or by all."""
    hinges = [hinge.name for hinge in it.scene.hinges]
    acting = {hinge: parts_on(it.scene, hinge) for hinge in hinges}
    losing = [part for part in STORES if any(part in parts for parts in acting.values())]
    kind = it.one_of(it.data["loss"], ["all", *losing, *TAKEN])
    needs = [("joint_work", f"{h} {kind}") for h, parts in acting.items() if kind in parts]
    who = "everything" if kind == "all" else kind
    return Found((kind,), "", "J", f"energy lost by {who} so far", tuple(needs))


KINDS: dict[str, tuple[tuple[str, ...], tuple[str, ...], Callable[[Definition], Found]]] = {
    "acceleration": (("component",), (), _vector),
    "angular_velocity": (("component",), (), _vector),
    "opening_rate": ((), (), _rate),
    "joint_moment": ((), ("part",), _moment),
    "joint_power": ((), ("part",), _moment),
    "constraint_force": (("component",), (), _vector),
    "constraint_moment": (("component",), (), _vector),
    "reaction_force": (("component",), (), _vector),
    "reaction_moment": (("component",), (), _vector),
    "section_force": (("at", "component"), (), _section),
    "section_moment": (("at", "component"), (), _section),
    "stress": ((), (), _one),
    "clearance": ((), (), _clearance),
    "loss": ((), (), _loss),
}
"""Each kind with the other keys that its definition needs, those that it may have, its reader."""


def read(name: str, kind: str, data: Mapping[str, Any], scene: Scene) -> Found:
    """What the definition of a response of one of KINDS means; SceneError names what is wrong."""
    needed, optional, reader = KINDS[kind]
    missing = [key for key in needed if key not in data]
    if missing or set(data) - {kind, *needed, *optional}:
        others = f" and {', '.join(needed)}" if needed else ""
        more = f", perhaps with {', '.join(optional)}" if optional else ""
        alone = "" if needed or optional else " alone"
        raise SceneError(f"responses.{name}", dict(data), f"{kind}{others}{more}{alone}")
    return reader(Definition(name, kind, data, scene))


def evaluate(kind: str, about: tuple[str, ...], component: str, needs, run) -> np.ndarray:
    """Values (t,) of a response of one of KINDS; run: an Outcome or Curves with what it needs."""
    columns = [run.asked[need] for need in needs]
    if kind == "loss":
        return _lost(about[0], columns, run.energies)
    if kind == "joint_power":
        rate, *columns = columns
        return rate * np.sum([np.zeros_like(rate), *columns], axis=0)
    if kind == "joint_moment":
        return np.sum([np.zeros(len(run.time)), *columns], axis=0)
    if component == "norm":
        return np.sqrt(np.sum(np.square(columns), axis=0))
    return columns[0]


def _lost(kind: str, works: list[np.ndarray], energies: Mapping[str, np.ndarray]) -> np.ndarray:
    """Energy (t,) J lost so far: by all, an account of the balance, or what a part of the moments
    has neither done as work on the hinges nor stored."""
    if kind == "all":
        return energies["joint_loss"] + sum(energies[name] for name in TAKEN.values())
    if kind in TAKEN:
        return energies[TAKEN[kind]]
    lost = -np.sum(works, axis=0)
    if STORES[kind]:
        stored = energies[STORES[kind]]
        lost = lost - (stored - stored[0])
    return lost + energies["motor_work"] if kind == "motor" else lost
