"""The plan of a campaign: which runs there are, known by their parameter values.

`plan.json` holds it:

    campaign, config_hash, config   the sections of the config that decide the runs, resolved
    step, step_limit (s), limiting_element, output_steps, assembly_energy (J), mechanics
    runs      {count, role, normalized}, the arrays (count) of indices into `ROLES`, one byte each,
              and (count, k) of little-endian doubles, in base64; the values follow from the box
    adaptive  of a round: the `rounds` before it, all `points` so far, and whether the tolerance is
              `met`: null unless this is the plan after the last round, which has no new runs; and
              what its bounds are to `check`

A run that serves two roles is listed twice, with the same id, and simulated once."""

import hashlib
import json
import math
from base64 import b64decode, b64encode
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import fpm
from deployable.campaign.config.sections import (
    Experiment,
    digest,
    from_data,
    make_design,
    steps_problems,
)
from deployable.campaign.errors import CampaignError, error_of_files
from deployable.campaign.files import (
    FAILURE_VARIABLES,
    ROLES,
    describe_error,
    read_json,
    report_damage,
    write_result,
)
from deployable.campaign.folder import Folder
from deployable.campaign.provenance import program_digest
from deployable.intervals import held_out_points
from deployable.intervals.box import MOST_FULL
from fpm.errors import SceneError
from fpm.files.seals import DamagedError
from fpm.files.trajectory import CONVENTIONS
from fpm.scenes.timestep import find_curve_step

_MAX_NAMES = 1 << 17  # names


@dataclass(frozen=True)
class PlannedRun:
    """One run to be made: its point in the box (`normalized` (k), -1 to 1) and `values` (k) of the
    interval parameters, in their units. id: digest that names its file; role: one of `ROLES`."""

    id: str
    role: str
    normalized: tuple[float, ...]
    values: tuple[float, ...]


class FailedRun(NamedTuple):
    """A run whose numbers mean nothing: the planned `run`, the `time` (s) at which that showed, NaN
    if not known, and the `reason`, a text."""

    run: PlannedRun
    time: float
    reason: str


def failure_columns(failures: Sequence[FailedRun]) -> dict[str, list]:
    """Return the columns of a result that tells which runs failed, by name; none where none did."""
    if not failures:
        return {}
    runs, times, reasons = zip(*failures, strict=True)
    keys = ("id", "normalized", "values")
    places = {key: [getattr(run, key) for run in runs] for key in keys}
    columns = zip(FAILURE_VARIABLES, (*places.values(), times, reasons), strict=True)
    return {name: list(column) for name, column in columns}


class Runs(Sequence[PlannedRun]):
    """Sequence of N runs, held as arrays: an index gives a `PlannedRun`, a slice or a list of
    indices another sequence. role (N): indices into `ROLES` (nominal, node, held_out, ...); points
    (N, k): parameters from -1 (lower end) to 1 (upper), kept as `normalized`; values (N, k): the
    same in their units; id_of: function that returns a run's id from its k values, a tuple."""

    def __init__(
        self,
        role: np.ndarray,
        points: np.ndarray,
        values: np.ndarray,
        id_of: Callable[[tuple[float, ...]], str],
    ):
        self.role, self.normalized, self.values, self.id_of = role, points, values, id_of

    @classmethod
    def from_points(
        cls, experiment: Experiment, role: np.ndarray, points: np.ndarray, step: float,
        mechanics: str,
    ) -> "Runs":  # fmt: skip
        """Make the sequence of an experiment's runs at normalized points (N, k); nominal runs get
        the config's exact values. role (N): as of the class; step, mechanics: as of `namer`."""
        values = experiment.box.from_unit(points)
        values[role == ROLES.index("nominal")] = experiment.nominal
        return cls(role, points, values, namer(experiment, step, mechanics))

    def __len__(self) -> int:
        return len(self.role)

    def __getitem__(self, index: Any) -> Any:
        """A `PlannedRun` for a number; for a slice, or a list of numbers, the `Runs` there."""
        if isinstance(index, list):
            index = np.array(index, int)
        role, points, values = self.role[index], self.normalized[index], self.values[index]
        if np.ndim(role):
            return Runs(role, points, values, self.id_of)
        physical = tuple(values.tolist())
        return PlannedRun(self.id_of(physical), ROLES[role], tuple(points.tolist()), physical)

    @property
    def digest(self) -> str:
        """Digest (16 hex digits) of roles, normalized points and values, to the last bit."""
        sha = hashlib.sha256(self.role.tobytes())
        sha.update(self.normalized.tobytes())
        sha.update(self.values.tobytes())
        return sha.hexdigest()[:16]

    def unique(self) -> "Runs":
        """Return the runs in order, without those that repeat an earlier one's parameter values."""
        if not self.values.shape[1]:
            return self[:1]
        bits = np.ascontiguousarray(self.values).view(f"V{8 * self.values.shape[1]}")[:, 0]
        return self[np.sort(np.unique(bits, return_index=True)[1])]


class RunAccount:
    """Account of the runs of a campaign beside those that are planned, so that a limit holds for
    all that make some. limit: most runs that it may count, infinite for none; known_ids: of runs
    counted elsewhere. Attributes: `limit`; `ids`: of all runs so far; `count`: of those here."""

    def __init__(self, limit: float = math.inf, known_ids: Iterable[str] = ()) -> None:
        self.limit, self.count, self.ids = limit, 0, set(known_ids)

    @property
    def allowance(self) -> float:
        """How many more runs the limit allows."""
        return self.limit - self.count

    def count_runs(self, ids: Sequence[str]) -> list[bool]:
        """Count the runs with these ids, as long as the limit allows, each once, and return for
        each whether it may be made (or is counted already)."""
        for run_id in ids:
            if run_id not in self.ids and self.count < self.limit:
                self.ids.add(run_id)
                self.count += 1
        return [run_id in self.ids for run_id in ids]


def namer(
    experiment: Experiment, step: float, mechanics: str
) -> Callable[[tuple[float, ...]], str]:
    """Make a function that computes a run's id (16 hex digits) from its values (k) of the interval
    parameters, and from all else that its motion depends on. step: time step (s); mechanics: digest
    of the structure and of the code that computes runs."""

    @lru_cache(_MAX_NAMES)
    def name(values: tuple[float, ...]) -> str:
        parameters = experiment.parameters(dict(zip(experiment.intervals, values, strict=True)))
        solver = experiment.solver
        return digest(
            {
                "scene": experiment.scene.name,
                "parameters": {
                    name: float(value) if type(value) is int else value
                    for name, value in parameters.items()
                },
                "duration": solver.duration,
                "instants": solver.instants,
                "readings": experiment.readings(step),
                "step": step,
                "energy_tolerance": solver.energy_tolerance,
                "mechanics": mechanics,
            }
        )

    return name


@dataclass(frozen=True)
class TimeStep:
    """Time step of all runs of a plan: `step` (s); `output_steps`, steps between recorded instants;
    `step_limit` (s), the largest stable step, set by `limiting_element`, or the time between
    instants; `assembly_energy`, largest strain energy (J) of a run at its start."""

    step: float
    output_steps: int
    step_limit: float
    limiting_element: str
    assembly_energy: float = 0.0


@dataclass(frozen=True)
class Round:
    """A finished round of an `accuracy`, with the `action` decided after it and the `reason`. runs,
    seconds: spent so far, checks included, the time (s of one core) by estimate; error: of the
    worst response or quantity; shares: errors by name and component (surrogate, step, mesh), both
    as fractions of the widths; elements: value of the mesh's parameter; safety: factor on the
    stable step, or the step (s) if the config gives it; nodes: runs that were fitted."""

    runs: int
    error: float
    action: str
    reason: str
    shares: dict[str, dict[str, float]] = field(default_factory=dict)
    elements: int = 0
    safety: float = 0.0
    seconds: float = 0.0
    nodes: int = 0


@dataclass(frozen=True)
class Rounds:
    """State of an `accuracy` in a plan: the finished `rounds`, and `points` (n, k), normalized to
    -1 to 1, of the runs that surrogates are fitted to besides the nominal one. met: whether all
    errors are within their tolerances, None while rounds go on; check: for which errors, of "step"
    and "mesh", this plan's bounds are to be checked, by repeating runs with finer ones."""

    rounds: tuple[Round, ...]
    points: tuple[tuple[float, ...], ...]
    met: bool | None = None
    check: tuple[str, ...] = ()


@dataclass(frozen=True)
class Plan:
    """All runs of an experiment, and their time step (`time`): the content of `plan.json`.
    mechanics: digest of structure and program; adaptive: the `Rounds` of an `accuracy`, or None."""

    experiment: Experiment
    mechanics: str
    time: TimeStep
    runs: Runs
    adaptive: Any = None

    @cached_property
    def config_hash(self) -> str:
        """Digest of the experiment; of a structure's file not the path counts but `mechanics`."""
        data = asdict(self.experiment)
        del data["display"]
        if data["scene"]["file"]:
            data["scene"]["file"] = self.mechanics
        if data["design"]["file"]:
            data["design"]["file"] = data["design"]["digest"]
        return digest(data)

    @cached_property
    def digest(self) -> str:
        """Digest of experiment, time step and runs, by which results show of what plan they are."""
        return digest([self.config_hash, self.mechanics, self.time.step, self.runs.digest])

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of netCDF files that are made of this plan's runs."""
        return {
            "Conventions": CONVENTIONS,
            "campaign": self.experiment.name,
            "scene": self.experiment.scene.name,
            "config_hash": self.config_hash,
            "config": json.dumps(asdict(self.experiment)),
            "mechanics": self.mechanics,
        }

    @cached_property
    def unique_runs(self) -> Runs:
        """The plan's runs in order, without repeats of an earlier one's parameter values."""
        return self.runs.unique()

    def name_values(self, run: PlannedRun) -> dict[str, float]:
        """Return the values of the interval parameters in a run, in their units, by name."""
        return dict(zip(self.experiment.intervals, run.values, strict=True))


def box_columns(experiment: Experiment) -> dict[str, list]:
    """Return the variables over `parameter` of netCDF files of a campaign: names and units of the
    interval parameters, and lower, upper and nominal value of each, lists by name of variable."""
    parameters, names = experiment.scene_type.parameters, list(experiment.intervals)
    columns = {"parameter": names, "box_units": [parameters[name].unit for name in names]}
    for key in ("lower", "upper", "nominal"):
        columns[f"box_{key}"] = [getattr(i, key) for i in experiment.intervals.values()]
    return columns


def make_plan(experiment: Experiment, time: TimeStep | None = None) -> Plan:
    """Make the plan of a checked experiment: the nominal run, those of its design and, unless that
    is a Sobol sequence, validation runs. time: their time step; None: `choose_step` finds it."""
    box = experiment.box
    design = make_design(experiment)
    groups = [("nominal", box.to_unit(experiment.nominal)[None]), ("node", design.points)]
    if experiment.design.method != "sobol":
        points = held_out_points(box.free, experiment.held_out, design.points)
        groups.append(("held_out", points))

    time, mechanics = time or choose_step(experiment), experiment.mechanics
    role = np.repeat([ROLES.index(role) for role, _ in groups], [len(p) for _, p in groups])
    normalized = np.concatenate([points for _, points in groups])
    runs = Runs.from_points(experiment, role.astype(np.int8), normalized, time.step, mechanics)
    return Plan(experiment, mechanics, time, runs)


def choose_step(experiment: Experiment, corners: bool = True) -> TimeStep:
    """Choose one time step for all runs: the safety factor times the largest stable step, at most
    a quarter of the finest feature of curves, or the config's step, shortened to divide the time
    between instants. corners: whether stability is computed at every corner of the box too (of more
    than eight intervals, at the ends of each and where the worse ends meet). Raises `CampaignError`
    for more steps than `MOST_STEPS`."""
    solver, box = experiment.solver, experiment.box
    limit, finest, element, energy = math.inf, math.inf, "", 0.0
    points, steps = [np.zeros(box.dimension), *(box.corners() if corners else ())], []
    for point in points:
        values = dict(zip(box.names, map(float, box.from_unit(point)), strict=True))
        scene = experiment.build(values)
        stable = fpm.find_stable_step(scene)
        steps.append(stable.step)
        finest = min(finest, find_curve_step(scene, solver.duration))
        if len(steps) == 2 * box.free.sum() + 1 > 2 * MOST_FULL + 1:  # the worse ends together
            low, high = np.reshape(steps[1:], (-1, 2)).T
            points.append(np.zeros(box.dimension))
            points[-1][box.free] = np.where(low < high, -1.0, 1.0)
        if stable.step < limit:
            limit, element = float(stable.step), str(stable.element)
        if scene.assembly is not None:
            energy = max(energy, scene.assembly.energy)
    if math.isinf(limit):  # nothing elastic: no longer steps than between instants are taken
        limit, element = solver.duration / max(solver.instants - 1, 1), "the instants"
    largest = min(solver.safety * limit, finest) if solver.step == "auto" else solver.step
    for problem in steps_problems(solver, largest):
        raise CampaignError(problem)
    division = fpm.divide_time(solver.duration, solver.instants, largest)
    return TimeStep(division.step, division.output_steps, limit, element, energy)


def split_evenly(items: list, index: int, count: int) -> list:
    """Part `index` (from 0) of `items`, a list or `Runs`, cut into `count` nearly equal ones."""
    return items[len(items) * index // count : len(items) * (index + 1) // count]


def write_plan(plan: Plan, path: str | Path) -> None:
    """Write a plan to the file `path` as JSON (`plan.json`)."""
    head = {
        "campaign": plan.experiment.name,
        "config_hash": plan.config_hash,
        "config": asdict(plan.experiment),
        "mechanics": plan.mechanics,
        "structure": plan.experiment.scene_type.digest,
        **asdict(plan.time),
    }
    if plan.adaptive:
        head["adaptive"] = asdict(plan.adaptive)
    arrays = {"role": plan.runs.role.astype("i1"), "normalized": plan.runs.normalized}
    columns = {name: b64encode(values.tobytes()).decode() for name, values in arrays.items()}
    head["runs"] = {"count": len(plan.runs), **columns}
    text = json.dumps(head, indent=1) + "\n"
    write_result(path, text, plan=plan.digest)


def read_plan(path: str | Path) -> Plan:
    """Read a plan from `path`; raises `fpm.files.seals.DamagedError` if the file has changed."""
    data = read_json(path)
    with report_damage(path):
        experiment, mechanics = Experiment.read(data["config"]), str(data["mechanics"])
        time = from_data(TimeStep, {name: data[name] for name in TimeStep.__dataclass_fields__})
        columns = data["runs"]
        role = np.frombuffer(b64decode(columns["role"]), "i1").astype(np.int8)
        points = np.frombuffer(b64decode(columns["normalized"]), "<f8").astype(float)
        points = points.reshape(columns["count"], -1)
        runs = Runs.from_points(experiment, role, points, time.step, mechanics)
        adaptive = from_data(Rounds, data["adaptive"]) if "adaptive" in data else None
    return Plan(experiment, mechanics, time, runs, adaptive)


@contextmanager
def errors_of_results(*folders: Folder) -> Iterator[None]:
    """Context manager for code that reads folders of results or writes to the first: errors of
    files become `CampaignError`s, and any where another program made results, which lack data."""
    try:
        yield
    except (CampaignError, SceneError):
        raise
    except Exception as error:
        file_error = error_of_files(error, folders[0].path)
        is_data = file_error is None or isinstance(error, DamagedError)
        reason = error.reason if isinstance(error, DamagedError) else describe_error(error)
        paths = [str(x.path) for x in folders if is_data and _is_of_another_program(x)]
        if paths:
            text = f"made by another version of this program ({reason}): run the campaign again"
            raise CampaignError(f"{', '.join(paths)}: {text}") from error
        if file_error is None:
            raise
        raise file_error from error


def _is_of_another_program(folder: Folder) -> bool:
    with suppress(OSError):
        plan = read_json(folder.plan)
        return plan.get("mechanics") != digest([program_digest(), plan.get("structure")])
    return False
