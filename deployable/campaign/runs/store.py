"""The stores of runs, one for each `jobs.keep`, and runs as one file between jobs."""

from __future__ import annotations

import shutil
import tarfile
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Experiment, digest
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import EVENT_VARIABLES, report_damage, whole_file
from deployable.campaign.plan.plan import PlannedRun, Runs
from deployable.campaign.runs import results as common
from deployable.campaign.runs.results import Result, RunRecord, Store
from fpm.files import trajectory
from fpm.files.seals import DamagedError, read_seal
from fpm.files.trajectory import PEAK
from fpm.reading.quantities import MARGIN_READS, impact_margins
from fpm.reading.variables import VARIABLES


class Trajectories(Store):
    """Store for `jobs.keep: trajectories`: one netCDF file for each group of runs, with energies,
    openings, events, and what responses read, whose seal names the runs. Changed responses are
    evaluated from it, unless they read other points or variables."""

    def __init__(self, folder: Path, experiment: Experiment):
        super().__init__(folder, experiment)
        self._peaks = {q.peak_column for q in experiment.peaks}
        self._reads = {column for response in self.responses for column in response.reads}

    @cached_property
    def _paths(self) -> dict[str, list[Path]]:
        """The files that have a run, by its name; as found at first, and written since."""
        paths: dict[str, list[Path]] = {}
        for path in sorted(self.folder.glob("*.nc")):
            for name in self._names_in(path):
                paths.setdefault(name, []).append(path)
        return paths

    def _names_in(self, path: Path) -> list[str]:
        try:
            facts, _ = read_seal(path)
            if facts["name"] != common.title(path) or "runs" not in facts:
                raise DamagedError(path, f"it is {facts['name']}")
            return facts["runs"].split()
        except DamagedError as error:
            self.damage[path] = error
        except FileNotFoundError:
            pass
        return []

    def missing(self, group: Runs) -> Runs:
        """Return the runs of a group to be simulated: those without an undamaged file, or whose
        file lacks a variable that responses need."""
        group = self.sound(group)
        curves = self.curves(group)
        return group[[i for i, run in enumerate(group) if run.id not in curves]]

    def counter(self, groups: Sequence[Runs]) -> Callable[[], int]:
        """Return a function that counts the stored runs of these groups, by seals alone."""
        names = {run.id for group in groups for run in group}
        paths = partial(self.folder.glob, "*.nc")
        return lambda: len(names.intersection(n for path in paths() for n in self._names_in(path)))

    def write(self, group: Runs, results: Iterable[Result]) -> None:
        """Write the results to one file, none if there are none; `group` is not used. Raises
        ValueError if a number is not finite."""
        if not (results := list(results)):
            return
        names = [result.id for result in results]
        types = self.experiment.scene_type.parameters
        attributes = {f"parameter_{key}": x for key, x in results[0].parameters.items()
                      if key not in self.experiment.intervals and x is not None}  # fmt: skip
        parameters = {key: ([result.parameters[key] for result in results], types[key].unit)
                      for key in self.experiment.intervals}  # fmt: skip
        outcomes, attributes = [r.outcome for r in results], {**results[0].common, **attributes}
        basis = {c for c in outcomes[0].columns if c[0] in (*MARGIN_READS, PEAK, *VARIABLES)}
        columns = self._reads | basis
        contents = trajectory.contents(outcomes, attributes, parameters, names, columns)
        path = self.folder / f"{digest(names)}.nc"
        trajectory.write(contents, path, name=common.title(path), runs=" ".join(names))
        for name in names:
            self._paths.setdefault(name, []).append(path)

    def read(self, group: Runs) -> dict[str, RunRecord]:
        """Read the runs of a group that are stored: returns a `RunRecord` by run id."""
        records = {}
        for name, curves in self.curves(group).items():
            with report_damage(self._paths[name][0]):
                values = common.values_of(self.responses, [curves])[0]
                numbers = common.numbers_of(self.quantities, curves)
                numbers = common.complete_numbers(self.experiment, numbers)
                events, contacts = curves.impacts()
                overlap = common.largest_overlap(curves.openings, contacts)
                rows = *numbers, np.array(impact_margins(curves))
                fields = (curves.time, values, events, contacts, *rows, overlap, curves.step)
                records[name] = RunRecord(*fields)
        return records

    def curves(self, runs: Sequence[PlannedRun]) -> dict[str, trajectory.Curves]:
        """Read the curves of those of some runs that have an undamaged file with what responses
        need, by id. What others lack is noted."""
        sound_curves: dict[str, trajectory.Curves] = {}
        names = [run.id for run in runs]
        for path in dict.fromkeys(path for name in names for path in self._paths.get(name, ())):
            rest = [n for n in names if n not in sound_curves and path in self._paths.get(n, ())]
            try:
                with report_damage(path):
                    file_curves = trajectory.read_curves(path, common.title(path), rest)
            except DamagedError as error:
                self.damage[error.path] = error
                continue
            except FileNotFoundError:
                continue
            for name, curves in file_curves.items():
                columns = {*curves.columns, *((trajectory.POSITION, p) for p in curves.points)}
                peaks = {p for p in self._peaks if any(key == PEAK for key, _ in curves.columns)}
                if lacks := (self._reads | peaks) - columns:
                    self.absences[name] = lacks
                else:
                    sound_curves[name] = curves
                    self.absences.pop(name, None)
        return sound_curves


class Responses(Store):
    """Store of runs for `jobs.keep: responses`: one netCDF file for each group of runs, with their
    responses (single precision), events and quantities. Other groups have other files."""

    def path(self, group: Runs) -> Path:
        """Return the path of a group's file, named by runs, responses and quantities."""
        return self.folder / f"{self.file_of(group)}.nc"

    def missing(self, group: Runs) -> Runs:
        """Return the runs of a group to be simulated: none, or all that are not known to fail."""
        import netCDF4

        path, group = self.path(group), self.sound(group)
        if not len(group) or not self.is_whole(path):
            return group
        with report_damage(path), netCDF4.Dataset(path) as file:
            is_old, ids = "event_margin" not in file.variables, list(file["run_id"][:])
        return group if is_old or ids != [run.id for run in group] else group[:0]

    def write(self, group: Runs, results: Iterable[Result]) -> None:
        """Write the results of a group's runs to its file, no file if none succeeded. Raises
        ValueError if a number is not finite."""
        if not (results := list(results)):
            return
        outcomes = [result.outcome for result in results]
        impacts = [outcome.impacts() for outcome in outcomes]
        contacts, ids = impacts[0].names, np.array([r.id for r in results], dtype=object)
        events = common.pad_events([impact.events for impact in impacts], least=1)
        overlaps = [common.largest_overlap(outcome.openings, contacts) for outcome in outcomes]
        values, curves = common.values_of(self.responses, outcomes), ("run", "response", "time")
        # Not compressed: it would save a third, and take half of the time of writing.
        variables: dict[str, tuple] = {
            "contact": (str, ("contact",), np.array(contacts, str)),
            "time": ("f8", ("time",), outcomes[0].time),
            "values": ("f4", curves, values),
            "run_id": (str, ("run",), ids),
            "overlap": ("f8", ("run",), overlaps),
            "step": ("f8", ("run",), [outcome.step for outcome in outcomes]),
            "event_margin": ("f8", ("run", "contact"), [*map(impact_margins, outcomes)]),
        }
        for name, column in zip(EVENT_VARIABLES, np.moveaxis(events, -1, 0), strict=True):
            variables[name] = "f8", ("run", "event"), column
        if self.quantities:
            numbers = [common.numbers_of(self.quantities, outcome) for outcome in outcomes]
            variables["quantities"] = "f8", ("run", "pair", "quantity"), numbers
        columns = {
            name: trajectory.NetcdfVariable(dims, content, {}, {"kind": kind})
            for name, (kind, dims, content) in variables.items()
        }
        path = self.path(group)
        with whole_file(path, {"name": common.title(path)}) as temporary:
            trajectory.write_arrays(temporary, {}, columns)

    def read(self, group: Runs) -> dict[str, RunRecord]:
        """Read the runs of a group from its file: returns a `RunRecord` by run id, none unless the
        file is undamaged and holds all of them."""
        import netCDF4

        path, missing, group = self.path(group), self.missing(group), self.sound(group)
        if missing or not len(group):
            return {}
        with report_damage(path), netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            time, contacts = file["time"][:], list(file["contact"][:])
            values, overlaps, steps = (file[name][:] for name in ("values", "overlap", "step"))
            events = np.stack([file[name][:] for name in EVENT_VARIABLES], axis=-1)
            event_margins = file["event_margin"][:]
            empty = np.zeros((len(group), 2, 0))
            numbers = file["quantities"][:] if self.quantities else empty
            numbers = common.complete_numbers(self.experiment, numbers)
            records = {}
            for row, run in enumerate(group):
                run_events = events[row][np.isfinite(events[row, :, 0])]
                last = *numbers[row], event_margins[row], float(overlaps[row]), float(steps[row])
                records[run.id] = RunRecord(time, values[row], run_events, contacts, *last)
        return records


STORES = {"trajectories": Trajectories, "responses": Responses}


def open_store(keep: str, folder: str | Path, experiment: Experiment) -> Any:
    """Return the store of an experiment's runs in a folder for `jobs.keep` of the config."""
    return STORES[keep](Path(folder), experiment)


# -- runs as one file, for jobs that share no folder ----------------------------------------------

_SUFFIXES = (".nc", common.NOTE_SUFFIX)


def pack(store: str | Path, bundle: str | Path) -> None:
    """Write all result files in the folder `store` into the tar file `bundle`."""
    with whole_file(bundle) as temporary, tarfile.open(temporary, "w") as file:
        for path in sorted(Path(store).glob("[!.]*")):
            if path.name.endswith(_SUFFIXES):
                file.add(path, path.name)


def unpack(bundles: Iterable[str | Path], store: str | Path) -> None:
    """Extract the result files in tar files, `bundles`, into the folder `store`, unless they exist.
    Raises `CampaignError` for a file that is not a tar file. Seals show damage later."""
    for bundle in bundles:
        try:
            with tarfile.open(bundle) as file:
                for member in file:
                    path = Path(store, Path(member.name).name)
                    if not member.isfile() or not path.name.endswith(_SUFFIXES) or path.exists():
                        continue
                    content: Any = file.extractfile(member)
                    with whole_file(path) as temporary, open(temporary, "wb") as copy:
                        shutil.copyfileobj(content, copy)
        except tarfile.TarError as error:
            raise CampaignError(f"{bundle} holds no runs: {error}") from None
