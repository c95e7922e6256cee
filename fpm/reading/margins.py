"""Torque and force margins over a travel: their definitions, and their values.

Runs record the virtual work of every part (`fpm.travel`) at positions of their own; factors are
applied when it is read, so that another standard takes no run. The curve of a margin lies evenly
over the way, the least is sought between all positions.
"""

from collections.abc import Iterable, Mapping
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from fpm.errors import SceneError
from fpm.reading.standards import CLASSES, STANDARDS
from fpm.travel import Travel, lead, parts_of, reeled
from fpm.travel.positions import between

WORK, INERTIA, OPENING = "travel_work", "travel_inertia", "travel_opening"
"""Variables of what is recorded (fpm.reading.variables)."""

MOST = 99.0
"""Largest margin that is told: where next to nothing resists, it has no end."""

TINY = 1e-300
"""N m, so that where nothing acts nothing is divided by zero: the margin is -1 there."""

ROUNDING = 1e-12
"""Margins below it are rounding: what acts is known to 1e-6 of itself."""

FINER, ZOOMS = 8, 7
"""Into how many each distance of positions is divided where the least is sought, and how often the
distance about it is, again."""

DRIVES = 1e-6
"""Share of the largest virtual work of all parts up to which that of a part drives nothing."""

STOW = "stow"
"""The opening at the start of a run, whichever that is."""

OPTIONAL = ("from", "evidence", "with", "locked", "without", "classes", "uncertainty_factors",
            "actuation_factors", "accelerate", "deliver")  # fmt: skip
UNITS = {"rad": 1.0, "deg": np.pi / 180, "m": 1.0, "mm": 1e-3}


class Along(NamedTuple):
    """What a response lies over instead of time: words, unit, and its first and last value."""

    words: str
    unit: str
    first: float
    last: float


class Led(NamedTuple):
    """What is led: openings by name, from one value to another (None: each run's own at its start),
    and those that stand."""

    openings: tuple[str, ...]
    first: float | None
    last: float | None
    stand: tuple[str, ...] = ()

    def label(self, part: str = "") -> str:
        """A column's label; `part`: of the work."""
        rest = "".join(f" beside {name}" for name in self.stand) + (part and f" by {part}")
        first, last = (STOW if end is None else repr(end) for end in (self.first, self.last))
        way = f" led from {first} to {last}"
        return self.openings[0] + way + "".join(f" with {n}" for n in self.openings[1:]) + rest


def read_label(label: str) -> tuple[Led, str]:
    """What is led, and the part, of a label."""
    rest, _, part = label.partition(" by ")
    rest, *stand = rest.split(" beside ")
    rest, *more = rest.split(" with ")
    name, _, way = rest.partition(" led from ")
    ends = (None if end == STOW else float(end) for end in way.split(" to "))
    return Led((name, *more), *ends, tuple(stand)), part


def travel_of(scene, led: Led, positions: int | None = None) -> Travel:
    """The travel of a scene; SceneError of `fpm.travel.lead`."""
    (start,) = (hinge.opening for hinge in scene.hinges if hinge.name == led.openings[0])
    first, last = (float(start) if end is None else end for end in (led.first, led.last))
    if first == last:
        what = f"opening {led.openings[0]}"
        raise SceneError(what, f"{first:.6g} at the start", "another one than that it is led to")
    return lead(scene, led.openings, first, last, led.stand, positions)


def column_of(travel: Travel, variable: str, part: str) -> np.ndarray:
    """What is recorded of a travel (p,)."""
    return {WORK: travel.work.get(part), INERTIA: travel.inertia, OPENING: travel.opening}[variable]


def driving(works: Mapping[str, np.ndarray]) -> list[str]:
    """The parts that drive somewhere on the way, by more than a rounding; works: their virtual work
    (p,)."""
    largest = max((float(np.abs(work).max()) for work in works.values()), default=0.0)
    return [part for part, work in works.items() if work.max() > DRIVES * largest]


def led_curves(scene, responses: Iterable[Any]) -> Any:
    """What a run of a scene has for margins, without the run."""
    columns, travels = {}, {}
    for variable, label in dict.fromkeys(c for response in responses for c in response.columns):
        led, part = read_label(label)
        if led not in travels:
            travels[led] = travel_of(scene, led)
        columns[variable, label] = column_of(travels[led], variable, part)
    return SimpleNamespace(time=np.linspace(0.0, 1.0, 201), columns=columns)


def read(it: Any) -> Any:
    """The response that a definition (`fpm.reading.responses.Definition`) of a margin means."""
    openings = (it.data[it.kind], *_names(it, "with"))
    hinges = {hinge.name: hinge for hinge in it.scene.hinges}
    for name in openings:
        it.one_of(hinges, value=name)
    if len(set(openings)) < len(openings):
        raise _refused(it, "with", [*openings], "each opening once")
    stand = tuple(it.one_of(hinges, "locked", name) for name in _names(it, "locked"))
    for name in stand:
        if name in openings:
            raise _refused(it, "locked", name, "openings that are not led")
    hinge = hinges[openings[0]]
    unit = "m" if hinge.slides else "rad"
    ends = [_opening(it, key, hinge, unit) for key in ("from", "to")]
    first, last = (float(hinge.opening) if end is None else end for end in ends)
    if first == last:
        raise _refused(it, "to", it.data["to"], "another opening than `from`")
    led = Led(openings, *ends, stand)
    standard = STANDARDS[it.one_of(STANDARDS, "standard")]
    evidence = it.data.get("evidence", next(iter(standard.resists)))
    resists = standard.resists[it.one_of(standard.resists, "evidence", evidence)]
    resists = resists | _numbers(it, "uncertainty_factors")
    drives = standard.drives | _numbers(it, "actuation_factors")
    parts = parts_of(it.scene)
    left = [it.one_of(parts, "without", name) for name in _names(it, "without")]
    classes = parts | {
        it.one_of(parts, "classes", part): it.one_of(CLASSES, f"classes.{part}", name)
        for part, name in _mapping(it, "classes").items()
    }
    parts = [part for part in parts if part not in left]
    for part in reeled(it.scene):
        if part in parts:
            allowed = f"{part} among them: a curve of time reels it, and a travel has no time"
            raise _refused(it, "without", left, allowed)
    columns = [(OPENING, led.label()), *((WORK, led.label(part)) for part in parts)]
    factors = [(drives[classes[part]], resists[classes[part]], classes[part]) for part in parts]
    rate = _number(it, "accelerate", it.data.get("accelerate", 0.0))
    if rate:
        columns.append((INERTIA, led.label()))
        factors.append((0.0, resists["TD"] * rate, "TD"))
    deliver = _number(it, "deliver", it.data.get("deliver", 0.0))
    if not (factors or deliver):
        allowed = "an opening on whose way something acts that a margin counts; here nothing does"
        raise _refused(it, it.kind, openings[0], allowed)
    text = f"margin of {openings[0]}, {standard.title}, {evidence}"
    own = ", from each run's start" if ends[0] is None else ""
    along = Along(f"opening of {openings[0]}{own}", unit, first, last)
    about = (*openings, it.data["standard"], evidence, *left)
    load = (deliver, resists["TL"])
    return it.response(about, "", "1", text, tuple(columns), along, (load, *factors))


class Share(NamedTuple):
    """What a part has of a torque budget: its class; moment (N m, on slides N): its virtual work,
    below 0 where it resists; factor, and moment times factor."""

    part: str
    class_: str
    factor: float
    moment: float
    weighted: float


class Budget(NamedTuple):
    """The torque budget at an opening: margin = drives / required - 1, the sums of the weighted
    moments of the rows above 0, and of those below 0 as a positive number."""

    opening: float
    margin: float
    drives: float
    required: float
    rows: list[Share]


class _Way:
    """A travel as a run recorded it, as a response weighs it; places are shares of the way."""

    def __init__(self, response: Any, run: Any):
        self.response = response
        opening, *work = (run.columns[column] for column in response.columns)
        count = np.flatnonzero(np.diff(opening))[-1] + 2  # what follows fills files
        self.opening = opening[:count]
        self.places = (self.opening - opening[0]) / (opening[count - 1] - opening[0])
        turned = [name == INERTIA for name, _ in response.columns[1:]]
        self.moments = np.array(
            [-x[:count] if by else x[:count] for x, by in zip(work, turned, strict=True)]
        ).T

    def weighed(self, at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Moments (m, k) at places (m,), and what drives and what is required (m,), by factors."""
        moments = between(self.places, self.moments, at)
        (deliver, factor), *factors = self.response.factors
        drives, resists = (np.array([f[k] for f in factors]) for k in (0, 1))
        required = np.maximum(-moments, 0.0) @ resists + deliver * factor
        return moments, np.maximum(moments, 0.0) @ drives, required

    def margin(self, at: np.ndarray) -> np.ndarray:
        """The margin (m,) at places; 0 where what is left of it is rounding."""
        _, drives, required = self.weighed(at)
        margin = drives / np.maximum(required, np.maximum(drives / (1.0 + MOST), TINY)) - 1.0
        return np.where(np.abs(margin) < ROUNDING, 0.0, margin)

    def least(self) -> tuple[float, float]:
        """The place of the least margin, the first of several, and the margin there."""
        steps = np.linspace(0.0, 1.0, FINER, endpoint=False)
        at = np.unique(
            np.append(self.places[:-1, None] + np.diff(self.places)[:, None] * steps, 1.0)
        )
        for _ in range(ZOOMS):
            margin = self.margin(at)
            i = int(np.argmax(margin <= margin.min() + 1e-12 * (1.0 + abs(margin.min()))))
            place, least = float(at[i]), float(margin[i])
            ends = at[max(i - 1, 0)], at[min(i + 1, len(at) - 1)]
            # From the place on either side, so that it stands once: next to itself, but for a
            # rounding, it would end the next distance.
            at = np.unique(np.linspace(place, ends, FINER + 1))
        return place, least


def values(response: Any, run: Any) -> np.ndarray:
    """The margin (t,), evenly over the way of the run."""
    time = run.time
    return _Way(response, run).margin((time - time[0]) / (time[-1] - time[0]))


def least(response: Any, run: Any) -> tuple[float, float]:
    """The least margin on the way of a run, and the opening there."""
    way = _Way(response, run)
    place, margin = way.least()
    return margin, float(between(way.places, way.opening, np.array([place]))[0])


def torque_budget(response: Any, run: Any) -> Budget:
    """What drives and resists where the margin of a run is least, part by part."""
    way = _Way(response, run)
    place, margin = way.least()
    at = np.array([place])
    (moments,), (drives,), (required,) = way.weighed(at)
    (deliver, factor), *factors = response.factors
    names = [read_label(label)[1] or "inertia" for _, label in response.columns[1:]]
    rows = []
    for name, moment, (drive, resist, of) in zip(names, moments, factors, strict=True):
        by = drive if moment > 0 else resist
        rows.append(Share(name, of, by, float(moment), float(by * moment)))
    if deliver:
        rows.append(Share("delivered", "TL", factor, -deliver, -factor * deliver))
    opening = float(between(way.places, way.opening, at)[0])
    return Budget(opening, margin, float(drives), float(required), rows)


# -- values of keys -------------------------------------------------------------------------------


def _refused(it, key: str, value: object, allowed: str) -> SceneError:
    return SceneError(f"responses.{it.name}.{key}", value, allowed)


def _names(it, key: str) -> tuple[str, ...]:
    found = it.data.get(key, ())
    if not isinstance(found, list | tuple) or not all(isinstance(name, str) for name in found):
        raise _refused(it, key, found, "a list of names")
    return tuple(found)


def _mapping(it, key: str) -> dict:
    found = it.data.get(key, {})
    if not isinstance(found, dict):
        raise _refused(it, key, found, f"a mapping, of classes ({', '.join(CLASSES)})")
    return found


def _numbers(it, key: str) -> dict[str, float]:
    """Factors by class."""
    found = _mapping(it, key)
    return {
        it.one_of(CLASSES, key, name): _number(it, f"{key}.{name}", x) for name, x in found.items()
    }


def _number(it, key: str, value: object) -> float:
    real = isinstance(value, int | float) and not isinstance(value, bool)
    if not real or not np.isfinite(value) or value < 0:
        raise _refused(it, key, value, "a number of at least 0")
    return float(value)


def _opening(it, key: str, hinge, unit: str) -> float | None:
    """An opening (rad, m): a number, or one with its unit; None for that at the start."""
    value = it.data.get(key, STOW)
    if value == STOW:
        return None
    number, _, given = str(value).strip().partition(" ")
    own = ("m", "mm") if unit == "m" else ("rad", "deg")
    try:
        found = float(number) * (UNITS[given] if given in own else 1.0 / (not given))
    except (ValueError, ZeroDivisionError):
        found = np.nan
    if isinstance(value, bool) or not np.isfinite(found):
        allowed = (
            f"`stow`, the opening at the start, or a number ({unit}), with or without its unit"
        )
        raise _refused(it, key, value, f"{allowed} ({', '.join(own)})")
    return found
