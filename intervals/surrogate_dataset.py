"""The surrogates of a samples dataset as a dataset of their own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .datasets import match_points, read_samples
from .designs import Design
from .partition import SplitDesign, parts_of
from .surrogate import fit

if TYPE_CHECKING:
    import xarray as xr


def surrogate_dataset(
    samples: xr.Dataset, design: Design | SplitDesign, responses: Sequence[str] | None = None
) -> xr.Dataset:
    """The Chebyshev coefficients of every response at every instant, for each part of the box.

    ``coefficient`` (response, part, term, time) in the response's units, ``multi_index`` (term,
    parameter), ``part_lower`` and ``part_upper`` (part, parameter) in unit coordinates; there is
    one part unless the design is split. A scan without order has no terms and no coefficients.
    """
    import xarray as xr

    data = read_samples(samples, responses, values=False)
    parts = parts_of(design)
    indices = parts[0].design.multi_indices  # all parts have the same
    corner = ("part", "parameter")
    variables: dict[str, tuple] = {
        "multi_index": (("term", "parameter"), indices, {"units": "1", "long_name": "degree"}),
    }
    for side in ("lower", "upper"):
        attributes = {"units": "1", "long_name": f"{side} unit coordinate"}
        variables[f"part_{side}"] = (corner, [getattr(p, side) for p in parts], attributes)
    if len(indices):
        rows = [match_points(part.points, data.unit) for part in parts]
        values = samples["values"].values
        found = [
            [fit(p.design, values[r, i]).coefficients for p, r in zip(parts, rows, strict=True)]
            for i in data.rows
        ]
        axes = ("response", "part", "term", "time")
        variables["coefficient"] = (axes, np.array(found), {"long_name": "Chebyshev coefficients"})
    return xr.Dataset(variables, coords=data.coordinates(), attrs=samples.attrs)
