"""`accuracy`: rounds of runs until the whole error is what was asked for, or the budget is spent.

Each round has a plan (`rounds/<round>/plan.json`) with a mesh, a step, and runs through which a
spline goes; those of later rounds are sought where the bounds are decided. What comes next is
decided by `decide`; here results become its arguments and its decision a plan. Bounds of quantities
are sought after the rounds (`answers.quantity_bounds`), with at least half of the runs that are
allowed; the rounds only make step and mesh fine enough for them."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from deployable import intervals
from deployable.campaign.config.models import MOST_INSTANTS
from deployable.campaign.config.sections import (
    Experiment,
    Solver,
    count_check_runs,
    count_first_runs,
)
from deployable.campaign.plan.decide import (
    CHECKED_RUNS,
    COMPONENTS,
    ROUND,
    RUN_FILES,
    UNKNOWN,
    Errors,
    RefinementState,
    Resources,
)
from deployable.campaign.plan.jobs import LANES, run_seconds
from deployable.campaign.plan.plan import Plan, Round, Rounds, TimeStep, choose_step, make_plan
from deployable.intervals.box import ROUNDING

_CANDIDATES = 4096  # points at which the spline is asked for more


def start_plan(experiment: Experiment) -> Plan:
    """Make the plan of round 0 of an `accuracy` (config). It has eight runs for each interval that
    has a width, fewer if `max_runs` leaves no room for them and a check: the nominal run, the
    corners of the box if they are at most half of the runs, and points of a Sobol sequence. It
    checks errors of the mesh, else of the step, and of both if there is no other check."""
    box, count = experiment.box, count_first_runs(experiment)
    points = intervals.make_design("sobol", box, samples=max(count - 1, 1)).points
    has_mesh = experiment.scene_type.mesh is not None  # free or given
    check: tuple[str, ...] = ("mesh",) if has_mesh else ("step",)
    accuracy, check_runs = experiment.accuracy, count_check_runs(experiment)
    if accuracy.max_runs - accuracy.reserve - count < 3 * check_runs:  # no second check
        check = COMPONENTS if has_mesh else ("step",)
    return _plan(experiment, points.tolist(), (), check)


def extend_plan(experiment: Experiment, plan: Plan, samples: Any, bounds: Any) -> Plan:
    """Make the plan after a finished round of an `accuracy`: with more runs, a finer mesh or step,
    or a check of the errors by both; or the same plan, marked as the last, with the reason to stop.
    experiment: has the `accuracy`; plan: of the finished round; samples: its open `RunSamples`;
    bounds: its `CampaignBounds`."""
    target, base, state = experiment.accuracy, plan.experiment, plan.adaptive
    shares = _relative_errors(plan, bounds, samples.table.numbers)
    is_free = base.solver.step == "auto"
    check_runs = bounds.attributes.get("check_runs") if plan.adaptive.check else 0
    refinement = _refinement_state(plan, shares, is_free, check_runs)
    cost, decision = refinement.cost, refinement.decide()
    whole = max((sum(parts.values()) for parts in shares.values()), default=0.0)
    step = base.solver.safety if is_free else base.solver.step
    new_round = Round(
        cost.runs, whole, decision.action, decision.reason,
        shares, cost.elements, float(step), cost.seconds, cost.nodes,
    )  # fmt: skip
    rounds = (*state.rounds, new_round)
    if decision.action == "stop":
        return replace(plan, adaptive=Rounds(rounds, state.points, decision.met, state.check))
    points = list(state.points)
    if decision.action == "runs":
        names = [errors.name for errors in refinement.reducible]
        points += _infill_points(base, samples, names, cost.next_runs, len(rounds)).tolist()
    finer = base
    if decision.action == "mesh":
        parameters = {**base.scene.parameters, target.mesh: 2 * cost.elements}
        finer = replace(base, scene=replace(base.scene, parameters=parameters))
        time = choose_step(finer)
        if time.step > time.step_limit:  # which the config gives, and is no longer stable
            finer = replace(finer, solver=replace(finer.solver, step="auto"))
    elif decision.action == "step":
        solver = replace(base.solver, safety=_halve(base.solver, plan.time))
        finer = replace(base, solver=replace(solver, peak_instants=MOST_INSTANTS))  # at all steps
    has_mesh = base.scene_type.mesh is not None
    check = tuple(part for part in decision.check if has_mesh or part != "mesh")
    return _plan(finer, points, rounds, check, plan.time if finer is base else None)


def _plan(
    experiment: Experiment, points: list, rounds: tuple, check: tuple, time: TimeStep | None = None
) -> Plan:
    """Return the plan of runs at unit points (n, k); time: step of the last plan if it is kept."""
    places = tuple(tuple(map(float, point)) for point in points)
    design = replace(experiment.design, points=places)
    plan = make_plan(replace(experiment, design=design), time=time)
    return replace(plan, adaptive=Rounds(rounds, places, check=check))


def _halve(solver: Solver, time: TimeStep) -> float:
    """Return the safety factor that halves the step, which recorded instants may keep small."""
    half, actual = solver.safety / 2, time.step / time.step_limit
    return half if half < actual else actual / 2


def _relative_errors(plan: Plan, bounds: Any, numbers: np.ndarray) -> dict[str, dict[str, float]]:
    """Return errors by component as fractions of widths: of responses by surrogate, step and mesh,
    of quantities by step and mesh, from the last check. numbers (R, q): quantities in runs."""
    previous: Mapping[str, Mapping] = {}
    if plan.adaptive.rounds and plan.adaptive.rounds[-1].action in ("runs", "check"):
        previous = plan.adaptive.rounds[-1].shares
    errors = {row.name: row.error_shares for row in bounds.responses}
    for i, (name, column) in enumerate(zip(plan.experiment.quantities, numbers.T, strict=True)):
        values = column[np.isfinite(column)]
        width = float(np.ptp(values)) if len(values) else 0.0
        varies = width > ROUNDING * np.abs(values).max(initial=0.0)
        sizes = {component: float(e[i]) for component, e in bounds.quantity_errors.items()}
        errors[name] = {c: e / width if varies else 0.0 for c, e in sizes.items()}
    for name, shares in errors.items():
        all_shares = {**previous.get(name, {}), **shares}
        errors[name] = {"surrogate": shares["surrogate"]} if "surrogate" in shares else {}
        for component in (component for component in COMPONENTS if component in all_shares):
            is_known = all_shares[component] < UNKNOWN  # False for NaN
            errors[name][component] = all_shares[component] if is_known else UNKNOWN
    return errors


def _count_new_runs(plan: Plan) -> int:
    """Count the runs of a plan that the round before it did not have."""
    nodes, last = len(plan.unique_runs), plan.adaptive.rounds[-1:]
    return nodes if not last or last[0].action in ("mesh", "step") else nodes - last[0].nodes


def allow_check_runs(plan: Plan) -> int:
    """Return how many runs the check of a plan's round may make: what the rounds so far left of the
    limit, but for what is kept for a choice, and for the check of step and mesh."""
    accuracy, rounds = plan.experiment.accuracy, plan.adaptive
    if rounds.met is not None:
        return accuracy.max_runs - accuracy.reserve - rounds.rounds[-1].runs
    count = (rounds.rounds[-1].runs if rounds.rounds else 0) + _count_new_runs(plan)
    reserve = 0 if "step" in rounds.check else 2 * count_check_runs(plan.experiment)
    return accuracy.max_runs - accuracy.reserve - count - reserve


def affordable_runs(plan: Plan) -> int:
    """Return how many runs the core time leaves for bounds of quantities after the last round."""
    seconds = 60 * plan.experiment.accuracy.max_core_minutes - plan.adaptive.rounds[-1].seconds
    return max(0, int(seconds / run_seconds(plan.experiment, plan.time)))


def left_tolerances(plan: Plan) -> list[float]:
    """Return errors (q) that surrogates of quantities may have, as fractions of widths, to keep the
    tolerances of an `accuracy` with those by step and mesh. plan: of its last round."""
    last, tolerances = plan.adaptive.rounds[-1].shares, plan.experiment.accuracy.tolerances
    return [
        Errors(name, tolerances[name], last.get(name, {})).allowance
        for name in plan.experiment.quantities
    ]


def _refinement_state(
    plan: Plan, shares: Mapping, is_step_free: bool = True, check_count: int | None = None
) -> RefinementState:
    """Return the state of the rounds: errors, the cost of the rounds so far, and the cost of the
    next one. check_count: number of check runs in this round, if known."""
    target, rounds, nodes = plan.experiment.accuracy, plan.adaptive.rounds, len(plan.unique_runs)
    time = run_seconds(plan.experiment, plan.time)
    last = rounds[-1] if rounds else Round(0, 0.0, "mesh", "")
    new, check_runs = _count_new_runs(plan), count_check_runs(plan.experiment)
    # A mesh twice as fine has twice the elements and half the step; what tells orders, both
    # together, takes no longer.
    factor = {"mesh": 4.0, "step": 2.0}
    runs, seconds = last.runs + new, last.seconds + _whole(new) * time
    for component in plan.adaptive.check:
        runs += check_runs if check_count is None else 0
        seconds += _whole(check_runs) * factor[component] * time
    runs += int(check_count or 0)
    reserve = 2 * check_runs, 6 * check_runs * time  # the check of step and mesh at the end
    answers = target.reserve
    if count := len(plan.experiment.quantities):
        answers += max(CHECKED_RUNS * count, (target.max_runs - target.reserve) // 2)
    affordable = min(
        target.max_runs - runs - reserve[0] - answers,
        (60 * target.max_core_minutes - seconds - reserve[1]) / time,
    )
    elements = int(plan.experiment.scene.parameters.get(target.mesh, 0))
    cost = Resources(runs, seconds, nodes, 0, check_runs, time, elements, answers)
    state = RefinementState(target, shares, plan.adaptive, cost, is_step_free)
    next_runs = add_runs(nodes, state.growth(), affordable, ROUND / (time + RUN_FILES))
    return replace(state, cost=replace(cost, next_runs=next_runs))


def add_runs(nodes: int, growth: float, affordable: float, cheap: float = 0.0) -> int:
    """Return how many runs the next round adds, a multiple of 8 (`LANES`): `growth` - 1 times
    `nodes`, if affordable, but at least a quarter of `nodes`, or all of them if they take no longer
    than a round, and at most as many as there are, or as take no longer. affordable: runs that the
    budget allows; cheap: runs that take as long as all else in a round."""
    least, most = max(min(cheap, nodes), nodes / 4), max(cheap, nodes)
    quarter, need = (
        LANES * max(1, round(count / LANES))
        for count in (nodes / 4, min(max(nodes * (growth - 1), least), most))
    )
    return max(quarter, min(need, LANES * int(affordable // LANES)))


def _whole(runs: int) -> int:
    return -(-runs // LANES) * LANES


def _infill_points(
    experiment: Experiment, samples: Any, unmet: list[str], count: int, seed: int
) -> np.ndarray:
    """Unit points (n, k) of the next `count` runs: where a spline predicts wider responses of those
    that are `unmet`; the rest spread."""
    runs, free = samples.table.points, experiment.box.free
    points: list[np.ndarray] = []
    candidates: list[tuple[Any, float]] = []
    if rows := [i for i, name in enumerate(experiment.responses) if name in unmet]:
        values = samples.curves(slice(None), rows).astype(float)
        next_points, _ = intervals.seek_points(
            runs, values, count, candidates=_CANDIDATES, seed=seed
        )
        candidates += [(point, 1e-3) for point in next_points]
    spacing = 2.0 * len(runs) ** (-1.0 / max(int(free.sum()), 1))
    spread = intervals.make_design("sobol", experiment.box, samples=4 * (len(runs) + count)).points
    candidates += [(point, 0.2 * spacing) for point in spread]
    for point, least in candidates:
        rivals = np.array([*runs, *points])
        if len(points) < count and np.linalg.norm(rivals - point, axis=1).min() > least:
            points.append(np.asarray(point, dtype=float))
    return np.array(points).reshape(-1, len(free))
