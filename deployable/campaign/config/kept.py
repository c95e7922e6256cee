"""What `jobs.keep` allows: bounds that follow from what is kept, runs that the disk can hold."""

from __future__ import annotations

import os
from pathlib import Path

from deployable.campaign.config.sections import Campaign

LISTED = 100_000
"""Runs up to which nobody asks whether the disk has room for them."""


def keep_problems(campaign: Campaign) -> list[str]:
    """What of `jobs.keep` does not go with the other keys, as sentences."""
    design, bounds = campaign.experiment.design, campaign.bounds
    if campaign.jobs.keep == "extremes":
        if campaign.experiment.is_sought or design.method != "scan" or design.order is not None:
            return [
                "jobs.keep: 'extremes' is not allowed with a surrogate, which needs every run; "
                "allowed: responses or trajectories, or design method scan without order"
            ]
        if bounds.model != "polynomial":
            return [
                f"jobs.keep: 'extremes' is not allowed with bounds model {bounds.model}, which "
                "needs every run; allowed: responses or trajectories"
            ]
        return []
    return _room_problems(campaign) if design.samples > LISTED and design.method == "scan" else []


def _room_problems(campaign: Campaign) -> list[str]:
    """Whether the disk of the working folder has room for a large scan."""
    from deployable.campaign.plan.estimate import bytes_of_run, size_text

    each, room = bytes_of_run(campaign), _free(Path.cwd())
    samples, keep = campaign.experiment.design.samples, campaign.jobs.keep
    if samples * each <= room:
        return []
    return [
        f"design.samples: {samples} runs with jobs.keep {keep} take about "
        f"{size_text(samples * each)}, and the disk has {size_text(room)}; allowed: at most "
        f"{int(room / each)}, or jobs.keep extremes"
    ]


def _free(folder: Path) -> float:
    """Free bytes on the disk of a folder, for those who are not its administrator."""
    found = os.statvfs(folder)
    return float(found.f_bavail * found.f_frsize)
