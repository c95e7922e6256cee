"""Which parameter widens a number's interval, and what knowing it better would save."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .surrogate import ScalarSurrogate


@dataclass(frozen=True)
class Influence:
    """Of each parameter (k): `alone`, the width of the range when only it varies; `share`, that as
    a share of the sum, 0 where it is not above the error of the fit; `fixed` and `halved`, the
    width of the range over the whole box but for this parameter, which keeps its nominal value, or
    whose interval is half as wide about it. `width`: that of the whole box.
    """

    width: float
    alone: np.ndarray
    share: np.ndarray
    fixed: np.ndarray
    halved: np.ndarray


def influence(surrogate: ScalarSurrogate, nominal: np.ndarray) -> Influence:
    """Influence of the parameters on a number, by the trend of its surrogate; `nominal` (k) in unit
    coordinates.

    No run is needed beyond those that were fitted.
    """
    surrogate = surrogate.trend
    nominal = np.asarray(nominal, dtype=float)
    k = len(nominal)
    ones = np.ones(k)
    alone, fixed, halved = np.zeros((3, k))
    for j in range(k):
        lower, upper = nominal.copy(), nominal.copy()
        lower[j], upper[j] = -1.0, 1.0
        alone[j] = surrogate.range(lower, upper).width
        for out, part in ((fixed, 0.0), (halved, 0.5)):
            lower, upper = -ones, ones.copy()
            lower[j] = nominal[j] + part * (-1.0 - nominal[j])
            upper[j] = nominal[j] + part * (1.0 - nominal[j])
            out[j] = surrogate.range(lower, upper).width
    told = np.where(alone > surrogate.error, alone, 0.0)
    share = told / (told.sum() or 1.0)
    return Influence(surrogate.range().width, alone, share, fixed, halved)
