"""From `samples.nc` to surrogate, bounds and sensitivities, by the `intervals` package.

`bounds.nc` is described at `intervals.bounds_dataset`, `sensitivities.nc` at
`intervals.sensitivity_dataset`. `surrogate.nc` has the Chebyshev coefficients of every response at
every instant, for each part of the box (one, unless it was split): `part_lower`, `part_upper`
(part, parameter) in unit coordinates, `multi_index(term, parameter)` and
`<response>_coefficient(part, term, time)`. A scan without order has no terms. Surrogate and
sensitivities are the polynomial's, also where the bounds are a spline's.
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
        names = samples.attrs["responses"].split()
        if how["align"] == "none":
            bounds = intervals.bounds_dataset(samples, design, names, model=how["model"])
        else:
            bounds = intervals.event_bounds_dataset(
                samples, design, names, alignment=how["align"], enclose=how["enclose"]
            )
        for key in ("unit", "lower", "upper", "nominal"):
            bounds[f"parameter_{key}"] = samples[f"parameter_{key}"]
        write_dataset(bounds, bounds_path, "Bounds of the responses")
        surrogate = surrogate_dataset(samples, design, names)
        write_dataset(surrogate, surrogate_path, "Surrogates of the responses")
        if design.method == "scan" and made_for["design"]["order"] is None:
            sensitivities = xr.Dataset(attrs={**samples.attrs, "responses": ""})
        else:
            sensitivities = intervals.sensitivity_dataset(samples, design, names)
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


def surrogate_dataset(samples: Any, design: Any, names: list[str]) -> Any:
    """The fitted coefficients as a dataset (see the module's text)."""
    import xarray as xr

    from intervals import fit, match_points
    from intervals.partition import parts_of

    parts = parts_of(design)
    indices = parts[0].design.multi_indices  # all parts have the same
    corner = ("part", "parameter")
    data: dict[str, tuple] = {
        "multi_index": (("term", "parameter"), indices, {"units": "1", "long_name": "degree"}),
        "part_lower": (
            corner,
            [p.lower for p in parts],
            {"units": "1", "long_name": "lower unit coordinate"},
        ),
        "part_upper": (
            corner,
            [p.upper for p in parts],
            {"units": "1", "long_name": "upper unit coordinate"},
        ),
    }
    if len(indices):
        rows = [match_points(part.points, samples["unit"].values) for part in parts]
        for name in names:
            values = samples[name].values
            fitted = [fit(p.design, values[r]) for p, r in zip(parts, rows, strict=True)]
            attributes = {
                "units": samples[name].attrs.get("units", ""),
                "long_name": f"Chebyshev coefficients of {samples[name].attrs['long_name']}",
            }
            coefficients = np.stack([surrogate.coefficients for surrogate in fitted])
            data[f"{name}_coefficient"] = (("part", "term", "time"), coefficients, attributes)
    coords = {"time": samples["time"], "parameter": samples["parameter"]}
    return xr.Dataset(data, coords=coords, attrs=samples.attrs)


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
