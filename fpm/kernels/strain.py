"""How far the elements are from small strains: what linear beam theory can bear."""

from fpm.kernels.beam import angle
from fpm.kernels.lanes import absolute, load, sqrt, where_negative
from fpm.kernels.layout import AXIAL, BEND_Y, BEND_Z, LENGTH
from fpm.kernels.vectors import kernel

MOST_BEND = 0.25
"""Largest sine of the angle between an element's chord and its ends, and of its twist. Whipping
links whose elements bend by so much are wrong by some percent (docs/extremes.md); beyond that the
energy still balances, on a wrong curve. A finer mesh bends less.
"""

MOST_STRAIN = 0.5
"""Largest strain at the surface of an element: its stretch, and half its height over the radius to
which it is bent. At 0.5 that radius is the height: no beam, whatever the mesh. (A bar curved to
such a radius is 8 % stiffer than a straight one: Winkler's theory of curved bars.)
"""


@kernel
def larger(x, y):
    """The larger of two lanes; x where y is not a number."""
    return where_negative(x - y, y, x)


@kernel
def larger_strains(beams, chord, e, sines, twist, bend, strain):
    """The larger of bend (square of a sine) and strain, and those of element e by its
    axial force and its shape.

    The height is that of a rectangle with the element's radius of gyration, sqrt(12 I/A).
    """
    sa2, sa3, sb2, sb3 = sines
    bend = larger(bend, sa2 * sa2 + sa3 * sa3)
    bend = larger(bend, sb2 * sb2 + sb3 * sb3)
    bend = larger(bend, twist * twist)
    # Angles between the ends, times the radii of gyration I/A = (2 EI/l0) / (2 EA/l0).
    turn2, turn3 = angle(sb2)[0] - angle(sa2)[0], angle(sb3)[0] - angle(sa3)[0]
    square = load(beams, e, BEND_Z) * turn2 * turn2 + load(beams, e, BEND_Y) * turn3 * turn3
    axial, rest = load(beams, e, AXIAL), load(beams, e, LENGTH)
    inverse = 1.0 / (axial * rest)
    stretch = absolute(load(chord, e, 4)) * inverse
    return bend, larger(strain, sqrt(1.5 * axial * square) * inverse + stretch)
