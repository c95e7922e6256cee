"""The best choice of nominal values, judged by the worst case about each, `choice.json`, whose keys
`summary.schema.json` describes.

The runs are those of a sparse grid over the choices and the box about each. Two goals trade off."""

import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from deployable.campaign.answers.evaluations import SAME_RUN, ModelEvaluator
from deployable.campaign.answers.limits import LimitSpec, describe_limit, list_limits
from deployable.campaign.config.sections import (
    Choose,
    Experiment,
    Verify,
    design_points,
    widen_intervals,
)
from deployable.campaign.files import write_result
from deployable.campaign.plan.plan import Plan, choose_step
from deployable.campaign.results.quantity_results import FittedRuns, QuantityResults, number
from deployable.campaign.results.run_samples import describe_failures
from deployable.campaign.text import words_of
from deployable.campaign.text.numbers import duration_text
from deployable.intervals.box import ROUNDING
from deployable.intervals.scalars import ChoiceProblem, EventLimit, Goal, Limit

_DOUBTS = 4
_REACH, _MOST_PARTS = 0.125, 4  # of a range: half of a part about a choice; parts in a row
_LARGE = 0.25  # of the differences between choices: error that calls for runs there
_ROOM, _TIGHT = 3.0, 2.0  # in errors: sought margins of a best choice, and least ones
_FINE = 1e-3  # of a margin's range: an error like none


def answer(
    evaluator: ModelEvaluator, choose: Choose, requirements: Mapping[str, Mapping], verify: Verify
) -> None:
    """Find nominal values of chosen parameters whose worst case is best, by further runs, and write
    `choice.json` into the folder of `evaluator`, which is of the campaign's plan. choose,
    requirements, verify: sections of the config."""
    base_plan, folder = evaluator.plan, evaluator.folder
    experiment = widen_intervals(base_plan.experiment, choose)
    plan = Plan(experiment, base_plan.mechanics, choose_step(experiment), base_plan.runs[:0])
    model = evaluator.for_plan(plan)
    if base_plan.experiment.is_adaptive:
        results = QuantityResults.read(folder)
        count = base_plan.adaptive.rounds[-1].runs + results.further_runs + results.check_runs
        model.account.limit = base_plan.experiment.accuracy.max_runs - count
    design = design_points(experiment, choose)
    model.notify(f"{experiment.name}: {len(design)} runs over choices and intervals")
    model.add(design)
    specs, base = list_limits(requirements, list(experiment.quantities)), base_plan.experiment
    specs = _with_events(model, specs)
    judge, best, safest, safe_ranges, trials, error = _search_parts(
        model, base, choose, specs, verify.max_iterations, len(design)
    )
    lower, upper = _subbox(model, base, choose, best.values)
    points = model.failed_points
    has_failed = bool(((points >= lower - 1e-9) & (points <= upper + 1e-9)).all(axis=1).any())
    decides = find_deciding_parameters(trials, error)
    rows = []
    for i, (name, (low, high)) in enumerate(choose.parameters.items()):
        value, units = float(best.values[i]), experiment.scene_type.parameters[name].unit
        row = {"name": name, "units": units, "lower": low, "upper": high, "value": value,
               "decides": decides[i], "safe": None, "safest": None}  # fmt: skip
        if safest is not None:
            safest_value = float(safest.values[i])
            row["safe"] = list(safe_ranges[i])
            row["safest"] = None if safest_value == value else safest_value
        rows.append(row)
    choice: dict[str, Any] = {
        "parameters": rows,
        "kept": best.is_allowed and not has_failed,
        "safe": best.is_safe and not has_failed,
        "failures": describe_failures(model.failures, experiment.intervals),
        "goals": list(map(partial(_goal, judge), choose.goals, best.goals, best.goal_points)),
        "limits": list(map(partial(_limit, judge), specs, best.margins, best.worst)),
        "tried": [
            {"values": trial.values.tolist(), "goals": list(map(number, trial.goals)),
             "margins": list(map(number, trial.margins)), "kept": trial.is_allowed}
            for trial in trials
        ],
        "fitted": {
            "intervals": {name: [i.lower, i.upper] for name, i in experiment.intervals.items()},
            "points": model.points.tolist(),
            "numbers": [list(map(number, row)) for row in model.numbers],
            "margins": [list(map(number, row)) for row in model.margins],
        },
        "runs": len(model.points),
        "simulated": model.simulated,
    }  # fmt: skip
    fit_errors = dict(zip(experiment.quantities, model.surrogates(), strict=True))
    for row in (*choice["goals"], *choice["limits"]):
        is_event = row.get("kind") == "happens"
        row["fit_error"] = row["error"] if is_event else number(fit_errors[row["quantity"]].error)
    write_result(folder.choice, json.dumps(choice, indent=1, allow_nan=False) + "\n")


def _search_parts(
    model: ModelEvaluator, base: Experiment, choose: Choose, specs: list[LimitSpec],
    iterations: int, count: int,
) -> tuple[ModelEvaluator, Any, Any, list, list, float]:  # fmt: skip
    """Search all choices, then parts of them about the best and about the nominal values, where
    errors decide and `count` runs are left. Returns the evaluator that judges the best choice, what
    `_search` does, and the error (`_error`)."""
    best, safest, safe_ranges, trials = _search(model, base, choose, specs, iterations)
    judge, error = model, _error(model, choose, None if best.is_allowed else specs)
    nominal = base.parameters(dict(zip(base.intervals, base.nominal, strict=True)))
    start = np.array([nominal[name] for name in choose.parameters])
    for values, reach in ((None, _REACH), (None, _REACH / 4), (start, _REACH)):
        is_tight = values is None and _is_tight(judge, best, trials, specs)
        is_open = (not best.is_safe and abs(best.safety) < 1) or (
            best.is_allowed and error > _LARGE * _spread([best, *trials])
        )
        if not (is_tight or (is_open and reach == _REACH)):
            continue
        if not iterations or model.account.allowance < count:
            break
        values = best.values if values is None else values
        local, candidate = _zoom(model, base, choose, specs, values, reach)
        is_better = (candidate.is_safe, candidate.safety) > (best.is_safe, best.safety)
        if is_tight and judge is not model:
            gain = choose.goals[0][0] * (best.goals[0] - candidate.goals[0])
            errors = [_error(part, choose, specs) for part in (local, judge)]
            is_better = candidate.is_safe and gain > 0 and 2 * errors[0] < errors[1]
        if is_better or (judge is model and not is_tight):
            judge, best, safest = local, candidate, None
            error = _error(judge, choose, None if best.is_allowed else specs)
    if judge is model and best.is_allowed and best.safety < _TIGHT:
        roomy = _search(model, base, choose, specs, iterations, _ROOM)
        if roomy[0].is_allowed and roomy[0].safety >= _TIGHT:
            best, safest, safe_ranges, trials = roomy
    return judge, best, safest, safe_ranges, trials, error


def _with_events(model: ModelEvaluator, specs: Sequence[LimitSpec]) -> list[LimitSpec]:
    """Return limits with those first that an event happens, also where a requirement implies that,
    as its quantity does not exist in some runs; one for all quantities of the same runs."""
    is_absent, events = np.isnan(model.numbers), [s for s in specs if s.kind == "happens"]
    patterns = {is_absent[:, spec.quantity].tobytes() for spec in events if spec.level}
    levels = [spec for spec in specs if spec.kind != "happens"]
    for spec in levels:
        runs = is_absent[:, spec.quantity]
        if runs.any() and runs.tobytes() not in patterns:
            patterns.add(runs.tobytes())
            events.append(LimitSpec(spec.requirement, spec.quantity, "happens", 1.0))
    return events + levels


def _search(
    model: ModelEvaluator, base: Experiment, choose: Choose, specs: list[LimitSpec],
    iterations: int, room: float = 1.0,
) -> tuple[Any, Any, list, list]:  # fmt: skip
    """Find the best and the safest choice (`intervals.scalars.Choice`), the safe range of each
    chosen value, and the choices that were tried; without a safe choice no safest and no ranges.
    The places that decide are simulated, in at most so many iterations, and the best choice is
    judged with runs at its worst places. room: by how many errors it is to keep each limit."""
    start = time.monotonic()
    for iteration in range(iterations + 1):
        problem = replace(_problem(model, base, choose, specs), room=room)
        best, trials = problem.find_best()
        safest, safe_ranges = None, []
        if best.is_safe and np.isfinite(best.safety):
            safe_ranges = [problem.find_safe_range(best, i) for i in range(len(problem.ranges))]
            safest = problem.find_safest(trials, best)
        points = [*np.concatenate(best.goal_points), *best.worst]
        points += recheck(best, trials, choose, specs)
        points += [] if safest is None else [*safest.worst]
        points = model.find_missing([point for point in points if np.isfinite(point).all()])
        if iteration == iterations or not points:
            break
        model.add(points)
        seconds = (time.monotonic() - start) / (iteration + 1) * (iterations - iteration)
        model.notify(
            f"{base.name}: choosing, {len(model.points)} runs, round {iteration + 1} of at most "
            f"{iterations}, at most {duration_text(max(1.0, seconds))} left"
        )
    best = _confirm(model, base, choose, specs, best, iterations)
    return best, safest if best.is_safe else None, safe_ranges, trials


def _confirm(
    model: ModelEvaluator, base: Experiment, choose: Choose, specs: list[LimitSpec], best: Any,
    iterations: int,
) -> Any:  # fmt: skip
    """Judge the values of a choice again with runs at its worst places, until these stay where runs
    are, or so many times. A goal or limit is that of a run in the choice's box that is worse, also
    of a run that the campaign made before."""
    problem, runs = _problem(model, base, choose, specs), _earlier_runs(model, base)
    for _ in range(iterations):
        count = len(model.points)
        worse = _by_runs(problem, best, choose, specs, base, *runs)
        places = [*best.goal_points, best.worst, *worse.goal_points, worse.worst]
        model.add(model.find_missing([*np.concatenate(places)]))
        if len(model.points) == count:
            break
        problem = _problem(model, base, choose, specs)
        best = problem.judge(best.values)
    return _by_runs(problem, best, choose, specs, base, model.points, model.numbers)


def _earlier_runs(model: ModelEvaluator, base: Experiment) -> tuple[np.ndarray, np.ndarray]:
    """Return points (R, k), in the unit coordinates of `model`, and quantities (R, q) of the runs
    that the campaign's other answers rest on."""
    runs, box = FittedRuns.read(model.folder), model.experiment.box
    nominal = base.parameters(dict(zip(base.intervals, base.nominal, strict=True)))
    columns = dict(zip(base.box.names, base.box.from_unit(runs.points).T, strict=True))
    values = [columns.get(name, np.full(len(runs.points), nominal[name])) for name in box.names]
    return box.to_unit(np.transpose(values)), runs.numbers


def _by_runs(
    problem: ChoiceProblem, best: Any, choose: Choose, specs: list[LimitSpec], base: Experiment,
    points: np.ndarray, numbers: np.ndarray,
) -> Any:  # fmt: skip
    """Return a choice whose goals and margins are those of runs in its box, where these are worse.
    points (R, k), numbers (R, q): of runs and their quantities."""
    lower, upper = problem.box(best.values)
    is_inside = ((points >= lower - SAME_RUN) & (points <= upper + SAME_RUN)).all(axis=1)
    points, columns = points[is_inside], numbers[is_inside].T
    goals, margins = best.goals.copy(), best.margins.copy()
    goal_points, worst = [*best.goal_points], best.worst.copy()
    for i, (_, end, name) in enumerate(choose.goals):
        column = columns[[*base.quantities].index(name)]
        if np.isfinite(column).any():
            least, most = int(np.nanargmin(column)), int(np.nanargmax(column))
            rows = {"lower": [least], "upper": [most], "width": [least, most]}[end]
            value = column[rows[-1]] - (column[least] if end == "width" else 0.0)
            if not (value >= goals[i] if end == "lower" else value <= goals[i]):
                goals[i], goal_points[i] = value, points[rows]
    for i, (spec, limit) in enumerate(zip(specs, problem.limits, strict=True)):
        of_runs = limit.find_margins(columns[spec.quantity])
        if len(of_runs) and of_runs.min() < margins[i]:
            margins[i], worst[i] = of_runs.min(), points[of_runs.argmin()]
    choice = problem.weigh(best, goals, margins)
    return replace(choice, goal_points=goal_points, worst=worst)


def _zoom(
    model: ModelEvaluator, base: Experiment, choose: Choose, specs: list, values: np.ndarray,
    width: float,
) -> tuple[ModelEvaluator, Any]:  # fmt: skip
    """Search a part of the choices about `values`, `width` of the ranges to either side, with a
    design of its own and a surrogate of the runs there, whose errors are not those of the whole;
    and go on about the best while it lies at an end of the part. Returns the evaluator over the
    last part, and the best choice there, which keeps limits by several errors."""
    ranges = np.array(list(choose.parameters.values()), dtype=float)
    reach = width * np.ptp(ranges, axis=1)
    for _ in range(_MOST_PARTS):
        values = np.clip(values, *ranges.T)
        ends = np.clip(np.array([values - reach, values + reach]), *ranges.T).T
        names = zip(choose.parameters, ends.tolist(), strict=True)
        part = replace(choose, parameters={name: tuple(end) for name, end in names}, order=2)
        local = model.narrow(widen_intervals(base, part))
        local.add(design_points(local.experiment, part))
        best, *_ = _search(local, base, part, specs, 2, _ROOM)
        model.absorb(local)
        values = best.values
        is_end = np.abs(values[:, None] - ends) < 1e-3 * reach[:, None]
        if not (is_end & (ends != ranges)).any():
            break
    return local, best


def _is_tight(
    model: ModelEvaluator, best: Any, trials: Sequence[Any], specs: list[LimitSpec]
) -> bool:
    """Return whether the error of a limit decides where the best choice lies, as its margin hardly
    exceeds that: runs there may have smaller errors, and leave better choices."""
    surrogates, margins = model.surrogates(), np.array([trial.margins for trial in trials])
    for i, spec in enumerate(specs):
        error = 1.0 if spec.kind == "happens" else surrogates[spec.quantity].error
        column = margins[np.isfinite(margins[:, i]), i]
        is_near = 0 <= best.margins[i] < 2 * _ROOM * error
        if is_near and len(column) and error > _FINE * np.ptp(column):
            return True
    return False


def _spread(trials: Sequence[Any]) -> float:
    """Difference of the first goal between tried choices that are allowed; infinite of none."""
    goals = [trial.goals[0] for trial in trials if trial.is_allowed and np.isfinite(trial.goals[0])]
    return float(np.ptp(goals)) if goals else np.inf


def recheck(
    best: Any, trials: Sequence[Any], choose: Choose, specs: Sequence[LimitSpec]
) -> list[np.ndarray]:
    """Find points to simulate before a choice is final, because only surrogates rule out choices
    that may be better. Such a choice breaks a limit only because an event does not happen (or
    happens, or a limited quantity is absent), and its first goal is better than that of the best
    choice. The four nearest ones, relative to the ranges' widths, are used. Returns normalized
    points (k), -1 to 1 in the box, one for each such limit. best, trials:
    `intervals.scalars.Choice`, the best and those of the first grid; choose: section of the
    config; specs: of the limits."""
    sign = choose.goals[0][0]
    better = [
        trial
        for trial in trials
        if not trial.is_allowed and sign * (trial.goals[0] - best.goals[0]) < 0
    ]
    ends = np.array(list(choose.parameters.values()), dtype=float)
    widths = np.maximum(np.ptp(ends, axis=1), np.finfo(float).tiny)
    better.sort(key=lambda trial: float(np.abs((trial.values - best.values) / widths).max()))
    return [
        point
        for trial in better[:_DOUBTS]
        for margin, point, spec in zip(trial.margins, trial.worst, specs, strict=True)
        if margin == -np.inf or (spec.kind == "happens" and margin < 0)
    ]


def _problem(
    model: ModelEvaluator, experiment: Experiment, choose: Choose, specs: list[LimitSpec]
) -> ChoiceProblem:
    surrogates = [s.trend for s in model.surrogates()]
    names = list(model.experiment.quantities)
    goals = [Goal(surrogates[names.index(q)], end, sign) for sign, end, q in choose.goals]
    limits = _limits(surrogates, specs)
    subbox = partial(_subbox, model, experiment, choose)
    return ChoiceProblem(goals, limits, list(choose.parameters.values()), subbox)


def _limits(surrogates: Sequence[Any], specs: Sequence[LimitSpec]) -> list[Limit]:
    return [
        (EventLimit if spec.kind == "happens" else Limit)(
            surrogates[spec.quantity], spec.kind, spec.level
        )
        for spec in specs
    ]


def _subbox(
    model: ModelEvaluator, experiment: Experiment, choose: Choose, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper normalized corner (k) of the box about chosen values."""
    box = model.experiment.box
    ends = {name: (i.lower, i.upper) for name, i in model.experiment.intervals.items()}
    for name, value in zip(choose.parameters, values, strict=True):
        ends[name] = choose.interval(name, float(value), experiment)
    lower, upper = box.to_unit(np.array([sorted(ends[name]) for name in box.names]).T)
    return np.clip(lower, -1.0, 1.0), np.clip(upper, -1.0, 1.0)


def _error(model: ModelEvaluator, choose: Choose, specs: list[LimitSpec] | None) -> float:
    """Error, and rounding, of what decides: the first goal, or, if no choice is allowed, limits, as
    shares of their sizes."""
    surrogates = model.surrogates()
    if specs is None:
        q = list(model.experiment.quantities).index(choose.goals[0][2])
        size, errors = np.nanmax(np.abs(model.numbers[:, q]), initial=0.0), [surrogates[q].error]
    else:
        size, errors = 1.0, [limit.error / limit.size for limit in _limits(surrogates, specs)]
    return max([ROUNDING * size, *(error for error in errors if np.isfinite(error))])


def find_deciding_parameters(trials: Sequence[Any], error: float) -> list[bool]:
    """Tell which chosen parameters matter, one flag each, in order: whether tried choices that
    differ only in it (all, if no two do) differ by more than `error` in the first goal, or only
    some of them are allowed; if no choice is allowed, in the least margin (`Choice.margin`).
    trials: `intervals.scalars.Choice`, all that were tried; error: of what is compared."""
    allowed = [trial.is_allowed for trial in trials]
    worth = np.array([
        trial.margin if not any(allowed) else trial.goals[0] if trial.is_allowed else np.inf
        for trial in trials
    ])  # fmt: skip
    worth = np.nan_to_num(worth, nan=np.inf)
    values = np.array([trial.values for trial in trials])

    def differ(rows: np.ndarray) -> bool:
        low, high = worth[rows].min(), worth[rows].max()
        return bool(low != high and not high - low <= error)

    flags = []
    for j in range(values.shape[1]):
        _, group = np.unique(np.delete(values, j, axis=1), axis=0, return_inverse=True)
        groups = [np.flatnonzero(group.ravel() == g) for g in range(group.max() + 1)]
        lines = [rows for rows in groups if len(rows) > 1]
        flags.append(any(map(differ, lines or [np.arange(len(trials))])))
    return flags


def _goal(
    model: ModelEvaluator, goal: tuple[float, str, str], value: float, points: np.ndarray
) -> dict:
    sign, end, name = goal
    q = list(model.experiment.quantities).index(name)
    quantity = model.experiment.quantity_list[q]
    description = {"end": end, "quantity": name, "units": quantity.unit, **words_of(quantity)}
    description |= {"sense": "minimise" if sign > 0 else "maximise", "value": number(value)}
    description["error"] = number(model.surrogates()[q].error)
    *lower_row, row = (model.describe_point(point, q) for point in points)
    if lower_row:
        row["lower_at"] = lower_row[0]["at"]
        pair = row["simulated"], lower_row[0]["simulated"]
        row["simulated"] = None if None in pair else pair[0] - pair[1]
    return {**description, **row}


def _limit(model: ModelEvaluator, spec: LimitSpec, margin: float, point: np.ndarray) -> dict:
    error = number(model.surrogates()[spec.quantity].error)
    if spec.kind == "happens":  # whose margin counts its errors
        error = 1.0 if np.isfinite(margin) else None
    fields = {"margin": number(margin), "error": error, "kept": bool(margin >= 0)}
    description = {"requirement": spec.requirement, **describe_limit(model, spec)}
    return {**description, **fields, **model.describe_point(point, spec.quantity)}
