"""The Bennett linkage at moments of its motion, in the paper's manner: straight mitred bars."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from deployable.campaign.config.sections import Experiment

# The six faces of a box as indices into its eight corners (see `_bennett_bars`).
_FACES = ((0, 1, 2, 3), (4, 5, 6, 7), *((i, j, j + 4, i + 4) for i, j in pairwise((0, 1, 2, 3, 0))))
_LIGHT = np.array([0.4, -0.5, 0.77])  # towards it
_MARGIN = 0.08  # m, room for the names
_BAR_COLOURS = ("#E69F00", "#56B4E9", "#E69F00", "#56B4E9")


def moments(
    time: np.ndarray, opening: np.ndarray, count: int, first_closure: float | None = None
) -> np.ndarray:
    """Indices of `count` instants from the start to the first closure, evenly spread in opening.

    `opening` (time) is that of a hinge, 0 when deployed. The last instant is that of its least
    value until shortly after `first_closure` (s) of any contact, since a flexible structure does
    not close everywhere at once; without a closure, the least of all.
    """
    until = len(time) if first_closure is None else np.searchsorted(time, 1.1 * first_closure)
    last = int(opening[:until].argmin())
    wanted = np.linspace(opening[0], opening[last], count)
    return np.array([int(np.abs(opening[: last + 1] - value).argmin()) for value in wanted])


def has_bars(experiment: Experiment, keep: str) -> bool:
    """Whether the structure can be drawn like this, from trajectories, which `keep` tells of."""
    scene = experiment.scene
    return scene.name in BARS and not scene.file and keep == "trajectories"


def draw(trajectory_path: str | Path, count: int) -> Any:
    """A figure of the structure at `count` moments; its scene is one of `BARS`."""
    import netCDF4

    from deployable.fpm.trajectory import read_curves

    curves = read_curves(trajectory_path)
    with netCDF4.Dataset(trajectory_path) as file:
        attributes = dict(file.__dict__)
    opening = curves.openings["B"]
    closures = curves.events[curves.events[:, 2] == 1, 0]
    indices = moments(curves.time, opening, count, closures.min() if len(closures) else None)
    times = curves.time[indices]
    points = {name: place[indices] for name, (place, _) in curves.points.items()}
    bars_of = BARS[attributes["scene"]]
    bars, drawn = bars_of(attributes, np.maximum(opening[indices], 0.0))
    # A structure that is free to move as a whole is drawn where it is.
    move = np.mean([points[name] - place for name, place in drawn.items()], axis=0)
    bars += move[:, None, None, :]
    marks = {name: place + move for name, place in drawn.items()}
    return _figure(bars, marks, times, np.degrees(opening[0] - opening[indices]))


def _bennett_bars(
    attributes: Mapping[str, Any], opening: np.ndarray
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Corners (moment, bar, 8, 3) of the four mitred bars, placed by the opening at hinge B (rad),
    and the points A to D in that place, each (moment, 3).

    The bars are drawn straight, as the rigid linkage of that opening would stand.
    """
    from deployable.fpm.scenes.bennett_geometry import HINGES, bennett_geometry

    def number(name: str) -> float | None:
        value = attributes.get(f"parameter_{name}")
        return None if value is None or isinstance(value, str) else float(value)

    geometry = bennett_geometry(
        *(number(n) for n in ("L", "a", "lambda_deg", "mu_deg", "omega_deg"))
    )
    half = 0.5 * geometry.side
    section = half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    corners = []
    for start, normal in (
        (0.0, geometry.face_normal_a),
        (geometry.length, geometry.face_normal_b),
    ):
        along = start - section @ normal[1:] / normal[0]
        corners.append(np.column_stack([along, section]))
    bar = np.concatenate(corners)
    # The mirror images BC and DA have the section's two axes exchanged.
    shapes = [bar, bar[:, [0, 2, 1]], bar, bar[:, [0, 2, 1]]]
    pose = geometry.pose(opening)
    bars = [
        pose.origin[:, i, None, :] + np.einsum("mij,cj->mci", pose.rotation[:, i], shape)
        for i, shape in enumerate(shapes)
    ]
    return np.stack(bars, axis=1), {n: pose.point[:, i] for i, n in enumerate(HINGES)}


BARS: dict[str, Callable] = {"bennett": _bennett_bars}


def _figure(bars: np.ndarray, points: Mapping, times: np.ndarray, degrees: np.ndarray) -> Any:
    """Draw bars (moment, bar, 8, 3) in parallel projection, one panel a moment; degrees: by how
    much the linkage has opened since its start."""
    from matplotlib.figure import Figure

    view, towards = _view(azimuth=-60.0, elevation=22.0)
    figure = Figure(figsize=(2.1 * len(times), 2.4), layout="constrained")
    axes = figure.subplots(1, len(times), sharex=True, sharey=True, squeeze=False)[0]
    for panel, ax in enumerate(axes):
        _draw_bars(ax, bars[panel], view, towards)
        _draw_points(ax, {name: view @ place[panel] for name, place in points.items()})
        ax.set_title(f"t = {times[panel]:.3f} s\nopened by {degrees[panel]:.0f}° at B", fontsize=8)
        ax.set_aspect("equal")
        ax.axis("off")
    corners = bars.reshape(-1, 3) @ view.T
    (left, bottom), (right, top) = corners.min(axis=0) - _MARGIN, corners.max(axis=0) + _MARGIN
    axes[0].set(xlim=(left, right), ylim=(bottom, top))
    return figure


def _draw_bars(ax: Any, bars: np.ndarray, view: np.ndarray, towards: np.ndarray) -> None:
    """Paint the faces of bars (bar, 8, 3) from far to near, the lit ones brighter."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb

    painted = []
    for bar, colour in zip(bars, _BAR_COLOURS, strict=True):
        for face in _FACES:
            corners = bar[list(face)]
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            brightness = 0.55 + 0.45 * abs(normal @ _LIGHT) / np.linalg.norm(normal)
            shade = tuple(brightness * channel for channel in to_rgb(colour))
            painted.append(((corners @ towards).mean(), corners @ view.T, shade))
    painted.sort(key=lambda item: item[0])
    _, faces, shades = zip(*painted, strict=True)
    ax.add_collection(PolyCollection(faces, facecolors=shades, edgecolors="black", linewidths=0.4))


def _draw_points(ax: Any, places: Mapping[str, np.ndarray]) -> None:
    """Mark points on the page, with their names away from their middle."""
    centre = np.mean(list(places.values()), axis=0)
    for name, at in places.items():
        away = at - centre
        ax.plot(*at, "o", color="black", markersize=2.5)
        place = at + 0.7 * _MARGIN * away / max(np.linalg.norm(away), 1e-9)
        ax.text(*place, name, fontsize=8, ha="center", va="center")


def _view(azimuth: float, elevation: float) -> tuple[np.ndarray, np.ndarray]:
    """Rows that project to the page (2, 3) and the direction to the eye; angles in degrees."""
    a, e = np.radians([azimuth, elevation])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    return np.stack([right, np.cross(towards, right)]), towards
