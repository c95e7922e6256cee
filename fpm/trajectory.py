"""Trajectory files: one netCDF-4 file per run, complete or absent."""

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray

_ENERGY_NAMES = {
    "kinetic": ("kinetic_energy", "kinetic energy"),
    "strain": ("strain_energy", "strain energy of the beam elements"),
    "spring": ("spring_energy", "energy of the torsion springs"),
    "contact": ("contact_energy", "energy of the face-to-face contacts"),
    "load_work": ("load_work", "work of loads, weight and drives"),
    "damping_work": ("damping_work", "energy taken out by damping"),
    "balance": ("energy_balance", "energy that came from nowhere since the start"),
}


def to_dataset(outcome, responses=(), attributes=None) -> "xarray.Dataset":
    """The trajectory of one outcome (fpm.Outcome) with its responses, CF-style names and units."""
    import xarray

    import fpm

    names = list(outcome.points)
    hinges = list(outcome.openings)
    scene = outcome.scene
    contacts = [scene.hinges[c.hinge].name for c in scene.contacts]
    empty = np.zeros((len(outcome.time), 0, 3))

    def tracks(which: int) -> np.ndarray:
        return np.stack([outcome.points[n][which] for n in names], axis=1) if names else empty

    def variable(dims, values, unit, long_name, **more):
        return (dims, values, {"units": unit, "long_name": long_name, **more})

    vectors = ("time", "point", "axis")
    openings = np.stack([outcome.openings[h] for h in hinges], axis=1) if hinges else empty[..., 0]
    data = {
        "position": variable(vectors, tracks(0), "m", "position of the named points"),
        "velocity": variable(vectors, tracks(1), "m s-1", "velocity of the named points"),
        "opening": variable(("time", "hinge"), openings, "rad", "opening of the hinges"),
        "hinge_gap": variable("time", outcome.gap, "m", "largest gap between hinge points"),
        "hinge_axis_gap": variable(
            "time", outcome.axis_gap, "rad", "largest angle between hinge axes"
        ),
        "contact_event_time": variable(
            "event", outcome.events[:, 0], "s", "time at which a contact closes or opens"
        ),
        "contact_event_contact": variable(
            "event", outcome.events[:, 1].astype(np.int32), "1", "index of the contact"
        ),
        "contact_event_closing": variable(
            "event", outcome.events[:, 2].astype(np.int8), "1", "1: closes, 0: opens"
        ),
    }
    for kind, (name, long_name) in _ENERGY_NAMES.items():
        data[name] = variable("time", outcome.energies[kind], "J", long_name)
    for response in responses:
        values = response.evaluate(outcome)
        data[response.name] = variable("time", values, response.unit, response.long_name)
    limit = outcome.limit
    return xarray.Dataset(
        data,
        coords={
            "time": ("time", outcome.time, {"units": "s", "long_name": "time", "axis": "T"}),
            "point": ("point", np.array(names, dtype=str), {"long_name": "named point"}),
            "axis": ("axis", np.array(list("xyz")), {"long_name": "global axis"}),
            "hinge": ("hinge", np.array(hinges, dtype=str), {"long_name": "hinge"}),
            "contact": ("contact", np.array(contacts, dtype=str), {"long_name": "its hinge"}),
        },
        attrs={
            "Conventions": "CF-1.11",
            "title": f"trajectory of scene {scene.name}",
            "source": f"finite particle method, data version {fpm.DATA_VERSION}",
            "scene": scene.name,
            "responses": " ".join(response.name for response in responses),
            "time_step": outcome.step,
            "steps": outcome.steps,
            "contact_events_dropped": outcome.events_dropped,
            **({} if limit is None else {
                "time_step_limit": limit.step,
                "limiting_element": limit.element,
            }),
            **(attributes or {}),
        },
    )  # fmt: skip


def check_finite(dataset: "xarray.Dataset") -> None:
    """ValueError that names the first variable with a value that is not finite."""
    for name, variable in dataset.data_vars.items():
        if variable.dtype.kind == "f" and not np.isfinite(variable.values).all():
            raise ValueError(f"{name} has values that are not finite; nothing is written")


def write(dataset: "xarray.Dataset", path: str | os.PathLike) -> None:
    """Write a trajectory, under a temporary name until it is complete.

    ValueError if any value is not finite; then, and when the write breaks off, no file is left.
    """
    check_finite(dataset)
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        write_netcdf(dataset, temporary)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def write_netcdf(dataset: "xarray.Dataset", path: Path) -> None:
    """Plain netCDF-4 through the netCDF4 library: a quarter of the time that to_netcdf takes.

    Names are fixed-width characters, which are quicker than strings of variable length.
    """
    import netCDF4

    with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
        file.setncatts(dataset.attrs)
        for name, size in dataset.sizes.items():
            file.createDimension(name, size)
        for name, variable in dataset.variables.items():
            values, dims, kind, attributes = variable.values, variable.dims, variable.dtype, {}
            if kind.kind == "U":
                width = max(1, kind.itemsize // 4)
                file.createDimension(f"{name}_width", width)
                dims, kind, attributes = (*dims, f"{name}_width"), "S1", {"_Encoding": "utf-8"}
                values = netCDF4.stringtochar(np.char.encode(values, "utf-8").astype(f"S{width}"))
            target = file.createVariable(name, kind, dims, fill_value=False)
            target.setncatts({**variable.attrs, **attributes})
            target.set_auto_chartostring(False)
            if values.size:
                target[:] = values


def read(path: str | os.PathLike) -> "xarray.Dataset":
    """Read a trajectory into memory."""
    import xarray

    with xarray.open_dataset(path) as dataset:
        return dataset.load()
