"""Events: levels that a quantity of an element crosses."""

from fpm.kernels.lanes import absolute, any_negative, store, where_negative
from fpm.kernels.vectors import kernel


@kernel
def note(log, lane, time, element, event):
    """Write an event into a log; where the log is full, it is only counted. log: that of the
    element's type (Log); lane: index of the sample; time (s); element: index among the type's
    elements; event: index in ElementType.events, the names of the type's events."""
    n = log.count[lane]
    log.count[lane] = n + 1
    if n < log.events.shape[0]:
        log.events[n, 0, lane] = time
        log.events[n, 1, lane] = log.first + element
        log.events[n, 2, lane] = event


@kernel
def note_crossings(log, element, previous, value, timing):
    """Note event 1 in samples whose value became negative in this step, 0 where it no longer is, at
    the time by linear interpolation. log: of the element's type (Log); element: index in its type;
    previous, value (lanes): at the start and end of the step; timing: times of this step (s)."""
    signs = where_negative(value, -1.0, 1.0)
    if any_negative(signs * where_negative(previous, -1.0, 1.0)):
        store(log.ends, 0, 0, previous)
        store(log.ends, 1, 0, value)
        for s in range(log.ends.shape[2]):
            first, last = log.ends[0, 0, s], log.ends[1, 0, s]
            if (last < 0.0) != (first < 0.0):
                time = timing.time - timing.step * last / (last - first)
                note(log, s, time, element, 1.0 if last < 0.0 else 0.0)


@kernel
def edge(new, old):
    """Return what to add to the overlap or stretch `new` of a spring that begins at 0, as that of a
    cable, in the step in which it passes 0; else 0. new, old: now and a step ago (rad or m, as the
    result). From -b to s such a spring does the work k s²/2, but the mean of the forces 0 and k s
    at both ends does k s (s + b)/2. Half of the difference is taken off now, half by the step that
    follows: the energy is then kept to the third order in the step instead of the second. For that
    one step, a cable that has turned slack pushes a little."""
    product = new * old
    return where_negative(product, 0.5 * product / absolute(new - old), 0.0)
