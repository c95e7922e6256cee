"""Numbers of the interval side for closed-form responses: every design, model, fit and search.

    PYTHONPATH=.:tests/intervals python tests/golden/interval_cases.py

prints what interval_cases.json is to hold: of each result the sum of its numbers, with weights, and
that of what they are without sign. A change that moves them says why.
"""

import json
from collections.abc import Iterator
from dataclasses import fields, is_dataclass

import numpy as np
import xarray as xr
from datasets_for_tests import samples_of

from deployable import intervals
from deployable.intervals import Box, Design, Surrogate, bounds_dataset, make_design
from deployable.intervals.enclosures import effects_enclosure
from deployable.intervals.estimates import extrapolate_error, refinement_ratio, share_outside, widen
from deployable.intervals.samples import RunBounds, quarter_ends
from deployable.intervals.scalars import requirements as req
from deployable.intervals.scalars.surrogate import find_influence, fit_scalar

TIME = np.linspace(0.1, 2.1, 41)
BOXES = {
    "1": Box(["f"], [0.9], [1.15]),
    "2": Box(["f", "g"], [0.9, 0.2], [1.15, 0.6]),
    "3": Box(["f", "g", "h"], [0.9, 0.2, -0.3], [1.15, 0.6, 0.1]),
    "flat": Box(["f", "w", "g"], [0.9, 2.0, 0.2], [1.15, 2.0, 0.6]),  # w has no width
}
RNG = np.random.default_rng(7)


def responses(values) -> np.ndarray:
    """A smooth response, one with a kink, one that stands still and then moves, one above 0."""
    f, g, h = (*values, 0.3, 0.1)[:3]
    smooth = np.sin(5 * TIME * f) * np.exp(-g * TIME) + 0.1 * h * TIME**2 * f
    kink = np.abs(np.sin(3 * TIME * f + g) - 0.43) + 0.2 * h
    still = np.maximum(TIME - 0.8 * f - 0.1 * g, 0.0) ** 1.5 * (1.0 + g) + 1e-3 * f * (1 + g + h)
    return np.array([smooth, kink, still, smooth**2])


def samples(box: str, design: Design, held_out: int = 5) -> xr.Dataset:
    """Runs of the responses; two of them cannot be below 0."""
    names = ("smooth", "kink", "still", "square")
    found = samples_of(responses, BOXES[box], design, TIME, held_out, names)
    return found.assign_coords(response_least=("response", [np.nan, np.nan, 0.0, 0.0]))


# -- what is computed -----------------------------------------------------------------------------


DESIGNS = [
    ("1", "tensor_roots", 6), ("2", "tensor_roots", [5, 3]), ("2", "tensor_lobatto", 4),
    ("3", "smolyak", 4), ("flat", "tensor_roots", 4), ("3", "tensor_roots", 2),
    ("2", "tensor_roots", 1), ("flat", "smolyak", [6, 0, 4]), ("3", "smolyak", [2, 4, 8]),
]  # fmt: skip


def polynomials() -> Iterator:
    """Bounds of polynomials, with and without held-out runs; what parameters contribute."""
    for box, method, order in DESIGNS:
        design = make_design(method, BOXES[box], order)
        for held_out, options in ((5, {}), (0, {}), (17, {"tolerance": 0.05})):
            runs = samples(box, design, held_out)
            yield bounds_dataset(runs, design, **options)
            yield intervals.sensitivity_dataset(runs, design)
        yield intervals.surrogate_dataset(runs, design)
    scan = make_design("sobol", BOXES["2"], 4, samples=40, seed=3)
    yield bounds_dataset(samples("2", scan), scan)
    yield scan


def scans() -> Iterator:
    """Bounds of scans, by values and by running ones, and their growth."""
    for box, count, seed in (("1", 21, 0), ("2", 50, 1), ("3", 64, 2), ("flat", 33, 0)):
        design = make_design("sobol", BOXES[box], samples=count, seed=seed)
        yield bounds_dataset(samples(box, design, 0), design, model="scan")
    values = RNG.normal(size=(30, 2, 5)).round(1)
    one, other = (
        RunBounds.from_runs(values[part], np.arange(30)[part])
        for part in (slice(12), slice(12, 30))
    )
    yield from (one.merge(other), other.merge(None), quarter_ends(30))


def splines() -> Iterator:
    """Bounds of splines through scans and sought runs, and which runs come next."""
    for box, count in (("1", 13), ("2", 40), ("3", 60), ("flat", 30)):
        design = make_design("sobol", BOXES[box], samples=count, seed=5)
        runs = samples(box, design)
        yield bounds_dataset(runs, design, model="spline")
        yield bounds_dataset(runs, None, model="spline")
        sought = Design(design.points, design.multi_indices, "adaptive")
        bounds = bounds_dataset(runs, sought, model="spline")
        yield bounds
        width = (bounds["upper"] - bounds["lower"]).values
        to_unit = BOXES[box].to_unit
        at = [to_unit(bounds[name].values) for name in ("argmin", "argmax")]
        places = intervals.choose_bound_points(*at, width, 6)
        yield (
            places.points.shape,
            places.errors(RNG.normal(size=(len(places.points), *width.shape))),
        )
        chosen, growth = intervals.seek_points(
            runs["normalized"].values, runs["values"].values, 5, candidates=512, seed=2
        )
        yield chosen, growth


def ranges() -> Iterator:
    """Enclosures and attained ranges of polynomials that nothing simple describes."""
    for order in ((9,), (5, 4), (3, 3, 2), (2, 1, 2, 1)):
        indices = intervals.chebyshev.tensor(order)
        c = RNG.normal(size=(len(indices), 6)) / (1.0 + indices.sum(axis=1, keepdims=True)) ** 2
        surrogate = Surrogate(c, indices)
        yield intervals.find_surrogate_range(surrogate)
        yield intervals.find_surrogate_range(surrogate, 0.2)
        yield effects_enclosure(c, indices)
        yield surrogate.evaluate(RNG.uniform(-1, 1, (7, len(order))))


def scalars() -> Iterator:
    """Numbers over the box: everywhere, in a part of it, up to a time; where limits are kept."""
    for k, count in ((1, 15), (2, 40), (3, 70)):
        points = RNG.uniform(-1, 1, (count, k))
        x, y, z = points[:, 0], points[:, -1], points[:, k // 2]
        smooth = np.exp(0.7 * x) + 0.4 * y * z + 0.05 * np.sin(9 * x)
        kink = np.abs(x - 0.31) + 0.6 * y
        margin = 0.4 - x + 0.3 * z**2
        some = np.where(margin > 0, smooth, np.nan)
        late = np.where(kink < 0.9, kink, np.nan)
        found = [
            fit_scalar(points, smooth), fit_scalar(points, kink, limits=(0.1, np.inf)),
            fit_scalar(points, some), fit_scalar(points, some, margin=margin),
            fit_scalar(points, late, latest=0.9), fit_scalar(points, 1.0 + 0.5 * x - x * z),
        ]  # fmt: skip
        trial, nominal = RNG.uniform(-1, 1, (50, k)), np.full(k, 0.15)
        part = np.full(k, -0.4), np.full(k, 0.7)
        for one in found:
            yield one.evaluate(trial), one.error, one.usual_error, one.occurrence.open_fraction
            border = one.occurrence
            yield border.decision(trial), border.band(trial), border.infill_points(4)
            yield [one.find_place(*part, happens) is None for happens in (True, False)]
            if not border.is_mixed:  # a search that ends at a border is as good as its last step
                wide = one.range(), one.range(*part)
                yield [(each.low, each.high, each.width) for each in wide], one.end(-1.0, *part)[0]
            if one is found[0] or one is found[-1]:
                yield find_influence(one, nominal)
            if one.fit:
                yield one.fit.left_out, one.trend.evaluate(trial)
        noisy = fit_scalar(points, smooth + 0.03 * RNG.normal(size=count))
        yield noisy.evaluate(trial), noisy.trend.evaluate(trial), noisy.fit.left_out
        limits = [
            req.Limit(found[0], "at_most", 2.1), req.Limit(found[1], "at_least", 0.15, 0.01),
            req.Limit(found[2], "happens", 1.0, 0.0, 0.1), req.Limit(found[4], "at_most", 0.7),
        ]  # fmt: skip
        free = np.ones(k, bool)
        for some in (limits[:1], limits[1:2], limits[2:], limits):
            yield req.share_of_box(some, free), req.share_of_box(some, free, *part)
            yield req.find_max_scale(some, nominal - 0.5)[:2]
            yield [(limit.worst(*part)[0], limit.best(*part)[0]) for limit in some]
        yield [limit.find_margins(np.array([0.1, np.nan, 3.0])) for limit in limits]
        yield req.find_least_scales(nominal, trial)
        yield from choices(k, found, limits)


def choices(k: int, found: list, limits: list) -> Iterator:
    """The best of what may be chosen: one, two or three numbers, with an interval about each."""

    def box(values):
        lower, upper = np.full(k, -1.0), np.full(k, 1.0)
        lower[: len(values)], upper[: len(values)] = values - 0.1, values + 0.1
        return lower.clip(-1, 1), upper.clip(-1, 1)

    for goal in (req.Goal(found[0], "upper"), req.Goal(found[1], "lower", -1.0)):
        best, first = req.ChoiceProblem([goal], limits[:2], [(-0.8, 0.8)] * k, box).find_best()
        yield best.goals, best.margin, [each.margin for each in first], len(first)
    if k == 1:
        width = req.Goal(found[3], "width")
        yield req.ChoiceProblem([width], [], [(-0.5, 0.5)], box).find_best()[0].goals


def estimates() -> Iterator:
    """Errors by themselves."""
    error = np.abs(RNG.normal(size=(3, 41)))
    yield [widen(TIME, error, window) for window in (None, 0.0, 0.11, 5.0)]
    yield [share_outside(n, c) for n in (1, 2, 30, 500) for c in (None, 0.95)]
    before, after = RNG.normal(size=(2, 20))
    yield extrapolate_error(before), extrapolate_error(after, refinement_ratio(before, after))
    RNG.normal(size=(11, 41))  # after which the numbers below were written down
    design = make_design("tensor_roots", BOXES["2"], 3)
    bounds = bounds_dataset(samples("2", design), design)
    parts = {"mesh": 0.01 * RNG.normal(size=bounds["error"].shape)}
    yield intervals.add_errors(bounds, parts)
    for box in BOXES.values():
        yield box.from_unit(intervals.held_out_points(box.free, 9, box.corners()[:1]))


PARTS = (polynomials, scans, splines, ranges, scalars, estimates)


# -- all numbers of a result ----------------------------------------------------------------------


def decided(dataset: xr.Dataset) -> dict:
    """What of a dataset rounding does not decide, as it does where bounds without width are
    attained, and which of two equal values is largest; `least` and `most` follow from the input."""
    variables = dataset.drop_vars(["least", "most"], errors="ignore").data_vars
    found = {n: v.values for n, v in variables.items() if not n.endswith("_time")}
    for name in ("argmin", "argmax"):
        if name in found:
            wide = (dataset["upper"] - dataset["lower"]).values > 1e-6
            found[name] = np.where(wide[..., None], found[name], 0.0)
    return found | dataset.attrs


def numbers(found) -> Iterator[np.ndarray]:
    """All numbers of whatever a function returns, one after the other."""
    if isinstance(found, xr.Dataset):
        found = decided(found)
    if is_dataclass(found):
        found = [getattr(found, field.name) for field in fields(found)]
    if isinstance(found, dict):
        found = [found[key] for key in sorted(found)]
    if isinstance(found, list | tuple):
        for each in found:
            yield from numbers(each)
    elif found is not None and np.asarray(found).dtype.kind in "bifu":
        yield np.asarray(found, dtype=float).ravel()


def sums(found) -> list[float]:
    """Each number has a weight of its own, so that none can stand for another; their sizes; and how
    many are not finite."""
    values = np.concatenate([np.zeros(0), *numbers(found)])
    finite = np.where(np.isfinite(values), values, 0.0)
    total = np.cos(1.0 + np.arange(values.size)) @ finite
    lost = int((~np.isfinite(values)).sum())
    return [float(f"{x:.12g}") for x in (total, np.abs(finite).sum())] + [lost]


if __name__ == "__main__":
    print(json.dumps({part.__name__: [sums(found) for found in part()] for part in PARTS}))
