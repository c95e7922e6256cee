"""Curves of time, by which loads and drives are scaled (theory: fpm/scenes/curve.py)."""

import math

from fpm.kernels.vectors import kernel


@kernel
def curve_value(world, curve, t):
    """Return the value of a curve (index, -1: constant 1) at time t (s)."""
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
    value = values[k] + fraction * (values[k + 1] - values[k])
    if world.curve_power.shape[1]:
        deviation = 0.0
        for j in range(world.curve_power.shape[1] - 1, -1, -1):
            deviation = (deviation + world.curve_power[k, j]) * fraction
        value += deviation
    return value


@kernel
def _point_after(times, first, last, t):
    """Return the index of the first time, from first to last, that is after t, or last."""
    while first < last:
        middle = (first + last) // 2
        if times[middle] > t:
            last = middle
        else:
            first = middle + 1
    return last


@kernel
def bend_after(world, curve, t):
    """Return the time (s) from t to the next jump of a curve's slope, or infinity."""
    if curve >= 0:
        times, last = world.curve_time, world.curve_start[curve + 1] - 1
        if times[last] > t:
            point = _point_after(times, world.curve_start[curve], last, t)
            return world.curve_kink[point] - t
    return math.inf


@kernel
def curve_integral(world, curve, t):
    """Return the exact integral of a curve from 0 to time t (s)."""
    if curve < 0:
        return t
    times, values = world.curve_time, world.curve_value
    first, last = world.curve_start[curve], world.curve_start[curve + 1] - 1
    if t <= times[first]:
        return values[first] * t
    if t >= times[last]:
        return world.curve_sum[last] + values[last] * (t - max(times[last], 0.0))
    k = _point_after(times, first, last, t) - 1
    start, step = max(times[k], 0.0), times[k + 1] - times[k]
    middle = (0.5 * (start + t) - times[k]) / step
    area = (t - start) * (values[k] + middle * (values[k + 1] - values[k]))
    if world.curve_power.shape[1]:
        old, new = (start - times[k]) / step, (t - times[k]) / step
        area_before, area_now = 0.0, 0.0
        for j in range(world.curve_power.shape[1] - 1, -1, -1):
            power = world.curve_power[k, j] / (j + 2.0)
            area_before, area_now = (area_before + power) * old, (area_now + power) * new
        area += step * (new * area_now - old * area_before)
    return world.curve_sum[k] + area


@kernel
def curve_mean(world, curve, start, end):
    """Return the mean of a curve between two times (s), exact but for rounding, so that an impulse
    is right however short the curve's pulses are."""
    if curve < 0:
        return 1.0
    start = max(start, 0.0)
    first, last = world.curve_start[curve], world.curve_start[curve + 1] - 1
    if end <= world.curve_time[first] or start >= world.curve_time[last]:
        return curve_value(world, curve, start)
    integral = curve_integral(world, curve, end) - curve_integral(world, curve, start)
    return integral / (end - start)


@kernel
def kick_mean(world, curve, timing, steps=0):
    """Return the mean of a curve over the kick of this step, or of one `steps` later."""
    time = timing.time + steps * timing.step
    return curve_mean(world, curve, time - 0.5 * timing.step, time + 0.5 * timing.step)


@kernel
def travel_factor(world, curve, by_rate, t):
    """Return by what a motor's turn (rad; by_rate: rad/s) is multiplied to give that made by time t
    (s): its curve, or the integral of that from 0 to t."""
    if by_rate:
        return curve_integral(world, curve, t)
    return curve_value(world, curve, t)


@kernel
def travel_mean(world, curve, by_rate, timing):
    """Return `travel_factor` as a mean over the kick of this step, or, if by_rate, that at
    timing.time: no pulse of a rate is lost between two times."""
    if by_rate:
        return curve_integral(world, curve, timing.time)
    return kick_mean(world, curve, timing)
