"""Responses: scalar functions of time that are read off a run.

KINDS is the table of all: those that every run records, those that are a variable of
`fpm.reading.variables` as it is, and those that are made of several."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from fpm import elements
from fpm.declare import SLIDE_UNITS, NumberLimits
from fpm.elements import Drag, Journal, Latch, Stop, Strut, energies_of, kinds_of
from fpm.elements.openings.latch import SERIES, SIDES
from fpm.errors import SceneError, did_you_mean, fold_name
from fpm.files.trajectory import POSITION, Column, Curves
from fpm.reading import bars, margins
from fpm.reading.margins import Abscissa
from fpm.reading.variables import VARIABLES, Variable
from fpm.scenes.scene import Scene


def kind_of(key: str, definition: Any, kinds: Mapping[str, Any], addition: str = "") -> str:
    """Return the one key of a definition that is among `kinds`; SceneError for none or several, and
    for keys that are not its own. key: dotted path; kinds: with `mandatory` and `optional` keys, by
    name; addition: what else it may be, in words."""
    names = [name for name in kinds if isinstance(definition, Mapping) and name in definition]
    if len(names) != 1:
        raise SceneError(key, definition, f"exactly one of {', '.join(kinds)}{addition}")
    (name,) = names
    mandatory, optional = kinds[name].mandatory, kinds[name].optional
    unknown_keys = [entry for entry in definition if entry not in {name, *mandatory, *optional}]
    if not unknown_keys and definition.keys() >= {*mandatory}:
        return name
    allowed = f"{name} and {', '.join(mandatory)}" if mandatory else name
    allowed += f", and optionally {', '.join(optional)}" if optional else ""
    allowed += "" if mandatory or optional else " alone"
    if {"unit", "units"} & {*unknown_keys}:
        allowed += ", in the SI unit of its kind: leave the unit out"
    if len(unknown_keys) == 1:  # whose line is told
        key = f"{key}.{unknown_keys[0]}"
    raise SceneError(key, ", ".join(map(str, unknown_keys)) or dict(definition), allowed)


def check_choice(key: str, value: object, choices: Iterable[str], addition: str = "") -> str:
    """Return a `value` that is one of `choices`; else SceneError, which tells what is likely meant.
    key: of the value; addition: what else is allowed, in words."""
    names = list(choices)
    if isinstance(value, int | str) and fold_name(str(value)) in names:
        return fold_name(str(value))
    if not isinstance(value, str) or value not in names:
        quotes = ' (write a name such as "1e3" or "no" in quotes)'
        hint = did_you_mean(value, names) if isinstance(value, str) else quotes
        allowed = f"one of {', '.join(names) or '(there is none)'}{addition}{hint}"
        raise SceneError(key, value, allowed)
    return value


AXES = ("x", "y", "z")
ALL = {"all": "all bars"}
_OF_POINTS = ("distance", "position", "velocity")

Lister = Callable[[Scene], Iterable[str]]
"""Function of a scene: names of what something may be of."""


@dataclass(frozen=True)
class Response:
    """A scalar function of time that is read off a run, by its definition.

    kind: type of response (key of KINDS, as "position"); subjects: names of its points, hinge, ...;
    component: x, y, z, norm, ... of a vector, "" of a scalar; unit (UDUNITS), long_name: of the
    values that `evaluate` returns; columns: recorded series, as (variable, label), that it is
    computed from, besides points and energies; along: what it is a function of, None: time
    (margins: the opening of a hinge); factors: of margins: (output torque, its factor), then
    (actuation factor, resistance factor, class) of each component; else (); ends: where stops and
    latches end the way of an opening, down and up; None: nowhere; is_signed: whether it can be
    below 0 though others of its kind cannot, as losses in wind, which drives what it drags."""

    name: str
    kind: str
    subjects: tuple[str, ...]
    component: str
    unit: str
    long_name: str
    columns: tuple[Column, ...] = ()
    along: Abscissa | None = None
    factors: tuple = ()
    ends: tuple[float | None, float | None] = (None, None)
    is_signed: bool = False

    @property
    def needs(self) -> tuple[Column, ...]:
        """Columns (variable, label) of the response that runs record only on request."""
        return tuple(column for column in self.columns if column[0] in VARIABLES)

    @property
    def reads(self) -> tuple[Column, ...]:
        """All columns that the response is read off, its points among them, as "position"."""
        points = self.subjects if self.kind in _OF_POINTS else ()
        return (*self.columns, *((POSITION, point) for point in points))

    @property
    def least(self) -> float | None:
        """Physical lower bound of the response's values, in its unit; None where there is none."""
        if self.kind == "margin":
            return -1.0
        positive = KINDS[self.kind].positive
        is_positive = isinstance(positive, tuple) and self.subjects[0] in positive
        if self.is_signed:
            return None
        return 0.0 if self.component == "norm" or positive is True or is_positive else None

    def evaluate(self, run: Curves) -> np.ndarray:
        """Return the response's values (t,), in `unit`, in one run (its recorded series), at least
        `least`; raises KeyError if the run did not record the columns in `needs`."""
        values = KINDS[self.kind].values(self, run)
        return values if self.least is None else np.maximum(values, self.least)


def parse(name: str, definition: Mapping[str, Any], scene: Scene) -> Response:
    """Return the response that a definition in a config states, with its unit and long name;
    SceneError for keys and values that are not allowed.

    Parameters
    ----------
    name: its name.
    definition: mapping with one key that is a type (KINDS), and further ones (docs/responses.md).
    scene: the Scene whose points, hinges and bars the definition names."""
    kind = kind_of(f"responses.{name}", definition, KINDS)
    return KINDS[kind].read(Definition(name, kind, definition, scene))


# -- definitions ----------------------------------------------------------------------------------


class Definition(NamedTuple):
    """Definition of a response in a config. name: its name; kind: its type (key of KINDS), which is
    one of its keys; data: all its keys with their values; scene: the scene that it refers to."""

    name: str
    kind: str
    data: Mapping[str, Any]
    scene: Scene

    def one_of(self, choices: Iterable[str], key: str = "", value: object = None) -> str:
        """Return a value of the definition that is among `choices`, else SceneError. key: of it, by
        default the one that is the kind; value: the one to check, by default that of the key."""
        key, names = key or self.kind, list(choices)
        value = self.data[key] if value is None else value
        are_points = self.kind in _OF_POINTS and names == [*self.scene.points]
        addition = "; the list `record` of the structure's file may name others"
        addition = addition if are_points else ""
        return check_choice(f"responses.{self.name}.{key}", value, names, addition)

    def hinge(self) -> tuple[str, bool, str]:
        """Return the hinge or slide that the definition names: its name, whether it is a slide, and
        words for messages ("hinge A"); raises SceneError if the scene has none of this name."""
        slides = {hinge.name: hinge.slides for hinge in self.scene.hinges}
        name = self.one_of(slides)
        kind = "slide" if slides[name] else "hinge"
        return name, slides[name], f"the {kind}" if name == kind else f"{kind} {name}"

    @property
    def variable(self) -> Variable:
        """Variable (fpm.reading.variables) with the name of the definition's type, or KeyError."""
        return VARIABLES[self.kind]

    def response(self, subjects: tuple[str, ...], component: str, *fields: Any) -> Response:
        """Return the Response of this definition, with its name and kind. subjects: names of what
        it is of; component: as "x", or ""; fields: the further fields of Response, in order."""
        return Response(self.name, self.kind, subjects, component, *fields)


_SIZES = {"velocity": "speed", "angular velocity": "angular speed"}
"""What the sizes of vectors are called."""


def _vector(spec: Definition, names: Lister | None = None, unit: str = "") -> Response:
    """Make a response of a vector's component, or of its size, from a variable or points."""
    name = spec.one_of((names or spec.variable.names)(spec.scene))
    component = spec.one_of((*AXES, "norm"), "component")
    axes = AXES if component == "norm" else (component,)
    noun = spec.kind.replace("_", " ")
    noun = f"{component}-{noun}" if component in AXES else _SIZES.get(noun, f"size of the {noun}")
    columns = () if names else tuple((spec.kind, f"{name} {axis}") for axis in axes)
    text = f"{noun} of {name}"
    return spec.response((name,), component, unit or spec.variable.unit, text, columns)


def _pair(spec: Definition, noun: str, names_of: Lister, column: bool = True) -> Response:
    """Two different ones of the known names, in their order."""
    value, names = spec.data[spec.kind], list(names_of(spec.scene))
    if not isinstance(value, list | tuple) or len(value) != 2 or value[0] == value[1]:
        raise SceneError(f"responses.{spec.name}.{spec.kind}", value, f"two different {noun}")
    pair = sorted((spec.one_of(names, value=name) for name in value), key=names.index)
    columns = ((spec.kind, " to ".join(pair)),) if column else ()
    return spec.response(tuple(pair), "", "m", f"{spec.kind} between {' and '.join(pair)}", columns)


def _by_name(spec: Definition, unit: str, text: str, names: Lister, variable: str = "") -> Response:
    """Make a response from a column of a variable, or from an energy, which has none."""
    name = spec.one_of(names(spec.scene))
    columns = ((variable, name),) if variable else ()
    return spec.response((name,), "", unit, text.format(ALL.get(name, name)), columns)


def _bar(spec: Definition) -> Response:
    names, unit = spec.variable.names, spec.variable.unit
    if not names(spec.scene):
        allowed = f"a structure with bars: only these have {spec.kind}, and bodies are rigid"
        raise SceneError(f"responses.{spec.name}.{spec.kind}", spec.data[spec.kind], allowed)
    return _by_name(spec, unit, f"equivalent {spec.kind} in {{}}", names, spec.kind)


def _section(spec: Definition) -> Response:
    """Make a response of a bar's section force or moment, or of the size of both axes."""
    parts, name = spec.variable.parts, spec.one_of(spec.variable.names(spec.scene))
    key, share = f"responses.{spec.name}.at", "a share of the bar's length,"
    fraction = NumberLimits(least=0, most=1).check(key, spec.data["at"], share)
    bending = parts[1].removesuffix("_y")
    component = spec.one_of((*parts, bending), "component")
    labels = parts[1:] if component == bending else (component,)
    noun = spec.kind.removeprefix("section_")
    text = component.replace("_", " along " if noun == "force" else " about ")
    text = f"{text} {noun} of {name} at {fraction:g} of its length"
    columns = tuple((spec.kind, f"{name} at {fraction:g} {label}") for label in labels)
    size = "norm" if component == bending else component
    return spec.response((name, f"{fraction:g}"), size, spec.variable.unit, text, columns)


def _of_cable(key: str, variable: str, unit: str, spec: Definition) -> Response:
    """Make a response of a cable: the tension of a stretch, or the length that ran over a point
    between its ends, both numbered from 1. Without a number it is the first stretch."""
    counts = {cable.name: len(cable.beams) - 1 for cable in spec.scene.cables}  # of stretches
    name = spec.one_of(counts)
    count = counts[name]
    number, least = spec.data.get(key, 1), 1 if key == "stretch" else 2
    if isinstance(number, bool) or number not in range(least, count + 1):
        allowed = f"the number of a {key} of cable {name}, {least} to {count}"
        allowed = allowed if count >= least else f"of a cable over points: {name} has its ends only"
        raise SceneError(f"responses.{spec.name}.{key}", number, allowed)
    if key not in spec.data or count == 1:
        column, place = ("cable_tension", name), ""
    else:
        column, place = (variable, f"{name} {int(number)}"), f"{key} {int(number)} of "
    words = "tension of" if key == "stretch" else "length that ran over"
    return spec.response((column[1],), "", unit, f"{words} {place}cable {name}", (column,))


def _opening(spec: Definition, unit: str, words: str) -> Response:
    """Make the response of an opening of a hinge or slide, or of its rate."""
    name, slides, place = spec.hinge()
    variable, unit = (SLIDES[spec.kind], SLIDE_UNITS[unit]) if slides else (spec.kind, unit)
    response = spec.response((name,), "", unit, f"{words} of {place}", ((variable, name),))
    return replace(response, ends=_ends(spec.scene, name)) if spec.kind == "opening" else response


def _ends(scene: Scene, name: str) -> tuple[float | None, float | None]:
    """Return the openings at which the first stop or latch holds a hinge, down and up."""
    index = [hinge.name for hinge in scene.hinges].index(name)
    start = scene.hinges[index].opening
    floors: list[float] = []
    ceilings: list[float] = []
    for stop in (stop for stop in Stop.find(scene) if stop.hinge == index):
        (ceilings if stop.side == "above" else floors).append(stop.angle)
    for latch in Latch.find(scene):
        lets_pass = latch.is_ratchet or np.isfinite(latch.max_capture_rate)
        if latch.hinge == index and not lets_pass:
            is_up = (SIDES[latch.side] or latch.angle - start) > 0
            (ceilings if is_up else floors).append(latch.angle)
    return max(floors, default=None), min(ceilings, default=None)


def _latch(spec: Definition) -> Response:
    """Make a response of a latch; only those that hold exactly have impacts."""
    is_impact = spec.kind == "latch_impact"
    elements = [e for e in Latch.find(spec.scene) if e.is_exact or not is_impact]
    latches = {latch.label(spec.scene): latch for latch in elements}
    value, hinges = spec.data[spec.kind], spec.scene.hinges
    labels = [label for label, latch in latches.items() if hinges[latch.hinge].name == value]
    label = labels[0] if len(labels) == 1 and value not in latches else spec.one_of(latches)
    unit, _, _, text = SERIES[spec.kind]
    variable = spec.kind
    if hinges[latches[label].hinge].slides:
        unit, variable = SLIDE_UNITS[unit], f"slide_{variable.replace('moment', 'force')}"
    component, columns = spec.data.get("component", "norm"), ((variable, label),)
    component = spec.one_of(("norm", "signed"), "component", component) if is_impact else ""
    return spec.response((label,), component, unit, f"{text} of latch {label}", columns)


def parts_on(scene: Scene, hinge: str) -> list[str]:
    """Return the components of the moment on a hinge in a scene ("spring", "friction", ...), by the
    elements that act on it, each once. hinge: its name."""
    index = [h.name for h in scene.hinges].index(hinge)
    types = (kind for kind in kinds_of([scene]) if kind.acts_as)
    parts = (k.acts_as for k in types for e in k.find(scene) if index in e.acts_on())
    return list(dict.fromkeys(parts))


def _moment(spec: Definition) -> Response:
    """Return the moment on a hinge, or force on a slide, by one part, or by all, or its power."""
    name, slides, place = spec.hinge()
    variable, rate = "joint_moment", "opening_rate"
    if slides:
        variable, rate = SLIDES[variable], SLIDES[rate]
    parts = parts_on(spec.scene, name)
    part = spec.one_of((*parts, "sum"), "part", spec.data.get("part", "sum"))
    columns = tuple((variable, f"{name} {p}") for p in (parts if part == "sum" else [part]))
    actor = "all that acts" if part == "sum" else part
    noun, unit = "force" if slides else "moment", VARIABLES[variable].unit
    if spec.kind == "joint_power":
        noun, unit, columns = "power", "W", ((rate, name), *columns)
    return spec.response((name, part), "", unit, f"{noun} of {actor} on {place}", columns)


SLIDES = {"opening": "slide_opening", "opening_rate": "slide_rate", "joint_moment": "joint_force"}
"""Variables of hinges, and those of slides."""

STORES = {"damper": None, "friction": "friction", "stop": "stop", "latch": "latch",
          "release": "release", "motor": "motor"}  # fmt: skip
"""Parts of the moment on openings that lose energy, and the energy that each stores."""

LOSSES = {"damping": "damping_work", "cables": "cable_friction"}
"""Losses that are energies of the balance, always recorded."""


def _loss(spec: Definition) -> Response:
    """Make the response of the energy lost so far by one kind of element, or by all."""
    by_hinge = {hinge.name: parts_on(spec.scene, hinge.name) for hinge in spec.scene.hinges}
    losses = [part for part in STORES if any(part in parts for parts in by_hinge.values())]
    kind = spec.one_of(["all", *losses, *LOSSES])
    columns = [("joint_work", f"{h} {kind}") for h, parts in by_hinge.items() if kind in parts]
    actor = "everything" if kind == "all" else kind
    response = spec.response((kind,), "", "J", f"energy lost by {actor} so far", tuple(columns))
    is_blown = any(np.any(drag.wind) for drag in Drag.find(spec.scene))
    return replace(response, is_signed=is_blown and kind in ("all", "damping"))


# -- values ---------------------------------------------------------------------------------------


def _of_columns(response: Response, run: Curves) -> np.ndarray:
    """Return the column that it is, or the size of the vector of its columns."""
    columns = [run.columns[column] for column in response.columns]
    if response.component == "norm":
        return np.sqrt(np.sum(np.square(columns), axis=0))
    return columns[0]


def _distance(response: Response, run: Curves) -> np.ndarray:
    first, second = (run.points[point][0] for point in response.subjects)
    return np.linalg.norm(first - second, axis=1)


def _of_point(index: int, response: Response, run: Curves) -> np.ndarray:
    track = run.points[response.subjects[0]][index]
    if response.component == "norm":
        return np.linalg.norm(track, axis=1)
    return track[:, AXES.index(response.component)]


def _sum(response: Response, run: Curves) -> np.ndarray:
    columns = (run.columns[column] for column in response.columns)
    return np.sum([np.zeros(len(run.time)), *columns], axis=0)


def _power(response: Response, run: Curves) -> np.ndarray:
    rate, *columns = (run.columns[column] for column in response.columns)
    return rate * np.sum([np.zeros_like(rate), *columns], axis=0)


def _dissipated_energy(response: Response, run: Curves) -> np.ndarray:
    """Energy (t,) J lost so far: by all, an account of the balance, or what a part of the moments
    has neither done as work on the hinges nor stored."""
    kind, energies = response.subjects[0], run.energies
    if kind == "all":
        return energies["joint_loss"] + sum(energies[name] for name in LOSSES.values())
    if kind in LOSSES:
        return energies[LOSSES[kind]]
    loss = -np.sum([run.columns[column] for column in response.columns], axis=0)
    if store := STORES[kind]:
        energy = energies[store]
        loss = loss - (energy - energy[0])
    return loss + energies["motor_work"] if kind == "motor" else loss


# -- the table ------------------------------------------------------------------------------------


class ResponseType(NamedTuple):
    """A type of response, in KINDS. read(definition): returns the Response; values(response, run):
    its values (t,) in a run; mandatory, optional: further keys that a definition must or may have;
    positive: whether values are never below 0 (a tuple: of these subjects alone); shock: whether an
    impact makes values jump, so that mesh and step decide its peak."""

    read: Callable[[Definition], Response]
    values: Callable[[Response, Curves], np.ndarray] = _of_columns
    mandatory: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    positive: bool | tuple[str, ...] = False
    shock: bool = False


FORMS: dict[str, tuple[Callable, tuple[str, ...]]] = {
    "vector": (_vector, ("component",)),
    "section": (_section, ("at", "component")),
    "bar": (_bar, ()),
    "bars": (partial(_pair, noun="bars", names_of=bars.bars_of), ()),
}
"""How definitions name columns of variables, and the other keys that it takes."""


def _points(scene: Scene) -> Iterable[str]:
    return scene.points


def _struts(scene: Scene) -> Iterable[str]:
    return (strut.name for strut in Strut.find(scene))


def _pins(scene: Scene) -> Iterable[str]:
    return (pin.label(scene) for pin in Journal.find(scene))


def _energies(scene: Scene) -> Iterable[str]:
    energies = energies_of([*elements.KINDS, *scene.kinds])
    return "kinetic", *(energy.name for energy in energies), "balance"


_POSITIVE = (
    "kinetic", "strain", "spring", "contact", "friction", "stop", "latch", "release", "motor",
    "loop", "pin", "cable", "joint_loss", "cable_friction",
)  # fmt: skip
"""Energies that are sums of squares, or losses. Recorded ones may be below 0 by errors of the step,
as products of velocities half a step apart (`fpm.kernels.record`)."""

KINDS = {
    "distance": ResponseType(partial(_pair, noun="points", names_of=_points, column=False),
                             _distance, positive=True),
    "position": ResponseType(partial(_vector, names=_points, unit="m"), partial(_of_point, 0),
                             ("component",)),
    "velocity": ResponseType(partial(_vector, names=_points, unit="m s-1"), partial(_of_point, 1),
                             ("component",)),
    "opening": ResponseType(partial(_opening, unit="rad", words="opening")),
    "tension": ResponseType(partial(_of_cable, "stretch", "stretch_tension", "N"),
                            optional=("stretch",), positive=True),
    "slip": ResponseType(partial(_of_cable, "point", "cable_slip", "m"), mandatory=("point",)),
    "strut_force": ResponseType(partial(_by_name, unit="N", text="force of strut {}", names=_struts,
                                        variable="strut_force")),
    "strut_length": ResponseType(partial(_by_name, unit="m", text="length of strut {}",
                                         names=_struts, variable="strut_length"), positive=True),
    "pin_force": ResponseType(partial(_by_name, unit="N", text="force that presses pin {}",
                                      names=_pins, variable="pin_force"), positive=True),
    "pin_eccentricity": ResponseType(partial(_by_name, unit="m", text="eccentricity of pin {}",
                                             names=_pins, variable="pin_eccentricity"),
                                     positive=True),
    "energy": ResponseType(partial(_by_name, unit="J", text="{} energy", names=_energies),
                   lambda response, run: run.energies[response.subjects[0]],
                   positive=_POSITIVE),
    **{name: ResponseType(_latch, shock=name == "latch_moment") for name in SERIES},
    "latch_impact": ResponseType(_latch, optional=("component",)),
    **{name: ResponseType(FORMS[v.response_form][0], mandatory=FORMS[v.response_form][1],
                          positive=v.positive, shock=v.shock)
       for name, v in VARIABLES.items() if v.response_form},
    "opening_rate": ResponseType(partial(_opening, unit="rad s-1", words="rate of the opening")),
    "joint_moment": ResponseType(_moment, _sum, optional=("part",), shock=True),
    "joint_power": ResponseType(_moment, _power, optional=("part",), shock=True),
    "loss": ResponseType(_loss, _dissipated_energy, positive=True),
    "margin": ResponseType(
        margins.read_margin, margins.values, ("to", "standard"), margins.OPTIONAL
    ),
}  # fmt: skip
