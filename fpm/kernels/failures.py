"""The search for lanes whose numbers can not be trusted, and for the element to blame."""

from fpm.kernels import hooks
from fpm.kernels.lanes import store
from fpm.kernels.layout import BALANCE, ENERGY_SIZE
from fpm.kernels.vectors import kernel

IMBALANCE = -1
"""Cause of a failure: no watched quantity, but the energy balance."""


@kernel
def find_failures(parts, world, record, row, n, tolerance):
    """Mark in `record` the samples that fail at step n; returns whether none is left running. A
    sample fails when its energy balance has an error above `tolerance` times the largest energy it
    has had so far, when a number is not finite, or when a watched quantity is above its limit.
    parts: arrays of each element type; world: solver state (World); record: of the run (Record);
    row: index of this step's energies in it; n: number of steps done."""
    count = 0
    for s in range(record.scale.shape[0]):
        if record.failed_step[s] >= 0:
            continue
        count += 1
        energy = world.sums[0, ENERGY_SIZE, s]
        if energy > record.scale[s]:
            record.scale[s] = energy
        is_balanced = abs(record.energies[row, BALANCE, s]) <= tolerance * record.scale[s]
        is_valid, cause = is_balanced, IMBALANCE
        for k in range(world.most.shape[0]):
            if not world.peaks[0, k, s] <= world.most[k, s]:
                is_valid = False
                # Mostly, only what happens while the energy balances is the cause.
                if is_balanced or world.unconditional[k]:
                    cause = k
        if not is_valid:
            record.failed_step[s] = n
            record.failed_cause[s] = cause
            record.failed_balance[s] = record.energies[row, BALANCE, s]
            # They grow on while other lanes run.
            for k in range(world.most.shape[0]):
                record.failed_peaks[k, s] = world.peaks[0, k, s]
            record.failed_row[s] = worst_row(parts, world, record.failed_cause[s], s)
            count -= 1
    return count == 0


@kernel
def worst_row(parts, world, cause, s):
    """Return the index in World.rows, one number an element, of the element to blame for the
    failure of sample s (its lane): that of the first number not finite, else of the largest; -1:
    none. cause: IMBALANCE, then the numbers are stored energies (J) of elements of all types; or
    index of a watched quantity, then what `list_excess` stores for elements of the type that
    watches it. parts: arrays of each element type; world: solver state, rows overwritten."""
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
