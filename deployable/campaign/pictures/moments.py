"""A structure at some moments of its motion, side by side."""

from typing import Any

import numpy as np

from deployable.campaign.pictures.figure import make_figure
from deployable.campaign.pictures.paint import frame_picture, limits_of, paint_cables, paint_solid
from deployable.campaign.pictures.solid import solid_of_motion, values_in
from deployable.campaign.pictures.view import View


def telling_moments(motion: Any, count: int) -> np.ndarray:
    """Choose `count` frames of a whole motion, evenly along the particles' paths, from the start to
    the first closure of a contact, or to the end. Length along the paths is the sum of the root
    mean square of the particles' displacements."""
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
    motion: whole motion (`fpm.motions`), an open `xarray.Dataset` or `netCDF4.Dataset`.
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
