"""Roles, number and names of the runs of an open `samples.nc` (`netCDF4.Dataset` or
`xarray.Dataset`), with any `jobs.keep`."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Experiment
from deployable.campaign.files.contents import ROLES
from deployable.campaign.plan.runs import namer


@dataclass(frozen=True)
class Counts:
    """How many different runs a campaign has: `runs`, all; `nodes`, those that were fitted;
    `held_out`, those kept back to test the fit (and no nodes). has_nominal: whether the run
    at nominal parameters is a node or held out, so that it is not counted once more in `runs`."""

    runs: int
    nodes: int
    held_out: int
    has_nominal: bool


def keeps_extremes(samples: Any) -> bool:
    """Whether an open `samples.nc` has least and largest values (`jobs.keep: extremes`) only."""
    return "lower_run" in samples.variables


def nominal_row(samples: Any) -> int | None:
    """Index of the run with nominal parameters in the open `samples.nc`; None if there is none."""
    if keeps_extremes(samples):
        return 0
    rows = np.flatnonzero(np.asarray(samples.variables["role"][:]) == ROLES[0])
    return int(rows[0]) if len(rows) else None


def read_roles(samples: Any) -> list[str]:
    """Role of each run of an open `samples.nc`: `nominal`, `node` (fitted), `held_out` (a test)."""
    if keeps_extremes(samples):
        return ["nominal"] + ["node"] * (samples.variables["value"].shape[0] - 1)
    return np.asarray(samples.variables["role"][:]).tolist()


def read_ids(samples: Any, rows: Sequence[int] | slice) -> list[str]:
    """Names (16 hex digits) of runs of an open `samples.nc`; rows: indices, or a slice."""
    rows = rows if isinstance(rows, slice) else list(rows)
    if "run_id" in samples.variables:
        return np.asarray(samples.variables["run_id"][:])[rows].tolist()
    experiment = Experiment.read(samples.config)
    name = namer(experiment, float(samples.time_step), samples.mechanics)
    return [name(tuple(row)) for row in np.asarray(samples.variables["value"][:])[rows].tolist()]


def count_roles(samples: Any) -> Counts:
    """Count the different runs of the open `samples.nc` (equal parameters count once) by role."""
    if keeps_extremes(samples):
        runs = samples.variables["value"].shape[0]
        return Counts(runs, runs - 1, 0, False)
    runs_by_role: dict[str, set] = {role: set() for role in ROLES}
    for role, run in zip(read_roles(samples), read_ids(samples, slice(None)), strict=True):
        runs_by_role[role].add(run)
    nominal, nodes, held_out, _ = runs_by_role.values()
    held_out = held_out - nodes
    design_runs = nodes | held_out
    has_nominal = bool(nominal & design_runs)
    return Counts(len(design_runs | nominal), len(nodes), len(held_out), has_nominal)
