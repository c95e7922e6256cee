"""What mesh and step add to the error: the runs at the places that decide again, once with half the
step, and once with that on a mesh twice as fine.

Each part is what changes beside the runs before: a finer mesh takes half the step anyway, which so
counts once, and all that changes is at most the sum of the parts.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from deployable.campaign.answers.bench import Bench, runs_at
from deployable.campaign.answers.ends import Ends, settle
from deployable.campaign.config.scenes import mesh_of
from deployable.campaign.config.sections import Jobs, Verify, plain_data
from deployable.campaign.folder import Folder
from deployable.campaign.plan.make import choose_step
from deployable.campaign.plan.plan import Plan
from deployable.campaign.runs.progress import Tell

PLACES = 8
"""Places at which runs are repeated for the responses: eight side by side cost what three do."""

BESIDE = 0.1
"""In unit coordinates: a planned run so near a place stands for it."""


PARTS = ("step", "mesh")


def finer_parts(plan: Plan, verify: Verify) -> tuple[str, ...]:
    """Which of step and mesh the bounds of a plan are to be checked for."""
    if plan.experiment.is_sought:
        return plan.adaptive.check
    return PARTS if verify.finer else ()


def check_bounds(
    folder: Folder, bounds: Any, jobs: Jobs, tell: Tell, threads: int = 1, parts: tuple = PARTS
) -> Any:
    """The bounds' dataset of a campaign in `folder` with the errors of `step` and `mesh` added.

    Of an `accuracy`, whose rounds look at quantities too, it also has ``quantity_error_<part>``
    over quantity.
    """
    from deployable import intervals

    bench = Bench.of(folder, jobs, tell, threads)
    found = intervals.add_errors(bounds, _curve_errors(bench, bounds, parts))
    if bench.experiment.is_sought and bench.experiment.quantities:
        errors = finer_errors(bench, settle(bench, 0), parts)
        text = "change of the ends with a finer {}".format
        found = found.assign(
            {
                f"quantity_error_{name}": ("quantity", values, {"long_name": text(name)})
                for name, values in errors.items()
            }
        )
    told = " and ".join(parts)
    tell(f"{bench.experiment.name}: the places that decide were run again with a finer {told}")
    return found


def finer_errors(bench: Bench, ends: list[Ends], parts: tuple = PARTS) -> dict[str, np.ndarray]:
    """Errors (q,) of `step` and `mesh` by name: the largest change of each quantity at the runs of
    its ends. NaN where it has none, or happens in one of both runs only; no mesh where no parameter
    sets it.
    """
    points = np.array([at for end in ends for at in (end.argmin, end.argmax)])
    there = np.isfinite(points).all(axis=1)
    before = np.array([(end.lower, end.upper) for end in ends])
    found = {}
    for name, plan in _plans(bench.plan, parts).items():
        numbers = np.full((len(points), len(ends)), np.nan)
        if there.any():
            numbers[there] = bench.measure(plan, runs_at(plan, points[there]))
        # Of quantity q, the numbers of the runs at its two ends.
        now = np.array([numbers[2 * q : 2 * q + 2, q] for q in range(len(ends))])
        found[name] = np.abs(now - before).max(axis=1)
        before = now
    return found


def _curve_errors(bench: Bench, bounds: Any, parts: tuple) -> dict[str, np.ndarray]:
    """Errors (n, T) by part: what a finer step or mesh changes at the places near which the bounds
    are attained, which are those of planned runs where there are some nearby."""
    from deployable import intervals

    box = bench.experiment.box
    attained = [box.to_unit(bounds[name].values) for name in ("argmin", "argmax")]
    width = (bounds["upper"] - bounds["lower"]).values
    places = intervals.deciding_places(*attained, width, PLACES)
    known = bench.plan.runs.unit
    apart = np.abs(known - places.unit[:, None]).max(axis=2)
    nearest = apart.argmin(axis=1)
    points = np.where(apart.min(axis=1)[:, None] <= BESIDE, known[nearest], places.unit)
    before, found = _curves(bench, bench.plan, points), {}
    for name, plan in _plans(bench.plan, parts).items():
        now = _curves(bench, plan, points)
        found[name] = places.errors(now - before)
        before = now
    return found


def _curves(bench: Bench, plan: Plan, unit: np.ndarray) -> np.ndarray:
    """Responses (P, n, T) of a plan's runs at unit points (P, k)."""
    return np.array([record.values for record in bench.records(plan, runs_at(plan, unit))])


def _plans(plan: Plan, parts: tuple) -> dict[str, Plan]:
    """The plan with half the step, and with that on a mesh twice as fine, those that are asked."""
    time, experiment, plans = plan.time, plan.experiment, {}
    if "step" in parts:
        time = replace(time, step=time.step / 2, steps_per_instant=2 * time.steps_per_instant)
        plans["step"] = replace(plan, time=time)
    scene = plain_data(experiment.scene)
    asked = {"file": scene["file"]} if scene["file"] else {"name": scene["name"]}
    if "mesh" in parts and (mesh := mesh_of(asked)):
        usual = experiment.scene_type.parameters[mesh].default
        finer = {**experiment.scene.parameters}
        finer[mesh] = 2 * finer.get(mesh, usual)
        other = replace(experiment, scene=replace(experiment.scene, parameters=finer))
        # The step may be too long for the finer mesh.
        stable = choose_step(replace(other, solver=replace(other.solver, step="auto")))
        step = min(time.step, stable.step)
        plans["mesh"] = replace(plan, experiment=other, time=replace(stable, step=step))
    return plans
