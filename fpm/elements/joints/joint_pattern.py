"""Which blocks the matrix of coupled joints has, and in which order they are eliminated.

Joints are coupled when they share a body that can move. Elimination by least degree (Tinney and
Walker, Proc. IEEE 55 (1967) 1801) keeps what it fills in small: a chain or a tree of joints fills
nothing, a loop one block a joint. Found once for all scenes of a topology."""

from collections.abc import Sequence
from itertools import chain, product

import numpy as np

from fpm.elements.joints.joint_arrays import Pattern


def neighbours(slots: np.ndarray, movable: np.ndarray) -> list[set[int]]:
    """Return for each joint the indices of the joints that share a movable body with it. slots (j,
    2): indices of the bodies at its sides, -1 for none; movable (b,): whether a body can move."""
    by_slot: dict[int, list[int]] = {}
    for joint, sides in enumerate(slots):
        for slot in {int(s) for s in sides if s >= 0 and movable[s]}:
            by_slot.setdefault(slot, []).append(joint)
    sets: list[set[int]] = [set() for _ in slots]
    for joints in by_slot.values():
        for joint in joints:
            sets[joint].update(joints)
    for joint, members in enumerate(sets):
        members.discard(joint)
    return sets


def elimination(graph: Sequence[set[int]]) -> tuple[list[int], list[list[int]]]:
    """Return the order in which to eliminate joints from their equations (indices), and for each
    place in it the sorted later places that it is then coupled to. graph: from `neighbours`."""
    active = {joint: set(members) for joint, members in enumerate(graph)}
    by_degree: dict[int, set[int]] = {}
    for joint, members in active.items():
        by_degree.setdefault(len(members), set()).add(joint)
    order, followers = [], []
    while active:
        degree = min(d for d, joints in by_degree.items() if joints)
        joint = min(by_degree[degree])
        by_degree[degree].discard(joint)
        members = active.pop(joint)
        for member in members:
            by_degree[len(active[member])].discard(member)
            active[member] |= members
            active[member] -= {joint, member}
            by_degree.setdefault(len(active[member]), set()).add(member)
        order.append(joint)
        followers.append(members)
    place = {joint: i for i, joint in enumerate(order)}
    return order, [sorted(place[member] for member in members) for members in followers]


def pattern(counts, slots, movable, followers: list[list[int]]) -> tuple[Pattern, int]:
    """Return the layout of the joints' matrix (Pattern), and its number of entries. counts (j,):
    constraints of each joint; slots (j, 2): bodies at its sides, -1: none; both in order of
    elimination; movable (b,): of bodies; followers: second result of `elimination`."""
    count = np.asarray(counts, np.int64)
    offsets: dict[tuple[int, int], int] = {}
    entries = 0
    for j in range(len(count)):
        for k in (j, *followers[j]):
            offsets[k, j] = entries
            entries += int(count[k] * count[j])
    meets = [
        (k, j, side1, side2, offset)
        for ((k, j), offset), side1, side2 in product(offsets.items(), range(2), range(2))
        if slots[k][side1] == slots[j][side2] >= 0 and movable[slots[k][side1]]
    ]
    updates = [
        [
            (i, k, offsets[i, j], offsets[k, j], offsets[i, k])
            for i, k in product(members, members)
            if k <= i
        ]
        for j, members in enumerate(followers)
    ]
    blocks = [[(k, offsets[k, j]) for k in members] for j, members in enumerate(followers)]
    result = Pattern(
        first=np.cumsum([0, *count[:-1]]),
        count=count,
        diagonal=_table([offsets[j, j] for j in range(len(count))]),
        meets=_table(meets, 5),
        below_start=np.cumsum([0, *map(len, blocks)]),
        followers=_table([*chain(*blocks)], 2),
        update_start=np.cumsum([0, *map(len, updates)]),
        updates=_table([*chain(*updates)], 5),
    )
    return result, entries


def _table(values, columns: int | None = None) -> np.ndarray:
    shape = (-1,) if columns is None else (-1, columns)
    return np.array(values, np.int64).reshape(shape)
