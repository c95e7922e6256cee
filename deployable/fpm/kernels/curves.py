"""Piecewise linear curves of time, by which loads and drives are scaled."""

from deployable.fpm.kernels.vectors import kernel


@kernel
def curve_value(world, curve, t):
    """Value of a curve at time t (s), constant outside; curve -1 is always 1."""
    if curve < 0:
        return 1.0
    times, values = world.curve_time, world.curve_value
    first, last = world.curve_start[curve], world.curve_start[curve + 1] - 1
    if t <= times[first]:
        return values[first]
    for k in range(first, last):
        if t < times[k + 1]:
            share = (t - times[k]) / (times[k + 1] - times[k])
            return values[k] + share * (values[k + 1] - values[k])
    return values[last]
