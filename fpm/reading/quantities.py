"""Quantities: numbers that are read off a run, such as its peaks and the times of its events.

A run in which what is asked for does not happen has no number: NaN.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Union

import numpy as np

from fpm.reading.events import value_at
from fpm.reading.responses import Response

if TYPE_CHECKING:
    from fpm.files.trajectory import Curves


@dataclass(frozen=True)
class Quantity:
    """A named number of a run: its `kind`, and what the other keys of its definition say.

    unit (UDUNITS) and long_name are those of the number that `evaluate` returns. `places` are the
    names of the elements whose `event` counts.
    """

    name: str
    kind: str
    unit: str
    long_name: str
    response: Response | None = None
    at: Union["Quantity", float, None] = None
    about: float | None = None
    within: float = 0.0
    level: float = 0.0
    way: str = "either"
    number: int = 1
    event: str = ""
    places: tuple[str, ...] = ()

    @property
    def is_peak(self) -> bool:
        """Whether it is as large as a response is for an instant."""
        return self.kind in ("largest", "smallest", "overshoot", "rms")

    @property
    def is_time(self) -> bool:
        """Whether it is a time of the run (s)."""
        return self.kind in ("crossing", "settling", "event")

    @property
    def least(self) -> float | None:
        """The least value that it can have; None where there is none."""
        if self.is_time or self.kind in ("overshoot", "rms"):
            return 0.0
        return self.response.least

    @property
    def decider(self) -> "Quantity | None":
        """The quantity whose `margin` tells whether there is this one; None where nothing does but
        that there is."""
        if isinstance(self.at, Quantity):
            return self.at.decider
        settles = self.kind == "settling" and self.about is not None
        return self if self.kind == "crossing" or settles else None

    def margin(self, values: np.ndarray) -> np.ndarray:
        """By how much (...) a decider happens, in the unit of its response, whose values (..., t)
        are given: not above 0 where it does not, and continuous."""
        if self.kind == "settling":
            return self.within - np.abs(values[..., -1] - self.about)
        return crossing_margin(values - self.level, self.way, self.number)

    def evaluate(self, curves: "Curves") -> float:
        """The number of one run; NaN where what is asked for does not happen in it.

        ValueError where the run had more events than were kept, and it may be among the others.
        """
        found = self._evaluate(curves)
        # Parabolas and cubics between instants go below what can be.
        return found if self.least is None else float(np.maximum(found, self.least))

    def _evaluate(self, curves: "Curves") -> float:
        if self.kind == "event":
            return self._event(curves)
        time, values = curves.time, self.response.evaluate(curves)
        if self.kind == "crossing":
            return crossing(time, values, self.level, self.way, self.number)
        if self.kind == "settling":
            return settling(time, values, self.within, self.about)
        if self.kind == "value":
            return self._value(curves)
        if self.kind == "overshoot":
            about = values[-1] if self.about is None else self.about
            way = np.sign(about - values[0])
            return peak(way * (values - about)) if way else 0.0
        if self.kind in ("largest", "smallest"):
            sign = 1.0 if self.kind == "largest" else -1.0
            return sign * peak(sign * values)
        if self.kind == "final":
            return float(values[-1])
        span = time[-1] - time[0]
        if self.kind == "mean":
            return float(np.trapezoid(values, time) / span)
        if self.kind == "rms":
            return float(np.sqrt(np.trapezoid(values**2, time) / span))
        raise ValueError(f"{self.name}: nothing is read off a run for the kind {self.kind}")

    def _event(self, curves: "Curves") -> float:
        found = [curves.happened.get((place, self.event), ()) for place in self.places]
        times = np.sort(np.concatenate([np.zeros(0), *found]))
        if len(times) >= self.number:
            return float(times[self.number - 1])
        if curves.events_dropped:
            raise ValueError(
                f"{self.name}: a run has {curves.events_dropped} events more than are kept; "
                f"{self.long_name} may be among them"
            )
        return float("nan")

    def _value(self, curves: "Curves") -> float:
        at = self.at.evaluate(curves) if isinstance(self.at, Quantity) else self.at
        if not np.isfinite(at) or not curves.time[0] <= at <= curves.time[-1]:
            return float("nan")
        event = isinstance(self.at, Quantity) and self.at.kind == "event"
        return float(value_at(curves, self.response, at, event))


def peak(values: np.ndarray) -> float:
    """The largest of values (t,) at equal distances, by the parabola through it and its neighbours.

    It is above the largest value by an eighth of the step to a neighbour at most.
    """
    i = int(values.argmax())
    top = float(values[i])
    if 0 < i < len(values) - 1:
        before, after = top - values[i - 1], top - values[i + 1]
        if before + after > 0:
            top += float((before - after) ** 2 / (8 * (before + after)))
    return top


def crossing(
    time: np.ndarray, values: np.ndarray, level: float, way: str = "either", number: int = 1
) -> float:
    """Time (s) at which values (t,) cross a level for the nth time; NaN if they do not.

    By the cubic through the four instants around it. A value on the level counts as below it.
    """
    above = values > level
    places = np.flatnonzero(above[1:] != above[:-1])
    if way != "either":
        places = places[above[places + 1] == (way == "rising")]
    if len(places) < number:
        return float("nan")
    return _root(time, values - level, int(places[number - 1]))


def crossing_margin(values: np.ndarray, way: str = "either", number: int = 1) -> np.ndarray:
    """How far from zero (...) values (..., t) get, at least, on each of the sides that they have to
    be on in turn to cross it for the nth time.

    Before a rising crossing they are below, then above, before the next one below again.
    """

    def turns(side: float, count: int) -> np.ndarray:
        reached = np.inf
        for _ in range(count):
            reached = np.maximum.accumulate(np.minimum(reached, side * values), axis=-1)
            side = -side
        return reached[..., -1]

    if way == "either":
        return np.maximum(turns(-1.0, number + 1), turns(1.0, number + 1))
    return turns(-1.0 if way == "rising" else 1.0, 2 * number)


def settling(
    time: np.ndarray, values: np.ndarray, within: float, about: float | None = None
) -> float:
    """Time (s) from which on values (t,) stay within a distance of `about`, or of the last value.

    NaN if they are outside at the end; the first instant if they never are.
    """
    off = values - (values[-1] if about is None else about)
    outside = np.flatnonzero(np.abs(off) > within)
    if not len(outside):
        return float(time[0])
    last = int(outside[-1])
    if last == len(time) - 1:
        return float("nan")
    return _root(time, np.sign(off[last]) * off - within, last)


def _polynomial(time: np.ndarray, values: np.ndarray, last: int) -> np.polynomial.Polynomial:
    """The cubic through the four instants up to `last`, or the nearest four that there are."""
    stop = min(max(last + 1, 4), len(time))
    near = slice(max(stop - 4, 0), stop)
    return np.polynomial.Polynomial.fit(time[near], values[near], len(time[near]) - 1)


def _root(time: np.ndarray, values: np.ndarray, i: int) -> float:
    """Where values (t,) vanish between the instants i and i + 1, at which they differ in sign."""
    cubic = _polynomial(time, values, i + 2)
    low, high = float(time[i]), float(time[i + 1])
    rising = bool(values[i + 1] > 0)
    for _ in range(60):
        middle = 0.5 * (low + high)
        if (cubic(middle) > 0) == rising:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)
