"""The part of the box that fails: which runs meet all requirements, over pairs of parameters."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from deployable.campaign.report.read import PageData

MOST_PARAMETERS = 3
"""Parameters that are drawn against each other: those by which failing runs differ most."""

MOST_MARKS = 400  # runs that are drawn, evenly chosen where there are more


@dataclass(frozen=True)
class Panel:
    """A scatter plot of runs over one or two parameters, or of trials of the best choice
    (`prices`), in shares of each axis. x_axis, y_axis: dict of a parameter or goal (name, units,
    lower, upper), y None for one parameter alone; marks: tuples of x, y, whether the run meets all
    (None: the choice itself), and whether its other parameters lie within the feasible part;
    feasible: lower and upper corner of the largest box about the nominal point without failures, or
    of the choice's range that keeps all requirements, or None; runs: of each mark the index in
    `PageData.verdicts`, of trials the chosen values by name."""

    x_axis: Mapping[str, Any]
    y_axis: Mapping[str, Any] | None
    marks: list[tuple[float, float, bool | None, bool]]
    feasible: tuple[tuple[float, float], tuple[float, float]] | None
    runs: list[int] | list[dict[str, float]]


def panels(data: PageData) -> list[Panel]:
    """Make scatter plots of failing and other runs, one for each pair of the (at most three)
    parameters whose mean differs most between these two groups, or one plot if one parameter alone
    varies; empty where all runs fail, or none does. data: all that the page shows."""
    if data.verdicts is None or not 0 < data.verdicts.met.sum() < len(data.verdicts.met):
        return []
    coords = [_scale(p, data.verdicts.values[:, k]) for k, p in enumerate(data.parameters)]
    free = [k for k, p in enumerate(data.parameters) if p["upper"] > p["lower"]]
    passes = data.verdicts.met
    free.sort(key=lambda k: -abs(coords[k][passes].mean() - coords[k][~passes].mean()))
    axes = sorted(free[:MOST_PARAMETERS])
    pairs: list[tuple] = [*combinations(axes, 2)] or [(axes[0], None)]
    kinds, most = [np.flatnonzero(passes), np.flatnonzero(~passes)], MOST_MARKS // 2
    counts = [max(most, MOST_MARKS - len(rest)) for rest in reversed(kinds)]
    marks = [  # evenly chosen of those that meet all, then of others
        runs[np.linspace(0, len(runs) - 1, min(count, len(runs))).round().astype(int)]
        for runs, count in zip(kinds, counts, strict=True)
    ]
    return [_panel(data, coords, np.concatenate(marks), *pair) for pair in pairs]


def _panel(data: PageData, coords: list, runs: np.ndarray, i: int, j: int | None) -> Panel:
    share = data.facts["together"]["max_interval_scale"]
    nominal = [_scale(p, p["nominal"]) for p in data.parameters]
    ends = [(middle * (1 - share), middle + share * (1 - middle)) for middle in nominal]
    pairs = zip(coords, ends, strict=True)
    in_part = [(values >= low) & (values <= high) for values, (low, high) in pairs]
    rest = [k for k in range(len(coords)) if share > 0 and k not in (i, j)]
    is_near = np.all([in_part[k] for k in rest], axis=0) if rest else np.full(len(coords[i]), True)
    y_values = np.full(len(is_near), 0.5) if j is None else coords[j]
    in_frame = in_part[i] & (True if j is None else in_part[j]) & (share > 0)
    runs = runs[~(in_frame & ~is_near & ~data.verdicts.met)[runs]]
    places = np.column_stack([coords[i][runs], y_values[runs]]).astype(float).tolist()
    flags = zip(data.verdicts.met[runs].tolist(), is_near[runs].tolist(), strict=True)
    marks = [(round(x, 4), round(y, 4), *f) for (x, y), f in zip(places, flags, strict=True)]
    feasible = zip(ends[i], (0.0, 1.0) if j is None else ends[j], strict=True)
    frame: Any = tuple((float(x), float(y)) for x, y in feasible) if share > 0 else None
    y_axis = None if j is None else data.parameters[j]
    return Panel(data.parameters[i], y_axis, marks, frame, runs.tolist())


def prices(facts: Mapping[str, Any]) -> list[Panel]:
    """Make plots of the trials of the best choice, which comes last: each of its (at most two)
    goals over the value of the one chosen parameter; of several parameters the second goal over the
    first, or the one goal over the first parameter. Left out are trials whose goal, the latest time
    of an event, is within 5 % of the end of the runs. Returns [] without a choice, or if fewer than
    two trials remain or a goal of one is unknown. facts: as of `facts_of`."""
    choice = facts.get("choice")
    if choice is None:
        return []
    parameters, goals = choice["parameters"], choice["goals"]
    values, goal_values = ([row["value"] for row in rows] for rows in (parameters, goals))
    best = {"values": values, "goals": goal_values, "kept": None}
    ends = [0.95 * facts["duration"] if g["units"] == "s" and g["end"] == "upper" else np.inf
            for g in goals]  # fmt: skip
    trials = [
        trial for trial in (*choice["tried"], best)
        if (np.nan_to_num(np.array(trial["goals"], float), nan=np.inf) <= ends).all()
    ]  # fmt: skip
    columns = np.array([(t["values"][0], *t["goals"][:2]) for t in trials], float).T
    if len(trials) < 2 or not np.isfinite(columns).all():
        return []
    names = [parameters[0]["name"], *(f"{g['quantity']} {_ENDS[g['end']]}" for g in goals[:2])]
    axes = [
        {"name": name, "units": row["units"], "lower": float(column.min()),
         "upper": float(column.max())}
        for name, row, column in zip(names, (parameters[0], *goals[:2]), columns, strict=True)
    ]  # fmt: skip
    shares = [_scale(axis, column).tolist() for axis, column in zip(axes, columns, strict=True)]
    frame, (x, *ys) = None, range(len(axes))
    if len(parameters) > 1 and len(axes) > 2:
        x, *ys = ys
    elif len(parameters) == 1 and (safe := parameters[0]["safe"]) is not None:
        low, high = (float(_scale(axes[0], value)) for value in safe)
        frame = (low, 0.0), (high, 1.0)
    chosen_names = [p["name"] for p in parameters]
    chosen_values = [dict(zip(chosen_names, trial["values"], strict=True)) for trial in trials]
    is_kept, is_near = [trial["kept"] for trial in trials], [True] * len(trials)
    return [
        Panel(axes[x], axes[y], [*zip(shares[x], shares[y], is_kept, is_near, strict=True)],
              frame, chosen_values)
        for y in ys
    ]  # fmt: skip


_ENDS = {"upper": "at most", "lower": "at least", "width": "known to"}


def _scale(parameter: Mapping[str, Any], values):
    """Values as shares of a parameter's interval."""
    width = parameter["upper"] - parameter["lower"]
    return (values - parameter["lower"]) / width if width > 0 else 0.0 * values
