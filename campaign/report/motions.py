"""The whole motion of the runs that the page shows: the nominal one, and those at the extremes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray

MOTIONS = "motions"
"""Folder beside the samples, with one netCDF file per run."""

MOST_MOVING = 5


def moving_runs(samples: xarray.Dataset, bounds: xarray.Dataset) -> dict[int, str]:
    """Indices of the runs to be shown, with what they are: the nominal run first.

    Then the runs with the least and the largest value of each response where its bounds differ
    most, at most `MOST_MOVING` in all. A scan without a nominal run begins with its first run.
    """
    roles = samples["role"].values.tolist()
    ids = samples["run_id"].values.tolist()
    first = roles.index("nominal") if "nominal" in roles else 0
    extremes: dict[int, dict[str, list[str]]] = {}
    for i, name in enumerate(samples["response"].values.tolist()):
        widest = int((bounds["upper"].values[i] - bounds["lower"].values[i]).argmax())
        there = samples["values"][:, i, widest].values
        for run, what in ((int(there.argmin()), "least"), (int(there.argmax()), "largest")):
            same = next((r for r in extremes if ids[r] == ids[run]), run)
            extremes.setdefault(same, {}).setdefault(what, []).append(name)
    shown = {first: "nominal run" if "nominal" in roles else "first run"}
    for run, texts in extremes.items():
        if ids[run] != ids[first] and len(shown) < MOST_MOVING:
            parts = [f"{what} {', '.join(names)}" for what, names in texts.items()]
            shown[run] = f"run of {' and '.join(parts)}"
    return shown


def motions_of(samples: xarray.Dataset, runs: Sequence[int], frames: int = 401) -> list:
    """The whole motion of runs of `samples.nc`, an xarray.Dataset each, made again side by side."""
    from campaign.config.sections import Experiment, from_data
    from fpm.motion import whole_motion

    experiment = from_data(Experiment, json.loads(samples.attrs["config"]))
    names = samples["parameter"].values.tolist()
    parameters = [
        experiment.parameters(dict(zip(names, row, strict=True)))
        for row in samples["value"].values[list(runs)].tolist()
    ]
    solver = experiment.solver
    closures = samples["event_time"].values[runs[0]]
    return whole_motion(
        [experiment.scene_type.build(**values) for values in parameters],
        duration=solver.duration,
        instants=solver.instants,
        step=float(samples.attrs["time_step"]),
        energy_tolerance=solver.energy_tolerance,
        frames=frames,
        times=closures[np.isfinite(closures)],
        attributes=[
            {"run_id": str(samples["run_id"].values[run]), "campaign": samples.attrs["campaign"]}
            for run in runs
        ],
    )


def make_motions(folder: str | Path, frames: int = 401) -> list[Path]:
    """Write `motions/<run id>.nc` of the runs that the page of a campaign's folder shows.

    None if they could not be made again as they were, since the structure or the mechanics changed.
    """
    from campaign.config.sections import Experiment, from_data
    from campaign.files import open_dataset
    from campaign.results.bounds import write_dataset

    folder = Path(folder)
    with (
        open_dataset(folder / "samples.nc") as samples,
        open_dataset(folder / "bounds.nc") as bounds,
    ):
        experiment = from_data(Experiment, json.loads(samples.attrs["config"]))
        if experiment.scene_type.digest != samples.attrs["mechanics"]:
            return []
        runs = list(moving_runs(samples, bounds))
        paths = [folder / MOTIONS / f"{samples['run_id'].values[run]}.nc" for run in runs]
        for motion, path in zip(motions_of(samples, runs, frames), paths, strict=True):
            write_dataset(motion, path, "Whole motion of a run")
    return paths
