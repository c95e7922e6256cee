"""From an experiment to its plan: points of the design, names of the runs, one time step."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from campaign.config.design import make_design, steps_problems
from campaign.config.sections import Experiment, digest
from campaign.errors import CampaignError
from campaign.plan.plan import Plan, Run, TimeStep


def make_plan(experiment: Experiment, tested: Sequence[Sequence[float]] = ()) -> Plan:
    """The plan of a checked experiment.

    `tested` are unit coordinates of further runs that test the surrogate; those at points of the
    design are left out.
    """
    from intervals import held_out_points

    box = experiment.box
    design = make_design(experiment.design, box)
    nominal = experiment.nominal
    rows = [("nominal", box.to_unit(nominal), nominal)]
    rows += [("node", unit, box.from_unit(unit)) for unit in design.points]
    if experiment.design.method != "scan":
        points = held_out_points(box.free, experiment.held_out, design.points)
        nodes = {tuple(point) for point in design.points.tolist()}
        points = [*points, *(point for point in tested if tuple(point) not in nodes)]
        rows += [("held_out", unit, box.from_unit(unit)) for unit in points]

    time, mechanics = choose_step(experiment), experiment.scene_type.digest
    runs = []
    for role, unit, row in rows:
        values = tuple(map(float, row))
        parameters = experiment.parameters(dict(zip(box.names, values, strict=True)))
        name = run_id(experiment, parameters, time.step, mechanics)
        runs.append(Run(name, role, tuple(map(float, unit)), values))
    return Plan(experiment, mechanics, time, tuple(runs))


def run_id(experiment: Experiment, parameters: Mapping, step: float, mechanics: str) -> str:
    """The name of a run: a digest of all that its motion depends on."""
    return digest(
        {
            "scene": experiment.scene.name,
            "parameters": {
                name: float(value) if type(value) is int else value
                for name, value in parameters.items()
            },
            "duration": experiment.solver.duration,
            "instants": experiment.solver.instants,
            "step": step,
            "energy_tolerance": experiment.solver.energy_tolerance,
            "mechanics": mechanics,
        }
    )


def choose_step(experiment: Experiment) -> TimeStep:
    """One time step for all runs: stable at the centre and at every corner of the box, times the
    safety, then shortened until the recording interval is a whole number of steps (s)."""
    import fpm

    solver, box = experiment.solver, experiment.box
    limit, element, energy = math.inf, "", 0.0
    for unit in np.vstack([np.zeros((1, box.dimension)), box.corners()]):
        named = dict(zip(box.names, map(float, box.from_unit(unit)), strict=True))
        scene = experiment.build(named)
        stable = fpm.stable_step(scene)
        if stable.step < limit:
            limit, element = float(stable.step), str(stable.element)
        if scene.assembly is not None:
            energy = max(energy, scene.assembly.energy)
    wanted = solver.safety * limit if solver.step == "auto" else solver.step
    for problem in steps_problems(solver, wanted):
        raise CampaignError(problem)
    division = fpm.divide_time(solver.duration, solver.instants, wanted)
    return TimeStep(division.step, division.per_instant, limit, element, energy)
