"""Bounds of every response at every instant: from a samples dataset to a bounds dataset, whose
errors others may be added to; and numbers that compare bounds with others or with runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .designs import Design, is_plain_scan
from .errors import IntervalError, check_choice, check_options
from .estimates import ErrorEstimate, widen
from .models import MODELS, Model
from .ranges import Range, clip_bounds
from .samples import RunBounds, Samples, read_samples

if TYPE_CHECKING:
    import xarray as xr


def bounds_dataset(
    samples: xr.Dataset,
    design: Design | None,
    *,
    model: str = "polynomial",
    **options: Any,
) -> xr.Dataset:
    """Compute a dataset of bounds of the responses over the box, with estimated errors, by instant.

    Parameters
    ----------
    samples: dimensions run, response, time, parameter; variables ``values`` (run, response, time),
        ``normalized`` (-1 to 1) and ``value`` (run, parameter), ``role`` (run); coordinates
        ``time`` (s) and ``response`` (names), and ``response_units``, ``response_long_name``
        (response) to be taken over.
    design: its points must be among the runs (recognised by their unit coordinates, in any order).
        All other runs, whatever their role, test the polynomial. A scan without order has none: its
        model is "scan". Splines and scans take all runs, and need no design (None).
    model: one of `MODELS`: "polynomial", of the design's order through the design's runs; "spline",
        one cubic spline through all runs, those of a scan or held out included; "aligned", splines
        through all runs over time that events map; "auto", for each response and stretch of time
        that of these which predicts left-out runs best; "scan", the least and the largest sample.
    options: keyword-only arguments of the model's constructor, as `tolerance` of `PolynomialModel`.

    Returns
    -------
    xarray.Dataset
        Each (response, time) in the units of the response: ``lower``, ``upper`` (guaranteed for the
        surrogate), ``inner_lower``, ``inner_upper`` (attained), ``nominal`` and ``error`` (estimate
        for the bounds, with its parts ``error_held_out`` and ``error_decay``); ``argmin``,
        ``argmax`` (response, time, parameter), the parameter values where; and numbers over
        response, such as ``largest_width`` and ``error_share_of_width``. No bound is below the
        physical one, ``response_least`` (response), where samples have that, nor further beyond
        the end of an opening's way (``response_floor``, ``response_ceiling``) than twice what
        any run went; ``least`` and ``most`` (response) are these limits (NaN: none), and
        ``largest_impossible`` says by how much the model was beyond."""
    import xarray as xr

    kind = MODELS[check_choice("model", model, MODELS)]
    if model == "polynomial" and design is None:
        raise IntervalError("design", None, f"the design that the model {model} is fitted to")
    if model == "auto" and design is None:
        kind = MODELS["spline"]
    elif model in ("auto", "polynomial") and design is not None and is_plain_scan(design):
        kind = MODELS["scan"]
    check_options(f"option of model {model}", kind, options)
    data = read_samples(samples)
    by_shares = data.ratios.any() and kind is not MODELS["scan"]
    fit = kind(shares_of(data) if by_shares else data, design, **options)
    bounds = fit.range()
    error = fit.error(bounds)
    if by_shares:
        bounds, error = ratios_of(data, bounds, error)
    least, most = (limit[:, None] for limit in _limits(data, kind is MODELS["scan"]))
    excess = np.maximum(least - bounds.inner_lower, bounds.inner_upper - most)
    bounds = clip_bounds(bounds, least, most)
    attributes = {**samples.attrs, "held_out_runs": len(fit.test_rows), "bounds_kind": fit.kind}
    if design is not None:
        attributes |= {"design_method": design.method, "design_order": list(design.order)}
    variables = _curves(data, fit, bounds, error, bool(by_shares))
    variables |= _numbers(data.time, bounds, error.total)
    variables |= _largest("impossible", np.maximum(excess, 0.0), data.time)
    for name, limit in (("least", least), ("most", most)):
        attrs = {"long_name": f"{name} value that bounds can have, for physical reasons"}
        values = np.where(np.isfinite(limit[:, 0]), limit[:, 0], np.nan)
        variables[name] = ("response", values, attrs)
    attributes |= fit.attributes
    return xr.Dataset(variables | fit.variables(), coords=data.coordinates(), attrs=attributes)


def _curves(
    samples: Samples, model: Model, bounds: Range, error: ErrorEstimate, by_shares: bool
) -> dict:
    """Return the variables over response and time, and where in the box the bounds are taken."""
    centre, label = model.centre(), "model at the centre of the box"
    if by_shares and centre is not None:
        centre = np.where(samples.ratios[:, None], ratio(centre), centre)
    if (nominal := samples.nominal_curve()) is not None:
        centre, label = nominal, "nominal run"
    curves = [
        ("lower", bounds.lower, "lower bound"),
        ("upper", bounds.upper, "upper bound"),
        ("inner_lower", bounds.inner_lower, "attained lower bound"),
        ("inner_upper", bounds.inner_upper, "attained upper bound"),
        ("nominal", centre, label),
        ("error", error.total, "estimated error of the bounds"),
        ("error_held_out", error.held_out, "largest error at the held-out runs"),
        ("error_decay", error.decay, "error extrapolated from the coefficients"),
    ]
    variables: dict[str, tuple] = {
        name: (("response", "time"), values, {"long_name": text})
        for name, values, text in curves
        if values is not None
    }
    to_value = samples.parameters()
    for name, x, side in (("argmin", bounds.argmin, "lower"), ("argmax", bounds.argmax, "upper")):
        axes, text = ("response", "time", "parameter"), f"parameters at the {side} bound"
        variables[name] = (axes, to_value(x), {"long_name": text})
    return variables


def _limits(samples: Samples, is_scan: bool) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest values (n,) of bounds, or -inf, inf. Stops yield: up to twice what any run
    went beyond."""

    def number(name: str) -> np.ndarray:
        if name not in samples.source:
            return np.full(len(samples.names), np.nan)
        return samples.source[name].values

    floor, ceiling = number("response_floor"), number("response_ceiling")
    least, most = number("response_least"), np.full(len(floor), np.nan)
    if np.isfinite([floor, ceiling]).any() and not is_scan:
        low, high = samples.values.min(axis=(0, 2)), samples.values.max(axis=(0, 2))
        least = np.fmax(least, floor - 2 * np.maximum(floor - low, 0.0))
        most = ceiling + 2 * np.maximum(high - ceiling, 0.0)
    return np.where(np.isnan(least), -np.inf, least), np.where(np.isnan(most), np.inf, most)


_LARGEST = {
    "width": "difference of the bounds",
    "error": "estimated error of the bounds",
    "impossible": "distance of the model beyond what is possible",
}


def _largest(name: str, values: np.ndarray, time: np.ndarray) -> dict[str, tuple]:
    """Variables (n) of the largest of values (n, T) over time, and of when it is."""
    text = f"largest {_LARGEST[name]}"
    attrs = {"long_name": f"time of the {text}", "units": "s"}
    return {
        f"largest_{name}": ("response", values.max(axis=1), {"long_name": text}),
        f"largest_{name}_time": ("response", time[values.argmax(axis=1)], attrs),
    }


def _share(name: str, text: str, error: np.ndarray, time: np.ndarray, bounds: Range) -> dict:
    """Return the variable (n) of an error (n, T), integrated over time, as a share of the width."""
    area, integrals = (np.trapezoid(x, time) for x in (bounds.upper - bounds.lower, error))
    shares = np.divide(integrals, area, out=np.zeros_like(integrals), where=area > 0)
    attrs = {"long_name": f"{text}, as a share of the width", "units": "1"}
    return {name: ("response", shares, attrs)}


def _numbers(time: np.ndarray, bounds: Range, error: np.ndarray) -> dict[str, tuple]:
    """Variables (n) of bounds and their error (n, T)."""
    text = "estimated error of the bounds"
    return {
        **_largest("width", bounds.upper - bounds.lower, time),
        **_largest("error", error, time),
        **_share("error_share_of_width", text, error, time, bounds),
    }


_RANGE = ("lower", "upper", "inner_lower", "inner_upper", "argmin", "argmax")


def add_errors(bounds: xr.Dataset, parts: Mapping[str, np.ndarray]) -> xr.Dataset:
    """Add further error components to a bounds dataset: returns a copy whose ``error`` (response,
    time) is the sum of the surrogate's and of all `parts`.

    parts: errors (n, T) by name of the component, such as "mesh", of n responses at T instants, in
    the responses' units, NaN where not known; the largest size within 0.5 % of the duration of
    each instant counts. The copy gets ``error_surrogate`` and
    ``error_<name>`` (response, time), and ``share_surrogate`` and ``share_<name>`` (response),
    fractions of the width, both integrated over time; ``largest_error``, its time and
    ``error_share_of_width`` are the sum's."""
    time, curves = bounds["time"].values, {"surrogate": bounds["error"].values}
    curves |= {name: widen(time, np.abs(values)) for name, values in parts.items()}
    bounds_range = Range(*(bounds[name].values for name in _RANGE))
    return bounds.assign(_errors(time, bounds_range, curves)).assign_attrs(error_parts=list(curves))


def _errors(time: np.ndarray, bounds: Range, curves: Mapping[str, np.ndarray]) -> dict[str, tuple]:
    """Variables of errors (n, T) by component, and of their sum."""
    variables, axes = {}, ("response", "time")
    for name, values in curves.items():
        variables[f"error_{name}"] = (axes, values, {"long_name": f"error of the bounds by {name}"})
        variables |= _share(f"share_{name}", f"error of the {name}", values, time, bounds)
    total = np.sum(list(curves.values()), axis=0)
    variables["error"] = (axes, total, {"long_name": "estimated error of the bounds"})
    return variables | _numbers(time, bounds, total)


def include_runs(bounds: xr.Dataset, runs: RunBounds, values: np.ndarray) -> xr.Dataset:
    """Widen a bounds dataset to further runs, `argmin` and `argmax` with them; the surrogate's
    error is at least the distance by which the bounds missed a run, within 0.5 % of the duration.
    runs: least and largest values (n, T); values (R, k): parameters in these, in their units."""
    time, first_range = bounds["time"].values, Range(*(bounds[name].values for name in _RANGE))
    wider_range = first_range.include(
        runs.low, runs.high, values[runs.low_run], values[runs.high_run]
    )
    distance = widen(
        time,
        np.maximum(first_range.lower - wider_range.lower, wider_range.upper - first_range.upper),
    )
    parts = np.atleast_1d(bounds.attrs.get("error_parts", []))
    curves = {name: bounds[f"error_{name}"].values for name in parts}
    if curves:
        curves["surrogate"] = np.maximum(curves["surrogate"], distance)
        variables = _errors(time, wider_range, curves)
    else:
        error = np.maximum(bounds["error"].values, distance)
        variables = {"error": (bounds["error"].dims, error, bounds["error"].attrs)}
        variables |= _numbers(time, wider_range, error)
    for name in _RANGE:
        variables[name] = (bounds[name].dims, getattr(wider_range, name), bounds[name].attrs)
    return bounds.assign(variables)


def hausdorff(
    lower: np.ndarray, upper: np.ndarray, reference_lower: np.ndarray, reference_upper: np.ndarray
) -> np.ndarray:
    """Hausdorff distance (...) of intervals from reference intervals, one by one: the larger
    difference of their lower and of their upper bounds."""
    return np.maximum(np.abs(lower - reference_lower), np.abs(upper - reference_upper))


# -- ratios less one, as margins are, of what is smooth: fitted by something that is smooth, too ---
# m = d/r - 1 with d, r >= 0 grows without end where r vanishes, and polynomials follow it badly.
# The share h = r/(r + d) = 1/(2 + m), from 0 to 1, does not: its denominator vanishes nowhere. It
# falls with m: its bounds are those of m, each of the other side; its error is one at either.

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
