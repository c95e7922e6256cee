"""The runs that surrogates of quantities are fitted to, as a campaign's results have them."""

import json
from typing import Any, NamedTuple

import numpy as np

from deployable.campaign.files import open_netcdf
from deployable.campaign.folder import Folder
from deployable.intervals.scalars import fit_scalar

MAX_FIT_RUNS = 10_000
"""Runs up to which surrogates of quantities are fitted to all of them."""

_MAX_FITTED_RUNS = 4_000  # of more runs


def fitted_rows(numbers: np.ndarray) -> np.ndarray:
    """Choose the runs that surrogates of quantities are fitted to: increasing indices. numbers (R,
    q): quantities of all runs, NaN for one that does not occur. Of up to 10,000 runs
    (`MAX_FIT_RUNS`) all are chosen; of more the first 4000, which fill the box of parameters, and
    for each quantity the runs with its least and largest value and the first without it."""
    if len(numbers) <= MAX_FIT_RUNS:
        return np.arange(len(numbers))
    rows = set(range(_MAX_FITTED_RUNS))
    for column in numbers.T:
        mask = np.isfinite(column)
        if mask.any():
            rows |= {int(np.nanargmin(column)), int(np.nanargmax(column))}
        if not mask.all():
            rows.add(int(np.argmin(mask)))
    return np.array(sorted(rows))


class FittedRuns(NamedTuple):
    """The R runs that surrogates (fitted functions) of quantities rest on: `points` (R, k),
    parameters scaled to -1 to 1; `numbers` (R, q), quantities, NaN for one that does not occur;
    `margins` (R, q), event margins, above 0 where the run has the quantity, NaN where not known.
    They are continuous where a quantity comes and goes in the box, and so locate that border. rest
    (S, q): quantities of the other runs of a large scan; refinement_count: how many of the R runs,
    the last ones, the search for bounds added."""

    points: np.ndarray
    numbers: np.ndarray
    margins: np.ndarray
    rest: np.ndarray = np.zeros((0, 0))
    refinement_count: int = 0

    @classmethod
    def read(cls, folder: Folder, refinements: bool = True) -> "FittedRuns":
        """Read the runs from a campaign's folder: those of `samples.nc` (of a large scan those that
        `fitted_rows` chooses) and, with `refinements`, of the search for bounds, in
        `refinement.nc`, which must exist."""
        with open_netcdf(folder.samples) as file:
            points = file["normalized"][:]
            has_numbers = "quantities" in file.variables
            numbers = file["quantities"][:] if has_numbers else np.zeros((len(points), 0))
            margins = file["margin"][:] if "margin" in file.variables else np.nan * numbers
        rows = fitted_rows(numbers)
        parts, rest = (
            [(points[rows], numbers[rows], margins[rows])],
            np.delete(numbers, rows, axis=0),
        )
        if refinements:
            with open_netcdf(folder.refinement) as file:
                names = ("normalized", "quantities", "margin")
                parts.append(tuple(file[name][:] for name in names))
        arrays = map(np.concatenate, zip(*parts, strict=True))
        return cls(*arrays, rest, sum(len(part[0]) for part in parts[1:]))

    def surrogate(self, data: Any, q: int) -> Any:
        """Fit the surrogate of quantity `q` (index) to these runs again, as for the results:
        returns a `ScalarSurrogate`. data: the open `quantities.nc`, whose settings are read."""
        end = json.loads(data.config)["solver"]["duration"]
        least = float(data["least"][q])
        latest = end if data["is_time"][q] else None
        least = least if np.isfinite(least) else None
        return fit_scalar(self.points, self.numbers[:, q], latest, least, self.margins[:, q])
