"""Trajectory files: one netCDF file per run, complete or absent, and sealed (`fpm.files.seals`).

Written in the classic format (`fpm.files.classic`), read by any netCDF library and `read_curves`.
The format has no empty arrays: a run without events has no variables of events. Energies and what
else the kinds in a scene record have the names that the kinds give them; all others are fixed."""

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fpm.elements import KINDS, energies_of
from fpm.elements.cross import columns as stack_columns
from fpm.elements.kind import Eventful, Gate
from fpm.files import classic, seals

if TYPE_CHECKING:
    import xarray

CONVENTIONS = "CF-1.8"
"""Those that files follow as far as they fit: simulated time begins at no date (docs/data.md)."""

_PARAMETER = "parameter_"

LED_OVER = "travel_position"
"""The dimension of what is recorded of travels: positions of an opening moved quasi-statically."""

Column = tuple[str, str]
"""Of what is recorded beside points and energies: a variable, and a label along its dimension."""

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


class Contents(NamedTuple):
    """Contents of a trajectory file to write. attributes (global ones), variables: by name."""

    attributes: dict[str, Any]
    variables: dict[str, classic.NetcdfVariable]


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

    @property
    def openings(self) -> dict[str, np.ndarray]:
        """Openings (joint coordinates) (t,) of all hinges by name: rad, of slides m."""
        return {**self.select_columns("opening"), **self.select_columns("slide_opening")}

    def select_columns(self, variable: str) -> dict[str, np.ndarray]:
        """Return the columns (t,) of a recorded variable by label: "cable_tension" by its cable."""
        return {label: x for (name, label), x in self.columns.items() if name == variable}

    def times(self, event: str, elements: Iterable[str]) -> np.ndarray:
        """Return the times (s), increasing, at which any of some elements had an event. event: its
        name, such as "latches"; elements: the elements' names."""
        names = [e.events if e.name in elements else () for e in self.eventful]
        numbers = [labels.index(event) if event in labels else -1 for labels in names]
        rows = self.events[:, 2] == np.array(numbers)[self.events[:, 1].astype(int)]
        return np.sort(self.events[rows, 0])

    def impacts(self, pairs: Mapping[str, str] = IMPACTS) -> Impacts:
        """Return the impacts of the run, at whose times responses bend or jump. pairs: names of
        events, {what begins an impact: what ends it}; a latch's ends at once."""
        events = [e.events for e in self.eventful]
        starts = [next((e for e in labels if e in pairs), None) for labels in events]
        has_impact = [event is not None for event in starts]
        index, element = np.cumsum(has_impact) - 1, self.events[:, 1].astype(int)
        blocks = []
        for number_of, flag in ((lambda e: e, 1.0), (pairs.get, 0.0)):
            event_pairs = zip(events, starts, strict=True)
            numbers = [labels.index(number_of(e)) if e else -1 for labels, e in event_pairs]
            selection = np.flatnonzero(self.events[:, 2] == np.array(numbers, int)[element])
            blocks.append(stack_columns(self.events[selection, 0], index[element[selection]], flag))
        rows = np.concatenate(blocks)
        # In order of time; what begins and ends at once begins first.
        rows = rows[np.lexsort((rows[:, 1], -rows[:, 2], rows[:, 0]))]
        names = [e.name for e, hits in zip(self.eventful, has_impact, strict=True) if hits]
        return Impacts(rows, [name.removeprefix("contact ") for name in names])


def contents(outcome, responses=(), attributes=None, parameters=None) -> Contents:
    """Return the contents of a trajectory file of one run, with names and units by the CF
    conventions. outcome: the run's (fpm.Outcome), whose failure is raised if it has one; responses:
    sequence of fpm.reading.responses.Response, whose values are added; attributes: further global
    ones by name; parameters: (value, unit) by name, each a scalar coordinate `parameter_<name>`;
    None for none of them."""
    if outcome.failure is not None:
        raise outcome.failure
    variables = {
        "time": _variable("time", outcome.time, "s", "time", standard_name="time", axis="T"),
        **_points(outcome),
        **_energies(outcome),
        **_record_variables(outcome),
        **_events(outcome),
        **_responses(outcome, responses),
        **{
            f"{_PARAMETER}{name}": _variable((), np.array(value), unit, name)
            for name, (value, unit) in (parameters or {}).items()
        },
    }
    limit = outcome.limit
    header = {
        "Conventions": CONVENTIONS,
        "title": f"trajectory of scene {outcome.scene.name}",
        "source": "finite particle method",
        "history": f"fpm.solver.simulate: {outcome.steps} steps of {outcome.step:.9g} s",
        "scene": outcome.scene.name,
        "responses": " ".join(response.name for response in responses),
        "time_step": outcome.step,
        "steps": outcome.steps,
        "events_dropped": outcome.dropped_events,
    }
    if outcome.scene.assembly is not None:
        assembly = outcome.scene.assembly
        header |= {"assembly_energy": assembly.energy, "assembly_gap": assembly.gap}
    if outcome.scene.equilibrium is not None:
        balance = outcome.scene.equilibrium
        header |= {"equilibrium_energy": balance.energy, "equilibrium_imbalance": balance.imbalance}
    if limit is not None:
        header |= {"time_step_limit": limit.step, "limiting_element": limit.element}
    return Contents({**header, **(attributes or {})}, variables)


def _variable(dims, values, unit, long_name, **extra) -> classic.NetcdfVariable:
    """A variable of numbers; without units if `unit` is "", as where its columns have several."""
    dims = (dims,) if isinstance(dims, str) else dims
    units = {"units": unit} if unit else {}
    return classic.NetcdfVariable(dims, values, {**units, "long_name": long_name, **extra})


def _names(dimension: str, values, long_name: str, name: str | None = None) -> dict:
    """Text along a dimension: its coordinate, or a variable of another name."""
    text = np.array(list(values), dtype=str)
    return {name or dimension: classic.NetcdfVariable((dimension,), text, {"long_name": long_name})}


def _points(outcome) -> dict[str, classic.NetcdfVariable]:
    names, dims = list(outcome.points), ("time", "point", "axis")
    tracks = np.zeros((2, len(outcome.time), len(names), 3))
    for i, name in enumerate(names):
        tracks[:, :, i] = outcome.points[name]
    return {
        **_names("point", names, "named point"),
        **_names("axis", "xyz", "global axis"),
        "position": _variable(dims, tracks[0], "m", "position of the named points"),
        "velocity": _variable(dims, tracks[1], "m s-1", "velocity of the named points"),
    }


def _energies(outcome) -> dict[str, classic.NetcdfVariable]:
    return {
        variable: _variable("time", outcome.energies[name], "J", long_name, energy=name)
        for name, variable, long_name in outcome.energy_kinds
    }


def _record_variables(outcome) -> dict[str, classic.NetcdfVariable]:
    """What the kinds in the scene have recorded, and the coordinates of it."""
    variables = {}
    for name, (values, unit, long_name, dimension, labels, axis) in outcome.records.items():
        dims = (axis,) if dimension is None else (axis, dimension)
        variables[name] = _variable(dims, values, unit, long_name)
        if dimension is not None:
            variables |= _names(dimension, labels, dimension)
    return variables


def _events(outcome) -> dict[str, classic.NetcdfVariable]:
    (time, element, number), eventful = outcome.events.T, outcome.eventful
    element, number = element.astype(np.int32), number.astype(np.int8)
    event_names = (" ".join(e.events) for e in eventful)
    gates = np.array(
        [e.gate[:4] if e.gate else (0.0, _NO_SIDE, 0.0, 0.0) for e in eventful]
    ).reshape(-1, 4)
    text = "where it latches, hits, closes: opening, side (2: not known), reach, largest rate"
    return {
        **_names("event_element", (e.name for e in eventful), "element that has events"),
        **_names("event_element", event_names, "events of the element, by number", "event_names"),
        **_names("event_element", (e.joint for e in eventful), "joint it is on", "event_joint"),
        "event_gate": _variable(("event_element", "gate_number"), gates, "", text),
        "event_time": _variable("event", time, "s", "time of an event"),
        "event_of": _variable("event", element, "1", "index of the event's element"),
        "event_number": _variable("event", number, "1", "number of the event"),
    }


def _responses(outcome, responses) -> dict[str, classic.NetcdfVariable]:
    """All responses in one variable: no name that a response may have meets another's."""
    values = np.array([response.evaluate(outcome) for response in responses])
    values, dims = values.reshape(-1, len(outcome.time)), ("response", "time")
    text = (response.long_name for response in responses)
    return {
        **_names("response", (r.name for r in responses), "response"),
        **_names("response", (r.unit for r in responses), "unit of the response", "response_units"),
        **_names("response", text, "response in words", "response_long_name"),
        "response_values": _variable(dims, values, "", "responses in units of response_units"),
    }


def to_dataset(outcome, responses=(), attributes=None, parameters=None) -> "xarray.Dataset":
    """Return one run's trajectory as an xarray.Dataset. outcome: the run's (fpm.Outcome), whose
    failure is raised if it has one; responses: sequence of Response whose values are added;
    attributes: further global ones by name; parameters: (value, unit) by name, of the run; None:
    none."""
    import xarray

    attributes, variables = contents(outcome, responses, attributes, parameters)
    return xarray.Dataset(
        {name: v for name, v in variables.items() if not _is_coordinate(name, v)},
        coords={name: v for name, v in variables.items() if _is_coordinate(name, v)},
        attrs=attributes,
    )


def _is_coordinate(name: str, variable: classic.NetcdfVariable) -> bool:
    text = variable.values.dtype.kind in "UO"
    return variable.dims == (name,) or text or name.startswith(_PARAMETER)


def check_finite(variables: Mapping[str, classic.NetcdfVariable]) -> None:
    """Check that all values of `variables` (NetcdfVariable by name) are finite; raises ValueError
    that names the first with one that is not."""
    for name, variable in variables.items():
        if variable.values.dtype.kind == "f" and not np.isfinite(variable.values).all():
            raise ValueError(f"{name} has values that are not finite; nothing is written")


def write(trajectory: "Contents | xarray.Dataset", path: str | os.PathLike) -> None:
    """Write a trajectory (Contents or xarray.Dataset) to a sealed netCDF file at `path`, which
    appears when it is complete. Its attribute `run_id`, if it has one, names it in the seal. Raises
    ValueError if a value is not finite; then no file is left."""
    if not isinstance(trajectory, Contents):
        variables = {
            str(name): classic.NetcdfVariable(tuple(map(str, v.dims)), v.values, v.attrs)
            for name, v in trajectory.variables.items()
        }
        trajectory = Contents(dict(trajectory.attrs), variables)
    check_finite(trajectory.variables)
    # By this attribute xarray tells coordinates that are no dimensions.
    names = [n for n, v in trajectory.variables.items() if _is_coordinate(n, v) and v.dims != (n,)]
    trajectory.attributes["coordinates"] = " ".join(names)
    with seals.whole_file(path, {"name": _name(trajectory.attributes.get("run_id"))}) as temporary:
        classic.write(temporary, *trajectory)


def _name(run: str | None) -> str:
    """What a trajectory is called in its seal."""
    return f"run {run}" if run else "a trajectory"


def read(path: str | os.PathLike) -> "xarray.Dataset":
    """Return the trajectory in the file at `path`, in memory, as an xarray.Dataset. Raises
    seals.DamagedError if the file is not as it was written."""
    import xarray

    seals.check(path)
    with xarray.open_dataset(path) as dataset:
        return dataset.load()


def _texts(variables: Mapping[str, classic.NetcdfVariable], name: str) -> list[str]:
    """Values of a variable of text; none where it is not in the file, as its dimension is empty."""
    rows = variables[name].values if name in variables else ()
    return [row.tobytes().rstrip(b"\0").decode() for row in rows]


def read_curves(path: str | os.PathLike, run: str | None = None) -> Curves:
    """Return the curves and events in the trajectory file at `path`, a hundred times faster than as
    a dataset. run: id of the run that it must be of, None: any. Raises OSError if there is no file,
    seals.DamagedError (a subclass) if it is not as it was written, or of another run."""
    content = seals.read_bytes(path)
    seals.check_content(path, content, run and _name(run))
    attributes, variables = classic.read(path, content)

    names = partial(_texts, variables)

    def values(name: str) -> np.ndarray:
        return variables[name].values

    try:
        columns = ("event_time", "event_of", "event_number")
        events = [values(name) for name in columns if name in variables]
        return Curves(
            time=values("time"),
            points={
                name: (values("position")[:, i], values("velocity")[:, i])
                for i, name in enumerate(names("point"))
            },
            energies=Energies(
                (v.attributes["energy"], v.values)
                for v in variables.values()
                if "energy" in v.attributes
            ),
            columns={
                (name, label): v.values[:, i]
                for name, v in variables.items()
                if v.dims[:-1] in (("time",), (LED_OVER,))
                for i, label in enumerate(names(v.dims[1]))
            },
            events=np.stack(events, axis=1) if events else np.zeros((0, len(columns))),
            eventful=tuple(
                Eventful(
                    name,
                    tuple(text.split(" ")),
                    joint,
                    None if gate[1] == _NO_SIDE else Gate(*gate),
                )
                for name, text, joint, gate in zip(
                    names("event_element"),
                    names("event_names"),
                    names("event_joint"),
                    values("event_gate").tolist() if "event_gate" in variables else (),
                    strict=True,
                )
            ),
            dropped_events=int(attributes.get("events_dropped", 0)),
            step=float(attributes["time_step"]),
        )
    except KeyError as missing:
        raise OSError(f"{os.fspath(path)} has no variable {missing}") from None
