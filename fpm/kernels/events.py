"""Events: levels that a quantity of an element crosses."""

from fpm.kernels.vectors import kernel


@kernel
def note(log, lane, time, element, which):
    """Note in a lane that event `which` of the kind's element happened at a time (s)."""
    n = log.count[lane]
    log.count[lane] = n + 1
    if n < log.events.shape[0]:
        log.events[n, 0, lane] = time
        log.events[n, 1, lane] = log.first + element
        log.events[n, 2, lane] = which


@kernel
def note_crossing(log, lane, element, before, after, now):
    """Note event 1 where a value has become negative since the step before, 0 where it was.

    before, after: its value at the end of either step, now: the Now of the later one. The time is
    found by linear interpolation.
    """
    if (after < 0.0) != (before < 0.0):
        time = now.time - now.step * after / (after - before)
        note(log, lane, time, element, 1.0 if after < 0.0 else 0.0)
