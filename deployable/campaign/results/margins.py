"""By how much runs have their quantities, where that is known: how far beyond a level a response
goes. It is continuous where a quantity comes and goes, and tells where that is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Experiment
from deployable.campaign.results.which import keeps_extremes

_AT_ONCE = 256  # runs


def margins_of(experiment: Experiment, values: np.ndarray) -> np.ndarray:
    """Margins (R, q) of runs from the values (R, n, t) of their responses; NaN where a quantity has
    none. Above 0 where a run has the quantity."""
    names = list(experiment.responses)
    found = np.full((len(values), len(experiment.quantities)), np.nan)
    for q, quantity in enumerate(experiment.numbers):
        if (one := quantity.decider) is not None and len(values):
            found[:, q] = one.margin(values[:, names.index(one.response.name)])
    return found


def margins_of_samples(experiment: Experiment, samples: Any, rows: Sequence[int]) -> np.ndarray:
    """The same of some runs of the open `samples.nc`; NaN where their curves were not kept."""
    if keeps_extremes(samples) or all(q.decider is None for q in experiment.numbers):
        return np.full((len(rows), len(experiment.quantities)), np.nan)
    parts = [rows[first : first + _AT_ONCE] for first in range(0, len(rows), _AT_ONCE)]
    return np.concatenate([margins_of(experiment, samples["values"][part]) for part in parts])
