"""One batch of the planned runs."""

from typing import Any

from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.runs.batch import run_batch
from deployable.campaign.runs.progress import Notify
from deployable.campaign.runs.store import pack


def work(
    folder: Folder, notify: Notify, jobs: Any, batch: int = 0, batches: int = 1, threads: int = 1,
    processes: int = 1, bundle: Any = None,
) -> None:  # fmt: skip
    """Do the work of the stage `simulate`: simulate one batch of the planned runs, except those
    that are stored already. batch: its number, from 0, of `batches`; processes divide the batch,
    threads each group of runs; bundle: path of a tar file to write with the runs."""
    plan = read_plan(folder.plan)
    store, manifest = folder.runs(jobs.keep), folder.batch(batch)
    run_batch(plan, batch, batches, jobs, store, manifest, notify, threads, processes)
    if bundle:
        pack(store, bundle)
