"""The shortest distance of two bars: of the axes of their elements, less what the sections take.

Along the line of the shortest distance of two axes, of direction d, a round section takes its
radius and a rectangle |d·y| b/2 + |d·z| h/2, with its axes y, z and sides b, h. Bars are convex
stretch by stretch, so they are at least so far apart, and just so where two sides or edges face
each other. Below zero they overlap."""

import numpy as np

from fpm.reading.bars import Bar, ends_of, half_sizes
from fpm.scenes.scene import Scene

MOST_PAIRS = 1 << 20
"""Number of pairs of elements at instants that are looked at together, at most."""


def find_clearance(scene: Scene, first: Bar, second: Bar, place, axes) -> np.ndarray:
    """Return a lower bound (t,) m of the shortest distance between the surfaces of two bars of a
    scene, `first` and `second`, at t instants: equal to it where sides or edges face each other; a
    value that is not above 0 does not show that they overlap. place(i), axes(i): positions (t, 3) m
    and frames (t, 3, 3), axes as columns, of particle i."""
    lines1, lines2 = (_lines(scene, bar, place, axes) for bar in (first, second))
    count, pairs = len(lines1[0]), lines1[0].shape[1] * lines2[0].shape[1]
    size = max(1, MOST_PAIRS // pairs)
    parts = [slice(k, k + size) for k in range(0, count, size)]
    return np.concatenate([_shortest(*(x[part] for x in (*lines1, *lines2))) for part in parts])


def _lines(scene: Scene, bar: Bar, place, axes) -> tuple[np.ndarray, ...]:
    """Elements of a bar: start and end (t, m, 3) m, half sizes of their sections along axes y and z
    as vectors (t, m, 2, 3) m, and radii (t, m) m of round ones."""
    lines = []
    for beams in bar.groups:
        (start, section_axes), (end, _) = ends_of(scene, beams, place, axes)
        y, z = half_sizes(beams.section)
        is_round = beams.section.outline == "round"
        sides = section_axes.swapaxes(2, 3) * (0.0 if is_round else np.array([[y], [z]]))
        lines.append((start, end, sides, np.full(start.shape[:2], y if is_round else 0.0)))
    return tuple(np.concatenate(arrays, axis=1) for arrays in zip(*lines, strict=True))


def _shortest(a, b, sides_one, radius_one, c, d, sides_two, radius_two) -> np.ndarray:
    """Shortest distance (t,) m of the elements from a to b and the elements from c to d."""
    a, b = a[:, :, None], b[:, :, None]
    c, d = c[:, None], d[:, None]
    line = nearest(a, b, c, d)
    distance = np.linalg.norm(line, axis=-1)
    direction = line / np.maximum(distance, 1e-300)[..., None]
    widths = radius_one[:, :, None] + radius_two[:, None]
    widths = widths + np.abs(np.einsum("tmki,tmni->tmnk", sides_one, direction)).sum(axis=-1)
    widths = widths + np.abs(np.einsum("tnki,tmni->tmnk", sides_two, direction)).sum(axis=-1)
    return (distance - widths).min(axis=(1, 2))


def nearest(a, b, c, d) -> np.ndarray:
    """Return the shortest vector (..., 3), m, from segment a b to segment c d. a, b, c, d: ends of
    the segments (..., 3), m."""
    u, v, w = b - a, d - c, c - a

    def to_segment(point, start, chord):
        fraction = np.sum((point - start) * chord, axis=-1) / np.sum(chord * chord, axis=-1)
        return start + np.clip(fraction, 0.0, 1.0)[..., None] * chord - point

    uu, vv, uv = (np.sum(p * q, axis=-1) for p, q in ((u, u), (v, v), (u, v)))
    uw, vw = np.sum(u * w, axis=-1), np.sum(v * w, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        det = uu * vv - uv * uv
        s, t = (uw * vv - vw * uv) / det, (uw * uv - vw * uu) / det
    is_inside = (det > 1e-12 * uu * vv) & (s > 0) & (s < 1) & (t > 0) & (t < 1)
    s, t = np.where(is_inside, s, 0.0)[..., None], np.where(is_inside, t, 0.0)[..., None]
    line = w + t * v - s * u  # where not inside: from a to c, which is not shorter
    lines = [line, to_segment(a, c, v), to_segment(b, c, v)]
    lines += [-to_segment(c, a, u), -to_segment(d, a, u)]
    shape = np.broadcast_shapes(*(vector.shape for vector in lines))
    vectors = np.stack([np.broadcast_to(vector, shape) for vector in lines])
    best = np.sum(vectors**2, axis=-1).argmin(axis=0)
    return np.take_along_axis(vectors, best[None, ..., None], axis=0)[0]
