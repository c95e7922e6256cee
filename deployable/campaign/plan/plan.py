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

import json
import math
from base64 import b64decode, b64encode
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import fpm
from deployable.campaign.config.sections import (
    Experiment,
    digest,
    from_data,
    make_design,
    plain_data,
    steps_problems,
)
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import read_json, write_result
from deployable.campaign.files.contents import ROLES, report_damage
from deployable.campaign.plan.runs import PlannedRun, Runs
from deployable.intervals import held_out_points
from deployable.intervals.box import MOST_FULL
from fpm.files.trajectory import CONVENTIONS
from fpm.scenes.timestep import find_curve_step

ROUNDING = 1e-12
"""Share of a size below which a width is rounding: thousands of steps leave some 1e-13."""


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

    @property
    def is_finished(self) -> bool:
        """Whether no rounds of an `accuracy` follow on this plan's; False without an `accuracy`."""
        return self.adaptive is not None and self.adaptive.met is not None

    @cached_property
    def config_hash(self) -> str:
        """Digest of the experiment; of a structure's file not the path counts but `mechanics`."""
        data = plain_data(self.experiment)
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
            "config": json.dumps(plain_data(self.experiment)),
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
    the finest feature of curves of time, or the config's step, shortened to divide the time between
    instants. corners: whether stability is computed at every corner of the box too (of more than
    eight intervals, at the ends of each and where the worse ends meet). Raises `CampaignError` for
    more steps than `MOST_STEPS`."""
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
        experiment, mechanics = Experiment.from_results(data["config"]), str(data["mechanics"])
        time = from_data(TimeStep, {name: data[name] for name in TimeStep.__dataclass_fields__})
        columns = data["runs"]
        role = np.frombuffer(b64decode(columns["role"]), "i1").astype(np.int8)
        points = np.frombuffer(b64decode(columns["normalized"]), "<f8").astype(float)
        points = points.reshape(columns["count"], -1)
        runs = Runs.from_points(experiment, role, points, time.step, mechanics)
        adaptive = from_data(Rounds, data["adaptive"]) if "adaptive" in data else None
    return Plan(experiment, mechanics, time, runs, adaptive)
