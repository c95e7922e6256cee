"""Arrays of a run that all element types share, as named tuples.

Integer arrays are one for all lanes; others are (rows, fields, lanes), fields as in layout.py."""

from typing import NamedTuple

import numpy as np


class StepTime(NamedTuple):
    """Times of a step (s). time: of positions at its start; step: its length; kick: time over which
    forces act on momenta, `step`, but step / 2 in the first, as momenta are half a step behind."""

    time: float
    step: float
    kick: float


class World(NamedTuple):
    """State of the solver: n particles, curves, and what element types share; w quantities are
    watched."""

    state: np.ndarray  # (n, STATE, lanes)
    start_state: np.ndarray  # (n, STATE, lanes) the state at the start of a step that is recorded
    particles: np.ndarray  # (n, PARTICLE, lanes)
    free: np.ndarray  # (f,) particles that no kind moves
    curve_start: np.ndarray  # (curves + 1,) first point of each curve
    curve_time: np.ndarray  # (points,) s
    curve_value: np.ndarray  # (points,)
    curve_power: np.ndarray  # (points, k) of the fraction, after each point (scenes/curve.py)
    curve_sum: np.ndarray  # (points,) integral from 0 on (s)
    curve_kink: np.ndarray  # (points,) time of the first kink from each point on (s)
    point_particle: np.ndarray  # (p,) particles of the named points
    point_arm: np.ndarray  # (p, 3, lanes) arms to them (m)
    accounts: np.ndarray  # (1, a, lanes) energy given by the first ones, taken by the others (J)
    givers: int  # number of accounts that give
    sums: np.ndarray  # (1, SUMS, lanes) of energies (J), by layout.py
    peaks: np.ndarray  # (1, w, lanes) largest so far of what kinds watch
    size: np.ndarray  # (1, 1, lanes) of the scene (m)
    resistance: np.ndarray  # (1, 1, lanes) moments by impulses over the kick, of damped particles
    most: np.ndarray  # (w, lanes) above which a lane fails
    unconditional: np.ndarray  # (w,) whether also where the energy does not balance
    watch_rows: np.ndarray  # (w, 2) first and end of the rows below of the kind that watches
    rows: np.ndarray  # (e, 1, lanes) each element's energy (J) or watched quantity, after a failure
    undecided: np.ndarray  # (1,) 1 where the impulses of the step have to be found (again)


class Log(NamedTuple):
    """Log of the events of all element types."""

    events: np.ndarray  # (room, 3, lanes) time (s), element among all with events, which event
    count: np.ndarray  # type: ignore[assignment]  # not tuple.count; (lanes,) of events
    first: int  # index of the first element of the type that writes
    ends: np.ndarray  # (2, 1, lanes) a value before and after a step


class Record(NamedTuple):
    """Recorded arrays of a run: rows for each instant, then spare ones, which take what checks
    between instants need and are no results. `failed_...` are of each sample's first failed
    check."""

    points: np.ndarray  # ((instants + 1) p, POINT, lanes) m and m/s of the named points
    energies: np.ndarray  # (instants + 1, ACCOUNTS + accounts + kinds that store, lanes), J
    failed_step: np.ndarray  # (lanes,) step of the first failed check; -1: none
    failed_cause: np.ndarray  # (lanes,) what was watched and is too large; -1: the balance
    failed_row: np.ndarray  # (lanes,) the worst element, a row of World.rows; -1: none
    failed_balance: np.ndarray  # (lanes,) error of the balance, J
    failed_peaks: np.ndarray  # (w, lanes) World.peaks then
    failed_scale: np.ndarray  # (lanes,) `scale` then, J
    failed_turns: np.ndarray  # (n, lanes) by how much each particle turned in the step (rad)
    turns: np.ndarray  # (n, 1, lanes) memory for these
    quiet: np.ndarray  # (lanes,) checks since the last with an error beyond the noted one's limit
    scale: np.ndarray  # (lanes,) largest energy so far (J)
    worst: np.ndarray  # (lanes,) largest error of the balance (J); infinite: failed for good
