"""What a polynomial through runs tells: coefficients, and which parameter widens bounds when."""

from __future__ import annotations

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


def measure_widths(surrogate: Surrogate) -> np.ndarray:
    """Compute the exact widths (k, ...) of the ranges of a polynomial surrogate when only one
    parameter varies, about the centre of the box; (...): shape of its values."""
    k, shape = surrogate.dimension, surrogate.coefficients.shape[1:]
    width = np.zeros((k, *shape))
    for j in range(k):
        line = surrogate.restrict(j, np.zeros(k))
        low, high, *_ = line_range(line.reshape(len(line), -1))
        width[j] = (high - low).reshape(shape)
    return width


def sensitivity_dataset(samples: xr.Dataset, design: Design) -> xr.Dataset:
    """Compute the influence of each parameter on each response, per instant and overall.

    Parameters
    ----------
    samples: runs as in `samples.nc`: ``values`` (run, response, time), ``normalized`` and ``value``
        (run, parameter).
    design: points among the runs, and the polynomials that are fitted to these runs.

    Returns
    -------
    xarray.Dataset
        Over (response, parameter, time): ``width``, of the range when only this parameter varies,
        in the response's units, 0 where the runs differ by rounding alone. Over (response, time):
        ``error``, the largest error of the polynomial at runs that it was not fitted to, within a
        short time (without such runs, by the decay of its coefficients): a width that is not above
        it may be the fit's noise. Over (response, parameter): ``width_overall``, the width where it
        is above ``error``, integrated over time, as a fraction of the sum over all parameters."""
    import xarray as xr

    data = read_samples(samples)
    values, lost_error = complete_runs(design, data.points, data.values, data.failed_points)
    surrogate = fit(design, values)
    if len(test_rows := find_other_runs(data.points, design.points)):
        residuals = np.abs(data.values[test_rows] - surrogate.evaluate(data.points[test_rows]))
        error = widen(data.time, residuals.max(axis=0)) + lost_error
    else:
        error = estimate_decay(surrogate, data.time) + lost_error
    width = np.moveaxis(measure_widths(surrogate), 0, 1)
    sure_widths = np.where(width > error[:, None], width, 0.0)
    wide = np.trapezoid(sure_widths, data.time, axis=-1)
    wide /= np.where(wide.any(axis=1), wide.sum(axis=1), 1.0)[:, None]
    # Where runs differ by rounding alone, no parameter contributes anything.
    limit = ROUNDING * np.abs(values).max(axis=(0, 2))[:, None]
    is_blank = (np.ptp(values, axis=0) <= limit)[:, None]
    curve = ("response", "parameter", "time")
    text = "width when only this parameter varies"
    overall = {"long_name": "share of the widths above the error", "units": "1"}
    variables = {
        "width": (curve, np.where(is_blank, 0.0, width), {"long_name": text}),
        "error": (curve[::2], error, {"long_name": "error at runs that were not fitted"}),
        "width_overall": (curve[:2], wide, overall),
    }
    return xr.Dataset(variables, data.coordinates(), samples.attrs)


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
