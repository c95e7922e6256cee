"""Interval analysis of responses with uncertain parameters: boxes, designs, surrogates, bounds.

Given a box of interval parameters, `make_design` says where to run the model, `fit` turns its
responses into polynomials, and `surrogate_range` or `bounds_dataset` bound them at every instant.
The package knows nothing of the model: it takes arrays, or netCDF files as datasets.
"""

from .adaptive import Decision, Progress, Specification, decide, measure_round
from .bounds import bounds_dataset
from .box import Box
from .datasets import match_points
from .designs import METHODS, Design, make_design
from .errors import error_estimate
from .events import event_bounds_dataset
from .exceptions import IntervalError
from .metrics import compare_bounds, compare_runs, hausdorff
from .partition import SplitDesign, split_design
from .ranges import Range, surrogate_range
from .scan_bounds import RunningBounds, scan_bounds_dataset, stream_bounds
from .scans import held_out_points
from .seek import seek_points
from .sensitivity import parameter_sensitivity, sensitivity_dataset
from .spline_bounds import MAX_RUNS, check_spline_runs, spline_bounds_dataset
from .splines import Spline, fit_spline, spline_range
from .surrogate import Surrogate, fit, fit_points
from .surrogate_dataset import surrogate_dataset

__all__ = [
    "MAX_RUNS",
    "METHODS",
    "Box",
    "Decision",
    "Design",
    "IntervalError",
    "Progress",
    "Range",
    "RunningBounds",
    "Specification",
    "Spline",
    "SplitDesign",
    "Surrogate",
    "bounds_dataset",
    "check_spline_runs",
    "compare_bounds",
    "compare_runs",
    "decide",
    "error_estimate",
    "event_bounds_dataset",
    "fit",
    "fit_points",
    "fit_spline",
    "hausdorff",
    "held_out_points",
    "make_design",
    "match_points",
    "measure_round",
    "parameter_sensitivity",
    "scan_bounds_dataset",
    "seek_points",
    "sensitivity_dataset",
    "spline_bounds_dataset",
    "spline_range",
    "split_design",
    "stream_bounds",
    "surrogate_dataset",
    "surrogate_range",
]
