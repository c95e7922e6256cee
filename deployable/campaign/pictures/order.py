"""The order in which faces are painted, so that none covers one that is nearer to the eye.

The middles of two faces do not tell which is nearer where one is long: of a tube within a tube the
inner face's may be. So depths are compared at a point where both faces are on the page. Where these
comparisons form a cycle, or faces intersect, their middles decide."""

import heapq

import numpy as np

_TOLERANCE = 1e-6  # of the largest distance: nearer than that faces are as far from the eye
_MOST = 3000  # faces; of more, pairs take too long, and faces are small


def paint_order(flat: np.ndarray, depth: np.ndarray) -> list[int]:
    """Sort f plane convex faces from far to near; returns their indices. flat (f, 4, 2): corners in
    the plane of the picture, going round each face; depth (f, 4): towards the eye, in the same
    unit. Up to 3000 faces are compared where two overlap, of more only their middles."""
    middle = depth.mean(axis=1)
    if not 0 < len(middle) <= _MOST:
        return np.argsort(middle, kind="stable").tolist()
    front, rear = _overlapping_pairs(flat, depth)
    successors: list[list[int]] = [[] for _ in middle]
    waits = np.bincount(front, minlength=len(middle))
    for face, successor in zip(rear.tolist(), front.tolist(), strict=True):
        successors[face].append(successor)
    ready: list[tuple] = [(middle[i], i) for i in np.flatnonzero(waits == 0)]
    heapq.heapify(ready)
    rest = iter(np.argsort(middle, kind="stable").tolist())
    order: list[int] = []
    is_painted = np.zeros(len(middle), bool)
    while len(order) < len(middle):
        face = heapq.heappop(ready)[1] if ready else next(i for i in rest if not is_painted[i])
        if is_painted[face]:
            continue
        is_painted[face] = True
        order.append(int(face))
        for successor in successors[face]:
            waits[successor] -= 1
            if waits[successor] == 0 and not is_painted[successor]:
                heapq.heappush(ready, (middle[successor], successor))
    return order


def _overlapping_pairs(flat: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of faces that share some of the page: the nearer one there (p,) and the other (p,)."""
    low, high = flat.min(axis=1), flat.max(axis=1)
    is_apart = (low[:, None] >= high).any(axis=2)
    i, j = np.nonzero(np.triu(~(is_apart | is_apart.T), 1))
    place, overlap = _places(flat[i], flat[j])
    i, j, place = i[overlap], j[overlap], place[overlap]
    planes = _planes(flat, depth)
    homogeneous = np.concatenate([place, np.ones((len(place), 1))], axis=1)
    nearer = ((planes[i] - planes[j]) * homogeneous).sum(axis=1)
    is_clear = np.abs(nearer) > _TOLERANCE * max(np.ptp(flat), 1e-300)
    first = nearer > 0
    return np.where(first, i, j)[is_clear], np.where(first, j, i)[is_clear]


def _planes(flat: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Coefficients (f, 3) of the nearness of faces over the page: a x + b y + c."""
    middle = flat.mean(axis=1)
    offset, height = flat - middle[:, None], depth - depth.mean(axis=1, keepdims=True)
    square = np.einsum("fci,fcj->fij", offset, offset)
    slope = np.einsum("fij,fcj,fc->fi", np.linalg.pinv(square), offset, height)
    return np.column_stack([slope, depth.mean(axis=1) - (slope * middle).sum(axis=1)])


def _places(first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The middle (p, 2) of what pairs of faces (p, 4, 2) share, and whether both have it (p,)."""
    crossings, cuts = _crossings(first, second)
    points = np.concatenate([first, second, crossings], axis=1)
    counts = np.concatenate([_is_inside(first, second), _is_inside(second, first), cuts], axis=1)
    total = counts.sum(axis=1)
    place = (points * counts[..., None]).sum(axis=1) / np.maximum(total, 1)[:, None]
    overlap = _is_inside(place[:, None], first)[:, 0] & _is_inside(place[:, None], second)[:, 0]
    return place, overlap & (total > 2)


def _is_inside(points: np.ndarray, face: np.ndarray) -> np.ndarray:
    """Whether points (p, k, 2) lie inside of faces (p, 4, 2), their edges left out."""
    edge = np.roll(face, -1, axis=1) - face
    offset = points[:, :, None] - face[:, None]
    side = edge[:, None, :, 0] * offset[..., 1] - edge[:, None, :, 1] * offset[..., 0]
    return (side > 0).all(axis=2) | (side < 0).all(axis=2)


def _crossings(first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where the edges of faces (p, 4, 2) cross: places (p, 16, 2), and whether they do (p, 16)."""
    first_edge, second_edge = (np.roll(face, -1, axis=1) - face for face in (first, second))
    first_edge, second_edge = first_edge[:, :, None], second_edge[:, None]
    offset = second[:, None] - first[:, :, None]
    turn = _cross(first_edge, second_edge)
    with np.errstate(divide="ignore", invalid="ignore"):
        part1, part2 = _cross(offset, second_edge) / turn, _cross(offset, first_edge) / turn
    cross = (part1 > 0) & (part1 < 1) & (part2 > 0) & (part2 < 1)
    place = first[:, :, None] + np.where(cross, part1, 0.0)[..., None] * first_edge
    count = len(first)
    return place.reshape(count, 16, 2), cross.reshape(count, 16)


def _cross(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
