"""Energies of a scene at a recorded instant, sample by sample."""

from fpm.kernels.beam import beam_energy, shape_of
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
def strain_energy(state, nodes, beams, axes, largest):
    """Sum over the beam elements (J); raises largest (1, 3, lanes), fields as in layout.py."""
    total = 0.0 * load(state, 0, X)
    bend, surface = load(largest, 0, LARGEST_BEND), load(largest, 0, LARGEST_STRAIN)
    for e in range(nodes.shape[0]):
        length, sines, twist = shape_of(state, nodes, axes, e)
        total = total + beam_energy(beams, e, length, sines, twist)
        bend, surface = larger_strains(beams, e, length, sines, twist, bend, surface)
    store(largest, 0, LARGEST_BEND, bend)
    store(largest, 0, LARGEST_STRAIN, surface)
    return total


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
