"""Event margins of runs: by how much they have their quantities."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Experiment


def margins_of_samples(experiment: Experiment, samples: Any, rows: Sequence[int]) -> np.ndarray:
    """Return the event margins (r, q), by how much each run has each quantity, positive if it has
    (`fpm.reading.quantities.Quantity.margin`), of r runs of an open `samples.nc` (`netCDF4.Dataset`
    or `xarray.Dataset`); NaN where not known. rows: indices of the runs, in the order wanted.

    A margin is continuous where a quantity comes and goes in the box, and so locates that border.
    """
    if "margin" not in samples.variables:
        return np.full((len(rows), len(experiment.quantities)), np.nan)
    return np.asarray(samples.variables["margin"][:])[rows]
