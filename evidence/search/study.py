"""The study of the search for bounds of quantities: boxes whose bounds are known."""

import itertools
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np

from deployable.campaign.answers.evaluations import ModelEvaluator
from deployable.campaign.answers.quantity_bounds import QuantityBounds, converge_bounds
from deployable.intervals.box import Box as ParameterBox
from deployable.intervals.box import corner_points
from deployable.intervals.designs import scan_points
from evidence.results import Report, table
from evidence.rows import Row, at_least, at_most
from evidence.search import mechanisms
from evidence.search.boxes import BOXES, Box
from evidence.search.fractions import measure_fractions, report_fractions
from evidence.search.rivals import CLOSE, rival_runs

ITERATIONS = 6  # as `verify.max_iterations`
FLOOR = 0.002  # fraction of the width that is added to every error
MOST_RATIO = 1.5  # of the runs to those of the best rival


@dataclass(frozen=True)
class BoxCheck:
    """The bounds of a box: true, reported, of the runs and their errors (2 each), and the runs.
    search_runs: number of runs after which both bounds were close and stayed so, else infinite."""

    name: str
    runs: int
    true: tuple[float, float]
    outer_bounds: tuple[float, float]
    attained: tuple[float, float]
    errors: tuple[float, float]
    search_runs: float = np.nan

    @property
    def width(self) -> float:
        """Width of the true bounds."""
        return self.true[1] - self.true[0]

    def misses(self) -> np.ndarray:
        """Distances (2) of the reported bounds from the true ones."""
        return np.abs(np.subtract(self.outer_bounds, self.true))


class _BoxEvaluator(ModelEvaluator):
    """Evaluations of a function in place of runs, from a design of 4 k points."""

    def __init__(self, box: Box):
        k = box.dimension
        quantity = SimpleNamespace(is_time=box.is_time, least=None)
        sides = ParameterBox(tuple(f"u{j}" for j in range(k)), -np.ones(k), np.ones(k))
        experiment = SimpleNamespace(
            quantity_list=[quantity], box=sides, solver=SimpleNamespace(duration=10.0)
        )
        self.plan, self.function = SimpleNamespace(experiment=experiment), box.function
        corners = corner_points(sides.free) if k <= 3 else np.zeros((0, k))
        spread = scan_points(sides.free, 4 * k - 1 - len(corners), corners=False)
        self.points = np.concatenate([np.zeros((1, k)), corners, spread])
        self.numbers, self.margins = self.evaluate(self.plan, self.points)

    refinements = ()

    def evaluate(self, plan: Any, points: Any) -> tuple[np.ndarray, np.ndarray]:
        """Values and margins (P, 1) at unit points (P, k)."""
        values, margins = self.function(np.asarray(points, dtype=float))
        return values[:, None], margins[:, None]

    def add(self, points: Any) -> np.ndarray:
        """Evaluate at unit points (P, k), each once; returns the run (P) at each."""
        for point in points:
            if self.nearest(point)[1] > 1e-6:
                values, margins = self.evaluate(self.plan, [point])
                self.points = np.vstack([self.points, point])
                self.numbers = np.vstack([self.numbers, values])
                self.margins = np.vstack([self.margins, margins])
        return np.array([self.nearest(point)[0] for point in points], dtype=int)


def find_bounds(box: Box) -> tuple[QuantityBounds, np.ndarray]:
    """Bounds of a box, sought as a campaign does, and the values (R) of all runs in their order."""
    model = _BoxEvaluator(box)
    (bounds,) = converge_bounds(model, ITERATIONS)
    return bounds, model.numbers[:, 0]


def search(box: Box) -> BoxCheck:
    """Search the bounds of a box, and compare them with the true ones."""
    bounds, values = find_bounds(box)
    errors = tuple(max(e.error, bounds.surrogate.bound_error) for e in bounds.estimates)
    attained, true, count = (bounds.lower, bounds.upper), box.true_bounds(), len(values)
    check = BoxCheck(box.name, count, true, bounds.outer, attained, errors)
    close = np.abs(np.subtract.outer(true, values)) <= CLOSE * check.width  # (2, R)
    counts = np.where(close.any(axis=1), close.argmax(axis=1) + 1.0, count)
    is_found = (check.misses() <= CLOSE * check.width).all()
    return replace(check, search_runs=float(counts.max()) if is_found else np.inf)


def measure_all(quick: bool = False) -> list[BoxCheck]:
    """Search all boxes; some with `quick`."""
    return [search(box) for box in (BOXES[:3] if quick else BOXES)]


def measure_rivals(quick: bool = False) -> list[dict[str, float]]:
    """Runs of other searches on all boxes; on some with `quick`."""
    return [rival_runs(box, box.true_bounds()) for box in (BOXES[:1] if quick else BOXES)]


PARTS = {
    "boxes": measure_all,
    "rivals": measure_rivals,
    "fractions": measure_fractions,
    **{
        part: partial(mechanisms.measure, f"mechanisms_{part}")
        for part in ("carts", "slides", "chains")
    },
}


def report(parts: Mapping[str, list]) -> Report:
    """What the study claims of functions and of mechanisms, and all as tables."""
    functions = ("boxes", "rivals", "fractions")
    checks = [c for name, part in parts.items() if name not in functions for c in part]
    reports = []
    if "boxes" in parts:
        rivals = [min(runs.values()) for runs in parts.get("rivals", [])]
        reports.append(_report_boxes(parts["boxes"], rivals))
    reports += [report_fractions(parts["fractions"])] if "fractions" in parts else []
    reports += [mechanisms.report(checks)] if checks else []
    return Report(
        [row for part in reports for row in part.rows],
        {key: value for part in reports for key, value in part.extra.items()},
        "".join(part.text for part in reports),
    )


def _report_boxes(boxes: list[BoxCheck], rivals: list[float]) -> Report:
    """What is asked of functions, and all of them as a table. rivals: runs of the best one."""
    coverage = [b.misses() <= np.add(b.errors, FLOOR * b.width) for b in boxes]
    is_close = [miss <= CLOSE * b.width for b in boxes for miss in b.misses()]
    worse = [
        miss > abs(run - true) + 1e-9 * b.width
        for b in boxes
        for miss, run, true in zip(b.misses(), b.attained, b.true, strict=True)
    ]
    rows: list[Row] = [
        at_least("true bounds within the reported error", float(np.mean(coverage)), 0.95),
        at_least(f"bounds within {CLOSE:.0%} of the width", float(np.mean(is_close)), 0.95),
        at_most("reported bounds worse than those of the runs", float(np.sum(worse)), 0.0),
    ]
    ratios = [
        b.search_runs / best for b, best in zip(boxes, rivals, strict=False) if np.isfinite(best)
    ]
    if ratios:
        is_near = [ratio <= MOST_RATIO for ratio in ratios]
        misses = float(np.isinf(ratios).sum())
        rows += [
            at_most("runs until both are, over the best rival's", float(np.median(ratios)), 1.0),
            at_least(f"boxes with at most {MOST_RATIO:g} of that", float(np.mean(is_near)), 0.9),
            at_most("boxes where a rival finds both, and this does not", misses, 0.0),
        ]
    lines = [
        (b.name, b.runs, b.search_runs, rival, *(f"{v:.4g}" for v in (*b.true, *b.outer_bounds)),
         *(100 * b.misses() / b.width), *(100 * np.divide(b.errors, b.width)))
        for b, rival in zip(boxes, rivals or itertools.repeat(np.nan), strict=False)
    ]  # fmt: skip
    header = ("box", "runs", "found after", "best rival", "lower", "upper", "reported lower",
              "reported upper", "off, lower (%)", "off, upper (%)", "error, lower (%)",
              "error, upper (%)")  # fmt: skip
    text = (
        "\n## Boxes\n\nOff, error: of the width. Found after: runs until both are within 1 %.\n\n"
    )
    text += table(header, lines)
    return Report(rows, {"boxes": [asdict(b) for b in boxes]}, text)
