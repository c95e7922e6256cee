"""Interval analysis of responses with uncertain parameters: boxes, designs, surrogates, bounds.

Given a box of interval parameters, `make_design` says where to run the model, `fit` turns its
responses into polynomials, and `surrogate_range` or `bounds_dataset` bound them at every instant.
The package knows nothing of the model: it takes arrays, or netCDF files as datasets.
"""

from .bounds import bounds_dataset
from .box import Box
from .datasets import match_points
from .designs import METHODS, Design, make_design
from .errors import error_estimate
from .exceptions import IntervalError
from .ranges import Range, surrogate_range
from .scans import held_out_points
from .surrogate import Surrogate, fit, fit_points

__all__ = [
    "METHODS",
    "Box",
    "Design",
    "IntervalError",
    "Range",
    "Surrogate",
    "bounds_dataset",
    "error_estimate",
    "fit",
    "fit_points",
    "held_out_points",
    "make_design",
    "match_points",
    "surrogate_range",
]
