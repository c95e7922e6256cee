"""What a campaign will take, before it runs: runs, time, disk, and what its jobs ask of a queue."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

import fpm
from deployable.campaign.config.sections import Campaign, Experiment, count_runs
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import TimeStep, choose_step, make_plan
from deployable.campaign.runs.extremes import LARGE, MOST
from deployable.campaign.runs.progress import duration_text
from deployable.campaign.runs.store import open_store
from fpm.reading.variables import words
from fpm.scenes import effort

LANES = 8
"""Runs that are integrated side by side; fewer take as long."""

STARTING, RESPONSE, QUANTITY = 4.0, 1.0, 0.6
"""Seconds to start and write the page, and to take the bounds of a response or the interval of a
quantity, and draw it."""

REQUIRING, CHOOSING = 2.0, 7.0
"""Seconds to find what of the box meets requirements, and the best choice, by surrogate."""

MOVING = 3
"""Batches of runs that are made again for the page, on which they move."""

WRITING = 5e-3
"""Seconds for a run's scene and file."""

ROUNDS = 2
"""Rounds of further runs that quantities take as a rule, where so many are allowed."""

JOB_STARTING = 5.0
"""Minutes of a job beside its runs, at most: starting, and compiling the time loop once."""

PROGRAM, PROCESS = 600.0, 150.0
"""Megabytes of a job with its libraries and while it compiles, and of each process beside it."""

_OTHER_CURVES = 10  # of a trajectory, beside points and hinges: time, gaps, energies
_BOUNDS_CURVES = 12  # of a response in bounds, surrogate and sensitivities, compressed
_SHARE_CURVES = 4  # of a response in the file of a share of a scan
_EVENTS_BYTES = 40  # of a run's impacts, compressed: some ten


@dataclass(frozen=True)
class Estimate:
    """runs: at most, but for those that answers take; seconds on all cores of this machine, of
    which `compiling` takes some if the time loop is not compiled yet; integrating: seconds of a
    core of it that the runs take, those of answers too; bytes on disk.

    is_budget: they are what may be spent, mostly far more than what will be. answers: what takes
    further runs, in words.
    """

    runs: int
    seconds: float
    integrating: float
    bytes: float
    compiling: float = 0.0
    is_budget: bool = False
    answers: str = ""

    def __str__(self) -> str:
        about = "at most" if self.is_budget else "about"
        further = f" and further ones for {self.answers}" if self.answers else ""
        first = duration_text(_rounded(self.compiling))
        return (
            f"at most {self.runs} runs{further}, {about} {duration_text(_rounded(self.seconds))} "
            f"on {cores()} cores{f' ({first} of it to compile, once)' if self.compiling else ''}, "
            f"{size_text(self.bytes)} on disk"
        )


def estimate(campaign: Campaign) -> Estimate:
    """What a campaign takes in one call, with its page; time is right to a factor of 1.5 where
    little is left to chance, and of two or so where runs are most of it (`fpm.scenes.effort`)."""
    experiment, solver = campaign.experiment, campaign.experiment.solver
    runs = count_runs(experiment)
    batch = LANES * effort.machine() * run_seconds(experiment, choose_step(experiment))
    further = {} if experiment.is_sought else _further(campaign)
    rounds = [(runs, 1.0), *(one for some in further.values() for one in some)]
    batches = [(math.ceil(count / LANES), factor) for count, factor in rounds if count]
    integrating = batch * sum(number * factor for number, factor in batches)
    # A batch is one core's; rounds wait for each other.
    waiting = batch * sum(math.ceil(number / cores()) * factor for number, factor in batches)
    writing = WRITING * sum(count for count, _ in rounds) / cores()
    scene = experiment.nominal_scene
    compiling = 0.0 if fpm.is_compiled(scene) else effort.compile_seconds(scene)
    starting = STARTING + compiling + MOVING * batch
    starting += RESPONSE * len(experiment.responses) + QUANTITY * len(experiment.quantities)
    starting += REQUIRING * bool(campaign.requirements) + CHOOSING * bool(
        campaign.choose.parameters
    )
    seconds = waiting + writing + starting
    if experiment.is_sought:  # meshes and steps become finer
        integrating = 60 * experiment.accuracy.minutes
        seconds = integrating / cores() + starting
    curves = _BOUNDS_CURVES * len(experiment.responses)
    if campaign.jobs.keep == "extremes":
        curves += _SHARE_CURVES * min(MOST, math.ceil(runs / LARGE)) * len(experiment.responses)
    size = runs * bytes_of_run(campaign) + 8 * solver.instants * curves
    answers = " and ".join(further)
    return Estimate(
        runs, seconds, integrating, float(size), compiling, experiment.is_sought, answers
    )


def _further(campaign: Campaign) -> dict[str, list[tuple[int, float]]]:
    """Further runs by what takes them, in words: for each round how many, and how many times as
    long as a planned one each of them takes."""
    experiment, verify = campaign.experiment, campaign.verify
    ends = 2 * len(experiment.quantities)
    rounds = min(ROUNDS, verify.rounds)
    found: dict[str, list[tuple[int, float]]] = {}
    if ends:
        found["quantities"] = [(ends, 1.0)] * rounds
    if campaign.choose.parameters:
        from deployable.campaign.answers.choice import design_points, widened

        points = design_points(widened(experiment, campaign.choose), campaign.choose)
        found["the choice"] = [(len(points), 1.0), *[(LANES, 1.0)] * rounds]
    if verify.finer:
        from deployable.campaign.answers.finer import PLACES

        # Half the step, and a mesh of twice as many elements with half the step; for their orders
        # at fewer places a quarter of the step, and half as many elements with half the step.
        again = [(PLACES, 1), *([(ends, ends // 2)] if ends else [])]
        found["errors of step and mesh"] = [
            (places, factor)
            for most, few in again
            for places, factor in ((most, 2.0), (few, 4.0), (most, 4.0), (few, 1.0))
        ]
    return found


def bytes_of_run(campaign: Campaign) -> float:
    """Bytes that a run takes on disk, about, in its own file and in samples.nc."""
    experiment = campaign.experiment
    instants, responses = experiment.solver.instants, len(experiment.responses)
    if campaign.jobs.keep == "extremes":
        numbers = 2 * len(experiment.quantities) + 2 * len(experiment.intervals)
        return 8.0 * numbers + 2 * _EVENTS_BYTES
    if campaign.jobs.keep == "responses":
        return 8.0 * instants * responses
    return 8.0 * instants * (recorded(experiment) + responses)


def runs_there(campaign: Campaign, folder: Folder) -> str:
    """Which of a campaign's runs are there, and why others must be made again; nothing where none
    is there, and for an `accuracy`, whose runs are not known beforehand."""
    keep = campaign.jobs.keep
    if campaign.experiment.is_sought or not folder.runs(keep).is_dir():
        return ""
    plan = make_plan(campaign.experiment)
    store = open_store(keep, folder.runs(keep), campaign.experiment)
    groups = store.groups(plan.unique_runs(), campaign.jobs.group)
    missing = sum(len(store.missing(group)) for group in groups)
    total, lacking = sum(map(len, groups)), len(store.lacking)
    if missing - lacking == total:
        return ""
    text = f"{total - missing} of them are there"
    if lacking:
        what = words(sorted(set().union(*store.lacking.values())))
        seconds = _rounded(estimate(campaign).seconds * missing / total)
        text += (
            f"; {lacking} more lack {what} as this version reads it and are simulated again, all "
            f"in all about {duration_text(seconds)}"
        )
    return text


def run_seconds(experiment: Experiment, time: TimeStep) -> float:
    """Seconds of a core for a run, one of eight side by side.

    Of a core as `fpm.scenes.effort` has them, whichever this one is: what rounds may spend depends
    on it.
    """
    instants = experiment.solver.instants
    return effort.run_seconds(
        experiment.nominal_scene, time.steps_per_instant * (instants - 1), instants
    )


def recorded(experiment: Experiment) -> int:
    """Curves of a trajectory, but for the responses."""
    scene = experiment.nominal_scene
    return 6 * len(scene.points) + len(scene.hinges) + _OTHER_CURVES + len(experiment.record)


def cores() -> int:
    """Cores of this machine."""
    return os.cpu_count() or 1


def size_text(size: float) -> str:
    """A number of bytes as people write it: `5.5 MB`."""
    for unit in ("kB", "MB"):
        size /= 1000
        if size < 1000:
            return f"{size:.2g} {unit}" if size < 10 else f"{size:.0f} {unit}"
    return f"{size / 1000:.3g} GB"


def _rounded(seconds: float) -> float:
    """To two digits."""
    power = 10.0 ** (math.floor(math.log10(max(seconds, 1.0))) - 1)
    return max(1.0, round(seconds / power) * power)


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
    return math.ceil(JOB_STARTING + 2.0 * minutes / campaign.jobs.processes)


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
    experiment = campaign.experiment
    known = campaign.jobs.run_seconds
    return known or effort.machine() * run_seconds(experiment, time or choose_step(experiment))


CORES = "DEPLOYABLE_INTERVALS_CORES"
"""Environment variable with the cores of the machine on which a workflow was started: jobs on other
machines must find as many batches."""


def batch_count(campaign: Campaign, runs: int) -> int:
    """Number of batches that runs are shared among."""
    if campaign.jobs.minutes:
        return -(-runs // runs_in_job(campaign))
    if campaign.jobs.nodes_per_job != "auto":
        return -(-runs // campaign.jobs.nodes_per_job)
    cores = int(os.environ.get(CORES, 0)) or os.cpu_count() or 1
    count = min(-(-runs // 512), max(8, cores, min(-(-runs // 4096), 64)))
    # As many for each core, so that none waits for the last job of another.
    return count - count % cores if count > cores else count
