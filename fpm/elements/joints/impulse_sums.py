"""Impulses of joints summed over a step: only in loops in which a probe asks for them.

The solvers call `count` where they push bodies; for arrays without sums nothing is compiled of it.
"""

from numba.extending import overload

from fpm.elements.joints.hinge_arrays import (
    ABOUT_ONE,
    ABOUT_TWO,
    DP,
    ON_ONE,
    ON_TWO,
    ONE,
    TWO,
    CountedHinges,
)
from fpm.elements.joints.joint_arrays import COUNTED, IMPULSE, TURNED
from fpm.elements.joints.turn_arrays import IMPULSE as OF_STEP
from fpm.kernels.lanes import load, store, where_negative
from fpm.kernels.vectors import INLINED, add_where, get3, kernel

ALL = -1.0
"""Where impulses count: in all lanes."""


@kernel
def clear(sums):
    """Begin a step."""
    for r in range(sums.shape[0]):
        for k in range(sums.shape[1]):
            store(sums, r, k, 0.0)


def count(part, h, where):
    """Count the impulses of hinge h, or of all joints, in the lanes where `where` is negative."""
    if isinstance(part, CountedHinges):
        count_hinge(part, h, where)
    elif isinstance(part, COUNTED + TURNED):
        if isinstance(part, COUNTED):
            count_joints(part, h, where)
        if isinstance(part, TURNED):
            count_turns(part, h, where)


@kernel
def count_hinge(part, h, where):
    """Add what was last found for hinge h."""
    sums, w, b = part.sums, part.hinge_scratch, part.body_scratch
    there = where + 0.0 * load(sums, h, 0)
    add_where(sums, h, ON_ONE, get3(w, h, ONE), there)
    add_where(sums, h, ABOUT_ONE, get3(b, 2 * h, DP), there)
    add_where(sums, h, ON_TWO, -1.0 * get3(w, h, TWO), there)
    add_where(sums, h, ABOUT_TWO, get3(b, 2 * h + 1, DP), there)


@kernel
def count_joints(part, h, where):
    """Add what was last found for all conditions."""
    sums = part.sums
    for r in range(sums.shape[0]):
        before = load(sums, r, 0)
        there = where + 0.0 * before
        store(sums, r, 0, where_negative(there, before + load(part.rows, r, IMPULSE), before))


@kernel
def count_turns(part, h, where):
    """Add what was last found for all openings that are held."""
    sums = part.turns.state
    for t in range(sums.shape[0]):
        before = load(sums, t, OF_STEP)
        impulse = load(part.rows, part.pattern.first[part.turn_at[t]], IMPULSE)
        there = where + 0.0 * before
        store(sums, t, OF_STEP, where_negative(there, before + impulse, before))


@kernel
def count_joints_and_turns(part, h, where):
    """Both."""
    count_joints(part, h, where)
    count_turns(part, h, where)


@overload(count, jit_options=INLINED)
def _count(part, h, where):
    if part.instance_class is CountedHinges:
        return lambda part, h, where: count_hinge(part, h, where)
    counted, turned = part.instance_class in COUNTED, part.instance_class in TURNED
    if counted and turned:
        return lambda part, h, where: count_joints_and_turns(part, h, where)
    if counted:
        return lambda part, h, where: count_joints(part, h, where)
    if turned:
        return lambda part, h, where: count_turns(part, h, where)
    return lambda part, h, where: None
