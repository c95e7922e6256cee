"""Envelope figures in the manner of the paper's Figure 4, and sensitivities.

Colours are those of Okabe and Ito, which colour-blind people can tell apart; bounds differ by dash
as well, so that a grey print can be read.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from campaign.files import open_netcdf, whole_file
from campaign.units import pretty

LOWER = {"color": "#0072B2", "linestyle": (0, (4, 1.5)), "linewidth": 1.1, "label": "lower bound"}
UPPER = {
    "color": "#D55E00",
    "linestyle": (0, (5, 1, 1, 1)),
    "linewidth": 1.1,
    "label": "upper bound",
}
NOMINAL = {"color": "black", "linestyle": "-", "linewidth": 0.8, "label": "nominal run"}
KINDS = ("png", "pdf")


def draw_envelopes(bounds_path: str | Path, config: Mapping, folder: str | Path) -> None:
    """Draw `<response>.png` and `.pdf` of all responses into `folder`."""
    with open_netcdf(bounds_path) as bounds:
        for name in bounds.responses.split():
            save(envelope(bounds, name, config["error"]["shade_above"]), Path(folder) / name)


def envelope(bounds: Any, name: str, shade_above: float) -> Any:
    """A figure of one response: lower and upper bound, nominal run, and where the error is large.

    `bounds` is the open `bounds.nc`. Instants are shaded at which the error estimate exceeds
    `shade_above` times the largest width of the bounds.
    """
    from matplotlib.figure import Figure

    time, lower, upper = (bounds[key][:] for key in ("time", f"{name}_lower", f"{name}_upper"))
    units = pretty(getattr(bounds[f"{name}_lower"], "units", "1"))
    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    ax = figure.subplots()
    ax.fill_between(time, lower, upper, color="0.85", linewidth=0, zorder=1)
    ax.plot(time, lower, zorder=3, **LOWER)
    ax.plot(time, upper, zorder=3, **UPPER)
    if f"{name}_nominal" in bounds.variables:
        ax.plot(time, bounds[f"{name}_nominal"][:], zorder=4, **NOMINAL)
    if f"{name}_error" in bounds.variables:
        doubtful = bounds[f"{name}_error"][:] > shade_above * (upper - lower).max()
        _shade(ax, time, doubtful, f"error estimate above {shade_above:.0%} of the largest width")
    _mark_largest(ax, time, lower, upper, units)
    label = bounds[f"{name}_lower"].long_name.removeprefix("lower bound of ")
    ax.set_xlabel("time (s)")
    ax.set_ylabel(f"{label} ({units})")
    ax.set_xlim(time[0], time[-1])
    ax.margins(y=0.08)
    ax.grid(color="0.9", linewidth=0.5)
    ax.set_axisbelow(True)
    figure.legend(loc="outside upper center", ncols=4, fontsize=7, frameon=False)
    return figure


def _shade(ax: Any, time: np.ndarray, where: np.ndarray, label: str) -> None:
    """Hatch the spans of time in which `where` holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], where.astype(int), [0]])))
    for count, (start, stop) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
        ax.axvspan(
            time[start],
            time[min(stop, len(time) - 1)],
            facecolor="#F0E442",
            edgecolor="0.6",
            hatch="///",
            alpha=0.25,
            linewidth=0,
            zorder=0,
            label=label if count == 0 else None,
        )


def _mark_largest(
    ax: Any, time: np.ndarray, lower: np.ndarray, upper: np.ndarray, units: str
) -> None:
    """Mark the largest difference of the bounds with an arrow and its size."""
    at = int((upper - lower).argmax())
    width = upper[at] - lower[at]
    if width <= 0:
        return
    arrow = {"arrowstyle": "<->", "color": "black", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (time[at], lower[at]), (time[at], upper[at]), arrowprops=arrow, zorder=5)
    left = time[at] > 0.5 * (time[0] + time[-1])
    ax.annotate(
        f"{width:.3g} {units}",
        (time[at], 0.5 * (lower[at] + upper[at])),
        xytext=(-6 if left else 6, 0),
        textcoords="offset points",
        ha="right" if left else "left",
        va="center",
        fontsize=8,
        zorder=6,
        bbox={
            "boxstyle": "round,pad=0.15",
            "facecolor": "white",
            "edgecolor": "none",
            "alpha": 0.8,
        },
    )


def save(figure: Any, path: Path) -> None:
    """Save as PNG and PDF, without the date, so that the same data give the same files."""
    for kind in KINDS:
        with whole_file(path.with_name(f"{path.name}.{kind}")) as temporary:
            metadata = {"CreationDate": None} if kind == "pdf" else {"Software": None}
            figure.savefig(temporary, dpi=200, metadata=metadata, bbox_inches="tight")
