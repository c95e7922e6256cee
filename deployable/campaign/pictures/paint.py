"""Paint a structure on axes of matplotlib: bodies from far to near, names, directions, scale."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from deployable.campaign.pictures.colours import BARS, CABLE, rgb
from deployable.campaign.pictures.solid import FACES, Solid


@dataclass(frozen=True)
class View:
    """A direction from the structure to the eye: `azimuth`, degrees from x about z, and
    `elevation`, degrees above the plane x, y. Pictures are parallel projections along it."""

    azimuth: float = -60.0
    elevation: float = 22.0

    @cached_property
    def page(self) -> np.ndarray:
        """Unit vectors (2, 3) right and up in the picture; `page @ position` projects onto it."""
        a = np.radians(self.azimuth)
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        return np.stack([right, np.cross(self.direction, right)])

    @cached_property
    def direction(self) -> np.ndarray:
        """Unit vector (3) from the structure to the eye."""
        a, e = np.radians([self.azimuth, self.elevation])
        return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def nice_length(limit: float) -> float:
    """Round a length, `limit` above 0, down to 1, 2 or 5 times a power of ten, for a scale."""
    power = 10.0 ** np.floor(np.log10(limit))
    steps = [step for step in (1.0, 2.0, 5.0) if step * power <= limit * (1 + 1e-9)]
    return float(max(steps) * power)


_LIGHT = np.array([0.4, -0.5, 0.77])  # towards it
_AXIS = "0.35"
_HALO = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6}


def paint_solid(
    ax: Any, solid: Solid, moment: int, view: View, colours: np.ndarray | None = None
) -> Any:
    """Paint a structure's visible faces into matplotlib axes and return their PolyCollection. view:
    direction to the eye; colours (m, 3): of its elements; None: one for each bar."""
    from matplotlib.collections import PolyCollection

    faces, shades = visible_faces(solid, moment, view, colours)
    edges = 0.7 * shades
    collection = PolyCollection([*faces], facecolors=shades, edgecolors=edges, linewidths=0.25)
    ax.add_collection(collection, autolim=False)
    return collection


def paint_cables(ax: Any, solid: Solid, moment: int, view: View) -> Any:
    """Paint a structure's cables at a moment into matplotlib axes, dashed where slack."""
    from matplotlib.collections import LineCollection

    cables = solid.cables
    lines = (solid.cable_points[moment] @ view.page.T)[cables.stretches]
    styles: list[Any] = ["solid"] * len(lines)
    if cables.tension is not None:
        taut = cables.tension[moment][cables.cable[cables.stretches[:, 0]]] > 0
        styles = ["solid" if pulls else (0, (3, 2)) for pulls in taut]
    collection = LineCollection(lines, colors=CABLE, linewidths=0.9, linestyles=styles)
    ax.add_collection(collection, autolim=False)
    return collection


def visible_faces(
    solid: Solid, moment: int, view: View, colours: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Find the faces of a structure that are turned to the eye, from far to near by their middles:
    corners (f, 4, 2) in the plane of the picture (m) and shaded colours (f, 3), 0 to 1."""
    element, face = np.nonzero(solid.visible)
    corners = solid.corners[moment][element[:, None], FACES[face]]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    is_visible = normal @ view.direction > 0
    corners, normal, element = corners[is_visible], normal[is_visible], element[is_visible]
    order = np.argsort((corners @ view.direction).mean(axis=1), kind="stable")
    bright = 0.6 + 0.4 * np.clip(normal @ _LIGHT, 0, 1)
    if colours is None:
        colours = np.array([rgb(BARS[bar % len(BARS)]) for bar in solid.bar]).reshape(-1, 3)
    return (corners @ view.page.T)[order], (bright[:, None] * colours[element])[order]


def paint_points(ax: Any, places: Mapping[str, np.ndarray], view: View, size: float) -> None:
    """Draw points of a structure, positions (3,) by name, into matplotlib axes, each with its name
    on the side away from the mean of all. size: larger of the picture's width and height (m)."""
    flat = {name: view.page @ place for name, place in places.items()}
    if not flat:
        return
    centre = np.mean(list(flat.values()), axis=0)
    for name, point in flat.items():
        direction = point - centre
        length = np.linalg.norm(direction)
        direction = direction / length if length > 1e-6 * size else np.array([0.0, 1.0])
        ax.plot(*point, "o", color="black", markersize=2.5)
        place = point + 0.045 * size * direction
        ax.text(*place, name, fontsize=7, ha="center", va="center", bbox=_HALO)


def frame_picture(ax: Any, limits: np.ndarray, view: View, signs: bool = True) -> None:
    """Set the limits (2, 2), m, of matplotlib axes, with a strip below for the directions x, y, z
    and a length scale; signs: False leaves it empty. view: direction to the eye."""
    low, high = limits
    width, height = high - low
    size = max(width, height)
    arrow, strip = 0.09 * size, 0.2 * size
    ax.set(xlim=(low[0], high[0]), ylim=(low[1] - strip, high[1]), aspect="equal")
    ax.axis("off")
    if not signs:
        return
    origin = np.array([low[0] + 0.1 * size, low[1] - 0.6 * strip])
    for name, end in zip("xyz", arrow * view.page.T, strict=True):
        arrow_style = {"arrowstyle": "-|>", "color": _AXIS, "lw": 0.8, "mutation_scale": 6}
        ax.annotate("", origin + end, origin, arrowprops=arrow_style | {"shrinkA": 0, "shrinkB": 0})
        if np.linalg.norm(end) > 0.15 * arrow:
            text = origin + end * (1 + 0.35 * arrow / np.linalg.norm(end))
            ax.text(*text, name, fontsize=7, color=_AXIS, ha="center", va="center")
    length = nice_length(0.3 * width)
    right, level = high[0] - 0.03 * size, low[1] - 0.6 * strip
    ax.plot((right - length, right), (level, level), color=_AXIS, lw=1.2, solid_capstyle="butt")
    for end in (right - length, right):
        ends = level - 0.012 * size, level + 0.012 * size
        ax.plot((end, end), ends, color=_AXIS, lw=1.2)
    place, style = (right - 0.5 * length, level + 0.03 * size), {"ha": "center", "va": "bottom"}
    text = f"{length:g} m" if length >= 0.1 else f"{1000 * length:g} mm"
    ax.text(*place, text, fontsize=7, color=_AXIS, **style)


def limits_of(places: np.ndarray, view: View, margin: float = 0.08) -> np.ndarray:
    """Find the lowest and highest corner (2, 2) of a picture (m, in its plane) that contains all
    positions. places (..., 3): m; view: direction to the eye; margin: added on each side, as a
    fraction of the larger extent. The smaller extent counts as at least 0.35 of the larger."""
    flat = places.reshape(-1, 3) @ view.page.T
    low, high = flat.min(axis=0), flat.max(axis=0)
    size = max((high - low).max(), 1e-9)
    # A thin structure still gets a picture with some height.
    lack = np.maximum(0.0, 0.35 * size - (high - low)) / 2
    return np.stack([low - lack - margin * size, high + lack + margin * size])
