"""The time loop: leapfrog steps, recording, events and the watch over the energy balance.

Positions stand at whole steps, momenta at half steps (central differences; Verlet 1967). The first
kick is half a step long, so that the given velocities are those at t = 0.
"""

from fpm.kernels import hinge, joint, outside
from fpm.kernels.beam import beam_forces, framed_beam_forces
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import IJ, IM, F, M, P, V, X
from fpm.kernels.record import find_failures, keep, note_events, record_after, record_before
from fpm.kernels.rotation import frame, half_turn, normalise, put_turned
from fpm.kernels.vectors import axpy, get3, kernel, put3, scale, sub, to_local

NORMALISE_EVERY = 16
"""Steps between two corrections of the directors. Rounding changes them, and, where they turn by
tenths of a radian in a step, the ends of the series; the third as a product adds to that.
"""


@kernel
def kick_and_move(state, particles, i, kick, step):
    """Kick particle (or pair) i for `kick` s, move it for `step` s, clear its forces."""
    v = axpy(kick * load(particles, i, IM), get3(state, i, F), get3(state, i, V))
    put3(state, i, V, v)
    put3(state, i, X, axpy(step, v, get3(state, i, X)))
    p = axpy(kick, get3(state, i, M), get3(state, i, P))
    put3(state, i, P, p)
    axes = frame(state, i)
    put_turned(state, i, axes, half_turn(to_local(axes, p), get3(particles, i, IJ), step))
    for k in range(6):
        store(state, i, F + k, 0.0)


@kernel
def advance(state, particles, on, kick, step):
    """Kick the particles `on` (n,) for `kick` s, move them for `step` s, clear their forces."""
    for n in range(on.shape[0]):
        kick_and_move(state, particles, on[n], kick, step)


@kernel
def run(state, kept, model, record, step, steps, per_instant, per_check, tolerance):
    """Integrate `steps` steps of `step` s; returns the number of steps done.

    state, kept (n, STATE, lanes); model, record: model.py; every `per_check` steps the energy
    balance is checked against `tolerance` times the largest energy so far, every `per_instant`
    steps an instant is recorded. The run ends early when all lanes have failed.
    """
    # Taken out of the tuple once: each look into it inside the loop would count references.
    particles, nodes, beams, axes = model.particles, model.nodes, model.beams, model.axes
    chord, ends, bodies, hinges = model.chord, model.ends, model.bodies, model.hinges
    held, open_hinge = model.held, model.open_hinge
    body_scratch, hinge_scratch = model.body_scratch, model.hinge_scratch
    openings, spring_on, springs = model.openings, model.spring_on, model.springs
    contact_on, contacts = model.contact_on, model.contacts
    load_on, load_curve, loads = model.load_on, model.load_curve, model.loads
    drive_on, drive_curve, drives = model.drive_on, model.drive_curve, model.drives
    hold_on, hold_free = model.hold_on, model.hold_free
    starts, times, values = model.curve_start, model.curve_time, model.curve_value
    gravity, damping, work = model.gravity, model.damping, model.work
    events, event_count = record.events, record.event_count
    spare = record.energies.shape[0] - 1
    heavy, damped, framed = gravity.shape[0] > 0, damping.shape[0] > 0, axes.shape[0] > 0
    hinged, supported = hinges.shape[0] > 0, held.sum() > 0
    sprung = spring_on.shape[0] + contact_on.shape[0] > 0
    loaded, driven = load_on.shape[0] > 0, drive_on.shape[0] > 0
    free, half = model.free, 0.5 * step

    for n in range(steps + 1):
        t = n * step
        kick = half if n == 0 else step
        # Forces at t.
        if heavy:
            outside.gravity_forces(state, particles, gravity)
        if framed:
            framed_beam_forces(state, nodes, beams, axes, chord)
        else:
            beam_forces(state, nodes, beams, chord)
        if sprung:
            joint.update_openings(state, ends, bodies, openings)
            joint.spring_forces(state, ends, bodies, openings, spring_on, springs)
            joint.contact_forces(state, ends, bodies, openings, contact_on, contacts)
            if n > 0:
                note_events(openings, contact_on, events, event_count, t, step)
        if loaded:
            outside.load_forces(state, load_on, loads, load_curve, starts, times, values, t)
        # Work of the half step up to t: forces at t, velocities of its middle.
        if n > 0:
            if loaded:
                outside.add_load_work(
                    work, state, particles, load_on, loads, load_curve, starts, times, values,
                    t, half,
                )  # fmt: skip
            if driven:
                outside.add_drive_work(
                    work, state, drive_on, drives, drive_curve, starts, times, values,
                    t - half, half,
                )  # fmt: skip
        check = n % per_check == 0
        row = n // per_instant if n % per_instant == 0 else spare
        if n % NORMALISE_EVERY == 0:
            normalise(state)
        if check:
            keep(state, kept)
            record_before(state, model, row, record)
        # Momenta to t + step/2, positions to t + step; the forces are used up.
        if driven:
            outside.add_drive_work(
                work, state, drive_on, drives, drive_curve, starts, times, values, t + half, half
            )
        if hold_on.shape[0] > 0:
            outside.hold(state, hold_on, hold_free)
        if damped:
            outside.damp(state, damping, kick)
        if hinged:
            hinge.prepare(
                state, ends, bodies, hinges, held, supported, body_scratch, hinge_scratch,
                open_hinge, kick,
            )  # fmt: skip
        advance(state, particles, free, kick, step)
        if driven:
            outside.drive(
                state, drive_on, drives, drive_curve, starts, times, values, t + half, step
            )
        if hinged:
            hinge.close(
                state, ends, bodies, hinges, held, supported, body_scratch, hinge_scratch,
                open_hinge, record.largest, step,
            )  # fmt: skip
        # Work of the half step after t.
        if loaded:
            outside.add_load_work(
                work, state, particles, load_on, loads, load_curve, starts, times, values, t, half
            )
        if damped:
            outside.add_damping_work(work, state, particles, damping, step)
        if check:
            if n == 0:
                # The momenta half a step before the start, by reflection of those after it.
                for i in range(state.shape[0]):
                    for k in (V, P):
                        put3(kept, i, k, sub(scale(2.0, get3(kept, i, k)), get3(state, i, k)))
            record_after(state, kept, model, row, record, t)
            if find_failures(state, model, record, row, n, tolerance):
                return n
    return steps
