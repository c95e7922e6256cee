"""Run a batch of a plan: groups of runs in processes and threads, written as they come."""

import json
import multiprocessing
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from itertools import chain, islice
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np

import fpm
from deployable.campaign.config.sections import Jobs
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import ROLES, write_result
from deployable.campaign.plan.plan import FailedRun, Plan, PlannedRun, Runs, split_evenly
from deployable.campaign.provenance import as_attribute
from deployable.campaign.runs.progress import (
    MessagePrinter,
    Notify,
    progress_of,
    report_step,
    warm_up,
)
from deployable.campaign.runs.results import Result, groups_of
from deployable.campaign.runs.store import open_store
from fpm.files.seals import remove_temporary
from fpm.reading.variables import words
from fpm.solver.simulate import HALVINGS

_MOST = 100  # runs that failed, named in a message

_WORK: dict[str, Any] = {}
"""What the processes of a batch inherit, since it need not be sent to them then."""

_BUILD_LOCK = Lock()
"""Held while scenes are built, since a structure keeps the models that it has made."""


def run_batch(
    plan: Plan,
    batch: int,
    batches: int,
    jobs: Jobs,
    folder: str | Path,
    manifest: str | Path,
    notify: Notify,
    threads: int = 1,
    processes: int = 1,
) -> None:
    """Simulate a batch of a plan's runs into a store, but for those that it has, then write the
    JSON file `manifest` with numbers of runs and seconds. batch: its number, from 0, of `batches`;
    threads share a group of runs, processes the groups: no result depends on them. Raises
    `CampaignError` if too many runs fail, after all others were written; then without manifest."""
    start_clocks = clocks()
    store = open_store(jobs.keep, folder, plan.experiment)
    remove_temporary(folder)
    groups = groups_of(plan.unique_runs, jobs.group)
    batch_groups = split_evenly(groups, batch, batches)
    work = [(group, missing) for group in batch_groups if len(missing := store.missing(group))]
    notify_reruns(store, notify)

    simulation, total = Simulation(plan, jobs.group, threads), sum(map(len, groups))
    if work:
        check_structure(plan)
        scene = plan.experiment.build(plan.name_values(work[0][1][0]))
        warm_up(scene, notify, plan.experiment.record)
        describe = progress_of(plan.experiment.name, total, store.counter(groups))
        start = time.perf_counter()
        lots = [work] if processes == 1 else [[item] for item in work]
        simulate_lot = partial(_simulate_groups, simulation, store)
        with report_step(describe, notify, processes == 1):
            for totals in spread(simulate_lot, [(lot,) for lot in lots], processes):
                simulation.take(totals)
                if processes > 1 and isinstance(notify, MessagePrinter):
                    notify.move(describe(time.perf_counter() - start))
        notify(describe(time.perf_counter() - start))
    store.note_failures(simulation.failures)  # of other processes
    failures = [failure for group in batch_groups for failure in store.list_failures(group)]
    check_failures(plan, failures, total)
    facts = {
        "batch": batch,
        "runs": sum(map(len, batch_groups)),
        "simulated": simulation.count,
        # Of the clock and of the processor.
        "seconds": (clocks() - start_clocks).round(3).tolist(),
        "seconds_integrating": simulation.seconds.round(3).tolist(),
    }
    write_result(manifest, json.dumps(facts, indent=1) + "\n")


def spread(function: Callable, work: Sequence[tuple], processes: int) -> Iterator[Any]:
    """Call `function(*arguments)` for each tuple of arguments in `work` in forked processes, at
    most `processes` at once, or here if that is 1, and yield the results, in order of completion.
    Raises what the function raises, and `CampaignError` if a process was ended from outside."""
    processes = min(processes, len(work))
    if processes < 2:
        yield from (function(*arguments) for arguments in work)
        return
    _WORK.update(function=function, work=work)
    context = multiprocessing.get_context("fork")
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        try:
            for future in as_completed([pool.submit(_call, number) for number in range(len(work))]):
                yield future.result()
        except BrokenProcessPool:
            raise CampaignError(
                "a process of this job was ended from outside, for lack of memory perhaps; "
                "finished runs are kept"
            ) from None
        finally:
            pool.shutdown(cancel_futures=True)
            _WORK.clear()


def _call(number: int) -> Any:
    return _WORK["function"](*_WORK["work"][number])


def _simulate_groups(
    simulation: "Simulation", store: Any, work: Sequence[tuple[Runs, Runs]]
) -> tuple[int, list[FailedRun], np.ndarray]:
    """Simulate and write the missing runs of groups; returns their number, failures, seconds."""
    runner = Simulation(simulation.plan, simulation.size, simulation.threads)
    lots = [missing for _, missing in work]
    for (group, _), results in zip(work, runner.run_lots(lots), strict=True):
        store.write(group, results)
        store.note_failures(runner.failures)
    return runner.count, runner.failures, runner.seconds


def check_structure(plan: Plan) -> None:
    """Raise `CampaignError` if the structure or the code that computes runs changed since the plan
    was made, as the ids of its runs would then name other runs."""
    if plan.experiment.mechanics != plan.mechanics:
        source = plan.experiment.scene.file or f"the structure {plan.experiment.scene.name}"
        raise CampaignError(f"{source} has changed since the runs were planned; start again")


def notify_reruns(store: Any, notify: Notify) -> None:
    """Report why runs of a store are made again (after `missing`): a text for each damaged file,
    and one for all runs whose files lack what responses need; then clear its notes of it."""
    for error in store.damage.values():
        notify(f"{error}; its runs are made again")
    store.damage.clear()
    if store.absences:
        variables = words(sorted(set().union(*store.absences.values())))
        count = len(store.absences)
        notify(f"{count} runs lack {variables}; they are simulated again")
    store.absences.clear()


def complete_group(
    plan: Plan, store: Any, group: Runs, simulation: "Simulation", notify: Notify, text: str = ""
) -> None:
    """Simulate the runs of a group that a store lacks, and write them into it; text: a message that
    comes first, with the number of these runs in place of `{}`. Raises `CampaignError` if structure
    or code changed since the plan was made."""
    missing = store.missing(group)
    notify_reruns(store, notify)
    if len(missing):
        check_structure(plan)
        if text:
            notify(text.format(len(missing)))
        scene = plan.experiment.build(plan.name_values(missing[0]))
        warm_up(scene, notify, plan.experiment.record)
        store.write(group, simulation.results(missing))
    store.note_failures(simulation.failures)


class Simulation:
    """Simulates runs of a plan in groups of `size`, which `threads` share, and counts them.
    Attributes: `count`: runs that succeeded; `failures`: those that did not; `seconds` (2):
    spent integrating, wall-clock (mean of the threads) and processor time (their sum)."""

    def __init__(self, plan: Plan, size: int, threads: int = 1):
        self.plan, self.size, self.threads = plan, size, threads
        self.count, self.seconds = 0, np.zeros(2)
        self.failures: list[FailedRun] = []

    def take(self, totals: tuple[int, list[FailedRun], np.ndarray]) -> None:
        """Add another simulation's totals: a tuple of the number of runs that succeeded, those that
        failed, and seconds (2), wall-clock and processor time."""
        count, failures, seconds = totals
        self.count += count
        self.failures += failures
        self.seconds += seconds

    def results(self, runs: Runs) -> Iterator[Result]:
        """Simulate runs and yield the `Result` of each that succeeds, in order."""
        for results in self.run_lots([runs]):
            yield from results

    def run_lots(self, lots: Sequence[Runs]) -> Iterator[Iterator[Result]]:
        """Simulate several lots of runs, and yield for each an iterator of `Result`, to be consumed
        in order, while threads go on."""
        with ThreadPoolExecutor(self.threads) as pool:

            def start(group: Runs) -> list[Future]:
                count = max(1, min(self.threads, len(group) // 4))  # eight runs take as long as one
                whole: Any = group
                parts = [split_evenly(whole, part, count) for part in range(count)]
                return [pool.submit(simulate, self.plan, part) for part in parts]

            groups = [groups_of(runs, self.size) for runs in lots]
            futures = _one_ahead(start, chain.from_iterable(groups))
            try:
                for lot in groups:
                    yield self._collect(islice(futures, len(lot)))
            finally:
                pool.shutdown(cancel_futures=True)

    def _collect(self, futures: Iterable[list[Future]]) -> Iterator[Result]:
        for parts in futures:
            for part in parts:
                results, failures, seconds = part.result()
                self.take((len(results), failures, seconds / (self.threads, 1)))
                yield from results


def _one_ahead(start: Callable, items: Iterable[Any]) -> Iterator[Any]:
    """`start(item)` of all items in order, each when that of the next was called."""
    queue: deque = deque()
    for item in items:
        queue.append(start(item))
        if len(queue) > 1:
            yield queue.popleft()
    yield from queue


def simulate(
    plan: Plan, runs: Sequence[PlannedRun]
) -> tuple[list[Result], list[FailedRun], np.ndarray]:
    """Simulate runs side by side in this thread: a `Result` or `FailedRun` each, and seconds (2) of
    integration, wall-clock and processor."""
    experiment, solver = plan.experiment, plan.experiment.solver
    parameters = [experiment.parameters(plan.name_values(run)) for run in runs]
    with _BUILD_LOCK:
        scenes = experiment.scene_type.build_all(parameters)
    start = clocks(time.thread_time)
    outcomes = fpm.simulate(
        scenes,
        duration=solver.duration,
        instants=solver.instants,
        step=plan.time.step,
        energy_tolerance=solver.energy_tolerance,
        record=experiment.record,
        halvings=HALVINGS if solver.step == "auto" else 0,
        readings=experiment.readings(plan.time.step),
        peaks=experiment.peaks,
    )
    seconds = clocks(time.thread_time) - start
    common = {
        "campaign": experiment.name,
        "config_hash": plan.config_hash,
        "time_step_limit": plan.time.step_limit,
        "limiting_element": plan.time.limiting_element,
        "provenance": as_attribute(),
    }
    results, failures = [], []
    for run, values, outcome in zip(runs, parameters, outcomes, strict=True):
        if outcome.failure is not None:
            moment = getattr(outcome.failure, "time", np.nan)
            failures.append(FailedRun(run, float(moment), str(outcome.failure)))
            continue
        if outcome.dropped_events:
            count = len(outcome.events) + outcome.dropped_events
            reason = f"{count} contact events, more than are kept: contacts chatter"
            failures.append(FailedRun(run, np.nan, reason))
            continue
        results.append(Result(run, outcome, values, common))
    return results, failures, seconds


def check_failures(plan: Plan, failures: Sequence[FailedRun], total: int) -> None:
    """Raise `CampaignError` if more of the `total` runs failed than the config allows, or the
    nominal one did. It names at most 100 runs, with parameter values and reasons."""
    allowed = plan.experiment.solver.failures
    nominal = [failure for failure in failures if failure.run.role == ROLES[0]]
    if not nominal and len(failures) <= allowed * total:
        return
    cause = "the nominal run among them" if nominal else f"solver.failures allows {allowed:.3g}"
    lines = [f"{len(failures)} of {total} runs failed ({cause}); all others were written:"]
    for run, _, reason in failures[:_MOST]:
        values = ", ".join(f"{name} = {value:.9g}" for name, value in plan.name_values(run).items())
        lines.append(f"  run {run.id} ({values}): {reason}")
    if len(failures) > _MOST:
        lines.append(f"  and {len(failures) - _MOST} more")
    raise CampaignError("\n".join(lines))


def clocks(cpu: Callable[[], float] = time.process_time) -> np.ndarray:
    """Read the clocks: seconds (2) of wall-clock and processor time, by the function `cpu`."""
    return np.array([time.perf_counter(), cpu()])
