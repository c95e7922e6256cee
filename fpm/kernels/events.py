"""Events: levels that a quantity of an element crosses."""

from fpm.kernels.vectors import kernel


@kernel
def note(log, lane, time, element, event):
    """Note in a lane that event `event` of the kind's element happened at a time (s)."""
    n = log.count[lane]
    log.count[lane] = n + 1
    if n < log.events.shape[0]:
        log.events[n, 0, lane] = time
        log.events[n, 1, lane] = log.first + element
        log.events[n, 2, lane] = event


@kernel
def note_crossing(log, lane, element, previous, value, timing):
    """Note event 1 where a value has become negative since the step before, 0 where it was.

    previous, value: at the end of the step before and of this one, of which `timing` is the
    StepTime. The time of the event follows by linear interpolation.
    """
    if (value < 0.0) != (previous < 0.0):
        time = timing.time - timing.step * value / (value - previous)
        note(log, lane, time, element, 1.0 if value < 0.0 else 0.0)
