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
    """The box along two parameters, or one: marks (x, y, met, near) of `runs`, by their places
    among all that are judged, and the part in which nothing fails, from `kept[0]` to `kept[1]`;
    coordinates from 0 to 1. Runs are near where all other parameters lie in that part."""

    across: Mapping[str, Any]
    up: Mapping[str, Any] | None
    marks: list[tuple[float, float, bool, bool]]
    kept: tuple[tuple[float, float], tuple[float, float]] | None
    runs: list[int]


def meets(limits: Iterable[Mapping], names: Sequence[str], numbers: np.ndarray) -> np.ndarray:
    """Which runs (R,) meet all limits of the summary's requirements, from their quantities (R, q)
    by name; not a number is what does not happen, and breaks any limit but `happens: false`."""
    from deployable.intervals.scalars import Limit

    met = np.ones(len(numbers), dtype=bool)
    for limit in limits:
        value = numbers[:, list(names).index(limit["quantity"])]
        met &= Limit(None, limit["kind"], limit["level"]).slack_of(value) >= 0
    return met


def _tells_apart(data: PageData) -> bool:
    """Whether some runs fail and some meet all requirements."""
    return data.judged is not None and 0 < data.judged.met.sum() < len(data.judged.met)


def panels(data: PageData) -> list[Panel]:
    """The panels of a page; none where there is nothing that fails, or nothing that meets all."""
    if not _tells_apart(data):
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
    inside = [
        (values >= low) & (values <= high) for values, (low, high) in zip(unit, ends, strict=True)
    ]
    others = [k for k in range(len(unit)) if share > 0 and k not in (i, j)]
    near = np.all([inside[k] for k in others], axis=0) if others else np.full(len(unit[i]), True)
    up = np.full(len(near), 0.5) if j is None else unit[j]
    framed = inside[i] & (True if j is None else inside[j]) & (share > 0)
    runs = runs[~(framed & ~near & ~data.judged.met)[runs]]
    marks = zip(unit[i][runs], up[runs], data.judged.met[runs], near[runs], strict=True)
    kept = zip(ends[i], (0.0, 1.0) if j is None else ends[j], strict=True)
    return Panel(
        data.parameters[i],
        None if j is None else data.parameters[j],
        [(round(float(x), 4), round(float(y), 4), bool(met), bool(by)) for x, y, met, by in marks],
        tuple((float(x), float(y)) for x, y in kept) if share > 0 else None,
        runs.tolist(),
    )


def lines(data: PageData) -> list[tuple[int, bool, list[float]]]:
    """Of more parameters than panels show each run, whether it meets all requirements, and its
    place along each parameter, from 0 to 1; what fails lies above."""
    if len(data.parameters) <= MOST_PARAMETERS or not _tells_apart(data):
        return []
    unit = np.array([_unit(p, data.judged.values[:, k]) for k, p in enumerate(data.parameters)])
    return [
        (int(run), bool(data.judged.met[run]), unit[:, run].round(4).tolist())
        for run in np.argsort(~data.judged.met, kind="stable")[-MOST_MARKS:]
    ]


def prices(facts: Mapping[str, Any]) -> Panel | None:
    """The choices that were tried: both goals, or the one over the first chosen parameter. Those
    whose latest time is the end of the runs are left out: it has none."""
    found = facts.get("choice")
    if found is None:
        return None
    aims = [
        {"name": f"{goal['quantity']} {_ENDS[goal['end']]}", "units": goal["units"]}
        for goal in found["goals"][:2]
    ]
    late = [g["units"] == "s" and g["end"] == "upper" for g in found["goals"]]
    best = {"values": [p["value"] for p in found["parameters"]], "kept": None}
    best["goals"] = [goal["value"] for goal in found["goals"]]
    rows, kept = [], []
    for one in [*found["tried"], best]:
        goals = [np.inf if value is None else value for value in one["goals"]]
        if not (np.array(late) & (np.array(goals) > 0.95 * facts["duration"])).any():
            rows.append(goals[:2] if len(aims) > 1 else [one["values"][0], goals[0]])
            kept.append(one["kept"])
    places = np.array(rows)
    if len(aims) == 1:
        aims.insert(0, {key: found["parameters"][0][key] for key in ("name", "units")})
    if len(rows) < 2 or not np.isfinite(places).all():
        return None
    across, up = (
        {**aim, "lower": float(column.min()), "upper": float(column.max())}
        for aim, column in zip(aims, places.T, strict=True)
    )
    unit = zip(_unit(across, places[:, 0]), _unit(up, places[:, 1]), kept, strict=True)
    return Panel(across, up, [(float(x), float(y), met, True) for x, y, met in unit], None, [])


_ENDS = {"upper": "at most", "lower": "at least", "width": "known to"}


def _unit(parameter: Mapping[str, Any], values):
    """Values as shares of a parameter's interval."""
    width = parameter["upper"] - parameter["lower"]
    return (values - parameter["lower"]) / width if width > 0 else 0.0 * values
