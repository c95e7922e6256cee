"""Recording: points, energies, the balance of the energies, and events: levels that are crossed."""

from fpm.kernels import hooks, layout
from fpm.kernels.lanes import absolute, any_negative, load, store, where_negative
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import cross, dot, get3, kernel, larger, put3, times, to_global, to_local

IMBALANCE_SHARE = 1e-6
"""Share of a kick's energy that counts in what the balance is compared with: far above rounding,
and so little that a growing mode, whose kicks are all that it has, is none the less noticed."""


@kernel
def keep(world):
    """Copy the motion of all particles to World.start_state, before a step that is recorded."""
    for i in range(world.state.shape[0]):
        for k in range(layout.START_FIELDS):
            store(world.start_state, i, k, load(world.state, i, k))


@kernel
def reflect(world):
    """Set momenta half a step before the start, in World.start_state, to those at the start less
    the change in the half step after it."""
    for i in range(world.state.shape[0]):
        for k in (layout.V, layout.P):
            momentum = 2.0 * get3(world.start_state, i, k) - get3(world.state, i, k)
            put3(world.start_state, i, k, momentum)


@kernel
def kinetic_energies(world):
    """Return the kinetic energy (J, lanes) at an instant, of the product of the velocities half a
    step before (start_state) and after it, which leapfrog conserves exactly with the potential
    energy, for linear systems; and half that of the change of momenta between, by which it is less
    than their mean."""
    state, start, particles = world.state, world.start_state, world.particles
    total = 0.0 * load(start, 0, layout.X)
    kick = total
    for i in range(start.shape[0]):
        # Held particles have no inverse mass: drives add the energy of those that they move.
        inertia = load(particles, i, layout.IM) * load(particles, i, layout.MASS)
        mass, inverse = load(particles, i, layout.MASS) * inertia, get3(particles, i, layout.IJ)
        linear = dot(get3(start, i, layout.V), get3(state, i, layout.V))
        axes = frame(start, i)
        p_before = to_local(axes, get3(start, i, layout.P))
        p_after = to_local(axes, get3(state, i, layout.P))
        total = total + 0.5 * (mass * linear + dot(p_before, times(inverse, p_after)))
        change, turn = get3(state, i, layout.V) - get3(start, i, layout.V), p_after - p_before
        kick = kick + 0.25 * (mass * dot(change, change) + dot(turn, times(inverse, turn)))
    return total, kick


@kernel
def record_before(parts, world, record, row):
    """Record what depends on positions at an instant: energies, and what each type records."""
    hooks.sum_energies(parts, world, record.energies, row)
    for k in range(world.accounts.shape[1]):
        store(record.energies, row, layout.ACCOUNTS + k, load(world.accounts, 0, k))
    hooks.work_of_place(parts, world, record.energies, row)
    hooks.record(parts, world, row)


@kernel
def record_after(parts, world, record, row, timing):
    """Record what depends on momenta: motion of points, kinetic energy, error of the balance."""
    start, state, points = world.start_state, world.state, record.points
    count = world.point_particle.shape[0]
    for n in range(count):
        i, index = world.point_particle[n], row * count + n
        axes = frame(start, i)
        arm = to_global(axes, get3(world.point_arm, n, 0))
        put3(points, index, layout.POSITION, get3(start, i, layout.X) + arm)
        v = 0.5 * (get3(start, i, layout.V) + get3(state, i, layout.V))
        p = 0.5 * (get3(start, i, layout.P) + get3(state, i, layout.P))
        turn = to_global(axes, times(get3(world.particles, i, layout.IJ), to_local(axes, p)))
        put3(points, index, layout.VELOCITY, v + cross(turn, arm))
    hooks.record_points(parts, world, points, row, timing)
    hooks.record_step(parts, world, row, timing)
    kinetic, kick = kinetic_energies(world)
    store(record.energies, row, layout.KINETIC, kinetic)
    hooks.work_due(parts, world, record.energies, row, timing)
    balance(world, record.energies, row, kinetic, kick)


@kernel
def find_supply(world):
    """Return the energy (J, lanes) given so far by all that gives. world: solver state (World)."""
    supply = 0.0 * load(world.sums, 0, layout.SUPPLY)
    for k in range(world.givers):
        supply = supply + load(world.accounts, 0, k)
    return supply


@kernel
def note_passage(world):
    """Raise World.sums to the energy that was given or taken back since the last check: pulses of
    drives, motors and loads pass between two checks. world: solver state (World), changed."""
    change = absolute(find_supply(world) - load(world.sums, 0, layout.SUPPLY))
    store(world.sums, 0, layout.PASSAGE, larger(load(world.sums, 0, layout.PASSAGE), change))


@kernel
def balance(world, energies, row, kinetic, kick):
    """Store the error of the energy balance (J) since the start in row `row` of `energies`: stored
    energy less work given, plus losses, less the same at the start. World.sums gets the scale of
    comparison (J): the `kinetic` energy of what no drive moves plus the sizes of all other stored
    energies (where such is zero is a matter of definition) plus 1e-6 of `kick`; or what passed
    since the last check (`note_passage`), if that is more, less `kick`, by which an instability
    outgrows it. kick: half the energy (J) of the change of momenta in the step."""
    stored_energy = load(energies, row, layout.KINETIC)
    size = kinetic  # of either sign: where a step is not stable, velocities alternate
    accounts = layout.ACCOUNTS + world.accounts.shape[1]
    for k in range(accounts, energies.shape[1]):
        energy = load(energies, row, k)
        stored_energy, size = stored_energy + energy, size + absolute(energy)
    total = stored_energy
    for k in range(layout.ACCOUNTS, layout.ACCOUNTS + world.givers):
        total = total - load(energies, row, k)
    for k in range(layout.ACCOUNTS + world.givers, accounts):
        total = total + load(energies, row, k)
    if row == 0:
        store(energies, row, layout.BALANCE, 0.0)
        store(world.sums, 0, layout.TOTAL, total)
        size = size + 0.5 * kick  # with that the kinetic energy of the given velocities
    else:
        store(energies, row, layout.BALANCE, total - load(world.sums, 0, layout.TOTAL))
    passage = load(world.sums, 0, layout.PASSAGE)
    store(world.sums, 0, layout.ENERGY_SIZE, larger(size + IMBALANCE_SHARE * kick, passage - kick))
    store(world.sums, 0, layout.SUPPLY, find_supply(world))
    store(world.sums, 0, layout.PASSAGE, 0.0 * passage)


@kernel
def note(log, lane, time, element, event):
    """Write an event of sample `lane` into a log of a type, or count it where that is full.
    element, event: indices in the type; time (s)."""
    n = log.count[lane]
    log.count[lane] = n + 1
    if n < log.events.shape[0]:
        log.events[n, 0, lane] = time
        log.events[n, 1, lane] = log.first + element
        log.events[n, 2, lane] = event


@kernel
def note_crossings(log, element, previous, value, timing):
    """Note event 1 where a value (lanes) became negative in this step from `previous`, 0 where it
    no longer is, at the time by linear interpolation."""
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
    """Return what to add to the overlap `new` (old: a step ago) of a spring that begins at 0, in
    the step in which it passes 0; else 0. From -b to s it does the work k s²/2, but the mean of the
    forces at both ends does k s (s + b)/2. Half of the difference is taken off now, half by the
    step that follows: the energy is kept to the third order in the step, not the second. For that
    step, a cable that turned slack pushes a little."""
    product = new * old
    return where_negative(product, 0.5 * product / absolute(new - old), 0.0)
