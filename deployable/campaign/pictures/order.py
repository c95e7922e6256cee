"""In which order faces are painted, so that none covers what lies before it.

The middles of two faces do not tell which is before the other where one is long: of a tube within a
tube the inner one's may be nearer. So it is asked at a place where both are on the page. Where such
answers go round in a circle, or faces pass through each other, their middles decide.
"""

from __future__ import annotations

import heapq

import numpy as np

_SAME = 1e-6  # of the largest distance: nearer than that faces are as far from the eye
_MOST = 3000  # faces; of more, pairs take too long, and faces are small


def paint_order(flat: np.ndarray, depth: np.ndarray) -> list[int]:
    """Faces from far to near: corners on the page (f, 4, 2) of plane convex ones, in the order of a
    walk about them, and how near each is to the eye (f, 4)."""
    middle = depth.mean(axis=1)
    if not 0 < len(middle) <= _MOST:
        return np.argsort(middle, kind="stable").tolist()
    near, far = _before(flat, depth)
    after: list[list[int]] = [[] for _ in middle]
    waits = np.bincount(near, minlength=len(middle))
    for one, other in zip(far.tolist(), near.tolist(), strict=True):
        after[one].append(other)
    ready = [(middle[i], i) for i in np.flatnonzero(waits == 0)]
    heapq.heapify(ready)
    rest = iter(np.argsort(middle, kind="stable").tolist())
    order: list[int] = []
    done = np.zeros(len(middle), bool)
    while len(order) < len(middle):
        face = heapq.heappop(ready)[1] if ready else next(i for i in rest if not done[i])
        if done[face]:
            continue
        done[face] = True
        order.append(int(face))
        for other in after[face]:
            waits[other] -= 1
            if waits[other] == 0 and not done[other]:
                heapq.heappush(ready, (middle[other], other))
    return order


def _before(flat: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of faces that share some of the page: the nearer one there (p,) and the other (p,)."""
    low, high = flat.min(axis=1), flat.max(axis=1)
    apart = (low[:, None] >= high).any(axis=2)
    one, other = np.nonzero(np.triu(~(apart | apart.T), 1))
    place, shared = _places(flat[one], flat[other])
    one, other, place = one[shared], other[shared], place[shared]
    planes = _planes(flat, depth)
    where = np.concatenate([place, np.ones((len(place), 1))], axis=1)
    nearer = ((planes[one] - planes[other]) * where).sum(axis=1)
    told = np.abs(nearer) > _SAME * max(np.ptp(flat), 1e-300)
    first = nearer > 0
    return np.where(first, one, other)[told], np.where(first, other, one)[told]


def _planes(flat: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Coefficients (f, 3) of the nearness of faces over the page: a x + b y + c."""
    middle = flat.mean(axis=1)
    off, up = flat - middle[:, None], depth - depth.mean(axis=1, keepdims=True)
    square = np.einsum("fci,fcj->fij", off, off)
    slope = np.einsum("fij,fcj,fc->fi", np.linalg.pinv(square), off, up)
    return np.column_stack([slope, depth.mean(axis=1) - (slope * middle).sum(axis=1)])


def _places(one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The middle (p, 2) of what pairs of convex faces (p, 4, 2) share, and whether it is inside of
    both (p,)."""
    cut, cuts = _crossings(one, other)
    points = np.concatenate([one, other, cut], axis=1)
    counts = np.concatenate([_inside(one, other), _inside(other, one), cuts], axis=1)
    total = counts.sum(axis=1)
    place = (points * counts[..., None]).sum(axis=1) / np.maximum(total, 1)[:, None]
    inside = _inside(place[:, None], one)[:, 0] & _inside(place[:, None], other)[:, 0]
    return place, inside & (total > 2)


def _inside(points: np.ndarray, face: np.ndarray) -> np.ndarray:
    """Whether points (p, k, 2) lie inside of faces (p, 4, 2), their edges left out."""
    edge = np.roll(face, -1, axis=1) - face
    off = points[:, :, None] - face[:, None]
    side = edge[:, None, :, 0] * off[..., 1] - edge[:, None, :, 1] * off[..., 0]
    return (side > 0).all(axis=2) | (side < 0).all(axis=2)


def _crossings(one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where the edges of faces (p, 4, 2) cross: places (p, 16, 2), and whether they do (p, 16)."""
    along, beside = (np.roll(face, -1, axis=1) - face for face in (one, other))
    along, beside = along[:, :, None], beside[:, None]
    off = other[:, None] - one[:, :, None]
    turn = _cross(along, beside)
    with np.errstate(divide="ignore", invalid="ignore"):
        share, back = _cross(off, beside) / turn, _cross(off, along) / turn
    cross = (share > 0) & (share < 1) & (back > 0) & (back < 1)
    place = one[:, :, None] + np.where(cross, share, 0.0)[..., None] * along
    count = len(one)
    return place.reshape(count, 16, 2), cross.reshape(count, 16)


def _cross(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
