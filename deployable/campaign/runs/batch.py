"""Simulate one batch of a plan's runs, skipping those that are there already.

A batch is one process, or several that share its groups. A process takes its runs in groups,
integrates a group side by side, hands it to
the store and goes on, so that memory stays bounded and a killed
job loses one group of each process at most. A run that fails does not harm the others: they are
written, and the failures are listed at the end.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Jobs
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import write_result
from deployable.campaign.plan.plan import Plan, share
from deployable.campaign.plan.runs import Run, Runs
from deployable.campaign.provenance import as_attribute
from deployable.campaign.runs.processes import spread
from deployable.campaign.runs.progress import Progress, Tell, warm_up
from deployable.campaign.runs.results import Result, groups_of
from deployable.campaign.runs.store import open_store
from deployable.campaign.stopping import import_ahead
from deployable.fpm.asked import Column, words
from deployable.fpm.sealed import sweep

Failure = tuple[Run, str]

_TOLD = 100  # runs that failed, named in a message


def run_batch(
    plan: Plan,
    batch: int,
    batches: int,
    jobs: Jobs,
    folder: str | Path,
    manifest: str | Path,
    tell: Tell,
    threads: int = 1,
    processes: int = 1,
    ahead: Iterable[str] = (),
) -> None:
    """Simulate batch `batch` of `batches` into the store in `folder`, then write the manifest.

    Groups are shared among `processes`, and each among `threads`, which changes no number. The
    modules `ahead` are imported while threads integrate, but not while they load what they need.
    Raises `CampaignError` that lists the runs that failed, after all others were written; then
    there is no manifest.
    """
    started = clocks()
    store = open_store(jobs.keep, folder, plan.experiment)
    sweep(folder)
    groups = store.groups(plan.unique_runs(), jobs.group)
    mine = share(groups, batch, batches)
    work = [(group, missing) for group in mine if len(missing := store.missing(group))]
    tell_again(store, tell)

    simulation = Simulation(plan, jobs.group, threads)
    if work:
        check_structure(plan)
        scene = plan.experiment.build(plan.named(work[0][1][0]))
        warm_up(scene, tell, plan.experiment.asked)
        for name in ahead:
            import_ahead(name)
        total = sum(map(len, groups))
        progress = Progress(plan.experiment.name, total, store.counter(groups), tell, Path(folder))
        begun = clocks()
        simulation.after = lambda: progress.report(last=False)
        one = partial(_simulate_group, simulation, store, processes)
        for other in spread(one, work, processes):
            simulation.take(other)
            progress.report(last=False)
        progress.report()
        if simulation.count and jobs.minutes:
            taken = (clocks() - begun)[0] * min(processes, len(work)) / simulation.count
            tell(f"jobs.run_seconds: {taken:.3g} s of a core for a run here")
    simulation.check()
    facts = {
        "batch": batch,
        "runs": sum(map(len, mine)),
        "simulated": simulation.count,
        # Of the clock and of the processor.
        "seconds": (clocks() - started).round(3).tolist(),
        "seconds_integrating": simulation.seconds.round(3).tolist(),
    }
    write_result(manifest, json.dumps(facts, indent=1) + "\n")


def _simulate_group(
    simulation: Simulation, store: Any, processes: int, group: Runs, missing: Runs
) -> tuple[int, list[Failure], np.ndarray]:
    """Simulate what is missing of a group and write it: how many, failures, seconds.

    Progress is told by the first of several processes.
    """
    own = Simulation(simulation.plan, simulation.size, simulation.threads)
    if processes == 1:
        own.after = simulation.after
    store.write(group, own.results(missing, store.had(missing)))
    return own.count, own.failures, own.seconds


def check_structure(plan: Plan) -> None:
    """Raise `CampaignError` if the structure or the mechanics are no longer those of the plan.

    The runs would be others under the names of the planned ones.
    """
    if plan.experiment.scene_type.digest != plan.mechanics:
        what = plan.experiment.scene.file or f"the code of the scene {plan.experiment.scene.name}"
        raise CampaignError(f"{what} has changed since the runs were planned; start again")


def tell_again(store: Any, tell: Tell) -> None:
    """Tell which files of a store can not be used, and will be made again; each once."""
    for error in store.damaged.values():
        tell(f"{error}; its runs are made again")
    store.damaged.clear()
    if store.lacking:
        what = words(sorted(set().union(*store.lacking.values())))
        tell(f"{len(store.lacking)} runs were recorded without {what}; they are simulated again")
    store.lacking.clear()


def make_again(plan: Plan, store: Any, group: Runs, size: int, tell: Tell) -> None:
    """Simulate the runs of a group that were there and are no longer, or are damaged.

    Raises `CampaignError` that lists those that failed.
    """
    missing = store.missing(group)
    tell_again(store, tell)
    if not len(missing):
        return
    check_structure(plan)
    tell(f"{plan.experiment.name}: {len(missing)} runs are missing and made again")
    simulation = Simulation(plan, size)
    store.write(group, simulation.results(missing, store.had(missing)))
    simulation.check()


class Simulation:
    """Simulates runs of a plan, `size` side by side, on so many threads.

    Attributes: `count` of the runs that went well, `failures`, and the `seconds` (by `clocks`) that
    it took to integrate; `after` is called after each group.
    """

    def __init__(self, plan: Plan, size: int, threads: int = 1):
        self.plan, self.size, self.threads = plan, size, threads
        self.count, self.seconds = 0, np.zeros(2)
        self.failures: list[Failure] = []
        self.after: Callable[[], None] = lambda: None

    def take(self, other: tuple[int, list[Failure], np.ndarray]) -> None:
        """Add what another one has done: its count, failures and seconds."""
        count, failures, seconds = other
        self.count += count
        self.failures += failures
        self.seconds += seconds

    def results(self, runs: Runs, also: Iterable[Column] = ()) -> Iterator[Result]:
        """The results of those runs that go well, as they come; also: as for `simulate`."""
        for group in groups_of(runs, self.size):
            results, failed, taken = simulate(self.plan, group, self.threads, also)
            self.count += len(results)
            self.failures += failed
            self.seconds += taken
            yield from results
            self.after()

    def check(self) -> None:
        """Raise `CampaignError` that lists the runs that failed, if any did."""
        if self.failures:
            raise CampaignError(failure_text(self.plan, self.failures))


def simulate(
    plan: Plan, runs: Sequence[Run], threads: int = 1, also: Iterable[Column] = ()
) -> tuple[list[Result], list[Failure], np.ndarray]:
    """Simulate runs side by side: those that went well, those that failed with the reason, and the
    seconds (by `clocks`) that it took to integrate them. also: what is recorded beside what the
    responses need."""
    from deployable import fpm

    experiment, solver = plan.experiment, plan.experiment.solver
    parameters = [experiment.parameters(plan.named(run)) for run in runs]
    scenes = [experiment.scene_type.build(**values) for values in parameters]
    before = clocks()
    integrate = partial(
        fpm.simulate,
        duration=solver.duration,
        instants=solver.instants,
        step=plan.time.step,
        energy_tolerance=solver.energy_tolerance,
        record=sorted({*experiment.asked, *also}),
    )
    threads = max(1, min(threads, len(scenes) // 4))  # eight runs take as long as one
    with ThreadPoolExecutor(threads) as pool:
        shares = [share(scenes, part, threads) for part in range(threads)]
        outcomes = [outcome for part in pool.map(integrate, shares) for outcome in part]
    seconds = clocks() - before
    results, failed = [], []
    for run, values, outcome in zip(runs, parameters, outcomes, strict=True):
        if outcome.failure is not None:
            failed.append((run, str(outcome.failure)))
            continue
        if outcome.events_dropped:
            count = len(outcome.events) + outcome.events_dropped
            failed.append((run, f"{count} contact events, more than are kept: contacts chatter"))
            continue
        attributes = {
            "run_id": run.id,
            "campaign": experiment.name,
            "config_hash": plan.config_hash,
            "time_step_limit": plan.time.step_limit,
            "limiting_element": plan.time.limiting_element,
            "provenance": as_attribute(),
            **{f"parameter_{name}": v for name, v in values.items() if v is not None},
        }
        results.append(Result(run, outcome, attributes))
    return results, failed, seconds


def failure_text(plan: Plan, failures: Sequence[Failure]) -> str:
    """Which runs of a plan failed, with their parameters and the reason."""
    lines = [f"{len(failures)} of the runs failed; all others were written:"]
    for run, reason in failures[:_TOLD]:
        values = ", ".join(f"{name} = {value:.9g}" for name, value in plan.named(run).items())
        lines.append(f"  run {run.id} ({values}): {reason}")
    if len(failures) > _TOLD:
        lines.append(f"  and {len(failures) - _TOLD} more")
    return "\n".join(lines)


def clocks() -> np.ndarray:
    """Seconds of the clock and of this process's cpu time, since some moment."""
    return np.array([time.perf_counter(), time.process_time()])
