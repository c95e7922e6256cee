"""What of a structure's file is hardly meant and does not show in its scene (plausible.py has what
does): boxes, areas and points in other units."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

DENSEST = 30_000.0
"""Density (kg/m3) above any material's, of boxes."""

MAX_SLENDERNESS = 500.0
"""Ratio of edges above which a box stands for a line or a sheet without thickness, of any mass."""

MAX_AREAS = 300.0
"""Area on which air drags by the square of the structure's size, above which it is odd."""

FARTHEST = 200.0
"""Distance of a point from the others by their extent, above which it is odd."""


def find_doubts(group: str, args: Any, size: float) -> Iterator[str]:
    """Yield sentences on an entry that is hardly meant, of what its scene does not show: boxes too
    dense, drag on too much area. args: values of its keys; size: extent of the structure (m)."""
    box = getattr(args, "box", None)
    # A line or a sheet has no density.
    if box is not None and MAX_SLENDERNESS * np.min(box) > np.max(box):
        edges = " x ".join(f"{edge:.4g}" for edge in box)
        yield from find_dense(args.name, args.mass, float(np.prod(box)), f"a box of {edges} m")
    if group == "drags" and args.area > MAX_AREAS * size**2 > 0:
        yield (
            f"drag {args.name} has an area of {args.area:.4g} m2, on a structure of {size:.4g} m: "
            f"an area in mm2 has its unit, as {args.area:.6g} mm2"
        )


def find_dense(name: str, mass: float, volume: float, shape: str = "") -> Iterator[str]:
    """Yield a sentence on a body that is denser than any material, if it has a volume. name: of the
    body; mass (kg); volume (m3), 0: none; shape: what has that, in words; "": the volume."""
    if mass > DENSEST * volume > 0:
        yield (
            f"body {name} has {mass:.4g} kg in {shape or f'{volume:.4g} m3'}, "
            f"{mass / volume:.3g} kg/m3; usual: at most {DENSEST:g} kg/m3: masses are in kg, not "
            "in g"
        )


def find_far_point(points: Mapping[str, np.ndarray]) -> Iterator[str]:
    """Yield a sentence on a point (positions by name, m) far from all others, if any."""
    names, places = list(points), np.array(list(points.values()))
    if len(names) < 3:
        return
    distances = np.linalg.norm(places - np.median(places, axis=0), axis=1)
    index = int(np.argmax(distances))
    rest = float(np.ptp(np.delete(places, index, axis=0), axis=0).max())
    if distances[index] > FARTHEST * rest > 0:
        yield (
            f"point {names[index]} is {distances[index]:.4g} m from the others, which lie within "
            f"{rest:.4g} m: a length in mm has its unit, as 500 mm"
        )
