"""Bounds of quantities by further runs, on boxes whose bounds are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from deployable.intervals.designs import scan_points
from deployable.intervals.scalars import Climb, estimate_bounds, fit_scalar

ITERATIONS = 6


def crossing(u):
    """Time at which a sin(w t) first reaches 1, and by how much it exceeds it: a root's edge."""
    amplitude, rate = 1 + 0.3 * u[:, 0] - 0.1 * u[:, 1] ** 2, 1 + 0.2 * u[:, 1]
    with np.errstate(invalid="ignore"):
        time = np.arcsin(1 / np.maximum(amplitude, 1.0)) / rate
    return np.where(amplitude > 1, time, np.nan), amplitude - 1


def silent(function):
    """The same without margins."""
    return lambda u: (function(u)[0], np.full(len(u), np.nan))


def race(u):
    """The first of two latches, either of which may miss: a jump."""
    early, late = crossing(u)[0], 2.2 + 0.2 * u[:, 1]
    return np.fmin(early, late), np.full(len(u), np.nan)


def humps(u):
    low = np.exp(-6 * ((u[:, 0] + 0.6) ** 2 + (u[:, 1] + 0.5) ** 2))
    return 0.9 * low + np.exp(-6 * ((u[:, 0] - 0.5) ** 2 + (u[:, 1] - 0.4) ** 2)), np.nan * low


def stop(u):
    value = np.minimum(1 + 0.5 * u[:, 0] + 0.2 * u[:, 1] ** 2, 1.2)
    return value, np.nan * value


def plane(u):
    return u[:, 0] + 0.3 * u[:, 1], np.nan * u[:, 0]


LAST = np.pi / 2 / 0.8  # where the amplitude falls to 1, at the least rate


def exact(function):
    """Bounds by a fine grid, but for the edge of a crossing, which a grid does not reach."""
    line = np.linspace(-1, 1, 1201)
    grid = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    values = function(grid)[0]
    return np.nanmin(values), np.nanmax(values) if function in SMOOTH else LAST


MUTE = silent(crossing)
SMOOTH = race, humps, stop, plane


def search(function, is_time=False, iterations=ITERATIONS):
    """Runs (N, 2), their values and the estimates, after so many iterations."""
    free = np.ones(2, bool)
    unit = np.concatenate([np.zeros((1, 2)), scan_points(free, 15)])
    for number in range(iterations + 1):
        values, margins = function(unit)
        surrogate = fit_scalar(unit, values, 10.0 if is_time else None, margin=margins)
        estimates = estimate_bounds(surrogate, unit, values)
        points = np.concatenate([estimate.points for estimate in estimates])
        if number == iterations or not len(points):
            return unit, values, estimates
        unit = np.concatenate([unit, points])


def test_a_time_beside_the_surface_where_it_ceases_has_the_exact_bounds():
    """By the root of its margin: to a thousandth of the width, in a few runs."""
    unit, _, (lower, upper) = search(crossing, is_time=True)
    assert upper.value == pytest.approx(LAST, abs=1e-3)
    assert lower.value == pytest.approx(exact(crossing)[0], abs=1e-3)
    assert max(lower.error, upper.error) < 0.02 * (LAST - lower.value)
    assert len(unit) < 50


@pytest.mark.parametrize("function", [crossing, MUTE, *SMOOTH])
@pytest.mark.parametrize("iterations", [1, ITERATIONS])
def test_true_bounds_lie_within_the_errors_and_no_bound_is_worse_than_the_runs(
    function, iterations
):
    _, values, estimates = search(function, function in (crossing, race), iterations)
    truth = exact(function)
    width = truth[1] - truth[0]
    for sign, estimate, true in zip((-1, 1), estimates, truth, strict=True):
        attained = np.nanmax(sign * values) * sign
        assert abs(estimate.value - true) <= estimate.error + 0.02 * width
        assert abs(estimate.value - true) <= abs(attained - true) + 1e-9
        assert estimate.error >= 0


def test_no_quantity_has_no_bounds():
    unit = scan_points(np.ones(2, bool), 15)
    surrogate = fit_scalar(unit, np.full(len(unit), np.nan))
    assert estimate_bounds(surrogate, unit, np.full(len(unit), np.nan)) == ()


def separatrix(u):
    """A time beside a saddle: minus the logarithm of the distance from a curved border; no margins
    tell where that is."""
    energy = u[:, 0] + 0.3 * u[:, 1] ** 2 - 0.2
    with np.errstate(invalid="ignore"):
        time = 1.0 - 0.16 * np.log(np.where(energy > 0, energy, np.nan)) + 0.1 * u[:, 1]
    return time, np.full(len(u), np.nan)


def power(u):
    """The same with a negative power of that distance."""
    time, margins = separatrix(u)
    return 1.0 + 0.1 * np.exp(2 * time), margins


@pytest.mark.parametrize(
    ("function", "is_endless"), [(separatrix, True), (power, True), (MUTE, False)]
)
def test_a_time_that_grows_with_every_bisection_has_no_upper_end(function, is_endless):
    """The end of the runs stands for it; beside the edge of a root the bound is finite."""
    _, values, (_, upper) = search(function, is_time=True)
    assert np.nanmax(values) < 10.0
    assert (upper.value == 10.0) == is_endless


def test_a_surrogate_that_runs_refuted_is_no_bound():
    """A misprediction of the last run there counts as its error."""
    unit = scan_points(np.ones(2, bool), 15, corners=False)
    values = plane(unit)[0]
    trusted = estimate_bounds(fit_scalar(unit, values), unit, values)[1]
    refuted = estimate_bounds(fit_scalar(unit, values), unit, values, (0.0, np.inf))[1]
    assert trusted.value == pytest.approx(1.3) and trusted.error < 1e-6
    assert refuted.value == values.max()
    assert refuted.error == pytest.approx(1.3 - values.max(), rel=1e-6)


def test_a_climb_goes_along_a_border_to_the_largest_value():
    """A time with a root at the border of where its event occurs, largest at one end of that."""

    def f(x):
        margin = 0.8 * x[:, 0] + 0.3 * x[:, 1] + 0.25
        times = 2 - 0.6 * np.sqrt(np.maximum(margin, 0)) - 0.1 * x[:, 1]
        return np.where(margin > 0, times, np.nan)

    points, climb = scan_points(np.ones(2, bool), 12), Climb(1.0)
    while (point := climb.propose(points, f(points))) is not None and len(points) < 60:
        points = np.vstack([points, point])
    assert np.nanmax(f(points)) == pytest.approx(2.1, abs=0.008)


def climbed(points, function, count):
    """The largest value after a search of at most `count` runs, the search, and its runs."""
    climb, runs = Climb(1.0), 0
    while runs < count:
        values, margins = function(points)
        point = climb.propose(points, values, margins)
        if point is None:
            break
        points, runs = np.vstack([points, point]), runs + 1
    return np.nanmax(function(points)[0]), climb, runs


def ceasing(x):
    """Time of an event that ceases to occur at a curved border, where it is like a root; at most
    0.9, at one end of the border."""
    margins = 0.4 + 0.5 * x[:, 0] - 0.3 * x[:, 1] ** 2
    times = 0.6 + 0.3 * x[:, 1] - np.sqrt(np.maximum(margins, 0.0))
    return np.where(margins > 0, times, np.nan), margins


def test_a_bound_at_a_border_is_reached_along_it_by_event_margins():
    points = scan_points(np.ones(2, bool), 12)
    value, climb, runs = climbed(points, ceasing, 40)
    start, width = np.nanmax(ceasing(points)[0]), 1.9
    assert 0.9 - start > 0.1 * width
    assert 0.9 - value < 0.01 * width
    assert runs < 40 and climb.remainder == 0.0


def test_a_search_that_is_cut_short_tells_what_it_may_still_gain():
    points = scan_points(np.ones(2, bool), 12)
    _, climb, _ = climbed(points, ceasing, 3)
    assert climb.remainder > 0.0
    assert Climb(1.0).remainder == 0.0
