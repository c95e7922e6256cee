"""Interval analysis of responses with uncertain parameters: boxes, designs, surrogates, bounds.

Given a box of interval parameters, `make_design` says where to run the model, `fit` turns its
responses into polynomials, and `find_surrogate_range` or `bounds_dataset` bound them at every
instant. The package knows nothing of the model: it takes arrays, or netCDF files as datasets."""

from .bounds import add_errors, bounds_dataset, hausdorff, include_runs
from .box import Box, held_out_points, match_points
from .chebyshev import Surrogate
from .designs import METHODS, Design, fit, make_design
from .errors import IntervalError
from .models import MODELS, Model
from .ranges import Range, find_surrogate_range
from .rounds import BoundPoints, choose_bound_points, seek_points
from .samples import RunBounds, add_runs
from .sensitivity import sensitivity_dataset, surrogate_dataset
from .spline_extremes import spline_range
from .splines import MAX_RUNS, Spline, check_spline_runs, fit_spline
