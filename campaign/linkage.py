"""Pictures of a structure at moments of its motion, for the scenes that can be drawn."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

# The six faces of a box as indices into its eight corners (see `_bennett_bars`).
_FACES = ((0, 1, 2, 3), (4, 5, 6, 7), *((i, j, j + 4, i + 4) for i, j in pairwise((0, 1, 2, 3, 0))))
_BAR_COLOURS = ("#E69F00", "#56B4E9", "#E69F00", "#56B4E9")


def moments(opening: np.ndarray, count: int) -> np.ndarray:
    """Indices of `count` instants from the start to the first closure, evenly spread in opening.

    `opening` (time) is that of a hinge, 0 when deployed. Without a closure, to its least value.
    """
    shut = np.flatnonzero(opening <= 0)
    last = int(shut[0]) if len(shut) else int(opening.argmin())
    wanted = np.linspace(opening[0], opening[last], count)
    return np.array([int(np.abs(opening[: last + 1] - value).argmin()) for value in wanted])


def draw_nominal(samples_path: str | Path, folder: Path, config: Mapping, out: Path) -> None:
    """Draw the nominal run, whose trajectory is in `folder`, as `linkage.png` and `.pdf` in `out`."""
    import netCDF4

    from campaign.figures import save

    with netCDF4.Dataset(samples_path) as samples:
        nominal = list(samples["role"][:]).index("nominal")
        run = samples["run_id"][nominal]
    figure = draw(Path(folder) / f"{run}.nc", config["figures"]["moments"])
    save(figure, Path(out) / "linkage")


def draw(trajectory_path: str | Path, count: int) -> Any:
    """A figure of the structure at `count` moments; its scene is one of `BARS`."""
    import netCDF4

    with netCDF4.Dataset(trajectory_path) as trajectory:
        hinge = list(trajectory["hinge"][:]).index("B")
        opening = np.asarray(trajectory["opening"][:, hinge])
        indices = moments(opening, count)
        times = np.asarray(trajectory["time"][indices])
        places = np.asarray(trajectory["position"][indices])
        points = {name: places[:, i] for i, name in enumerate(trajectory["point"][:])}
        bars_of = BARS[trajectory.scene]
        bars = bars_of(trajectory.__dict__, np.maximum(opening[indices], 0.0))
    return _figure(bars, points, times, np.degrees(opening[indices]))


def _bennett_bars(attributes: Mapping[str, Any], opening: np.ndarray) -> np.ndarray:
    """Corners (moment, bar, 8, 3) of the four mitred bars, placed by the opening at hinge B (rad).

    The bars are drawn straight: on the scale of the picture their bending cannot be seen.
    """
    from fpm.scenes.bennett_geometry import bennett_geometry

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
    return np.stack(
        [
            pose.origin[:, i, None, :] + np.einsum("mij,cj->mci", pose.rotation[:, i], shape)
            for i, shape in enumerate(shapes)
        ],
        axis=1,
    )


BARS: dict[str, Callable[[Mapping[str, Any], np.ndarray], np.ndarray]] = {"bennett": _bennett_bars}


def _figure(bars: np.ndarray, points: Mapping, times: np.ndarray, degrees: np.ndarray) -> Any:
    """Draw bars (moment, bar, 8, 3) in parallel projection, one panel a moment."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb
    from matplotlib.figure import Figure

    view, depth_axis = _view(azimuth=-60.0, elevation=22.0)
    light = np.array([0.4, -0.5, 0.77])
    figure = Figure(figsize=(2.1 * len(times), 2.6), layout="constrained")
    axes = figure.subplots(1, len(times), sharex=True, sharey=True, squeeze=False)[0]
    for panel, ax in enumerate(axes):
        faces, colours, depths = [], [], []
        for bar, colour in zip(bars[panel], _BAR_COLOURS, strict=True):
            for face in _FACES:
                corners = bar[list(face)]
                normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
                normal /= np.linalg.norm(normal)
                brightness = 0.55 + 0.45 * abs(normal @ light)
                faces.append(corners @ view.T)
                colours.append(tuple(brightness * channel for channel in to_rgb(colour)))
                depths.append((corners @ depth_axis).mean())
        order = np.argsort(depths)
        ax.add_collection(
            PolyCollection(
                [faces[i] for i in order],
                facecolors=[colours[i] for i in order],
                edgecolors="black",
                linewidths=0.4,
            )
        )
        centre = np.mean([place[panel] for place in points.values()], axis=0)
        for name, place in points.items():
            at, away = view @ place[panel], view @ (place[panel] - centre)
            away = 0.05 * away / max(np.linalg.norm(away), 1e-9)
            ax.plot(*at, "o", color="black", markersize=2.5)
            ax.annotate(name, at + away, fontsize=8, ha="center", va="center")
        ax.set_title(f"t = {times[panel]:.3f} s\nopening at B {degrees[panel]:.0f}°", fontsize=8)
        ax.set_aspect("equal")
        ax.axis("off")
        ax.autoscale_view()
    return figure


def _view(azimuth: float, elevation: float) -> tuple[np.ndarray, np.ndarray]:
    """Rows that project to the page (2, 3) and the direction to the eye; angles in degrees."""
    a, e = np.radians([azimuth, elevation])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    return np.stack([right, np.cross(towards, right)]), towards
