"""Ratios less one, as margins are, of what is smooth: fitted by something that is smooth, too.

m = d/r - 1 with d, r >= 0 grows without end where r vanishes, and polynomials follow it badly. The
share h = r/(r + d) = 1/(2 + m), from 0 to 1, does not: its denominator vanishes nowhere. It falls
with m, so that its bounds are those of m, each of the other side, and its error is one at either.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .estimates import ErrorEstimate
from .ranges import Range
from .samples import Samples

SMALLEST = 1e-3
"""Least share that is told apart from none: a ratio of a thousand."""


def shares_of(samples: Samples) -> Samples:
    """Samples with the shares of those responses that are ratios."""
    out = replace(samples)
    values = samples.values
    with np.errstate(divide="ignore"):
        shares = 1.0 / (2.0 + values)
    out.__dict__["values"] = np.where(samples.ratios[:, None], shares, values)
    return out


def ratios_of(samples: Samples, found: Range, error: ErrorEstimate) -> tuple[Range, ErrorEstimate]:
    """The range (n, T) of ratios, and its error, from that of their shares."""
    its, own = samples.ratios[:, None], samples.ratios[:, None, None]
    ends = (found.upper, found.lower, found.inner_upper, found.inner_lower)
    old = (found.lower, found.upper, found.inner_lower, found.inner_upper)
    swapped = [np.where(its, ratio(end), was) for end, was in zip(ends, old, strict=True)]
    places = [
        np.where(own, one, other)
        for one, other in ((found.argmax, found.argmin), (found.argmin, found.argmax))
    ]

    def at_ends(off: np.ndarray) -> np.ndarray:
        sides = ((found.inner_upper, 1.0), (found.inner_lower, -1.0))
        missed = [np.abs(ratio(end + way * off) - ratio(end)) for end, way in sides]
        return np.where(its, np.maximum(*missed), off)

    errors = (at_ends(off) for off in (error.total, error.held_out, error.decay))
    return Range(*swapped, *places), ErrorEstimate(*errors)


def ratio(share: np.ndarray) -> np.ndarray:
    """The ratio less one of which something is the share."""
    return 1.0 / np.clip(share, SMALLEST, 1.0) - 2.0
