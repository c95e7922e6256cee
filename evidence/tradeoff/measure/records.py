"""Error against cost of one case: over mesh, time step, order, design, and lanes.

Two errors are told apart. The surrogate's: bounds against a dense scan of the same level, that is
of the same mesh and step. The total: bounds against the dense scan of the finest level. Errors
of single runs, from mesh and step alone, are measured beside them."""

import math
import time
from collections.abc import Callable
from dataclasses import asdict

import numpy as np

import fpm
from deployable.campaign.config.sections import scene_type
from evidence.tradeoff.measure import bounds
from evidence.tradeoff.measure.cases import Case, Level
from evidence.tradeoff.measure.points import design_of, held_out_of, points_of
from evidence.tradeoff.measure.reference import missing, seek_runs
from evidence.tradeoff.measure.runs import LANES, Runs, simulate


def measure_case(case: Case, notify: Callable[[str], object] = print) -> dict:
    """Everything that the report needs of a case, as plain numbers."""
    levels = []
    for level in case.levels:
        notify(f"{case.name}: {level.label}, {level.scan} runs of the scan and the designs")
        points = points_of(case, level.choices, level.scan)
        runs = simulate(case, level.elements, level.safety, points)
        runs, rounds = seek_runs(level, runs)
        levels.append((level, runs))
    finest_level, finest = levels[-1]
    reference, phases = bounds.hull(finest), bounds.phases_of(finest)
    records = []
    for level, runs in levels:
        notify(f"{case.name}: {level.label}, bounds of {len(level.choices)} choices")
        records += _measure_level(case, level, runs, reference, phases)
    return {
        "case": case.name,
        "title": case.title,
        "responses": list(case.responses),
        "phases": list(phases),
        "reference": {
            "elements": finest_level.elements,
            "runs": len(finest.points),
            "cpu": finest.cost(len(finest.points)),
            "rounds": len(rounds) - 1,
            "missing": missing(case, finest_level, rounds, phases),
        },
        "records": records,
        "trajectories": _measure_trajectories(case, phases, notify),
        "lanes": _measure_lanes(case, case.levels[0]),
    }


def _measure_level(
    case: Case, level: Level, runs: Runs, reference: bounds.Band, phases: dict[str, np.ndarray]
) -> list[dict]:
    hull = bounds.hull(runs) if level.scan else None
    records = []
    for choice in level.choices:
        design = design_of(case, choice)
        tests = held_out_of(case, choice, design)
        band = bounds.take_bounds(choice, design, tests, runs)
        # a spline goes through the held-out runs too
        count = design.run_count + (len(tests) if choice.model == "spline" else 0)
        record = {
            "level": level.label,
            "elements": level.elements,
            "safety": level.safety,
            "step": runs.step,
            "choice": choice.label,
            **asdict(choice),
            "runs": count,
            "held_out": design.run_count + len(tests) - count,
            "cpu": runs.cost(count) + band.cpu,
            "cpu_batch": runs.cpu,
            "cpu_bounds": band.cpu,
            "lanes": LANES,
            "total": bounds.distance(runs.time, band, reference, phases),
        }
        if hull is not None:
            record["surrogate"] = bounds.distance(runs.time, band, hull, phases)
            record["estimate"] = bounds.judge_estimate(runs.time, band, hull, phases)
            record["scan"] = bounds.runs_in_band(band, runs)
        records.append(record)
    return records


def _measure_trajectories(case: Case, phases: dict[str, np.ndarray], notify) -> list[dict]:
    """Error of single runs from mesh and step: rms over LANES runs spread over the box."""
    if not case.trajectories:
        return []
    points = np.linspace(-1.0, 1.0, LANES)[:, None] * np.ones(len(case.intervals))
    all_runs = []
    for elements, safety in case.trajectories:
        notify(f"{case.name}: single runs with {elements} elements, {safety} of the stable step")
        all_runs.append(simulate(case, elements, safety, points))
    # what the step alone does: against the smallest step on the same mesh
    smallest = {}
    for (elements, _), runs in zip(case.trajectories, all_runs, strict=True):
        best = smallest.setdefault(elements, runs)
        smallest[elements] = min(best, runs, key=lambda r: r.step)
    rows = []
    for (elements, safety), runs in zip(case.trajectories, all_runs, strict=True):
        row = {"elements": elements, "safety": safety, "step": runs.step, "cpu": runs.cpu / LANES}
        for key, exact in (("rms", all_runs[-1]), ("rms_step", smallest[elements])):
            errors = runs.values - exact.values
            row[key] = [bounds.rms(errors[:, i], phases) for i in range(errors.shape[1])]
        rows.append(row)
    return rows


def _measure_lanes(case: Case, level: Level) -> list[dict]:
    """Cpu time of 1 and of LANES runs side by side."""
    kind = scene_type(case.scene)
    scene = kind.build(**{case.mesh: level.elements}, **case.fixed)
    rows = []
    for count in (1, LANES):
        best = math.inf
        for _ in range(3):
            start = time.process_time()
            fpm.simulate([scene] * count, duration=case.duration, instants=case.instants)
            best = min(best, time.process_time() - start)
        rows.append({"lanes": count, "cpu": best})
    return rows
