"""The whole motion of the runs that the page shows: the nominal one, and those at the extremes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from campaign.results.which import ids, keeps_extremes, nominal_row
from fpm.sealed import DamagedError

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
    nominal = nominal_row(samples)
    first = nominal or 0
    values = samples["value"].values  # runs with the same are the same
    extremes: dict[int, dict[str, list[str]]] = {}
    for i, name in enumerate(samples["response"].values.tolist()):
        widest = int((bounds["upper"].values[i] - bounds["lower"].values[i]).argmax())
        for run, what in zip(_extreme_runs(samples, i, widest), ("least", "largest"), strict=True):
            same = next((r for r in extremes if (values[r] == values[run]).all()), run)
            extremes.setdefault(same, {}).setdefault(what, []).append(name)
    shown = {first: "first run" if nominal is None else "nominal run"}
    for run, texts in extremes.items():
        if (values[run] != values[first]).any() and len(shown) < MOST_MOVING:
            parts = [f"{what} {', '.join(names)}" for what, names in texts.items()]
            shown[run] = f"run of {' and '.join(parts)}"
    return shown


def _extreme_runs(samples: xarray.Dataset, response: int, instant: int) -> tuple[int, int]:
    """The runs with the least and the largest value of a response at an instant."""
    if keeps_extremes(samples):
        low, high, low_run, high_run = (
            samples[name][:, response, instant].values
            for name in ("lower", "upper", "lower_run", "upper_run")
        )
        there = np.flatnonzero(low_run >= 0)
        return int(low_run[there[low[there].argmin()]]), int(high_run[there[high[there].argmax()]])
    values = samples["values"][:, response, instant].values
    return int(values.argmin()), int(values.argmax())


def motions_of(samples: xarray.Dataset, runs: Sequence[int], frames: int = 401) -> list:
    """The whole motion of runs of `samples.nc`, an xarray.Dataset each, made again side by side.

    Where samples have no curves of runs, it has them: ``curves`` (response, instant).
    """
    import fpm
    from campaign.config.sections import Experiment, from_data
    from fpm.motion import whole_motion

    experiment = from_data(Experiment, json.loads(samples.attrs["config"]))
    names = samples["parameter"].values.tolist()
    scenes = [
        experiment.build(dict(zip(names, row, strict=True)))
        for row in samples["value"].values[list(runs)].tolist()
    ]
    solver = experiment.solver
    how = {
        "duration": solver.duration,
        "instants": solver.instants,
        "step": float(samples.attrs["time_step"]),
        "energy_tolerance": solver.energy_tolerance,
    }
    closures = samples["event_time"].values[runs[0]]
    motions = whole_motion(
        scenes,
        **how,
        frames=frames,
        times=closures[np.isfinite(closures)],
        attributes=[
            {"run_id": name, "campaign": samples.attrs["campaign"]} for name in ids(samples, runs)
        ],
    )
    if not keeps_extremes(samples):
        return motions
    curves = [
        np.array([response.evaluate(outcome) for response in experiment.curves])
        for outcome in fpm.simulate(scenes, **how, record=experiment.asked)
    ]
    return [
        motion.assign(curves=(("response", "instant"), own, {"long_name": "value of the response"}))
        for motion, own in zip(motions, curves, strict=True)
    ]


def motion_of(folder: str | Path, row: int) -> xarray.Dataset:
    """The whole motion of the run at a place among the samples: the one that is there, or else made
    again."""
    from campaign.files import open_dataset

    folder = Path(folder)
    with open_dataset(folder / "samples.nc") as samples:
        (name,) = ids(samples, [row])
        with (
            suppress(FileNotFoundError, DamagedError),
            open_dataset(folder / MOTIONS / f"{name}.nc") as motion,
        ):
            return motion.load()
        return motions_of(samples, [row])[0]


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
        paths = [folder / MOTIONS / f"{name}.nc" for name in ids(samples, runs)]
        for motion, path in zip(motions_of(samples, runs, frames), paths, strict=True):
            write_dataset(motion, path, "Whole motion of a run")
    return paths
