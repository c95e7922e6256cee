"""What the runs of a campaign take on disk, and whether that has room."""

import shutil
from pathlib import Path

from deployable.campaign.config.sections import Campaign, Experiment
from deployable.campaign.text.numbers import size_text

LARGE = 100_000  # runs up to which nobody asks whether the disk has room for them


_TRAJECTORY_CURVES = 10  # of a trajectory, beside points and hinges: time, gaps, energies
_EVENTS_BYTES = 40  # of a run's impacts, compressed: some ten


def bytes_of_run(campaign: Campaign) -> float:
    """Estimate the bytes on disk of one run: in the store (by `jobs.keep`) and `samples.nc`."""
    experiment = campaign.experiment
    instants, responses = experiment.solver.instants, len(experiment.responses)
    if campaign.jobs.keep == "extremes":
        numbers = 2 * len(experiment.quantities) + 2 * len(experiment.intervals)
        return 8.0 * numbers + 2 * _EVENTS_BYTES
    if campaign.jobs.keep == "responses":
        return 8.0 * instants * responses
    return 8.0 * instants * (count_curves(experiment) + responses)


def count_curves(experiment: Experiment) -> int:
    """Return how many arrays over time the trajectory file of a run has, besides responses."""
    scene = experiment.nominal_scene
    return 6 * len(scene.points) + len(scene.hinges) + _TRAJECTORY_CURVES + len(experiment.record)


def room_problems(campaign: Campaign) -> list[str]:
    """Check that the disk has room for the runs of a campaign's `sobol` design."""
    run_bytes, room = bytes_of_run(campaign), shutil.disk_usage(Path.cwd()).free
    samples, keep = campaign.experiment.design.samples, campaign.jobs.keep
    if samples * run_bytes <= room:
        return []
    return [
        f"design.samples: {samples} runs with jobs.keep {keep} take about "
        f"{size_text(samples * run_bytes)}, and the disk has {size_text(room)}; allowed: at most "
        f"{int(room / run_bytes)}, or jobs.keep extremes"
    ]
