"""What the jobs of a campaign ask of a queue, and how many they are."""

import math
import os

from deployable.campaign.config.sections import Campaign, Experiment, corners, count_curves
from deployable.campaign.plan.plan import TimeStep, choose_step
from fpm.scenes import timestep
from fpm.solver.pack import curve_bytes

LANES = 8  # runs that are integrated side by side; fewer take as long

JOB_START = 5.0
"""Minutes of a job beside its runs, at most: starting, and compiling the time loop once."""

PROGRAM, PROCESS = 600.0, 150.0
"""Megabytes of a job with its libraries and while it compiles, and of each process beside it."""


def run_seconds(experiment: Experiment, time: TimeStep) -> float:
    """Estimated core seconds of a run that is one of eight side by side, on the reference core of
    `fpm.scenes.timestep`, so that the rounds of an `accuracy` are the same everywhere."""
    instants, scene = experiment.solver.instants, experiment.nominal_scene
    places = corners(experiment.intervals) if scene.curves else ()
    differs = any(curve_bytes(experiment.build(x)) != curve_bytes(scene) for x in places)
    rows = instants * max(1, experiment.readings(time.step))
    seconds = timestep.run_seconds(scene, time.output_steps * (instants - 1), rows)
    return LANES * seconds if differs else seconds


def runs_in_job(campaign: Campaign) -> int:
    """Return how many runs of a campaign fit a job of `jobs.minutes` (config): whole groups of
    `jobs.group` runs, at least one group for each process."""
    jobs = campaign.jobs
    runs = 60.0 * jobs.minutes * jobs.processes / seconds_of_run(campaign)
    return max(1, jobs.processes, int(runs / jobs.group)) * jobs.group


def job_minutes(campaign: Campaign, runs: int, time: TimeStep | None = None) -> int:
    """Minutes to ask a queue for, for a job of `runs` runs: 5, and twice the estimated core minutes
    (of an `accuracy` its budget) over `jobs.processes`. time: step of the plan; None: chosen."""
    if campaign.experiment.is_adaptive:
        minutes = campaign.experiment.accuracy.max_core_minutes
    else:
        minutes = math.ceil(runs / LANES) * LANES * seconds_of_run(campaign, time) / 60.0
    return math.ceil(JOB_START + 2.0 * minutes / campaign.jobs.processes)


def job_megabytes(campaign: Campaign) -> int:
    """Return the megabytes of memory to ask a queue for, for one job: for the program, and for each
    process its own and three groups of `jobs.group` runs: being simulated, done, and written."""
    experiment, jobs = campaign.experiment, campaign.jobs
    run = 8 * experiment.solver.instants * (count_curves(experiment) + len(experiment.responses))
    return math.ceil(PROGRAM + jobs.processes * (PROCESS + 3.0 * jobs.group * run / 1e6))


def seconds_of_run(campaign: Campaign, time: TimeStep | None = None) -> float:
    """Estimate core seconds of one of eight runs side by side here. time: step; None: chosen."""
    experiment = campaign.experiment
    # Every call of Snakemake needs this, so the corners, with nearly the same step, are skipped.
    time = time or choose_step(experiment, corners=False)
    return timestep.machine() * run_seconds(experiment, time)


CORES = "DEPLOYABLE_INTERVALS_CORES"
"""Environment variable: cores of the machine that started a workflow, which decide batches."""


def batch_count(campaign: Campaign, runs: int) -> int:
    """Return how many batches, one for each job of a workflow, `runs` runs are divided into: each
    of as many as fit `jobs.minutes` of the config, else of `jobs.runs_per_job`. If that is `auto`,
    there is one for each 512 runs, but at most the largest of 8, the number of cores, and one for
    each 4,096 runs up to 64; above the cores, rounded down to a multiple of them."""
    if campaign.jobs.minutes:
        return -(-runs // runs_in_job(campaign))
    if campaign.jobs.runs_per_job != "auto":
        return -(-runs // campaign.jobs.runs_per_job)
    cores = int(os.environ.get(CORES, 0)) or os.cpu_count() or 1
    count = min(-(-runs // 512), max(8, cores, min(-(-runs // 4096), 64)))
    # As many for each core, so that none waits for the last job of another.
    return count - count % cores if count > cores else count
