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
    moment); start_state: at the start of a recorded step; particles (n, 9, lanes): constants
    (inverse mass and inertias, mass, effects of the step's kick); free: indices of particles that
    no type moves; curve_start: first point of each curve; curve_time (s), curve_value: of all
    curves' points; point_particle, point_arm: particles and arms (m) of named points; accounts (1,
    a, lanes): energy given by the first `givers`, taken by the others (J); sums: for the balance.
    Of quantities that types watch: peaks: largest values so far; most: limits; unconditional:
    whether one is a failure's cause even where energy does not balance; watch_rows: first and end
    of its elements in `rows`. size: of the scene (m); rows (e, 1, lanes): of each element, once a
    run has failed, its energy (J) or watched quantity; undecided: 1 to find impulses again."""

    state: np.ndarray  # (n, STATE, lanes)
    start_state: np.ndarray  # (n, STATE, lanes) the state at the start of a step that is recorded
    particles: np.ndarray  # (n, PARTICLE, lanes)
    free: np.ndarray  # (f,) particles that no kind moves
    curve_start: np.ndarray  # (curves + 1,) first point of each curve
    curve_time: np.ndarray  # (points,) s
    curve_value: np.ndarray  # (points,)
    point_particle: np.ndarray  # (p,) particles of the named points
    point_arm: np.ndarray  # (p, 3, lanes)
    accounts: np.ndarray  # (1, a, lanes) energy given by the first ones, taken by the others (J)
    givers: int  # number of accounts that give
    sums: np.ndarray  # (1, SUMS, lanes)
    peaks: np.ndarray  # (1, w, lanes) largest so far of what kinds watch
    size: np.ndarray  # (1, 1, lanes) of the scene (m)
    most: np.ndarray  # (w, lanes) above which a lane fails
    unconditional: np.ndarray  # (w,) whether also where the energy does not balance
    watch_rows: np.ndarray  # (w, 2) first and end of the rows below of the kind that watches
    rows: np.ndarray  # (e, 1, lanes) how bad each element is, for the report of a failure
    undecided: np.ndarray  # (1,) 1 where the impulses of the step have to be found (again)


class Log(NamedTuple):
    """Log of the events of all element types. events (room, 3, lanes): time (s), number of the
    element, which of its events; count (lanes,): noted so far, also those without room; first:
    number of the first element of the type that writes; ends (2, 1, lanes): working memory."""

    events: np.ndarray  # (most events, 3, lanes) time, element, which of its events
    count: np.ndarray  # (lanes,) noted so far, also those that find no place
    first: int
    ends: np.ndarray  # (2, 1, lanes) a value before and after a step


class Record(NamedTuple):
    """Recorded arrays, with one row more than instants, for checks between. points: positions (m),
    velocities (m/s) of named points; energies (J): kinetic, balance, accounts, stored by type. Of
    the first failed check, lanes last: failed_step: its step, -1: none; failed_cause: watched
    quantity's index, -1: balance; failed_row: worst element, a row of World.rows; failed_balance
    (J); failed_peaks: World.peaks then. scale (lanes,): largest energy so far (J)."""

    points: np.ndarray  # ((instants + 1) p, POINT, lanes)
    energies: np.ndarray  # (instants + 1, ACCOUNTS + accounts + kinds that store, lanes)
    failed_step: np.ndarray  # (lanes,) step of the first failed check; -1: none
    failed_cause: np.ndarray  # (lanes,) what was watched and is too large; -1: the balance
    failed_row: np.ndarray  # (lanes,) the worst element, a row of World.rows; -1: none
    failed_balance: np.ndarray  # (lanes,) J
    failed_peaks: np.ndarray  # (w, lanes) World.peaks then
    scale: np.ndarray  # (lanes,) largest energy so far
