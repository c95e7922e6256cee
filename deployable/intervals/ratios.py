"""Ratios less one, as margins are, of what is smooth: fitted by something that is smooth, too.

m = d/r - 1 with d, r >= 0 grows without end where r vanishes, and polynomials follow it badly. The
share h = r/(r + d) = 1/(2 + m), from 0 to 1, does not: its denominator vanishes nowhere. It falls
with m: its bounds are those of m, each of the other side; its error is one at either."""

from dataclasses import replace

import numpy as np

from .estimates import ErrorEstimate
from .ranges import Range
from .samples import Samples

SMALLEST = 1e-3
"""Least share that is told apart from none: a ratio of a thousand."""


def shares_of(samples: Samples) -> Samples:
    """Copy of samples in which each response m that is a ratio less one, as a torque margin d/r -
    1, is replaced by its share 1/(2 + m) = r/(r + d), which is smooth; others stay."""
    share_samples = replace(samples)
    values = samples.values
    with np.errstate(divide="ignore"):
        shares = 1.0 / (2.0 + values)
    share_samples.__dict__["values"] = np.where(samples.ratios[:, None], shares, values)
    return share_samples


def ratios_of(samples: Samples, bounds: Range, error: ErrorEstimate) -> tuple[Range, ErrorEstimate]:
    """Transform back the range and error (n, T) of a fit to `shares_of(samples)`, to those of the
    responses in `samples`: for ratios less one, lower and upper swap; others stay."""
    is_ratio = samples.ratios[:, None]
    ends = (bounds.upper, bounds.lower, bounds.inner_upper, bounds.inner_lower)
    old = (bounds.lower, bounds.upper, bounds.inner_lower, bounds.inner_upper)
    curves = [np.where(is_ratio, ratio(end), curve) for end, curve in zip(ends, old, strict=True)]
    points = [
        np.where(is_ratio[..., None], mirror, point)
        for mirror, point in ((bounds.argmax, bounds.argmin), (bounds.argmin, bounds.argmax))
    ]

    def at_ends(part: np.ndarray) -> np.ndarray:
        sides = ((bounds.inner_upper, 1.0), (bounds.inner_lower, -1.0))
        changes = [np.abs(ratio(end + sign * part) - ratio(end)) for end, sign in sides]
        return np.where(is_ratio, np.maximum(*changes), part)

    errors = (at_ends(part) for part in (error.total, error.held_out, error.decay))
    return Range(*curves, *points), ErrorEstimate(*errors)


def ratio(share: np.ndarray) -> np.ndarray:
    """Convert shares h = 1/(2 + m) (...), from 0 to 1, back to ratios less one m = 1/h - 2 (...);
    shares below 0.001 (SMALLEST) count as that."""
    return 1.0 / np.clip(share, SMALLEST, 1.0) - 2.0
