"""The presets of a config in the study: their designs, and what each costs and how wrong it is."""

import math

from campaign.presets import METHOD, PRESETS
from studies.tradeoff_cases import Choice, Level

MODELS = ("polynomial", "spline")


def preset_choices(level: Level) -> tuple[Choice, ...]:
    """What the presets that have the level's mesh and step do, and the same with the other model.

    The nominal run, at the centre of the box, is a point of all their designs.
    """
    return tuple(
        Choice(METHOD, preset["order"], model=model, preset=name)
        for name, preset in PRESETS.items()
        if (preset["elements"], preset["safety"]) == (level.elements, level.safety)
        for model in MODELS
    )


def cost_of(record: dict) -> tuple[int, float]:
    """Runs with the held-out ones, and their cpu time (s) in whole batches, bounds included."""
    runs = record["runs"] + record["held_out"]
    return runs, math.ceil(runs / record["lanes"]) * record["cpu_batch"] + record["cpu_bounds"]
