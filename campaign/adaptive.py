"""`order: auto`: rounds of runs until the error meets a tolerance or the budget is spent.

Each round has a plan (`rounds/<round>/nodes.json`) with one more entry, `adaptive`: the finished
`rounds` so far, the unit coordinates of all `points` that were nodes, and, in the plan after the
last round, which has no new runs, whether the tolerance is `met`. What comes next is decided by
`intervals.decide`; here files become its arguments and its decision a plan.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from campaign.nodes import make_design, make_plan
from campaign.parameters import intervals_of

_START = {"tensor_roots": 3}  # the paper's order; 2 for the others


def start_config(config: Mapping) -> dict:
    """The config of the first round: a low order in each direction that has a width."""
    import fpm

    intervals, _ = intervals_of(config, fpm.scenes.get(config["scene"]["name"]))
    order = _START.get(config["design"]["method"], 2)
    orders = [order if i.upper > i.lower else 0 for i in intervals.values()]
    return _settled(config, orders)


def first_plan(config: Mapping) -> dict:
    """The plan of round 0 of a config with `order: auto`."""
    return _plan(start_config(config), [], [])


def next_plan(
    config: Mapping, plan: Mapping, samples_path: str | Path, bounds_path: str | Path
) -> dict:
    """The plan after a finished round: a better design, or the same with the reason to stop."""
    import intervals as interval_side

    design, spent = plan["config"]["design"], plan["adaptive"]["points"]
    rounds, parts = plan["adaptive"]["rounds"], design.get("parts", [])
    now = interval_side.Specification(
        design["method"],
        tuple(design["order"]),
        tuple((tuple(low), tuple(high)) for low, high in parts),
    )
    error, tails = _measure(plan, samples_path, bounds_path)
    decision = interval_side.decide(
        interval_side.Progress(
            specification=now,
            error=error,
            tails=tails,
            points=np.array(spent),
            tolerance=config["design"]["tolerance"],
            budget=config["design"]["budget"],
            history=[entry["error"] for entry in rounds if entry["parts"] == parts],
            free=[up > low for low, up in zip(plan["lower"], plan["upper"], strict=True)],
        )
    )
    entry = {
        "order": list(now.order),
        "parts": parts,
        "runs": len(spent),
        "error": error,
        "action": decision.action,
        "reason": _named(decision.reason, plan["names"]),
    }
    rounds = [*rounds, entry]
    if decision.action == "stop":
        return {**plan, "adaptive": {"rounds": rounds, "points": spent, "met": decision.met}}
    wanted = decision.specification
    return _plan(_settled(config, list(wanted.order), wanted.parts, spent), rounds, spent)


def is_finished(plan: Mapping) -> bool:
    """Whether this is the plan after the last round."""
    return "met" in plan["adaptive"]


def _named(reason: str, names: list[str]) -> str:
    """The reason with parameters by name: `intervals.decide` knows directions by number only."""

    def name(match: re.Match) -> str:
        numbers = [int(number) for number in re.findall(r"\d+", match[1])]
        return ", ".join(names[number] for number in numbers)

    return re.sub(r"direction (\d+(?:, \d+)*)", name, reason)


def _plan(config: Mapping, rounds: list[dict], spent: list[list[float]]) -> dict:
    """The plan of a settled config; runs of earlier designs that it leaves out test it."""
    plan = make_plan(config, spent)
    points = {tuple(point): point for point in spent}
    for run in plan["runs"]:
        if run["role"] == "node":
            points.setdefault(tuple(run["unit"]), run["unit"])
    return {**plan, "adaptive": {"rounds": rounds, "points": list(points.values())}}


def _settled(config: Mapping, order: list[int], parts: Any = (), existing: Any = ()) -> dict:
    """The config with the design of one round in the place of `auto`."""
    design = {**config["design"], "order": order}
    if parts:
        design["parts"] = [[list(low), list(high)] for low, high in parts]
    elif design["method"] == "total_degree" and len(existing):
        design["existing"] = existing
    return {**config, "design": design}


def _measure(
    plan: Mapping, samples_path: str | Path, bounds_path: str | Path
) -> tuple[float, list[float]]:
    """Error of the bounds as a share of their width in the worst response, and by direction."""
    import xarray as xr

    import fpm
    from intervals import measure_round

    config = plan["config"]
    named, _ = intervals_of(config, fpm.scenes.get(config["scene"]["name"]))
    with xr.open_dataset(samples_path) as samples, xr.open_dataset(bounds_path) as bounds:
        return measure_round(samples, bounds, make_design(config, named))
