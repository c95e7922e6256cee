"""The study of the search for bounds of quantities: boxes whose bounds are known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from deployable.campaign.answers.evaluations import ModelEvaluator
from deployable.campaign.answers.quantity_bounds import converge_bounds
from deployable.intervals.designs import scan_points
from evidence.results import Report, table
from evidence.rows import Row, at_least, at_most
from evidence.search.boxes import BOXES, Box

ITERATIONS = 6  # as `verify.max_iterations`
FLOOR = 0.002  # fraction of the width that is added to every error
CLOSE = 0.01  # fraction of the width within which a bound is close


@dataclass(frozen=True)
class BoxCheck:
    """The bounds of a box: true, reported, of the runs and their errors (2 each), and the runs."""

    name: str
    runs: int
    true: tuple[float, float]
    outer_bounds: tuple[float, float]
    attained: tuple[float, float]
    errors: tuple[float, float]

    @property
    def width(self) -> float:
        """Width of the true bounds."""
        return self.true[1] - self.true[0]

    def misses(self) -> np.ndarray:
        """Distances (2) of the reported bounds from the true ones."""
        return np.abs(np.subtract(self.outer_bounds, self.true))


class _BoxEvaluator(ModelEvaluator):
    """Evaluations of a function in place of runs, from a design of 8 k points."""

    def __init__(self, box: Box):
        k = box.dimension
        quantity = SimpleNamespace(is_time=box.is_time, least=None)
        sides = SimpleNamespace(free=np.ones(k, bool), from_unit=lambda points: points)
        experiment = SimpleNamespace(
            quantity_list=[quantity], box=sides, solver=SimpleNamespace(duration=10.0)
        )
        self.plan, self.function = SimpleNamespace(experiment=experiment), box.function
        self.points = np.concatenate([np.zeros((1, k)), scan_points(np.ones(k, bool), 8 * k - 1)])
        self.numbers, self.margins = self.evaluate(self.plan, self.points)

    refinements = ()

    def evaluate(self, plan: Any, points: Any) -> tuple[np.ndarray, np.ndarray]:
        """Values and margins (P, 1) at unit points (P, k)."""
        values, margins = self.function(np.asarray(points, dtype=float))
        return values[:, None], margins[:, None]

    def add(self, points: Any) -> None:
        """Evaluate at unit points (P, k), each once."""
        for point in points:
            if self.nearest(point)[1] > 1e-6:
                values, margins = self.evaluate(self.plan, [point])
                self.points = np.vstack([self.points, point])
                self.numbers = np.vstack([self.numbers, values])
                self.margins = np.vstack([self.margins, margins])


def search(box: Box) -> BoxCheck:
    """Search the bounds of a box as a campaign does."""
    model = _BoxEvaluator(box)
    (bounds,) = converge_bounds(model, ITERATIONS)
    errors = tuple(max(e.error, bounds.surrogate.bound_error) for e in bounds.estimates)
    attained = bounds.lower, bounds.upper
    return BoxCheck(box.name, len(model.points), box.true_bounds(), bounds.outer, attained, errors)


def measure_all(quick: bool = False) -> list[BoxCheck]:
    """Search all boxes; some with `quick`."""
    return [search(box) for box in (BOXES[:3] if quick else BOXES)]


PARTS = {"boxes": measure_all}


def report(parts: Mapping[str, list[BoxCheck]]) -> Report:
    """What the study claims, and all boxes as a table."""
    boxes = parts["boxes"]
    coverage = [b.misses() <= np.add(b.errors, FLOOR * b.width) for b in boxes]
    is_close = [miss <= CLOSE * b.width for b in boxes for miss in b.misses()]
    worse = [
        miss > abs(run - true) + 1e-9 * b.width
        for b in boxes
        for miss, run, true in zip(b.misses(), b.attained, b.true, strict=True)
    ]
    rows: list[Row] = [
        at_least("true bounds within the reported error", float(np.mean(coverage)), 0.95),
        at_least(f"bounds within {CLOSE:.0%} of the width", float(np.mean(is_close)), 0.8),
        at_most("reported bounds worse than those of the runs", float(np.sum(worse)), 0.0),
    ]
    lines = [
        (b.name, b.runs, *(f"{v:.4g}" for v in (*b.true, *b.outer_bounds)),
         *(100 * b.misses() / b.width), *(100 * np.divide(b.errors, b.width)))
        for b in boxes
    ]  # fmt: skip
    header = ("box", "runs", "lower", "upper", "reported lower", "reported upper",
              "off, lower (%)", "off, upper (%)", "error, lower (%)",
              "error, upper (%)")  # fmt: skip
    text = "\n## Boxes\n\nOff and error: of the width.\n\n" + table(header, lines)
    return Report(rows, {"boxes": [asdict(b) for b in boxes]}, text)
