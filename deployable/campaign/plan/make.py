"""From an experiment to its plan: points of the design, names of the runs, one time step."""

from __future__ import annotations

import math

import numpy as np

from deployable.campaign.config.design import make_design, steps_problems
from deployable.campaign.config.sections import Experiment
from deployable.campaign.errors import CampaignError
from deployable.campaign.plan.plan import Plan, TimeStep
from deployable.campaign.plan.runs import ROLES, Runs, namer, values_of


def make_plan(experiment: Experiment, time: TimeStep | None = None) -> Plan:
    """The plan of a checked experiment; time: the step, where it is known already."""
    from deployable.intervals import held_out_points

    box = experiment.box
    design = make_design(experiment.design, box)
    parts = [("nominal", box.to_unit(experiment.nominal)[None]), ("node", design.points)]
    if experiment.design.method != "scan":
        points = held_out_points(box.free, experiment.held_out, design.points)
        parts.append(("held_out", points))

    time, mechanics = time or choose_step(experiment), experiment.scene_type.digest
    unit = np.concatenate([points for _, points in parts])
    role = np.repeat([ROLES.index(role) for role, _ in parts], [len(p) for _, p in parts])
    name = namer(experiment, time.step, mechanics)
    role = role.astype(np.int8)
    runs = Runs(role, unit, values_of(experiment, role, unit), name)
    return Plan(experiment, mechanics, time, runs)


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
