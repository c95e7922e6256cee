"""From the runs of a campaign to what of the box meets its requirements, `requirements.json`, whose
keys `summary.schema.json` describes.

The runs that decide were made with those of the quantities' ends."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from deployable.campaign.answers.evaluations import ModelEvaluator
from deployable.campaign.answers.limits import (
    LimitAssessment,
    assess_limits,
    describe_limit,
    is_refuted,
    is_shown,
    list_limits,
)
from deployable.campaign.config.sections import Jobs
from deployable.campaign.files import write_result
from deployable.campaign.folder import Folder
from deployable.campaign.results.quantity_results import QuantityResults, number
from deployable.campaign.runs.progress import Notify
from deployable.intervals.scalars import find_halving, shares_of_box

_RULE_OF_THREE = 3.0  # over a number of runs: share that none of them meets with a chance of 5 %


def answer(folder: Folder, requirements: Mapping[str, Mapping], jobs: Jobs, notify: Notify) -> None:
    """Assess in which part of the box the requirements are met, and write `requirements.json` into
    `folder`, which has `quantities.nc` and `refinement.nc`; nothing is simulated."""
    model = ModelEvaluator.from_folder(folder, jobs, notify, refinements=True)
    rows = judge(model, requirements, QuantityResults.read(folder).errors)
    write_result(folder.requirements, json.dumps(rows, indent=1, allow_nan=False) + "\n")


def judge(
    model: ModelEvaluator, requirements: Mapping[str, Mapping], errors: np.ndarray | None = None
) -> dict[str, Any]:
    """Find where in the box the requirements are met, in the form of `requirements.json`. errors
    (2, q): by mesh and step, of values and of decision functions, or None."""
    specs = list_limits(requirements, list(model.experiment.quantities))
    result = assess_limits(model, model.surrogates(), specs, errors)
    shares = _find_shares(model, result)
    return {
        "requirements": [_requirement(model, result, name, shares) for name in requirements],
        "together": {**_combine(model, result, shares), "whole": errors is not None},
        "runs": len(model.distinct_rows) + model.rest_count + len(model.failed_points),
        "further_runs": len(model.refinements),
    }


_Shares = Mapping[tuple[int, ...], tuple[float, float]]


def _find_shares(model: ModelEvaluator, result: LimitAssessment) -> _Shares:
    """Share of the box that keeps limits and in which no run fails, and what is open, by their
    indices: of each limit, of those of a requirement, and of all."""
    sets: list[tuple[int, ...]] = [(i,) for i in range(len(result.specs))]
    sets += [_indices(result, spec.requirement) for spec in result.specs]
    sets = list(dict.fromkeys([*sets, tuple(range(len(result.specs)))]))
    soundness = result.limits[len(result.specs) :]
    limits = [[result.limits[i] for i in indices] + soundness for indices in sets]
    return dict(zip(sets, shares_of_box(limits, model.experiment.box.free), strict=True))


def _indices(result: LimitAssessment, name: str) -> tuple[int, ...]:
    """Indices of the limits of a requirement."""
    return tuple(i for i, spec in enumerate(result.specs) if spec.requirement == name)


def _judge_limits(
    model: ModelEvaluator, result: LimitAssessment, limits: tuple[int, ...], shares: _Shares
) -> dict:
    """Return whether all, some or none of the box keeps chosen limits, which share, and what is
    open. All is open where no run varies a parameter, as with runs of a user's own."""
    row = _judge_runs(model, result, limits, shares)
    if model.experiment.box.constant_names(model.points):
        row["met"] = "undecided" if row["met"] == "all" else "some"
        row["share_uncertainty"] = 1.0
    return row


def _judge_runs(
    model: ModelEvaluator, result: LimitAssessment, indices: tuple[int, ...], shares: _Shares
) -> dict:
    """Judge limits as `_judge_limits` does, if the runs vary every parameter. Runs decide where
    they agree with the surrogates up to the error. If no run keeps a limit, that proves nothing,
    and the share is unknown."""
    (fraction, open_), rows = shares[indices], list(indices)
    is_met = result.margins[rows].min(axis=0) >= 0
    runs = len(model.distinct_rows) + model.rest_count + len(model.failed_points)
    # What so many runs in any places miss with a chance of 5 % is not excluded.
    bound = min(1.0, _RULE_OF_THREE / runs)
    if any(result.margins[i].min() >= 0 and not is_shown(model, result, i) for i in indices):
        open_ = max(open_, bound)
    row = {"share": fraction, "share_uncertainty": open_, "runs": runs}
    if is_met.all() and not len(model.failed_points):
        # Where surrogates break what all runs keep, no run shows it.
        row["share_uncertainty"] = max(open_, 1.0 - fraction)
        is_kept = min(result.worst[i][0] for i in indices) >= 0
        sure = is_kept and not open_ and all(is_shown(model, result, i) for i in indices)
        if not sure:
            row["share_uncertainty"] = max(row["share_uncertainty"], bound)
        return {"met": "all" if sure else "undecided", **row, "share": 1.0 if is_kept else fraction}
    if fraction > 0 or is_met.any():
        return {"met": "some", **row}
    violated_limits = [i for i in indices if not (result.margins[i] >= 0).any()]
    if violated_limits and not any(is_refuted(model, result, i) for i in violated_limits):
        return {"met": "some", **row, "share_uncertainty": 1.0}
    return {"met": "none", **row}


def _requirement(
    model: ModelEvaluator, result: LimitAssessment, name: str, shares: _Shares
) -> dict:
    indices = _indices(result, name)
    verdict = _judge_limits(model, result, indices, shares)
    rows = [_judge_limits(model, result, (i,), shares) for i in indices]
    limits = [_limit(model, result, i) | row for i, row in zip(indices, rows, strict=True)]
    return {"name": name, **verdict, "limits": limits}


def _limit(model: ModelEvaluator, result: LimitAssessment, i: int) -> dict:
    """Return the limit with its worst place: that of the surrogate, or a run that is worse."""
    (margin, point), runs, spec = result.worst[i], result.margins[i], result.specs[i]
    if runs.min() < margin:
        margin, point = float(runs.min()), model.points[runs.argmin()]
    error = number(result.limits[i].error)
    fields = {"margin": number(margin), "error": error, "kept": bool(margin >= 0)}
    free, halved = model.experiment.box.free.astype(float), {}
    for j in np.flatnonzero(free):
        middle = np.where(np.arange(len(free)) == j, model.nominal, 0.0)
        size = np.where(np.arange(len(free)) == j, 0.5, 1.0) * free
        worst, _ = result.limits[i].worst(middle / 2 - size, middle / 2 + size)
        halved[model.experiment.box.names[j]] = number(worst)
    fields["halved"] = halved
    return {**describe_limit(model, spec), **fields, **model.describe_point(point, spec.quantity)}


def _combine(model: ModelEvaluator, result: LimitAssessment, shares: _Shares) -> dict:
    largest, index, _ = result.largest
    row = {
        **_judge_limits(model, result, tuple(range(len(result.specs))), shares),
        "max_interval_scale": largest,
        "unsampled": result.doubt is not None and bool(model.find_missing([result.doubt])),
    }
    row["halved"] = _halve_intervals(model, result, row["share_uncertainty"] >= 1)
    is_broken = result.margins[:, model.distinct_rows].min(axis=0) < 0
    count = int(is_broken.sum()) + len(model.failed_points)
    row["failures"] = None if model.rest_count else count
    if index is None or index == len(result.specs):
        return {**row, "fails": None}
    spec = result.specs[index]
    fails = {"requirement": spec.requirement, **describe_limit(model, spec)}
    point: Any = result.failure_point
    fails |= model.describe_point(point, spec.quantity)
    fails["error"] = number(result.limits[index].error)
    simulated = np.nan if fails["simulated"] is None else fails["simulated"]
    fails["kept"] = bool(fails["ran"] and result.limits[index].find_margins(simulated) >= 0)
    return {**row, "fails": fails}


def _halve_intervals(
    model: ModelEvaluator, result: LimitAssessment, is_unknown: bool
) -> dict[str, dict[str, float]]:
    """Return the share that meets all if one interval were half as wide, by the parameter's name.
    It is unknown where that of the whole box is (`is_unknown`)."""
    box, rows = model.experiment.box, {}
    for j in np.flatnonzero(box.free):
        row = find_halving(result.limits, box.free, model.nominal, int(j))._asdict()
        for key in ("share_uncertainty", "gain_uncertainty"):
            row[key] = 1.0 if is_unknown else row[key]
        rows[box.names[j]] = row
    return rows
