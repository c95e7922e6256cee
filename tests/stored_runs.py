"""Runs in a folder of trajectory files, whichever file has them."""

from pathlib import Path

import xarray

from fpm.files.trajectory import Curves, read_curves


def curves_in(folder: Path) -> dict[str, Curves]:
    """Curves of all runs in a folder, by their names."""
    return {run: c for path in folder.glob("*.nc") for run, c in read_curves(path).items()}


def load_run(folder: Path, run: str) -> xarray.Dataset:
    """The trajectory of one run, without the events of the others in its file."""
    for path in folder.glob("*.nc"):
        with xarray.open_dataset(path) as data:
            if run in data.run:
                row = data.run.values.tolist().index(run)
                events = (data.event_run == row).values
                return data.isel(event=events).sel(run=run).drop_vars("event_run").load()
    raise FileNotFoundError(f"{run} in {folder}")
