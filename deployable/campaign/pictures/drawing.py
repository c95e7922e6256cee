"""A structure as it stands, with points, joints, cables, supports, and at moments of its motion."""

from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.files import whole_file
from deployable.campaign.pictures import make_figure
from deployable.campaign.pictures.paint import (
    View,
    frame_picture,
    limits_of,
    paint_cables,
    paint_points,
    paint_solid,
)
from deployable.campaign.pictures.solid import solid_of_motion, solid_of_scene, values_in

SUFFIXES = (".png", ".svg", ".pdf")
_HINGE = {"color": "black", "linewidth": 0.9, "zorder": 4}
_MARKER = {"marker": "^", "color": "none", "markeredgecolor": "black", "markersize": 6, "zorder": 5}


WIDTH = 6.0  # width of the figure, in inches; the height follows from the structure


def draw_structure(scene: Any) -> Any:
    """Draw a structure where it starts, with named points, axes of hinges, cables and supports, as
    a matplotlib figure, not saved yet. scene: an `fpm.Scene`, which holds the structure."""
    view, solid = View(), solid_of_scene(scene)
    points = {name: _place(scene, beam) for name, beam in scene.points.items()}
    supports = scene.position[scene.fixed[:, :3].all(axis=1)]
    is_on_beam = np.zeros(len(scene.position), bool)
    for beams in scene.beams:
        is_on_beam[beams.nodes.ravel()] = True
    particles = np.flatnonzero(is_on_beam | ~scene.fixed.all(axis=1))  # the ground's has no place
    places = [solid.corners, solid.cable_points, scene.position[particles], *points.values()]
    limits = limits_of(np.vstack([np.reshape(p, (-1, 3)) for p in places]), view)
    x_span, y_span = limits[1] - limits[0]
    size = max(x_span, y_span)
    height = WIDTH * min(1.1, (y_span + 0.2 * size) / x_span)
    figure = make_figure(figsize=(WIDTH, height))
    ax = figure.add_axes((0, 0, 1, 1))
    frame_picture(ax, limits, view)
    if len(solid.nodes):
        paint_solid(ax, solid, 0, view)
    paint_cables(ax, solid, 0, view)
    for hinge in scene.hinges:
        first = hinge.beams[0]
        place, axis = _place(scene, first), scene.frame[first.particle] @ hinge.axes[0]
        ends = np.stack([place - 0.02 * size * axis, place + 0.02 * size * axis])
        ax.plot(*(ends @ view.page.T).T, **_HINGE)
    flat = supports @ view.page.T
    for place in supports[((flat >= limits[0]) & (flat <= limits[1])).all(axis=1)]:
        ax.plot(*(view.page @ place), **_MARKER)
    particles = np.setdiff1d(particles, solid.nodes)
    ax.plot(*(scene.position[particles] @ view.page.T).T, "o", color="black", markersize=4)
    paint_points(ax, points, view, size)
    return figure


def write_structure(scene: Any, path: str | Path) -> Path:
    """Draw the structure of an `fpm.Scene` where it starts into the file `path`, which ends with
    one of `SUFFIXES` (.png, .svg, .pdf), and return `path`."""
    path = Path(path)
    with whole_file(path) as temporary:
        draw_structure(scene).savefig(temporary, dpi=160)
    return path


def _place(scene: Any, beam: Any) -> np.ndarray:
    """Return the global end point of a virtual beam."""
    return scene.position[beam.particle] + scene.frame[beam.particle] @ beam.arm


def telling_moments(motion: Any, count: int) -> np.ndarray:
    """Choose `count` frames of a whole motion, evenly along the particles' mean paths, from the
    start to the first closure of a contact, or to the end."""
    time, position = values_in(motion, "time"), values_in(motion, "position")
    is_closing = values_in(motion, "contact_event_closing") == 1
    closures = values_in(motion, "contact_event_time")[is_closing]
    last = int(np.abs(time - closures.min()).argmin()) if len(closures) else len(time) - 1
    last = max(last, 1)
    steps = np.sqrt(np.square(np.diff(position[: last + 1], axis=0)).sum(axis=2).mean(axis=1))
    path_length = np.concatenate([[0.0], steps.cumsum()])
    targets = np.linspace(0.0, path_length[-1], count)
    return np.array([int(np.abs(path_length - target).argmin()) for target in targets])


def draw_moments(motion: Any, count: int = 5, width: float = 7.5) -> Any:
    """Draw a structure at moments of its motion, side by side, as an unsaved matplotlib figure.

    Parameters
    ----------
    motion: whole motion (`fpm.solver.motion`), an open `xarray.Dataset` or `netCDF4.Dataset`.
    count: number of moments, evenly spread over the length of the particles' paths, up to the first
        closure of a contact or else the end.
    width: width of the figure, in inches."""
    view, indices = View(), telling_moments(motion, count)
    solid = solid_of_motion(motion, indices)
    limits = limits_of(solid.places, view, margin=0.02)
    x_span, y_span = limits[1] - limits[0]
    shape = min(2.6, (y_span + 0.2 * max(x_span, y_span)) / x_span)  # of a panel
    figure = make_figure(figsize=(width, width / count * shape + 0.2))
    height = figure.get_figheight()
    for moment, time in enumerate(values_in(motion, "time")[indices]):
        ax = figure.add_axes((moment / count, 0, 1 / count, 1 - 0.2 / height))
        frame_picture(ax, limits, view, signs=moment == 0)
        if len(solid.nodes):
            paint_solid(ax, solid, moment, view)
            paint_cables(ax, solid, moment, view)
        else:
            ax.plot(*(view.page @ solid.position[moment].T), "o", color="black", markersize=3)
        ax.set_title(f"{time:.3g} s", fontsize=8, pad=2)
    return figure
