"""Discretization error of the bounds: runs at the extreme points are repeated, once with half the
time step, and once with that on a mesh twice as fine. With the step, the distance of the instants
is halved at which peaks are read.

Each component begins with what changes beside the runs before: a finer mesh takes half the step
anyway, which so counts once. The change is continued to what all further halvings would change, by
its order: that of a few runs with a quarter of the step, or on a mesh half as fine."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from deployable import intervals
from deployable.campaign.answers.evaluations import ModelEvaluator, runs_at
from deployable.campaign.answers.quantity_bounds import QuantityBounds, converge_bounds
from deployable.campaign.config.sections import CHECK_POINTS, Experiment, Jobs
from deployable.campaign.errors import CampaignError
from deployable.campaign.folder import Folder
from deployable.campaign.plan.accuracy import allow_check_runs
from deployable.campaign.plan.decide import COMPONENTS
from deployable.campaign.plan.plan import Plan, choose_step
from deployable.campaign.runs.progress import Notify
from deployable.intervals.estimates import extrapolate_error, refinement_ratio

_HALVINGS, _NEIGHBOURS = 6, (1, 2, 4, 8, 16, 32, 64)
"""Of the way on which finer runs cease to have a number; to which of the next runs it may go."""

_MOST_GROWTH = 16.0  # of a change under refinement, which then is next to none by accident

_CLOSE = 0.01
"""Of the width: a number that near to the bound needs no nearer one."""

MAX_POINT_DISTANCE = 0.1
"""In unit coordinates: a planned run so near a point stands for it."""


def check_bounds(
    folder: Folder,
    bounds: Any,
    jobs: Jobs,
    notify: Notify,
    threads: int = 1,
    components: tuple = COMPONENTS,
) -> Any:
    """Add errors by time step and mesh (`components`) to response bounds: runs at a few points
    where these are attained are repeated with half the step, then on a finer mesh. Returns a copy
    of the dataset with error components (`intervals.add_errors`), with an `accuracy` also
    ``quantity_error_<component>`` (quantity), and attributes `check_runs` and `check_ids`, the ids
    divided by blanks. folder: of the results, with plan and samples."""
    model = ModelEvaluator.from_folder(folder, jobs, notify, threads)
    known_ids = set(model.account.ids)
    if model.experiment.is_adaptive:
        model.account.limit = allow_check_runs(model.plan)
    dataset = intervals.add_errors(bounds, _curve_errors(model, bounds, components))
    if model.experiment.is_adaptive and model.experiment.quantities:
        errors = estimate_discretization_errors(model, converge_bounds(model, 0), components)
        for name, e in errors.items():
            text = {"long_name": f"error of the bounds by {name}"}
            dataset[f"quantity_error_{name}"] = "quantity", e.max(axis=1), text
    ids = " ".join(sorted(model.account.ids - known_ids))
    dataset = dataset.assign_attrs(check_runs=model.account.count, check_ids=ids)
    names = " and ".join(components)
    notify(f"{model.experiment.name}: runs at the bounds were repeated with a finer {names}")
    return dataset


class RefinementLevel(NamedTuple):
    """Plans whose runs show the error by one component, time step or mesh. finer: plan with half
    the step, or half the step and a mesh twice as fine; third: one that shows the order of the
    error, None without one; ends_finest: whether `third` is finer still or coarser."""

    finer: Plan
    third: Plan | None
    ends_finest: bool

    def ratio(self, coarse: np.ndarray, fine: np.ndarray, third: np.ndarray) -> np.ndarray:
        """Return the ratio of successive changes under refinement, |coarse to medium| / |medium to
        fine|: 2**p at order p. coarse, fine, third: values (n), or curves (..., T), whose changes
        count by their mean over T, of the original plan, of `finer` and of `third`."""
        levels = (coarse, fine, third) if self.ends_finest else (third, coarse, fine)
        sizes = np.abs(np.diff(levels, axis=0))
        return refinement_ratio(*(sizes if sizes.ndim == 2 else sizes.mean(axis=-1)))

    def extrapolate(self, change: np.ndarray, ratio: np.ndarray | None) -> np.ndarray:
        """Return the error by all halvings from the `change` by the first and the `ratio`, of
        successive changes. A change smaller than the next is so by accident, and counts as that."""
        growth = 1.0
        if self.ends_finest and ratio is not None:
            with np.errstate(divide="ignore"):
                growth = np.clip(1.0 / np.nan_to_num(ratio, nan=1.0), 1.0, _MOST_GROWTH)
        return extrapolate_error(change * growth, ratio)


def estimate_discretization_errors(
    model: ModelEvaluator, bounds: list[QuantityBounds], components: tuple = COMPONENTS
) -> dict[str, np.ndarray]:
    """Estimate the errors by time step and mesh of the bounds of all q quantities: arrays (q, 2),
    for lower and upper bound, by "step" and "mesh". They are the changes when the runs at the
    bounds (or the nearest that have the quantity when refined) are refined, extrapolated by the
    order at the bound that changes most. NaN without a value; no "mesh" if none is set."""
    points = np.array([point for b in bounds for point in (b.argmin, b.argmax)])
    values = np.array([value for b in bounds for value in (b.lower, b.upper)])
    q, errors = np.repeat(np.arange(len(bounds)), 2), {}

    def numbers(plan: Plan, rows: np.ndarray) -> np.ndarray:
        """Return the bounded quantity at chosen points (rows), from runs of the plan."""
        results, finite = np.full(len(rows), np.nan), np.isfinite(points[rows]).all(axis=1)
        if finite.any():
            finer, _ = model.evaluate(plan, points[rows][finite])
            results[finite] = finer[np.arange(len(finer)), q[rows][finite]]
        return results

    for name, level in _levels(model.plan, components, model.finest_step).items():
        finer_values = numbers(level.finer, np.arange(len(points)))
        lost_rows = np.isfinite(values) & ~np.isfinite(finer_values)
        if lost_rows.any():
            points[lost_rows], finer_values[lost_rows] = _find_nearest_values(
                model, level.finer, q[lost_rows], points[lost_rows], values[lost_rows]
            )
        change = np.abs(finer_values - values).reshape(-1, 2)
        worst = 2 * np.arange(len(bounds)) + np.nan_to_num(change).argmax(axis=1)
        # Where the finer value is of another place, it tells no order.
        finest = np.where(lost_rows[worst], np.nan, finer_values[worst])
        evaluate = partial(numbers, rows=worst)
        ratio = _find_ratio(model, level, values[worst], finest, evaluate)
        errors[name] = level.extrapolate(change, ratio)
        values = finer_values
    return errors


def _find_nearest_values(
    model: ModelEvaluator, plan: Plan, indices: np.ndarray, points: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Unit points (P, k) and numbers (P) of the planned runs that have quantities `indices` (P),
    also when refined, nearest to points at which they do not; NaN: none. values (P): bounds."""
    row, starts = np.arange(len(indices)), np.empty((len(_NEIGHBOURS), *points.shape))
    for i, q in enumerate(indices):
        present = model.points[np.isfinite(model.numbers[:, q])]
        order = np.argsort(np.linalg.norm(present - points[i], axis=1), kind="stable")
        starts[:, i] = present[order[np.minimum(_NEIGHBOURS, len(order) - 1)]]
    start_numbers = np.array([model.evaluate(plan, start)[0][row, indices] for start in starts])
    first = np.isfinite(start_numbers).argmax(axis=0)
    inner, numbers = starts[first, row], start_numbers[first, row]
    widths = np.array([np.nanmax(x) - np.nanmin(x) for x in model.numbers[:, indices].T])
    for _ in range(_HALVINGS):
        if not (np.abs(numbers - values) > _CLOSE * widths).any():
            break
        middle = (points + inner) / 2
        current = model.evaluate(plan, middle)[0][row, indices]
        exists = np.isfinite(current)
        numbers = np.where(exists, current, numbers)
        points, inner = (
            np.where(exists[:, None], *pair) for pair in ((points, middle), (middle, inner))
        )
    return inner, numbers


def estimate_fraction_errors(
    model: ModelEvaluator, bounds: list[QuantityBounds], errors: Mapping[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Errors by mesh and step, (q) each, by which fractions of the box's volume are uncertain: of
    each quantity's values, and of the decision function, whose sign tells whether it exists;
    infinite where refined runs disagree on that by an unknown amount, 0 if `errors` is empty."""
    numbers, shifts = np.zeros(len(bounds)), np.zeros(len(bounds))
    if not errors:
        return numbers, shifts
    *_, finest = _levels(model.plan, tuple(errors), model.finest_step).values()
    for q, b in enumerate(bounds):
        if b.surrogate.fit is None:
            continue
        shifts[q], change = estimate_limit_state_error(
            model, q, b.surrogate.occurrence, finest.finer
        )
        numbers[q] = np.sum([e[q] for e in errors.values()], axis=0).max()
        values, _ = model.evaluate(finest.finer, [b.argmin, b.argmax])
        if not np.isfinite(values[:, q]).all():
            numbers[q] = np.nan_to_num(np.maximum(numbers[q], change), nan=np.inf)
            shifts[q] = shifts[q] if b.surrogate.occurrence.is_mixed else np.inf
    return numbers, shifts


def _curve_errors(model: ModelEvaluator, bounds: Any, components: tuple) -> dict[str, np.ndarray]:
    """Errors (n, T) by component: what a finer step or mesh changes at points near which the bounds
    are attained; its order is taken where it is largest."""
    box = model.experiment.box
    low, high = [box.to_unit(bounds[name].values) for name in ("argmin", "argmax")]
    width = (bounds["upper"] - bounds["lower"]).values
    sites = intervals.choose_bound_points(low, high, width, CHECK_POINTS)
    run_points = model.plan.runs.normalized
    distances = np.abs(run_points - sites.points[:, None]).max(axis=2)
    nearest = distances.argmin(axis=1)
    # With an `accuracy` no runs are spent on what those that are there tell well enough.
    is_near = model.experiment.is_adaptive | (distances.min(axis=1) <= MAX_POINT_DISTANCE)
    test_points = np.where(is_near[:, None], run_points[nearest], sites.points)
    curves, errors = _curves(model, model.plan, test_points), {}
    for name, level in _levels(model.plan, components, model.finest_step).items():
        finer_curves = _curves(model, level.finer, test_points)
        change = np.abs(finer_curves - curves)
        change = np.where(np.isnan(change), np.nanmax(change, axis=0), change)  # of failed runs
        relative = change.mean(axis=2) / np.maximum(change.mean(axis=(0, 2)), np.finfo(float).tiny)
        worst = int(relative.sum(axis=1).argmax())
        evaluate = partial(_curves, model, points=test_points[[worst]])
        ratio = _find_ratio(model, level, curves[[worst]], finer_curves[[worst]], evaluate)
        errors[name] = level.extrapolate(sites.errors(change), ratio)
        curves = finer_curves
    return errors


def _find_ratio(
    model: ModelEvaluator, level: RefinementLevel, coarse: np.ndarray, fine: np.ndarray,
    evaluate: Callable[[Plan], np.ndarray],
) -> np.ndarray | None:  # fmt: skip
    """Ratios (n, 1) of changes from the plan to a finer one and to the third of a level; None where
    there is no third, or its mesh is too coarse. evaluate: gives what is compared by a plan."""
    if level.third is None:
        return None
    try:
        return level.ratio(coarse, fine, evaluate(level.third)).reshape(-1, 1)
    except CampaignError as error:
        name = model.experiment.name
        model.notify(f"{name}: the order of an error is not measured, and counts as 1: {error}")
        return None


def _curves(model: ModelEvaluator, plan: Plan, points: np.ndarray) -> np.ndarray:
    """Responses (P, n, T) of a plan's runs at unit points (P, k); NaN of those that fail."""
    experiment = plan.experiment
    blank = np.full((len(experiment.responses), experiment.solver.instants), np.nan)
    records = model.records(plan, runs_at(plan, points))
    return np.array([blank if record is None else record.values for record in records])


def _levels(plan: Plan, components: tuple, finest: float = math.inf) -> dict[str, RefinementLevel]:
    """Plans with half the step, and a mesh twice as fine, as asked, each with its third level.
    finest: step (s) of the runs that were repeated with a shorter one, half of which is taken."""
    levels = {}
    if "step" in components:
        while finest < 0.9 * plan.time.step:
            plan = halved(plan)
        plan = halved(plan)
        levels["step"] = RefinementLevel(plan, halved(plan), True)
    time, experiment = plan.time, plan.experiment
    if "mesh" in components and (mesh := experiment.scene_type.mesh):
        parameter = experiment.scene_type.parameters[mesh]
        number = experiment.scene.parameters.get(mesh, parameter.default)

        def with_mesh(number: float) -> Experiment:
            parameters = {**experiment.scene.parameters, mesh: number}
            return replace(experiment, scene=replace(experiment.scene, parameters=parameters))

        finer_plan = with_mesh(2 * number)
        # The step may be too long for the finer mesh.
        stable = choose_step(replace(finer_plan, solver=replace(finer_plan.solver, step="auto")))
        step = min(time.step, stable.step)
        finer = replace(plan, experiment=finer_plan, time=replace(stable, step=step))
        third = None
        if number % 2 == 0 and number // 2 >= parameter.least:
            third = replace(plan, experiment=with_mesh(number // 2), time=time)
        levels["mesh"] = RefinementLevel(finer, third, False)
    return levels


def halved(plan: Plan) -> Plan:
    """Return a plan with half the step, and peaks read at twice as many instants."""
    time, solver = plan.time, plan.experiment.solver
    time = replace(time, step=time.step / 2, output_steps=2 * time.output_steps)
    solver = replace(solver, peak_instants=2 * solver.peak_instants)
    return replace(plan, time=time, experiment=replace(plan.experiment, solver=solver))


# -- borders of where something happens ------------------------------------------------------------
# Where runs near it with finer mesh and step agree with the others, the border fits them as well.
# Else it moves: by how much finer runs change what tells the border, as the time of an event that
# may come too late; or, where runs only tell whether it happens, to where finer ones cease to
# differ. That is continued as if it fell at the first order: what happens or not tells no order.

_SIDE = 4  # runs at once on each side of a border: eight side by side cost what three do
_JUMP = 10.0  # times the median change of scores: more is a jump
_STRETCH_HALVINGS = 3  # of the stretch on which a border lies


def estimate_limit_state_error(
    model: ModelEvaluator, q: int, occurrence: Any, finest: Plan
) -> tuple[float, float]:
    """Estimate two errors by step and mesh near the border of where quantity `q` exists, by refined
    runs near it: of the decision function, whose sign tells the side, and of the quantity's value,
    NaN if no run has it. finest: plan with the finest step and mesh. If all runs have the quantity,
    or none, the first is the change of their event margins; 0 and NaN where these are not known."""
    happens = np.isfinite(model.numbers[:, q])
    if occurrence.is_mixed:
        scores, score = occurrence.decision(model.points), occurrence.run_decision
    elif np.isfinite(model.margins[:, q]).all():
        scores, score = model.margins[:, q], lambda numbers, margins: margins
    else:
        return 0.0, np.nan
    shift, number, test_rows, differs = 0.0, np.nan, np.zeros(0, int), np.zeros(0, bool)
    change = np.zeros(0)
    for rows in _iterate_rows(np.abs(scores), happens):
        if model.account.allowance < len(rows):
            break
        numbers, margins = (values[:, q] for values in model.evaluate(finest, model.points[rows]))
        previous = score(model.numbers[rows, q], model.margins[rows, q])
        switches = np.isfinite(numbers) != happens[rows]
        change = np.abs(score(numbers, margins) - previous)
        size = switches * np.abs(scores[rows])
        # Scores may jump, as where another event comes first: their change tells nothing then.
        is_jump = change > _JUMP * np.median(change)
        change = np.where(is_jump, 2 * size, change)
        shift = max(shift, float(np.where(np.isfinite(change), change, size).max()))
        number = np.fmax(number, np.fmax.reduce(np.abs(numbers - model.numbers[rows, q])))
        test_rows, differs = np.concatenate([test_rows, rows]), np.concatenate([differs, switches])
        if not switches.any() or (np.isfinite(change).all() and np.isfinite(number)):
            break
    if differs.any() and not np.isfinite(change).any():
        segments = _find_segments(
            model.points[test_rows], happens[test_rows], differs, np.abs(scores[test_rows])
        )
        shift = max(shift, _bisect_segments(model, q, occurrence, finest, *segments))
    shift, number = map(float, extrapolate_error(np.array([shift, number])))
    return shift, number


def _iterate_rows(size: np.ndarray, happens: np.ndarray) -> Iterator[np.ndarray]:
    """Runs on both sides of a border, the nearest by `size` (R) first, then twice as far on."""
    order = np.argsort(size, kind="stable")
    sides = order[happens[order]], order[~happens[order]]
    first, last = 0, _SIDE
    while first < max(map(len, sides)):
        stride = max(1, (last - first) // _SIDE)
        yield np.concatenate([side[first:last:stride] for side in sides])
        first, last = last, 2 * last


def _find_segments(
    points: np.ndarray, happens: np.ndarray, differs: np.ndarray, size: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit points (P, k) with the largest differences in finer runs, and for each the
    nearest point where a finer run agrees."""
    starts, stops = [], []
    for row in np.flatnonzero(differs)[np.argsort(-size[differs], kind="stable")][: 2 * _SIDE]:
        peers = np.flatnonzero(~differs & (happens == happens[row]))
        if len(peers):
            distances = np.linalg.norm(points[peers] - points[row], axis=1)
            starts.append(points[row])
            stops.append(points[peers[distances.argmin()]])
    k = points.shape[1]
    return np.array(starts).reshape(-1, k), np.array(stops).reshape(-1, k)


def _bisect_segments(
    model: ModelEvaluator,
    q: int,
    occurrence: Any,
    finest: Plan,
    outer: np.ndarray,
    inner: np.ndarray,
) -> float:
    """Return the largest decision value at which finer runs differ, between points (P, k)."""
    if not len(outer):
        return 0.0
    happens = occurrence.evaluate(outer)
    for _ in range(_STRETCH_HALVINGS):
        if model.account.allowance < len(outer):
            break
        middle = (outer + inner) / 2
        numbers, _ = model.evaluate(finest, middle)
        switches = (np.isfinite(numbers[:, q]) != happens)[:, None]
        outer, inner = np.where(switches, middle, outer), np.where(switches, inner, middle)
    return float(np.abs(occurrence.decision((outer + inner) / 2)).max())
