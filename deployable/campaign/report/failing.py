"""The part of the box that fails: which runs meet all requirements, seen along two parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from deployable.campaign.report.data import PageData

MOST_PARAMETERS = 3
"""Parameters that are drawn against each other: those by which failing runs differ most."""

MOST_MARKS = 400
"""Runs that are drawn, evenly chosen where there are more."""


@dataclass(frozen=True)
class Panel:
    """The box along two parameters, or one: marks (x, y, met, near) of runs and the part in which
    nothing fails, from `kept[0]` to `kept[1]`; coordinates from 0 to 1. Runs are near where all
    other parameters lie in that part."""

    across: Mapping[str, Any]
    up: Mapping[str, Any] | None
    marks: list[tuple[float, float, bool, bool]]
    kept: tuple[tuple[float, float], tuple[float, float]] | None


def meets(limits: Iterable[Mapping], names: Sequence[str], numbers: np.ndarray) -> np.ndarray:
    """Which runs (R,) meet all limits of the summary's requirements, from their quantities (R, q)
    by name; not a number is what does not happen, and breaks any limit but `happens: false`."""
    from deployable.intervals.scalars import Limit

    met = np.ones(len(numbers), dtype=bool)
    for limit in limits:
        value = numbers[:, list(names).index(limit["quantity"])]
        met &= Limit(None, limit["kind"], limit["level"]).slack_of(value) >= 0
    return met


def panels(data: PageData) -> list[Panel]:
    """The panels of a page; none where there is nothing that fails, or nothing that meets all."""
    if data.judged is None or data.judged.met.all() or not data.judged.met.any():
        return []
    unit = [_unit(p, data.judged.values[:, k]) for k, p in enumerate(data.parameters)]
    free = [k for k, p in enumerate(data.parameters) if p["upper"] > p["lower"]]
    met = data.judged.met
    free.sort(key=lambda k: -abs(unit[k][met].mean() - unit[k][~met].mean()))
    chosen = sorted(free[:MOST_PARAMETERS])
    pairs = list(combinations(chosen, 2)) or [(chosen[0], None)]
    few = min(MOST_MARKS, len(met))
    runs = np.linspace(0, len(met) - 1, few).round().astype(int)
    runs = runs[np.argsort(~met[runs], kind="stable")]  # what fails lies above
    return [_panel(data, unit, runs, *pair) for pair in pairs]


def _panel(data: PageData, unit: list, runs: np.ndarray, i: int, j: int | None) -> Panel:
    share = data.facts["together"]["largest_share"]
    nominal = [_unit(p, p["nominal"]) for p in data.parameters]
    ends = [(middle * (1 - share), middle + share * (1 - middle)) for middle in nominal]
    near = np.ones(len(data.judged.met), dtype=bool)
    for k, (low, high) in enumerate(ends):
        if share > 0 and k not in (i, j):
            near &= (unit[k] >= low) & (unit[k] <= high)
    up = np.full(len(near), 0.5) if j is None else unit[j]
    marks = zip(unit[i][runs], up[runs], data.judged.met[runs], near[runs], strict=True)
    kept = zip(ends[i], (0.0, 1.0) if j is None else ends[j], strict=True)
    return Panel(
        data.parameters[i],
        None if j is None else data.parameters[j],
        [(round(float(x), 4), round(float(y), 4), bool(met), bool(by)) for x, y, met, by in marks],
        tuple((float(x), float(y)) for x, y in kept) if share > 0 else None,
    )


def _unit(parameter: Mapping[str, Any], values):
    """Values as shares of a parameter's interval."""
    width = parameter["upper"] - parameter["lower"]
    return (values - parameter["lower"]) / width if width > 0 else 0.0 * values
