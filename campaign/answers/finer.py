"""What mesh and step add to the error: the runs at the places that decide again, once with half the
step and once on a mesh twice as fine."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from campaign.answers.bench import NEAR, Bench, runs_at
from campaign.answers.ends import Ends
from campaign.config.scenes import mesh_of
from campaign.config.sections import Jobs, plain_data
from campaign.folder import Folder
from campaign.plan.make import choose_step
from campaign.plan.plan import Plan, read_plan
from campaign.runs.progress import Tell

PLACES = 8
"""Places at which runs are repeated for the responses: eight side by side cost what three do."""


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


def finer_curves(
    folder: Folder, bounds: Any, jobs: Jobs, tell: Tell, threads: int = 1
) -> dict[str, np.ndarray]:
    """Errors (n, T) of `step` and `mesh` by name, for the bounds of a campaign in `folder`.

    They are what half the step, and a mesh twice as fine, change at the places near which the
    bounds are attained; no mesh where no parameter sets it.
    """
    import intervals

    bench = Bench(read_plan(folder.plan), jobs, folder, tell, threads)
    box = bench.experiment.box
    attained = [box.to_unit(bounds[name].values) for name in ("argmin", "argmax")]
    width = (bounds["upper"] - bounds["lower"]).values
    places = intervals.deciding_places(*attained, width, PLACES)
    usual = _curves(bench, bench.plan, places.unit)
    found = {
        name: places.errors(_curves(bench, plan, places.unit) - usual)
        for name, plan in _plans(bench.plan).items()
    }
    told = " and ".join(f"{name} finer" for name in found)
    tell(f"{bench.experiment.name}: {len(places.unit)} runs at places that decide, with {told}")
    return found


def _curves(bench: Bench, plan: Plan, unit: np.ndarray) -> np.ndarray:
    """Responses (P, n, T) of a plan's runs at unit points (P, k); planned runs are found again."""
    known = plan.runs.unit
    points = []
    for point in unit:
        apart = np.abs(known - point).max(axis=1)
        points.append(known[apart.argmin()] if apart.min() <= NEAR else point)
    records = bench.records(plan, runs_at(plan, points))
    return np.array([record.values for record in records])


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
