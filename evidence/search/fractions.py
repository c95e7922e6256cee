"""Volume fractions of boxes that are known: in which part of a box an event happens or a limit is
met, beside planes, balls, corners and curved surfaces, of one to six parameters; known by margins,
by levels, by times, and only by whether it happens."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
import scipy

from deployable.intervals.designs import scan_points
from deployable.intervals.scalars import Limit, fit_scalar, share_of_box
from evidence.results import Report, table
from evidence.rows import at_least, at_most

DIMENSIONS, TYPES = (1, 2, 3, 4, 6), ("happens", "margin", "level", "time")
RUNS = 20  # for each parameter
_POINTS = 2**18  # of a Sobol sequence, for true fractions
_FLOOR, _LEAST = 5e-4, 1e-3  # errors of true fractions; errors whose size should be told

Margin = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class FractionCheck:
    """A volume fraction: true, estimated and how uncertain it is said to be."""

    name: str
    true: float
    estimate: float
    uncertainty: float

    @property
    def error(self) -> float:
        """Distance of the estimate from the true fraction."""
        return abs(self.estimate - self.true)


def make_margins(k: int, generator: np.random.Generator) -> dict[str, Margin]:
    """Functions of unit points (P, k) that are above 0 in a part of the box, by its shape."""
    axis = generator.normal(size=k)
    axis /= np.linalg.norm(axis)
    level, centre = generator.uniform(-0.3, 0.5), generator.uniform(-0.6, 0.6, k)
    radius = 0.75 * generator.uniform(0.7, 1.0) * np.sqrt(k)

    def plane(u: np.ndarray) -> np.ndarray:
        return u @ axis + level

    return {
        "plane": plane,
        "ball": lambda u: radius - np.linalg.norm(u - centre, axis=1),
        "corner": lambda u: np.minimum(plane(u) + 0.3, 1 - 0.5 * u[:, 0] - 0.2 * u[:, -1] - level),
        "curved": lambda u: plane(u) + 0.35 * np.sin(2 * u @ np.roll(axis, 1)) - 0.2 * u[:, 0] ** 2,
    }


def check_fraction(name: str, k: int, margin: Margin, kind: str) -> FractionCheck:
    """Estimate a fraction by twenty runs for each parameter, spread over the box. kind: of what
    tells it, one of `TYPES`."""
    free = np.ones(k, bool)
    points = np.concatenate([np.zeros((1, k)), scan_points(free, RUNS * k - 1)])
    margins = margin(points)
    values = np.where(margins > 0, 2 - 0.5 * np.sqrt(np.maximum(margins, 0.0)), np.nan)
    if kind == "happens":
        values = np.where(margins > 0, 1 + 0.1 * points[:, 0], np.nan)
    if kind == "level":
        limit = Limit(fit_scalar(points, margins), "at_least", 0.0)
    else:
        surrogate = fit_scalar(
            points, values, 10.0 if kind == "time" else None,
            margin=margins if kind == "margin" else None,
        )  # fmt: skip
        limit = Limit(surrogate, "happens", 1.0)
    draws = 2 * scipy.stats.qmc.Sobol(k, seed=1).random(_POINTS) - 1
    return FractionCheck(name, float((margin(draws) > 0).mean()), *share_of_box([limit], free))


def measure_fractions(quick: bool = False) -> list[FractionCheck]:
    """Estimate all fractions; those of two parameters with `quick`."""
    return [
        check_fraction(f"{shape} of {k}, {kind}", k, margin, kind)
        for k in ((2,) if quick else DIMENSIONS)
        for number, kind in enumerate(TYPES)
        for shape, margin in make_margins(k, np.random.default_rng(10 * k + number)).items()
    ]


def report_fractions(checks: list[FractionCheck]) -> Report:
    """What is asked of the uncertainty of volume fractions, and all of them as a table."""
    coverage = [c.error <= c.uncertainty + _FLOOR for c in checks]
    ratios = [c.uncertainty / c.error for c in checks if c.error > _LEAST]
    rows = [
        at_least("true fractions within the uncertainty", float(np.mean(coverage)), 0.95),
        at_most("uncertainty over the true error (median)", float(np.median(ratios)), 3.0),
    ]
    lines = [(c.name, *(100 * x for x in (c.true, c.error, c.uncertainty))) for c in checks]
    header = ("part of the box", "true (%)", "off (%)", "uncertainty (%)")
    text = "\n## Volume fractions\n\nIn percent of the box.\n\n" + table(header, lines)
    return Report(rows, {"fractions": [asdict(c) for c in checks]}, text)
