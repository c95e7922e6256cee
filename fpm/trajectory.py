"""Trajectory files: one netCDF file per run, complete or absent.

Written in the classic format, which is quick for files of this kind (`fpm.classic`); to be read by
any netCDF library, and by `read_curves`. The format has no empty arrays: a run without contact
events has no variables of events, a scene without hinges none of hinges.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fpm import classic

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
_EVENT_COLUMNS = ("time", "contact", "closing")
_COORDINATES = ("time", "point", "axis", "hinge", "contact")


class Contents(NamedTuple):
    """What a trajectory file holds: global attributes, and variables by name."""

    attributes: dict[str, Any]
    variables: dict[str, classic.Variable]


class Curves(NamedTuple):
    """What responses are functions of, as an `fpm.Outcome` has it: time (t,) s; points: name ->
    (position (t, 3) m, velocity (t, 3) m/s); openings: hinge -> (t,) rad; energies: kind -> (t,) J.

    Also events (e, 3): time (s), contact index, 1 if it closes; contacts: names of their hinges.
    """

    time: np.ndarray
    points: dict[str, tuple[np.ndarray, np.ndarray]]
    openings: dict[str, np.ndarray]
    energies: dict[str, np.ndarray]
    events: np.ndarray
    contacts: list[str]


def contents(outcome, responses=(), attributes=None) -> Contents:
    """The trajectory of one outcome (fpm.Outcome) with its responses, CF-style names and units.

    Raises the outcome's failure if there is one.
    """
    import fpm

    if outcome.failure is not None:
        raise outcome.failure
    names = list(outcome.points)
    hinges = list(outcome.openings)
    scene = outcome.scene
    contacts = [scene.hinges[c.hinge].name for c in scene.contacts]
    empty = np.zeros((len(outcome.time), 0, 3))

    def tracks(which: int) -> np.ndarray:
        return np.stack([outcome.points[n][which] for n in names], axis=1) if names else empty

    def variable(dims, values, unit, long_name):
        dims = (dims,) if isinstance(dims, str) else dims
        return classic.Variable(dims, values, {"units": unit, "long_name": long_name})

    def coordinate(name, values, long_name):
        return classic.Variable((name,), np.array(values, dtype=str), {"long_name": long_name})

    vectors = ("time", "point", "axis")
    openings = np.stack([outcome.openings[h] for h in hinges], axis=1) if hinges else empty[..., 0]
    time = {"units": "s", "long_name": "time", "axis": "T"}
    variables = {
        "time": classic.Variable(("time",), outcome.time, time),
        "point": coordinate("point", names, "named point"),
        "axis": coordinate("axis", list("xyz"), "global axis"),
        "hinge": coordinate("hinge", hinges, "hinge"),
        "contact": coordinate("contact", contacts, "its hinge"),
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
        variables[name] = variable("time", outcome.energies[kind], "J", long_name)
    for response in responses:
        values = response.evaluate(outcome)
        variables[response.name] = variable("time", values, response.unit, response.long_name)
    limit = outcome.limit
    known = {
        "Conventions": "CF-1.11",
        "title": f"trajectory of scene {scene.name}",
        "source": f"finite particle method, data version {fpm.DATA_VERSION}",
        "scene": scene.name,
        "responses": " ".join(response.name for response in responses),
        "time_step": outcome.step,
        "steps": outcome.steps,
        "contact_events_dropped": outcome.events_dropped,
    }
    if limit is not None:
        known |= {"time_step_limit": limit.step, "limiting_element": limit.element}
    return Contents({**known, **(attributes or {})}, variables)


def to_dataset(outcome, responses=(), attributes=None) -> "xarray.Dataset":
    """The `contents` of an outcome as an xarray Dataset."""
    import xarray

    attributes, variables = contents(outcome, responses, attributes)
    return xarray.Dataset(
        {name: variable for name, variable in variables.items() if name not in _COORDINATES},
        coords={name: variables[name] for name in _COORDINATES},
        attrs=attributes,
    )


def check_finite(variables: Mapping[str, classic.Variable]) -> None:
    """ValueError that names the first variable with a value that is not finite."""
    for name, variable in variables.items():
        if variable.values.dtype.kind == "f" and not np.isfinite(variable.values).all():
            raise ValueError(f"{name} has values that are not finite; nothing is written")


def write(trajectory: "Contents | xarray.Dataset", path: str | os.PathLike) -> None:
    """Write a trajectory, under a temporary name until it is complete.

    ValueError if any value is not finite; then, and when the write breaks off, no file is left.
    """
    if not isinstance(trajectory, Contents):
        variables = {
            name: classic.Variable(v.dims, v.values, v.attrs)
            for name, v in trajectory.variables.items()
        }
        trajectory = Contents(dict(trajectory.attrs), variables)
    check_finite(trajectory.variables)
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        classic.write(temporary, *trajectory)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def read(path: str | os.PathLike) -> "xarray.Dataset":
    """Read a trajectory into memory."""
    import xarray

    with xarray.open_dataset(path) as dataset:
        return dataset.load()


def read_curves(path: str | os.PathLike) -> Curves:
    """The curves of a trajectory, a hundred times faster than `read`.

    Raises OSError if the file is not there, was cut off, or was not written by `write`.
    """
    _, variables = classic.read(path)

    def names(dimension: str) -> list[str]:
        # What has an empty dimension is not in the file.
        found = variables[dimension].values if dimension in variables else ()
        return [row.tobytes().rstrip(b"\0").decode() for row in found]

    def values(name: str) -> np.ndarray:
        return variables[name].values

    def events() -> np.ndarray:
        names = [f"contact_event_{column}" for column in _EVENT_COLUMNS]
        if names[0] not in variables:
            return np.zeros((0, len(names)))
        return np.stack([values(name) for name in names], axis=1)

    try:
        return Curves(
            time=values("time"),
            points={
                name: (values("position")[:, i], values("velocity")[:, i])
                for i, name in enumerate(names("point"))
            },
            openings={name: values("opening")[:, i] for i, name in enumerate(names("hinge"))},
            energies={kind: values(name) for kind, (name, _) in _ENERGY_NAMES.items()},
            events=events(),
            contacts=names("contact"),
        )
    except KeyError as missing:
        raise OSError(f"{os.fspath(path)} has no variable {missing}") from None
