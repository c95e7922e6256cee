"""Torque and force margins over a travel: their definitions, and their values.

Runs record the virtual work of every part (`fpm.travel`) at positions of their own; factors are
applied when a response is read, so that another standard takes no run. The curve of a margin is
even over the travel; the least margin is sought between all positions."""

from collections.abc import Iterable, Mapping
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from fpm.declare import NumberLimits
from fpm.elements import Journal
from fpm.errors import SceneError
from fpm.reading.standards import CLASSES, STANDARDS
from fpm.travel import Travel, interpolate, sweep
from fpm.travel.components import component_classes, find_reels
from fpm.travel.path import TINY

WORK, INERTIA, OPENING = "travel_work", "travel_inertia", "travel_opening"
"""Variables of what is recorded (fpm.reading.variables)."""

MOST = 99.0
"""Largest margin that is given: where next to nothing resists, margins have no end."""

ROUNDING = 1e-12
"""Margins below this value are rounding: what acts is known to 1e-6 of itself."""

FINER, ZOOMS = 8, 7
"""Number of parts of each distance of positions in the search of the least margin, and number of
repetitions in the distances next to the last minimum."""

DRIVES = 1e-6
"""Fraction of the largest virtual work of all parts up to which that of a part drives nothing."""

STOW = "stow"
"""The opening at the start of a run, whichever that is."""

OPTIONAL = ("from", "evidence", "with", "locked", "without", "classes", "uncertainty_factors",
            "actuation_factors", "specified_acceleration", "output_torque")  # fmt: skip
LARGEST = 20.0
"""Largest opening (rad) without its unit: more is hardly meant but in degrees."""

UNITS = {"rad": 1.0, "deg": np.pi / 180, "m": 1.0, "mm": 1e-3}


class Abscissa(NamedTuple):
    """What the values of a response are a function of, if not of time. words: its name, as "opening
    of A"; unit: of its values; first, last: its values at the ends of the curve."""

    words: str
    unit: str
    first: float
    last: float


class OpeningPath(NamedTuple):
    """Path along which openings are moved quasi-statically. openings: hinges or slides moved
    together, the others as far from their start as the first; first, last: ends of the first (rad,
    m; None: its start in each run); locked: hinges held at their start."""

    openings: tuple[str, ...]
    first: float | None
    last: float | None
    locked: tuple[str, ...] = ()

    def label(self, part: str = "") -> str:
        """Return the label of a recorded column for a travel along this path, such as "A led
        from 0.0 to 1.5 by spring". part: the part whose virtual work it has, such as "spring";
        "": none."""
        suffix = "".join(f" beside {name}" for name in self.locked) + (part and f" by {part}")
        first, last = (STOW if end is None else repr(end) for end in (self.first, self.last))
        names = "".join(f" with {name}" for name in self.openings[1:])
        return f"{self.openings[0]} led from {first} to {last}{names}{suffix}"


def read_label(label: str) -> tuple[OpeningPath, str]:
    """Return the path (OpeningPath) that the label of a recorded column names, such as "A led from
    0.0 to 1.5 by spring", and the component of the virtual work in it, "" if none."""
    rest, _, part = label.partition(" by ")
    rest, *locked = rest.split(" beside ")
    rest, *names = rest.split(" with ")
    name, _, values = rest.partition(" led from ")
    first, last = (None if end == STOW else float(end) for end in values.split(" to "))
    return OpeningPath((name, *names), first, last, tuple(locked)), part


def travel_of(scene, path: OpeningPath, positions: int | None = None) -> Travel:
    """Move openings (joint coordinates) of a scene slowly along a path; returns openings, virtual
    works and inertia there (Travel). positions: number of evenly spaced ones; None: as many as the
    tolerance takes. SceneError where the opening does not move or does not decide the motion."""
    (start,) = (hinge.opening for hinge in scene.hinges if hinge.name == path.openings[0])
    first, last = (float(start) if end is None else end for end in (path.first, path.last))
    if first == last:
        name = f"opening {path.openings[0]}"
        raise SceneError(name, f"{first:.6g} at the start", "another one than the last")
    return sweep(scene, path.openings, first, last, path.locked, positions)


def column_of(travel: Travel, variable: str, part: str) -> Any:
    """Return the values (p,) of a variable at the positions of a travel: "travel_work" of the
    component `part` (N m; N), None: there is none; "travel_inertia" (kg m²; kg); "travel_opening"
    (rad; m)."""
    if variable == WORK:
        return travel.work.get(part)
    return travel.inertia if variable == INERTIA else travel.opening


def find_drives(works: Mapping[str, np.ndarray]) -> list[str]:
    """Return the names of components that drive somewhere on a travel, by more than rounding.
    works: virtual work (p,) at its p positions by component, above 0 where it drives."""
    largest = max((float(np.abs(work).max()) for work in works.values()), default=0.0)
    return [part for part, work in works.items() if work.max() > DRIVES * largest]


def sweep_travel(scene, responses: Iterable[Any]) -> Any:
    """Move openings of a scene slowly as `responses`, all margins, need it, without a run. Return
    what serves as `run` of `values`, `least`, `make_torque_budget`: an object with `columns` (p,),
    by (variable, label), and `time`, 201 values, which sets only how many margins `values`
    gives."""
    columns, travels = {}, {}
    for variable, label in dict.fromkeys(c for response in responses for c in response.columns):
        path, part = read_label(label)
        if path not in travels:
            travels[path] = travel_of(scene, path)
        columns[variable, label] = column_of(travels[path], variable, part)
    return SimpleNamespace(time=np.linspace(0.0, 1.0, 201), columns=columns)


def read_margin(spec: Any) -> Any:
    """Return the Response that the definition of a torque or force margin in a config states. spec:
    the definition (`responses.Definition`); raises SceneError for wrong keys and values."""
    path, abscissa = _path_of(spec)
    standard = STANDARDS[spec.one_of(STANDARDS, "standard")]
    evidence = spec.data.get("evidence", next(iter(standard.resists)))
    resists = standard.resists[spec.one_of(standard.resists, "evidence", evidence)]
    resists = resists | _numbers(spec, "uncertainty_factors")
    drives = standard.drives | _numbers(spec, "actuation_factors")
    classes = _classes_of(spec)
    columns = [(OPENING, path.label()), *((WORK, path.label(part)) for part in classes)]
    factors = [(drives[name], resists[name], name) for name in classes.values()]
    rate = _number(spec, "specified_acceleration", spec.data.get("specified_acceleration", 0.0))
    if rate:
        columns.append((INERTIA, path.label()))
        factors.append((0.0, resists["TD"] * rate, "TD"))
    output = _number(spec, "output_torque", spec.data.get("output_torque", 0.0))
    if not (factors or output):
        allowed = "an opening on which something acts that a margin counts; here nothing does"
        raise _error(spec, spec.kind, path.openings[0], allowed)
    text = f"margin of {' and '.join(path.openings)}, {standard.title}, {evidence}"
    subjects = (*path.openings, spec.data["standard"], evidence, *_names(spec, "without"))
    load = (output, resists["TL"])
    return spec.response(subjects, "", "1", text, tuple(columns), abscissa, (load, *factors))


def _path_of(spec) -> tuple[OpeningPath, Abscissa]:
    """Return the prescribed path of the openings, and the abscissa of the margin."""
    openings = (spec.data[spec.kind], *_names(spec, "with"))
    for pin in Journal.find(spec.scene):
        allowed = f"a structure without {pin.title(spec.scene)}: within its clearance it has no "
        allowed += "balance; a case with a revolute joint and a `bearing` in its place has margins"
        raise _error(spec, spec.kind, openings[0], allowed)
    hinges = {hinge.name: hinge for hinge in spec.scene.hinges}
    for name in openings:
        spec.one_of(hinges, value=name)
    if len(set(openings)) < len(openings):
        raise _error(spec, "with", [*openings], "each opening once")
    locked = tuple(spec.one_of(hinges, "locked", name) for name in _names(spec, "locked"))
    for name in locked:
        if name in openings:
            raise _error(spec, "locked", name, "openings that are not moved")
    hinge = hinges[openings[0]]
    unit = "m" if hinge.slides else "rad"
    ends = [_opening(spec, key, hinge, unit) for key in ("from", "to")]
    first, last = (float(hinge.opening) if end is None else end for end in ends)
    if first == last:
        raise _error(spec, "to", spec.data["to"], "another opening than `from`")
    suffix = ", from each run's start" if ends[0] is None else ""
    abscissa = Abscissa(f"opening of {openings[0]}{suffix}", unit, first, last)
    return OpeningPath(openings, ends[0], ends[1], locked), abscissa


def _classes_of(spec) -> dict[str, str]:
    """Class of each component that counts, by name: all but those left out."""
    parts = component_classes(spec.scene)
    inactive = [spec.one_of(parts, "without", name) for name in _names(spec, "without")]
    classes = parts | {
        spec.one_of(parts, "classes", part): spec.one_of(CLASSES, f"classes.{part}", name)
        for part, name in _mapping(spec, "classes").items()
    }
    for part in find_reels(spec.scene):
        if part in parts and part not in inactive:
            allowed = f"{part} among them: a curve of time reels it, and a travel has no time"
            raise _error(spec, "without", inactive, allowed)
    return {part: classes[part] for part in parts if part not in inactive}


class BudgetRow(NamedTuple):
    """Row of a component in a torque budget. part: its name; class_: its class in the standard, as
    "FR" for friction; factor: of that class; moment: virtual work per unit of the opening (N m, on
    slides N), below 0 where it resists; weighted: factor times moment."""

    part: str
    class_: str
    factor: float
    moment: float
    weighted: float


class Budget(NamedTuple):
    """Torque budget at an opening (rad, m). margin: drives / requirement - 1, at most 99; drives:
    sum of the components' moments above 0 times their factors (N m, N); requirement: of those below
    0, and of the output torque, as a positive number; rows: one for each component."""

    opening: float
    margin: float
    drives: float
    requirement: float
    rows: list[BudgetRow]


class _WeightedTravel:
    """The travel of a run with the factors of a response; positions are fractions of the travel."""

    def __init__(self, response: Any, run: Any):
        self.response = response
        opening, *work = (run.columns[column] for column in response.columns)
        count = np.flatnonzero(np.diff(opening))[-1] + 2  # what follows fills files
        self.opening = opening[:count]
        self.positions = (self.opening - opening[0]) / (opening[count - 1] - opening[0])
        is_inertia = [name == INERTIA for name, _ in response.columns[1:]]
        self.moments = np.array(
            [-x[:count] if flip else x[:count] for x, flip in zip(work, is_inertia, strict=True)]
        ).T

    def weighted_sums(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Moments (m, k) at positions (m,), and the weighted sums (m,) of those that drive, and of
        those that are required, a positive number."""
        moments = interpolate(self.positions, self.moments, points)
        (output, factor), *factors = self.response.factors
        drives, resists = (np.array([f[k] for f in factors]) for k in (0, 1))
        requirement = np.maximum(-moments, 0.0) @ resists + output * factor
        return moments, np.maximum(moments, 0.0) @ drives, requirement

    def margin(self, points: np.ndarray) -> np.ndarray:
        """Return the margin (m,) at positions (m,); 0 where its size is below ROUNDING."""
        _, drives, requirement = self.weighted_sums(points)
        margin = drives / np.maximum(requirement, np.maximum(drives / (1.0 + MOST), TINY)) - 1.0
        return np.where(np.abs(margin) < ROUNDING, 0.0, margin)

    def least(self) -> tuple[float, float]:
        """Return the position of the least margin, the first of several, and the margin there."""
        steps = np.linspace(0.0, 1.0, FINER, endpoint=False)
        inner = self.positions[:-1, None] + np.diff(self.positions)[:, None] * steps
        points = np.unique(np.append(inner, 1.0))
        for _ in range(ZOOMS):
            margin = self.margin(points)
            i = int(np.argmax(margin <= margin.min() + 1e-12 * (1.0 + abs(margin.min()))))
            position, least = float(points[i]), float(margin[i])
            ends = points[max(i - 1, 0)], points[min(i + 1, len(points) - 1)]
            # From the position on either side, so that it stands once: next to itself, but for a
            # rounding, it would end the next distance.
            points = np.unique(np.linspace(position, ends, FINER + 1))
        return position, least


def values(response: Any, run: Any) -> np.ndarray:
    """Return the torque or force margin (t,) at t positions evenly spaced over its travel: the
    weighted sum of the moments that drive over that of those that resist, less 1, from -1 to 99.
    run: series (`Curves`) of a run, or what `sweep_travel` returns."""
    time = run.time
    return _WeightedTravel(response, run).margin((time - time[0]) / (time[-1] - time[0]))


def least(response: Any, run: Any) -> tuple[float, float]:
    """Return the least margin over its travel, and the opening (rad, m) there. response: made by
    `read_margin`; run: series (`Curves`) of a run, or what `sweep_travel` returns."""
    travel = _WeightedTravel(response, run)
    position, margin = travel.least()
    return margin, float(interpolate(travel.positions, travel.opening, np.array([position]))[0])


def make_torque_budget(response: Any, run: Any) -> Budget:
    """Return the torque budget, component by component, at the opening where a margin is least.
    response: made by `read_margin`; run: `Curves` of a run, or what `sweep_travel` returns."""
    travel = _WeightedTravel(response, run)
    position, margin = travel.least()
    points = np.array([position])
    (moments,), (drives,), (requirement,) = travel.weighted_sums(points)
    (output, factor), *factors = response.factors
    names = [read_label(label)[1] or "inertia" for _, label in response.columns[1:]]
    rows = []
    for name, moment, (drive, resist, class_) in zip(names, moments, factors, strict=True):
        weight = drive if moment > 0 else resist
        rows.append(BudgetRow(name, class_, weight, float(moment), float(weight * moment)))
    if output:
        rows.append(BudgetRow("output", "TL", factor, -output, -factor * output))
    opening = float(interpolate(travel.positions, travel.opening, points)[0])
    return Budget(opening, margin, float(drives), float(requirement), rows)


# -- values of keys -------------------------------------------------------------------------------


def _error(spec, key: str, value: object, allowed: str) -> SceneError:
    return SceneError(f"responses.{spec.name}.{key}", value, allowed)


def _names(spec, key: str) -> tuple[str, ...]:
    names = spec.data.get(key, ())
    if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
        raise _error(spec, key, names, "a list of names")
    return tuple(names)


def _mapping(spec, key: str) -> dict:
    data = spec.data.get(key, {})
    if not isinstance(data, dict):
        raise _error(spec, key, data, f"a mapping, of classes ({', '.join(CLASSES)})")
    return data


def _numbers(spec, key: str) -> dict[str, float]:
    """Factors by class."""
    data = _mapping(spec, key)
    return {
        spec.one_of(CLASSES, key, name): _number(spec, f"{key}.{name}", x)
        for name, x in data.items()
    }


def _number(spec, key: str, value: object) -> float:
    return NumberLimits(least=0).check(f"responses.{spec.name}.{key}", value)


def _opening(spec, key: str, hinge, unit: str) -> float | None:
    """Read an opening (rad, m): a number, or one with its unit; None for that at the start."""
    value = spec.data.get(key, STOW)
    if value == STOW:
        return None
    number, _, unit_name = str(value).strip().partition(" ")
    pair = ("m", "mm") if unit == "m" else ("rad", "deg")
    try:
        opening = float(number) * (UNITS[unit_name] if unit_name in pair else 1.0 / (not unit_name))
    except (ValueError, ZeroDivisionError):
        opening = np.nan
    if unit == "rad" and not unit_name and abs(opening) > LARGEST:
        raise _error(spec, key, value, f"up to {LARGEST:g} rad, or with its unit, as {number} deg")
    if isinstance(value, bool) or not np.isfinite(opening):
        allowed = (
            f"`stow`, the opening at the start, or a number ({unit}), with or without its unit"
        )
        raise _error(spec, key, value, f"{allowed} ({', '.join(pair)})")
    return opening
