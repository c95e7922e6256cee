"""The runs of a campaign, and further ones wherever an answer asks for them.

Further runs go through the campaign's store, so that they are found again."""

import copy
import itertools
import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Experiment, Jobs
from deployable.campaign.files import ROLES
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import FailedRun, Plan, PlannedRun, RunAccount, Runs, read_plan
from deployable.campaign.results.quantity_results import MAX_FIT_RUNS, FittedRuns, number
from deployable.campaign.results.run_samples import open_samples
from deployable.campaign.runs.batch import Simulation, complete_group
from deployable.campaign.runs.progress import Notify
from deployable.campaign.runs.results import RunRecord, groups_of, pad_events
from deployable.campaign.runs.store import open_store

# In unit coordinates: points nearer than this have one run, or need none of their own.
SAME_RUN, SAME_POINT = 1e-6, 2e-4


class FurtherRuns:
    """Runs that answers made within the box of an `experiment`: `values`, of the interval
    parameters in each; `records`, what each gave."""

    def __init__(self, experiment: Experiment) -> None:
        self.experiment = experiment
        self.values: list[list[float]] = []
        self.records: list[RunRecord] = []

    @property
    def events(self) -> tuple[np.ndarray, np.ndarray]:
        """Events (R, e, 3) of the runs: time (s), what, and which way, padded with NaN; and margins
        (R, c) of the first event at each contact, stop or latch, NaN if not known."""
        events = pad_events([record.events for record in self.records])
        return events, np.array([record.event_margins for record in self.records])

    def add(self, model: Experiment, run: PlannedRun, record: RunRecord) -> None:
        """Add a run of a plan for `model`, an experiment that may have other intervals."""
        parameters = model.parameters(dict(zip(model.intervals, run.values, strict=True)))
        values, box = [parameters[name] for name in self.experiment.intervals], self.experiment.box
        nearest = box.from_unit(np.clip(box.to_unit(values), -1.0, 1.0))
        expected = self.experiment.parameters(dict(zip(box.names, values, strict=True)))
        if expected == parameters and np.allclose(nearest, values, rtol=1e-12, atol=0.0):
            self.values.append(values)
            self.records.append(record)


class ModelEvaluator:
    """The R runs that surrogates are fitted to, and simulation of further ones at any point of the
    box. `points` (R, k): -1 to 1; `numbers` (R, q): values of quantities, NaN if absent; `margins`
    (R, q): by how much each event occurs (above 0) or is missed, NaN if not known. `refinements`:
    planned runs that were added, at most `max_refinements`; `account`: counts all runs that it
    makes; `finest_step` (s): of runs that had to be repeated; `further_runs`: takes note of each
    run by its plan, or None; `simulated`: runs that were not stored before. Of a scan only some
    runs are taken: `rest_count` counts the others, `rest_counts` (q) those with each quantity.
    `planned_failures`, `failures`: planned and further runs that failed.

    It has no runs yet (but see `from_folder`)."""

    max_refinements: float = math.inf
    planned_failures: Sequence[FailedRun] = ()
    failures: Sequence[FailedRun] = ()
    _last_fit: tuple[Any, list[Any]] = (None, [])

    def __init__(
        self, plan: Plan, folder: Folder, jobs: Jobs, notify: Notify, threads: int = 1,
        further_runs: FurtherRuns | None = None,
    ) -> None:  # fmt: skip
        self.plan, self.folder, self.jobs = plan, folder, jobs
        self.notify, self.threads, self.further_runs = notify, threads, further_runs
        self.store = folder.runs(jobs.keep)
        self.points = np.zeros((0, len(plan.experiment.intervals)))
        self.numbers = np.zeros((0, len(plan.experiment.quantities)))
        self.margins = self.numbers
        self.rest_counts, self.rest_count = np.zeros(len(plan.experiment.quantities), int), 0
        self.refinements: list[PlannedRun] = []
        self.simulated, self.account = 0, RunAccount()
        self.finest_step = plan.time.step

    @classmethod
    def from_folder(
        cls, folder: Folder, jobs: Jobs, notify: Notify, threads: int = 1,
        further_runs: FurtherRuns | None = None, refinements: bool = False,
    ) -> "ModelEvaluator":  # fmt: skip
        """Make an evaluator with the runs of a folder of results, from its plan and `samples.nc`;
        of a scan of more than 10,000 runs those that `fitted_rows` chooses; with `refinements` also
        those in `refinement.nc`, which must exist."""
        model = cls(plan := read_plan(folder.plan), folder, jobs, notify, threads, further_runs)
        if len(plan.runs) <= MAX_FIT_RUNS:
            model.account = RunAccount(known_ids=[run.id for run in plan.runs])
        with open_samples(folder) as samples:
            model.finest_step = samples.finest_step
        runs = FittedRuns.read(folder, refinements)
        model.points, model.numbers, model.margins = runs.points, runs.numbers, runs.margins
        model.rest_count, model.rest_counts = len(runs.rest), np.isfinite(runs.rest).sum(axis=0)
        model.refinements += runs_at(plan, runs.points[len(runs.points) - runs.refinement_count :])
        model.planned_failures, model.failures = runs.failures
        return model

    def for_plan(self, plan: Plan) -> "ModelEvaluator":
        """Make an evaluator without runs for another plan; its runs go to the same store."""
        arguments = self.folder, self.jobs, self.notify, self.threads, self.further_runs
        return ModelEvaluator(plan, *arguments)

    @property
    def experiment(self) -> Experiment:
        """Experiment of the plan: scene, solver, intervals and all else that decides its runs."""
        return self.plan.experiment

    @cached_property
    def nominal(self) -> np.ndarray:
        """Normalized coordinates (k), -1 to 1 in the box, of the nominal run."""
        return self.experiment.box.to_unit(self.experiment.nominal)

    @property
    def failed_points(self) -> np.ndarray:
        """Normalized points (F, k) of all runs that failed."""
        failures = [*self.planned_failures, *self.failures]
        points = [failure.run.normalized for failure in failures]
        return np.reshape(points, (-1, self.points.shape[1]))

    @property
    def spare_failures(self) -> int:
        """How many more runs may fail, and one beside, before further ones end (`add`); below -1
        where more failed than `solver.failures` allows."""
        if not (count := len(self.failed_points)):
            return 0
        total = len(self.points) + self.rest_count + count
        return int(self.experiment.solver.failures * total) - count - 1

    def nearest(self, point: np.ndarray) -> tuple[int, float]:
        """Return the index of the evaluator's run nearest to a normalized point (k), and its
        distance, the largest difference of a normalized coordinate."""
        distances = np.abs(self.points - point).max(axis=1)
        row = int(distances.argmin())
        return row, float(distances[row])

    def find_missing(self, points: Sequence[np.ndarray] | np.ndarray) -> list[np.ndarray]:
        """Return those of some normalized points (k) at which the evaluator made no run."""
        runs = np.concatenate([self.points, self.failed_points])
        return [x for x in points if np.abs(runs - x).max(axis=1).min() > SAME_POINT]

    def describe_point(self, point: np.ndarray, q: int) -> dict:
        """Describe a normalized point (k), None for no point, for JSON: `at`, parameter values by
        name; `ran`, whether a run was made there; `simulated`, the value in it of quantity `q`, or
        None; and `failed`, True, where that run failed."""
        box = self.experiment.box
        values = dict(zip(box.names, map(number, box.from_unit(point)), strict=True))
        run, distance = self.nearest(point)
        has_run = bool(distance <= SAME_POINT)
        value = self.numbers[run, q] if has_run else np.nan
        row = {"at": values, "ran": has_run, "simulated": number(value)}
        is_lost = (np.abs(self.failed_points - point).max(axis=1) <= SAME_POINT).any()
        return row | {"failed": True} if is_lost else row

    def add(self, points: Sequence[np.ndarray] | np.ndarray) -> np.ndarray:
        """Simulate runs at normalized points (P, k) that have none yet, add them to the evaluator's
        (`points`, `numbers`, `margins`, `refinements`), and return the index (P) of the run at each
        point, or of the nearest once `max_refinements` are added, too many runs failed, or the
        `account` allows no more, or where the run fails, which goes to `failures`."""
        additions: list[np.ndarray] = []
        for point in points if self.spare_failures >= -1 else ():
            present = np.array([*self.points, *self.failed_points, *additions])
            present = present.reshape(-1, self.points.shape[1])
            is_new = not (np.abs(present - point).max(axis=1) <= SAME_RUN).any()
            if is_new and len(self.refinements) + len(additions) < self.max_refinements:
                additions.append(np.asarray(point, dtype=float))
        ids = [run.id for run in runs_at(self.plan, additions)]
        is_allowed = self.account.count_runs(ids)
        additions = list(itertools.compress(additions, is_allowed))
        if additions:
            runs = runs_at(self.plan, additions)
            numbers, margins = self.evaluate(self.plan, additions)
            lost_ids = {failure.run.id for failure in self.failures}
            is_sound = np.array([run.id not in lost_ids for run in runs])
            self.numbers = np.concatenate([self.numbers, numbers[is_sound]])
            self.margins = np.concatenate([self.margins, margins[is_sound]])
            self.points = np.concatenate([self.points, np.array(additions)[is_sound]])
            self.refinements += itertools.compress(runs, is_sound)
        return np.array([self.nearest(point)[0] for point in points], dtype=int)

    def narrow(self, experiment: Experiment) -> "ModelEvaluator":
        """Make an evaluator over a part of the box, that of `experiment`, with those of the runs
        that lie there; its further runs go to the same store and account."""
        part = copy.copy(self)
        part.__dict__.pop("nominal", None)
        part.plan = replace(self.plan, experiment=experiment)
        part.refinements, part.simulated = [], 0
        part.planned_failures, part.failures = [], []
        points = experiment.box.to_unit(self.experiment.box.from_unit(self.points))
        rows = (np.abs(points) <= 1 + SAME_RUN).all(axis=1)
        part.points, part.numbers = points[rows], self.numbers[rows]
        part.margins = self.margins[rows]
        return part

    def absorb(self, part: "ModelEvaluator") -> None:
        """Add the runs that an evaluator over a part of the box (`narrow`) has made."""
        new = -len(part.refinements) or len(part.points)
        points = self.experiment.box.to_unit(part.experiment.box.from_unit(part.points[new:]))
        self.points = np.concatenate([self.points, points])
        self.numbers = np.concatenate([self.numbers, part.numbers[new:]])
        self.margins = np.concatenate([self.margins, part.margins[new:]])
        self.simulated += part.simulated
        for failure in part.failures:
            values = part.experiment.box.from_unit(np.asarray(failure.run.normalized))
            normalized = tuple(self.experiment.box.to_unit(values).tolist())
            run = replace(failure.run, normalized=normalized)
            self.failures = [*self.failures, failure._replace(run=run)]

    @property
    def distinct_rows(self) -> np.ndarray:
        """Indices of the evaluator's runs, increasing, one for each distinct point."""
        return np.sort(np.unique(np.round(self.points, 9) + 0.0, axis=0, return_index=True)[1])

    def surrogates(self) -> list[Any]:
        """Fit an `intervals.scalars.ScalarSurrogate` to the runs for each quantity, in order; once,
        as long as there are no others."""
        if self._last_fit[0] is not self.points:
            runs = FittedRuns(self.points, self.numbers, self.margins)
            self._last_fit = self.points, runs.surrogates(self.experiment)
        return self._last_fit[1]

    def evaluate(
        self, plan: Plan, points: Sequence[np.ndarray] | np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Quantities and event margins, (P, q) each, of runs at normalized points (P, k) with mesh
        and step of `plan`, simulated unless stored; they do not become the evaluator's own. NaN of
        runs that its `account` does not allow, and of those that fail."""
        runs = runs_at(plan, points)
        rows = np.flatnonzero(self.account.count_runs([run.id for run in runs]))
        numbers, margins = np.full((2, len(runs), len(self.experiment.quantities)), np.nan)
        if len(rows):
            records = self.records(plan, runs[rows])
            for row, record in zip(rows, records, strict=True):
                if record is not None:
                    numbers[row], margins[row] = record.numbers, record.margins
        return numbers, margins

    def records(self, plan: Plan, runs: Runs) -> list[RunRecord | None]:
        """The `RunRecord` of each of a plan's runs, simulated unless stored, whatever the `account`
        allows; None of one that fails."""
        self.account.count_runs([run.id for run in runs])
        store = open_store(self.jobs.keep, self.store, plan.experiment)
        records: dict = {}
        simulation = Simulation(plan, self.jobs.group, self.threads)
        for group in groups_of(runs.unique(), self.jobs.group):
            complete_group(plan, store, group, simulation, self.notify)
            records |= store.read(group)
        if plan is self.plan:
            self.finest_step = min([self.finest_step, *(r.step for r in records.values())])
        self.simulated += simulation.count
        failures = store.list_failures(runs)
        if plan is self.plan:
            known_ids = {f.run.id for f in (*self.planned_failures, *self.failures)}
            self.failures = [*self.failures, *(f for f in failures if f.run.id not in known_ids)]
        if self.further_runs and plan is self.plan:
            for run in runs:
                if run.id in records:
                    self.further_runs.add(plan.experiment, run, records[run.id])
        return [records.get(run.id) for run in runs]


def runs_at(plan: Plan, points: Sequence[np.ndarray] | np.ndarray) -> Runs:
    """Make runs beyond the design (role "further") at normalized points (P, k), -1 to 1 in
    the box, with mesh and step of a plan; nothing is simulated."""
    places = np.reshape(points, (-1, plan.experiment.box.dimension)).astype(float)
    role = np.full(len(places), ROLES.index("further"), np.int8)
    names = plan.time.step, plan.mechanics
    return Runs.from_points(plan.experiment, role, places, *names)
