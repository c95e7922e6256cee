"""Plots of the calibration: the paper's two numbers, the misfit and the closing times over K_F."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from studies.calibration import CLOSE, DURATION, PAPER, Scan, default

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito's colours; lines differ by dash and marker as well, for grey prints.
STYLES = (
    {"color": "#0072B2", "linestyle": (0, (4, 1.5))},
    {"color": "#D55E00", "linestyle": (0, (5, 1, 1, 1))},
    {"color": "#009E73", "linestyle": ":"},
    {"color": "#CC79A7", "linestyle": (0, (1, 1))},
)
LABELS = {"BD": "distance BD (m)", "vBz": "z-velocity of B (m/s)"}


def _figure(rows: int, height: float) -> tuple[Figure, list[Axes]]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, height), layout="constrained")
    axes = np.atleast_1d(figure.subplots(rows, 1)).tolist()
    for ax in axes:
        ax.grid(color="0.9", linewidth=0.5)
        ax.set_axisbelow(True)
    axes[-1].set_xlabel("K_F (N/rad)")
    return figure, axes


def _pick(scans: list[Scan], word: str) -> list[Scan]:
    return [s for s in scans if word in s.reading.label]


def _default(ax: Axes, scan: Scan, values: np.ndarray) -> None:
    mesh, start = default("elements_per_link"), default("start_deg")
    label = f"default: {mesh} elements, start {start:g}°"
    ax.plot(scan.K_F, values, "k.-", linewidth=1, markersize=3, label=label, zorder=5)
    ax.axvline(default("K_F"), color="0.4", linewidth=0.8, linestyle="--", zorder=1)


def numbers(scans: list[Scan]) -> Figure:
    """Both largest differences over K_F, with the paper's values as lines."""
    figure, axes = _figure(2, 5.6)
    main, starts = scans[0], _pick(scans, "start ")
    starts = [s for s in starts if "μ" not in s.reading.label]
    for ax, name in zip(axes, PAPER, strict=True):
        _default(ax, main, np.array([n.largest[name] for n in main.numbers]))
        if starts:
            values = np.array([[n.largest[name] for n in s.numbers] for s in starts])
            angles = [dict(s.reading.parameters)["start_deg"] for s in starts]
            ax.fill_between(
                starts[0].K_F, values.min(axis=0), values.max(axis=0), color="#56B4E9", alpha=0.3,
                linewidth=0, label=f"starts from {min(angles):g}° to {max(angles):g}°",
            )  # fmt: skip
        for scan, style in zip(_pick(scans, "elements"), STYLES, strict=False):
            values = [n.largest[name] for n in scan.numbers]
            ax.plot(scan.K_F, values, linewidth=1.1, label=scan.reading.label, **style)
        ax.axhline(PAPER[name], color="#D55E00", linewidth=1.5, label=f"paper: {PAPER[name]:g}")
        ax.set_ylabel(f"largest difference of the bounds\n{LABELS[name]}", fontsize=8)
        ax.set_ylim(bottom=0)
        ax.legend(fontsize=7, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)
        ax.set_xlim(4.4, 6.8)
    return figure


def misfit(scans: list[Scan]) -> Figure:
    """Misfit over K_F: meshes and starts near the best value, and the other supports."""
    figure, (near, wide) = _figure(2, 6.0)
    main = scans[0]
    for ax in (near, wide):
        _default(ax, main, main.misfit)
        ax.set_ylabel("misfit (about the relative error)", fontsize=8)
        ax.set_ylim(bottom=0)
    fitting = main.K_F[main.fits]
    for k in fitting:
        near.axvspan(k - 0.0125, k + 0.0125, color="#F0E442", alpha=0.4, linewidth=0, zorder=0)
    for scan, style in zip(_pick(scans, "elements"), STYLES, strict=False):
        near.plot(scan.K_F, scan.misfit, linewidth=1.1, label=scan.reading.label, **style)
    for scan in _pick(scans, "start "):
        if "μ" not in scan.reading.label:
            near.plot(scan.K_F, scan.misfit, color="0.7", linewidth=0.6, zorder=1)
    near.plot([], [], color="0.7", linewidth=0.6, label="other starts")
    near.fill_between([], [], color="#F0E442", alpha=0.4, label=f"default within {CLOSE:.0%}")
    others = _pick(scans, "A ") + _pick(scans, "μ_B")
    for scan, style in zip(others, STYLES, strict=False):
        wide.plot(scan.K_F, scan.misfit, linewidth=1.1, label=scan.reading.label, **style)
    for ax in (near, wide):
        ax.set_xlabel("K_F (N/rad)")
        ax.legend(fontsize=7, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)
    near.set_xlim(4.7, 7.3)
    return figure


def closures(scans: list[Scan]) -> Figure:
    """Closing times over K_F: all samples of the default reading, and the law 1/sqrt(K_F)."""
    from studies.calibration_report import rigid_closings

    figure, (ax,) = _figure(1, 4.0)
    main, k = scans[0], default("K_F")
    for which, (name, colour) in enumerate((("first", "#0072B2"), ("second", "#D55E00"))):
        times = np.array([n.closure(which) for n in main.numbers])
        seen = np.isfinite(times).all(axis=1)
        ax.fill_between(
            main.K_F[seen], times[seen].min(axis=1), times[seen].max(axis=1), color=colour,
            alpha=0.8, label=f"{name} closure of the samples, a ± 1 %",
        )  # fmt: skip
    rigid = rigid_closings(k)[:2]
    for time, style in zip(rigid, ("-", "--"), strict=False):
        law = time * np.sqrt(k / main.K_F)
        ax.plot(main.K_F, law, "k", linewidth=0.9, linestyle=style, label="rigid linkage, 1/√K_F")
    for name, marker in (("BD", "."), ("vBz", "+")):
        at = [n.at[name] for n in main.numbers]
        ax.plot(main.K_F, at, marker, color="0.5", markersize=3, label=f"largest in {name}")
    ax.axhline(DURATION, color="0.3", linewidth=0.8)
    ax.set_ylabel("time (s)")
    ax.set_ylim(0, 1.3)
    ax.legend(fontsize=7, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)
    return figure
