"""The plan of a campaign: which runs there are, known by their parameter values.

The plan is a plain dict, written as `nodes.json`:

    campaign, config_hash, config   the sections of the config that decide the runs
    names, lower, upper, nominal    the box, in the parameters' units (k)
    step, step_limit (s), limiting_element, steps_per_instant, data_version
    runs    [{id, role, unit (k), values (k)}], role is node, nominal or held_out

A run that serves two roles is listed twice, with the same id, and simulated once.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from campaign.config import RUN_SECTIONS, config_hash, digest
from campaign.files import write_text
from campaign.parameters import Interval, all_parameters, intervals_of

# Options of a config's design that each method takes.
_OPTIONS = {"total_degree": ("oversampling", "existing"), "scan": ("samples", "seed", "sequence")}


def box_of(intervals: Mapping[str, Interval]) -> Any:
    """The `intervals.Box` of a config's intervals."""
    from intervals import Box

    rows = intervals.values()
    return Box(list(intervals), [i.lower for i in rows], [i.upper for i in rows])


def make_design(config: Mapping, intervals: Mapping[str, Interval]) -> Any:
    """The `intervals.Design` that a config asks for; raises `intervals.IntervalError`.

    Besides a config's keys, `design` may have what an adaptive campaign settles: `order` for each
    direction, `parts` of the box (a `SplitDesign`), and `existing` points that are run already.
    """
    import intervals as interval_side

    design = config["design"]
    options = {key: design[key] for key in _OPTIONS.get(design["method"], ()) if key in design}
    box = box_of(intervals)
    made = interval_side.make_design(design["method"], box, design["order"], **options)
    if design.get("parts"):
        return interval_side.split_design(made, design["parts"])
    return made


def count_runs(config: Mapping) -> int:
    """Number of runs of the campaign, at most; those in two roles are counted twice."""
    import fpm

    design = config["design"]
    if design["method"] == "scan":  # its points take a while to make, and their number is known
        return design["samples"] + 1
    if design["order"] == "auto":
        return design["budget"] + 1 + config["held_out"]
    intervals, _ = intervals_of(config, fpm.scenes.get(config["scene"]["name"]))
    return make_design(config, intervals).runs + 1 + config["held_out"]


def make_plan(config: Mapping, tested: Sequence[Sequence[float]] = ()) -> dict:
    """The plan of a checked config (see the module's text).

    `tested` are unit coordinates of further runs that test the surrogate; those at points of the
    design are left out.
    """
    import fpm
    from intervals import held_out_points

    scene_type = fpm.scenes.get(config["scene"]["name"])
    intervals, _ = intervals_of(config, scene_type)
    box = box_of(intervals)
    design = make_design(config, intervals)
    nominal = [interval.nominal for interval in intervals.values()]

    rows = [("nominal", box.to_unit(nominal), nominal)]
    rows += [("node", unit, box.from_unit(unit)) for unit in design.points]
    if config["design"]["method"] != "scan":
        points = held_out_points(box.free, config["held_out"], design.points)
        nodes = {tuple(point) for point in design.points.tolist()}
        points = [*points, *(point for point in tested if tuple(point) not in nodes)]
        rows += [("held_out", unit, box.from_unit(unit)) for unit in points]

    step = choose_step(config, scene_type, box)
    runs = []
    for role, unit, values in rows:
        named = dict(zip(box.names, map(float, values), strict=True))
        parameters = all_parameters(config, scene_type, named)
        runs.append(
            {
                "id": run_id(config, parameters, step["step"], fpm.DATA_VERSION),
                "role": role,
                "unit": [float(u) for u in unit],
                "values": list(named.values()),
            }
        )
    return {
        "campaign": config["campaign"],
        "config_hash": config_hash(config, RUN_SECTIONS),
        "config": {key: config[key] for key in RUN_SECTIONS},
        "data_version": fpm.DATA_VERSION,
        "names": list(box.names),
        "lower": box.lower.tolist(),
        "upper": box.upper.tolist(),
        "nominal": nominal,
        **step,
        "runs": runs,
    }


def run_id(config: Mapping, parameters: Mapping, step: float, data_version: Any) -> str:
    """The name of a run: a digest of all that its motion depends on."""
    solver = config["solver"]
    return digest(
        {
            "scene": config["scene"]["name"],
            "parameters": {
                name: float(value) if type(value) is int else value
                for name, value in parameters.items()
            },
            "duration": float(solver["duration"]),
            "instants": solver["instants"],
            "step": step,
            "energy_tolerance": float(solver["energy_tolerance"]),
            "data_version": data_version,
        }
    )


def choose_step(config: Mapping, scene_type: Any, box: Any) -> dict:
    """One time step for all runs: stable at the centre and at every corner of the box, times the
    safety, then shortened until the recording interval is a whole number of steps (s)."""
    import numpy as np

    import fpm

    solver = config["solver"]
    limit, element = math.inf, ""
    for unit in np.vstack([np.zeros((1, box.dimension)), box.corners()]):
        named = dict(zip(box.names, map(float, box.from_unit(unit)), strict=True))
        stable = fpm.stable_step(scene_type.build(**all_parameters(config, scene_type, named)))
        if stable.step < limit:
            limit, element = float(stable.step), str(stable.element)
    wanted = solver["safety"] * limit if solver["step"] == "auto" else float(solver["step"])
    division = fpm.divide_time(solver["duration"], solver["instants"], wanted)
    return {
        "step": division.step,
        "steps_per_instant": division.per_instant,
        "step_limit": limit,
        "limiting_element": element,
    }


def unique_runs(plan: Mapping) -> list[dict]:
    """The runs of the plan, each id once, in their order."""
    unique: dict[str, dict] = {}
    for run in plan["runs"]:
        unique.setdefault(run["id"], run)
    return list(unique.values())


def share(items: list, part: int, parts: int) -> list:
    """Part `part` of `items` split evenly, in order, into `parts`."""
    return items[len(items) * part // parts : len(items) * (part + 1) // parts]


def write_plan(plan: Mapping, path: str | Path) -> None:
    """Write `nodes.json`; one run a line, so that it can be read and compared."""
    head = {key: value for key, value in plan.items() if key != "runs"}
    runs = ",\n  ".join(json.dumps(run) for run in plan["runs"])
    text = json.dumps(head, indent=1)[:-2] + f',\n "runs": [\n  {runs}\n ]\n}}\n'
    write_text(path, text)


def read_plan(path: str | Path) -> dict:
    """The plan in `nodes.json`."""
    return json.loads(Path(path).read_text(encoding="utf-8"))
