"""Colours that colour-blind people can tell apart (Okabe and Ito), and those of stresses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray

BARS = ("#E69F00", "#56B4E9", "#009E73", "#CC79A7", "#F0E442", "#0072B2", "#D55E00")
"""Of bars, in their order; repeated where there are more."""

BLUE, RED = BARS[5:]  # of lower and upper, kept and broken

BODY = "#999999"
"""Of rigid bodies, where bars have the colours of their stress."""

CABLE = BLUE

PIN = "#1D2327"
"""Of the axes of hinges."""

SCALE = "viridis"
"""Map of colours, even to the eye and for colour-blind people; the page has it too."""

CLIPPED_SHARE = 0.005  # share of all values that lie beyond the end of the scale


def rgb(colour: str) -> tuple[float, float, float]:
    """Split a hexadecimal colour such as `#E69F00` into red, green and blue, each 0 to 1."""
    red, green, blue = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return red, green, blue


def stress_colours(motion: xarray.Dataset) -> tuple[np.ndarray, float]:
    """Colour a motion's m elements by equivalent stress: colours (T, m, 3), 0 to 1, at T frames,
    and the stress (Pa) at which the scale, from 0, ends, which 0.5 % of the values exceed. Rigid
    bodies are grey. motion: a run's whole motion, a dataset (`fpm.solver.motion`)."""
    from matplotlib import colormaps

    nodes, stress = motion["element_particle"].values, motion["stress"].values
    bars = nodes[:, 0] != nodes[:, 1]
    top = float(np.quantile(stress[:, bars], 1 - CLIPPED_SHARE)) if bars.any() else 0.0
    colours = np.tile(np.array(rgb(BODY)), (*stress.shape, 1))
    colours[:, bars] = colormaps[SCALE](stress[:, bars] / (top or 1.0))[..., :3]
    return colours, top


def draw_scale(figure: Any, top: float) -> None:
    """Draw a legend of stress colours, 0 to `top` (Pa), at a matplotlib figure's upper right."""
    from matplotlib.ticker import EngFormatter

    ax = figure.add_axes((0.58, 0.94, 0.32, 0.018))
    ax.imshow(np.linspace(0, 1, 256)[None], aspect="auto", cmap=SCALE, extent=(0, 1, 0, 1))
    ax.set_yticks([])
    ax.set_xticks([0, 1], ["0", EngFormatter("Pa")(float(f"{top:.3g}"))])
    ax.tick_params(labelsize=7, length=0, pad=2)
    ax.set_title("equivalent stress", fontsize=7, pad=2)
