"""Torque and force margins over a travel: their definitions, and their values.

Runs record the virtual work of every part (`fpm.travel`), at the instants as if the travel took the
run's time, evenly; factors are applied when it is read, so that another standard takes no run.
"""

from typing import Any, NamedTuple

import numpy as np

from fpm.errors import SceneError
from fpm.reading.standards import CLASSES, STANDARDS
from fpm.travel import Travel, lead, parts_of

WORK, INERTIA = "travel_work", "travel_inertia"
"""Variables of what is recorded (fpm.reading.variables)."""

MOST = 99.0
"""Largest margin that is told: where next to nothing resists, it has no end."""

TINY = 1e-300
"""N m, so that where nothing acts nothing is divided by zero: the margin is -1 there."""

OPTIONAL = ("from", "evidence", "with", "stand", "without", "classes", "factors", "drives",
            "accelerate", "deliver")  # fmt: skip
UNITS = {"rad": 1.0, "deg": np.pi / 180, "m": 1.0, "mm": 1e-3}


class Along(NamedTuple):
    """What a response lies over instead of time: words, unit, and its first and last value."""

    words: str
    unit: str
    first: float
    last: float


class Led(NamedTuple):
    """What is led: openings by name, from one value to another, and those that stand."""

    openings: tuple[str, ...]
    first: float
    last: float
    stand: tuple[str, ...] = ()

    def label(self, part: str = "") -> str:
        """A column's label; `part`: of the work."""
        rest = "".join(f" beside {name}" for name in self.stand) + (part and f" by {part}")
        way = f" led from {self.first!r} to {self.last!r}"
        return self.openings[0] + way + "".join(f" with {n}" for n in self.openings[1:]) + rest


def read_label(label: str) -> tuple[Led, str]:
    """What is led, and the part, of a label."""
    rest, _, part = label.partition(" by ")
    rest, *stand = rest.split(" beside ")
    rest, *more = rest.split(" with ")
    name, _, way = rest.partition(" led from ")
    first, _, last = way.partition(" to ")
    return Led((name, *more), float(first), float(last), tuple(stand)), part


def travel_of(scene, led: Led) -> Travel:
    """The travel of a scene; SceneError of `fpm.travel.lead`."""
    return lead(scene, led.openings, led.first, led.last, led.stand)


def over_time(values: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Values at positions of a travel as values (t,) at instants, at which it is evenly led."""
    from scipy.interpolate import Akima1DInterpolator

    share = (time - time[0]) / (time[-1] - time[0])
    return Akima1DInterpolator(np.linspace(0.0, 1.0, len(values)), values)(share)


def read(it: Any) -> Any:
    """The response that a definition (`fpm.reading.responses.Definition`) of a margin means."""
    openings = (it.data[it.kind], *_names(it, "with"))
    hinges = {hinge.name: hinge for hinge in it.scene.hinges}
    for name in openings:
        it.one_of(hinges, value=name)
    stand = tuple(it.one_of(hinges, "stand", name) for name in _names(it, "stand"))
    hinge = hinges[openings[0]]
    unit = "m" if hinge.slides else "rad"
    first, last = (_opening(it, key, hinge, unit) for key in ("from", "to"))
    if first == last:
        raise _refused(it, "to", it.data["to"], "another opening than `from`")
    led = Led(openings, first, last, stand)
    standard = STANDARDS[it.one_of(STANDARDS, "standard")]
    evidence = it.data.get("evidence", next(iter(standard.resists)))
    resists = standard.resists[it.one_of(standard.resists, "evidence", evidence)]
    resists = resists | _numbers(it, "factors")
    drives = standard.drives | _numbers(it, "drives")
    parts = parts_of(it.scene)
    left = [it.one_of(parts, "without", name) for name in _names(it, "without")]
    classes = parts | {
        it.one_of(parts, "classes", part): it.one_of(CLASSES, f"classes.{part}", name)
        for part, name in _mapping(it, "classes").items()
    }
    parts = [part for part in parts if part not in left]
    columns = [(WORK, led.label(part)) for part in parts]
    factors = [(drives[classes[part]], resists[classes[part]]) for part in parts]
    rate = _number(it, "accelerate", it.data.get("accelerate", 0.0))
    if rate:
        columns.append((INERTIA, led.label()))
        factors.append((0.0, resists["TD"] * rate))
    load = resists["TL"] * _number(it, "deliver", it.data.get("deliver", 0.0))
    text = f"margin of {openings[0]}, {standard.title}, {evidence}"
    along = Along(f"opening of {openings[0]}", unit, first, last)
    about = (*openings, it.data["standard"], evidence, *left)
    return it.response(about, "", "1", text, tuple(columns), along, (load, *factors))


def values(response: Any, run: Any) -> np.ndarray:
    """The margin (t,)."""
    load, *factors = response.factors
    work = np.array([run.columns[column] for column in response.columns])
    drives, resists = np.array(factors).T[:, :, None]
    turned = np.array([[name == INERTIA] for name, _ in response.columns])
    resisting = load + np.sum(resists * np.where(turned, work, np.maximum(-work, 0.0)), axis=0)
    driving = np.sum(drives * np.where(turned, 0.0, np.maximum(work, 0.0)), axis=0)
    return driving / np.maximum(resisting, np.maximum(driving / (1.0 + MOST), TINY)) - 1.0


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


def _opening(it, key: str, hinge, unit: str) -> float:
    """An opening (rad, m): a number, one with its unit, or that at the start."""
    value = it.data.get(key, "stow")
    if value == "stow":
        return float(hinge.opening)
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
