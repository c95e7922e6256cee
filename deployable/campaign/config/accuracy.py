"""`accuracy` of a config: one key that chooses mesh, step, design, number of runs and model.

What it chooses is settled in rounds (`campaign.plan.accuracy`); here a config with it gets the keys
that they begin with.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

from deployable.campaign.config.scenes import mesh_of, scene_type
from fpm.errors import did_you_mean

CHOSEN = ("design", "bounds", "held_out")
"""Keys that a config with `accuracy` must not have: it chooses what they say."""

SOUGHT = "sought"
"""The method of a design whose runs are sought round by round; no config can ask for it alone."""

NONE = {"shares": {}, "runs": 0, "minutes": 0.0, "mesh": ""}


def with_accuracy(raw: Mapping) -> dict:
    """A copy of `raw` with what its `accuracy`, if it has one, says of other keys.

    The mesh starts at half of the structure's own, and is refined from there, unless the config
    gives one.
    """
    config = copy.deepcopy(dict(raw))
    if "accuracy" not in config:
        return config
    given = config["accuracy"]
    config["accuracy"] = dict(given) if isinstance(given, Mapping) else {"share": given}
    for key in CHOSEN:
        config.pop(key, None)
    config |= {"design": {"method": SOUGHT, "order": None}, "held_out": 0}
    config["bounds"] = {"model": "spline"}
    config.setdefault("verify", {})["finer"] = True
    scene = config["scene"]
    mesh = mesh_of(scene)
    parameters = scene.setdefault("parameters", {})
    if mesh is not None and mesh not in parameters:
        known = scene_type(scene.get("name", ""), scene.get("file", "")).parameters[mesh]
        parameters[mesh] = int(max(known.lower, 2, known.default // 2))
        config["accuracy"]["mesh"] = mesh
    return config


def accuracy_data(config: Mapping) -> dict[str, Any]:
    """The section as plain data of an `Accuracy`, from a config that is filled in."""
    if "accuracy" not in config:
        return NONE
    given = config["accuracy"]
    names = [*config["responses"], *config["quantities"]]
    shares = {name: float(given["of"].get(name, given["share"])) for name in names}
    budget = {"runs": given["runs"], "minutes": float(given["minutes"])}
    return {"shares": shares, "mesh": given.get("mesh", ""), **budget}


def accuracy_problems(raw: Mapping) -> list[str]:
    """What does not go together with `accuracy`, one sentence each."""
    if "accuracy" not in raw:
        return []
    problems = [
        f"{key}: not allowed beside accuracy, which chooses it; allowed: one of the two"
        for key in CHOSEN
        if key in raw
    ]
    known = [*raw.get("responses", {}), *raw.get("quantities", {})]
    given = raw["accuracy"]
    for name in given.get("of", {}) if isinstance(given, Mapping) else ():
        if name not in known:
            problems.append(
                f"accuracy.of.{name}: there is no such response or quantity"
                f"{did_you_mean(name, known)}; allowed: {', '.join(known)}"
            )
    return problems
