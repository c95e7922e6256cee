"""Forces of the damping of bars, and their losses (theory: bar_damping.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.bars import beam_kernels as beam
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store
from fpm.kernels.vectors import kernel

# Of each of an element's six deformations, in the order of `forces`: its value at the last
# positions, its rate in the middle of the last step (at first that at the start), its force there.
VALUE, RATE, FORCE = 0, 6, 12
HISTORY = 18


class DampedElements(NamedTuple):
    """Arrays of those d beam elements that are damped. bars: the Straight- or FramedElements, with
    their damping in the place of the stiffness;
    history (d, 18, lanes): of their deformations; account: index of the loss in World.accounts."""

    bars: beam.StraightElements | beam.FramedElements
    history: np.ndarray
    account: int


@kernel
def follow(part, timing, e, k, value, damping):
    """Note deformation k of element e, `value` (m, rad). Return its rate, extrapolated from the
    last two steps, and what `damping` took of it in the step (J, by the trapezium rule)."""
    history = part.history
    rate = load(history, e, RATE + k)
    loss = 0.0 * rate
    if timing.time > 0.0:
        change = value - load(history, e, VALUE + k)
        half = (1.0 / timing.step) * change
        store(history, e, RATE + k, half)
        rate = 1.5 * half - 0.5 * rate
        loss = 0.5 * (damping * rate + load(history, e, FORCE + k)) * change
    store(history, e, VALUE + k, value)
    store(history, e, FORCE + k, damping * rate)
    return rate, loss


@hook(DampedElements)
def forces(part, world, timing):
    state, bars = world.state, part.bars
    total = load(world.accounts, 0, part.account)
    for e in range(bars.nodes.shape[0]):
        n, inverse, _ = beam.chord_of(bars, state, e)
        axes = beam.end_axes(bars, state, e)
        (a2, a3, b2, b3), slopes = beam.bends_of(n, axes)
        axial, torsion = load(bars.beams, e, beam.AXIAL), load(bars.beams, e, beam.TWIST)
        kz, ky = load(bars.beams, e, beam.BEND_Z), load(bars.beams, e, beam.BEND_Y)
        twist = beam.twist_of(axes[0], axes[1], axes[2], axes[3])
        stretch_rate, loss1 = follow(part, timing, e, 0, 1.0 / inverse, axial)
        twist_rate, loss2 = follow(part, timing, e, 1, twist, torsion)
        # By the sum and the difference of the angles the energy of a plane is diagonal.
        sum2, loss3 = follow(part, timing, e, 2, a2 + b2, 0.5 * kz)
        sum3, loss4 = follow(part, timing, e, 3, a3 + b3, 0.5 * ky)
        change2, loss5 = follow(part, timing, e, 4, a2 - b2, (1 / 6) * kz)
        change3, loss6 = follow(part, timing, e, 5, a3 - b3, (1 / 6) * ky)
        total = total + (loss1 + loss2 + loss3 + loss4 + loss5 + loss6)
        first = 0.5 * (sum2 + change2), 0.5 * (sum3 + change3)
        second = 0.5 * (sum2 - change2), 0.5 * (sum3 - change3)
        loads = axial * stretch_rate, torsion * twist_rate, first + second
        beam.push_ends(bars, state, e, n, inverse, axes, slopes, loads)
    store(world.accounts, 0, part.account, total)
