"""Events: levels that a quantity of an element crosses."""

from fpm.kernels.vectors import kernel


@kernel
def note(log, lane, time, element, event):
    """Note an event in a log. log: of the element type (Log); lane: index of the sample; time: of
    the event (s); element, event: indices among the type's elements and its `events`."""
    n = log.count[lane]
    log.count[lane] = n + 1
    if n < log.events.shape[0]:
        log.events[n, 0, lane] = time
        log.events[n, 1, lane] = log.first + element
        log.events[n, 2, lane] = event


@kernel
def note_crossing(log, lane, element, previous, value, timing):
    """Note event 1 where a value has become negative since the step before, 0 where it was. log,
    lane, element: as of `note`; previous, value: at the end of the step before and of this one;
    timing: times of the step (s). The time of the event follows by linear interpolation."""
    if (value < 0.0) != (previous < 0.0):
        time = timing.time - timing.step * value / (value - previous)
        note(log, lane, time, element, 1.0 if value < 0.0 else 0.0)
