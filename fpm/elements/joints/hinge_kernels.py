"""Revolute hinges: impulses that close every hinge at the end of the step (hinge.py).

The matrix of impulses (hinge_matrix.py) serves three times: `aim`, by the rates of the gaps, less
what was missing so in the step before; `move` in rounds, only where gaps are large, each of which
gains three digits; and `move` at the end, always, by small turns on top. A sample whose gaps are
small is left alone in the rounds that others need: its numbers do not depend on theirs."""

from fpm.elements.joints import closure, hinge_matrix
from fpm.elements.joints import hinge_arrays as hinge
from fpm.elements.joints.hinge_arrays import Hinges
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import any_negative, load, store, where_negative
from fpm.kernels.layout import HALF, P, V, X
from fpm.kernels.rotation import frame, half_turn, turn_frame
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
    """Kick the particles of all hinges, and apply impulses that would keep the hinges closed if the
    rates of their gaps stayed as they are over the step."""
    closure.clear(part.sums)
    hinge_matrix.prepare_bodies(world, part, timing.kick)
    hinge_matrix.prepare_matrices(part)
    if part.has_supports:
        hinge_matrix.prepare_supports(part)
    aim(part, world.state)


@kernel
def aim(part, state):
    """Apply the impulses that would keep every hinge closed over the step if the rates of its gaps
    stayed as they are; changes momenta in `state` (World.state). part: all hinges (Hinges)."""
    ends, b, w = part.ends, part.body_scratch, part.hinge_scratch
    part.open[:] = True
    for h in range(w.shape[0]):
        row1, row2 = 2 * h, 2 * h + 1
        i, k = ends[row1], ends[row2]
        spin1 = symmetric(get6(b, row1, hinge.INVERSE), get3(state, i, P))
        spin2 = symmetric(get6(b, row2, hinge.INVERSE), get3(state, k, P))
        point = get3(state, i, V) + cross(spin1, get3(b, row1, hinge.GLOBAL_ARM))
        v2 = get3(state, k, V) + cross(spin2, get3(b, row2, hinge.GLOBAL_ARM))
        turn = spin1 - spin2
        put3(w, h, hinge.GOAL, (v2 - point) + get3(w, h, hinge.MISS))
        store(w, h, hinge.GOAL + 3, dot(turn, get3(w, h, hinge.PA)) + load(w, h, hinge.MISS + 3))
        store(w, h, hinge.GOAL + 4, dot(turn, get3(w, h, hinge.QA)) + load(w, h, hinge.MISS + 4))
        put3(w, h, hinge.GOAL + 5, get3(w, h, hinge.MISS + 5) - point)
    hinge_matrix.find_impulses(part)
    for r in range(ends.shape[0]):
        push(state, ends[r], r, b)
    for h in range(w.shape[0]):
        closure.count_hinge(part.sums, part, h, closure.ALL)


@kernel
def push(state, i, r, b):
    """Add DV (m/s) and DP (N m s) in row r of `b` (body_scratch) to the momenta of particle i."""
    add3(state, i, V, get3(b, r, hinge.DV))
    add3(state, i, P, get3(b, r, hinge.DP))


@kernel
def push_where_far(state, i, r, b, condition):
    """Do as `push` in samples where `condition` (lanes) is below 0."""
    for k, change in ((V, hinge.DV), (P, hinge.DP)):
        add_where(state, i, k, get3(b, r, change), condition)


@kernel
def gaps(part, state, h):
    """Return, global, the point of hinge h on body 1 (m); the gap (m), this point minus that on
    body 2; and the sines of the tilts of body 2's axis from body 1's about p and q, right-handed:
    the reference direction of body 1, and the direction normal to it and the axis."""
    row1, row2 = 2 * h, 2 * h + 1
    bodies, i, k = part.bodies, part.ends[row1], part.ends[row2]
    first, second = frame(state, i), frame(state, k)
    point = get3(state, i, X) + to_global(first, get3(bodies, row1, hinge.ARM))
    point2 = get3(state, k, X) + to_global(second, get3(bodies, row2, hinge.ARM))
    # The second's axis in the first's frame, where what it is compared with is constant.
    axis = to_local(first, to_global(second, get3(bodies, row2, hinge.AXIS)))
    ep, eq = -dot(get3(bodies, row1, hinge.NORMAL), axis), dot(get3(bodies, row1, hinge.REF), axis)
    return point, point - point2, ep, eq


@kernel
def move_bodies(part, world, repeat, step):
    """Move the bodies of open hinges by a `step` (s); repeat: from the step's start again."""
    state = world.state
    for r in range(part.ends.shape[0]):
        i = part.ends[r]
        if part.open[r // 2]:
            if repeat:
                closure.restore_pose(part.body_scratch, r, state, i)
            put3(state, i, X, step * get3(state, i, V) + get3(state, i, X))
            axes = frame(state, i)
            half = half_turn(to_local(axes, get3(state, i, P)), get3(world.particles, i, HALF))
            turn_frame(state, i, axes, half)


@kernel
def nudge(state, i, r, b, step):
    """Do as `push`, and move particle i by its effect over a step (s), to close small gaps."""
    push(state, i, r, b)
    put3(state, i, X, step * get3(b, r, hinge.DV) + get3(state, i, X))
    closure.turn_little(state, i, step * symmetric(get6(b, r, hinge.INVERSE), get3(b, r, hinge.DP)))


@kernel
def set_goal(part, state, h, rate):
    """Store in GOAL of hinge h the rates that its impulses must produce to close it in the time
    1/rate (s): of the gap, both tilts, and the distance from where its point is held."""
    w = part.hinge_scratch
    point, gap, ep, eq = gaps(part, state, h)
    put3(w, h, hinge.GOAL, -rate * gap)
    store(w, h, hinge.GOAL + 3, -rate * ep)
    store(w, h, hinge.GOAL + 4, -rate * eq)
    offset = point - get3(part.hinges, h, hinge.PLACE)
    put3(w, h, hinge.GOAL + 5, -rate * times(get3(part.hinges, h, hinge.SUPPORTS), offset))


@hook(Hinges)
def move(part, world, timing):
    """Move the particles of all hinges and close the hinges at the end of the step, in up to ROUNDS
    (4) rounds. Gaps that the last round leaves raise part.peaks."""
    state, ends, open_ = world.state, part.ends, part.open
    b, w = part.body_scratch, part.hinge_scratch
    open_[:] = True
    rate = 1.0 / timing.step
    for n in range(hinge.ROUNDS):
        move_bodies(part, world, n > 0, timing.step)
        for h in range(w.shape[0]):
            if open_[h]:
                set_goal(part, state, h, rate)
                if n == 0:
                    for k in range(8):
                        miss = load(w, h, hinge.MISS + k) + load(w, h, hinge.GOAL + k)
                        store(w, h, hinge.MISS + k, miss)
        hinge_matrix.find_impulses(part)
        is_open = False
        for h in range(w.shape[0]):
            if open_[h]:
                margin = distance(w, h, timing.step, load(world.size, 0, 0))
                open_[h] = any_negative(margin)
                if open_[h] and n + 1 == hinge.ROUNDS:
                    open_[h] = False
                    closure.watch(part, *gap_squares(part, state, h))
                if open_[h]:
                    is_open = True
                    push_where_far(state, ends[2 * h], 2 * h, b, margin)
                    push_where_far(state, ends[2 * h + 1], 2 * h + 1, b, margin)
                    closure.count_hinge(part.sums, part, h, margin)
        if not is_open:
            break
    for r in range(ends.shape[0]):
        nudge(state, ends[r], r, b, timing.step)
    for h in range(w.shape[0]):
        closure.count_hinge(part.sums, part, h, closure.ALL)


@hook(Hinges)
def look_back(part, world, timing):
    """Close the hinges also one step before the start (why: joint_kernels.look_back)."""
    start, ends, b = world.start_state, part.ends, part.body_scratch
    part.open[:] = True
    for r in range(ends.shape[0]):
        i = ends[r]
        put3(start, i, X, get3(start, i, X) - timing.step * get3(start, i, V))
        axes = frame(start, i)
        half = -1.0 * get3(world.particles, i, HALF)
        turn_frame(start, i, axes, half_turn(to_local(axes, get3(start, i, P)), half))
    for h in range(part.hinge_scratch.shape[0]):
        set_goal(part, start, h, 0.5 / timing.step)
    hinge_matrix.find_impulses(part)
    for r in range(ends.shape[0]):
        add3(start, ends[r], V, -2.0 * get3(b, r, hinge.DV))
        add3(start, ends[r], P, -2.0 * get3(b, r, hinge.DP))
        closure.restore_pose(b, r, start, ends[r])
    for h in range(part.hinge_scratch.shape[0]):
        closure.count_hinge(part.sums, part, h, closure.ALL)


@kernel
def gap_squares(part, state, h):
    """Return the squared gap of hinge h (m²), or distance from where it is held if larger, and the
    squared sine of the angle between its axes on both bodies."""
    point, gap, ep, eq = gaps(part, state, h)
    gap2 = dot(gap, gap)
    if part.has_supports:
        offset = point - get3(part.hinges, h, hinge.PLACE)
        offset = times(get3(part.hinges, h, hinge.SUPPORTS), offset)
        gap2 = larger(gap2, dot(offset, offset))
    return gap2, ep * ep + eq * eq


@kernel
def distance(w, h, step, size):
    """Return how far (lanes) hinge h is from needing another round, by its GOAL: 1 where it is
    closed, above 0 where a `nudge` suffices. step: time step (s); size: of the scene (m)."""
    most = closure.coarse(step, size)
    gap, gap2 = get3(w, h, hinge.GOAL), get3(w, h, hinge.GOAL + 5)
    ep, eq = load(w, h, hinge.GOAL + 3), load(w, h, hinge.GOAL + 4)
    margin = 1.0 - (dot(gap, gap) + dot(gap2, gap2)) * (most * most)
    tilt = 1.0 - (ep * ep + eq * eq) * (step / hinge.COARSE_TILT) ** 2
    return where_negative(tilt, tilt, margin)


closure.report_gaps(Hinges, gap_squares)


@hook(Hinges)
def record_step(part, world, row, timing):
    record_sums(part.sums, part.forces, row, timing, world)


@kernel
def record_sums(sums, forces, row, timing, world):
    """Store the mean forces (N) and moments (N m) of a step's impulses `sums` (h, 12, lanes; None:
    nothing is done) at an instant in `forces` ((instants + 1) h, 12, lanes)."""
    if sums is not None:
        count = sums.shape[0]
        for h in range(count):
            for k in range(hinge.SUMS):
                force = closure.mean_force(world, timing) * load(sums, h, k)
                store(forces, row * count + h, k, force)
