"""The search for lanes whose numbers can not be trusted, and for the element to blame."""

import math

from fpm.kernels import hooks
from fpm.kernels.lanes import sqrt, store
from fpm.kernels.layout import BALANCE, ENERGY_SIZE, HALF, KINETIC, P
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import dot, get3, kernel, times, to_local

IMBALANCE = -1
"""Cause of a failure: no watched quantity, but the energy balance."""


NEGLIGIBLE, GROWTH, EXCESS, QUIET = 0.1, 100.0, 10.0, 4
"""Share of the tolerance, by the largest energy of the whole run, below which an error of the
balance was none; growth of an error since it was noted, and its ratio to the energy so far,
above which it is an instability; and checks without one after which it is over."""

MOST_NEGATIVE = 1e5
"""Negative kinetic energy, over the largest energy, above which a motion grows and alternates: a
stable one reaches that where its step is less than 5e-6 below the limit."""


@kernel
def find_failures(parts, world, record, row, n, tolerance):
    """Note in `record` the samples that fail at step n; return whether all have failed for good: by
    an error of the energy balance above `tolerance` times the largest energy so far, a kinetic
    energy that is negative and far larger, a number not finite, or a watched quantity above its
    limit. An error of the balance is forgiven once it is over, as where a contact strikes, or
    negligible beside the energy held since, as where teeth with play first touch; it is final once
    it has grown. row: index of this step's energies."""
    count = 0
    for s in range(record.scale.shape[0]):
        if record.worst[s] == math.inf:
            continue
        count += 1
        energy = world.sums[0, ENERGY_SIZE, s]
        if energy > record.scale[s]:
            record.scale[s] = energy
        balance = record.energies[row, BALANCE, s]
        # An instability of linear springs keeps the balance, but velocities alternate.
        if n > 0 and record.energies[row, KINETIC, s] < -MOST_NEGATIVE * record.scale[s]:
            balance = record.energies[row, KINETIC, s]
        error = abs(balance)
        is_balanced = error <= tolerance * record.scale[s]
        is_valid, cause = is_balanced, IMBALANCE
        for k in range(world.most.shape[0]):
            if not world.peaks[0, k, s] <= world.most[k, s]:
                is_valid = False
                # Mostly, only what happens while the energy balances is the cause.
                if is_balanced or world.unconditional[k]:
                    cause = k
        if is_valid:
            is_small = error <= tolerance * record.failed_scale[s]
            record.quiet[s] = record.quiet[s] + 1 if is_small else 0
            # An instability that alternates has hardly an error now and then.
            is_over = record.quiet[s] >= QUIET
            # Nor does the rounding of energies that explode make an error negligible.
            largest = max(record.worst[s], error)
            if is_over or largest <= NEGLIGIBLE * tolerance * record.scale[s]:
                record.worst[s], record.failed_step[s] = 0.0, -1
            continue
        record.quiet[s] = 0
        if record.failed_step[s] < 0:
            record.failed_step[s] = n
            record.failed_cause[s] = cause
            record.failed_balance[s] = balance
            record.failed_scale[s] = record.scale[s]
            # They grow on while the run goes on.
            for k in range(world.most.shape[0]):
                record.failed_peaks[k, s] = world.peaks[0, k, s]
            for i in range(world.state.shape[0]):
                store(record.turns, i, 0, turn_in_step(world, i))
                record.failed_turns[i, s] = record.turns[i, 0, s]
            record.failed_row[s] = worst_row(parts, world, record.failed_cause[s], s)
        limit = min(GROWTH * abs(record.failed_balance[s]), EXCESS * record.scale[s])
        if cause == IMBALANCE and error <= limit:
            record.worst[s] = max(record.worst[s], error)
        else:
            record.worst[s] = math.inf
            count -= 1
    return count == 0


@kernel
def turn_in_step(world, i):
    """Return the angle (rad, lanes) by which particle i turns in a step."""
    body = to_local(frame(world.start_state, i), get3(world.start_state, i, P))
    half = times(get3(world.particles, i, HALF), body)
    return 2.0 * sqrt(dot(half, half))


@kernel
def worst_row(parts, world, cause, s):
    """Return the index in World.rows (overwritten) of the element to blame for the failure of
    sample s: of the first number not finite, else the largest; -1: none. cause: IMBALANCE, by
    stored energies, or index of a watched quantity."""
    rows = world.rows
    for e in range(rows.shape[0]):
        store(rows, e, 0, -1.0)
    first, end = 0, rows.shape[0]
    if cause == IMBALANCE:
        hooks.list_energies(parts, world)
    else:
        hooks.list_excess(parts, world)
        first, end = world.watch_rows[cause, 0], world.watch_rows[cause, 1]
    worst = IMBALANCE
    for e in range(first, end):
        if not abs(rows[e, 0, s]) < float("inf"):
            return e
        if rows[e, 0, s] >= 0.0 and (worst < 0 or rows[e, 0, s] > rows[worst, 0, s]):
            worst = e
    return worst
