"""What mesh and step add to the error: the deciding runs again, once with half the step and once on
a mesh twice as fine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from campaign.answers.bench import Bench, runs_at
from campaign.answers.ends import Ends
from campaign.config.scenes import mesh_of
from campaign.config.sections import plain_data
from campaign.plan.make import choose_step
from campaign.plan.plan import Plan


def finer_errors(bench: Bench, ends: list[Ends]) -> dict[str, np.ndarray]:
    """Errors (q,) of `step` and `mesh` by name: the largest change of each quantity at the runs of
    its ends. NaN where it has none, or happens in one of both runs only; no mesh where no parameter
    sets it.
    """
    found = {}
    for name, plan in _plans(bench.plan).items():
        points = np.array([at for end in ends for at in (end.argmin, end.argmax)])
        there = np.isfinite(points).all(axis=1)
        numbers = np.full((len(points), len(ends)), np.nan)
        if there.any():
            numbers[there] = bench.measure(plan, runs_at(plan, points[there]))
        errors = np.full(len(ends), np.nan)
        for q, end in enumerate(ends):
            if np.isfinite(end.lower):
                changes = numbers[2 * q : 2 * q + 2, q] - (end.lower, end.upper)
                errors[q] = np.abs(changes).max()
        found[name] = errors
    return found


def _plans(plan: Plan) -> dict[str, Plan]:
    """The plan with half the step, and with a mesh twice as fine."""
    time, experiment = plan.time, plan.experiment
    halved = replace(time, step=time.step / 2, steps_per_instant=2 * time.steps_per_instant)
    plans = {"step": replace(plan, time=halved)}
    scene = plain_data(experiment.scene)
    asked = {"file": scene["file"]} if scene["file"] else {"name": scene["name"]}
    if mesh := mesh_of(asked):
        usual = experiment.scene_type.parameters[mesh].default
        finer = {**experiment.scene.parameters}
        finer[mesh] = 2 * finer.get(mesh, usual)
        other = replace(experiment, scene=replace(experiment.scene, parameters=finer))
        # A step that was given may be too long for the finer mesh.
        stable = choose_step(replace(other, solver=replace(other.solver, step="auto")))
        step = min(time.step, stable.step)
        plans["mesh"] = replace(plan, experiment=other, time=replace(stable, step=step))
    return plans
