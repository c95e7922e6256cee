"""The value of a response at a time, or just before what happens then: never across an event.

Between instants it is that of a polynomial through those nearby. At an event the polynomial is
continued from before, by up to two instants and a step; where its rates are recorded, as of points,
it goes through values and rates of three instants (Hermite; Davis, Interpolation and Approximation,
ch. 2), and the error falls with the sixth power of their distance."""

from dataclasses import replace

import numpy as np

from fpm.files.trajectory import Curves
from fpm.reading.responses import Response

SPREAD = 2
"""Steps after an event in which velocities may still be between those before and after it: the
impulse of one that holds exactly comes in the step that it happens in and the next, and a velocity
at an instant is the mean of half a step before and after."""

_CONTINUOUS = ("clearance", "distance", "opening", "position", "strut_length")
"""Kinds of responses that no event breaks: their values at instants are of one side of it."""

MIN_STEPS = 5
"""Steps that two events are apart, at least, if two instants shall lie between them that neither
touches: a step before the later one, SPREAD after the earlier one, and up to one to the first."""


def value_at(curves: Curves, response: Response, instant: float, is_event: bool) -> float:
    """Return the value of a response in one run at `instant` (s). is_event: something jumps then:
    the value just before is meant, by values and rates of three instants where rates are recorded
    (Hermite). Else by a cubic at most through the nearest instants with no other event between;
    with fewer than two, before an event, the value at the last instant a step before."""
    time, step, values = curves.time, curves.step, response.evaluate(curves)
    times = np.sort(curves.events[:, 0])
    if is_event:  # those that a few steps cannot tell apart are one
        instant = float(times[np.searchsorted(times, instant - MIN_STEPS * step)])
    later_events = times[np.searchsorted(times, instant, side="left" if is_event else "right") :]
    earlier_events = times[times < instant] if is_event else times[times <= instant]
    upper = np.inf if not len(later_events) else later_events[0] - step
    lower = -np.inf if not len(earlier_events) else earlier_events[-1] + SPREAD * step
    rounding = 1e-6 * step  # of times
    indices = np.flatnonzero((time >= lower - rounding) & (time <= upper + rounding))
    if is_event and (value := _extrapolate(curves, response, indices[-5:], instant)) is not None:
        return value
    if len(indices) > 1:
        middle = int(np.searchsorted(time[indices], instant, side="left"))
        return cubic_through(time[indices], values[indices], middle + 1)(instant)
    if is_event:
        return values[max(np.searchsorted(time, upper + rounding, side="right") - 1, 0)]
    return np.interp(instant, time, values)


def cubic_through(time: np.ndarray, values: np.ndarray, last: int) -> np.polynomial.Polynomial:
    """Return the polynomial in time (s), a cubic at most, through four of the values (t,) at the
    instants `time` (t,): those at indices last - 3 to last, or the nearest four that there are."""
    stop = min(max(last + 1, 4), len(time))
    window = slice(max(stop - 4, 0), stop)
    return np.polynomial.Polynomial.fit(time[window], values[window], len(time[window]) - 1)


def peak(values: np.ndarray) -> float:
    """Return the largest of values (t,) at equal steps: the top of the parabola through it and its
    neighbours, above it by at most an eighth of the larger drop, and not above lines through the
    two instants on either side, as at a jump; at an end the value itself."""
    i = int(values.argmax())
    top = float(values[i])
    if 0 < i < len(values) - 1:
        drops = {side: float(top - values[i + side]) for side in (-1, 1)}
        side = min(drops, key=drops.__getitem__)  # on which the parabola has its top
        drop, slope = drops[side], drops[-side]
        if slope > 0:
            rise = (slope - drop) ** 2 / (8 * (slope + drop))
            if 0 <= i + 2 * side < len(values):
                next_drop = float(values[i + side] - values[i + 2 * side])
                excess = max(next_drop - drop, 0.0)
                rise = min(rise, slope * excess / max(slope + next_drop, slope))
            top += rise
    return top


def extreme_value(curves: Curves, response: Response, sign: float) -> float:
    """Return the largest (sign 1) or smallest (-1) value of a response in one run: by a parabola
    (`peak`), unless an event lies between the instants it goes through, or touches one. It is then
    the extreme recorded value, or that just before such an event (`value_at`), beyond it by at most
    as much as the response changes meanwhile."""
    time, values = curves.time, sign * response.evaluate(curves)
    if response.along:  # no curve over time
        return sign * peak(values)
    i = int(values.argmax())
    start, end = time[max(i - 1, 0)], time[min(i + 1, len(time) - 1)]
    times = curves.events[:, 0]
    step = 0.0 if response.kind in _CONTINUOUS else curves.step
    instants = times[(times > start - SPREAD * step) & (times < end + step)]
    if not len(instants):
        return sign * peak(values)
    ends = [sign * value_at(curves, response, instant, True) for instant in instants]
    changes = np.diff(values[max(i - 2, 0) : i + 1])
    change = np.abs(changes).max(initial=0.0) + np.abs(np.diff(changes)).max(initial=0.0)
    most = values[i] + change * max(1.0, 2 * (instants.max() - time[i]) / (end - start))
    return sign * float(np.clip(max(ends), values[i], most))


def find_root(time: np.ndarray, values: np.ndarray, i: int) -> float:
    """Return the time (s) at which values (t,) at instants `time` (t,) s vanish between the
    instants of indices i and i + 1, at which they differ in sign, by a cubic through four."""
    cubic = cubic_through(time, values, i + 2)
    offset, scale = map(float, cubic.mapparms())
    coefficients = cubic.coef[::-1].tolist()
    low, high = float(time[i]), float(time[i + 1])
    is_rising = bool(values[i + 1] > 0)
    for _ in range(60):
        middle = 0.5 * (low + high)
        # As `cubic` itself has it, in plain numbers: a tenth of the time.
        x, value = offset + scale * middle, 0.0
        for coefficient in coefficients:
            value = coefficient + value * x
        if (value > 0) == is_rising:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


def _extrapolate(curves: Curves, response: Response, rows, instant: float) -> float | None:
    """Return the value of a response at an instant (s) after five others, those of indices `rows`,
    by the rates of its constituents. None: the run has not recorded these, or they would not have
    predicted the last of the five as well as a cubic does."""
    time, constituents = curves.time[rows], {}
    for name in response.subjects:
        curve = _with_rates(curves, response.kind, name)
        if curve is None or len(time) < 5:
            return None
        values, rates = (x[rows] for x in curve)
        cubic = np.polynomial.polynomial.polyfit(time[:4] - time[4], values[:4], 3)[0]
        prediction = _hermite(time[1:4], values[1:4], rates[1:4], time[4])
        error, limit = (np.linalg.norm(value - values[4]) for value in (prediction, cubic))
        if not error <= limit + 1e-12 * np.abs(values).max():  # rounding
            return None
        constituents[name] = _hermite(time[2:], values[2:], rates[2:], instant)
    if not constituents:
        return None
    points = {name: (value, value) for name, value in constituents.items()}
    columns = {("opening", name): value[:, 0] for name, value in constituents.items()}
    extrapolation = replace(curves, time=np.array([instant]), points=points, columns=columns)
    return float(response.evaluate(extrapolation)[0])


def _with_rates(curves: Curves, kind: str, name: str) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the constituents of a response at a point or hinge, and their rates (t, k)."""
    if kind in ("position", "distance"):
        return curves.points[name]
    rates = {
        "velocity": [("acceleration", f"{name} {axis}") for axis in "xyz"],
        "opening": [("opening_rate", name)],
    }.get(kind, [])
    if not rates or any(column not in curves.columns for column in rates):
        return None
    values = curves.points[name][1] if kind == "velocity" else curves.openings[name][:, None]
    return values, np.stack([curves.columns[column] for column in rates], axis=1)


def _hermite(time: np.ndarray, values: np.ndarray, rates: np.ndarray, instant: float) -> np.ndarray:
    """Return the values (1, k) at an instant (s) of k polynomials, from values and rates (n, k) at
    n times. Their terms are powers of the distance from the instant, so that the first is it."""
    unit, powers = time[-1] - time[0], np.arange(2 * len(time))
    distance = ((time - instant) / unit)[:, None]
    terms, slopes = distance**powers, powers * distance ** np.maximum(powers - 1, 0)
    coefficients = np.linalg.solve(np.vstack([terms, slopes]), np.vstack([values, unit * rates]))
    return coefficients[:1]
