"""How a cable slips over the points through which it runs: Euler and Eytelwein's law as a whole.

Theory: docs/mechanics.md, "Cables", where it is shown that there is one solution, and that these
steps find it."""

from fpm.elements.cables.cable_kernels import LENGTH, TINY
from fpm.kernels.lanes import absolute, any_negative, load, sqrt, store, where_negative
from fpm.kernels.vectors import kernel, larger

# Of a stretch, and of the point at which it begins.
START = 0  # unstrained length before anything slips in this step
FREE_STRAIN = 1  # strain, if nothing could slip over the point after it
RATIO, INVERSE = 2, 3  # of the tensions on either side when it slips
MATERIAL = 4  # unstrained length; the length, where the cable is slack
TENSION, TENSION_BEFORE = 5, 6
SLIP = 7  # unstrained length that came over the point, or from the winch, while tight
SLIP_BEFORE = 8  # size of that in the step before, for events
SLIP_SIZE = 9

CLOSE = 1e-13
"""What may be left over in the search for a strain, as a share of the cable's unstrained length."""

MOST = 60
"""Steps of Newton's, or halvings, at most; one or two do in a smooth motion."""


FLOOR = 1e-200
"""Least strain, behind points that much friction holds, as a share of the largest that may be."""


@kernel
def positive(x):
    """Return the larger of x and 0; x: a number or lanes."""
    return where_negative(x, 0.0, x)


@kernel
def find_flow(part, first, j, strain):
    """Return the unstrained length (m) that slips from the stretches `first` to j over the point at
    j's end if j has this `strain`, and its derivative by it (m). part: RubbingCables."""
    flow, follows = 0.0 * strain, 0.0 * strain + 1.0
    slope, link = flow, follows
    for k in range(j, first - 1, -1):
        local, scale = follows * strain, 1.0 / (1.0 + follows * strain)
        start, length = load(part.slip, k, START), load(part.stretches, k, LENGTH)
        flow = flow + link * (scale * (start * local - (length - start)))  # start - length scale
        slope = slope + link * (follows * length * scale * scale)
        if k > first:
            free_strain, ratio = load(part.slip, k - 1, FREE_STRAIN), load(part.slip, k, RATIO)
            inverse = load(part.slip, k, INVERSE)
            low, high = inverse * local - free_strain, free_strain - ratio * local
            link = where_negative(low, where_negative(high, 0.0, link), link)
            follows = follows * where_negative(low, ratio, inverse)
            if not any_negative(-link):
                break
    return flow, slope


@kernel
def find_free_strain(part, first, j, tight, slope, close):
    """Return the strain of stretch j > first if nothing could slip over the point at its end (0:
    slack), at which `find_flow` is 0, and the derivative of that (m): by Newton's method between
    bounds. tight: length less unstrained length (m) of the stretches up to j; slope: derivative (m)
    for those before j; close: flow (m) near enough to 0."""
    start, length = load(part.slip, j, START), load(part.stretches, j, LENGTH)
    free_strain = load(part.slip, j - 1, FREE_STRAIN)
    stick_strain = positive((length - start) / start)
    ratio, inverse = load(part.slip, j, RATIO), load(part.slip, j, INVERSE)
    least, most = inverse * stick_strain - free_strain, free_strain - ratio * stick_strain
    follows = where_negative(least, ratio, inverse)
    slope = where_negative(least, where_negative(most, 0.0, slope), slope)
    strain = (start * stick_strain + slope * free_strain) / (start + slope * follows)
    is_open = where_negative(-tight, 1.0, 0.0)
    strain = is_open * strain
    high = larger(stick_strain, free_strain)
    low = FLOOR * high
    for _ in range(MOST):
        flow, steep = find_flow(part, first, j, strain)
        low, high = where_negative(flow, strain, low), where_negative(flow, high, strain)
        better, bisection = strain - flow / steep, sqrt(low * high)
        better = where_negative(low - better, better, bisection)
        better = where_negative(better - high, better, bisection)
        slope = where_negative(-is_open, steep, slope)
        is_open = where_negative(absolute(flow) - close, 0.0, is_open)
        strain = where_negative(-is_open, better, strain)
        if not any_negative(-is_open):
            break
    return strain, slope


@kernel
def strain_before(part, j, strain):
    """Return the strain of the stretch before point j by the law of friction, after it `strain`."""
    least, most = load(part.slip, j, INVERSE) * strain, load(part.slip, j, RATIO) * strain
    free_strain = load(part.slip, j - 1, FREE_STRAIN)
    return larger(least, where_negative(most - free_strain, most, free_strain))


@kernel
def find_free_strains(part, first, last, close):
    """Store in FREE_STRAIN the strain of each stretch if it slipped over the points before, but
    nothing over that at its end. first, last: the cable's first and last point; close: error of
    unstrained length (m) at which the iteration ends."""
    start, length = load(part.slip, first, START), load(part.stretches, first, LENGTH)
    tight = length - start
    strain, slope = positive(tight) / larger(start, 0.0 * start + TINY), length
    store(part.slip, first, FREE_STRAIN, strain)
    for j in range(first + 1, last):
        tight = tight + (load(part.stretches, j, LENGTH) - load(part.slip, j, START))
        strain, slope = find_free_strain(part, first, j, tight, slope, close)
        store(part.slip, j, FREE_STRAIN, strain)
