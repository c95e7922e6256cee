"""What a round of runs has shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..designs import Design, SplitDesign
from ..estimates import direction_tails
from ..models import PolynomialModel
from ..samples import read_samples

if TYPE_CHECKING:
    import xarray as xr


def measure_round(
    samples: xr.Dataset, bounds: xr.Dataset, design: Design | SplitDesign
) -> tuple[float, list[float]]:
    """What `decide` needs of a round: `error` and `tails` of `Progress`, in the worst response.

    `bounds` are those that `bounds_dataset` makes of `samples` and `design`.
    """
    data = read_samples(samples)
    error = float(bounds["error_share_of_width"].max())
    areas = np.trapezoid((bounds["upper"] - bounds["lower"]).values, data.time)
    tails = np.zeros(design.dimension)
    for surrogate in PolynomialModel(data, design).surrogates:
        tail = np.trapezoid(direction_tails(surrogate), data.time)
        tails = np.maximum(tails, (tail / np.where(areas > 0, areas, 1.0)).max(axis=1))
    return error, tails.tolist()
