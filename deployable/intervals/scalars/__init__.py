"""Numbers of runs over the box: a peak, the time of an event. One surrogate each, from all runs.

A number is smooth in the parameters where curves are not, and has no time of its own: it is fitted
directly. Where what it is of does not happen in a run, that run has none (NaN)."""

from .fits import Fit, best_fit
from .occurrence import Occurrence
from .requirements import (
    Choice,
    Goal,
    Limit,
    best_choice,
    find_max_scale,
    least_scales,
    safe_range,
    safest_choice,
    share_of_box,
    sub_box,
)
from .search import NEAREST, TOLERANCE, BoundEstimate, estimate_bounds
from .surrogate import Extremes, Influence, ScalarSurrogate, extremes, fit_scalar, influence

__all__ = [
    "NEAREST",
    "TOLERANCE",
    "BoundEstimate",
    "Choice",
    "Extremes",
    "Fit",
    "Goal",
    "Influence",
    "Limit",
    "Occurrence",
    "ScalarSurrogate",
    "best_choice",
    "best_fit",
    "estimate_bounds",
    "extremes",
    "find_max_scale",
    "fit_scalar",
    "influence",
    "least_scales",
    "safe_range",
    "safest_choice",
    "share_of_box",
    "sub_box",
]
