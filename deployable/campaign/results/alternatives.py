"""A picture of the choices that were tried: what each would be worth, and where two
aims trade off."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.folder import Folder
from deployable.campaign.pictures.colours import BLUE, RED
from deployable.campaign.results.facts import read_json
from deployable.campaign.results.figures import save
from deployable.campaign.text.numbers import pretty, quantity

_GREY = "0.6"
_LABELS = 6


def draw_alternatives(folder: Folder, place: str | Path) -> None:
    """Draw `alternatives.png`, `.pdf` and `.svg` into `place`."""
    save(alternatives(read_json(folder.choice)), Path(place) / "alternatives")


def alternatives(found: Mapping, width: float = 6.4) -> Any:
    """A figure of what `choice.json` holds; width in inches.

    With two goals, the choices in the plane of both; with one goal, the goal over the first chosen
    parameter. Hollow where a requirement is not kept over the whole box about the choice.
    """
    from matplotlib.figure import Figure

    tried = [one for one in found["tried"] if None not in one["goals"]]
    goals, first = found["goals"], found["parameters"][0]
    values = np.array([one["values"] for one in tried]).reshape(-1, len(found["parameters"]))
    worth = np.array([one["goals"] for one in tried]).reshape(-1, len(goals))
    kept = np.array([one["kept"] for one in tried], dtype=bool)
    figure = Figure(figsize=(width, 0.62 * width), layout="constrained")
    ax = figure.subplots()
    several = len(goals) > 1
    x, y = (worth[:, 0], worth[:, 1]) if several else (values[:, 0], worth[:, 0])
    if values.shape[1] == 1:
        ax.plot(x, y, color=_GREY, lw=0.8, zorder=1)
    ax.plot(x[~kept], y[~kept], "o", mfc="white", mec=RED, ms=5, label="breaks a requirement")
    ax.plot(x[kept], y[kept], "o", color=BLUE, ms=5, label="meets all over its box")
    best = [goal["value"] for goal in goals[:2]]
    best = best if several else [first["value"], *best]
    chosen = [f"{p['name']} = {quantity(p['value'], p['units'])}" for p in found["parameters"]]
    how = {"marker": "*", "color": "black", "label": "best choice"}
    if not found["kept"]:
        how = {"marker": "D", "mfc": "none", "mec": RED, "label": "none meets all; misses least"}
    ax.plot(*best, ls="", ms=12, **how | {"label": f"{how['label']}: {', '.join(chosen)}"})
    ax.margins(0.1)
    if several and values.shape[1] == 1:
        for i in np.unique(np.linspace(0, len(x) - 1, _LABELS).round().astype(int)):
            ax.annotate(
                f"{first['name']} = {values[i, 0]:.3g}", (x[i], y[i]), (6, 4), fontsize=7,
                textcoords="offset points",
            )  # fmt: skip
    ax.set_xlabel(_aim(goals[0]) if several else f"{first['name']} ({pretty(first['units'])})")
    ax.set_ylabel(_aim(goals[1] if several else goals[0]))
    figure.legend(loc="outside upper left", fontsize=8, frameon=False)
    return figure


def _aim(goal: Mapping) -> str:
    return f"{goal['end']}({goal['quantity']}) ({pretty(goal['units'])}), {goal['sense']}"
