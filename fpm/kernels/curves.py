"""Piecewise linear curves of time, by which loads and drives are scaled."""

import math

from fpm.kernels.vectors import kernel


@kernel
def curve_value(world, curve, t):
    """Return the value of a curve of time at time t (s): one number for all samples, linear between
    the curve's points, constant before the first and after the last, in the unit of what refers to
    it. world: solver state with all curves (World); curve: index, -1: always 1."""
    if curve < 0:
        return 1.0
    times, values = world.curve_time, world.curve_value
    first, last = world.curve_start[curve], world.curve_start[curve + 1] - 1
    if t <= times[first]:
        return values[first]
    if t >= times[last]:
        return values[last]
    k = _point_after(times, first, last, t) - 1
    fraction = (t - times[k]) / (times[k + 1] - times[k])
    return values[k] + fraction * (values[k + 1] - values[k])


@kernel
def _point_after(times, first, last, t):
    """Index of the first of increasing times, from first to last, that is after t, else last."""
    while first < last:
        middle = (first + last) // 2
        if times[middle] > t:
            last = middle
        else:
            first = middle + 1
    return last


@kernel
def bend_after(world, curve, t):
    """Return the time (s) from t (s) to the next point of a curve after t, where its slope jumps;
    infinite where none follows. world: solver state with all curves (World); curve: index, -1: the
    curve that is always 1, which has no points."""
    if curve >= 0:
        times, last = world.curve_time, world.curve_start[curve + 1] - 1
        if times[last] > t:
            return times[_point_after(times, world.curve_start[curve], last, t)] - t
    return math.inf


@kernel
def curve_integral(world, curve, t):
    """Return the exact integral of a curve of time from 0 to time t (s). world: solver state with
    all curves (World); curve: index, -1: the curve that is always 1."""
    if curve < 0:
        return t
    times, values = world.curve_time, world.curve_value
    first, last = world.curve_start[curve], world.curve_start[curve + 1] - 1
    t_first, t_last = max(times[first], 0.0), max(times[last], 0.0)
    total = values[first] * min(t, t_first) + values[last] * max(t - t_last, 0.0)
    for k in range(first, last):
        start, end = max(times[k], 0.0), min(times[k + 1], t)
        if start < end:
            middle = (0.5 * (start + end) - times[k]) / (times[k + 1] - times[k])
            total += (end - start) * (values[k] + middle * (values[k + 1] - values[k]))
    return total


@kernel
def travel_factor(world, curve, by_rate, t):
    """Return by what a motor's turn (rad; by_rate: rad/s) is multiplied to give that made by time t
    (s): the value of its curve or, if by_rate, the curve's integral from 0 to t. world: solver
    state with all curves (World); curve: index, -1: the curve that is always 1."""
    if by_rate:
        return curve_integral(world, curve, t)
    return curve_value(world, curve, t)
