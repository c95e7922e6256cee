"""Simulate one batch of a plan's runs, skipping those that are there already.

A batch is one process. It takes its runs in groups of `lanes`, integrates a group side by side,
writes it and goes on, so that memory stays bounded and a killed job loses one group at most. A run
that fails does not harm the others: they are written, and the failures are listed at the end.
"""

from __future__ import annotations

import json
import math
import platform
import sys
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from campaign.errors import CampaignError
from campaign.files import write_text
from campaign.nodes import share, unique_runs
from campaign.parameters import all_parameters
from campaign.store import Result, open_store


def groups_of(plan: Mapping, batches: int, lanes: int) -> list[list[list[dict]]]:
    """The plan's runs by batch, then by group of `lanes`; only the last group may be smaller."""
    runs = unique_runs(plan)
    groups = [runs[first : first + lanes] for first in range(0, len(runs), lanes)]
    return [share(groups, batch, batches) for batch in range(batches)]


def run_batch(
    plan: Mapping,
    batch: int,
    batches: int,
    jobs: Mapping,
    folder: str | Path,
    manifest: str | Path,
    tell: Any = lambda text: print(text, file=sys.stderr, flush=True),
) -> None:
    """Simulate batch `batch` of `batches` into the store in `folder`, then write the manifest.

    `jobs` is the config's section (`lanes`, `keep`). Raises `CampaignError` that lists the runs
    that failed, after all others were written; then there is no manifest.
    """
    started = clocks()
    store = open_store(jobs["keep"], folder, plan["config"])
    all_groups = groups_of(plan, batches, jobs["lanes"])
    mine = all_groups[batch]
    flat = [group for groups in all_groups for group in groups]
    work = [(group, missing) for group in mine if (missing := store.missing(group))]

    failures: list[tuple[dict, str]] = []
    simulated, integrating = 0, np.zeros(2)
    if work:
        warm_up(tell)
        progress = Progress(plan["campaign"], sum(map(len, flat)), lambda: store.count(flat), tell)
        for number, (group, missing) in enumerate(work, start=1):
            results, failed, taken = simulate(plan, missing)
            store.write(group, results)
            failures += failed
            simulated += len(results)
            integrating += taken
            progress.report(last=number == len(work))
    if failures:
        raise CampaignError(_failure_text(plan, failures))
    ids = [run["id"] for group in mine for run in group]
    facts = {
        "batch": batch,
        "runs": ids,
        "simulated": simulated,
        # Of the clock and of the processor.
        "seconds": (clocks() - started).round(3).tolist(),
        "seconds_integrating": integrating.round(3).tolist(),
    }
    write_text(manifest, json.dumps(facts, indent=1) + "\n")


def simulate(
    plan: Mapping, runs: list[dict]
) -> tuple[list[Result], list[tuple[dict, str]], np.ndarray]:
    """Simulate runs side by side: those that went well, those that failed with the reason, and the
    seconds (by `clocks`) that it took to integrate them."""
    import fpm

    config = plan["config"]
    scene_type = fpm.scenes.get(config["scene"]["name"])
    parameters = [
        all_parameters(config, scene_type, dict(zip(plan["names"], run["values"], strict=True)))
        for run in runs
    ]
    solver = config["solver"]
    scenes = [scene_type.build(**values) for values in parameters]
    before = clocks()
    outcomes = fpm.simulate(
        scenes,
        duration=solver["duration"],
        instants=solver["instants"],
        step=plan["step"],
        energy_tolerance=solver["energy_tolerance"],
    )
    seconds = clocks() - before
    results, failed = [], []
    for run, values, outcome in zip(runs, parameters, outcomes, strict=True):
        if outcome.failure is not None:
            failed.append((run, str(outcome.failure)))
            continue
        attributes = {
            "run_id": run["id"],
            "campaign": plan["campaign"],
            "config_hash": plan["config_hash"],
            "time_step_limit": plan["step_limit"],
            "limiting_element": plan["limiting_element"],
            "versions": versions(),
            **{f"parameter_{name}": v for name, v in values.items() if v is not None},
        }
        results.append(Result(run["id"], outcome, attributes))
    return results, failed, seconds


@cache
def versions() -> str:
    """What computes the runs, as one line for their files."""
    from importlib.metadata import PackageNotFoundError, version

    found = [f"Python {platform.python_version()}"]
    for package in ("deployable-intervals", "numpy", "numba"):
        with suppress(PackageNotFoundError):  # a checkout that was not installed
            found.append(f"{package} {version(package)}")
    return ", ".join(found)


def _failure_text(plan: Mapping, failures: list[tuple[dict, str]]) -> str:
    lines = [f"{len(failures)} of the runs failed; all others were written:"]
    for run, reason in failures:
        values = ", ".join(
            f"{n} = {v:.9g}" for n, v in zip(plan["names"], run["values"], strict=True)
        )
        lines.append(f"  run {run['id']} ({values}): {reason}")
    return "\n".join(lines)


def clocks() -> np.ndarray:
    """Seconds of the clock and of this process's cpu time, since some moment."""
    return np.array([time.perf_counter(), time.process_time()])


class Progress:
    """Tells how many runs of the campaign are done and how long the rest will take.

    Counts what all jobs together have written, so that the rate is that of the whole campaign.
    """

    def __init__(self, campaign: str, total: int, count: Any, tell: Any):
        self.campaign, self.total, self.count, self.tell = campaign, total, count, tell
        self.start_time, self.start_count = time.monotonic(), count()
        self.told = -math.inf

    def report(self, last: bool = True) -> None:
        """Tell; not more than once a second unless it is the last time."""
        if not last and time.monotonic() < self.told + 1.0:
            return
        self.told = time.monotonic()
        done = self.count()
        gained = done - self.start_count
        text = f"{self.campaign}: {done} of {self.total} runs done"
        if done < self.total and gained > 0:
            left = (time.monotonic() - self.start_time) / gained * (self.total - done)
            text += f", about {duration_text(left)} left"
        self.tell(text)


def duration_text(seconds: float) -> str:
    """`95` s as `1 min 35 s`."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"


def warm_up(tell: Any) -> None:
    """Compile the kernels, or load them, and tell if that takes a while."""
    import fpm

    slow = threading.Timer(5.0, tell, ["compiling the kernels, once; this takes about a minute"])
    slow.daemon = True
    slow.start()
    fpm.warm_up()
    slow.cancel()
