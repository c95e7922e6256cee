"""`accuracy` of a config: one key that chooses mesh, step, design, number of runs and model.

What it chooses is settled in rounds (`campaign.plan.accuracy`); here a config with it gets what
they begin with.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from deployable.campaign.config.models import Aim, BoundsChoice, Config
from deployable.campaign.config.sections import Accuracy, DesignChoice
from fpm.errors import did_you_mean

CHOSEN = ("design", "bounds", "held_out")
"""Keys that a config with `accuracy` must not have: it chooses what they say."""

SOUGHT = "sought"
"""The method of a design whose runs are sought round by round; no config can ask for it alone."""


def with_accuracy(config: Config, scene_type: Any) -> tuple[Config, Accuracy]:
    """The config with what its `accuracy` chooses, and that with all names.

    The mesh starts at half of the structure's own, and is refined from there, unless the config
    gives one.
    """
    aim, scene, mesh = config.accuracy, config.scene, scene_type.mesh
    aim = aim if isinstance(aim, Aim) else Aim(share=aim)
    if mesh is None or mesh in scene.parameters:
        mesh = ""
    else:
        known = scene_type.parameters[mesh]
        start = int(max(known.lower, 2, known.default // 2))
        scene = replace(scene, parameters={**scene.parameters, mesh: start})
    names = [*config.responses, *config.quantities]
    shares = {name: aim.of.get(name, aim.share) for name in names}
    config = replace(
        config,
        scene=scene,
        design=DesignChoice(SOUGHT, None),
        bounds=BoundsChoice("spline"),
        held_out=0,
        verify=replace(config.verify, finer=True),
    )
    return config, Accuracy(shares, aim.runs, aim.minutes, mesh)


def accuracy_problems(config: Config, given: Mapping) -> list[str]:
    """What does not go together with `accuracy`, one sentence each; given: keys of the config."""
    if config.accuracy is None:
        return []
    problems = [
        f"{key}: not allowed beside accuracy, which chooses it; allowed: one of the two"
        for key in CHOSEN
        if key in given
    ]
    known = [*config.responses, *config.quantities]
    for name in config.accuracy.of if isinstance(config.accuracy, Aim) else ():
        if name not in known:
            problems.append(
                f"accuracy.of.{name}: there is no such response or quantity"
                f"{did_you_mean(name, known)}; allowed: {', '.join(known)}"
            )
    return problems
