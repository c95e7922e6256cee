"""Presets of a config: mesh, step, design, held-out runs and model that belong together.

They come from the study `snakemake -c2 tradeoff`, which measures what each costs and how wrong it
is (docs/tradeoff.md). A preset fills in what the config itself does not say.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from deployable.campaign.config.scenes import mesh_of

if TYPE_CHECKING:
    from deployable.campaign.config.sections import Campaign

# Smolyak's points on a line are the Lobatto points of the same order; in more directions they grow
# slowly. One order serves all.
PRESETS: dict[str, dict[str, Any]] = {
    "draft": {"elements": 8, "safety": 0.9, "order": 2, "held_out": 4},
    "standard": {"elements": 16, "safety": 0.9, "order": 4, "held_out": 3},
    "reference": {"elements": 32, "safety": 0.9, "order": 8, "held_out": 7},
}

# A design that polynomials can be taken from too; at the same runs a spline is less wrong.
METHOD, MODEL = "smolyak", "spline"


def with_preset(raw: Mapping) -> dict:
    """A copy of `raw` with what its `preset`, if it names one, says of absent keys.

    A config's own `design` counts as a whole: orders of one method mean nothing to another. The
    model belongs to the preset's design; it is left alone beside an alignment, which needs
    polynomials, and where there are more runs than a spline can take.
    """
    config = copy.deepcopy(dict(raw))
    if "preset" not in config:
        return config
    preset = PRESETS[config["preset"]]
    own = "design" in config
    config.setdefault("design", {"method": METHOD, "order": preset["order"]})
    if config["design"].get("method") != "scan":
        config.setdefault("held_out", preset["held_out"])
    bounds = config.setdefault("bounds", {})
    if not own and bounds.get("align", "none") == "none" and _spline_takes(config):
        bounds.setdefault("model", MODEL)
    solver = config.setdefault("solver", {})
    if "step" not in solver:
        solver.setdefault("safety", preset["safety"])
    mesh = mesh_of(config["scene"])
    if mesh is not None:
        parameters = config["scene"].setdefault("parameters", {})
        parameters.setdefault(mesh, preset["elements"])
    return config


def mesh_of_preset(raw: Mapping, campaign: Campaign) -> str:
    """What a config's preset makes of the structure's own mesh, in words; "" where it does not."""
    mesh = mesh_of(raw["scene"]) if "preset" in raw else None
    if mesh is None or mesh in (raw["scene"].get("parameters") or {}):
        return ""
    own = campaign.experiment.scene_type.parameters[mesh].default
    found = campaign.experiment.scene.parameters[mesh]
    if own == found:
        return ""
    return (
        f"preset {raw['preset']} takes {mesh} = {found}, not the structure's own {own}; to keep "
        f"that, state scene.parameters.{mesh}"
    )


def _spline_takes(config: Mapping) -> bool:
    """Whether a spline can take the runs of the preset's design, held-out and nominal ones too."""
    from deployable.intervals import MAX_RUNS, IntervalError, make_design

    try:
        nodes = make_design(METHOD, len(config["intervals"]), config["design"]["order"]).runs
    except IntervalError:
        return False
    return nodes + config["held_out"] + 1 <= MAX_RUNS
