"""Where the results of runs are kept, under names that follow from their content.

A finished run is found again by any later design that asks for it, and by a campaign that was
killed. Two ways to keep a run, with the same methods:

`Trajectories`  one netCDF file per run, `<run id>.nc`, with everything recorded;
`Responses`     one netCDF file per group of lanes, `<digest of the group's run ids>.nc`, with the
                responses and contact events only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from campaign.config import digest
from campaign.files import whole_file

# Contact events as the interval side gets them, however a run is kept: names in the samples and in
# a trajectory, in the order of the columns of an outcome's `events`.
EVENT_VARIABLES = {
    "event_time": "contact_event_time",
    "event_contact": "contact_event_contact",
    "event_closing": "contact_event_closing",
}


@dataclass(frozen=True)
class Result:
    """A run that went well: its `fpm.Outcome`, parsed responses, and attributes for its file."""

    id: str
    outcome: Any
    responses: Sequence[Any]
    attributes: Mapping[str, Any]


def open_store(keep: str, folder: str | Path) -> Trajectories | Responses:
    """The store for a config's `jobs.keep` in `folder`."""
    return {"trajectories": Trajectories, "responses": Responses}[keep](Path(folder))


class Trajectories:
    """One netCDF file per run."""

    def __init__(self, folder: Path):
        self.folder = Path(folder)

    def path(self, run: Mapping) -> Path:
        return self.folder / f"{run['id']}.nc"

    def missing(self, group: Sequence[Mapping]) -> list[Mapping]:
        """The runs of the group that are still to be simulated."""
        return [run for run in group if not _is_whole(self.path(run))]

    def count(self, groups: Sequence[Sequence[Mapping]]) -> int:
        """How many runs of all groups are there, by file name alone."""
        there = {path.stem for path in self.folder.glob("*.nc")} if self.folder.is_dir() else set()
        return sum(run["id"] in there for group in groups for run in group)

    def write(self, group: Sequence[Mapping], results: Sequence[Result]) -> None:
        """Write the results that a group has left."""
        import fpm

        for result in results:
            dataset = result.outcome.dataset(result.responses, result.attributes)
            fpm.trajectory.write(dataset, self.folder / f"{result.id}.nc")

    def read(self, group: Sequence[Mapping], names: Sequence[str]) -> dict[str, dict]:
        """Responses (time) and events (event) of each run by its id; see `read_run`."""
        import netCDF4

        found = {}
        for run in group:
            with netCDF4.Dataset(self.path(run)) as file:
                found[run["id"]] = read_run(file, names)
        return found


class Responses:
    """One netCDF file per group of lanes, with the responses only, in single precision."""

    def __init__(self, folder: Path):
        self.folder = Path(folder)

    def path(self, group: Sequence[Mapping]) -> Path:
        return self.folder / f"{digest([run['id'] for run in group])}.nc"

    def missing(self, group: Sequence[Mapping]) -> list[Mapping]:
        """The runs of the group that are still to be simulated: all of them, or none.

        A group in which a run had failed is simulated again as a whole.
        """
        path = self.path(group)
        if _is_whole(path) and self._ids(path) == [run["id"] for run in group]:
            return []
        return list(group)

    @staticmethod
    def _ids(path: Path) -> list[str]:
        import netCDF4

        with netCDF4.Dataset(path) as file:
            return list(file["run_id"][:])

    def count(self, groups: Sequence[Sequence[Mapping]]) -> int:
        """How many runs of all groups are there."""
        return sum(len(group) for group in groups if self.path(group).exists())

    def write(self, group: Sequence[Mapping], results: Sequence[Result]) -> None:
        """Write the results that a group has left; ValueError if a number is not finite."""
        import netCDF4

        if not results:
            return
        first = results[0].outcome
        events = [result.outcome.events for result in results]
        with (
            whole_file(self.path(group)) as temporary,
            netCDF4.Dataset(temporary, "w", format="NETCDF4") as file,
        ):
            file.createDimension("run", len(results))
            file.createDimension("time", len(first.time))
            file.createDimension("event", max(1, max(map(len, events))))
            file.createVariable("time", "f8", ("time",))[:] = first.time
            write_names(
                file, "contact", [first.scene.hinges[c.hinge].name for c in first.scene.contacts]
            )
            ids = np.array([result.id for result in results], dtype=object)
            file.createVariable("run_id", str, ("run",))[:] = ids
            for response in results[0].responses:
                values = np.stack([response.evaluate(result.outcome) for result in results])
                if not np.isfinite(values).all():
                    raise ValueError(f"{response.name} has values that are not finite")
                variable = file.createVariable(
                    response.name, "f4", ("run", "time"), zlib=True, complevel=1
                )
                variable[:] = values
                variable.setncatts({"units": response.unit, "long_name": response.long_name})
            for column, name in enumerate(EVENT_VARIABLES):
                variable = file.createVariable(name, "f8", ("run", "event"), fill_value=np.nan)
                for row, table in enumerate(events):
                    variable[row, : len(table)] = table[:, column]

    def read(self, group: Sequence[Mapping], names: Sequence[str]) -> dict[str, dict]:
        """Responses (time) and events (event) of each run by its id; see `read_run`."""
        import netCDF4

        with netCDF4.Dataset(self.path(group)) as file:
            whole, ids = read_run(file, names), list(file["run_id"][:])
        return {
            id_: {
                key: value[row] if key in names or key in EVENT_VARIABLES else value
                for key, value in whole.items()
            }
            for row, id_ in enumerate(ids)
        }


def read_run(file: Any, names: Sequence[str]) -> dict[str, Any]:
    """Time, responses, their `attributes` and contact events of an open netCDF file."""
    found: dict[str, Any] = {"time": np.asarray(file["time"][:])}
    for name in names:
        found[name] = np.asarray(file[name][:])
    found["contact"] = list(file["contact"][:]) if "contact" in file.variables else []
    found["attributes"] = {
        name: {key: getattr(file[name], key, "") for key in ("units", "long_name")}
        for name in names
    }
    for name, source in EVENT_VARIABLES.items():
        key = source if source in file.variables else name
        if key in file.variables:
            found[name] = np.ma.filled(np.ma.asarray(file[key][:], dtype=float), np.nan)
    return found


def write_names(file: Any, dimension: str, names: Sequence[str]) -> None:
    """Define a dimension whose coordinate are names."""
    file.createDimension(dimension, len(names))
    variable = file.createVariable(dimension, str, (dimension,))
    if len(names):
        variable[:] = np.array([str(name) for name in names], dtype=object)


def _is_whole(path: Path) -> bool:
    """Whether the file is there and can be opened as netCDF."""
    if not path.exists():
        return False
    import netCDF4

    try:
        with netCDF4.Dataset(path):
            return True
    except OSError:
        return False
