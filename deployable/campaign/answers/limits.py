"""The limits that requirements set, assessed by surrogates and by runs; and what of the box meets
the requirements, `requirements.json`, whose keys `summary.schema.json` describes.

The runs that decide were made with those of the quantities' ends."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from deployable.campaign.answers.evaluations import ModelEvaluator
from deployable.campaign.config.models import LIMITS
from deployable.campaign.files import write_result
from deployable.campaign.results.quantity_results import QuantityResults, number
from deployable.campaign.text import words_of
from deployable.intervals.scalars import (
    Limit,
    Occurrence,
    ScalarSurrogate,
    extreme,
    find_halving,
    find_least_scales,
    find_max_scale,
    fit_scalar,
    shares_of_box,
    sub_box,
)

_OVERSHOOT = 1e-3  # by how much farther from the nominal values than the border a run is made


@dataclass(frozen=True)
class LimitSpec:
    """One limit that a `requirement`, by name, sets on the quantity of index `quantity`. kind:
    "at_least", "at_most" or "happens"; level: bound in the quantity's unit; of "happens" 1 if the
    event must occur, 0 if it must not."""

    requirement: str
    quantity: int
    kind: str
    level: float


def list_limits(requirements: Mapping[str, Mapping], quantities: list[str]) -> list[LimitSpec]:
    """List all limits that requirements set, in their order. requirements: section of the config,
    limits by requirement and by quantity; quantities: names of all quantities, in order."""
    return [
        LimitSpec(name, quantities.index(quantity), kind, float(bounds[kind]))
        for name, limits in requirements.items()
        for quantity, bounds in limits.items()
        for kind in LIMITS
        if kind in bounds
    ]


@dataclass(frozen=True)
class LimitAssessment:
    """How l limits are kept over the box, by surrogates, and in R simulated runs. specs: the limits
    as the config sets them; limits: the same with their surrogates (`intervals.scalars.Limit`),
    and, where runs failed, a last one: that none fails, whose border only runs tell;
    margins (l, R): of limits in runs, below 0 if broken; worst: least margin of each limit in the
    box, and its normalized point (k); largest: scale (0 to 1) of the largest box about the nominal
    point in which all limits hold, then, if below 1, index of the limit that fails first beyond it,
    and where; failure_point (k): normalized, where a limit fails, None if none does; doubt (k):
    where a run is most likely to fail in that box, or at its border; None where no run failed;
    endless: indices of quantities that may have no upper end, so that no fit shows an upper limit
    on them."""

    specs: Sequence[LimitSpec]
    limits: list[Any]
    margins: np.ndarray
    worst: list[tuple[float, np.ndarray]]
    largest: tuple[float, int | None, np.ndarray | None]
    failure_point: np.ndarray | None
    doubt: np.ndarray | None = None
    endless: Sequence[int] = ()

    @property
    def points(self) -> list[np.ndarray]:
        """Normalized points (k) where a run would confirm or refute whether the limits hold: those
        of `worst`, in the order of the limits, then `failure_point` if a limit fails there."""
        is_of_limit = self.largest[1] not in (None, len(self.specs))
        points = [point for _, point in self.worst]
        return points if self.failure_point is None else points + [self.failure_point] * is_of_limit


def assess_limits(
    model: ModelEvaluator,
    surrogates: Sequence[Any],
    specs: Sequence[LimitSpec],
    errors: np.ndarray | None = None,
) -> LimitAssessment:
    """Assess limits (`specs`, as the config sets them) over the box by the surrogates of all
    quantities, and in the runs of `model`, to say where requirements are met. errors (2, q): by
    mesh and step, of values and of decision functions (sign: whether one exists), or None."""
    errors = np.zeros((2, len(surrogates))) if errors is None else errors
    limits = []
    for spec in specs:
        run_error, border_error = map(float, errors[:, spec.quantity])
        limits.append(
            Limit(surrogates[spec.quantity], spec.kind, spec.level, run_error, border_error)
        )
    upper, failed_points = model.experiment.box.free.astype(float), model.failed_points
    worst = [limit.worst(-upper, upper) for limit in limits]
    runs = np.concatenate([model.points, failed_points])
    if len(failed_points):
        border = Occurrence(runs, np.arange(len(runs)) < len(model.points))
        limits.append(Limit(ScalarSurrogate(None, border), "happens", 1.0))
    largest = find_max_scale(limits, model.nominal)
    margins = np.array([
        limit.find_margins(model.numbers[:, spec.quantity])
        for spec, limit in zip(specs, limits, strict=False)
    ])  # fmt: skip
    shares = margins / np.array([[limit.size] for limit in limits[: len(specs)]])
    index = np.append(shares.argmin(axis=0), [len(specs)] * len(failed_points)).astype(int)
    is_failing = np.append(margins.min(axis=0) < 0, [True] * len(failed_points))
    failing_rows = np.flatnonzero(is_failing)
    scales = find_least_scales(model.nominal, runs[failing_rows])
    failure_point = None
    if len(failing_rows) and scales.min() <= (1 + 2 * _OVERSHOOT) * largest[0]:
        # A run fails nearer than the surrogates' border, or at it.
        run = failing_rows[scales.argmin()]
        failure_point = runs[run]
        largest = min(largest[0], float(scales.min())), int(index[run]), failure_point
    elif largest[2] is not None:
        # A little beyond the border, so that the run there fails and does not only touch it.
        farther = np.clip((1 + _OVERSHOOT) * (largest[2] - model.nominal), -2, 2)
        failure_point = np.clip(model.nominal + farther, -upper, upper)
    doubt = failure_point
    if len(failed_points) and largest[1] != len(specs):
        inner = sub_box(model.nominal, largest[0])
        doubt = extreme(border.decision, -1.0, *inner, runs, climbs=1)[1]
    doubt = doubt if len(failed_points) else None
    return LimitAssessment(specs, limits, margins, worst, largest, failure_point, doubt)


def is_shown(
    model: ModelEvaluator, result: LimitAssessment, i: int, worst: float | None = None
) -> bool:
    """Return whether limit `i` (index) of an assessment, broken in no run, surely holds in the
    whole box, or in the part in which its least margin is `worst`: it exceeds the estimated errors,
    and, if the quantity may be absent, the event margin (how far a run is from losing or gaining
    it), fitted over the box, keeps its sign by more than its error. False where that margin is not
    known: runs prove nothing between them; True for a box without width. model: has the runs;
    result: the assessment."""
    limit, q = result.limits[i], result.specs[i].quantity
    if not model.experiment.box.free.any():
        return True
    worst = result.worst[i][0] if worst is None else worst
    if limit.kind == "at_most" and q in result.endless:
        return False
    if limit.kind != "happens" and not worst >= limit.error:
        return False
    sign = -1 if limit.kind == "happens" and not limit.level else 1
    return occurs(model, limit, q, sign)


def is_open(
    model: ModelEvaluator, result: LimitAssessment, i: int, worst: float | None = None
) -> bool:
    """Return whether runs alone tell that limit `i` holds, or that its quantity, which all runs
    have, exists in the whole box: between them it may not. worst: as of `is_shown`."""
    limit, q = result.limits[i], result.specs[i].quantity
    if result.margins[i].min() >= 0:
        return not is_shown(model, result, i, worst)
    is_everywhere = limit.kind != "happens" and np.isfinite(result.margins[i]).all()
    return is_everywhere and not occurs(model, limit, q)


def is_refuted(model: ModelEvaluator, result: LimitAssessment, i: int) -> bool:
    """Return whether limit `i` (index) of an assessment, which no run satisfies, is surely violated
    in the whole box. If some run has a value of the quantity: its largest limit margin in the box
    is below 0 by more than its estimated error (where it is absent, the limit is violated, too). If
    none has, or the limit is "happens": the event margin, fitted over the box, has everywhere the
    sign that violates the limit, by more than its error; False if a run's is not known. True for a
    box without width. model: has the runs; result: the assessment."""
    limit, q = result.limits[i], result.specs[i].quantity
    free = model.experiment.box.free
    if not free.any():
        return True
    if limit.kind == "happens":
        return _sure_occurrence(model, limit, q) == (-1 if limit.level else 1)
    if limit.surrogate.fit is None:
        return _sure_occurrence(model, limit, q) == -1
    return bool(limit.best(-free.astype(float), free.astype(float))[0] < -limit.error)


def occurs(model: ModelEvaluator, limit: Any, q: int, sign: int = 1) -> bool:
    """Return whether quantity `q` surely exists in the whole box; sign -1: whether it nowhere
    does."""
    always_exists = model.experiment.quantity_list[q].always_exists
    return always_exists or _sure_occurrence(model, limit, q) == sign


def _sure_occurrence(model: ModelEvaluator, limit: Any, q: int) -> int:
    """1 if the event of quantity `q` surely occurs in the whole box, -1 if nowhere, 0 if open."""
    margins = model.margins[:, q]
    if not np.isfinite(margins).all():
        return 0
    surrogate = fit_scalar(model.points, margins)
    margin_range, error = surrogate.range(), surrogate.error + limit.border_error
    return int(margin_range.low > error) - int(-margin_range.high > error)


def describe_limit(model: ModelEvaluator, spec: LimitSpec) -> dict:
    """Describe a limit (`spec`) as a dict for JSON: its quantity (name, units, words), kind
    ("at_most", "at_least", "happens") and level. model: has the quantities."""
    quantity = model.experiment.quantity_list[spec.quantity]
    level = bool(spec.level) if spec.kind == "happens" else spec.level
    description = {"quantity": quantity.name, "units": quantity.unit, **words_of(quantity)}
    return {**description, "kind": spec.kind, "level": level}


# -- the answer: what of the box meets the requirements --------------------------------------------

_RULE_OF_THREE = 3.0  # over a number of runs: share that none of them meets with a chance of 5 %


def answer(model: ModelEvaluator, requirements: Mapping[str, Mapping]) -> None:
    """Assess in which part of the box the requirements are met, and write `requirements.json` into
    the folder of `model`, which has all runs; nothing is simulated."""
    results = QuantityResults.read(model.folder)
    endless = [q for q, row in enumerate(results.rows) if row["may_be_endless"]]
    rows = judge(model, requirements, results.errors, endless)
    pairs = zip(results.rows, model.experiment.quantity_list, strict=True)
    quantities = {q.name: (row, q.least if q.always_exists else None) for row, q in pairs}
    for limit in (limit for row in rows["requirements"] for limit in row["limits"]):
        if reason := why_idle(limit, *quantities[limit["quantity"]]):
            limit["idle"] = reason
    write_result(model.folder.requirements, json.dumps(rows, indent=1, allow_nan=False) + "\n")


def why_idle(limit: Mapping, row: Mapping, least: float | None) -> str | None:
    """Return why a limit cannot fail, so that to meet it says nothing: its quantity has a physical
    lower bound, or the other sign in all runs, as where the size of a signed number is meant; None
    if it can fail. limit: its dict in the results; row: that of the quantity; least: that bound."""
    sign = {"at_most": 1, "at_least": -1}.get(limit["kind"], 0)
    if sign < 0 and least is not None and limit["level"] <= least:
        return f"is never below {least:g}"
    end = row["upper" if sign > 0 else "lower"]
    if not sign or end is None or not sign * limit["level"] > 0 > sign * end:
        return None
    return f"is {'negative' if sign > 0 else 'positive'} in all runs"


def judge(
    model: ModelEvaluator, requirements: Mapping[str, Mapping], errors: np.ndarray | None = None,
    endless: Sequence[int] = (),
) -> dict[str, Any]:  # fmt: skip
    """Find where in the box the requirements are met, in the form of `requirements.json`. errors
    (2, q): by mesh and step, of values and of decision functions, or None; endless: indices of
    quantities that may have no upper end."""
    specs = list_limits(requirements, list(model.experiment.quantities))
    result = assess_limits(model, model.surrogates(), specs, errors)
    result = replace(result, endless=endless)
    shares, halves, rows = _find_shares(model, result), _worst_of_halves(model, result), []
    for name in requirements:
        indices = _indices(result, name)
        limits = [
            _limit(model, result, i, halves[i]) | _judge_limits(model, result, (i,), shares)
            for i in indices
        ]
        verdict = _judge_limits(model, result, indices, shares)
        rows.append({"name": name, **verdict, "limits": limits})
    return {
        "requirements": rows,
        "together": {**_combine(model, result, shares, halves), "whole": errors is not None},
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
    model: ModelEvaluator, result: LimitAssessment, indices: tuple[int, ...], shares: _Shares
) -> dict:
    """Return whether all, some or none of the box keeps chosen limits, which share, and what is
    open. Runs decide where they agree with the surrogates up to the error. If no run keeps a limit,
    that proves nothing, and the share is unknown. All is open where no run varies a parameter, as
    with runs of a user's own."""
    (share, open_), rows = shares[indices], list(indices)
    is_met, has_failures = result.margins[rows].min(axis=0) >= 0, bool(len(model.failed_points))
    runs = len(model.distinct_rows) + model.rest_count + len(model.failed_points)
    # What so many runs in any places miss with a chance of 5 % is not excluded.
    bound = min(1.0, _RULE_OF_THREE / runs)
    if has_failures or any(is_open(model, result, i) for i in indices):
        open_ = max(open_, bound)
    verdict = "some"
    if is_met.all() and not has_failures:
        is_kept = min(result.worst[i][0] for i in indices) >= 0
        sure = is_kept and not open_ and all(is_shown(model, result, i) for i in indices)
        # Where surrogates break what all runs keep, no run shows it.
        open_ = max(open_, 1.0 - share, 0.0 if sure else bound)
        verdict, share = "all" if sure else "undecided", 1.0 if is_kept else share
    elif not (share > 0 or is_met.any()):
        violated_limits = [i for i in indices if not (result.margins[i] >= 0).any()]
        if violated_limits and not any(is_refuted(model, result, i) for i in violated_limits):
            open_ = 1.0
        else:
            verdict = "none"
    if model.experiment.box.constant_names(model.points):
        verdict, open_ = "undecided" if verdict == "all" else "some", 1.0
    return {"met": verdict, "share": share, "share_uncertainty": open_, "runs": runs}


def _limit(model: ModelEvaluator, result: LimitAssessment, i: int, halves: np.ndarray) -> dict:
    """Return the limit with its worst place: that of the surrogate, or a run that is worse; and its
    least margins with each interval half as wide, `halves` (k)."""
    (margin, point), runs, spec = result.worst[i], result.margins[i], result.specs[i]
    if runs.min() < margin:
        margin, point = float(runs.min()), model.points[runs.argmin()]
    error = number(result.limits[i].error)
    fields: dict[str, Any] = {"margin": number(margin), "error": error, "kept": bool(margin >= 0)}
    fields["halved"] = {
        model.experiment.box.names[j]: number(halves[j])
        for j in np.flatnonzero(model.experiment.box.free)
    }
    return {**describe_limit(model, spec), **fields, **model.describe_point(point, spec.quantity)}


def _worst_of_halves(model: ModelEvaluator, result: LimitAssessment) -> np.ndarray:
    """Return the least margin (l, k) of each limit with each interval half as wide."""
    free = model.experiment.box.free.astype(float)
    margins = np.full((len(result.specs), len(free)), np.nan)
    for j in np.flatnonzero(free):
        middle = np.where(np.arange(len(free)) == j, model.nominal, 0.0) / 2
        size = np.where(np.arange(len(free)) == j, 0.5, 1.0) * free
        for i in range(len(result.specs)):
            margins[i, j], _ = result.limits[i].worst(middle - size, middle + size)
    return margins


def _combine(
    model: ModelEvaluator, result: LimitAssessment, shares: _Shares, halves: np.ndarray
) -> dict:
    largest, index, _ = result.largest
    row = {
        **_judge_limits(model, result, tuple(range(len(result.specs))), shares),
        "max_interval_scale": largest,
        "unsampled": result.doubt is not None and bool(model.find_missing([result.doubt])),
    }
    box, row["halved"] = model.experiment.box, {}
    for j in np.flatnonzero(box.free):  # what meets all if one interval were half as wide
        half = find_halving(result.limits, box.free, model.nominal, int(j))._asdict()
        indices = range(len(result.specs))
        worst = halves[:, j].tolist()
        # An effect that does not exceed the error is none.
        sure = [
            half if half - result.worst[i][0] > result.limits[i].error else result.worst[i][0]
            for i, half in enumerate(worst)
        ]
        if len(model.failed_points) or any(
            (worst[i] >= 0 and sure[i] < result.limits[i].error)
            or is_open(model, result, i, sure[i])
            for i in indices
        ):  # as of the whole box: what so many runs miss is not excluded
            bound = min(1.0, _RULE_OF_THREE / row["runs"])
            half["share_uncertainty"] = max(half["share_uncertainty"], bound)
        if row["share_uncertainty"] >= 1:
            half |= {"share_uncertainty": 1.0, "gain_uncertainty": 1.0}
        row["halved"][box.names[j]] = half
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
