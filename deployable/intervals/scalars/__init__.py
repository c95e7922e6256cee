"""Numbers of runs over the box: a peak, the time of an event. One surrogate each, from all runs.

A number is smooth in the parameters where curves are not, and has no time of its own: it is fitted
directly. Where what it is of does not happen in a run, that run has none (NaN).
"""

from .choice import Choice, Goal, best_choice
from .extremes import Extremes, extremes
from .fits import Fit, best_fit
from .influence import Influence, influence
from .occurrence import Occurrence
from .requirements import Limit, largest_share, share_of_box, share_reaching, sub_box
from .surrogate import ScalarSurrogate, fit_scalar

__all__ = [
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
    "extremes",
    "fit_scalar",
    "influence",
    "largest_share",
    "share_of_box",
    "share_reaching",
    "sub_box",
]
