"""Numbers of runs over the box, on functions whose answers are known."""

import itertools
import math
from dataclasses import replace
from math import comb, factorial

import numpy as np
import pytest

from deployable.intervals import make_design
from deployable.intervals.box import Box, held_out_points
from deployable.intervals.designs import scan_points
from deployable.intervals.scalars import (
    ChoiceProblem,
    EventLimit,
    FittedOccurrence,
    Goal,
    Limit,
    estimate_bounds,
    find_halving,
    find_influence,
    find_least_scales,
    find_max_scale,
    fit_scalar,
    share_borders,
    share_of_box,
    sub_box,
)


def runs(k: int, order: int = 4, held_out: int = 4) -> np.ndarray:
    """Unit points (N, k) of a campaign: its nodes and the runs held out."""
    box = Box([f"p{j}" for j in range(k)], -np.ones(k), np.ones(k))
    nodes = make_design("smolyak", box, order).points
    return np.concatenate([nodes, held_out_points(box.free, held_out, nodes)])


def fitted(function, k: int, **more):
    points = runs(k, **more)
    return fit_scalar(points, function(points))


def opening_time(x: np.ndarray) -> np.ndarray:
    """The panel's: falls as the root of a stiffness that is known to 5 %."""
    return 1.9 * (1 + 0.05 * x[:, 0]) ** -0.5


def test_a_smooth_number_is_fitted_to_nine_digits_and_its_error_estimate_covers_that():
    surrogate = fitted(opening_time, 1)
    x = np.linspace(-1, 1, 501)[:, None]
    wrong = np.abs(surrogate.evaluate(x) - opening_time(x)).max()
    assert wrong < 1e-8
    assert wrong <= surrogate.error < 1e-6
    found = surrogate.range()
    assert found.low == pytest.approx(1.9 / np.sqrt(1.05), rel=1e-8)
    assert found.high == pytest.approx(1.9 / np.sqrt(0.95), rel=1e-8)
    assert (found.argmin[0], found.argmax[0]) == (1.0, -1.0)


def test_one_run_and_a_box_without_width():
    fixed = fit_scalar(np.zeros((1, 2)), np.array([3.0]))
    assert fixed.error == 0
    assert fixed.range().low == fixed.range().high == 3.0
    few = fit_scalar(np.array([[-1.0], [1.0]]), np.array([0.0, 2.0]))
    assert few.error >= 1


def test_what_each_parameter_contributes():
    surrogate = fitted(lambda x: 3 * x[:, 0] + x[:, 1] + 0.5 * x[:, 0] * x[:, 1], 2)
    found = find_influence(surrogate, np.array([0.0, 0.5]))
    assert found.width == pytest.approx(8.0)  # 4.5 at (1, 1), -3.5 at (-1, 1) or (-1, -1)
    np.testing.assert_allclose(found.alone, [6.5, 2.0])
    np.testing.assert_allclose(found.share, [6.5 / 8.5, 2 / 8.5])
    # With the second parameter at 0.5: 3.25 x + 0.5.
    np.testing.assert_allclose(found.fixed[1], 6.5)
    # The first one fixed at 0: x2 from -1 to 1.
    np.testing.assert_allclose(found.fixed[0], 2.0)
    # The first in [-0.5, 0.5]: from 2.75 at (0.5, 1) to -2.25 at (-0.5, -1).
    assert found.halved[0] == pytest.approx(5.0)
    # The second in [-0.25, 0.75]: 4.125 down to -3.125 (x2 = -0.25: -3 - 0.25 + 0.125).
    assert found.halved[1] == pytest.approx(4.125 + 3.125)


def shims(k: int, level: float) -> Limit:
    """A stack of k shims, each off by up to 1, that is at most `level` high."""
    return Limit(fitted(lambda x: x.sum(axis=1), k, order=1), "at_most", level)


def stacked(k: int, level: float, half: int) -> float:
    """Share of stacks at most `level` high with `half` of k shims off by up to a half only: by
    inclusion and exclusion of the corners beyond (Feller 1966, I.9)."""
    widths, failing = [1.0] * half + [2.0] * (k - half), 0.0
    for cut in itertools.product((0, 1), repeat=k):
        room = sum(widths) / 2 - level - sum(c * w for c, w in zip(cut, widths, strict=True))
        failing += (-1) ** sum(cut) * max(room, 0.0) ** k
    return 1 - failing / math.factorial(k) / math.prod(widths)


@pytest.mark.parametrize("k, level", [(1, 0.5), (2, 1.5), (4, 3.3), (8, 5.0)])
def test_a_halved_tolerance_gains_what_the_corner_beyond_the_limit_holds(k, level):
    whole, half = stacked(k, level, 0), stacked(k, level, 1)
    found = [find_halving([shims(k, level)], np.ones(k, bool), np.zeros(k), j) for j in (0, k - 1)]
    assert found[0] == pytest.approx(found[-1])  # equal tolerances
    one = found[0]
    assert abs(one.share - half) <= one.share_uncertainty + 1e-9
    assert abs(one.gain - (half - whole)) <= one.gain_uncertainty + 1e-9
    assert one.gain_uncertainty < 0.7 * one.gain
    is_kept = (k - 0.5) <= level
    assert (one.share == 1 and not one.share_uncertainty) == (is_kept or k == 1)


def test_the_widths_of_what_exists_in_part_have_the_error_of_its_border():
    """A body that creeps up to a level, which some never reach: -log(1 - level / end)."""

    def times(x: np.ndarray) -> np.ndarray:
        part = (0.95 + 0.02 * x[:, 1]) / (1 + 0.1 * x[:, 0])
        time = -np.log(np.maximum(1 - part, 1e-9))
        return np.where(time < 6, time, np.nan)

    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 801)] * 2), axis=-1).reshape(-1, 2)
    for count in (8, 40):
        points = np.concatenate([runs(2), scan_points(np.ones(2, bool), count, corners=False)])
        found = find_influence(fit_scalar(points, times(points), latest=6.0), np.zeros(2))
        for widths, part in ((found.fixed, 0.0), (found.halved, 0.5)):
            for j in range(2):
                values = times(grid * np.where(np.arange(2) == j, part, 1.0))
                exact = np.nanmax(values) - np.nanmin(values)
                assert abs(widths[j] - exact) <= found.error[j]
        # The border, at x0 = 0.1 (0.2 x1 - 0.5), crosses all parts but that of x0 = 0.
        ended = find_influence(
            fit_scalar(points, times(points), latest=6.0), np.zeros(2), None, is_endless=True
        )
        is_open = np.isnan([*ended.fixed, *ended.halved])
        assert is_open.tolist() == [False, True, True, True]


def test_the_share_of_the_box_that_meets_a_limit():
    surrogate = fitted(opening_time, 1)
    level = 1.9 / np.sqrt(1 + 0.05 * 0.123)
    share, open_ = share_of_box([Limit(surrogate, "at_most", level)], np.ones(1))
    assert share == pytest.approx((1 - 0.123) / 2, abs=1e-6)
    assert 0 < open_ < 1e-6
    both = [Limit(surrogate, "at_most", level), Limit(surrogate, "at_least", 1.9 / np.sqrt(1.04))]
    assert share_of_box(both, np.ones(1))[0] == pytest.approx((0.8 - 0.123) / 2, abs=1e-6)
    part = share_of_box(both, np.ones(1), np.array([-0.5]), np.array([0.5]))
    assert part[0] == pytest.approx(0.5 - 0.123, abs=1e-6)


def test_the_share_is_open_by_what_the_runs_themselves_may_be_wrong_by():
    """Of 2 + x at most 2.1: a hundredth moves the border by a two hundredth of the box."""
    points = np.linspace(-1.0, 1.0, 9)[:, None]
    surrogate = fit_scalar(points, 2.0 + points[:, 0])
    limit = Limit(surrogate, "at_most", 2.1, run_error=0.01)
    assert limit.error == pytest.approx(0.01, abs=1e-9)
    assert share_of_box([limit], np.ones(1)) == pytest.approx((0.55, 0.005), abs=1e-6)


@pytest.mark.parametrize("place", [0, 2])
def test_a_direction_without_width_changes_no_share_and_no_choice_of_a_box(place):
    points = runs(2)
    values = points[:, 0] + 2 * points[:, 1] ** 2
    alone, free = fit_scalar(points, values), np.arange(3) != place
    wider = fit_scalar(np.insert(points, place, 0.0, axis=1), values)
    assert wider.range().low == pytest.approx(alone.range().low)
    assert wider.range().high == pytest.approx(alone.range().high)
    one, other = ([Limit(found, "at_most", 1.0)] for found in (alone, wider))
    share, _ = share_of_box(one, np.ones(2))
    assert 0.1 < share < 0.9
    assert share_of_box(other, free)[0] == pytest.approx(share, abs=1e-3)
    scales = [find_max_scale(limits, np.zeros(k))[0] for limits, k in ((one, 2), (other, 3))]
    assert scales[1] == pytest.approx(scales[0])
    found = find_influence(wider, np.zeros(3))
    shares = find_influence(alone, np.zeros(2)).share
    np.testing.assert_allclose(np.delete(found.share, place), shares)
    assert found.share[place] == 0.0


def test_the_largest_box_that_meets_a_limit_and_the_nearest_place_that_does_not():
    surrogate = fitted(lambda x: x[:, 0] + 2 * x[:, 1], 2)
    limit = Limit(surrogate, "at_most", 1.5)
    share, which, at = find_max_scale([limit], np.zeros(2))
    assert share == pytest.approx(0.5, abs=1e-6)
    assert which == 0
    np.testing.assert_allclose(at, [0.5, 0.5], atol=1e-6)
    # About another nominal point: 0.5 + 0.5 s + 2 s = 1.5.
    share, _, at = find_max_scale([limit], np.array([0.5, 0.0]))
    assert share == pytest.approx(0.4, abs=1e-6)
    np.testing.assert_allclose(at, [0.7, 0.4], atol=1e-6)
    assert find_max_scale([Limit(surrogate, "at_most", 3.1)], np.zeros(2))[:2] == (1.0, None)
    assert find_max_scale([Limit(surrogate, "at_most", -0.1)], np.zeros(2))[:2] == (0.0, 0)


def landing(x: np.ndarray) -> np.ndarray:
    """Time of reaching a height that is reached only where the first parameter is above -0.2."""
    return np.where(x[:, 0] > -0.2, 2.0 - x[:, 0] + 0.1 * x[:, 1], np.nan)


def test_what_was_simulated_is_foretold_as_it_was():
    """By a polynomial that misses runs, and no more so between them."""
    points = runs(2, order=3, held_out=4)
    x, y = points.T
    values = x + y**2 / 2 + 0.02 * np.sin(25 * x + 17 * y)
    found = fit_scalar(points, values)
    assert found.fit.kind.startswith("polynomial")
    missed = np.abs(found.trend.evaluate(points) - values).max()
    assert missed > 0.01 * np.ptp(values)
    np.testing.assert_allclose(found.evaluate(points), values, atol=1e-9)
    assert found.range().high == pytest.approx(values.max(), abs=1e-9)
    places = np.random.default_rng(1).uniform(-1, 1, (1000, 2))
    assert np.abs(found.evaluate(places) - found.trend.evaluate(places)).max() < missed


def test_no_error_is_known_of_what_happens_in_one_run_of_several():
    points = np.array([[-1.0], [0.0], [1.0]])
    found = fit_scalar(points, np.array([1.0, np.nan, np.nan]), latest=2.0)
    assert found.error == np.inf
    share, open_ = share_of_box([Limit(found, "at_most", 0.9)], np.ones(1))
    assert share == 0.0
    assert 0.5 <= open_ < 0.7  # at least what lies beside that run
    assert fit_scalar(points[:1], np.array([1.0])).error == 0.0  # of a box without width


def test_what_does_not_happen_everywhere_has_a_share():
    points = np.linspace(-1, 1, 41)[:, None]
    values = np.where(points[:, 0] > -0.2 + 1e-9, 2.0 - points[:, 0], np.nan)
    surrogate = fit_scalar(points, values)
    share, open_ = share_of_box([Limit(surrogate, "happens", 1.0)], np.ones(1))
    # The border is somewhere between the runs at -0.2 and -0.15.
    assert share == pytest.approx((1 + 0.175) / 2, abs=1e-3)
    assert open_ == pytest.approx(0.05 / 4, abs=1e-3)
    asked = surrogate.occurrence.infill_points(5)[:, 0]
    assert asked[0] == pytest.approx(-0.175, abs=1e-3)
    np.testing.assert_allclose(np.diff(np.sort([*asked, -0.2, -0.15])), 0.05 / 6, atol=2e-3)
    found = surrogate.range()
    assert found.low == pytest.approx(1.0)
    assert found.high == pytest.approx(2.175, abs=1e-3)
    never = fit_scalar(points, np.full(41, np.nan))
    assert share_of_box([Limit(never, "happens", 1.0)], np.ones(1)) == (0.0, 0.0)
    assert np.isnan(never.range().low)
    assert np.isnan(never.error)


def test_what_only_comes_too_late_is_told_by_its_time():
    """A time of 2 + x y + x within 2.5 s: where x (1 + y) <= 0.5."""
    points = runs(2, held_out=8)
    time = 2 + points[:, 0] * points[:, 1] + points[:, 0]
    surrogate = fit_scalar(points, np.where(time <= 2.5, time, np.nan), latest=2.5)
    share, open_ = share_of_box([Limit(surrogate, "happens", 1.0)], np.ones(2))
    # Less than the whole square by the area between y = 0.5 / x - 1 and 1, for x from 1/4 to 1.
    assert share == pytest.approx(1 - (1.5 - 0.5 * np.log(4)) / 4, abs=1e-3)
    assert open_ < 1e-4  # what the spline through the runs, the other kind of fit, would tell
    assert surrogate.range().high == pytest.approx(2.5, abs=1e-3)
    # Runs that would have been in time, but in which it does not happen: the nearest runs tell.
    missed = np.where((time <= 2.5) & (points[:, 0] > -0.5), time, np.nan)
    other = fit_scalar(points, missed, latest=2.5)
    assert type(other.occurrence) is type(fit_scalar(points, missed).occurrence)
    assert other.occurrence.open_fraction > 0.1
    # Nor can it be later there than runs last.
    assert fit_scalar(points, missed).range().high > 2.51
    assert other.range().high <= 2.5


def test_a_number_that_can_not_be_negative_is_not():
    points = runs(1)
    values = np.maximum(points[:, 0], 0.0)
    assert fit_scalar(points, values).range().low < -0.01
    assert fit_scalar(points, values, limits=(0.0, np.inf)).range().low == 0.0
    surrogate = fit_scalar(points, -values, limits=(-np.inf, 0.0))
    assert surrogate.range().high == 0.0
    assert estimate_bounds(surrogate, points, -values)[1].error == 0.0


def test_limits_where_something_does_not_happen():
    points = runs(2, order=16, held_out=8)
    surrogate = fit_scalar(points, landing(points))
    ends = -np.ones(2), np.ones(2)
    assert Limit(surrogate, "at_most", 5.0).worst(*ends)[0] == -np.inf
    assert Limit(surrogate, "at_most", 5.0).best(*ends)[0] == pytest.approx(4.1)
    there = np.array([0.5, -1.0]), np.array([1.0, 1.0])
    assert Limit(surrogate, "at_most", 5.0).worst(*there)[0] == pytest.approx(3.4)
    for level, kept in ((1.0, there), (0.0, (-np.ones(2), np.array([-0.5, 1.0])))):
        limit = Limit(surrogate, "happens", level)
        assert limit.worst(*kept)[0] == np.inf
        slack, at = limit.worst(*ends)
        assert slack == -np.inf
        assert np.isfinite(landing(at[None])[0]) != bool(level)
        share, _ = share_of_box([limit], np.ones(2))
        assert share == pytest.approx(0.6 if level else 0.4, abs=0.05)


@pytest.mark.parametrize(("kind", "level"), [("at_most", 3.0), ("at_least", 3.0), ("happens", 1.0),
                                             ("happens", 0.0)])  # fmt: skip
def test_the_worst_and_the_best_place_lie_in_the_part_that_is_asked(kind, level):
    points = runs(2, order=16, held_out=8)
    limit = Limit(fit_scalar(points, landing(points)), kind, level)
    rng = np.random.default_rng(7)
    for _ in range(12):
        lower, upper = np.sort(rng.uniform(-1, 1, (2, 2)), axis=0)
        found = []
        for place in (limit.worst, limit.best):
            slack, at = place(lower, upper)
            assert (at >= lower - 1e-9).all() and (at <= upper + 1e-9).all()
            found.append(slack)
        assert found[0] <= found[1]


def test_the_best_choice_of_a_stiffness_is_that_of_the_closed_form():
    """Opening in at least a time, with the stiffness known to 5 %, as soon as may be at the latest.

    t = c / sqrt(k); the earliest, at 1.05 k, must not be before 1.8 by the error of the fit:
    k = (c / (1.8 + error))² / 1.05.
    """
    low, high, c = 0.05 * 0.95, 0.2 * 1.05, 0.6
    points = runs(1, order=16, held_out=4)
    k = low + (points[:, 0] + 1) / 2 * (high - low)
    surrogate = fit_scalar(points, c / np.sqrt(k))

    def box(choice):
        ends = np.array([0.95, 1.05])[:, None] * choice
        return tuple(2 * (ends - low) / (high - low) - 1)

    limits = [Limit(surrogate, "at_least", 1.8)]
    best, grid = ChoiceProblem([Goal(surrogate, "upper")], limits, [(0.05, 0.2)], box).find_best()
    exact = (c / (1.8 + surrogate.error)) ** 2 / 1.05
    assert best.is_safe and surrogate.error < 1e-4
    assert best.values[0] == pytest.approx(exact, rel=1e-6)
    latest = (1.8 + surrogate.error) * np.sqrt(1.05 / 0.95)
    assert best.goals[0] == pytest.approx(latest, rel=1e-6)
    assert len(grid) == 33
    # A window that no choice can keep: the one that breaks it least is in its middle, relative to
    # its ends, in whatever unit one of them is stated: c / 1.8 / sqrt(1.05 k) - 1 = 1 - c / 1.85 /
    # sqrt(0.95 k).
    exact = (c * (1.05**-0.5 / 1.8 + 0.95**-0.5 / 1.85) / 2) ** 2
    for unit in (1.0, 10.0):
        late = fit_scalar(points, unit * c / np.sqrt(k))
        limits = [Limit(surrogate, "at_least", 1.8), Limit(late, "at_most", 1.85 * unit)]
        best, _ = ChoiceProblem([Goal(surrogate, "upper")], limits, [(0.05, 0.2)], box).find_best()
        assert not best.is_allowed
        assert best.values[0] == pytest.approx(exact, rel=1e-4)
        apart = [Limit(surrogate, "at_least", 1.85), Limit(late, "at_most", 1.8 * unit)]
        place = 2 * ((c / 1.82) ** 2 - low) / (high - low) - 1
        assert find_max_scale(apart, np.array([place]))[1] == 0


@pytest.mark.parametrize("start", [0.0, 0.3])  # of a limit; or of where an event happens
@pytest.mark.parametrize(("error", "is_safe"), [(0.02, True), (0.2, False)])
def test_a_choice_keeps_its_limits_by_their_errors_where_one_can(error, is_safe, start):
    """q = x, known to 0.1, from start to 0.4 above: the lowest choice that keeps the error is 0.1 +
    error above the start."""
    points = runs(1, order=4, held_out=2)
    surrogate = fit_scalar(points, (points[:, 0] + 1) / 2)
    surrogate = replace(surrogate, fit=replace(surrogate.fit, left_out=np.full(1, error)))
    limits = [Limit(surrogate, "at_least", 0.0), Limit(surrogate, "at_most", start + 0.4)]
    if start:
        margins = (points[:, 0] + 1) / 2 - start
        event = fit_scalar(points, np.where(margins < 0, np.nan, 1.0), margin=margins)
        event = replace(event, occurrence=replace(event.occurrence, error=error))
        limits[0] = EventLimit(event, "happens", 1.0)
    goals, ends = [Goal(surrogate, "upper")], [(0.0, 1.0)]

    def box(choice):
        return 2 * (choice - 0.1) - 1, 2 * (choice + 0.1) - 1

    problem = ChoiceProblem(goals, limits, ends, box)
    best, trials = problem.find_best()
    assert best.is_allowed and best.is_safe == is_safe
    # Where none keeps the error, the one in the middle is farthest from both limits.
    assert best.values[0] == pytest.approx(start + (0.1 + error if is_safe else 0.2), abs=1e-4)
    safest = problem.find_safest(trials, best)
    assert safest.values[0] == pytest.approx(start + 0.2, abs=1e-4)
    if is_safe:
        low, high = problem.find_safe_range(best, 0)
        assert [low, high] == pytest.approx([start + 0.1 + error, start + 0.3 - error], abs=1e-3)


def test_a_value_that_gains_less_than_the_errors_is_no_safer():
    """1 / (p u), at most 0.9, does not change with the other chosen value, q, but its fit does, by
    its error."""
    points = runs(3, order=5)
    p, u = 1.3 + 0.9 * points[:, 0], 1 + 0.1 * points[:, 2]
    surrogate = fit_scalar(points, 1 / (p * u))

    def box(choice):
        middle = [(choice[0] - 1.3) / 0.9, (choice[1] - 1) / 0.7, 0.0]
        reach = [0.1 * choice[0] / 0.9, 0.2 / 0.7, 1.0]
        return np.clip([np.subtract(middle, reach), np.add(middle, reach)], -1, 1)

    goal = Goal(fit_scalar(points, 0.2 * (1 + 0.7 * points[:, 1]) * p * u), "upper")
    limits, ranges = [Limit(surrogate, "at_most", 0.9)], [(0.6, 2), (0.5, 1.5)]
    problem = ChoiceProblem([goal], limits, ranges, box)
    best, trials = problem.find_best()
    safest = problem.find_safest(trials, best)
    assert safest.values[1] == best.values[1] == pytest.approx(0.5)
    assert safest.values[0] > 1.5 and safest.safety > best.safety + 2


def test_a_box_shrunk_to_a_points_share_just_holds_it():
    rng = np.random.default_rng(3)
    unit, nominal = rng.uniform(-1, 1, (40, 3)), np.array([0.2, -1.0, 0.9])
    for point, share in zip(unit, find_least_scales(nominal, unit), strict=True):
        for less, inside in ((0.0, True), (1e-9, False)):
            lower, upper = sub_box(nominal, share - less)
            assert ((lower <= point + 1e-12) & (point <= upper + 1e-12)).all() == inside
    assert find_least_scales(nominal, nominal[None]) == [0.0]


BORDERS = {
    "plane": (3, lambda x: 0.1 + 0.5 * x[:, 0] + 0.3 * x[:, 1] - 0.2 * x[:, 2]),
    "ball": (3, lambda x: 1.6**2 - ((x - [-0.8, 0.6, 0.3]) ** 2).sum(axis=1)),
    "corner": (2, lambda x: np.minimum(0.6 - x[:, 0] - 0.3 * x[:, 1], x[:, 1] + 0.4)),
    "wave": (2, lambda x: x[:, 1] - 0.2 * np.sin(3 * x[:, 0]) - 0.1),
}


@pytest.mark.parametrize(
    "border",
    ["ball", "wave", *(pytest.param(b, marks=pytest.mark.slow) for b in ("plane", "corner"))],
)
def test_the_share_in_which_something_happens_is_the_true_one_up_to_what_is_open(border):
    """Eight runs at a time, sought where it is open: to 1.5 % of the box after six times."""
    k, slack = BORDERS[border]
    exact = (slack(scan_points(np.ones(k, dtype=bool), 2**15, seed=5)) >= 0).mean()
    points = make_design("smolyak", k, order=3 if k == 2 else 2).points
    for turn in range(7):
        surrogate = fit_scalar(points, np.where(slack(points) >= 0, 1.0, np.nan))
        if turn in (0, 3, 6):
            share, open_ = share_of_box([Limit(surrogate, "happens", 1.0)], np.ones(k))
            assert abs(share - exact) < 1.3 * open_  # beyond it in one of twenty
        points = np.concatenate([points, surrogate.occurrence.infill_points(8)])
    assert abs(share - exact) < 0.015
    assert open_ < 0.06


def test_the_uncertainty_of_a_share_has_the_error_of_its_lines():
    """A sum of eight numbers, which is fitted exactly; its distribution: Irwin (1927), Hall."""
    k, points = 8, make_design("smolyak", 8, order=1).points
    surrogate, rows = fit_scalar(points, points.sum(axis=1)), []
    for level in (-2.2, 0.0, 3.0, 4.5, 5.0):
        share, open_ = share_of_box([Limit(surrogate, "at_most", level)], np.ones(k))
        terms = [
            (-1) ** j * comb(k, j) * ((level + k) / 2 - j) ** k
            for j in range(int(level + k) // 2 + 1)
        ]
        rows.append((abs(share - sum(terms) / factorial(k)), open_))
    errors, opens = np.array(rows).T
    assert (errors <= opens).all() and errors.max() > 3e-4
    assert opens.max() < 0.01


def test_a_difference_of_times_that_the_end_cuts_off_has_the_borders_of_both(monkeypatch):
    """Against counts of the closed form."""
    x = scan_points(np.ones(3, bool), 60)

    def times(x):
        pair = 0.9 + 0.2 * x[:, 0] + 0.1 * x[:, 2], 1.0 / (1.0 - 0.2 * x[:, 1] - 0.1 * x[:, 0])
        return [np.where(t <= 1.0, t, np.nan) for t in pair]

    first, second = times(x)
    columns = ((first, 1.0), (second, 1.0), (first - second, None))
    surrogates = share_borders([fit_scalar(x, values, end) for values, end in columns])
    many = times(scan_points(np.ones(3, bool), 2**16, seed=3))
    lag = many[0] - many[1]
    for level, true in ((-0.05, lag >= -0.05), (None, np.isfinite(lag))):
        limit = Limit(surrogates[2], *(("happens", 1.0) if level is None else ("at_least", level)))
        share, open_ = share_of_box([limit], np.ones(3))
        assert abs(share - true.mean()) <= open_ < 0.01
    calls, decide = [], FittedOccurrence._decide
    monkeypatch.setattr(
        FittedOccurrence, "_decide", lambda part, x: calls.append(part) or decide(part, x)
    )
    limit.conditions(x + 0.0)  # of the joint border, and of its band
    assert len(calls) == 2


@pytest.mark.parametrize("count", [20, 40])
def test_a_root_of_margins_that_no_fit_describes_predicts_no_better_than_these(count):
    """The value is exact in its run's margin, which jumps and bends where the event ceases."""

    def told(x):
        slack = 0.2 + 0.7 * x[:, 0] - 0.5 * x[:, 1] ** 2
        values = x[:, 1] + np.sqrt(np.maximum(slack, 0.0) + 0.3)
        margins = np.where(slack > 0, slack + 0.3, 5.0 * slack)
        return np.where(slack > 0, values, np.nan), margins

    points = np.concatenate([runs(2, order=2), scan_points(np.ones(2, bool), count, corners=False)])
    values, margins = told(points)
    surrogate, x = fit_scalar(points, values, margin=margins), scan_points(np.ones(2, bool), 4096)
    errors = surrogate.predict(x) - told(x)[0]
    assert np.sqrt(np.nanmean(errors**2)) < 2.0 * surrogate.fit.mean_error < 0.04


def settling(x: np.ndarray) -> np.ndarray:
    """A number that rises to 1 along a direction, and stays there."""
    along = 0.44 - x @ [1.0, -0.9, 0.3, -0.3]
    return np.where(along < 0, 1.0, 1.0 - 0.3 * np.maximum(along, 0.0) - 0.1 * along**2)


SHAPES = {
    "kinks": (3, lambda x: x.max(axis=1), 0.7, 12),
    "kinks that meet at corners": (2, lambda x: np.abs(x).max(axis=1), 0.55, 90),
    "a jump": (2, lambda x: np.where(x.sum(axis=1) > 0.3, 1.0, 0.0) + 0.05 * x[:, 0], 0.5, 18),
    "a level just below a plateau": (4, settling, 0.9999, 30),
    "powers of eight numbers": (8, lambda x: (x**4).sum(axis=1), 2.0, 20),
    "an exponential of seven": (7, lambda x: np.exp(x.sum(axis=1)), 0.65, 20),
    "a wave across seven": (7, lambda x: np.sin(x.sum(axis=1)), 0.5, 40),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_shares_of_closed_forms_lie_within_their_uncertainty(shape):
    """By runs of a sparse grid and others spread over the box."""
    k, function, level, count = SHAPES[shape]
    grid = make_design("smolyak", k, order=2).points
    points = np.concatenate([grid, scan_points(np.ones(k, bool), count, corners=False)])
    limit = Limit(fit_scalar(points, function(points)), "at_most", level)
    share, open_ = share_of_box([limit], np.ones(k), lines=256)
    exact = (function(np.random.default_rng(0).uniform(-1, 1, (100_000, k))) <= level).mean()
    assert abs(share - exact) <= open_ < 0.15


def test_a_kind_of_fit_that_predicts_far_worse_has_no_say():
    """A polynomial that is exact, and a spline that is not: half the ball of radius 1."""
    limit = Limit(fitted(lambda x: (x**2).sum(axis=1), 3, order=2), "at_most", 1.0)
    share, open_ = share_of_box([limit], np.ones(3), lines=512)
    other, _ = share_of_box([limit.rival], np.ones(3), lines=512)
    assert abs(share - np.pi / 6) <= open_ + 1e-3 < 0.2 * abs(other - share)
