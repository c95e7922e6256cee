"""From `samples.nc` to `surrogate.nc` and `bounds.nc`, by the `intervals` package.

`surrogate.nc` has the Chebyshev coefficients of every response at every instant:
`multi_index(term, parameter)` and `<response>_coefficient(term, time)`; a scan without order has no
terms. `bounds.nc` is described at `intervals.bounds_dataset`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from campaign.files import whole_file


def analyse(samples_path: str | Path, surrogate_path: str | Path, bounds_path: str | Path) -> None:
    """Fit the design of the samples' own config and write surrogate and bounds."""
    import xarray as xr

    import fpm
    import intervals
    from campaign.nodes import make_design
    from campaign.parameters import intervals_of

    with xr.open_dataset(samples_path) as file:
        samples = file.load()
    config = json.loads(samples.attrs["config"])
    named, _ = intervals_of(config, fpm.scenes.get(config["scene"]["name"]))
    design = make_design(config, named)
    names = samples.attrs["responses"].split()
    bounds = intervals.bounds_dataset(samples, design, names)
    for key in ("lower", "upper", "nominal"):
        bounds[f"parameter_{key}"] = samples[f"parameter_{key}"]
    write_dataset(bounds, bounds_path)
    write_dataset(surrogate_dataset(samples, design, names), surrogate_path)


def surrogate_dataset(samples: Any, design: Any, names: list[str]) -> Any:
    """The fitted coefficients as a dataset (see the module's text)."""
    import xarray as xr

    from intervals import fit
    from intervals.bounds import match_points

    data = {"multi_index": (("term", "parameter"), design.multi_indices)}
    if len(design.multi_indices):
        rows = match_points(design.points, samples["unit"].values)
        for name in names:
            coefficients = fit(design, samples[name].values[rows]).coefficients
            attributes = {
                "units": samples[name].attrs.get("units", ""),
                "long_name": f"Chebyshev coefficients of {samples[name].attrs['long_name']}",
            }
            data[f"{name}_coefficient"] = (("term", "time"), coefficients, attributes)
    coords = {"time": samples["time"], "parameter": samples["parameter"]}
    return xr.Dataset(data, coords=coords, attrs=samples.attrs)


def write_dataset(dataset: Any, path: str | Path) -> None:
    """Write a dataset compressed, whole or not at all."""
    encoding = {
        name: {"zlib": True, "complevel": 1}
        for name, variable in dataset.variables.items()
        if variable.dtype.kind == "f" and variable.ndim
    }
    with whole_file(path) as temporary:
        dataset.to_netcdf(temporary, engine="netcdf4", format="NETCDF4", encoding=encoding)
