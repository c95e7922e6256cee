"""Plots of the calibration: the paper's two numbers, the misfit and the closing times over K_F."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from evidence import plots
from evidence.calibration.findings import rigid_closings
from evidence.calibration.scans import CLOSE, DURATION, PAPER, Scan
from evidence.linkage.runs import default

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Lines differ by dash as well, for grey prints.
STYLES = (
    {"color": plots.BLUE, "linestyle": (0, (4, 1.5))},
    {"color": plots.VERMILION, "linestyle": (0, (5, 1, 1, 1))},
    {"color": plots.GREEN, "linestyle": ":"},
    {"color": plots.PURPLE, "linestyle": (0, (1, 1))},
)
LABELS = {"BD": "distance BD (m)", "vBz": "z-velocity of B (m/s)"}


def _pick(scans: list[Scan], word: str) -> list[Scan]:
    return [s for s in scans if word in s.reading.label]


def _starts(scans: list[Scan]) -> list[Scan]:
    """Scans of other starts, without those of the paper's angle."""
    return [s for s in _pick(scans, "start ") if "μ" not in s.reading.label]


def _default(ax: Axes, scan: Scan, values: list | np.ndarray) -> None:
    mesh, start = default("elements"), default("start")
    label = f"default: {mesh} elements, start {start:g}°"
    ax.plot(scan.K_F, values, "k.-", linewidth=1, markersize=3, label=label, zorder=5)
    ax.axvline(default("K_F"), color="0.4", linewidth=0.8, linestyle="--", zorder=1)


def _finish(ax: Axes, label: str) -> None:
    ax.set_xlabel("K_F (N/rad)")
    ax.set_ylabel(label, fontsize=8)
    ax.set_ylim(bottom=0)
    ax.legend(fontsize=7, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)


def numbers(scans: list[Scan]) -> Figure:
    """Both largest differences over K_F, with the paper's values as lines."""
    figure, axes = plots.panels(2, 1, (6.4, 5.6))
    for ax, name in zip(axes, PAPER, strict=True):
        _default(ax, scans[0], [n.largest[name] for n in scans[0].numbers])
        _band(ax, _starts(scans), name)
        for scan, style in zip(_pick(scans, "elements"), STYLES, strict=False):
            values = [n.largest[name] for n in scan.numbers]
            ax.plot(scan.K_F, values, linewidth=1.1, label=scan.reading.label, **style)
        ax.axhline(PAPER[name], color=plots.VERMILION, linewidth=1.5, label=f"paper: {PAPER[name]}")
        _finish(ax, f"largest difference of the bounds\n{LABELS[name]}")
        ax.set_xlim(4.4, 6.8)
    return figure


def _band(ax: Axes, starts: list[Scan], name: str) -> None:
    """What all starts together span, where there are any."""
    if not starts:
        return
    values = np.array([[n.largest[name] for n in s.numbers] for s in starts])
    angles = [dict(s.reading.parameters)["start"] for s in starts]
    label = f"starts from {min(angles):g}° to {max(angles):g}°"
    low, high = values.min(axis=0), values.max(axis=0)
    style = {"color": plots.SKY, "alpha": 0.3, "linewidth": 0}
    ax.fill_between(starts[0].K_F, low, high, label=label, **style)


def misfit(scans: list[Scan]) -> Figure:
    """Misfit over K_F: meshes and starts near the best value, and the other supports."""
    figure, (narrow, wide) = plots.panels(2, 1, (6.4, 6.0))
    main = scans[0]
    for k in main.K_F[main.fits]:
        narrow.axvspan(k - 0.0125, k + 0.0125, color=plots.YELLOW, alpha=0.4, linewidth=0, zorder=0)
    for scan in _starts(scans):
        narrow.plot(scan.K_F, scan.misfit, color="0.7", linewidth=0.6, zorder=1)
    narrow.plot([], [], color="0.7", linewidth=0.6, label="other starts")
    narrow.fill_between([], [], color=plots.YELLOW, alpha=0.4, label=f"default within {CLOSE:.0%}")
    supports = _pick(scans, "A ") + _pick(scans, "μ_B")
    for ax, group in ((narrow, _pick(scans, "elements")), (wide, supports)):
        _default(ax, main, main.misfit)
        for scan, style in zip(group, STYLES, strict=False):
            ax.plot(scan.K_F, scan.misfit, linewidth=1.1, label=scan.reading.label, **style)
        _finish(ax, "misfit (about the relative error)")
    narrow.set_xlim(4.7, 7.3)
    return figure


def closures(scans: list[Scan]) -> Figure:
    """Closing times over K_F: all samples of the default reading, and the law 1/sqrt(K_F)."""
    figure, (ax,) = plots.panels(size=(6.4, 4.0))
    main, k = scans[0], default("K_F")
    for index, (name, colour) in enumerate((("first", plots.BLUE), ("second", plots.VERMILION))):
        times = np.array([n.closure(index) for n in main.numbers])
        finite = np.isfinite(times).all(axis=1)
        low, high = times[finite].min(axis=1), times[finite].max(axis=1)
        label = f"{name} closure of the samples, a ± 1 %"
        ax.fill_between(main.K_F[finite], low, high, color=colour, alpha=0.8, label=label)
    for time, style in zip(rigid_closings(k)[:2], ("-", "--"), strict=False):
        law = time * np.sqrt(k / main.K_F)
        ax.plot(main.K_F, law, "k", linewidth=0.9, linestyle=style, label="rigid linkage, 1/√K_F")
    for name, marker in (("BD", "."), ("vBz", "+")):
        instants = [n.times[name] for n in main.numbers]
        ax.plot(main.K_F, instants, marker, color="0.5", markersize=3, label=f"largest in {name}")
    ax.axhline(DURATION, color="0.3", linewidth=0.8)
    _finish(ax, "time (s)")
    ax.set_ylim(0, 1.3)
    return figure
