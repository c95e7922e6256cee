"""Splines through all runs, attained: where a vibration gets out of step over the box."""

from .model import MAX_RUNS, SplineModel, check_spline_runs
from .search import spline_range, spread_points
from .spline import Spline, fit_spline

__all__ = [
    "MAX_RUNS",
    "Spline",
    "SplineModel",
    "check_spline_runs",
    "fit_spline",
    "spline_range",
    "spread_points",
]
