"""The runs of a campaign, and further ones wherever an answer asks for them.

Further runs go through the campaign's store, so that they are found again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from campaign.config.sections import Experiment, Jobs
from campaign.errors import CampaignError
from campaign.files import open_netcdf
from campaign.folder import Folder
from campaign.plan.make import run_id
from campaign.plan.plan import Plan, Run, read_plan
from campaign.runs.batch import check_structure, failure_text, simulate, tell_again
from campaign.runs.progress import Tell, warm_up
from campaign.runs.store import Record, open_store

# In unit coordinates: places nearer than this have one run, or need none of their own.
NEAR, SAME = 1e-6, 1e-3


class Bench:
    """Runs of a plan's experiment at unit points `unit` (R, k), with the numbers (R, q) of their
    quantities; `further` are those that were asked for here, `simulated` of which were not there.
    """

    def __init__(self, plan: Plan, jobs: Jobs, store: Path, tell: Tell, threads: int = 1) -> None:
        self.plan, self.jobs, self.store, self.tell, self.threads = plan, jobs, store, tell, threads
        self.unit = np.zeros((0, len(plan.experiment.intervals)))
        self.numbers = np.zeros((0, len(plan.experiment.quantities)))
        self.further: list[Run] = []
        self.simulated = 0

    @classmethod
    def of(
        cls, folder: Folder, jobs: Jobs, tell: Tell, threads: int = 1, further: bool = False
    ) -> Bench:
        """The runs of a campaign that was sampled, perhaps with the further ones of quantities."""
        bench = cls(read_plan(folder.plan), jobs, folder.runs(jobs.keep), tell, threads)
        with open_netcdf(folder.samples) as samples:
            bench.unit = samples["unit"][:]
            if bench.experiment.quantities:
                bench.numbers = samples["quantities"][:]
        if further:
            with open_netcdf(folder.further) as file:
                if len(points := file["unit"][:]):
                    bench.unit = np.concatenate([bench.unit, points])
                    bench.numbers = np.concatenate([bench.numbers, file["quantities"][:]])
                    bench.further += runs_at(bench.plan, points)
        return bench

    @property
    def experiment(self) -> Experiment:
        """What the runs are of."""
        return self.plan.experiment

    @cached_property
    def nominal(self) -> np.ndarray:
        """Unit coordinates (k) of the nominal run."""
        return self.experiment.box.to_unit(self.experiment.nominal)

    def nearest(self, point: np.ndarray) -> tuple[int, float]:
        """The run nearest to a unit point (k), and how far it is (largest coordinate)."""
        apart = np.abs(self.unit - point).max(axis=1)
        at = int(apart.argmin())
        return at, float(apart[at])

    def place(self, at: np.ndarray, q: int) -> dict:
        """A unit point (k) as parameter values `at`, and what was `simulated` there of quantity
        number `q`: None where there is no run, or no number."""
        box = self.experiment.box
        values = dict(zip(box.names, map(float, box.from_unit(at)), strict=True))
        run, apart = self.nearest(at)
        value = self.numbers[run, q] if apart <= SAME else np.nan
        return {"at": values, "simulated": number(value)}

    def add(self, points: Sequence[np.ndarray]) -> np.ndarray:
        """Indices of the runs at unit points (P, k), simulated unless they are there.

        Raises `CampaignError` if one fails.
        """
        wanted: list[np.ndarray] = []
        for point in points:
            known = np.array([*self.unit, *wanted]).reshape(-1, self.unit.shape[1])
            if not (np.abs(known - point).max(axis=1) <= NEAR).any():
                wanted.append(np.asarray(point, dtype=float))
        if wanted:
            runs = runs_at(self.plan, wanted)
            self.numbers = np.concatenate([self.numbers, self.measure(self.plan, runs)])
            self.unit = np.concatenate([self.unit, wanted])
            self.further += runs
        return np.array([self.nearest(point)[0] for point in points], dtype=int)

    def surrogates(self) -> list[Any]:
        """A surrogate of each quantity (`intervals.scalars.ScalarSurrogate`), from all runs."""
        from intervals.scalars import fit_scalar

        end = self.experiment.solver.duration
        asked = zip(self.numbers.T, self.experiment.numbers, strict=True)
        return [
            fit_scalar(self.unit, column, end if q.is_time else None, q.least)
            for column, q in asked
        ]

    def measure(self, plan: Plan, runs: Sequence[Run]) -> np.ndarray:
        """The quantities (r, q) of runs of a plan, simulated unless the store has them."""
        return np.array([record.numbers for record in self.records(plan, runs)])

    def records(self, plan: Plan, runs: Sequence[Run]) -> list[Record]:
        """What there is of runs of a plan, simulated unless the store has them.

        Raises `CampaignError` if one fails.
        """
        store = open_store(self.jobs.keep, self.store, plan.experiment)
        plan = replace(plan, runs=tuple(runs))
        found, failures = {}, []
        for group in plan.groups(1, self.jobs.group)[0]:
            missing = store.missing(group)
            tell_again(store, self.tell)
            if missing:
                check_structure(plan)
                scene = plan.experiment.build(plan.named(missing[0]))
                warm_up(scene, self.tell, plan.experiment.asked)
                results, failed, _ = simulate(plan, missing, self.threads, store.had(missing))
                store.write(group, results)
                failures += failed
                self.simulated += len(results)
            found |= store.read(group)
        if failures:
            raise CampaignError(failure_text(plan, failures))
        return [found[run.id] for run in runs]


def runs_at(plan: Plan, points: Sequence[np.ndarray]) -> list[Run]:
    """The runs of a plan's experiment, with its step, at unit points (P, k)."""
    experiment, runs = plan.experiment, []
    for point in points:
        values = tuple(map(float, experiment.box.from_unit(point)))
        named = dict(zip(experiment.intervals, values, strict=True))
        name = run_id(experiment, experiment.parameters(named), plan.time.step, plan.mechanics)
        runs.append(Run(name, "further", tuple(map(float, point)), values))
    return runs


def number(value: float) -> float | None:
    """A number for JSON; None for what is none."""
    return float(value) if np.isfinite(value) else None
