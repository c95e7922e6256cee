"""Responses: scalar functions of time that are read off a run.

KINDS is the table of all: those that every run records, those that are a variable of
`fpm.reading.variables` as it is (its entry there is all there is to such a one), and those that are
made of several.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from fpm.elements import Latch, RigidLatch, energies_of, kinds_of
from fpm.elements.openings.latch import SERIES
from fpm.elements.openings.opening import SLIDING
from fpm.errors import SceneError, did_you_mean
from fpm.files.trajectory import Column, Curves
from fpm.reading import bars, margins
from fpm.reading.margins import Along
from fpm.reading.variables import VARIABLES, Variable
from fpm.scenes.scene import Scene

AXES = ("x", "y", "z")
ALL = {"all": "all bars"}

Names = Callable[[Scene], Iterable[str]]
"""Of a scene: what something may be of."""


@dataclass(frozen=True)
class Response:
    """A named response: `kind`, what it is about (points, a hinge, ...), `component` of a vector.

    unit (UDUNITS) and long_name are those of the values that `evaluate` returns. columns: what of a
    run it is made of, beside points and energies (`Curves.columns`). along: over what it lies, if
    not over time; factors: of its columns, if it has some.
    """

    name: str
    kind: str
    about: tuple[str, ...]
    component: str
    unit: str
    long_name: str
    columns: tuple[Column, ...] = ()
    along: Along | None = None
    factors: tuple = ()

    @property
    def needs(self) -> tuple[Column, ...]:
        """Columns that a run must record for it, beside what is always recorded."""
        return tuple(column for column in self.columns if column[0] in VARIABLES)

    @property
    def least(self) -> float | None:
        """The least value that it can have; None where there is none."""
        if self.kind == "margin":
            return -1.0
        positive = KINDS[self.kind].positive
        some = isinstance(positive, tuple) and self.about[0] in positive
        return 0.0 if self.component == "norm" or positive is True or some else None

    def evaluate(self, run: Curves) -> np.ndarray:
        """Values (t,) of the response for one run; KeyError if it did not record its needs."""
        return KINDS[self.kind].values(self, run)


def parse(name: str, definition: Mapping[str, Any], scene: Scene) -> Response:
    """A response from its definition in a config, one of KINDS as docs/responses.md describes them;
    SceneError names what is wrong."""
    if not isinstance(definition, Mapping) or len(set(definition) & set(KINDS)) != 1:
        raise SceneError(f"responses.{name}", definition, f"exactly one of {', '.join(KINDS)}")
    kind = next(k for k in KINDS if k in definition)
    needed, optional = KINDS[kind].needed, KINDS[kind].optional
    missing = [key for key in needed if key not in definition]
    if missing or set(definition) - {kind, *needed, *optional}:
        others = f" and {', '.join(needed)}" if needed else ""
        more = f", perhaps with {', '.join(optional)}" if optional else ""
        alone = "" if needed or optional else " alone"
        raise SceneError(f"responses.{name}", dict(definition), f"{kind}{others}{more}{alone}")
    return KINDS[kind].read(Definition(name, kind, definition, scene))


# -- definitions ----------------------------------------------------------------------------------


class Definition(NamedTuple):
    """A definition in a config: the name of its response, its kind, its keys, the scene."""

    name: str
    kind: str
    data: Mapping[str, Any]
    scene: Scene

    def one_of(self, known: Iterable[str], key: str = "", value: object = None) -> str:
        """The value of a key, or of the kind, or another one; SceneError unless it is known."""
        key, names = key or self.kind, list(known)
        value = self.data[key] if value is None else value
        if not isinstance(value, str) or value not in names:
            hint = did_you_mean(value, names) if isinstance(value, str) else ""
            allowed = f"one of {', '.join(names) or '(this scene has none)'}{hint}"
            raise SceneError(f"responses.{self.name}.{key}", value, allowed)
        return value

    def hinge(self) -> tuple[str, bool, str]:
        """The hinge that it is about, whether it is a slide, and its words."""
        slides = {hinge.name: hinge.slides for hinge in self.scene.hinges}
        name = self.one_of(slides)
        kind = "slide" if slides[name] else "hinge"
        return name, slides[name], f"the {kind}" if name == kind else f"{kind} {name}"

    @property
    def variable(self) -> Variable:
        """The variable of its kind."""
        return VARIABLES[self.kind]

    def response(self, about: tuple[str, ...], component: str, *more: Any) -> Response:
        """The response that it means, of the other fields of one."""
        return Response(self.name, self.kind, about, component, *more)


def _vector(it: Definition, names: Names | None = None, unit: str = "") -> Response:
    """A vector along or about global axes, or its size: of a variable, or of some names."""
    name = it.one_of((names or it.variable.names)(it.scene))
    component = it.one_of((*AXES, "norm"), "component")
    own = AXES if component == "norm" else (component,)
    what = "magnitude of the " if component == "norm" else f"{component}-component of the "
    columns = () if names else tuple((it.kind, f"{name} {axis}") for axis in own)
    text = f"{what}{it.kind.replace('_', ' ')} of {name}"
    return it.response((name,), component, unit or it.variable.unit, text, columns)


def _pair(it: Definition, what: str, known: Names, column: bool = True) -> Response:
    """Two different ones of the known names, in their order."""
    value, names = it.data[it.kind], list(known(it.scene))
    if not isinstance(value, list | tuple) or len(value) != 2 or value[0] == value[1]:
        raise SceneError(f"responses.{it.name}.{it.kind}", value, f"two different {what}")
    pair = sorted((it.one_of(names, value=name) for name in value), key=names.index)
    columns = ((it.kind, " to ".join(pair)),) if column else ()
    return it.response(tuple(pair), "", "m", f"{it.kind} between {' and '.join(pair)}", columns)


def _one(it: Definition, unit: str, text: str, known: Names, variable: str = "") -> Response:
    """A column of a variable by its label, or what has no column: an energy."""
    name = it.one_of(known(it.scene))
    columns = ((variable, name),) if variable else ()
    return it.response((name,), "", unit, text.format(ALL.get(name, name)), columns)


def _bar(it: Definition) -> Response:
    known, unit = it.variable.names, it.variable.unit
    return _one(it, unit, f"equivalent {it.kind} in {{}}", known, it.kind)


def _section(it: Definition) -> Response:
    """A component of what a section of a bar bears, or the size of both of two axes."""
    name, share, parts = it.one_of(it.variable.names(it.scene)), it.data["at"], it.variable.parts
    real = isinstance(share, int | float) and not isinstance(share, bool)
    if not (real and 0 <= share <= 1):
        allowed = "a share of the bar's length, from 0 to 1"
        raise SceneError(f"responses.{it.name}.at", share, allowed)
    both = parts[1].removesuffix("_y")
    component = it.one_of((*parts, both), "component")
    own = parts[1:] if component == both else (component,)
    what = it.kind.removeprefix("section_")
    text = component.replace("_", " along " if what == "force" else " about ")
    text = f"{text} {what} of {name} at {share:g} of its length"
    columns = tuple((it.kind, f"{name} at {share:g} {each}") for each in own)
    size = "norm" if component == both else component
    return it.response((name, f"{share:g}"), size, it.variable.unit, text, columns)


def _opening(it: Definition, unit: str, words: str) -> Response:
    """An opening of a hinge or slide, or its rate."""
    name, slides, on = it.hinge()
    variable, unit = (SLIDES[it.kind], SLIDING[unit]) if slides else (it.kind, unit)
    return it.response((name,), "", unit, f"{words} of {on}", ((variable, name),))


def _latch(it: Definition) -> Response:
    """What every run records of a latch; impacts are those of latches that hold exactly."""
    kinds = (RigidLatch,) if it.kind == "latch_impact" else (Latch, RigidLatch)
    latches = {latch.label(it.scene): latch for k in kinds for latch in k.of(it.scene)}
    value, hinges = it.data[it.kind], it.scene.hinges
    on = [label for label, latch in latches.items() if hinges[latch.hinge].name == value]
    label = on[0] if len(on) == 1 and value not in latches else it.one_of(latches)
    unit, _, _, text = SERIES[it.kind]
    variable = it.kind
    if hinges[latches[label].hinge].slides:
        unit, variable = SLIDING[unit], f"slide_{variable.replace('moment', 'force')}"
    return it.response((label,), "", unit, f"{text} of latch {label}", ((variable, label),))


def parts_on(scene: Scene, hinge: str) -> list[str]:
    """The parts of the moment on a hinge that something in the scene has."""
    index = [h.name for h in scene.hinges].index(hinge)
    acting = (kind for kind in kinds_of([scene]) if kind.acts_as)
    found = (k.acts_as for k in acting for e in k.of(scene) if index in e.acts_on())
    return list(dict.fromkeys(found))


def _moment(it: Definition) -> Response:
    """The moment on a hinge, or force on a slide, by one part, or by all, or its power."""
    name, slides, on = it.hinge()
    variable, rate = "joint_moment", "opening_rate"
    if slides:
        variable, rate = SLIDES[variable], SLIDES[rate]
    acting = parts_on(it.scene, name)
    part = it.one_of((*acting, "sum"), "part", it.data.get("part", "sum"))
    columns = tuple((variable, f"{name} {each}") for each in (acting if part == "sum" else [part]))
    who = "all that acts" if part == "sum" else part
    what, unit = "force" if slides else "moment", VARIABLES[variable].unit
    if it.kind == "joint_power":
        what, unit, columns = "power", "W", ((rate, name), *columns)
    return it.response((name, part), "", unit, f"{what} of {who} on {on}", columns)


SLIDES = {"opening": "slide_opening", "opening_rate": "slide_rate", "joint_moment": "joint_force"}
"""Variables of hinges, and those of slides."""

STORES = {"damper": None, "friction": "friction", "stop": "stop", "latch": "latch",
          "release": "release", "motor": "motor"}  # fmt: skip
"""Parts of the moment on openings that lose energy, and the energy that each stores."""

TAKEN = {"damping": "damping_work", "cables": "cable_friction"}
"""Losses that are energies of the balance, always recorded."""


def _loss(it: Definition) -> Response:
    """Energy lost so far by one kind of element, or by all."""
    acting = {hinge.name: parts_on(it.scene, hinge.name) for hinge in it.scene.hinges}
    losing = [part for part in STORES if any(part in parts for parts in acting.values())]
    kind = it.one_of(["all", *losing, *TAKEN])
    columns = [("joint_work", f"{h} {kind}") for h, parts in acting.items() if kind in parts]
    who = "everything" if kind == "all" else kind
    return it.response((kind,), "", "J", f"energy lost by {who} so far", tuple(columns))


# -- values ---------------------------------------------------------------------------------------


def _of_columns(response: Response, run: Curves) -> np.ndarray:
    """The column that it is, or the size of the vector of its columns."""
    columns = [run.columns[column] for column in response.columns]
    if response.component == "norm":
        return np.sqrt(np.sum(np.square(columns), axis=0))
    return columns[0]


def _apart(response: Response, run: Curves) -> np.ndarray:
    first, second = (run.points[point][0] for point in response.about)
    return np.linalg.norm(first - second, axis=1)


def _of_point(which: int, response: Response, run: Curves) -> np.ndarray:
    track = run.points[response.about[0]][which]
    if response.component == "norm":
        return np.linalg.norm(track, axis=1)
    return track[:, AXES.index(response.component)]


def _sum(response: Response, run: Curves) -> np.ndarray:
    columns = (run.columns[column] for column in response.columns)
    return np.sum([np.zeros(len(run.time)), *columns], axis=0)


def _power(response: Response, run: Curves) -> np.ndarray:
    rate, *columns = (run.columns[column] for column in response.columns)
    return rate * np.sum([np.zeros_like(rate), *columns], axis=0)


def _lost(response: Response, run: Curves) -> np.ndarray:
    """Energy (t,) J lost so far: by all, an account of the balance, or what a part of the moments
    has neither done as work on the hinges nor stored."""
    kind, energies = response.about[0], run.energies
    if kind == "all":
        return energies["joint_loss"] + sum(energies[name] for name in TAKEN.values())
    if kind in TAKEN:
        return energies[TAKEN[kind]]
    lost = -np.sum([run.columns[column] for column in response.columns], axis=0)
    if STORES[kind]:
        stored = energies[STORES[kind]]
        lost = lost - (stored - stored[0])
    return lost + energies["motor_work"] if kind == "motor" else lost


# -- the table ------------------------------------------------------------------------------------


class Kind(NamedTuple):
    """A kind of response, by the key that names what it is of.

    read(definition): what it means; values(response, run): its values (t,); needed, optional: the
    other keys of its definition; positive: whether it is never below 0, or about what it is not;
    shock: as of a `fpm.reading.variables.Variable`.
    """

    read: Callable[[Definition], Response]
    values: Callable[[Response, Curves], np.ndarray] = _of_columns
    needed: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    positive: bool | tuple[str, ...] = False
    shock: bool = False


FORMS = {
    "vector": (_vector, ("component",)),
    "section": (_section, ("at", "component")),
    "bar": (_bar, ()),
    "bars": (partial(_pair, what="bars", known=bars.bars_of), ()),
}
"""How definitions name columns of variables, and the other keys that it takes."""


def _as_recorded(variable: Variable) -> Kind:
    """The kind that a variable is by itself."""
    read, needed = FORMS[variable.form]
    return Kind(read, needed=needed, positive=variable.positive, shock=variable.shock)


def _points(scene: Scene) -> Iterable[str]:
    return scene.points


def _cables(scene: Scene) -> Iterable[str]:
    return (cable.name for cable in scene.cables)


def _energies(scene: Scene) -> Iterable[str]:
    return "kinetic", *(energy.name for energy in energies_of(scene.kinds)), "balance"


KINDS = {
    "distance": Kind(partial(_pair, what="points", known=_points, column=False), _apart,
                     positive=True),
    "position": Kind(partial(_vector, names=_points, unit="m"), partial(_of_point, 0),
                     ("component",)),
    "velocity": Kind(partial(_vector, names=_points, unit="m s-1"), partial(_of_point, 1),
                     ("component",)),
    "opening": Kind(partial(_opening, unit="rad", words="opening")),
    "tension": Kind(partial(_one, unit="N", text="tension of cable {}", known=_cables,
                            variable="cable_tension"), positive=True),
    # Sums of squares; the kinetic energy is a product of velocities half a step apart
    # (`fpm.kernels.record`), which can differ in sign.
    "energy": Kind(partial(_one, unit="J", text="{} energy", known=_energies),
                   lambda it, run: run.energies[it.about[0]],
                   positive=("strain", "spring", "contact")),
    **{name: Kind(_latch, shock=name == "latch_moment") for name in SERIES},
    **{name: _as_recorded(variable) for name, variable in VARIABLES.items() if variable.form},
    "opening_rate": Kind(partial(_opening, unit="rad s-1", words="rate of the opening")),
    "joint_moment": Kind(_moment, _sum, optional=("part",), shock=True),
    "joint_power": Kind(_moment, _power, optional=("part",), shock=True),
    "loss": Kind(_loss, _lost),
    "margin": Kind(margins.read, margins.values, ("to", "standard"), margins.OPTIONAL),
}  # fmt: skip
