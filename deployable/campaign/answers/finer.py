"""What mesh and step add to the error: the runs at the places that decide again, once with half the
step, and once with that on a mesh twice as fine.

Each part begins with what changes beside the runs before: a finer mesh takes half the step anyway,
which so counts once. The change is continued to what all further halvings would change, by the
order at which it falls: a few runs with a quarter of the step, and on a mesh half as fine, tell it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from deployable.campaign.answers.bench import Bench, runs_at
from deployable.campaign.answers.borders import moved
from deployable.campaign.answers.ends import Ends, settle
from deployable.campaign.config.sections import Experiment, Jobs, Verify
from deployable.campaign.errors import CampaignError
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import Plan, TimeStep, choose_step
from deployable.campaign.runs.progress import Tell
from deployable.intervals.estimates import refinement_ratio, richardson_error

PLACES = 8
"""Places at which runs are repeated for the responses: eight side by side cost what three do."""

_HALVINGS = 6
"""Of the way on which finer runs cease to have a number."""

BESIDE = 0.1
"""In unit coordinates: a planned run so near a place stands for it."""


PARTS = ("step", "mesh")


def finer_parts(plan: Plan, verify: Verify) -> tuple[str, ...]:
    """Which of step and mesh the bounds of a plan are to be checked for."""
    if plan.experiment.is_sought:
        return plan.adaptive.check
    return PARTS if verify.discretization else ()


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
        text = "error of the ends by their {}".format
        found = found.assign(
            {
                f"quantity_error_{name}": ("quantity", ends.max(axis=1), {"long_name": text(name)})
                for name, ends in errors.items()
            }
        )
    told = " and ".join(parts)
    tell(f"{bench.experiment.name}: the places that decide were run again with a finer {told}")
    return found


class Level(NamedTuple):
    """Plans by which a part of the error is told: `finer` than the one before, and a `third`, half
    as fine as that or twice as fine as the finer one (`ends_finest`); None where there is none."""

    finer: Plan
    third: Plan | None
    ends_finest: bool

    def ratio(self, before: np.ndarray, now: np.ndarray, third: np.ndarray) -> np.ndarray:
        """How many times less the later of two halvings changes numbers (..., T) or (...), by their
        means over T; before, now: without and with the finer mesh or step."""
        levels = (before, now, third) if self.ends_finest else (third, before, now)
        return refinement_ratio(*(_mean_size(change) for change in np.diff(levels, axis=0)))


def _mean_size(change: np.ndarray) -> np.ndarray:
    return np.abs(change) if change.ndim == 1 else np.abs(change).mean(axis=-1)


def finer_errors(bench: Bench, ends: list[Ends], parts: tuple = PARTS) -> dict[str, np.ndarray]:
    """Errors (q, 2) of `step` and `mesh` by name: of the lower and the upper end of each quantity,
    by the order at the one that a finer one changes most. Where the finer run at an end has no
    number, by that of the one nearest to it that has. NaN where there is none; no mesh where no
    parameter sets it.
    """
    points = np.array([at for end in ends for at in (end.argmin, end.argmax)])
    before = np.array([value for end in ends for value in (end.lower, end.upper)])
    of, found = np.repeat(np.arange(len(ends)), 2), {}

    def numbers(plan: Plan, chosen: np.ndarray) -> np.ndarray:
        """At chosen points what a run of the plan tells of the quantity whose end it is."""
        out, there = np.full(len(chosen), np.nan), np.isfinite(points[chosen]).all(axis=1)
        if there.any():
            measured, _ = bench.told(plan, points[chosen][there])
            out[there] = measured[np.arange(len(measured)), of[chosen][there]]
        return out

    for name, level in _levels(bench.plan, parts).items():
        now = numbers(level.finer, np.arange(len(points)))
        lost = np.isfinite(before) & ~np.isfinite(now)
        if lost.any():
            points[lost], now[lost] = _nearest_left(bench, level.finer, of[lost], points[lost])
        change = np.abs(now - before).reshape(-1, 2)
        most = 2 * np.arange(len(ends)) + np.nan_to_num(change).argmax(axis=1)
        third = _third(bench, level, lambda plan, most=most: numbers(plan, most))
        if third is not None:  # which tells no order beside a run at another place
            third = level.ratio(before[most], now[most], np.where(lost[most], np.nan, third))
        found[name] = richardson_error(change, None if third is None else third[:, None])
        before = now
    return found


def _nearest_left(
    bench: Bench, plan: Plan, of: np.ndarray, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Unit points (P, k) and numbers (P) of the runs of a plan that have the quantities `of` (P),
    nearest to points at which they do not, on the way to the middle of all runs that have them."""
    left = np.array([bench.unit[np.isfinite(bench.numbers[:, q])].mean(axis=0) for q in of])
    found, _ = bench.told(plan, left)
    numbers, row = found[np.arange(len(of)), of], np.arange(len(of))
    for _ in range(_HALVINGS):
        middle = (points + left) / 2
        now = bench.told(plan, middle)[0][row, of]
        there = np.isfinite(now)
        numbers = np.where(there, now, numbers)
        points, left = (
            np.where(there[:, None], *pair) for pair in ((points, middle), (middle, left))
        )
    return left, numbers


def beyond_of(
    bench: Bench, ends: list[Ends], errors: dict[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """What the runs are wrong by (q,) by mesh and step, for shares of the box: the numbers, by the
    `finer_errors` of their ends, and next to where they cease if that passes an end; and the
    certainty that there are any. Infinite where finer runs tell that it is wrong, not how much."""
    numbers, borders = np.zeros(len(ends)), np.zeros(len(ends))
    if not errors:
        return numbers, borders
    *_, finest = _levels(bench.plan, tuple(errors)).values()
    for q, end in enumerate(ends):
        if end.surrogate.fit is None:
            continue
        borders[q], beside = moved(bench, q, end.surrogate.occurrence, finest.finer)
        numbers[q] = np.sum([each[q] for each in errors.values()], axis=0).max()
        at_ends, _ = bench.told(finest.finer, [end.argmin, end.argmax])
        if not np.isfinite(at_ends[:, q]).all():
            numbers[q] = np.nan_to_num(np.maximum(numbers[q], beside), nan=np.inf)
            borders[q] = borders[q] if end.surrogate.occurrence.is_mixed else np.inf
    return numbers, borders


def _curve_errors(bench: Bench, bounds: Any, parts: tuple) -> dict[str, np.ndarray]:
    """Errors (n, T) by part: what a finer step or mesh changes at the places near which the bounds
    are attained, which are those of planned runs where there are some nearby. At which order that
    falls is told by the place at which it is most."""
    from deployable import intervals

    box = bench.experiment.box
    attained = [box.to_unit(bounds[name].values) for name in ("argmin", "argmax")]
    width = (bounds["upper"] - bounds["lower"]).values
    places = intervals.deciding_places(*attained, width, PLACES)
    known = bench.plan.runs.normalized
    apart = np.abs(known - places.unit[:, None]).max(axis=2)
    nearest = apart.argmin(axis=1)
    points = np.where(apart.min(axis=1)[:, None] <= BESIDE, known[nearest], places.unit)
    before, found = _curves(bench, bench.plan, points), {}
    for name, level in _levels(bench.plan, parts).items():
        now = _curves(bench, level.finer, points)
        change = np.abs(now - before)
        share = change.mean(axis=2) / np.maximum(change.mean(axis=(0, 2)), np.finfo(float).tiny)
        at = int(share.sum(axis=1).argmax())
        third = _third(bench, level, lambda plan, at=at: _curves(bench, plan, points[[at]])[0])
        ratio = None if third is None else level.ratio(before[at], now[at], third)[:, None]
        found[name] = richardson_error(places.errors(change), ratio)
        before = now
    return found


def _third(bench: Bench, level: Level, of: Callable[[Plan], np.ndarray]) -> np.ndarray | None:
    """What the third plan of a level gives; None where it has none, or its mesh is too coarse."""
    if level.third is None:
        return None
    try:
        return of(level.third)
    except CampaignError as error:
        name = bench.experiment.name
        bench.tell(f"{name}: the order of an error is not measured, and counts as 1: {error}")
        return None


def _curves(bench: Bench, plan: Plan, unit: np.ndarray) -> np.ndarray:
    """Responses (P, n, T) of a plan's runs at unit points (P, k)."""
    return np.array([record.values for record in bench.records(plan, runs_at(plan, unit))])


def _levels(plan: Plan, parts: tuple) -> dict[str, Level]:
    """The plan with half the step, and with that on a mesh twice as fine, those that are asked;
    and with a quarter of the step, and on a mesh half as fine."""
    time, experiment, found = plan.time, plan.experiment, {}
    if "step" in parts:
        time, quarter = _halved(plan.time), _halved(_halved(plan.time))
        found["step"] = Level(replace(plan, time=time), replace(plan, time=quarter), True)
    if "mesh" in parts and (mesh := experiment.scene_type.mesh):
        known = experiment.scene_type.parameters[mesh]
        number = experiment.scene.parameters.get(mesh, known.default)

        def with_mesh(number: float) -> Experiment:
            parameters = {**experiment.scene.parameters, mesh: number}
            return replace(experiment, scene=replace(experiment.scene, parameters=parameters))

        other = with_mesh(2 * number)
        # The step may be too long for the finer mesh.
        stable = choose_step(replace(other, solver=replace(other.solver, step="auto")))
        step = min(time.step, stable.step)
        finer = replace(plan, experiment=other, time=replace(stable, step=step))
        third = None
        if number % 2 == 0 and number // 2 >= known.lower:
            third = replace(plan, experiment=with_mesh(number // 2), time=time)
        found["mesh"] = Level(finer, third, False)
    return found


def _halved(time: TimeStep) -> TimeStep:
    return replace(time, step=time.step / 2, steps_per_instant=2 * time.steps_per_instant)
