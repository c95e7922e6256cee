"""Revolute hinges: impulses that close every hinge at the end of the step (elements/hinge.py).

The matrix of the impulses (hinge_matrix.py) is built at the start of the step and serves three
times:

1. `aim`: impulses that would close the hinge if the rates of its gaps stayed as they are over the
   step, less what was missing so in the step before. What is left is the change from step to step
   of a term of second order in the angle turned.
2. `close`, in rounds, only where that is much: particles move, and their gaps are closed. Each
   round gains a factor of about the angle turned in a step: three digits.
3. `close`, at the end, always: the gaps found then are closed by small turns on top, which gains
   three digits more, down to rounding.

A sample whose gaps are small is left alone in the rounds that other samples need: its numbers do
not depend on theirs.
"""

from fpm.kernels.hinge_matrix import (
    DP,
    DV,
    GLOBAL_ARM,
    INVERSE,
    MISSED,
    OFF,
    OLD_D2,
    OLD_D3,
    OLD_X,
    PA,
    QA,
    find_impulses,
    get6,
    prepare_bodies,
    prepare_directions,
    prepare_matrices,
    prepare_supports,
)
from fpm.kernels.lanes import any_negative, load, sqrt, store, where_negative
from fpm.kernels.layout import (
    ARM,
    AXIS,
    D2,
    D3,
    HELD,
    HIJ,
    LARGEST_GAP,
    LARGEST_TILT,
    PLACE,
    REF,
    P,
    V,
    X,
)
from fpm.kernels.rotation import frame, half_turn, put_turned
from fpm.kernels.strain import larger
from fpm.kernels.vectors import (
    add,
    axpy,
    cross,
    dot,
    get3,
    kernel,
    put3,
    scale,
    sub,
    symmetric,
    times,
    to_global,
    to_local,
)

ROUNDS = 4
"""Most rounds in a step; smooth motion takes one, a fast impact two."""

COARSE_GAP = 5e-9
"""Gap (m) of the hinge point above which a sample gets another round."""

COARSE_TILT = 5e-8
"""The same for the angle between the axes (rad)."""


@kernel
def aim(state, ends, bodies, hinges, held, supported, b, w, open_):
    """Impulses that would keep every hinge closed if its rates did not change over the step."""
    open_[:] = True
    for h in range(w.shape[0]):
        one, two = 2 * h, 2 * h + 1
        i, k = ends[one], ends[two]
        spin1 = symmetric(get6(b, one, INVERSE), get3(state, i, P))
        spin2 = symmetric(get6(b, two, INVERSE), get3(state, k, P))
        point = add(get3(state, i, V), cross(spin1, get3(b, one, GLOBAL_ARM)))
        other = add(get3(state, k, V), cross(spin2, get3(b, two, GLOBAL_ARM)))
        turn = sub(spin2, spin1)
        put3(w, h, OFF, add(sub(point, other), get3(w, h, MISSED)))
        store(w, h, OFF + 3, dot(turn, get3(w, h, PA)) + load(w, h, MISSED + 3))
        store(w, h, OFF + 4, dot(turn, get3(w, h, QA)) + load(w, h, MISSED + 4))
        put3(w, h, OFF + 5, add(point, get3(w, h, MISSED + 5)))
    find_impulses(hinges, held, supported, bodies, b, w, open_, -1.0)
    for h in range(w.shape[0]):
        push(state, (ends[2 * h], ends[2 * h + 1]), (2 * h, 2 * h + 1), b)


@kernel
def push(state, i, r, b):
    """Add DV and DP to the momenta of particles i, bodies r (pairs)."""
    put3(state, i, V, add(get3(state, i, V), get3(b, r, DV)))
    put3(state, i, P, add(get3(state, i, P), get3(b, r, DP)))


@kernel
def push_where_far(state, i, r, b, far):
    """The same in the lanes where `far` is negative; the others are not touched."""
    for k, change in ((V, DV), (P, DP)):
        for m in range(3):
            before = load(state, i, k + m)
            after = where_negative(far, before + load(b, r, change + m), before)
            store(state, i, k + m, after)


@kernel
def note_open(gap2, tilt2, largest):
    """Raise largest by the squares of a hinge's gaps; returns the gaps (m, rad)."""
    gap, tilt = sqrt(gap2), sqrt(tilt2)
    store(largest, 0, LARGEST_GAP, larger(load(largest, 0, LARGEST_GAP), gap))
    store(largest, 0, LARGEST_TILT, larger(load(largest, 0, LARGEST_TILT), tilt))
    return gap, tilt


@kernel
def prepare(state, ends, bodies, hinges, held, supported, b, w, open_, kick):
    """Kick the particles of all hinges for `kick` s, and aim their impulses.

    All forces must be summed; those of hinged particles are used up. ends (2h,) particles; bodies
    (2h, BODY, lanes), hinges (h, HINGE, lanes) constants; held (h, 3) held axes, supported: whether
    there are any; b (2h, BODY_SCRATCH, lanes), w (h, HINGE_SCRATCH, lanes), open_ (h,) scratch.
    """
    prepare_directions(state, ends, bodies, w)
    prepare_bodies(state, ends, bodies, b, kick)
    prepare_matrices(b, w)
    if supported:
        prepare_supports(hinges, held, b, w)
    aim(state, ends, bodies, hinges, held, supported, b, w, open_)


@kernel
def gaps(state, ends, bodies, h):
    """Hinge point of body 1, its gap (3) to that of 2, and the axis gap about p and q (rad)."""
    one, two = 2 * h, 2 * h + 1
    i, k = ends[one], ends[two]
    first, second = frame(state, i), frame(state, k)
    point = add(get3(state, i, X), to_global(first, get3(bodies, one, ARM)))
    other = add(get3(state, k, X), to_global(second, get3(bodies, two, ARM)))
    p = to_global(first, get3(bodies, one, REF))
    q = cross(to_global(first, get3(bodies, one, AXIS)), p)
    axis = to_global(second, get3(bodies, two, AXIS))
    return point, sub(point, other), -dot(q, axis), dot(p, axis)


@kernel
def restore(state, on, rows, b):
    """Bring the particles `on` of the bodies `rows` (pairs) back to the start of the step."""
    put3(state, on, X, get3(b, rows, OLD_X))
    put3(state, on, D2, get3(b, rows, OLD_D2))
    put3(state, on, D3, get3(b, rows, OLD_D3))


@kernel
def move(state, on, rows, bodies, step):
    """Move the particles `on` of the bodies `rows` (pairs) by a step, with their momenta."""
    put3(state, on, X, axpy(step, get3(state, on, V), get3(state, on, X)))
    axes = frame(state, on)
    half = half_turn(to_local(axes, get3(state, on, P)), get3(bodies, rows, HIJ), step)
    put_turned(state, on, axes, half)


@kernel
def nudge(state, i, r, b, step):
    """Change the momenta of particles i, bodies r (pairs), by DV and DP; move them by that."""
    push(state, i, r, b)
    put3(state, i, X, axpy(step, get3(b, r, DV), get3(state, i, X)))
    # So small a turn that its square does not show.
    turn = scale(step, symmetric(get6(b, r, INVERSE), get3(b, r, DP)))
    for k in (D2, D3):
        axis = get3(state, i, k)
        put3(state, i, k, add(axis, cross(turn, axis)))


@kernel
def close(state, ends, bodies, hinges, held, supported, b, w, open_, largest, step):
    """Move the particles of all hinges by a step, and close the hinges at its end.

    Raises largest (1, 4, lanes), fields as in layout.py, by what the last round leaves open.
    """
    open_[:] = True
    rate = 1.0 / step
    for n in range(ROUNDS):
        for h in range(w.shape[0]):
            if open_[h]:
                on, rows = (ends[2 * h], ends[2 * h + 1]), (2 * h, 2 * h + 1)
                if n > 0:
                    restore(state, on, rows, b)
                move(state, on, rows, bodies, step)
        for h in range(w.shape[0]):
            if open_[h]:
                point, gap, ep, eq = gaps(state, ends, bodies, h)
                put3(w, h, OFF, gap)
                store(w, h, OFF + 3, ep)
                store(w, h, OFF + 4, eq)
                off = sub(point, get3(hinges, h, PLACE))
                put3(w, h, OFF + 5, times(get3(hinges, h, HELD), off))
                if n == 0:
                    for k in range(8):
                        missed = rate * load(w, h, OFF + k) + load(w, h, MISSED + k)
                        store(w, h, MISSED + k, missed)
        find_impulses(hinges, held, supported, bodies, b, w, open_, -rate)
        left = False
        for h in range(w.shape[0]):
            if open_[h]:
                far = distance(w, h)
                open_[h] = any_negative(far)
                if open_[h] and n + 1 == ROUNDS:
                    open_[h] = False
                    gap, ep, eq = get3(w, h, OFF), load(w, h, OFF + 3), load(w, h, OFF + 4)
                    note_open(dot(gap, gap), ep * ep + eq * eq, largest)
                if open_[h]:
                    left = True
                    for r in (2 * h, 2 * h + 1):
                        push_where_far(state, ends[r], r, b, far)
        if not left:
            break
    for h in range(w.shape[0]):
        nudge(state, (ends[2 * h], ends[2 * h + 1]), (2 * h, 2 * h + 1), b, step)


@kernel
def distance(w, h):
    """Negative where what is in OFF of hinge h is too much for `nudge`."""
    gap, off = get3(w, h, OFF), get3(w, h, OFF + 5)
    ep, eq = load(w, h, OFF + 3), load(w, h, OFF + 4)
    far = 1.0 - (dot(gap, gap) + dot(off, off)) * (1.0 / COARSE_GAP**2)
    tilt = 1.0 - (ep * ep + eq * eq) * (1.0 / COARSE_TILT**2)
    return where_negative(tilt, tilt, far)
