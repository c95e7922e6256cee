"""The arrays a run works on, as one named tuple; what a scene lacks is an array of no rows.

Integer arrays are the same for all lanes; the others are (rows, fields, lanes).
"""

from typing import NamedTuple

import numpy as np


class Model(NamedTuple):
    """Constants of the scene (fields: layout.py) and the small states that are not particles'."""

    particles: np.ndarray  # (n, PARTICLE, lanes)
    free: np.ndarray  # particles that neither a hinge nor a drive moves
    nodes: np.ndarray  # (m, 2) particles of the beam elements
    beams: np.ndarray  # (m, BEAM, lanes)
    axes: np.ndarray  # (m or 0, AXES, lanes)
    gravity: np.ndarray  # (1 or 0, 3, lanes)
    damping: np.ndarray  # (1 or 0, 1, lanes) rate, 1/s
    chord: np.ndarray  # (m, CHORD, lanes) scratch
    ends: np.ndarray  # (2h,) particles of the hinges: bodies 2h and 2h + 1 of hinge h
    bodies: np.ndarray  # (2h, BODY, lanes)
    hinges: np.ndarray  # (h, HINGE, lanes)
    held: np.ndarray  # (h, 3) 1 where the hinge point is held along a global axis
    body_scratch: np.ndarray  # (2h, BODY_SCRATCH, lanes)
    hinge_scratch: np.ndarray  # (h, HINGE_SCRATCH, lanes)
    open_hinge: np.ndarray  # (h,) scratch
    openings: np.ndarray  # (h, 2, lanes) now and one step ago
    spring_on: np.ndarray  # (s,) hinges
    springs: np.ndarray  # (s, 2, lanes) stiffness, rest
    contact_on: np.ndarray  # (c,) hinges
    contacts: np.ndarray  # (c, 1, lanes) stiffness
    load_on: np.ndarray  # (l,) particles
    load_curve: np.ndarray  # (l,) curves, -1: constant
    loads: np.ndarray  # (l, 9, lanes) force, moment, arm
    drive_on: np.ndarray  # (d,) particles
    drive_curve: np.ndarray  # (d,) curves
    drives: np.ndarray  # (d, 6, lanes) velocity, spin
    hold_on: np.ndarray  # (f,) particles held along some axes only
    hold_free: np.ndarray  # (f, 6, lanes) 1 where free, 0 where held
    curve_start: np.ndarray  # (curves + 1,) first point of each curve
    curve_time: np.ndarray  # (points,) s
    curve_value: np.ndarray  # (points,)
    point_on: np.ndarray  # (p,) particles of the named points
    point_arm: np.ndarray  # (p, 3, lanes)
    work: (
        np.ndarray
    )  # (2, 2, lanes) work of loads, energy taken by damping; total at t = 0, stored now
    element_energy: np.ndarray  # (m + s + c, 1, lanes) scratch for the report of a failure


class Record(NamedTuple):
    """What a run writes; one more row than instants, the last one for checks in between."""

    points: np.ndarray  # (instants + 1, 6 p, lanes) position and velocity of each point
    hinges: np.ndarray  # (instants + 1, h + 2, lanes) openings, largest gap, largest axis gap
    energies: np.ndarray  # (instants + 1, 7, lanes)
    events: np.ndarray  # (most events, 3, lanes) time, contact, 1 if it closes
    event_count: np.ndarray  # (lanes,)
    failed_step: np.ndarray  # (lanes,) step of the first failed check; -1: none
    failed_element: np.ndarray  # (lanes,)
    failed_balance: np.ndarray  # (lanes,) J
    scale: np.ndarray  # (lanes,) largest energy so far
    failed_cause: np.ndarray  # (lanes,) see record.py
    largest: np.ndarray  # (1, 4, lanes) largest bend, strain and gaps so far (layout.py)
    failed_largest: np.ndarray  # (4, lanes) the same when the lane failed
