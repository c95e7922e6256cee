"""How large jobs are, and what they ask a queue for: time and memory."""

from __future__ import annotations

import math

from deployable.campaign.config.sections import Campaign
from deployable.campaign.plan.estimate import LANES, recorded, run_seconds
from deployable.campaign.plan.make import choose_step
from deployable.campaign.plan.plan import TimeStep

STARTING = 5.0
"""Minutes of a job beside its runs, at most: starting, and compiling the time loop once."""

PROGRAM, PROCESS = 600.0, 150.0
"""Megabytes of a job with its libraries and while it compiles, and of each process beside it."""


def runs_in_job(campaign: Campaign) -> int:
    """Most runs in a job that takes `jobs.minutes`: whole groups, one at least for each process."""
    jobs = campaign.jobs
    fitting = 60.0 * jobs.minutes * jobs.processes / seconds_of_run(campaign)
    return max(1, jobs.processes, int(fitting / jobs.group)) * jobs.group


def job_minutes(campaign: Campaign, runs: int, time: TimeStep | None = None) -> int:
    """Minutes to ask a queue for, for a job of so many runs: twice the estimate, and what it takes
    to start and to compile. Where the mesh is sought, all the time that it may take.

    time: the step of their plan, if there is one; to find it takes longer.
    """
    if campaign.experiment.is_sought:
        minutes = campaign.experiment.accuracy.minutes
    else:
        minutes = math.ceil(runs / LANES) * LANES * seconds_of_run(campaign, time) / 60.0
    return math.ceil(STARTING + 2.0 * minutes / campaign.jobs.processes)


def job_megabytes(campaign: Campaign) -> int:
    """Memory to ask a queue for, for a job: a program for each process, which holds a group of runs
    as they are written and the next as they are recorded."""
    experiment, jobs = campaign.experiment, campaign.jobs
    run = 8 * experiment.solver.instants * (recorded(experiment) + len(experiment.responses))
    return math.ceil(PROGRAM + jobs.processes * (PROCESS + 2.0 * jobs.group * run / 1e6))


def seconds_of_run(campaign: Campaign, time: TimeStep | None = None) -> float:
    """Seconds of a core that a run takes among others side by side: the config's, or estimated.

    time: as for `job_minutes`.
    """
    from fpm.scenes.effort import machine

    experiment = campaign.experiment
    known = campaign.jobs.run_seconds
    return known or machine() * run_seconds(experiment, time or choose_step(experiment))
