"""From `samples.nc` to surrogate, bounds and sensitivities, by the `intervals` package.

The files are described at `intervals.bounds_dataset`, `intervals.surrogate_dataset` and
`intervals.sensitivity_dataset`; all have the coordinates `response`, `response_units`,
`response_long_name`, and of the box `parameter`, `box_lower`, `box_upper`, `box_nominal`,
`box_units`. Surrogate and sensitivities are the polynomial's, also where the bounds are a spline's.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from campaign.files import whole_file


def analyse(
    samples_path: str | Path,
    config: Mapping,
    surrogate_path: str | Path,
    bounds_path: str | Path,
    sensitivities_path: str | Path,
) -> None:
    """Fit the design that the samples were made for; write surrogate, bounds and sensitivities.

    `config` has the section `bounds`. Samples of a scan are read in pieces, so that they may be
    larger than memory.
    """
    import xarray as xr

    import intervals

    how = config["bounds"]
    with xr.open_dataset(samples_path) as samples:
        made_for = json.loads(samples.attrs["config"])
        design = _design(samples, made_for)
        options = {"model": how["model"]}
        if how["align"] != "none":
            options = {"model": "aligned", "alignment": how["align"], "enclose": how["enclose"]}
        bounds = intervals.bounds_dataset(samples, design, **options)
        write_dataset(bounds, bounds_path, "Bounds of the responses")
        surrogate = intervals.surrogate_dataset(samples, design)
        write_dataset(surrogate, surrogate_path, "Surrogates of the responses")
        if design.method == "scan" and made_for["design"]["order"] is None:
            sensitivities = xr.Dataset(attrs=samples.attrs)
        else:
            sensitivities = intervals.sensitivity_dataset(samples, design)
        write_dataset(sensitivities, sensitivities_path, "Influence of each parameter")


def _design(samples: Any, made_for: Mapping) -> Any:
    """The design of a config whose samples these are."""
    import fpm
    import intervals
    from campaign.nodes import make_design
    from campaign.parameters import intervals_of

    if made_for["design"]["method"] == "scan" and made_for["design"]["order"] is None:
        # To make it again would take longer than its bounds: sequences are slow to import.
        points = samples["unit"].values[samples["role"].values == "node"]
        none = (0,) * points.shape[1]
        return intervals.Design(points, np.zeros((0, len(none)), dtype=int), "scan", none)
    named, _ = intervals_of(made_for, fpm.scenes.get(made_for["scene"]["name"]))
    return make_design(made_for, named)


def write_dataset(dataset: Any, path: str | Path, title: str) -> None:
    """Write a dataset compressed, whole or not at all; `title` says what it holds."""
    titled = f"{title}, campaign {dataset.attrs['campaign']}"
    dataset = dataset.assign_attrs(title=titled)
    encoding = {
        name: {"zlib": True, "complevel": 1}
        for name, variable in dataset.variables.items()
        if variable.dtype.kind == "f" and variable.ndim
    }
    with whole_file(path) as temporary:
        dataset.to_netcdf(temporary, engine="netcdf4", format="NETCDF4", encoding=encoding)
