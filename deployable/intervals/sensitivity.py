"""What a polynomial through runs tells: coefficients, and which parameter widens bounds when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .box import ROUNDING, find_other_runs
from .chebyshev import Surrogate
from .designs import Design, complete_runs, fit
from .estimates import estimate_decay, widen
from .line_range import line_range
from .samples import read_samples

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Sensitivity:
    """Influence of each of k parameters on responses, whose arrays (responses, instants) have the
    shape (...). width (k, ...): exact width of the range when only this parameter varies; first (k,
    ...): fraction of the variance from this parameter alone (Sobol index of first order); total (k,
    ...): fraction from all terms with it (total Sobol index); variance (...): of the response."""

    width: np.ndarray
    first: np.ndarray
    total: np.ndarray
    variance: np.ndarray


def measure_sensitivity(surrogate: Surrogate, centre: np.ndarray | None = None) -> Sensitivity:
    """Compute the influence of each parameter on responses from their polynomial surrogate. centre
    (k): point in [-1, 1]^k through which one parameter at a time varies for the widths; None: the
    middle. The Sobol-like shares (Sudret 2008) are read off the coefficients. They refer to the
    arcsine density, for which Chebyshev polynomials are orthogonal and which weighs ends of
    intervals more than the uniform density: a convention, as intervals have none. They are 0
    without variance."""
    indices, c = surrogate.multi_indices, surrogate.coefficients
    k, shape = surrogate.dimension, c.shape[1:]
    centre = np.zeros(k) if centre is None else np.asarray(centre, dtype=float)
    active = indices > 0
    # the mean square of T_i is 1/2 for i > 0 and 1 for i = 0
    power = c**2 * (0.5 ** active.sum(axis=1)).reshape(-1, *[1] * len(shape))
    variance = power[active.any(axis=1)].sum(axis=0)
    scale = np.where(variance > 0, variance, 1.0)
    width, first, total = np.zeros((3, k, *shape))
    for j in range(k):
        line = surrogate.restrict(j, centre)
        low, high, *_ = line_range(line.reshape(len(line), -1))
        width[j] = (high - low).reshape(shape)
        first[j] = power[active[:, j] & (active.sum(axis=1) == 1)].sum(axis=0) / scale
        total[j] = power[active[:, j]].sum(axis=0) / scale
    return Sensitivity(width, first, total, variance)


def sensitivity_dataset(
    samples: xr.Dataset, design: Design, responses: Sequence[str] | None = None
) -> xr.Dataset:
    """Compute the influence of each parameter on each response, per instant and overall.

    Parameters
    ----------
    samples: runs as in `samples.nc`: ``values`` (run, response, time), ``normalized`` and ``value``
        (run, parameter).
    design: points among the runs, and the polynomials that are fitted to these runs.
    responses: names of the responses that are wanted; None: all.

    Returns
    -------
    xarray.Dataset
        Over (response, parameter, time): ``width``, of the range when only this parameter varies,
        in the response's units, ``first`` and ``total`` Sobol indices, all 0 where the runs differ
        by rounding alone. Over (response, time):
        ``error``, the largest error of the polynomial at runs that it was not fitted to, within a
        short time (without such runs, by the decay of its coefficients): a width that is not above
        it may be the fit's noise. Over (response, parameter): ``width_overall``, the width where it
        is above ``error``, integrated over time, as a fraction of the sum over all parameters, and
        ``total_overall``, the variance-weighted mean of the total indices."""
    import xarray as xr

    data = read_samples(samples, responses)
    values, lost_error = complete_runs(design, data.points, data.values, data.failed_points)
    surrogate = fit(design, values)
    if len(test_rows := find_other_runs(data.points, design.points)):
        residuals = np.abs(data.values[test_rows] - surrogate.evaluate(data.points[test_rows]))
        error = widen(data.time, residuals.max(axis=0)) + lost_error
    else:
        error = estimate_decay(surrogate, data.time) + lost_error
    influence = measure_sensitivity(surrogate)
    arrays = influence.width, influence.first, influence.total
    width, first, total = (np.moveaxis(array, 0, 1) for array in arrays)
    wide, shares = np.zeros((2, *width.shape[:2]))
    for i, variance in enumerate(influence.variance):
        area = np.trapezoid(np.where(width[i] > error[i], width[i], 0.0), data.time)
        weight = np.trapezoid(variance, data.time)
        parts = np.trapezoid(total[i] * variance, data.time)
        wide[i], shares[i] = area / (area.sum() or 1.0), parts / (weight or 1.0)
    # Where runs differ by rounding alone, no parameter contributes anything.
    limit = ROUNDING * np.abs(values).max(axis=(0, 2))[:, None]
    is_blank = (np.ptp(values, axis=0) <= limit)[:, None]
    width, first, total = (np.where(is_blank, 0.0, part) for part in (width, first, total))
    curve, number = ("response", "parameter", "time"), ("response", "parameter")
    share = {"units": "1"}
    variables = {
        "width": (curve, width, "width when only this parameter varies", {}),
        "first": (curve, first, "share of the variance from this parameter alone", share),
        "total": (curve, total, "share of the variance in which this parameter takes part", share),
        "error": (("response", "time"), error, "error at runs that were not fitted", {}),
        "width_overall": (number, wide, "share of the widths above the error", share),
        "total_overall": (number, shares, "mean share of the variance, over all time", share),
    }
    return xr.Dataset(
        {n: (axes, v, {"long_name": t, **a}) for n, (axes, v, t, a) in variables.items()},
        coords=data.coordinates(),
        attrs=samples.attrs,
    )


def surrogate_dataset(samples: xr.Dataset, design: Design) -> xr.Dataset:
    """Compute the Chebyshev coefficients of every response at every instant, as a dataset.

    Parameters
    ----------
    samples: runs as in `samples.nc`: ``values`` (run, response, time), ``normalized`` and ``value``
        (run, parameter).
    design: points among the runs, and the polynomials that are fitted to these runs.

    Returns
    -------
    xarray.Dataset
        ``coefficient`` (response, term, time) in the response's units, ``multi_index`` (term,
        parameter), the degrees of each term. A design without order has no terms and no
        coefficients."""
    import xarray as xr

    data, indices = read_samples(samples), design.multi_indices
    variables: dict[str, tuple] = {
        "multi_index": (("term", "parameter"), indices, {"units": "1", "long_name": "degree"})
    }
    if len(indices):
        runs, _ = complete_runs(design, data.points, data.values, data.failed_points)
        # one response after the other: products of larger matrices round in another way
        values = [fit(design, runs[:, i]).coefficients for i in range(len(data.names))]
        axes = ("response", "term", "time")
        variables["coefficient"] = (axes, values, {"long_name": "Chebyshev coefficients"})
    return xr.Dataset(variables, coords=data.coordinates(), attrs=samples.attrs)
