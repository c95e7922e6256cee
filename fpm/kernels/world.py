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
    """State of the solver: n particles, curves, and what element types share.

    state (n, 21, lanes): particles now (position, axes 2 and 3, velocity, angular momentum, force,
    moment); start_state (n, 21, lanes): at the start of a recorded step; particles (n, 9, lanes):
    constants (inverse mass and inertias, mass, effects of the step's kick); free (f,): indices of
    particles that no type moves; curve_start (c + 1,): index of the first point of each curve of
    time, and the end; curve_time (s), curve_value, curve_power (points, k), curve_sum (s),
    curve_kink (s): of all points, as in fpm/scenes/curve.py; point_particle (p,), point_arm (p, 3,
    lanes): particles and arms (m) of named points; accounts (1, a, lanes): energy (J) given so far
    by the first `givers`, taken by the others; sums (1, 4, lanes): total energy at t = 0, size of
    energies now, energy given up to the last check, its largest change since (J). Of w quantities
    that types watch: peaks (1, w, lanes): largest so far; most (w, lanes): limits;
    unconditional (w,): whether one is a failure's cause even where energy does not balance;
    watch_rows (w, 2): first and end of its elements in `rows`. size (1, 1, lanes): of the scene
    (m); resistance (1, 1, lanes): moments and forces over the impulses, divided by the kick, by
    which joints act on damped particles; rows (e, 1, lanes): of each element, once a run has
    failed, its energy (J) or watched quantity; undecided (1,): 1 where impulses are to be found
    (again)."""

    state: np.ndarray  # (n, STATE, lanes)
    start_state: np.ndarray  # (n, STATE, lanes) the state at the start of a step that is recorded
    particles: np.ndarray  # (n, PARTICLE, lanes)
    free: np.ndarray  # (f,) particles that no kind moves
    curve_start: np.ndarray  # (curves + 1,) first point of each curve
    curve_time: np.ndarray  # (points,) s
    curve_value: np.ndarray  # (points,)
    curve_power: np.ndarray  # (points, k) of the fraction, in the piece after each point
    curve_sum: np.ndarray  # (points,) integral from 0 on
    curve_kink: np.ndarray  # (points,) time of the first kink from each point on
    point_particle: np.ndarray  # (p,) particles of the named points
    point_arm: np.ndarray  # (p, 3, lanes)
    accounts: np.ndarray  # (1, a, lanes) energy given by the first ones, taken by the others (J)
    givers: int  # number of accounts that give
    sums: np.ndarray  # (1, SUMS, lanes)
    peaks: np.ndarray  # (1, w, lanes) largest so far of what kinds watch
    size: np.ndarray  # (1, 1, lanes) of the scene (m)
    resistance: np.ndarray  # (1, 1, lanes) 1, or by damping more
    most: np.ndarray  # (w, lanes) above which a lane fails
    unconditional: np.ndarray  # (w,) whether also where the energy does not balance
    watch_rows: np.ndarray  # (w, 2) first and end of the rows below of the kind that watches
    rows: np.ndarray  # (e, 1, lanes) each element's watched quantity, for the report of a failure
    undecided: np.ndarray  # (1,) 1 where the impulses of the step have to be found (again)


class Log(NamedTuple):
    """Log of the events of all element types. events (room, 3, lanes): time (s), index of the
    element among all that have events, index of the event in its type's `events`; count (lanes,):
    noted so far, also those without room; first: index of the first element of the type that
    writes; ends (2, 1, lanes): working memory."""

    events: np.ndarray  # (most events, 3, lanes) time, element, which of its events
    count: np.ndarray  # type: ignore[assignment]  # not tuple.count; (lanes,) noted so far
    first: int
    ends: np.ndarray  # (2, 1, lanes) a value before and after a step


class Record(NamedTuple):
    """Recorded arrays of a run: rows for each instant, then spare ones, which take what checks
    between instants need and are no results. points ((instants + 1) p, 6, lanes), p rows for each
    instant: positions (m), velocities (m/s) of the p named points; energies (instants + 1, k,
    lanes), J: kinetic, error of the balance, World.accounts, stored by each element type. Of each
    sample's first failed check, (lanes,): failed_step: its step, -1: none failed, and the rest does
    not count; failed_cause: index of the watched quantity above its limit or not finite, -1: energy
    balance; failed_row: index in World.rows of the element of which that quantity, or the stored
    energy, is largest or not finite, -1: none; failed_balance: error (J); failed_peaks (w, lanes):
    World.peaks of all w watched quantities; failed_scale: scale (J); failed_turns (n, lanes): angle
    (rad) by which each particle turned in that step; turns (n, 1, lanes): memory for it. quiet
    (lanes,): checks since then without such an error. scale (lanes,): largest energy
    so far (J); worst (lanes,): largest error of the balance that is noted (J), infinite once the
    sample has failed for good."""

    points: np.ndarray  # ((instants + 1) p, POINT, lanes)
    energies: np.ndarray  # (instants + 1, ACCOUNTS + accounts + kinds that store, lanes)
    failed_step: np.ndarray  # (lanes,) step of the first failed check; -1: none
    failed_cause: np.ndarray  # (lanes,) what was watched and is too large; -1: the balance
    failed_row: np.ndarray  # (lanes,) the worst element, a row of World.rows; -1: none
    failed_balance: np.ndarray  # (lanes,) J
    failed_peaks: np.ndarray  # (w, lanes) World.peaks then
    failed_scale: np.ndarray  # (lanes,) J
    failed_turns: np.ndarray  # (n, lanes) rad in a step
    turns: np.ndarray  # (n, 1, lanes)
    quiet: np.ndarray  # (lanes,) checks since the last with an error beyond the noted one's limit
    scale: np.ndarray  # (lanes,) largest energy so far
    worst: np.ndarray  # (lanes,) J; infinite: failed for good
