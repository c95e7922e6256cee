"""Forces and strain energy of beam elements (theory: elements/beam.py)."""

from fpm.kernels.lanes import load, sqrt, store
from fpm.kernels.layout import AXIAL, BEND_Y, BEND_Z, D2, D3, LENGTH, TWIST, F, M, X
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import (
    add,
    axpy,
    cross,
    dot,
    get3,
    kernel,
    put3,
    scale,
    sub,
    to_global,
)

SIXTH = 1.0 / 6.0


@kernel
def angle(s):
    """The angle of which s is the sine, to fifth order, and its derivative."""
    s2 = s * s
    return s * (1.0 + SIXTH * s2), 1.0 + 0.5 * s2


@kernel
def own_axes(state, a, b):
    """Axes 2 and 3 of an element as its ends a and b carry them, where they are the particles'."""
    return get3(state, a, D2), get3(state, a, D3), get3(state, b, D2), get3(state, b, D3)


@kernel
def framed_axes(state, axes, e, a, b):
    """Axes 2 and 3 of element e as its ends carry them; axes (m, AXES, lanes) in their frames."""
    one, two = frame(state, a), frame(state, b)
    return (
        to_global(one, get3(axes, e, 0)),
        to_global(one, get3(axes, e, 3)),
        to_global(two, get3(axes, e, 6)),
        to_global(two, get3(axes, e, 9)),
    )


@kernel
def chords(state, nodes, beams, out):
    """Direction of every chord (3), inverse length and axial force into out (m, CHORD, lanes)."""
    for e in range(nodes.shape[0]):
        chord = sub(get3(state, nodes[e, 1], X), get3(state, nodes[e, 0], X))
        square = dot(chord, chord)
        # The root and the quotient run side by side.
        length = sqrt(square)
        inverse = length * (1.0 / square)
        put3(out, e, 0, scale(inverse, chord))
        store(out, e, 3, inverse)
        store(out, e, 4, load(beams, e, AXIAL) * (length - load(beams, e, LENGTH)))


@kernel
def add_forces(state, beams, chord, e, a, b, a2, a3, b2, b3):
    """Add the end forces and moments of element e, whose axes are given, to particles a and b."""
    n, inverse = get3(chord, e, 0), load(chord, e, 3)
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
    ga = axpy(ca2, a2, scale(ca3, a3))
    gb = axpy(cb2, b2, scale(cb3, b3))
    along = (ca2 * sa2 + ca3 * sa3) + (cb2 * sb2 + cb3 * sb3)
    force = axpy(inverse, add(ga, gb), scale(load(chord, e, 4) - along * inverse, n))
    twist = 0.5 * (dot(b2, a3) - dot(b3, a2))
    moment = scale(0.5 * load(beams, e, TWIST) * twist, sub(cross(a3, b2), cross(a2, b3)))
    put3(state, a, F, add(get3(state, a, F), force))
    put3(state, b, F, sub(get3(state, b, F), force))
    put3(state, a, M, add(get3(state, a, M), sub(cross(n, ga), moment)))
    put3(state, b, M, add(get3(state, b, M), add(cross(n, gb), moment)))


@kernel
def beam_forces(state, nodes, beams, chord):
    """Add all elements' forces and moments where their axes are the particles' (straight links).

    nodes (m, 2); beams (m, BEAM, lanes); chord (m, CHORD, lanes) scratch. Two passes, each with a
    short chain of operations, so that the processor works on several elements at once.
    """
    chords(state, nodes, beams, chord)
    for e in range(nodes.shape[0]):
        a, b = nodes[e, 0], nodes[e, 1]
        a2, a3, b2, b3 = own_axes(state, a, b)
        add_forces(state, beams, chord, e, a, b, a2, a3, b2, b3)


@kernel
def framed_beam_forces(state, nodes, beams, axes, chord):
    """The same for elements whose axes (m, AXES, lanes) differ from the particles'."""
    chords(state, nodes, beams, chord)
    for e in range(nodes.shape[0]):
        a, b = nodes[e, 0], nodes[e, 1]
        a2, a3, b2, b3 = framed_axes(state, axes, e, a, b)
        add_forces(state, beams, chord, e, a, b, a2, a3, b2, b3)


@kernel
def shape_of(chord, e, a2, a3, b2, b3):
    """The sines between the chord of element e and axes 2 and 3 of its ends (a2, a3, b2, b3), and
    the sine of its twist; chord (m, CHORD, lanes) as `chords` leaves it.
    """
    n = get3(chord, e, 0)
    sines = (dot(n, a2), dot(n, a3), dot(n, b2), dot(n, b3))
    return sines, 0.5 * (dot(b2, a3) - dot(b3, a2))


@kernel
def beam_energy(beams, chord, e, sines, twist):
    """Strain energy (J) of element e, from its axial force and its shape."""
    ta2, ta3 = angle(sines[0])[0], angle(sines[1])[0]
    tb2, tb3 = angle(sines[2])[0], angle(sines[3])[0]
    force = load(chord, e, 4)
    return (
        0.5 * force * force / load(beams, e, AXIAL)
        + 0.5 * load(beams, e, TWIST) * twist * twist
        + load(beams, e, BEND_Z) * (ta2 * ta2 + ta2 * tb2 + tb2 * tb2)
        + load(beams, e, BEND_Y) * (ta3 * ta3 + ta3 * tb3 + tb3 * tb3)
    )
