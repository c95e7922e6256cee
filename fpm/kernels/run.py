"""The time loop: leapfrog steps, recording, events and the watch over the energy balance.

Positions stand at whole steps, momenta at half steps (central differences; Verlet 1967). The first
kick is half a step long, so that the given velocities are those at t = 0.
"""

from fpm.kernels import hinge, joint, outside
from fpm.kernels.beam import beam_forces
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import IJ, IM, D, F, M, P, Q, V, X
from fpm.kernels.record import find_failures, keep, note_events, record_after, record_before
from fpm.kernels.rotation import get4, half_turn, put_rotation, turned
from fpm.kernels.vectors import axpy, get3, kernel, put3, scale, sub, to_local


@kernel
def advance(state, particles, kick, step):
    """Kick all particles for `kick` s, move them for `step` s, and clear their forces."""
    for i in range(state.shape[0]):
        inverse_mass = load(particles, i, IM)
        v = axpy(kick * inverse_mass, get3(state, i, F), get3(state, i, V))
        put3(state, i, V, v)
        put3(state, i, X, axpy(step, v, get3(state, i, X)))
        p = axpy(kick, get3(state, i, M), get3(state, i, P))
        put3(state, i, P, p)
        half = half_turn(to_local(state, i, D, p), get3(particles, i, IJ), step)
        put_rotation(state, i, turned(get4(state, i, Q), half))
        for k in range(6):
            store(state, i, F + k, 0.0)


@kernel
def forces(state, model, t):
    """Sum all forces and moments at the current positions."""
    if model.gravity.shape[0] > 0:
        outside.gravity_forces(state, model.particles, model.gravity)
    beam_forces(state, model.nodes, model.beams, model.axes)
    if model.spring_on.shape[0] + model.contact_on.shape[0] > 0:
        joint.update_openings(state, model.pairs, model.hinges, model.openings)
        joint.spring_forces(
            state, model.pairs, model.hinges, model.openings, model.spring_on, model.springs
        )
        joint.contact_forces(
            state, model.pairs, model.hinges, model.openings, model.contact_on, model.contacts
        )
    if model.load_on.shape[0] > 0:
        outside.load_forces(
            state, model.load_on, model.loads, model.load_curve,
            model.curve_start, model.curve_time, model.curve_value, t,
        )  # fmt: skip


@kernel
def outside_work(state, model, t, step):
    """Add half a step's work of loads and damping at t, with the velocities as they are."""
    half = 0.5 * step
    if model.load_on.shape[0] > 0:
        power = outside.load_power(
            state, model.particles, model.load_on, model.loads, model.load_curve,
            model.curve_start, model.curve_time, model.curve_value, t,
        )  # fmt: skip
        store(model.work, 0, 0, load(model.work, 0, 0) + half * power)
    if model.damping.shape[0] > 0:
        power = outside.damping_power(state, model.particles, load(model.damping, 0, 0))
        store(model.work, 0, 1, load(model.work, 0, 1) + half * power)


@kernel
def drive_work(state, model, middle, step):
    """Add half a step's work of the drives; `middle` (s) is the time of their velocities."""
    if model.drive_on.shape[0] > 0:
        power = outside.drive_power(
            state, model.drive_on, model.drives, model.drive_curve,
            model.curve_start, model.curve_time, model.curve_value, middle,
        )  # fmt: skip
        store(model.work, 0, 0, load(model.work, 0, 0) + 0.5 * step * power)


@kernel
def move(state, model, t, kick, step):
    """Kick for `kick` s by the forces at t, then move from t to t + step."""
    if model.hold_on.shape[0] > 0:
        outside.hold(state, model.hold_on, model.hold_free)
    if model.pairs.shape[0] > 0:
        hinge.prepare(state, model.pairs, model.hinges, model.supported, model.scratch)
    if model.damping.shape[0] > 0:
        outside.damp(state, 0.5 * kick * load(model.damping, 0, 0))
    advance(state, model.particles, kick, step)
    if model.drive_on.shape[0] > 0:
        outside.drive(
            state, model.drive_on, model.drives, model.drive_curve,
            model.curve_start, model.curve_time, model.curve_value, t + 0.5 * step, step,
        )  # fmt: skip
    if model.pairs.shape[0] > 0:
        hinge.close(state, model.pairs, model.hinges, model.supported, model.scratch, step)


@kernel
def run(state, kept, model, record, step, steps, per_instant, per_check, tolerance):
    """Integrate `steps` steps of `step` s; returns the number of steps done.

    state, kept (n, STATE, lanes); model, record: model.py; every `per_check` steps the energy
    balance is checked against `tolerance` times the largest energy so far, every `per_instant`
    steps an instant is recorded. The run ends early when all lanes have failed.
    """
    spare = record.energies.shape[0] - 1
    for n in range(steps + 1):
        t = n * step
        forces(state, model, t)
        if model.contact_on.shape[0] > 0 and n > 0:
            note_events(model, record.events, record.event_count, t, step)
        if n > 0:
            outside_work(state, model, t, step)
            drive_work(state, model, t - 0.5 * step, step)
        check = n % per_check == 0
        row = n // per_instant if n % per_instant == 0 else spare
        if check:
            keep(state, kept)
            record_before(state, model, row, record)
        # The force on driven particles is needed after the move, which clears it.
        drive_work(state, model, t + 0.5 * step, step)
        move(state, model, t, 0.5 * step if n == 0 else step, step)
        outside_work(state, model, t, step)
        if check:
            if n == 0:
                # The momenta half a step before the start, by reflection of those after it.
                for i in range(state.shape[0]):
                    for k in (V, P):
                        put3(kept, i, k, sub(scale(2.0, get3(kept, i, k)), get3(state, i, k)))
            record_after(state, kept, model, row, record)
            if find_failures(state, model, record, row, n, tolerance):
                return n
    return steps
