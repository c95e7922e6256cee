"""The structure as it stands at some moments, for browsers that cannot move it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from deployable.campaign.pictures.moments import telling_moments
from deployable.campaign.pictures.paint import limits_of, visible_faces
from deployable.campaign.pictures.solid import solid_of_motion
from deployable.campaign.pictures.view import View

if TYPE_CHECKING:
    import xarray

_MOMENTS = 3
_WIDE = 300  # units of the drawing, of each moment


def still(motion: xarray.Dataset) -> str:
    """An SVG picture of a whole motion, its moments side by side."""
    shown, view = telling_moments(motion, _MOMENTS), View()
    solid = solid_of_motion(motion, shown)
    low, high = limits_of(solid.places, view, margin=0.03)
    unit = _WIDE / max(high - low)
    parts = []
    for moment in range(_MOMENTS):
        start = np.array([_WIDE * (moment + 0.5) - unit * (low[0] + high[0]) / 2, unit * high[1]])
        faces, colours = visible_faces(solid, moment, view)
        lines = (solid.cable_points[moment] @ view.page.T)[solid.cables.stretches]
        for corners, colour in zip(faces, np.rint(255 * colours).astype(int), strict=True):
            parts.append(
                f'<path fill="#{bytes(colour.tolist()).hex()}" d="{_path(corners, start, unit)}Z"/>'
            )
        parts += [f'<path class="cable" d="{_path(line, start, unit)}"/>' for line in lines]
    tall = unit * (high - low)[1]
    return f'<svg viewBox="0 0 {_MOMENTS * _WIDE} {tall:.0f}">{"".join(parts)}</svg>'


def _path(places: np.ndarray, start: np.ndarray, unit: float) -> str:
    """Places (p, 2), m upwards, as a path downwards."""
    points = start + unit * places * [1, -1]
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
