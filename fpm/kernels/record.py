"""Recording, contact events, and the search for lanes whose energy balance broke."""

from fpm.kernels import energy, hinge
from fpm.kernels.beam import beam_energy, chords, framed_axes, own_axes, shape_of
from fpm.kernels.hinge_matrix import OFF
from fpm.kernels.joint import contact_energy, spring_energy, update_openings
from fpm.kernels.lanes import any_negative, load, store, where_negative
from fpm.kernels.layout import (
    BALANCE,
    CONTACT,
    DAMPING_WORK,
    IJ,
    KEPT,
    KINETIC,
    LARGEST_BEND,
    LARGEST_GAP,
    LARGEST_STRAIN,
    LARGEST_TILT,
    LOAD_WORK,
    SPRING,
    STRAIN,
    P,
    V,
    X,
)
from fpm.kernels.outside import curve_value
from fpm.kernels.rotation import frame
from fpm.kernels.strain import MOST_BEND, MOST_STRAIN, larger
from fpm.kernels.vectors import (
    add,
    cross,
    dot,
    get3,
    kernel,
    put3,
    scale,
    times,
    to_global,
    to_local,
)

UNBALANCED, TOO_COARSE, TOO_STRAINED, GAPING = range(4)
"""Causes of a failure; only what happens while the energy balances is put down to the strains."""

MOST_GAP = 1e-6
"""Gap (m) of a hinge point from which a hinge counts as open; it is below 1e-11 m as a rule, and
1e-7 m in single precision. It gapes when its particles turn too far in a step for its rounds.
"""

MOST_TILT = 1e-5
"""The same for the angle between its axes (rad)."""

TOUCH = 1e-9
"""Overlap (rad) from which faces count as shut: what the hinges leave open is below it, so a
linkage at rest at closure has no events. Faces that meet at 1 rad/s reach it within 1 ns.
"""


@kernel
def note_events(openings, contact_on, events, event_count, t, step):
    """Note the contacts that shut or opened since the last step, by linear interpolation."""
    for c in range(contact_on.shape[0]):
        h = contact_on[c]
        now = where_negative(load(openings, h, 0) + TOUCH, -1.0, 1.0)
        last = where_negative(load(openings, h, 1) + TOUCH, -1.0, 1.0)
        if any_negative(now * last):
            for s in range(event_count.shape[0]):
                over, before = openings[h, 0, s] + TOUCH, openings[h, 1, s] + TOUCH
                if (over < 0.0) != (before < 0.0):
                    n = event_count[s]
                    event_count[s] = n + 1
                    if n < events.shape[0]:
                        events[n, 0, s] = t - step * over / (over - before)
                        events[n, 1, s] = c
                        events[n, 2, s] = 1.0 if over < 0.0 else 0.0


@kernel
def keep(state, kept):
    """Copy what recording needs from the start of a step."""
    for i in range(state.shape[0]):
        for k in range(KEPT):
            store(kept, i, k, load(state, i, k))


@kernel
def record_before(state, model, row, record):
    """Record what belongs to the positions at an instant: energies, openings, gaps."""
    out = record.energies
    largest = record.largest
    strain = energy.strain_energy(state, model.nodes, model.beams, model.axes, model.chord, largest)
    store(out, row, STRAIN, strain)
    if model.spring_on.shape[0] + model.contact_on.shape[0] == 0:
        update_openings(state, model.ends, model.bodies, model.openings)
    springs = energy.spring_energies(state, model.openings, model.spring_on, model.springs)
    store(out, row, SPRING, springs)
    contacts = energy.contact_energies(state, model.openings, model.contact_on, model.contacts)
    store(out, row, CONTACT, contacts)
    work = load(model.work, 0, 0)
    if model.gravity.shape[0] > 0:
        work = work + energy.weight_work(state, model.particles, model.gravity)
    store(out, row, LOAD_WORK, work)
    store(out, row, DAMPING_WORK, load(model.work, 0, 1))
    count = model.hinges.shape[0]
    worst = 0.0 * work
    worst_axis = worst
    for h in range(count):
        store(record.hinges, row, h, load(model.openings, h, 0))
        _, gap, ep, eq = hinge.gaps(state, model.ends, model.bodies, h)
        size, tilt = dot(gap, gap), ep * ep + eq * eq
        worst, worst_axis = larger(worst, size), larger(worst_axis, tilt)
    worst, worst_axis = hinge.note_open(worst, worst_axis, largest)
    store(record.hinges, row, count, worst)
    store(record.hinges, row, count + 1, worst_axis)


@kernel
def record_driven(kept, model, row, record, t):
    """Record the velocities of points on driven particles: those prescribed at time t (s).

    Such a particle has no momenta of its own.
    """
    for n in range(model.point_on.shape[0]):
        i, first = model.point_on[n], True
        arm = to_global(frame(kept, i), get3(model.point_arm, n, 0))
        for k in range(model.drive_on.shape[0]):
            if model.drive_on[k] == i:
                if first:
                    v = get3(record.points, row, 6 * n + 3)
                    put3(record.points, row, 6 * n + 3, scale(0.0, v))
                    first = False
                factor = curve_value(
                    model.drive_curve[k], model.curve_start, model.curve_time, model.curve_value, t
                )
                spin = get3(model.drives, k, 3)
                v = scale(factor, add(get3(model.drives, k, 0), cross(spin, arm)))
                v = add(v, get3(record.points, row, 6 * n + 3))
                put3(record.points, row, 6 * n + 3, v)


@kernel
def record_after(state, kept, model, row, record, t):
    """Record what needs the momenta on both sides of an instant: points, kinetic energy, balance.

    kept: the state at the instant, with the momenta half a step before it; t (s): the instant.
    """
    for n in range(model.point_on.shape[0]):
        i = model.point_on[n]
        axes = frame(kept, i)
        arm = to_global(axes, get3(model.point_arm, n, 0))
        put3(record.points, row, 6 * n, add(get3(kept, i, X), arm))
        v = scale(0.5, add(get3(kept, i, V), get3(state, i, V)))
        p = scale(0.5, add(get3(kept, i, P), get3(state, i, P)))
        turn = to_global(axes, times(get3(model.particles, i, IJ), to_local(axes, p)))
        put3(record.points, row, 6 * n + 3, add(v, cross(turn, arm)))
    if model.drive_on.shape[0] > 0:
        record_driven(kept, model, row, record, t)
    out = record.energies
    kinetic = energy.kinetic_energy(state, kept, model.particles)
    store(out, row, KINETIC, kinetic)
    stored = kinetic + load(out, row, STRAIN) + load(out, row, SPRING) + load(out, row, CONTACT)
    total = stored - load(out, row, LOAD_WORK) + load(out, row, DAMPING_WORK)
    if row == 0:
        store(out, row, BALANCE, 0.0)
        store(model.work, 1, 0, total)
    else:
        store(out, row, BALANCE, total - load(model.work, 1, 0))
    store(model.work, 1, 1, stored)


@kernel
def find_failures(state, model, record, row, n, tolerance):
    """Mark the lanes whose balance is off at step n; True when no lane is left.

    A lane fails when energy came from nowhere (or went there) by more than `tolerance` times the
    largest energy it has held so far, when a number is not finite, when an element is bent or
    strained by more than linear beam theory bears, or when a hinge is open.
    """
    left = 0
    for s in range(record.scale.shape[0]):
        if record.failed_step[s] >= 0:
            continue
        left += 1
        stored = model.work[1, 1, s]
        if stored > record.scale[s]:
            record.scale[s] = stored
        balanced = abs(record.energies[row, BALANCE, s]) <= tolerance * record.scale[s]
        straight = record.largest[0, LARGEST_BEND, s] <= MOST_BEND * MOST_BEND
        slight = record.largest[0, LARGEST_STRAIN, s] <= MOST_STRAIN
        closed = record.largest[0, LARGEST_GAP, s] <= MOST_GAP
        closed = closed and record.largest[0, LARGEST_TILT, s] <= MOST_TILT
        if not (balanced and straight and slight and closed):
            record.failed_step[s] = n
            record.failed_balance[s] = record.energies[row, BALANCE, s]
            # They grow on while other lanes run.
            record.failed_largest[:, s] = record.largest[0, :, s]
            if not closed:
                record.failed_cause[s] = GAPING
                record.failed_element[s] = worst_hinge(state, model, s)
            else:
                if balanced:
                    record.failed_cause[s] = TOO_COARSE if slight else TOO_STRAINED
                record.failed_element[s] = worst_element(state, model, s, balanced)
            left -= 1
    return left == 0


@kernel
def worst_hinge(state, model, s):
    """Index of the hinge of lane s that is open the furthest."""
    out, worst = model.hinge_scratch, 0
    for h in range(model.hinges.shape[0]):
        _, gap, ep, eq = hinge.gaps(state, model.ends, model.bodies, h)
        gap2, tilt2 = dot(gap, gap), ep * ep + eq * eq
        # Either gap as a share of what is allowed; the field is scratch of the next step.
        store(out, h, OFF, gap2 * (1.0 / MOST_GAP**2) + tilt2 * (1.0 / MOST_TILT**2))
        if out[h, OFF, s] > out[worst, OFF, s]:
            worst = h
    return worst


@kernel
def worst_element(state, model, s, beams_only):
    """Index of the first element of lane s with an energy that is not finite, else the largest.

    Order: beams, springs, contacts. beams_only: the balance holds, and what is wrong is a bend.
    """
    out, m = model.element_energy, model.nodes.shape[0]
    chords(state, model.nodes, model.beams, model.chord)
    for e in range(m):
        if model.axes.shape[0] > 0:
            ends = framed_axes(state, model.axes, e, model.nodes[e, 0], model.nodes[e, 1])
        else:
            ends = own_axes(state, model.nodes[e, 0], model.nodes[e, 1])
        sines, twist = shape_of(model.chord, e, ends[0], ends[1], ends[2], ends[3])
        store(out, e, 0, beam_energy(model.beams, model.chord, e, sines, twist))
    for i in range(model.spring_on.shape[0]):
        value = spring_energy(model.openings, model.spring_on, model.springs, i)
        store(out, m + i, 0, value)
    m += model.spring_on.shape[0]
    for i in range(model.contact_on.shape[0]):
        value = contact_energy(model.openings, model.contact_on, model.contacts, i)
        store(out, m + i, 0, value)
    worst = 0
    for e in range(model.nodes.shape[0] if beams_only else out.shape[0]):
        if not abs(out[e, 0, s]) < float("inf"):
            return e
        if out[e, 0, s] > out[worst, 0, s]:
            worst = e
    return worst
