"""Boxes whose numbers are known in closed form, with errors of step and mesh that are known too: a
`ModelEvaluator` without simulations.

A plan is (step, mesh), each 1 at first and halved; a box tells the numbers and margins (P) of a
plan at unit points (P, k), of which (0, 0) is the truth.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from deployable.campaign.answers import discretization, evaluations, quantity_bounds
from deployable.campaign.answers.evaluations import ModelEvaluator
from deployable.campaign.plan.plan import RunAccount
from deployable.intervals import Box
from deployable.intervals.designs import scan_points

LATEST = 2.0


@dataclass(frozen=True)
class Closed:
    """A number t over a box of `k` directions: `kind` "limit" (it is everywhere), "margin" (it is
    where a margin is above 0, which runs tell), "late" (where it is below LATEST), or "latch"
    (where something is above 0 that runs do not tell). What decides has an error of `error` by the
    means of step and mesh, to the powers of the orders, at one corner, and half at the other."""

    kind: str
    k: int
    seed: int
    error: float
    orders: tuple[int, int] = (2, 2)

    def decides(self, unit, plan):
        rng = np.random.default_rng(self.seed)
        slope = rng.uniform(0.3, 1.0, self.k) * rng.choice([-1, 1], self.k)
        bend, shift = rng.uniform(-0.3, 0.3), rng.uniform(-0.5, 0.5)
        along = unit @ slope / np.abs(slope).sum()
        across = unit @ rng.uniform(-1, 1, self.k) / self.k
        off = sum(size**order for size, order in zip(plan, self.orders, strict=True)) / 2
        sign = rng.choice([-1, 1])
        return (
            along
            + shift
            + bend * np.sin(2 * across + 1)
            + sign * self.error * off * (0.75 + 0.25 * along)
        )

    def told(self, unit, plan):
        decides = self.decides(unit, plan)
        margin = np.full(len(unit), np.nan)
        t = 1.5 - 0.4 * decides + 0.1 * decides**2
        if self.kind == "late":
            t = LATEST * np.exp(-decides)
            t[t > LATEST] = np.nan
        elif self.kind == "margin":
            t, margin = np.where(decides > 0, t, np.nan), decides
        elif self.kind == "latch":
            t = np.where(decides > 0, t, np.nan)
        return t, margin

    def truth(self, kind, level):
        """The share of the box that keeps a limit."""
        unit = scan_points(np.ones(self.k, dtype=bool), 2**16, corners=False)
        t, _ = self.told(unit, (0.0, 0.0))
        there = np.isfinite(t)
        return float((there if kind == "happens" else there & (t <= level)).mean())


class ClosedBench(ModelEvaluator):
    """The evaluator of a closed box, with `count` runs spread over it and its corners."""

    def __init__(self, closed, count):
        box = Box(list("abcdef"[: closed.k]), [0.0] * closed.k, [1.0] * closed.k)
        late = closed.kind == "late"
        number = SimpleNamespace(name="t", unit="s", is_time=late, instant=None,
                                 limits=(-np.inf, np.inf),
                                 kind="crossing" if closed.kind == "margin" else "event",
                                 always_exists=closed.kind == "limit")  # fmt: skip
        if closed.kind == "limit":
            number.kind = "largest"
        self.of, self.plan, self.refinements, self.rest_count = closed, (1.0, 1.0), [], 0
        self.around = SimpleNamespace(
            box=box, quantity_list=[number], quantities={"t": {}}, nominal=np.full(closed.k, 0.5),
            solver=SimpleNamespace(duration=LATEST), intervals={}, name="closed",
        )  # fmt: skip
        self.points = scan_points(np.ones(closed.k, dtype=bool), count)
        self.numbers, self.margins = self.evaluate(self.plan, self.points)
        self.notify, self.account, self.finest_step = lambda text: None, RunAccount(), 1.0

    @property
    def experiment(self):
        return self.around

    def evaluate(self, plan, points):
        return tuple(values[:, None] for values in self.of.told(np.array(points), plan))


class _Point(np.ndarray):
    """A point in the place of its run, which is named by it."""

    def __new__(cls, point):
        return np.asarray(point).view(cls)

    @property
    def id(self):
        return tuple(self.tolist())


def without_runs(monkeypatch):
    """Levels of these plans, no runs, and no expressions that turn back."""
    levels = {
        "step": discretization.RefinementLevel((0.5, 1.0), (0.25, 1.0), True),
        "mesh": discretization.RefinementLevel((0.5, 0.5), (0.5, 2.0), False),
    }
    monkeypatch.setattr(discretization, "_levels", lambda plan, parts, step: levels)
    monkeypatch.setattr(quantity_bounds, "_turning_points", lambda model: [])
    monkeypatch.setattr(evaluations, "runs_at", lambda plan, points: [_Point(p) for p in points])
