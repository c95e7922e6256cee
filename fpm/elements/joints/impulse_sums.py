"""Impulses of joints summed over a step: only in loops in which a probe asks for them.

The solvers count where they push bodies; where sums are None nothing is compiled of it.
"""

from fpm.elements.joints.hinge_arrays import (
    ABOUT_ONE,
    ABOUT_TWO,
    DP,
    ON_ONE,
    ON_TWO,
    ONE,
    TWO,
)
from fpm.elements.joints.joint_arrays import IMPULSE
from fpm.elements.joints.turn_arrays import IMPULSE as OF_STEP
from fpm.kernels.lanes import load, store, where_negative
from fpm.kernels.vectors import add_where, get3, kernel

ALL = -1.0
"""Where impulses count: in all lanes."""


@kernel
def clear(sums):
    """Begin a step."""
    if sums is not None:
        for r in range(sums.shape[0]):
            for k in range(sums.shape[1]):
                store(sums, r, k, 0.0)


@kernel
def count_hinge(sums, part, h, where):
    """Count the impulses last found for hinge h in the lanes where `where` is negative."""
    if sums is not None:
        w, b = part.hinge_scratch, part.body_scratch
        there = where + 0.0 * load(sums, h, 0)
        add_where(sums, h, ON_ONE, get3(w, h, ONE), there)
        add_where(sums, h, ABOUT_ONE, get3(b, 2 * h, DP), there)
        add_where(sums, h, ON_TWO, -1.0 * get3(w, h, TWO), there)
        add_where(sums, h, ABOUT_TWO, get3(b, 2 * h + 1, DP), there)


@kernel
def count_joints(part, where):
    """The same of all conditions, and of the openings that are held among them."""
    count_conditions(part.sums, part, where)
    count_turns(part.turns, part, where)


@kernel
def count_conditions(sums, part, where):
    """Add what was last found for all conditions."""
    if sums is not None:
        for r in range(sums.shape[0]):
            before = load(sums, r, 0)
            there = where + 0.0 * before
            store(sums, r, 0, where_negative(there, before + load(part.rows, r, IMPULSE), before))


@kernel
def count_turns(turns, part, where):
    """Add what was last found for all openings that are held."""
    if turns is not None:
        sums = turns.state
        for t in range(sums.shape[0]):
            before = load(sums, t, OF_STEP)
            impulse = load(part.rows, part.pattern.first[part.turn_at[t]], IMPULSE)
            there = where + 0.0 * before
            store(sums, t, OF_STEP, where_negative(there, before + impulse, before))
