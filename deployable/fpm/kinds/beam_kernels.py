"""Forces, strain energy and strains of beam elements (theory: beam.py).

Elements whose axes are those of their particles, as on straight links, have arrays of their own
type, for which less is computed.
"""

from typing import NamedTuple

import numpy as np
from numba.extending import overload

from deployable.fpm.kernels.hooks import hook
from deployable.fpm.kernels.lanes import absolute, load, sqrt, store
from deployable.fpm.kernels.layout import D2, D3, F, M, X
from deployable.fpm.kernels.rotation import frame
from deployable.fpm.kernels.vectors import (
    INLINED,
    add3,
    cross,
    dot,
    get3,
    kernel,
    larger,
    put3,
    to_global,
)

# Constants of an element.
LENGTH = 0  # undeformed length
AXIAL = 1  # EA/l0
BEND_Z = 2  # 2 EIz/l0
BEND_Y = 3  # 2 EIy/l0
TWIST = 4  # GJ/l0
BEAM = 5

# Its axes in the frames of its particles: 2 and 3 at a, then at b (3 each).
A2, A3, B2, B3 = 0, 3, 6, 9
AXES = 12

# What the forces leave for the energy.
DIRECTION = 0  # of the chord (3)
INVERSE = 3  # of the length of the chord
FORCE = 4  # axial
CHORD = 5

BEND, STRAIN = 0, 1  # watched

SIXTH = 1.0 / 6.0


class StraightElements(NamedTuple):
    """Elements whose axes are those of their particles."""

    nodes: np.ndarray  # (m, 2) particles
    beams: np.ndarray  # (m, BEAM, lanes)
    chord: np.ndarray  # (m, CHORD, lanes)
    watched: np.ndarray  # (1, 2, lanes)
    rows: np.ndarray  # (m, 1, lanes)


class FramedElements(NamedTuple):
    """Elements with axes of their own."""

    nodes: np.ndarray
    beams: np.ndarray
    chord: np.ndarray
    watched: np.ndarray
    rows: np.ndarray
    axes: np.ndarray  # (m, AXES, lanes)


@kernel
def angle(s):
    """The angle of which s is the sine, to fifth order, and its derivative."""
    s2 = s * s
    return s * (1.0 + SIXTH * s2), 1.0 + 0.5 * s2


@kernel
def _own_axes(part, state, e):
    a, b = part.nodes[e, 0], part.nodes[e, 1]
    return get3(state, a, D2), get3(state, a, D3), get3(state, b, D2), get3(state, b, D3)


@kernel
def _framed_axes(part, state, e):
    one, two = frame(state, part.nodes[e, 0]), frame(state, part.nodes[e, 1])
    return (
        to_global(one, get3(part.axes, e, A2)),
        to_global(one, get3(part.axes, e, A3)),
        to_global(two, get3(part.axes, e, B2)),
        to_global(two, get3(part.axes, e, B3)),
    )


def end_axes(part, state, e):
    """Axes 2 and 3 of element e as its ends a and b carry them: a2, a3, b2, b3."""
    return _axes_for(type(part))(part, state, e)


def _axes_for(arrays: type):
    return _framed_axes if arrays is FramedElements else _own_axes


@overload(end_axes, jit_options=INLINED)
def _end_axes(part, state, e):
    chosen = _axes_for(part.instance_class)
    return lambda part, state, e: chosen(part, state, e)


@kernel
def find_chords(part, state):
    """Direction of every chord, inverse length and axial force."""
    for e in range(part.nodes.shape[0]):
        chord = get3(state, part.nodes[e, 1], X) - get3(state, part.nodes[e, 0], X)
        square = dot(chord, chord)
        # The root and the quotient run side by side.
        length = sqrt(square)
        inverse = length * (1.0 / square)
        put3(part.chord, e, DIRECTION, inverse * chord)
        store(part.chord, e, INVERSE, inverse)
        stretch = length - load(part.beams, e, LENGTH)
        store(part.chord, e, FORCE, load(part.beams, e, AXIAL) * stretch)


@kernel
def forces(part, world, now):
    """End forces and moments of all elements.

    Two passes, each with a short chain of operations, so that the processor works on several
    elements at once.
    """
    state, beams, chord = world.state, part.beams, part.chord
    find_chords(part, state)
    for e in range(part.nodes.shape[0]):
        a, b = part.nodes[e, 0], part.nodes[e, 1]
        a2, a3, b2, b3 = end_axes(part, state, e)
        n, inverse = get3(chord, e, DIRECTION), load(chord, e, INVERSE)
        sa2, sa3, sb2, sb3 = dot(n, a2), dot(n, a3), dot(n, b2), dot(n, b3)
        ta2, da2 = angle(sa2)
        ta3, da3 = angle(sa3)
        tb2, db2 = angle(sb2)
        tb3, db3 = angle(sb3)
        kz, ky = load(beams, e, BEND_Z), load(beams, e, BEND_Y)
        # Generalised forces: derivatives of the energy with respect to the four sines.
        ca2 = kz * (2.0 * ta2 + tb2) * da2
        cb2 = kz * (2.0 * tb2 + ta2) * db2
        ca3 = ky * (2.0 * ta3 + tb3) * da3
        cb3 = ky * (2.0 * tb3 + ta3) * db3
        ga = ca2 * a2 + ca3 * a3
        gb = cb2 * b2 + cb3 * b3
        along = (ca2 * sa2 + ca3 * sa3) + (cb2 * sb2 + cb3 * sb3)
        force = inverse * (ga + gb) + (load(chord, e, FORCE) - along * inverse) * n
        twist = 0.5 * (dot(b2, a3) - dot(b3, a2))
        moment = (0.5 * load(beams, e, TWIST) * twist) * (cross(a3, b2) - cross(a2, b3))
        add3(state, a, F, force)
        put3(state, b, F, get3(state, b, F) - force)
        add3(state, a, M, cross(n, ga) - moment)
        add3(state, b, M, cross(n, gb) + moment)


@kernel
def shape_of(part, state, e):
    """The sines between the chord of element e and axes 2 and 3 of its ends a and b, and the sine
    of its twist; the chord as the forces leave it.
    """
    a2, a3, b2, b3 = end_axes(part, state, e)
    n = get3(part.chord, e, DIRECTION)
    sines = (dot(n, a2), dot(n, a3), dot(n, b2), dot(n, b3))
    return sines, 0.5 * (dot(b2, a3) - dot(b3, a2))


@kernel
def strain_energy(part, e, sines, twist):
    """Strain energy (J) of element e, from its axial force and its shape."""
    ta2, ta3 = angle(sines[0])[0], angle(sines[1])[0]
    tb2, tb3 = angle(sines[2])[0], angle(sines[3])[0]
    force = load(part.chord, e, FORCE)
    return (
        0.5 * force * force / load(part.beams, e, AXIAL)
        + 0.5 * load(part.beams, e, TWIST) * twist * twist
        + load(part.beams, e, BEND_Z) * (ta2 * ta2 + ta2 * tb2 + tb2 * tb2)
        + load(part.beams, e, BEND_Y) * (ta3 * ta3 + ta3 * tb3 + tb3 * tb3)
    )


@kernel
def larger_strains(part, e, sines, twist, bend, strain):
    """The larger of bend (square of a sine) and strain, and those of element e by its
    axial force and its shape.

    The height is that of a rectangle with the element's radius of gyration, sqrt(12 I/A).
    """
    beams = part.beams
    sa2, sa3, sb2, sb3 = sines
    bend = larger(bend, sa2 * sa2 + sa3 * sa3)
    bend = larger(bend, sb2 * sb2 + sb3 * sb3)
    bend = larger(bend, twist * twist)
    # Angles between the ends, times the radii of gyration I/A = (2 EI/l0) / (2 EA/l0).
    turn2, turn3 = angle(sb2)[0] - angle(sa2)[0], angle(sb3)[0] - angle(sa3)[0]
    square = load(beams, e, BEND_Z) * turn2 * turn2 + load(beams, e, BEND_Y) * turn3 * turn3
    axial, rest = load(beams, e, AXIAL), load(beams, e, LENGTH)
    inverse = 1.0 / (axial * rest)
    stretch = absolute(load(part.chord, e, FORCE)) * inverse
    return bend, larger(strain, sqrt(1.5 * axial * square) * inverse + stretch)


@kernel
def stored(part, world):
    """Strain energy of all elements (J); their bend and strain are watched."""
    total = 0.0 * load(world.state, 0, X)
    bend, strain = 0.0 * load(part.watched, 0, BEND), load(part.watched, 0, STRAIN)
    for e in range(part.nodes.shape[0]):
        sines, twist = shape_of(part, world.state, e)
        bend, strain = larger_strains(part, e, sines, twist, bend, strain)
        total = total + strain_energy(part, e, sines, twist)
    store(part.watched, 0, BEND, larger(load(part.watched, 0, BEND), sqrt(bend)))
    store(part.watched, 0, STRAIN, strain)
    return total


@kernel
def list_energies(part, world):
    """Strain energy of each element (J)."""
    find_chords(part, world.state)
    for e in range(part.nodes.shape[0]):
        sines, twist = shape_of(part, world.state, e)
        store(part.rows, e, 0, strain_energy(part, e, sines, twist))


for _arrays in (StraightElements, FramedElements):
    hook(_arrays, "forces")(forces)
    hook(_arrays, "stored")(stored)
    hook(_arrays, "list_energies")(list_energies)
    hook(_arrays, "list_excess")(list_energies)  # the one with the most energy is to blame
