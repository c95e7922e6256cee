"""Revolute hinges: impulses that close every hinge at the end of the step (hinge.py).

The matrix of the impulses (hinge_matrix.py) is built at the start of the step and serves three
times:

1. `aim`: impulses that would close the hinge if the rates of its gaps stayed as they are over the
   step, less what was missing so in the step before. What is left is the change from step to step
   of a term of second order in the angle turned.
2. `move`, in rounds, only where that is much: particles move, and their gaps are closed. Each
   round gains a factor of about the angle turned in a step: three digits.
3. `move`, at the end, always: the gaps found then are closed by small turns on top, which gains
   three digits more, down to rounding.

A sample whose gaps are small is left alone in the rounds that other samples need: its numbers do
not depend on theirs.
"""

from fpm.elements.joints.closing import (
    ALL,
    clear,
    coarse,
    count_hinge,
    report_gaps,
    restore,
    turn_little,
    watch,
)
from fpm.elements.joints.hinge_arrays import (
    ARM,
    ASKED,
    AXIS,
    COARSE_TILT,
    DP,
    DV,
    GLOBAL_ARM,
    HELD,
    INVERSE,
    MISSED,
    NORMAL,
    PA,
    PLACE,
    QA,
    REF,
    ROUNDS,
    SUMS,
    Hinges,
)
from fpm.elements.joints.hinge_matrix import (
    find_impulses,
    prepare_bodies,
    prepare_matrices,
    prepare_supports,
)
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import any_negative, load, store, where_negative
from fpm.kernels.layout import HALF, P, V, X
from fpm.kernels.rotation import frame, half_turn, put_turned
from fpm.kernels.vectors import (
    add3,
    add_where,
    cross,
    dot,
    get3,
    get6,
    kernel,
    larger,
    put3,
    symmetric,
    times,
    to_global,
    to_local,
)


@hook(Hinges)
def prepare(part, world, timing):
    """Kick the particles of all hinges, and aim the impulses; all forces must be summed."""
    clear(part.sums)
    prepare_bodies(world, part, timing.kick)
    prepare_matrices(part)
    if part.supported:
        prepare_supports(part)
    aim(part, world.state)


@kernel
def aim(part, state):
    """Impulses that would keep every hinge closed if its rates did not change over the step."""
    ends, b, w = part.ends, part.body_scratch, part.hinge_scratch
    part.open[:] = True
    for h in range(w.shape[0]):
        one, two = 2 * h, 2 * h + 1
        i, k = ends[one], ends[two]
        spin1 = symmetric(get6(b, one, INVERSE), get3(state, i, P))
        spin2 = symmetric(get6(b, two, INVERSE), get3(state, k, P))
        point = get3(state, i, V) + cross(spin1, get3(b, one, GLOBAL_ARM))
        other = get3(state, k, V) + cross(spin2, get3(b, two, GLOBAL_ARM))
        turn = spin1 - spin2
        put3(w, h, ASKED, (other - point) + get3(w, h, MISSED))
        store(w, h, ASKED + 3, dot(turn, get3(w, h, PA)) + load(w, h, MISSED + 3))
        store(w, h, ASKED + 4, dot(turn, get3(w, h, QA)) + load(w, h, MISSED + 4))
        put3(w, h, ASKED + 5, get3(w, h, MISSED + 5) - point)
    find_impulses(part)
    for h in range(w.shape[0]):
        push(state, (ends[2 * h], ends[2 * h + 1]), (2 * h, 2 * h + 1), b)
        count_hinge(part.sums, part, h, ALL)


@kernel
def push(state, i, r, b):
    """Add DV and DP to the momenta of particles i, bodies r (pairs)."""
    add3(state, i, V, get3(b, r, DV))
    add3(state, i, P, get3(b, r, DP))


@kernel
def push_where_far(state, i, r, b, far):
    """The same in the lanes where `far` is negative; the others are not touched."""
    for k, change in ((V, DV), (P, DP)):
        add_where(state, i, k, get3(b, r, change), far)


@kernel
def gaps(part, state, h):
    """Hinge point of body 1, its gap (3) to that of 2, and the axis gap about p and q (rad)."""
    one, two = 2 * h, 2 * h + 1
    bodies, i, k = part.bodies, part.ends[one], part.ends[two]
    first, second = frame(state, i), frame(state, k)
    point = get3(state, i, X) + to_global(first, get3(bodies, one, ARM))
    other = get3(state, k, X) + to_global(second, get3(bodies, two, ARM))
    # The second's axis in the first's frame, where what it is compared with is constant.
    axis = to_local(first, to_global(second, get3(bodies, two, AXIS)))
    ep, eq = -dot(get3(bodies, one, NORMAL), axis), dot(get3(bodies, one, REF), axis)
    return point, point - other, ep, eq


@kernel
def move_bodies(state, particles, on, step):
    """Move the particles `on` (a pair) by a step, with their momenta."""
    put3(state, on, X, step * get3(state, on, V) + get3(state, on, X))
    axes = frame(state, on)
    half = half_turn(to_local(axes, get3(state, on, P)), get3(particles, on, HALF))
    put_turned(state, on, axes, half)


@kernel
def nudge(state, i, r, b, step):
    """Change the momenta of particles i, bodies r (pairs), by DV and DP; move them by that."""
    push(state, i, r, b)
    put3(state, i, X, step * get3(b, r, DV) + get3(state, i, X))
    turn_little(state, i, step * symmetric(get6(b, r, INVERSE), get3(b, r, DP)))


@kernel
def ask(part, state, h, rate):
    """Ask for what closes the gaps of hinge h within 1 / rate: of the point, the tilts, and from
    where it is held.
    """
    w = part.hinge_scratch
    point, gap, ep, eq = gaps(part, state, h)
    put3(w, h, ASKED, -rate * gap)
    store(w, h, ASKED + 3, -rate * ep)
    store(w, h, ASKED + 4, -rate * eq)
    off = point - get3(part.hinges, h, PLACE)
    put3(w, h, ASKED + 5, -rate * times(get3(part.hinges, h, HELD), off))


@hook(Hinges)
def move(part, world, timing):
    """Move the particles of all hinges by a step, and close the hinges at its end.

    What the last round leaves open is watched.
    """
    state, ends, open_ = world.state, part.ends, part.open
    b, w = part.body_scratch, part.hinge_scratch
    open_[:] = True
    rate = 1.0 / timing.step
    for n in range(ROUNDS):
        for h in range(w.shape[0]):
            if open_[h]:
                on = ends[2 * h], ends[2 * h + 1]
                if n > 0:
                    restore(b, (2 * h, 2 * h + 1), state, on)
                move_bodies(state, world.particles, on, timing.step)
        for h in range(w.shape[0]):
            if open_[h]:
                ask(part, state, h, rate)
                if n == 0:
                    for k in range(8):
                        store(w, h, MISSED + k, load(w, h, MISSED + k) + load(w, h, ASKED + k))
        find_impulses(part)
        left = False
        for h in range(w.shape[0]):
            if open_[h]:
                far = distance(w, h, timing.step, load(world.size, 0, 0))
                open_[h] = any_negative(far)
                if open_[h] and n + 1 == ROUNDS:
                    open_[h] = False
                    watch(part, *opened(part, state, h))
                if open_[h]:
                    left = True
                    for r in (2 * h, 2 * h + 1):
                        push_where_far(state, ends[r], r, b, far)
                    count_hinge(part.sums, part, h, far)
        if not left:
            break
    for h in range(w.shape[0]):
        nudge(state, (ends[2 * h], ends[2 * h + 1]), (2 * h, 2 * h + 1), b, timing.step)
        count_hinge(part.sums, part, h, ALL)


@hook(Hinges)
def look_back(part, world, timing):
    """Close the hinges half a step before the start as well (joint_kernels.py)."""
    kept, ends, b = world.start_state, part.ends, part.body_scratch
    part.open[:] = True
    for h in range(part.hinge_scratch.shape[0]):
        on = ends[2 * h], ends[2 * h + 1]
        put3(kept, on, X, get3(kept, on, X) - timing.step * get3(kept, on, V))
        axes = frame(kept, on)
        back = -1.0 * get3(world.particles, on, HALF)
        put_turned(kept, on, axes, half_turn(to_local(axes, get3(kept, on, P)), back))
        ask(part, kept, h, 0.5 / timing.step)
    find_impulses(part)
    for h in range(part.hinge_scratch.shape[0]):
        on, rows = (ends[2 * h], ends[2 * h + 1]), (2 * h, 2 * h + 1)
        add3(kept, on, V, -2.0 * get3(b, rows, DV))
        add3(kept, on, P, -2.0 * get3(b, rows, DP))
        restore(b, rows, kept, on)
        count_hinge(part.sums, part, h, ALL)


@kernel
def opened(part, state, h):
    """Squares of what a hinge is open by: of the gap of its point (m) or, if that is larger, its
    distance from where it is held, and of the angle between its axes (rad)."""
    point, gap, ep, eq = gaps(part, state, h)
    gap2 = dot(gap, gap)
    if part.supported:
        off = times(get3(part.hinges, h, HELD), point - get3(part.hinges, h, PLACE))
        gap2 = larger(gap2, dot(off, off))
    return gap2, ep * ep + eq * eq


@kernel
def distance(w, h, step, size):
    """Negative where what is ASKED of hinge h is too much for `nudge`; size (m) of the scene."""
    most = coarse(step, size)
    gap, off = get3(w, h, ASKED), get3(w, h, ASKED + 5)
    ep, eq = load(w, h, ASKED + 3), load(w, h, ASKED + 4)
    far = 1.0 - (dot(gap, gap) + dot(off, off)) * (most * most)
    tilt = 1.0 - (ep * ep + eq * eq) * (step / COARSE_TILT) ** 2
    return where_negative(tilt, tilt, far)


report_gaps(Hinges, opened)


@hook(Hinges)
def record_step(part, world, row, timing):
    """Record the constraint forces of the step, where they are counted."""
    record_sums(part.sums, part.forces, row, timing)


@kernel
def record_sums(sums, forces, row, timing):
    """The sums as forces."""
    if sums is not None:
        count = sums.shape[0]
        for h in range(count):
            for k in range(SUMS):
                store(forces, row * count + h, k, (1.0 / timing.kick) * load(sums, h, k))
