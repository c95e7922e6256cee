"""Tensions, energies, work and events of cables (theory: cable.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.opening_kernels import NEW, Openings, turn
from fpm.kernels.curves import curve_value, kick_mean
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, sqrt, store, where_negative
from fpm.kernels.layout import F, M, X
from fpm.kernels.record import edge, note_crossings
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import add3, cross, dot, get3, kernel, larger, put3, to_global
from fpm.kernels.world import Log

# Constants of a cable: N, m, m, m, rad, m (fields of cable.py).
NUMBERS = "stiffness", "rest", "reel", "radius", "start", "least"
EA, REST, REEL, RADIUS, OPENING, LEAST = range(6)
CABLE = 6

# Of the point at which a stretch begins; the last point of a cable has an arm only.
DIRECTION = 0  # of the stretch (3)
LENGTH = 3  # of the stretch
GLOBAL_ARM = 4  # (3)
PULL = 7  # force (N) of the stretch that moves the points
STRETCH = 8

# Of a cable, at the last forces and a step before.
LONGER = 0  # length less unstrained length (m)
LONGER_BEFORE = 1
UNSTRAINED = 2  # its length
UNSTRAINED_BEFORE = 3
WINCH, WINCH_BEFORE = 4, 5  # force (N) that the winch works against
SURPLUS, SURPLUS_BEFORE = 6, 7  # unstrained length at the instant, less its mean over the kick
STATE = 8

TAUT = 1e-9
"""Strain from which a cable counts as tight: one at rest without preload has no events."""

TINY = 1e-30
"""Metres, so that points that coincide have no direction instead of one that is not a number."""


class Cables(NamedTuple):
    """Arrays of all c cables (lanes: samples), one after the other, with p points; a stretch runs
    from a point to the next. The fields of CABLE, STRETCH and STATE stand above."""

    start: np.ndarray  # (c + 1,) first point of each
    particle: np.ndarray  # (p,) particles
    curve: np.ndarray  # (c,) index of the winch's curve; -1: none
    arms: np.ndarray  # (p, 3, lanes) from particles to points, in their frames (m)
    cables: np.ndarray  # (c, CABLE, lanes)
    stretches: np.ndarray  # (p, STRETCH, lanes)
    state: np.ndarray  # (c, STATE, lanes)
    account: int  # of the winches' work, in World.accounts
    peaks: np.ndarray  # (1, 2, lanes) largest crowding and drum ratio so far
    rows: np.ndarray  # (c, 1, lanes) the larger of both, of each
    log: Log
    track: np.ndarray  # ((instants + 1) c, 2, lanes) recorded tension (N) and length (m)
    stretch_track: np.ndarray  # ((instants + 1) p, 2, lanes) those of stretches
    drum: np.ndarray  # (c,) hinge of the drum; -1: none
    openings: Openings | None  # None: no drums


@kernel
def measure_path(part, state, c):
    """Measure cable c: stores directions and lengths (m) of its stretches now in part.stretches,
    and returns its whole length (m). part: Cables or RubbingCables; state: World.state."""
    first, last = part.start[c], part.start[c + 1] - 1
    total = 0.0 * load(part.cables, c, REST)
    for j in range(first, last + 1):
        i = part.particle[j]
        arm = to_global(frame(state, i), get3(part.arms, j, 0))
        put3(part.stretches, j, GLOBAL_ARM, arm)
        if j > first:
            corner = get3(state, part.particle[j - 1], X) + get3(part.stretches, j - 1, GLOBAL_ARM)
            chord = (get3(state, i, X) + arm) - corner
            length = sqrt(dot(chord, chord))
            put3(part.stretches, j - 1, DIRECTION, (1.0 / (length + TINY)) * chord)
            store(part.stretches, j - 1, LENGTH, length)
            total = total + length
    return total


@kernel
def find_unstrained_length(part, world, timing, c):
    """Return the unstrained length (m, lanes) of cable c outside drum and winch, of which it is a
    mean over the kick; store by how much it is more at timing.time."""
    mean, reel = kick_mean(world, part.curve[c], timing), load(part.cables, c, REEL)
    store(part.state, c, SURPLUS_BEFORE, load(part.state, c, SURPLUS))
    store(part.state, c, SURPLUS, (mean - curve_value(world, part.curve[c], timing.time)) * reel)
    return find_length_outside(part.openings, part, c, load(part.cables, c, REST) - mean * reel)


@kernel
def find_length_outside(openings, part, c, rest):
    """Return the unstrained length (m, lanes) of cable c outside its drum. openings: None without
    drums; rest: length (m) at the drum's opening at the start."""
    if openings is not None and part.drum[c] >= 0:
        turns = load(openings.angles, part.drum[c], NEW) - load(part.cables, c, OPENING)
        rest = rest - load(part.cables, c, RADIUS) * turns
    return rest


@kernel
def turn_drum(openings, part, state, c, pull):
    """Turn the joint of the drum of cable c by -r F. r: its radius; pull: F (N), the tension T (1 +
    e/2) where the cable is strained by e; openings: None without drums."""
    if openings is not None and part.drum[c] >= 0:
        turn(openings, state, part.drum[c], -1.0 * load(part.cables, c, RADIUS) * pull)


@kernel
def find_pull(part, world, timing, c):
    """Store elongation, unstrained length (m) and winch force (N) of cable c, without friction, in
    part.state, tension (N) in part.stretches. part: Cables; world: World; timing: StepTime (s)."""
    length = measure_path(part, world.state, c)
    store(part.state, c, LONGER_BEFORE, load(part.state, c, LONGER))
    store(part.state, c, UNSTRAINED_BEFORE, load(part.state, c, UNSTRAINED))
    store(part.state, c, WINCH_BEFORE, load(part.state, c, WINCH))
    rest = find_unstrained_length(part, world, timing, c)
    stretch, last = length - rest, load(part.state, c, LONGER_BEFORE)
    stiffness = load(part.cables, c, EA) / rest
    pull = stiffness * (where_negative(stretch, 0.0, stretch) + edge(stretch, last))
    store(part.state, c, LONGER, stretch)
    store(part.state, c, UNSTRAINED, rest)
    store(part.state, c, WINCH, pull * (1.0 + 0.5 * stretch / rest))
    for j in range(part.start[c], part.start[c + 1] - 1):
        store(part.stretches, j, PULL, pull)


@kernel
def pull_points(part, state, c):
    """Add the tensions of cable c (N) to its particles, at each point towards those beside it."""
    first, last = part.start[c], part.start[c + 1] - 1
    for j in range(first, last + 1):
        force = 0.0 * get3(part.stretches, j, DIRECTION)
        if j < last:
            force = force + load(part.stretches, j, PULL) * get3(part.stretches, j, DIRECTION)
        if j > first:
            pull = load(part.stretches, j - 1, PULL)
            force = force - pull * get3(part.stretches, j - 1, DIRECTION)
        add3(state, part.particle[j], F, force)
        add3(state, part.particle[j], M, cross(get3(part.stretches, j, GLOBAL_ARM), force))


@hook(Cables)
def forces(part, world, timing):
    for c in range(part.curve.shape[0]):
        find_pull(part, world, timing, c)
        pull_points(part, world.state, c)
        turn_drum(part.openings, part, world.state, c, load(part.state, c, WINCH))


@hook(Cables)
def note_events(part, world, timing):
    """Note which cables turned tight (event 0) or slack (1) in the step, and when."""
    for c in range(part.curve.shape[0]):
        old = load(part.state, c, LONGER_BEFORE) - TAUT * load(part.state, c, UNSTRAINED_BEFORE)
        new = load(part.state, c, LONGER) - TAUT * load(part.state, c, UNSTRAINED)
        old, new = old - load(part.state, c, SURPLUS_BEFORE), new - load(part.state, c, SURPLUS)
        note_crossings(part.log, c, old, new, timing)


@kernel
def work_of_winch(part, c):
    """Return the work (J, lanes) of cable c's winch in the step, above 0 where it takes it in."""
    reel_length = load(part.state, c, UNSTRAINED_BEFORE) - load(part.state, c, UNSTRAINED)
    return 0.5 * reel_length * (load(part.state, c, WINCH) + load(part.state, c, WINCH_BEFORE))


@hook(Cables)
def work_before(part, world, timing):
    work = load(world.accounts, 0, part.account)
    for c in range(part.curve.shape[0]):
        if part.curve[c] >= 0:
            work = work + work_of_winch(part, c)
    store(world.accounts, 0, part.account, work)


@kernel
def strain_of(part, c):
    """Return the strain of cable c at the last forces, 0 where slack. part: all cables (Cables)."""
    strain = load(part.state, c, LONGER) / load(part.state, c, UNSTRAINED)
    return where_negative(strain, 0.0, strain)


@kernel
def energy_of_cable(part, c):
    """Return the strain energy (J) of cable c without friction. part: all cables (Cables)."""
    strain = strain_of(part, c)
    return 0.5 * load(part.cables, c, EA) * load(part.state, c, UNSTRAINED) * strain * strain


@hook(Cables)
def energy_of(part, world, c):
    return energy_of_cable(part, c)


@kernel
def crowding_of(part, c):
    """Return the crowding of cable c: its elongation over the length of its shortest stretch, 0 if
    it is slack. A run fails above 1. part: arrays of all cables (Cables or RubbingCables)."""
    longer = where_negative(load(part.state, c, LONGER), 0.0, load(part.state, c, LONGER))
    most = 0.0 * longer
    for j in range(part.start[c], part.start[c + 1] - 1):
        most = larger(most, longer / (load(part.stretches, j, LENGTH) + TINY))
    return most


@kernel
def drum_ratio(part, c):
    """Return the least length that the drum of cable c may leave, over the length outside it now; 0
    without a drum. A run fails above 1. part: Cables or RubbingCables."""
    return load(part.cables, c, LEAST) / load(part.state, c, UNSTRAINED)


@kernel
def record_drum(openings, part, c):
    """Raise part.peaks to the drum ratio of cable c. openings: None without drums."""
    if openings is not None:
        store(part.peaks, 0, 1, larger(load(part.peaks, 0, 1), drum_ratio(part, c)))


@kernel
def record_stretch(part, j, row, tension):
    """Store `tension` (N) and length (m) of stretch j in part.stretch_track at an instant."""
    index = row * part.particle.shape[0] + j
    store(part.stretch_track, index, 0, tension)
    store(part.stretch_track, index, 1, load(part.stretches, j, LENGTH))


@kernel
def record_cable(part, c, row):
    """Store tension (N) and strained length (m) of cable c and of its stretches at an instant, and
    raise part.peaks to its crowding and drum ratio."""
    surplus, index = load(part.state, c, SURPLUS), row * part.curve.shape[0] + c
    strain = (load(part.state, c, LONGER) - surplus) / (load(part.state, c, UNSTRAINED) + surplus)
    tension = load(part.cables, c, EA) * where_negative(strain, 0.0, strain)
    store(part.track, index, 0, tension)
    store(part.track, index, 1, load(part.state, c, LONGER) + load(part.state, c, UNSTRAINED))
    store(part.peaks, 0, 0, larger(load(part.peaks, 0, 0), crowding_of(part, c)))
    for j in range(part.start[c], part.start[c + 1] - 1):
        record_stretch(part, j, row, tension)
    record_drum(part.openings, part, c)


@hook(Cables)
def record(part, world, row):
    """Store tensions (N) and lengths (m); raise part.peaks to crowding and drum ratio."""
    for c in range(part.curve.shape[0]):
        record_cable(part, c, row)


@hook(Cables)
def list_excess(part, world):
    """Store each cable's crowding, or its drum ratio if that is larger, in part.rows."""
    for c in range(part.curve.shape[0]):
        store(part.rows, c, 0, larger(crowding_of(part, c), drum_ratio(part, c)))
