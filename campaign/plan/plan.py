"""The plan of a campaign: which runs there are, known by their parameter values.

`nodes.json` holds it, one run a line:

    campaign, config_hash, config   the sections of the config that decide the runs, resolved
    step, step_limit (s), limiting_element, steps_per_instant, assembly_energy (J), mechanics
    runs      [{id, role, unit (k), values (k)}], role is node, nominal or held_out
    adaptive  of a round: the `rounds` before it, all `points` so far, and whether the tolerance is
              `met`: null unless this is the plan after the last round, which has no new runs; of
              an `accuracy`, what its bounds are to `check`

A run that serves two roles is listed twice, with the same id, and simulated once.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path

from campaign.config.sections import Experiment, digest, from_data, plain_data
from campaign.files import write_result
from fpm.sealed import check_content


@dataclass(frozen=True)
class Run:
    """One run: unit coordinates (k) in the box, and values (k) of the interval parameters."""

    id: str
    role: str
    unit: tuple[float, ...]
    values: tuple[float, ...]


@dataclass(frozen=True)
class TimeStep:
    """The step that serves all runs, the largest stable one (s), and what limits it where.

    assembly_energy: most strain energy (J) that forcing parts together leaves, there.
    """

    step: float
    steps_per_instant: int
    step_limit: float
    limiting_element: str
    assembly_energy: float = 0.0


@dataclass(frozen=True)
class Round:
    """A finished round: its design, the runs so far, its error as a share of the bounds' width in
    the worst response, and what was decided for which reason.

    Of an `accuracy`: the errors by part (surrogate, step, mesh) of every response and quantity as
    `shares` of the widths, the `elements` and the `safety` of the step (or the step, s) that the
    runs have, and the `seconds` of a core that rounds so far took, by estimate.
    """

    order: tuple[int, ...]
    parts: tuple
    runs: int
    error: float
    action: str
    reason: str
    shares: dict[str, dict[str, float]] = field(default_factory=dict)
    elements: int = 0
    safety: float = 0.0
    seconds: float = 0.0


@dataclass(frozen=True)
class Rounds:
    """The rounds before a plan, and all points (n, k) that were nodes so far.

    check: which of step and mesh the bounds of this plan are to be checked for, with finer runs.
    """

    rounds: tuple[Round, ...]
    points: tuple[tuple[float, ...], ...]
    met: bool | None = None
    check: tuple[str, ...] = ()


@dataclass(frozen=True)
class Plan:
    """All runs of an experiment. `mechanics` is the digest of the code that computes them."""

    experiment: Experiment
    mechanics: str
    time: TimeStep
    runs: tuple[Run, ...]
    adaptive: Rounds | None = None

    @property
    def is_finished(self) -> bool:
        """Whether this is the plan after the last round."""
        return self.adaptive is not None and self.adaptive.met is not None

    @cached_property
    def config_hash(self) -> str:
        """Digest of the experiment; for a structure's path stands the digest of its mechanics."""
        data = plain_data(self.experiment)
        if data["scene"]["file"]:
            data["scene"]["file"] = self.mechanics
        return digest(data)

    @cached_property
    def digest(self) -> str:
        """Digest of the experiment and all its runs: what results of the plan are known by."""
        return digest([self.config_hash, self.mechanics, *map(asdict, self.runs)])

    def unique_runs(self) -> list[Run]:
        """The runs, each id once, in their order."""
        return list({run.id: run for run in self.runs}.values())

    def named(self, run: Run) -> dict[str, float]:
        """Values of the interval parameters in a run, by name."""
        return dict(zip(self.experiment.intervals, run.values, strict=True))

    def groups(self, batches: int, size: int) -> list[list[list[Run]]]:
        """The runs by batch, then by group of `size`; only the last group may be smaller."""
        runs = self.unique_runs()
        groups = [runs[first : first + size] for first in range(0, len(runs), size)]
        return [share(groups, batch, batches) for batch in range(batches)]


def share(items: list, part: int, parts: int) -> list:
    """Part `part` of `items` split evenly, in order, into `parts`."""
    return items[len(items) * part // parts : len(items) * (part + 1) // parts]


def write_plan(plan: Plan, path: str | Path) -> None:
    """Write `nodes.json`; one run a line, so that it can be read and compared."""
    head = {
        "campaign": plan.experiment.name,
        "config_hash": plan.config_hash,
        "config": asdict(plan.experiment),
        "mechanics": plan.mechanics,
        **asdict(plan.time),
    }
    if plan.adaptive:
        head["adaptive"] = asdict(plan.adaptive)
    runs = ",\n  ".join(json.dumps(asdict(run)) for run in plan.runs)
    text = json.dumps(head, indent=1)[:-2] + f',\n "runs": [\n  {runs}\n ]\n}}\n'
    write_result(path, text, plan=plan.digest)


def read_plan(path: str | Path) -> Plan:
    """The plan in `nodes.json`; raises `fpm.sealed.DamagedError` unless it is as it was written."""
    content = Path(path).read_bytes()
    check_content(path, content, "nodes.json")
    data = json.loads(content)
    return Plan(
        from_data(Experiment, data["config"]),
        data["mechanics"],
        TimeStep(**{name: data[name] for name in TimeStep.__dataclass_fields__}),
        tuple(Run(r["id"], r["role"], tuple(r["unit"]), tuple(r["values"])) for r in data["runs"]),
        from_data(Rounds, data["adaptive"]) if "adaptive" in data else None,
    )
