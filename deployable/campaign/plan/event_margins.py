"""Event margins of runs: by how much they have their quantities, from the curves of responses."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Experiment

_BLOCK = 256  # runs


def margins_of(experiment: Experiment, values: np.ndarray) -> np.ndarray:
    """Compute event margins (R, q): by how much each of R runs has, or misses, each of q
    quantities, positive if the quantity exists; NaN for a quantity on which no response decides.
    values (R, n, T): the n responses of the experiment at T instants.

    A margin is in the unit of the response that decides. For the nth crossing of a level it is the
    least distance beyond the level that the response reaches, on each side of it in turn; for
    settling, the distance of the response, at the last instant, to the edge of its band. It is
    continuous where a quantity comes and goes in the box, and so locates that border."""
    names = list(experiment.responses)
    margins = np.full((len(values), len(experiment.quantities)), np.nan)
    for q, quantity in enumerate(experiment.quantity_list):
        if (source := quantity.margin_source) is not None and len(values):
            margins[:, q] = source.margin(values[:, names.index(source.response.name)])
    return margins


def margins_of_samples(experiment: Experiment, samples: Any, rows: Sequence[int]) -> np.ndarray:
    """Compute event margins (r, q), by how much each run has each quantity (`margins_of`), of r
    runs of an open `samples.nc` (`netCDF4.Dataset` or `xarray.Dataset`); NaN if it holds no curves
    of them. rows: indices of the runs, in the order wanted."""
    has_source = any(q.margin_source is not None for q in experiment.quantity_list)
    if "values" not in samples.variables or not has_source:
        return np.full((len(rows), len(experiment.quantities)), np.nan)
    parts = [rows[first : first + _BLOCK] for first in range(0, len(rows), _BLOCK)]
    values = samples.variables["values"]
    return np.concatenate([margins_of(experiment, np.asarray(values[part])) for part in parts])
