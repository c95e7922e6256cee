"""Coupled joints: impulses that close all of them at the end of the step (joint.py).

As for lone hinges (hinge_kernels.py): `solve` aims the impulses so that the gaps stay closed if
their rates do not change over the step, less what was missing so in the step before; `move` moves
the bodies and, only where a gap is large, goes back and aims better; at its end all gaps are closed
by small turns on top. All joints of a sample are solved together, and go the same rounds."""

from fpm.elements.joints import closure
from fpm.elements.joints import hinge_arrays as hinge
from fpm.elements.joints import joint_arrays as joint
from fpm.elements.joints.hinge_matrix import world_inverse
from fpm.elements.joints.joint_arrays import Joints
from fpm.elements.joints.joint_matrix import build, factorise, substitute
from fpm.elements.joints.joint_rows import find_gaps, find_rows, place
from fpm.elements.openings.opening_kernels import NEW
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, any_negative, load, store, where_negative
from fpm.kernels.layout import ACCOUNTS, F, M, P, V, X
from fpm.kernels.rotation import frame, half_turn, turn_frame
from fpm.kernels.vectors import (
    add3,
    add_where,
    cross,
    dot,
    get3,
    get6,
    kernel,
    put3,
    put6,
    symmetric,
    times,
    to_global,
    to_local,
)


@hook(Joints)
def prepare(part, world, timing):
    """Kick the bodies of all joints, and let `solve` find the joints' impulses."""
    closure.clear(part.sums)
    kick_bodies(part, world.state, timing.kick)
    world.undecided[0] = 1
    for t in range(part.turn_at.shape[0]):
        store(part.turns.state, t, joint.TURN_IMPULSE, 0.0)
        store(part.turns.state, t, joint.IS_NEW_STEP, 1.0)
        store(part.turns.state, t, joint.STOPPED_RATE, 0.0)
        store(part.turns.state, t, joint.FIRST_CHANGE, 0.0)


@hook(Joints)
def solve(part, world, timing):
    """Find the impulses of all joints, with what is held now, and the rates they would give."""
    find_rows(part, world.state)
    build(part)
    factorise(part)
    find_stops(part, joint.STOPPED_RATE, joint.STOP_IMPULSE)
    find_stops(part, joint.FIRST_CHANGE, joint.FIRST_IMPULSE)
    find_rates(part, world.state)
    for t in range(part.turn_at.shape[0]):
        j = part.turn_at[t]
        r, turns = part.pattern.first[j], part.turns
        # By the opening, which counts whole turns: a step may take several.
        gap = load(turns.angles, turns.hinge[t], NEW) - load(turns.state, t, joint.TARGET)
        gap = (1.0 / timing.step) * where_negative(load(turns.state, t, joint.HOLDS), gap, 0.0)
        store(part.rows, r, joint.RESIDUAL, load(part.rows, r, joint.RESIDUAL) + gap)
    find_impulses(part, -1.0)
    if part.turn_at.shape[0] > 0:
        store_rates(part, world.state)


@kernel
def find_stops(part, rate, impulse):
    """Store in field `impulse` of part.turns.state the impulses (N m s) that change the rates of
    held joint coordinates by those in field `rate` (rad/s), and no other rate of a condition."""
    rows, turns, is_any = part.rows, part.turns.state, False
    for t in range(part.turn_at.shape[0]):
        is_any = is_any or any_negative(-1.0 * absolute(load(turns, t, rate)))
    if is_any:
        for r in range(rows.shape[0]):
            store(rows, r, joint.IMPULSE, 0.0)
        for t in range(part.turn_at.shape[0]):
            r = part.pattern.first[part.turn_at[t]]
            store(rows, r, joint.IMPULSE, load(turns, t, rate))
        substitute(part)
        for t in range(part.turn_at.shape[0]):
            r = part.pattern.first[part.turn_at[t]]
            store(turns, t, impulse, load(rows, r, joint.IMPULSE))


@kernel
def store_rates(part, state):
    """Store in part.turns.state the rates (rad/s, m/s) of joint coordinates after the impulses
    (RATE), and the impulses (N m s, N s) that hold them (SOLVED_IMPULSE)."""
    b = part.body_scratch
    for s in range(part.particle.shape[0]):
        if not part.is_driven[s]:
            rotation = symmetric(get6(b, s, joint.INVERSE), get3(b, s, joint.MOMENT))
            add3(b, s, joint.SPIN, times(get3(part.bodies, s, joint.TURNS), rotation))
    for t in range(part.turn_at.shape[0]):
        j = part.turn_at[t]
        slot1, slot2 = part.slots[2 * j], part.slots[2 * j + 1]
        axis = to_global(frame(state, part.particle[slot1]), get3(part.sides, 2 * j, joint.AXIS))
        if part.types[j] == joint.SLIDE:
            _, _, end = place(part, state, j, 1)
            change = velocity(part, state, slot2, end) - velocity(part, state, slot1, end)
            rate = dot(axis, change)
        else:
            rate = dot(axis, get3(b, slot2, joint.SPIN) - get3(b, slot1, joint.SPIN))
        store(part.turns.state, t, joint.RATE, rate)
        is_old, free = 0.5 - load(part.turns.state, t, joint.IS_NEW_STEP), joint.FREE_RATE
        free_rate = where_negative(is_old, rate, load(part.turns.state, t, free))
        store(part.turns.state, t, free, free_rate)
        store(part.turns.state, t, joint.IS_NEW_STEP, 0.0)
        impulse = load(part.rows, part.pattern.first[j], joint.IMPULSE)
        store(part.turns.state, t, joint.SOLVED_IMPULSE, impulse)


@kernel
def velocity(part, state, s, point):
    """Return the velocity (m/s, 3) of a `point` (m, 3) of body s after the impulses found."""
    b, i = part.body_scratch, part.particle[s]
    v = get3(state, i, V)
    if not part.is_driven[s]:
        v = v + times(get3(part.bodies, s, joint.AXIS_IM), get3(b, s, joint.FORCE))
    return v + cross(get3(b, s, joint.SPIN), point - get3(state, i, X))


@kernel
def kick_bodies(part, state, kick):
    """Save the poses of all bodies at the start of a step, kick those that no drive moves over the
    time `kick` (s), and store their inverse inertias."""
    bodies, b = part.bodies, part.body_scratch
    for s in range(part.particle.shape[0]):
        i = part.particle[s]
        axes = frame(state, i)
        closure.save_pose(b, s, state, i, axes)
        put6(b, s, joint.INVERSE, world_inverse(axes, get3(bodies, s, joint.HIJ)))
        for k in (joint.ALL_FORCE, joint.ALL_MOMENT):
            put3(b, s, k, 0.0 * axes[1])
        if not part.is_driven[s]:
            v = get3(state, i, V) + kick * times(get3(bodies, s, joint.AXIS_IM), get3(state, i, F))
            put3(state, i, V, v)
            put3(state, i, P, kick * get3(state, i, M) + get3(state, i, P))
            for k in range(6):
                store(state, i, F + k, 0.0)


@kernel
def find_spin(part, state, s):
    """Return the angular velocity (rad/s, 3, global) of body s, about axes about which it may turn;
    if a drive moves it, of the last step. part: all joints (Joints); state: World.state."""
    b, turns = part.body_scratch, get3(part.bodies, s, joint.TURNS)
    if part.is_driven[s]:
        return get3(b, s, joint.LAST_SPIN)
    return times(turns, symmetric(get6(b, s, joint.INVERSE), get3(state, part.particle[s], P)))


@kernel
def find_rates(part, state):
    """Store in RESIDUAL of part.rows, for every constraint equation, the rate (m/s, rad/s) that
    impulses must cancel: the rate of its gap plus MISS. MISS is the sum over all earlier steps of
    the gap left after the motion, divided by the time step. part: Joints; state: World.state."""
    rows, b, pattern = part.rows, part.body_scratch, part.pattern
    for s in range(part.particle.shape[0]):
        put3(b, s, joint.SPIN, find_spin(part, state, s))
    for j in range(part.types.shape[0]):
        slot1, slot2 = part.slots[2 * j], part.slots[2 * j + 1]
        v, w1 = get3(state, part.particle[slot1], V), get3(b, slot1, joint.SPIN)
        w2 = 0.0 * w1
        if slot2 >= 0:
            v = v - get3(state, part.particle[slot2], V)
            w2 = get3(b, slot2, joint.SPIN)
        for r in range(pattern.first[j], pattern.first[j] + pattern.count[j]):
            turn = dot(get3(rows, r, joint.TURN1), w1) - dot(get3(rows, r, joint.TURN2), w2)
            rate = dot(get3(rows, r, joint.DIRECTION), v) + turn + load(rows, r, joint.MISS)
            store(rows, r, joint.RESIDUAL, rate)


@kernel
def push_all(part, state):
    """Apply the impulses of `find_impulses` to all bodies' momenta, and count them."""
    for s in range(part.particle.shape[0]):
        push(part, state, s)
    closure.count_joints(part, closure.ALL)


@kernel
def find_impulses(part, factor):
    """Find the IMPULSE of every row that changes the rate of its gap by `factor` times RESIDUAL,
    and their sums by body, FORCE (N s) and MOMENT (N m s)."""
    rows, b, pattern = part.rows, part.body_scratch, part.pattern
    for r in range(rows.shape[0]):
        store(rows, r, joint.IMPULSE, factor * load(rows, r, joint.RESIDUAL))
    substitute(part)
    for s in range(part.particle.shape[0]):
        zero = 0.0 * get3(b, s, hinge.OLD_X)
        put3(b, s, joint.FORCE, zero)
        put3(b, s, joint.MOMENT, zero)
    for j in range(part.types.shape[0]):
        slot1, slot2 = part.slots[2 * j], part.slots[2 * j + 1]
        force = 0.0 * get3(b, slot1, hinge.OLD_X)
        first, second = force, force
        for r in range(pattern.first[j], pattern.first[j] + pattern.count[j]):
            impulse = load(rows, r, joint.IMPULSE)
            force = force + impulse * get3(rows, r, joint.DIRECTION)
            first = first + impulse * get3(rows, r, joint.TURN1)
            second = second + impulse * get3(rows, r, joint.TURN2)
        add3(b, slot1, joint.FORCE, force)
        add3(b, slot1, joint.MOMENT, first)
        if slot2 >= 0:
            add3(b, slot2, joint.FORCE, -1.0 * force)
            add3(b, slot2, joint.MOMENT, -1.0 * second)


@kernel
def push(part, state, s):
    """Add the impulses FORCE and MOMENT of body s to its momenta, unless a drive moves it."""
    b, i = part.body_scratch, part.particle[s]
    force, moment = get3(b, s, joint.FORCE), get3(b, s, joint.MOMENT)
    if not part.is_driven[s]:
        add3(state, i, V, times(get3(part.bodies, s, joint.AXIS_IM), force))
        add3(state, i, P, moment)
    add3(b, s, joint.ALL_FORCE, force)
    add3(b, s, joint.ALL_MOMENT, moment)


@kernel
def push_where_far(part, state, s, condition):
    """Do as `push` in samples where `condition` (lanes) is below 0."""
    b, i = part.body_scratch, part.particle[s]
    inverse_mass = get3(part.bodies, s, joint.AXIS_IM)
    force, moment = get3(b, s, joint.FORCE), get3(b, s, joint.MOMENT)
    if not part.is_driven[s]:
        add_where(state, i, V, times(inverse_mass, force), condition)
        add_where(state, i, P, moment, condition)
    add_where(b, s, joint.ALL_FORCE, force, condition)
    add_where(b, s, joint.ALL_MOMENT, moment, condition)


@kernel
def move_bodies(part, state, repeat, step):
    """Move all bodies but driven ones by a `step` (s); repeat: from the step's start again."""
    b = part.body_scratch
    for s in range(part.particle.shape[0]):
        i = part.particle[s]
        if not part.is_driven[s]:
            if repeat:
                closure.restore_pose(b, s, state, i)
            put3(state, i, X, step * get3(state, i, V) + get3(state, i, X))
            axes = frame(state, i)
            rate = (0.5 * step) * get3(part.bodies, s, joint.HIJ)
            half = half_turn(to_local(axes, get3(state, i, P)), rate)
            turn_frame(state, i, axes, half)


@kernel
def nudge(part, state, s, step):
    """Do as `push`, and move body s by what that changes over a `step` (s), to close small gaps."""
    b, i = part.body_scratch, part.particle[s]
    push(part, state, s)
    if not part.is_driven[s]:
        shift = step * times(get3(part.bodies, s, joint.AXIS_IM), get3(b, s, joint.FORCE))
        put3(state, i, X, get3(state, i, X) + shift)
        spin = symmetric(get6(b, s, joint.INVERSE), get3(b, s, joint.MOMENT))
        closure.turn_little(state, i, step * spin)


@hook(Joints)
def move(part, world, timing):
    """Apply the impulses found, move the bodies, and close the joints at the end of the step, in up
    to ROUNDS (4) rounds. Gaps that the last round leaves raise part.peaks."""
    state, rows = world.state, part.rows
    push_all(part, state)
    inverse_step = 1.0 / timing.step
    most = closure.coarse(1.0, load(world.size, 0, 0))
    for n in range(hinge.ROUNDS):
        move_bodies(part, state, n > 0, timing.step)
        margin = 0.0 * load(state, 0, X) + 1.0
        for j in range(part.types.shape[0]):
            gap2, tilt2 = find_gaps(part, state, j)
            value = 1.0 - gap2 * (most * most)
            margin = where_negative(value, value, margin)
            value = 1.0 - tilt2 * (1.0 / hinge.COARSE_TILT**2)
            margin = where_negative(value, value, margin)
            if n + 1 == hinge.ROUNDS:
                closure.watch(part, gap2, tilt2)
        if n == 0:
            for r in range(rows.shape[0]):
                miss = inverse_step * load(rows, r, joint.RESIDUAL) + load(rows, r, joint.MISS)
                store(rows, r, joint.MISS, miss)
        find_impulses(part, -inverse_step)
        if n + 1 == hinge.ROUNDS or not any_negative(margin):
            break
        for s in range(part.particle.shape[0]):
            push_where_far(part, state, s, margin)
        closure.count_joints(part, margin)
    for s in range(part.particle.shape[0]):
        nudge(part, state, s, timing.step)
    closure.count_joints(part, closure.ALL)


@hook(Joints)
def look_back(part, world, timing):
    """Close the joints also one step before the start, in the first step only, by the momenta in
    world.start_state; there, held coordinates are where their motion began.

    The impulses of the first kick also close gaps of the third order in the step. As those of other
    steps do so before and after an instant alike, momenta change over an instant by what acts there
    alone. Reflected, those before the first lack it: the impulses mu that close the joints a step
    before the start as well belong to them; those of both kicks are twice the first less mu."""
    state, start, b = world.state, world.start_state, part.body_scratch
    for s in range(part.particle.shape[0]):
        i = part.particle[s]
        total = get3(start, i, P) + get3(state, i, P)  # that at the start
        if not part.is_driven[s]:
            spin = symmetric(get6(b, s, joint.INVERSE), total)
            total = times(get3(part.bodies, s, joint.TURNS), spin)
        put3(b, s, joint.SPIN, total)
    move_back(part, start, timing.step)
    for j in range(part.types.shape[0]):
        find_gaps(part, start, j)
    for t in range(part.turn_at.shape[0]):
        j = part.turn_at[t]
        r, slot1, slot2 = part.pattern.first[j], part.slots[2 * j], part.slots[2 * j + 1]
        first, second = part.particle[slot1], part.particle[slot2]
        v = (get3(start, first, V) + get3(state, first, V)) - get3(start, second, V)
        rate = dot(get3(part.rows, r, joint.DIRECTION), v - get3(state, second, V))
        rate = rate + dot(get3(part.rows, r, joint.TURN1), get3(b, slot1, joint.SPIN))
        rate = rate - dot(get3(part.rows, r, joint.TURN2), get3(b, slot2, joint.SPIN))
        store(part.rows, r, joint.RESIDUAL, load(part.rows, r, joint.RESIDUAL) + timing.step * rate)
    close_before(part, start, timing.step)


@kernel
def move_back(part, start, step):
    """Move all bodies from the start of the run to one `step` (s) before it, where `look_back`
    finds the joints' gaps; momenta stay. start: World.start_state."""
    for s in range(part.particle.shape[0]):
        i = part.particle[s]
        put3(start, i, X, get3(start, i, X) - step * get3(start, i, V))
        axes = frame(start, i)
        body = to_local(axes, get3(start, i, P))
        rate = -0.5 * step * get3(part.bodies, s, joint.HIJ)
        if part.is_driven[s]:  # by its spin, which stands there
            turn_frame(start, i, axes, (-0.5 * step) * body)
        else:
            turn_frame(start, i, axes, half_turn(body, rate))


@kernel
def close_before(part, start, step):
    """Change the momenta before the start so that the joints are closed one `step` (s) before it,
    too, by the gaps in RESIDUAL; then restore the positions at the start."""
    b = part.body_scratch
    find_impulses(part, -0.5 / step)
    for s in range(part.particle.shape[0]):
        i, force, moment = part.particle[s], get3(b, s, joint.FORCE), get3(b, s, joint.MOMENT)
        if not part.is_driven[s]:
            add3(start, i, V, -2.0 * times(get3(part.bodies, s, joint.AXIS_IM), force))
            add3(start, i, P, -2.0 * moment)
        add3(b, s, joint.ALL_FORCE, force)
        add3(b, s, joint.ALL_MOMENT, moment)
        closure.restore_pose(b, s, start, i)
    closure.count_joints(part, closure.ALL)


@hook(Joints)
def work_after(part, world, timing):
    """Add the work (J) that drives do against the joints' impulses in this step."""
    state, b = world.state, part.body_scratch
    total = 0.0 * load(state, 0, X)
    for s in range(part.particle.shape[0]):
        if part.is_driven[s]:
            i = part.particle[s]
            v, spin = get3(state, i, V), get3(state, i, P)
            force, moment = get3(b, s, joint.ALL_FORCE), get3(b, s, joint.ALL_MOMENT)
            # An impulse acts over the half steps before and after an instant, the first one only
            # after: its earlier part would belong to an instant that is recorded already.
            work = -1.0 * (dot(force, v) + dot(moment, spin))
            work_due = 0.0 * work
            if timing.kick == timing.step:
                work_due = dot(force, get3(b, s, joint.LAST_V))
                work_due = work_due + dot(moment, get3(b, s, joint.LAST_SPIN))
                work, work_due = 0.5 * work, -0.5 * work_due
            total = total + work + work_due
            store(b, s, joint.WORK_DUE, work_due)
            put3(b, s, joint.LAST_V, v)
            put3(b, s, joint.LAST_SPIN, spin)
    work_sum = load(world.accounts, 0, part.account)
    store(world.accounts, 0, part.account, work_sum + total)


@hook(Joints)
def work_due(part, world, energies, row, timing):
    """Add the work (J) of drives that `work_after` counted after the instant was recorded."""
    account = ACCOUNTS + part.account
    for s in range(part.particle.shape[0]):
        if part.is_driven[s]:
            work = load(energies, row, account) + load(part.body_scratch, s, joint.WORK_DUE)
            store(energies, row, account, work)


closure.report_gaps(Joints, find_gaps)


@hook(Joints)
def record_step(part, world, row, timing):
    record_sums(part.sums, part, row, timing, world)


@kernel
def record_sums(sums, part, row, timing, world):
    """Store the mean forces (N) and moments (N m) on both bodies of each joint at an instant, in
    the scene's order of joints. sums: part.sums, None if not counted. Left out: moments about axes
    about which a body cannot turn."""
    if sums is not None:
        rows, pattern, count = part.rows, part.pattern, part.types.shape[0]
        for j in range(count):
            force = 0.0 * get3(rows, 0, joint.DIRECTION)
            first, second = force, force
            for r in range(pattern.first[j], pattern.first[j] + pattern.count[j]):
                impulse = closure.mean_force(world, timing) * load(sums, r, 0)
                force = force + impulse * get3(rows, r, joint.DIRECTION)
                first = first + impulse * get3(rows, r, joint.TURN1)
                second = second + impulse * get3(rows, r, joint.TURN2)
            index = row * count + part.names[j]
            put3(part.forces, index, hinge.SIDE_FORCE1, force)
            put3(part.forces, index, hinge.SIDE_MOMENT1, first)
            put3(part.forces, index, hinge.SIDE_FORCE2, -1.0 * force)
            put3(part.forces, index, hinge.SIDE_MOMENT2, -1.0 * second)
