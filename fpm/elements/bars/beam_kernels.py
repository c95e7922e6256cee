"""Forces, strain energy and strains of beam elements (theory: beam.py).

Elements with the axes of their particles, as on straight links, have arrays of their own type."""

from typing import NamedTuple

import numpy as np
from numba.extending import overload

from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, load, sqrt, store
from fpm.kernels.layout import D2, D3, F, M, X
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import INLINE, add3, cross, dot, get3, kernel, larger, put3, to_global

# Constants of an element.
LENGTH = 0  # undeformed length
AXIAL = 1  # EA/l0
BEND_Z = 2  # EIz/(6 l0), for `angle`
BEND_Y = 3  # EIy/(6 l0)
TWIST = 4  # GJ/(4 l0), for `twist_of`
BEAM = 5
SHARES = (1.0, 1.0, 1 / 12, 1 / 12, 1 / 4)
"""Factor of each column of `Beams.stiffness` in these constants, so that kernels multiply less."""

# Its axes in the frames of its particles: 2 and 3 at a, then at b (3 each).
A2, A3, B2, B3 = 0, 3, 6, 9
AXES = 12

BEND, STRAIN = 0, 1  # watched


class StraightElements(NamedTuple):
    """Arrays of m beam elements (lanes: samples) whose local axes are their particles' axes, as on
    straight bars."""

    nodes: np.ndarray  # (m, 2) particles
    beams: np.ndarray  # (m, BEAM, lanes)
    peaks: np.ndarray  # (1, 2, lanes) largest bend (sine) and strain so far
    rows: np.ndarray  # (m, 1, lanes) energy of each (J)


class FramedElements(NamedTuple):
    """Arrays of m beam elements whose local axes are not their particles': those of
    StraightElements, and axes (m, 12, lanes): local axes 2 and 3 (three components each) at end a,
    then at end b, in the axes of the particle there."""

    nodes: np.ndarray
    beams: np.ndarray
    peaks: np.ndarray
    rows: np.ndarray
    axes: np.ndarray  # (m, AXES, lanes)


@kernel
def angle(s):
    """Return 6 th and 2 dth/ds of the angle th (rad) with the sine s (number or lanes), by th = s +
    s³/6, whose error is of the fifth order: of the ends' deflections, for their moments."""
    slope = s * s + 2.0
    return s * (slope + 4.0), slope


@kernel
def twist_of(a2, a3, b2, b3):
    """Return twice the sine of an element's twist, b2 . a3 - b3 . a2, by its unit axes 2 and 3 at
    the ends a and b (vectors in global components), normal to each other at either end."""
    return dot(b2 - a2, a3 + b3)


@kernel
def _element_axes(part, state, e):
    """Axes of an element of `StraightElements`, as `end_axes`."""
    a, b = part.nodes[e, 0], part.nodes[e, 1]
    return get3(state, a, D2), get3(state, a, D3), get3(state, b, D2), get3(state, b, D3)


@kernel
def _framed_axes(part, state, e):
    """Axes of an element of `FramedElements`, as `end_axes`."""
    frame1, frame2 = frame(state, part.nodes[e, 0]), frame(state, part.nodes[e, 1])
    return (
        to_global(frame1, get3(part.axes, e, A2)),
        to_global(frame1, get3(part.axes, e, A3)),
        to_global(frame2, get3(part.axes, e, B2)),
        to_global(frame2, get3(part.axes, e, B3)),
    )


def end_axes(part, state, e):
    """Return four unit vectors in global components: local axes 2 and 3 of element e at its end a,
    and at its end b. part: StraightElements or FramedElements; state: World.state."""
    return _axes_for(type(part))(part, state, e)


def _axes_for(arrays: type):
    return _framed_axes if arrays is FramedElements else _element_axes


@overload(end_axes, jit_options=INLINE)
def _end_axes(part, state, e):
    function = _axes_for(part.instance_class)
    return lambda part, state, e: function(part, state, e)


@kernel
def chord_of(part, state, e):
    """Return the chord of element e (unit vector from end a to b), inverse of its length (1/m), and
    axial force (N, tension above 0). part: Straight- or FramedElements; state: World.state."""
    chord = get3(state, part.nodes[e, 1], X) - get3(state, part.nodes[e, 0], X)
    length = sqrt(dot(chord, chord))
    inverse = 1.0 / length
    stretch = length - load(part.beams, e, LENGTH)
    return inverse * chord, inverse, load(part.beams, e, AXIAL) * stretch


@kernel
def forces(part, world, timing):
    """Add forces (N) and moments (N m) of all beam elements to their end particles. The chord of
    the next element is found beside the forces of each: its root and quotient take long."""
    state, beams = world.state, part.beams
    last = part.nodes.shape[0] - 1
    next_chord = chord_of(part, state, 0)
    for e in range(last + 1):
        n, inverse, axial = next_chord
        next_chord = chord_of(part, state, min(e + 1, last))
        axes = end_axes(part, state, e)
        twist = load(beams, e, TWIST) * twist_of(axes[0], axes[1], axes[2], axes[3])
        turns, slopes = bends_of(n, axes)
        push_ends(part, state, e, n, inverse, axes, slopes, (axial, twist, turns))


@kernel
def bends_of(n, axes):
    """Return, for the axes 2, 3 at end a and 2, 3 at end b (`end_axes`), six times the angles (rad)
    off the normal to the chord n, and twice the derivatives of these by their sines."""
    ta2, da2 = angle(dot(n, axes[0]))
    ta3, da3 = angle(dot(n, axes[1]))
    tb2, db2 = angle(dot(n, axes[2]))
    tb3, db3 = angle(dot(n, axes[3]))
    return (ta2, ta3, tb2, tb3), (da2, da3, db2, db3)


@kernel
def push_ends(part, state, e, n, inverse, axes, slopes, loads):
    """Add forces (N) and moments (N m) of element e to its end particles. n, inverse: its chord,
    and inverse of its length (1/m); axes, slopes: of `end_axes` and `bends_of`; loads: axial force
    (N), moment of its twist (N m), and six times the angles (rad) of its bending moments."""
    axial, twist, (ta2, ta3, tb2, tb3) = loads
    a, b = part.nodes[e, 0], part.nodes[e, 1]
    a2, a3, b2, b3 = axes
    da2, da3, db2, db3 = slopes
    moment = twist * (cross(a3, b2) - cross(a2, b3))
    kz, ky = load(part.beams, e, BEND_Z), load(part.beams, e, BEND_Y)
    # Generalised forces: derivatives of the energy with respect to the four sines.
    t2, t3 = ta2 + tb2, ta3 + tb3
    ca2, cb2 = kz * (t2 + ta2) * da2, kz * (t2 + tb2) * db2
    ca3, cb3 = ky * (t3 + ta3) * da3, ky * (t3 + tb3) * db3
    ga = ca2 * a2 + ca3 * a3
    gb = cb2 * b2 + cb3 * b3
    shear = inverse * (ga + gb)
    force = shear + (axial - dot(n, shear)) * n
    add3(state, a, F, force)
    put3(state, b, F, get3(state, b, F) - force)
    add3(state, a, M, cross(n, ga) - moment)
    add3(state, b, M, cross(n, gb) + moment)


@kernel
def shape_of(part, state, e):
    """Return the deformation of element e: axial force (N); sines of the angles by which the axes
    2, 3 at end a and at end b are off the normal to the chord; twice the sine of its twist."""
    a2, a3, b2, b3 = end_axes(part, state, e)
    n, _, force = chord_of(part, state, e)
    return force, (dot(n, a2), dot(n, a3), dot(n, b2), dot(n, b3)), twist_of(a2, a3, b2, b3)


@kernel
def strain_energy(part, e, shape):
    """Return the strain energy (J, lanes) of element e. shape: of `shape_of`."""
    force, sines, twist = shape
    ta2, ta3 = angle(sines[0])[0], angle(sines[1])[0]
    tb2, tb3 = angle(sines[2])[0], angle(sines[3])[0]
    return (
        0.5 * force * force / load(part.beams, e, AXIAL)
        + 0.5 * load(part.beams, e, TWIST) * twist * twist
        + load(part.beams, e, BEND_Z) * (ta2 * ta2 + ta2 * tb2 + tb2 * tb2) / 3.0
        + load(part.beams, e, BEND_Y) * (ta3 * ta3 + ta3 * tb3 + tb3 * tb3) / 3.0
    )


@kernel
def larger_strains(part, e, shape, bend, strain):
    """Return the maxima `bend` (squared sine of bend or twist) and `strain` (at the surface of the
    rectangle with the section's radii of gyration), raised to those of a `shape_of` element e."""
    beams = part.beams
    force, (sa2, sa3, sb2, sb3), twist = shape
    bend = larger(bend, sa2 * sa2 + sa3 * sa3)
    bend = larger(bend, sb2 * sb2 + sb3 * sb3)
    bend = larger(bend, 0.25 * twist * twist)
    # Angles between the ends (six times), by the radii of gyration I/A = (6 BEND) / AXIAL.
    turn2, turn3 = angle(sb2)[0] - angle(sa2)[0], angle(sb3)[0] - angle(sa3)[0]
    square = load(beams, e, BEND_Z) * turn2 * turn2 + load(beams, e, BEND_Y) * turn3 * turn3
    axial, rest = load(beams, e, AXIAL), load(beams, e, LENGTH)
    inverse = 1.0 / (axial * rest)
    stretch = absolute(force) * inverse
    return bend, larger(strain, sqrt(0.5 * axial * square) * inverse + stretch)


@kernel
def sum_energies(part, world):
    """Return the strain energy (J, lanes) of all elements; raise part.peaks to bend and strain."""
    total = 0.0 * load(world.state, 0, X)
    bend, strain = 0.0 * load(part.peaks, 0, BEND), load(part.peaks, 0, STRAIN)
    for e in range(part.nodes.shape[0]):
        shape = shape_of(part, world.state, e)
        bend, strain = larger_strains(part, e, shape, bend, strain)
        total = total + strain_energy(part, e, shape)
    store(part.peaks, 0, BEND, larger(load(part.peaks, 0, BEND), sqrt(bend)))
    store(part.peaks, 0, STRAIN, strain)
    return total


@kernel
def list_energies(part, world):
    """Store the strain energy (J) of each beam element in part.rows."""
    for e in range(part.nodes.shape[0]):
        store(part.rows, e, 0, strain_energy(part, e, shape_of(part, world.state, e)))


for _arrays in (StraightElements, FramedElements):
    hook(_arrays, "forces")(forces)
    hook(_arrays, "sum_energies")(sum_energies)
    hook(_arrays, "list_energies")(list_energies)
    hook(_arrays, "list_excess")(list_energies)  # the one with the most energy is to blame
