"""Which blocks the matrix of coupled joints has, and in which order they are eliminated.

Joints are coupled when they share a body that can move. Elimination by least degree (Tinney and
Walker, Proc. IEEE 55 (1967) 1801) keeps what it fills in small: a chain or a tree of joints fills
nothing, a loop one block a joint. Found once for all scenes of a topology.
"""

from collections.abc import Sequence

import numpy as np

from fpm.elements.joints.joint_arrays import Pattern


def neighbours(slots: np.ndarray, movable: np.ndarray) -> list[set[int]]:
    """For each joint those that share a body with it that can move.

    slots (j, 2): bodies of the sides, -1 for none; movable (b,).
    """
    at: dict[int, list[int]] = {}
    for joint, sides in enumerate(slots):
        for slot in {int(s) for s in sides if s >= 0 and movable[s]}:
            at.setdefault(slot, []).append(joint)
    found: list[set[int]] = [set() for _ in slots]
    for joints in at.values():
        for joint in joints:
            found[joint].update(joints)
    for joint, others in enumerate(found):
        others.discard(joint)
    return found


def elimination(graph: Sequence[set[int]]) -> tuple[list[int], list[list[int]]]:
    """Order of elimination, and for each joint in it the later ones that it is coupled to then.

    The later ones come as places in the order, sorted.
    """
    left = {joint: set(others) for joint, others in enumerate(graph)}
    by_degree: dict[int, set[int]] = {}
    for joint, others in left.items():
        by_degree.setdefault(len(others), set()).add(joint)
    order, after = [], []
    while left:
        degree = min(d for d, joints in by_degree.items() if joints)
        joint = min(by_degree[degree])
        by_degree[degree].discard(joint)
        others = left.pop(joint)
        for other in others:
            by_degree[len(left[other])].discard(other)
            left[other] |= others
            left[other] -= {joint, other}
            by_degree.setdefault(len(left[other]), set()).add(other)
        order.append(joint)
        after.append(others)
    place = {joint: i for i, joint in enumerate(order)}
    return order, [sorted(place[other] for other in others) for others in after]


def pattern(counts, slots, movable, below: list[list[int]]) -> tuple[Pattern, int]:
    """The pattern of joints in their order of elimination, and the number of entries.

    counts (j,): conditions of each; slots (j, 2); movable (b,); below: as `elimination` gives it.
    """
    count = np.asarray(counts, np.int64)
    offsets: dict[tuple[int, int], int] = {}
    entries = 0
    for j in range(len(count)):
        for k in (j, *below[j]):
            offsets[k, j] = entries
            entries += int(count[k] * count[j])
    meets = []
    for k, j in offsets:
        for one, slot in enumerate(slots[k]):
            for two, other in enumerate(slots[j]):
                if slot == other >= 0 and movable[slot]:
                    meets.append((k, j, one, two, offsets[k, j]))
    updates = [
        [
            (i, k, offsets[i, j], offsets[k, j], offsets[i, k])
            for i in later
            for k in later
            if k <= i
        ]
        for j, later in enumerate(below)
    ]
    blocks = [[(k, offsets[k, j]) for k in later] for j, later in enumerate(below)]
    found = Pattern(
        first=np.cumsum([0, *count[:-1]]),
        count=count,
        diagonal=_table([offsets[j, j] for j in range(len(count))]),
        meets=_table(meets, 5),
        below_start=np.cumsum([0, *map(len, blocks)]),
        below=_table([block for each in blocks for block in each], 2),
        update_start=np.cumsum([0, *map(len, updates)]),
        updates=_table([update for each in updates for update in each], 5),
    )
    return found, entries


def _table(values, columns: int | None = None) -> np.ndarray:
    shape = (-1,) if columns is None else (-1, columns)
    return np.array(values, np.int64).reshape(shape)
