"""Numbers of runs over the box: a peak, the time of an event. One surrogate each, from all runs.

A number is smooth in the parameters where curves are not, and has no time of its own: it is fitted
directly. Where what it is of does not happen in a run, that run has none (NaN)."""

from .climb import Climb
from .fits import Fit, choose_fit
from .occurrence import FittedOccurrence, Occurrence
from .requirements import (
    Choice,
    ChoiceProblem,
    EventLimit,
    Goal,
    Limit,
    find_halving,
    find_least_scales,
    find_max_scale,
    share_of_box,
    shares_of_box,
    sub_box,
)
from .search import NEAREST, TOLERANCE, BoundEstimate, estimate_bounds
from .surrogate import (
    Extremes,
    Influence,
    ScalarSurrogate,
    extreme,
    find_influence,
    fit_scalar,
    share_borders,
)
