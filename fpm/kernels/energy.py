"""Energies of a scene at a recorded instant, sample by sample."""

from fpm.kernels.beam import beam_energy, framed_axes, own_axes, shape_of
from fpm.kernels.joint import contact_energy, spring_energy
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import IJ, IM, LARGEST_BEND, LARGEST_STRAIN, MASS, P, V, X
from fpm.kernels.rotation import frame
from fpm.kernels.strain import larger_strains
from fpm.kernels.vectors import dot, get3, kernel, times, to_local


@kernel
def kinetic_energy(state, kept, particles):
    """Kinetic energy (J) between the half steps before (`kept`) and after an instant.

    The product of the two half-step velocities is the form that leapfrog conserves exactly,
    together with the potential energy at the instant, for linear systems.
    """
    total = 0.0 * load(kept, 0, X)
    for i in range(kept.shape[0]):
        # Held particles have no inverse mass; their given motion carries no energy of the scene.
        moving = load(particles, i, IM) * load(particles, i, MASS)
        linear = dot(get3(kept, i, V), get3(state, i, V))
        axes = frame(kept, i)
        before = to_local(axes, get3(kept, i, P))
        after = times(get3(particles, i, IJ), to_local(axes, get3(state, i, P)))
        total = total + 0.5 * (load(particles, i, MASS) * moving * linear + dot(before, after))
    return total


@kernel
def strain_energy(state, nodes, beams, axes, chord, largest):
    """Sum over the beam elements (J); raises largest (1, 4, lanes), fields as in layout.py.

    chord (m, CHORD, lanes): as the forces at this instant left it.
    """
    sums = 0.0 * load(state, 0, X), load(largest, 0, LARGEST_BEND), load(largest, 0, LARGEST_STRAIN)
    # The choice inside the loop would cost more than the loop.
    if axes.shape[0] > 0:
        for e in range(nodes.shape[0]):
            ends = framed_axes(state, axes, e, nodes[e, 0], nodes[e, 1])
            sums = add_element(sums, beams, chord, e, ends)
    else:
        for e in range(nodes.shape[0]):
            ends = own_axes(state, nodes[e, 0], nodes[e, 1])
            sums = add_element(sums, beams, chord, e, ends)
    store(largest, 0, LARGEST_BEND, sums[1])
    store(largest, 0, LARGEST_STRAIN, sums[2])
    return sums[0]


@kernel
def add_element(sums, beams, chord, e, ends):
    """Energy, bend and strain of the elements so far with those of element e."""
    sines, twist = shape_of(chord, e, ends[0], ends[1], ends[2], ends[3])
    bend, strain = larger_strains(beams, chord, e, sines, twist, sums[1], sums[2])
    return sums[0] + beam_energy(beams, chord, e, sines, twist), bend, strain


@kernel
def spring_energies(state, openings, on, springs):
    """Sum over the torsion springs (J)."""
    total = 0.0 * load(state, 0, X)
    for i in range(on.shape[0]):
        total = total + spring_energy(openings, on, springs, i)
    return total


@kernel
def contact_energies(state, openings, on, contacts):
    """Sum over the contacts (J)."""
    total = 0.0 * load(state, 0, X)
    for i in range(on.shape[0]):
        total = total + contact_energy(openings, on, contacts, i)
    return total


@kernel
def weight_work(state, particles, gravity):
    """Minus the potential energy of the weight (J), zero at the global origin."""
    g = get3(gravity, 0, 0)
    total = 0.0 * load(state, 0, X)
    for i in range(state.shape[0]):
        total = total + load(particles, i, MASS) * dot(g, get3(state, i, X))
    return total
