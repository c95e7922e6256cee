"""Quantities: numbers that are read off a run, such as its peaks and the times of its events.

A run in which what is asked for does not happen has no number: NaN. Margins of events:
docs/quantities.md."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from fpm.elements.kind import Eventful
from fpm.files.trajectory import IMPACTS, PEAK, Column, Curves
from fpm.reading import margins
from fpm.reading.events import SPREAD, cubic_through, extreme_value, find_root, peak, value_at

CATCH_RATES = ("latch_rate", "slide_latch_rate")
MARGIN_READS = ("opening", "slide_opening", *CATCH_RATES)
"""Variables that the margins of impacts are read off."""

_START_SHARE = 1e-3  # share of the way within which it is at its gate from the start
_TINY = 1e-12  # rad²/s², m²/s²: the size of a margin, at least
BETWEEN_KINDS = {
    *("largest", "smallest", "smallest_at"),
    *("mean", "rms", "settling", "crossing", "value"),
}
"""Kinds of quantities that are read between instants, too."""

_ABSENT = -1e30  # a number that a run does not have, as files hold finite ones

_LAST, _ROWS = 0.1, 4  # share of the way, and least instants, over which deceleration is found


def impact_margins(curves: Curves) -> list[float]:
    """Return the margins (rad²/s²; m²/s²) of the first impact of each element that can have any, in
    the order of `Curves.impacts`; NaN where not known. curves: the run's."""
    pairs = [(next((n for n in e.events if n in IMPACTS), ""), e) for e in curves.eventful]
    return [gate_margin(curves, event, e) for event, e in pairs if event]


def gate_margin(curves: Curves, event: str, element: Eventful) -> float:
    """Return the margin (rad²/s²; m²/s²) of an element's first `event` ("latches", "hits",
    "closes") in one run, above 0 if it occurs; NaN without a gate, if it is beyond that at the
    start, or if it may catch late within its reach, once it has become slow enough."""
    gate = element.gate
    if gate is None:
        return np.nan
    opening = curves.openings[element.joint]
    side = gate.side or np.sign(gate.opening - opening[0])
    gap = side * (opening - gate.opening) + gate.reach
    if gap[0] > -_START_SHARE * np.abs(gap).max() or not side or not gate.is_sharp:
        return np.nan
    times = curves.times(event, [element.name])[:1]
    passes = times if len(times) else curves.times("misses", [element.name])
    if not len(passes):
        return min(_lack(curves.time, gap), -_TINY)
    label, columns = element.name.removeprefix("latch "), curves.columns
    keys = [key for name in CATCH_RATES if (key := (name, label)) in columns] if len(times) else ()
    rates = [columns[key][-1] for key in keys]
    rates = rates or [_arrival_rate(curves, gap, time) for time in passes]
    energies = 0.5 * np.square(rates)
    limit = 0.5 * gate.largest_rate**2 or np.inf
    margin = float(np.max(energies * (1.0 - energies / limit)))
    return max(margin, _TINY) if len(times) else min(margin, -_TINY)


def _arrival_rate(curves: Curves, gap: np.ndarray, instant: float) -> float:
    """Rate at which a gap, below 0 before, vanishes at an instant (s), by the instants before."""
    event_times = curves.events[curves.events[:, 0] < instant - SPREAD * curves.step, 0]
    start = event_times.max(initial=-np.inf) + SPREAD * curves.step
    last = instant - max(curves.step, 0.5 * (curves.time[1] - curves.time[0]))
    rows = np.flatnonzero((curves.time >= start) & (curves.time <= last))[-3:]
    if not len(rows):
        rows = np.searchsorted(curves.time, [instant], side="left") - 1
    # The mean rates from these instants on, continued to none (Neville's scheme): the rate there of
    # the cubic through the gaps and zero.
    spans = curves.time[rows] - instant
    rates = gap[rows] / spans
    for n in range(1, len(rows)):
        rates = (spans[n:] * rates[:-1] - spans[:-n] * rates[1:]) / (spans[n:] - spans[:-n])
    return max(float(rates[0]), 0.0)


def _lack(time: np.ndarray, gap: np.ndarray) -> float:
    """What a gap (t,) below 0 lacked to vanish: what was still to go, times the deceleration there,
    continued from the last tenth of the way to where it turned back or stuck."""
    i = int(gap.argmax())
    first = int(gap[: i + 1].argmin())
    nearest = min(peak(gap), 0.0)
    stretch = max(_LAST * (nearest - gap[first]), nearest - gap[max(i - _ROWS, first)])
    if i == first:  # it never approaches
        k = min(_ROWS, len(time) - 1)
        return nearest * 2.0 * float(gap[0] - gap[k]) / (time[k] - time[0]) ** 2
    energies = []
    for distance in (stretch, 2.0 * stretch):
        excess = gap - max(nearest - distance, gap[first])
        row = first + int(np.flatnonzero(excess[first:i] <= 0.0)[-1])
        instant = find_root(time, excess, row) if excess[row + 1] > 0 else time[row]
        energies.append(0.5 * float(cubic_through(time, gap, row + 2).deriv()(instant)) ** 2)
    # By the energies (a s + b s²) at these distances, continued to what is still to go, within
    # bounds for those with shocks about them.
    a = max(4.0 * energies[0] - energies[1], energies[0]) / (2.0 * stretch)
    b = (energies[1] - 2.0 * energies[0]) / (2.0 * stretch**2)
    return nearest * a * min(max(1.0 + b * nearest / a, 0.5), 4.0)


@dataclass(frozen=True)
class Quantity:
    """Definition of a named number of a run, such as a peak or the time of an event.

    kind: how it is read, a key of KINDS, as "largest"; unit (UDUNITS) and long_name: of the number;
    response: the function of time that it is read off, None for events; instant: of a value, its
    time (s) or the quantity that gives it; of an event margin, the quantity that has it; target:
    target of settling, None: the last value; tolerance: largest deviation from it
    after settling; level, direction ("rising", "falling", "either"): of a crossing; number: n, from
    1, of the nth crossing or event; event: its name; places: elements whose events count, (): none.
    target, tolerance, level: in its unit."""

    name: str
    kind: str
    unit: str
    long_name: str
    response: Any = None
    instant: Any = None
    target: float | None = None
    tolerance: float = 0.0
    level: float = 0.0
    direction: str = "either"
    number: int = 1
    event: str = ""
    places: tuple[str, ...] = ()

    @property
    def is_instantaneous(self) -> bool:
        """Whether the quantity is a size of the response at an instant (largest, smallest, rms), so
        that a shock that mesh and step do not resolve can decide it."""
        return KINDS[self.kind].is_instantaneous

    @property
    def peak_column(self) -> Column | None:
        """Column of runs that have the number already, read between instants, too; None of others
        than BETWEEN_KINDS, and of values at another quantity."""
        response = self.response
        if self.kind not in BETWEEN_KINDS or response.along or isinstance(self.instant, Quantity):
            return None
        details = {"about": self.target, "within": self.tolerance or None, "at": self.instant}
        if self.kind == "crossing":
            details = {"of": self.level, "way": self.direction, "number": self.number}
        texts = (f"{key} {value}" for key, value in details.items() if value is not None)
        parts = response.kind, *response.subjects, response.component, *texts
        return PEAK, " ".join((self.kind, *filter(None, parts)))

    @property
    def _margin_column(self) -> Column | None:
        column = self.peak_column if self.has_margin else None
        return column and (PEAK, f"margin of {column[1]}")

    def readings(self, curves: Curves) -> dict[str, float]:
        """Return the numbers of one run of a `peak_column` by label: value, and event margin."""
        columns = (self.peak_column, self.evaluate), (self._margin_column, self.margin)
        rows = {column[1]: read(curves) for column, read in columns if column}
        return {label: _ABSENT if np.isnan(x) else x for label, x in rows.items()}

    @property
    def is_time(self) -> bool:
        """Return whether the quantity is the time (s) of a crossing, event or settling. Such a time
        lies within the run and can be another quantity's `instant`; that of a smallest value
        cannot."""
        return KINDS[self.kind].unit == "s"

    @property
    def least(self) -> float | None:
        """Physical lower bound of the quantity, in its unit; None where there is none."""
        if self.kind == "smallest_at":  # a time, or a place along the response
            return None if self.response.along else 0.0
        is_positive = self.is_time or KINDS[self.kind].positive
        return 0.0 if is_positive else (self.response and self.response.least)

    @property
    def limits(self) -> tuple[float, float]:
        """Physical bounds of the quantity, in its unit, infinite where there is none."""
        return -np.inf if self.least is None else self.least, np.inf

    @property
    def always_exists(self) -> bool:
        """Whether every run has the quantity, as a peak, unlike an event or a crossing."""
        if isinstance(self.instant, Quantity) and self.kind == "value":
            return self.instant.always_exists
        return not self.has_margin and self.kind != "event"

    @property
    def leaves(self) -> tuple["Quantity", ...]:
        """Quantities, read off curves and events, of which this one is made: itself."""
        return (self,)

    @property
    def has_margin(self) -> bool:
        """Whether an event margin tells by how much this quantity exists: of a crossing, of
        settling to a target, of the first time at which something latches, hits or closes."""
        if self.kind == "event":
            return self.event in IMPACTS and self.number == 1
        return self.kind == "crossing" or (self.kind == "settling" and self.target is not None)

    def margin(self, curves: Curves) -> float:
        """Return by how much the quantity exists in one run, above 0 if it does, continuously, in
        the unit of the response or of `gate_margin`; a value uses that of its time. NaN if it is
        not known, or the quantity always exists."""
        if isinstance(self.instant, Quantity) and self.kind == "value":
            return self.instant.margin(curves)
        if not self.has_margin:
            return float("nan")
        if self.kind == "event":
            elements = [e for e in curves.eventful if e.name in self.places]
            return float(np.max([gate_margin(curves, self.event, e) for e in elements]))
        if (column := self._margin_column) and column in curves.columns:
            return float(curves.columns[column][0])
        values = self.response.evaluate(curves)
        if self.kind == "settling":
            return float(self.tolerance - np.abs(values[-1] - self.target))
        return float(crossing_margin(values - self.level, self.direction, self.number))

    def read_margin(self, margin: Callable[["Quantity"], float]) -> float:
        """Return the event margin (NaN: not known), by a function of `leaves`."""
        return margin(self)

    def read(self, number: Callable[["Quantity"], float]) -> float:
        """Return the value (NaN: none), by a function of `leaves`."""
        return number(self)

    def evaluate(self, curves: Curves) -> float:
        """Return the quantity's value in one run; NaN if it does not exist there. ValueError if it
        had more events than are kept, and the event may be one of the others."""
        column = self.peak_column
        if column is not None and column in curves.columns:
            value = float(curves.columns[column][0])
            value = np.nan if value < _ABSENT / 2 else value
        else:
            value = KINDS[self.kind].read(self, curves)
        # Parabolas and cubics between instants go below what can be.
        return value if self.least is None else float(np.maximum(value, self.least))


def crossing(
    time: np.ndarray, values: np.ndarray, level: float, direction: str = "either", number: int = 1
) -> float:
    """Return the time (s) at which values (t,) cross a level for the nth time (`number`), by the
    cubic through the four instants around; NaN: they do not. Values on the level are below it."""
    is_above = values > level
    places = np.flatnonzero(is_above[1:] != is_above[:-1])
    if direction != "either":
        places = places[is_above[places + 1] == (direction == "rising")]
    if len(places) < number:
        return float("nan")
    return find_root(time, values - level, int(places[number - 1]))


def crossing_margin(values: np.ndarray, direction: str = "either", number: int = 1) -> np.ndarray:
    """Return by how much values (..., t) cross zero for the nth time (`number`): the least of the
    largest distances from zero on both sides in turn, which one crossing after another needs."""

    def turns(side: float, count: int) -> np.ndarray:
        margin: Any = np.inf
        for _ in range(count):
            margin = np.maximum.accumulate(np.minimum(margin, side * values), axis=-1)
            side = -side
        return margin[..., -1]

    if direction == "either":
        return np.maximum(turns(-1.0, number + 1), turns(1.0, number + 1))
    return turns(-1.0 if direction == "rising" else 1.0, 2 * number)


def settling(
    time: np.ndarray, values: np.ndarray, tolerance: float, target: float | None = None
) -> float:
    """Return the time (s) from which on values (t,) stay within `tolerance` of `target`, None: of
    the last value; NaN if they are outside at the end."""
    deviation = values - (values[-1] if target is None else target)
    indices = np.flatnonzero(np.abs(deviation) > tolerance)
    if not len(indices):
        return float(time[0])
    last = int(indices[-1])
    if last == len(time) - 1:
        return float("nan")
    return find_root(time, np.sign(deviation[last]) * deviation - tolerance, last)


def _place_of_smallest(quantity: Quantity, curves: Curves) -> float:
    """Return where values are smallest: a time (s), or a value of the response's abscissa."""
    if quantity.response.along:
        return margins.least(quantity.response, curves)[1]
    time, values = curves.time, quantity.response.evaluate(curves)
    i, shift = int(values.argmin()), 0.0
    if 0 < i < len(values) - 1:
        rise1, rise2 = values[i - 1] - values[i], values[i + 1] - values[i]
        shift = 0.5 * (rise1 - rise2) / (rise1 + rise2) if rise1 + rise2 > 0 else 0.0
    fraction = (i + shift) / (len(values) - 1)
    return float(time[0] + fraction * (time[-1] - time[0]))


def _mean(quantity: Quantity, curves: Curves, power: int = 1) -> float:
    """Return the mean over time of a power of the response."""
    time, values = curves.time, quantity.response.evaluate(curves)
    return float(np.trapezoid(values**power, time) / (time[-1] - time[0]))


def _value(quantity: Quantity, curves: Curves) -> float:
    instant = quantity.instant if isinstance(quantity.instant, Quantity) else None
    time = instant.evaluate(curves) if instant else quantity.instant
    if not np.isfinite(time) or not curves.time[0] <= time <= curves.time[-1]:
        return float("nan")
    event = instant is not None and any(
        leaf.kind == "event" and leaf.evaluate(curves) == time for leaf in instant.leaves
    )
    return float(value_at(curves, quantity.response, time, event))


def _event(quantity: Quantity, curves: Curves) -> float:
    times = curves.times(quantity.event, quantity.places)
    if len(times) >= quantity.number:
        return float(times[quantity.number - 1])
    if curves.dropped_events:
        raise ValueError(
            f"{quantity.name}: a run has {curves.dropped_events} events more than are kept; "
            f"{quantity.long_name} may be among them"
        )
    return float("nan")


class QuantityType(NamedTuple):
    """A kind of quantity, in KINDS. read(quantity, curves): returns its number in a run; text:
    template of its long name, in which {about} is the response's; mandatory, optional: further keys
    that a definition must or may have; unit: of the number, None: the response's; positive: whether
    it is never below 0; is_instantaneous: whether it is a size of the response at an instant."""

    read: Callable[[Quantity, Curves], float]
    text: str
    mandatory: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    unit: str | None = None
    positive: bool = False
    is_instantaneous: bool = False


KINDS = {
    "largest": QuantityType(
        lambda q, curves: extreme_value(curves, q.response, 1.0),
        "largest {about}", is_instantaneous=True,
    ),
    "smallest": QuantityType(
        lambda q, curves: (
            margins.least(q.response, curves)[0] if q.response.along  # between all positions
            else extreme_value(curves, q.response, -1.0)
        ),
        "smallest {about}", is_instantaneous=True,
    ),
    "smallest_at": QuantityType(_place_of_smallest, "{place} of the smallest {about}"),
    "final": QuantityType(
        lambda q, curves: float(q.response.evaluate(curves)[-1]), "final {about}"
    ),
    "mean": QuantityType(_mean, "mean {about}"),
    "rms": QuantityType(
        lambda q, curves: float(np.sqrt(_mean(q, curves, 2))), "rms {about}",
        positive=True, is_instantaneous=True,
    ),
    "value": QuantityType(_value, "{about} {moment}", ("at",)),
    "settling": QuantityType(
        lambda q, curves: settling(
            curves.time, q.response.evaluate(curves), q.tolerance, q.target
        ),
        "time from which the {about} stays within {within:.6g}", ("within",), ("about",), "s",
    ),
    "crossing": QuantityType(
        lambda q, curves: crossing(
            curves.time, q.response.evaluate(curves), q.level, q.direction, q.number
        ),
        "time of the {nth}crossing of {level:.6g}{way} by the {about}",
        ("level",), ("way", "number"), "s",
    ),
    "event_margin": QuantityType(
        lambda q, curves: q.instant.margin(curves), "event margin of {time}"
    ),
    "event": QuantityType(
        _event, "time of the {nth}event '{event}'{whose}", optional=("of", "number"), unit="s"
    ),
}  # fmt: skip
"""All kinds of quantities, in the order of messages."""
