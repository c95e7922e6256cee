"""Interval analysis of responses with uncertain parameters: boxes, designs, surrogates, bounds.

Given a box of interval parameters, `make_design` says where to run the model, `fit` turns its
responses into polynomials, and `surrogate_range` or `bounds_dataset` bound them at every instant.
The package knows nothing of the model: it takes arrays, or netCDF files as datasets.
"""

from .bounds import bounds_dataset
from .box import Box
from .budget import add_errors
from .designs import METHODS, Design, SplitDesign, make_design, split_design
from .errors import IntervalError
from .metrics import compare_bounds, compare_runs, hausdorff
from .models import MODELS, Model
from .models.polynomial import surrogate_dataset
from .models.spline import MAX_RUNS, Spline, check_spline_runs, fit_spline, spline_range
from .points import held_out_points, match_points
from .ranges import Range, surrogate_range
from .rounds import (
    Decision,
    Places,
    Progress,
    Specification,
    decide,
    deciding_places,
    measure_round,
    seek_points,
)
from .sensitivity import parameter_sensitivity, sensitivity_dataset
from .surrogate import Surrogate, fit, fit_points

__all__ = [
    "MAX_RUNS",
    "METHODS",
    "MODELS",
    "Box",
    "Decision",
    "Design",
    "IntervalError",
    "Model",
    "Places",
    "Progress",
    "Range",
    "Specification",
    "Spline",
    "SplitDesign",
    "Surrogate",
    "add_errors",
    "bounds_dataset",
    "check_spline_runs",
    "compare_bounds",
    "compare_runs",
    "decide",
    "deciding_places",
    "fit",
    "fit_points",
    "fit_spline",
    "hausdorff",
    "held_out_points",
    "make_design",
    "match_points",
    "measure_round",
    "parameter_sensitivity",
    "seek_points",
    "sensitivity_dataset",
    "spline_range",
    "split_design",
    "surrogate_dataset",
    "surrogate_range",
]
