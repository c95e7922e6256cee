"""By how much a latch catches, a stop is hit or a contact closes, or by how much they are missed.

The margin is an energy for each unit of inertia (rad²/s², on slides m²/s²), so that it goes on
smoothly where the event ceases to occur. It is half the square of the rate with which the opening
arrives; and where it does not, what it lacked: the deceleration before it turned back times the
opening that was still to go. A latch with a largest rate L, that the opening has at w, catches by
w²/2 (1 - w²/L²), which is below zero where it is passed too fast."""

import numpy as np

from fpm.elements.kind import Eventful
from fpm.files.trajectory import IMPACTS, Curves
from fpm.reading.events import SPREAD, cubic_through, find_root, peak

_START_SHARE = 1e-3  # share of the way within which it is at its gate from the start
_TINY = 1e-12  # rad²/s², m²/s²: the size of a margin, at least
_LAST, _ROWS = 0.1, 4  # share of the way, and least instants, over which deceleration is found


def impact_margins(curves: Curves) -> list[float]:
    """Return the margins (rad²/s²; m²/s²) of the first impact of each element that can have any, in
    the order of `Curves.impacts`; NaN where not known. curves: the run's."""
    pairs = [(next((n for n in e.events if n in IMPACTS), ""), e) for e in curves.eventful]
    return [gate_margin(curves, event, e) for event, e in pairs if event]


def gate_margin(curves: Curves, event: str, element: Eventful) -> float:
    """Return the margin (rad²/s²; m²/s²) of an element's first event in one run: above 0 if it
    occurs, else below; NaN where it is not known: of one without a gate, that is beyond it at the
    start, or that may catch late within its reach, once it has become slow enough. curves: the
    run's; event: "latches", "hits" or "closes"."""
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
    rates = [_arrival_rate(curves, gap, time) for time in passes]
    catch_rates = {
        **curves.select_columns("latch_rate"),
        **curves.select_columns("slide_latch_rate"),
    }
    if len(times) and (label := element.name.removeprefix("latch ")) in catch_rates:
        rates = [catch_rates[label][-1]]
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
    time, values = np.append(curves.time[rows], instant), np.append(gap[rows], 0.0)
    cubic = np.polynomial.Polynomial.fit(time, values, len(rows))
    return max(float(cubic.deriv()(instant)), 0.0)


def _lack(time: np.ndarray, gap: np.ndarray) -> float:
    """What a gap (t,), below 0 at instants `time` (t,), lacked to vanish: what was still to go,
    times the deceleration there, continued from the last tenth of the way to its largest value,
    where it turned back or stuck."""
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
