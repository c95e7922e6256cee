"""The reference of a level: a dense scan, and rounds of runs sought where its bounds still grow."""

from deployable import intervals
from evidence.tradeoff.measure.bounds import distance, hull
from evidence.tradeoff.measure.cases import Case, Level
from evidence.tradeoff.measure.points import scan_of
from evidence.tradeoff.measure.runs import Runs, simulate

SEEK = 400
"""Runs of one round."""


def seek_runs(level: Level, runs: Runs) -> tuple[Runs, list[Runs]]:
    """The runs with those of the level's rounds, and what there was after each round."""
    rounds = [runs]
    for seed in range(level.rounds):
        last = rounds[-1]
        options = {"candidates": 8192, "seed": seed + 1}
        points, _ = intervals.seek_points(last.points, last.values, SEEK, **options)
        if not len(points):
            break
        rounds.append(last.with_runs(simulate(last.case, level.elements, level.safety, points)))
    return rounds[-1], rounds


def missing(case: Case, level: Level, rounds: list[Runs], phases: dict) -> list[dict]:
    """What the reference still misses, for each response and phase, as `distance` gives it.

    After rounds: the growth g of the last one, and of those that did not come: g q / (1 - q) if the
    growth goes on to fall by q = g / (growth of the round before), q from 0.5 to 0.95. Without
    rounds: the growth from half the scan to all of it."""
    last = rounds[-1]
    if len(rounds) < 3:
        half = scan_of(case, level.scan)
        half = half[::2] if len(case.intervals) == 1 else half[: len(half) // 2]
        rows = intervals.match_points(half, last.points)
        return distance(last.time, hull(last, rows), hull(last), phases)
    first, second, third = map(hull, rounds[-3:])
    previous = distance(last.time, first, second, phases)
    current = distance(last.time, second, third, phases)
    return [
        {phase: _rest(b[phase], n[phase]) for phase in phases}
        for b, n in zip(previous, current, strict=True)
    ]


def _rest(previous: dict[str, float], current: dict[str, float]) -> dict[str, float]:
    key = "hausdorff_integrated"
    ratio = current[key] / previous[key] if previous[key] > 0 else 0.5
    ratio = min(max(ratio, 0.5), 0.95)
    return {key: current[key] * ratio / (1.0 - ratio)}
