"""Trajectory files: runs of one batch in one netCDF file, complete or absent, and sealed.

Arrays over time have the dimension `run` first. Energies and what else the kinds in a scene record
have the names that the kinds give them; all others are fixed."""

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fpm.elements import KINDS, energies_of
from fpm.elements.kind import Eventful, Gate
from fpm.files import seals


class NetcdfVariable(NamedTuple):
    """A netCDF variable: dimensions, values, attributes. options: of
    `netCDF4.Dataset.createVariable`, and `kind`, the type in the file, if it is another."""

    dims: tuple[str, ...]
    values: np.ndarray
    attributes: Mapping[str, Any] = {}
    options: Mapping[str, Any] = {}


def write_arrays(
    path: str | os.PathLike, attributes: Mapping[str, Any], variables: Mapping[str, NetcdfVariable]
) -> None:
    """Write a new netCDF-4 file. path: of the file; attributes: global ones by name; variables: by
    name; a dimension is as long as the first variable along it."""
    import netCDF4

    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(attributes)
        for name, (dims, values, attrs, options) in variables.items():
            values = np.asarray(values)
            for dim, size in zip(dims, values.shape, strict=True):
                if dim not in file.dimensions:
                    file.createDimension(dim, size)
            is_text = values.dtype.kind in "OU"
            options = {"kind": str if is_text else values.dtype, **options}
            column = file.createVariable(name, options.pop("kind"), dims, **options)
            column.setncatts(attrs)
            if values.size:
                column[...] = values.astype(object) if is_text else values


if TYPE_CHECKING:
    import xarray

CONVENTIONS = "CF-1.8"
"""Those that files follow as far as they fit: simulated time begins at no date (docs/data.md)."""

_PARAMETER = "parameter_"

LED_OVER = "travel_position"
"""The dimension of what is recorded of travels: positions of an opening moved quasi-statically."""

PEAK, READING = "peak", "reading"
"""Variable of extreme values that were read between instants, too, and its first dimension."""

Column = tuple[str, str]
"""Of what is recorded beside points and energies: a variable, and a label along its dimension."""

POSITION = "position"
"""The variable of columns that stand for points, with their velocities."""

_NO_SIDE = 2.0
"""Side, in a file, of the gate of an element that has none."""

IMPACTS = {"closes": "opens", "hits": "leaves", "latches": "latches"}
"""Events at which velocities change all at once, and those that end what they begin."""


class Energies(dict[str, np.ndarray]):
    """Energies (t,) J of a run by name; zero those of the registry that its scene lacks."""

    def __missing__(self, name: str) -> np.ndarray:
        if name not in {energy.name for energy in energies_of(KINDS)}:
            raise KeyError(name)
        return np.zeros_like(self["kinetic"])


RUN, EVENTS = "run", ("event_time", "event_of", "event_number")
"""The dimension of runs with their names; columns of `Curves.events`, of all runs in a file."""


class Contents(NamedTuple):
    """Contents of a trajectory file to write. attributes (global ones), variables: by name."""

    attributes: dict[str, Any]
    variables: dict[str, NetcdfVariable]


class Impacts(NamedTuple):
    """Impacts of a run, as of closing contacts and latches. events (e, 3): a row for each begin or
    end of an impact, by time: time (s), index into `names`, 1 for begin, 0 for end; names: of all
    elements that can have impacts, of contacts those of their hinges."""

    events: np.ndarray
    names: list[str]


@dataclass(frozen=True)
class Curves:
    """Curves and events of one run, off which responses and quantities are read. time (t,):
    instants (s); points: (position (t, 3) m, velocity (t, 3) m/s) by name; energies: `Energies`;
    columns: further values (t,) by (variable, label); events (e, 3): time (s), index into
    `eventful`, index among that element's `events`; eventful: elements that have events;
    dropped_events: number of events that were not kept; step: time step (s)."""

    time: np.ndarray
    points: dict[str, tuple[np.ndarray, np.ndarray]]
    energies: dict[str, np.ndarray]
    columns: Mapping[Column, np.ndarray]
    events: np.ndarray
    eventful: tuple[Eventful, ...]
    dropped_events: int
    step: float

    @cached_property
    def openings(self) -> dict[str, np.ndarray]:
        """Openings (joint coordinates) (t,) of all hinges by name: rad, of slides m."""
        return {**self.select_columns("opening"), **self.select_columns("slide_opening")}

    def select_columns(self, variable: str) -> dict[str, np.ndarray]:
        """Return the columns (t,) of a recorded variable by label: "cable_tension" by its cable."""
        return {label: x for (name, label), x in self.columns.items() if name == variable}

    def times(self, event: str, elements: Iterable[str]) -> np.ndarray:
        """Return the times (s), increasing, at which any of some elements had an event. event: its
        name, such as "latches"; elements: the elements' names."""
        numbers = [
            e.events.index(event) if event in e.events and e.name in elements else -1
            for e in self.eventful
        ]
        rows = self.events[:, 2] == np.array(numbers)[self.events[:, 1].astype(int)]
        return np.sort(self.events[rows, 0])

    def impacts(self, pairs: Mapping[str, str] = IMPACTS) -> Impacts:
        """Return the impacts of the run, at whose times responses bend or jump. pairs: names of
        events, {what begins an impact: what ends it}; a latch's ends at once."""
        rows: list[tuple[float, int, float]] = []
        names: list[str] = []
        for index, element in enumerate(self.eventful):
            start = next((event for event in element.events if event in pairs), None)
            if start is None:
                continue
            events = self.events[self.events[:, 1] == index]
            for event, flag in ((start, 1.0), (pairs[start], 0.0)):
                times = events[events[:, 2] == element.events.index(event), 0]
                rows += [(time, len(names), flag) for time in times.tolist()]
            names.append(element.name.removeprefix("contact "))
        # In order of time; what begins and ends at once begins first.
        rows.sort(key=lambda row: (row[0], -row[2], row[1]))
        return Impacts(np.array(rows, float).reshape(-1, 3), names)


def contents(outcomes, attributes=None, parameters=None, runs=None, columns=None) -> Contents:
    """Return the contents of a trajectory file of runs of one structure, by the CF conventions.
    outcomes: of the runs, the first failure of which is raised; attributes: further global ones;
    parameters: (value of each run, unit) by name, coordinates `parameter_<name>`; runs: their
    names; columns: (variable, label) of what is to be written, of points as "position"; None:
    all."""
    for outcome in outcomes:
        if outcome.failure is not None:
            raise outcome.failure
    names = map(str, range(len(outcomes))) if runs is None else runs
    variables = {
        **_names(RUN, names, "name of the run"),
        "time": _variable("time", outcomes[0].time, "s", "time", standard_name="time", axis="T"),
        **_points(outcomes, columns),
    }
    for name, variable, words in outcomes[0].energy_kinds:
        values = [outcome.energies[name] for outcome in outcomes]
        variables[variable] = _variable((RUN, "time"), values, "J", words, energy=name)
    variables |= _record_variables(outcomes, columns) | _events(outcomes)
    for name, (read_number, unit, words) in _NUMBERS.items():
        values = [read_number(outcome) for outcome in outcomes]
        if None not in values:
            variables[name] = _variable(RUN, values, unit, words)
    for name, (values, unit) in (parameters or {}).items():
        variables[f"{_PARAMETER}{name}"] = _variable(RUN, values, unit, name)
    # By the last attribute xarray tells coordinates that are no dimensions.
    is_text = {name: v.values.dtype.kind in "UO" for name, v in variables.items()}
    coordinates = [n for n in variables if is_text[n] or n.startswith(_PARAMETER)]
    scene = outcomes[0].scene.name
    header = {
        "Conventions": CONVENTIONS,
        "title": f"trajectories of scene {scene}",
        "source": "finite particle method",
        "history": f"fpm.solver.simulate: {len(outcomes)} runs",
        "scene": scene,
        **(attributes or {}),
        "coordinates": " ".join(n for n in coordinates if variables[n].dims != (n,)),
    }
    return Contents(header, variables)


_NUMBERS: dict[str, tuple[Callable[[Any], Any], str, str]] = {
    "time_step": (lambda o: o.step, "s", "time step"),
    "steps": (lambda o: np.int32(o.steps), "1", "number of time steps"),
    "events_dropped": (lambda o: np.int32(o.dropped_events), "1",
                       "number of events that were not kept"),
    "assembly_energy": (lambda o: o.scene.assembly and o.scene.assembly.energy, "J",
                        "strain energy after the parts were forced together"),
    "assembly_gap": (lambda o: o.scene.assembly and o.scene.assembly.gap, "m",
                     "distance of the points of the joint most open before that"),
    "equilibrium_energy": (lambda o: o.scene.equilibrium and o.scene.equilibrium.energy, "J",
                           "strain energy of the equilibrium at the start"),
    "equilibrium_imbalance": (lambda o: o.scene.equilibrium and o.scene.equilibrium.imbalance, "",
                              "largest force (N) or moment (N m) left in it on a particle"),
    "time_step_limit": (lambda o: o.limit and o.limit.step, "s", "stable time step"),
    "limiting_element": (lambda o: o.limit and o.limit.element, "", "element that limits the step"),
}  # fmt: skip
"""What a file has of each run: a function of its outcome (None: not known), unit, and words."""


def _variable(dims, values, unit, long_name, **extra) -> NetcdfVariable:
    """Make a variable of numbers, without units if `unit` is ""."""
    dims = (dims,) if isinstance(dims, str) else dims
    units = {"units": unit} if unit else {}
    return NetcdfVariable(dims, np.asarray(values), {**units, "long_name": long_name, **extra})


def _names(dimension: str, values, long_name: str, name: str | None = None) -> dict:
    """Text along a dimension: its coordinate, or a variable of another name."""
    text = np.array(list(values), dtype=str)
    return {name or dimension: NetcdfVariable((dimension,), text, {"long_name": long_name})}


def _points(outcomes, columns) -> dict[str, NetcdfVariable]:
    points, dims = outcomes[0].points, (RUN, "time", "point", "axis")
    names = [n for n in points if columns is None or (POSITION, n) in columns]
    if not names:
        return {}
    tracks = np.empty((2, len(outcomes), len(outcomes[0].time), len(names), 3))
    for row, outcome in enumerate(outcomes):
        for i, name in enumerate(names):
            tracks[0, row, :, i], tracks[1, row, :, i] = outcome.points[name]
    return {
        **_names("point", names, "named point"),
        **_names("axis", "xyz", "global axis"),
        "position": _variable(dims, tracks[0], "m", "position of the named points"),
        "velocity": _variable(dims, tracks[1], "m s-1", "velocity of the named points"),
    }


def _record_variables(outcomes, columns) -> dict[str, NetcdfVariable]:
    """Return what kinds recorded, with coordinates, if a label is among the columns."""
    variables = {}
    for name, (_, unit, long_name, dimension, labels, axis) in outcomes[0].records.items():
        if columns is not None and columns.isdisjoint((name, label) for label in labels):
            continue
        dims = (RUN, axis) if dimension is None else (RUN, axis, dimension)
        values = [outcome.records[name].values for outcome in outcomes]
        variables[name] = _variable(dims, values, unit, long_name)
        if dimension is not None:
            variables |= _names(dimension, labels, dimension)
    return variables


def _events(outcomes) -> dict[str, NetcdfVariable]:
    time, element, number = np.concatenate([outcome.events for outcome in outcomes]).T
    element, number = element.astype(np.int32), number.astype(np.int8)
    rows = np.repeat(np.arange(len(outcomes), dtype=np.int32), [len(o.events) for o in outcomes])
    eventful = outcomes[0].eventful
    event_names = (" ".join(e.events) for e in eventful)
    no_gate = (0.0, _NO_SIDE, 0.0, 0.0)
    gate_rows = [e.gate[:4] if e.gate else no_gate for o in outcomes for e in o.eventful]
    gates = np.array(gate_rows).reshape(len(outcomes), -1, 4)
    text = "where it latches, hits, closes: opening, side (2: not known), reach, largest rate"
    return {
        **_names("event_element", (e.name for e in eventful), "element that has events"),
        **_names("event_element", event_names, "events of the element, by number", "event_names"),
        **_names("event_element", (e.joint for e in eventful), "joint it is on", "event_joint"),
        "event_gate": _variable((RUN, "event_element", "gate_number"), gates, "", text),
        "event_time": _variable("event", time, "s", "time of an event"),
        "event_of": _variable("event", element, "1", "index of the event's element"),
        "event_number": _variable("event", number, "1", "number of the event"),
        "event_run": _variable("event", rows, "1", "index of the event's run"),
    }


def to_dataset(outcome) -> "xarray.Dataset":
    """Return one run's trajectory as an xarray.Dataset, without the dimension of runs. outcome:
    whose failure is raised."""
    import xarray

    attributes, variables = contents([outcome])
    coordinates = attributes.pop("coordinates").split(" ")
    data = xarray.Dataset({name: v[:3] for name, v in variables.items()}, attrs=attributes)
    return data.set_coords(coordinates).isel(run=0).drop_vars([RUN, "event_run"])


def write(trajectory: Contents, path: str | os.PathLike, **facts: str) -> None:
    """Write trajectories to a whole, sealed netCDF file at `path`. facts: of its seal, with `name`.
    ValueError if a value is not finite."""
    for name, variable in trajectory.variables.items():
        if variable.values.dtype.kind == "f" and not np.isfinite(variable.values).all():
            raise ValueError(f"{name} has values that are not finite; nothing is written")
    with seals.whole_file(path, {"name": "a trajectory", **facts}) as temporary:
        write_arrays(temporary, *trajectory)


def read(path: str | os.PathLike) -> "xarray.Dataset":
    """Return the trajectories in the file at `path`, in memory, as an xarray.Dataset. Raises
    seals.DamagedError if the file is not as it was written."""
    import xarray

    seals.check(path)
    with xarray.open_dataset(path, engine="netcdf4") as dataset:
        return dataset.load()


def read_curves(
    path: str | os.PathLike, name: str | None = None, runs: Iterable[str] | None = None
) -> dict[str, Curves]:
    """Return curves and events of the runs in a trajectory file, by their names, as views of its
    arrays. name: in its seal, None: anything; runs: those to return, None: all. OSError, or
    seals.DamagedError if it is not as it was written."""
    import netCDF4

    seals.check(path, name)
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        variables = {key: (v.dimensions, v[...], v.__dict__) for key, v in file.variables.items()}
    values = {key: array for key, (_, array, _) in variables.items()}
    labels = [tuple(text.split(" ")) for text in values["event_names"]]
    elements = [*zip(values["event_element"], labels, values["event_joint"], strict=True)]
    events = np.stack([values[key] for key in EVENTS], axis=1)
    energies = [(v[2]["energy"], v[1]) for v in variables.values() if "energy" in v[2]]
    columns = {
        (key, label): array[..., i]
        for key, (dims, array, _) in variables.items()
        if dims[:1] == (RUN,) and dims[1:-1] in (("time",), (LED_OVER,), (READING,))
        for i, label in enumerate(values[dims[-1]].tolist())
    }
    selection = set(values[RUN].tolist() if runs is None else runs)
    curves = {}
    for row, run in enumerate(values[RUN].tolist()):
        if run not in selection:
            continue
        points = {
            point: (values["position"][row, :, i], values["velocity"][row, :, i])
            for i, point in enumerate(values.get("point", ()))
        }
        gates = [None if gate[1] == _NO_SIDE else Gate(*gate)
                 for gate in values["event_gate"][row].tolist()]  # fmt: skip
        curves[run] = Curves(
            time=values["time"],
            points=points,
            energies=Energies((energy, array[row]) for energy, array in energies),
            columns={column: array[row] for column, array in columns.items()},
            events=events[values["event_run"] == row],
            eventful=tuple(Eventful(*e, g) for e, g in zip(elements, gates, strict=True)),
            dropped_events=int(values["events_dropped"][row]),
            step=float(values["time_step"][row]),
        )
    return curves
