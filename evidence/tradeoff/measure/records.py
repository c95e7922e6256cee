"""Error against cost of one case: over mesh, order and design.

Two errors are told apart. The surrogate's: bounds against a dense scan of the same mesh. The total:
bounds against the dense scan of the finest one."""

from collections.abc import Callable
from dataclasses import asdict

from evidence.tradeoff.measure.bounds import (
    Band,
    distance,
    hull,
    judge_estimate,
    seek_runs,
    take_bounds,
)
from evidence.tradeoff.measure.cases import RESPONSES, Case, Level
from evidence.tradeoff.measure.runs import Runs, design_of, held_out_of, points_of, simulate


def measure_case(case: Case, notify: Callable[[str], object] = print) -> dict:
    """Everything that the report needs of a case, as plain numbers."""
    levels = []
    for level in case.levels:
        notify(f"{case.name}: {level.elements} elements, {level.scan} runs and the designs")
        points = points_of(case, level.choices, level.scan)
        runs, growth = seek_runs(level, simulate(case, level.elements, points))
        levels.append((level, runs))
    reference = hull(runs)
    return {
        "case": case.name,
        "title": case.title,
        "responses": list(RESPONSES),
        "reference": {"elements": level.elements, "runs": len(runs.points), "growth": growth},
        "records": [
            record for level, runs in levels for record in _level(case, level, runs, reference)
        ],
    }


def _level(case: Case, level: Level, runs: Runs, reference: Band) -> list[dict]:
    """What every choice of a level costs and gets wrong."""
    records, level_hull = [], hull(runs)
    for choice in level.choices:
        design = design_of(case, choice)
        tests = held_out_of(case, choice, design)
        band = take_bounds(choice, design, tests, runs)
        # A spline goes through the held-out runs too.
        count = design.run_count + (len(tests) if choice.model == "spline" else 0)
        records.append(
            {
                "elements": level.elements,
                "choice": choice.label,
                "kind": choice.kind,
                **asdict(choice),
                "runs": count,
                "cpu": runs.cost(count) + band.cpu,
                "total": distance(runs.time, band, reference),
                "surrogate": distance(runs.time, band, level_hull),
                "estimate": judge_estimate(runs.time, band, level_hull),
            }
        )
    return records
