"""The time loop: leapfrog steps, recording, and the watch over the energy balance.

Positions stand at whole steps, momenta at half steps (central differences; Verlet 1967). The first
kick is half a step long, so that the given velocities are those at t = 0."""

from fpm.kernels import hooks
from fpm.kernels.failures import find_failures
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import HALF, IJ, IM, KICK, F, M, P, V, X
from fpm.kernels.record import keep, note_passage, record_after, record_before, reflect
from fpm.kernels.rotation import frame, half_turn, normalise, turn_frame
from fpm.kernels.vectors import get3, kernel, put3, to_local
from fpm.kernels.world import StepTime

NORMALISE_EVERY = 16
"""Steps between two corrections of the directors. Rounding changes them, and, where they turn by
tenths of a radian in a step, the ends of the series; the third as a product adds to that."""


@kernel
def time_particles(particles, timing):
    """Store for every particle in KICK the velocity (m/s) that a unit force gives it in the kick,
    in HALF (3) half the turns (rad) in the step by unit angular momenta; in the first two steps
    only, as the first kick is shorter."""
    for i in range(particles.shape[0]):
        store(particles, i, KICK, timing.kick * load(particles, i, IM))
        put3(particles, i, HALF, (0.5 * timing.step) * get3(particles, i, IJ))


@kernel
def kick_and_move(state, particles, i, timing):
    """Add the impulses of the step's forces to particle i, move and turn it, and clear them."""
    carry(state, i, load(particles, i, KICK) * get3(state, i, F) + get3(state, i, V), timing.step)
    turn(state, particles, i, timing.kick * get3(state, i, M) + get3(state, i, P))


@kernel
def carry(state, i, v, step):
    """Store velocity v (m/s) of particle i, and move it by a step (s) with it."""
    put3(state, i, V, v)
    put3(state, i, X, step * v + get3(state, i, X))


@kernel
def turn(state, particles, i, p):
    """Store angular momentum p (N m s, global) of particle i, turn it by a step, and clear its
    forces. Return p and half the rotation vector (rad), along the particle's axes before."""
    put3(state, i, P, p)
    for k in range(6):
        store(state, i, F + k, 0.0)
    axes = frame(state, i)
    body = to_local(axes, p)
    half = half_turn(body, get3(particles, i, HALF))
    turn_frame(state, i, axes, half)
    return body, half


@kernel
def run(parts, world, record, step, steps, output_steps, check_steps, tolerance):
    """Integrate `steps` steps of `step` s, fewer where all samples fail. record: arrays of the run,
    written; output_steps: between instants; check_steps: between checks that the error of the
    energy balance is at most `tolerance` times the largest energy."""
    state, particles, free, undecided = world.state, world.particles, world.free, world.undecided
    spare = record.energies.shape[0] - 1
    for n in range(steps + 1):
        timing = StepTime(n * step, step, 0.5 * step if n == 0 else step)
        hooks.forces(parts, world, timing)
        if n > 0:
            hooks.note_events(parts, world, timing)
            hooks.work_before(parts, world, timing)
        check = n % check_steps == 0
        row = n // output_steps if n % output_steps == 0 else spare
        if n % NORMALISE_EVERY == 0:
            normalise(state)
        if check:
            keep(world)
            record_before(parts, world, record, row)
        # Momenta to half a step later, positions to a step later; the forces are used up.
        if n < 2:  # the first kick is shorter than the others
            time_particles(particles, timing)
        hooks.restrain(parts, world, timing)
        hooks.prepare(parts, world, timing)
        while undecided[0] != 0:
            undecided[0] = 0
            hooks.solve(parts, world, timing)
            hooks.decide(parts, world, timing)
        for k in range(free.shape[0]):
            kick_and_move(state, particles, free[k], timing)
        hooks.move(parts, world, timing)
        if n == 0:
            reflect(world)
            hooks.look_back(parts, world, timing)
        hooks.work_after(parts, world, timing)
        note_passage(world)
        if check:
            record_after(parts, world, record, row, timing)
            if find_failures(parts, world, record, row, n, tolerance):
                return


@kernel
def act(parts, world, timing):
    """Add the forces (N, N m) of all element types at timing.time, without a step: at the poses of
    slow motions (fpm/travel)."""
    hooks.forces(parts, world, timing)
