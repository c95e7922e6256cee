"""Shares of the box carry the whole error: the truth, which is that of no step and no mesh, lies
within what is open; and "all" is said only where nothing is."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from closed_boxes import LATEST, Closed, ClosedBench, without_runs

from deployable.campaign.answers import discretization, limits
from deployable.campaign.answers.discretization import (
    estimate_discretization_errors,
    estimate_fraction_errors,
)
from deployable.campaign.answers.limits import (
    LimitAssessment,
    LimitSpec,
    _combine,
    _worst_of_halves,
    assess_limits,
)
from deployable.campaign.answers.quantity_bounds import _turning_points, converge_bounds
from deployable.campaign.plan.plan import RunAccount
from deployable.campaign.text.numbers import interval
from deployable.intervals import Box
from deployable.intervals.designs import scan_points
from deployable.intervals.scalars import (
    Limit,
    Occurrence,
    ScalarSurrogate,
    fit_scalar,
    share_of_box,
)
from deployable.intervals.scalars.fits import choose_fit
from deployable.intervals.scalars.occurrence import FittedOccurrence
from evidence.search.fractions import BOXES, is_covered, one_number, play, truths

HAPPENS = LimitSpec("there", 0, "happens", 1.0)
BEYOND_THE_ERROR = 3.0
"""Open is at most so many times what is wrong, on average: continued as of the first order where it
is of the second, which is half as much again, and by stretches that were halved thrice."""


@pytest.fixture(autouse=True)
def _closed(monkeypatch):
    without_runs(monkeypatch)


def shares(closed, *asked, runs=9):
    """The share and what is open of it by step and mesh too, by limit; and what is open without."""
    model = ClosedBench(closed, runs * closed.k)
    ends = converge_bounds(model, 4, asked)
    beyond = np.array(
        estimate_fraction_errors(model, ends, estimate_discretization_errors(model, ends))
    )
    free = np.ones(closed.k)
    rows = []
    for errors in (beyond, None):
        limits = assess_limits(model, model.surrogates(), asked, errors).limits
        rows.append([share_of_box([limit], free) for limit in limits])
    return [(*whole, fit[1]) for whole, fit in zip(*rows, strict=True)]


SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    "kind", [*(pytest.param(kind, marks=SLOW) for kind in ("limit", "margin", "late")), "latch"]
)
def test_the_truth_lies_within_what_step_and_mesh_leave_open(kind):
    """Of a number's limit, of whether it happens, and of both; step and mesh are wrong by a tenth
    of what decides, and what is open by the fit alone leaves the truth out."""
    asked = [LimitSpec("early", 0, "at_most", 1.4)] + [HAPPENS] * (kind != "limit")
    off, wide, blind = [], [], []
    for k, seed in ((1, 11), (2, 22)):
        closed = Closed(kind, k, seed, 0.1)
        for one, (share, open_, by_the_fit) in zip(asked, shares(closed, *asked), strict=True):
            off.append(abs(share - closed.truth(one.kind, one.level)))
            wide.append(open_)
            blind.append(by_the_fit)
    assert (np.array(off) <= wide).all()
    assert np.mean(wide) <= BEYOND_THE_ERROR * np.mean(off)
    assert np.mean(blind) < np.mean(off)


@pytest.mark.parametrize("kind", ["late", pytest.param("latch", marks=SLOW)])
def test_the_error_of_an_end_next_to_a_border_is_known_and_covers_the_true_one(kind):
    """Where the finer run at an end no longer has the number: by the nearest one that has."""
    for k, seed in ((1, 11), (1, 12), (2, 22)):
        closed = Closed(kind, k, seed, 0.1)
        model = ClosedBench(closed, 9 * k)
        (end,) = converge_bounds(model, 4, [HAPPENS])
        step, mesh = (errors[0] for errors in estimate_discretization_errors(model, [end]).values())
        unit = scan_points(np.ones(k, dtype=bool), 2**12)
        truth, _ = closed.told(unit, (0.0, 0.0))
        off = np.abs(np.array(end.outer) - [np.nanmin(truth), np.nanmax(truth)])
        near = 0.02 * np.ptp(truth[np.isfinite(truth)])
        assert (off <= step + mesh + end.surrogate.usual_error + near).all()


@pytest.mark.parametrize("inside", [0, 3, 4, 5, 8, 16, 40])
@pytest.mark.parametrize("outside", [0, 2, 4, 8, 21])
def test_runs_beside_a_border_are_made_again_the_nearest_first(inside, outside):
    """On either side the four nearest ones, then four of the next four, of the next eight and so
    on, until a side has no more; never a round of none."""
    happens = np.arange(inside + outside) < inside
    rng = np.random.default_rng(inside + outside)
    size = rng.permutation(inside + outside).astype(float)
    rounds = list(discretization._iterate_rows(size, happens))
    assert all(len(rows) for rows in rounds)
    for side in (happens, ~happens):
        order = np.flatnonzero(side)[np.argsort(size[side])]
        taken = [list(rows[side[rows]]) for rows in rounds]
        expected, first, last = [], 0, 4
        while len(expected) < len(rounds):
            expected.append(list(order[first:last][:: max(1, (last - first) // 4)]))
            first, last = last, 2 * last
        assert taken == expected
        assert first >= len(order), "the farthest are among them"


def test_a_border_moves_to_where_finer_runs_cease_to_differ():
    """Of what happens above x = 0, and by finer runs above 0.3: twice the decision value there, as
    the rest of the way counts as much again."""
    x = np.linspace(-1, 1, 21)[:, None]
    model = SimpleNamespace(
        points=x, numbers=np.where(x > 0.01, 1.0, np.nan), margins=np.nan * x, account=RunAccount()
    )

    def told(plan, points):
        x = np.array(points)
        return np.where(x > 0.3, 1.0, np.nan), np.full(x.shape, np.nan)

    model.evaluate = told
    occurrence = Occurrence(x, np.isfinite(model.numbers[:, 0]))
    found, _ = discretization.estimate_limit_state_error(model, 0, occurrence, None)
    there = float(occurrence.decision(np.array([[0.3]]))[0])
    assert found == pytest.approx(2 * there, rel=0.05)
    limit = Limit(ScalarSurrogate(None, occurrence), "happens", 1.0, border_error=found)
    share, open_ = share_of_box([limit], np.ones(1))
    assert share - open_ < 0.35 < share


def test_runs_that_the_limit_does_not_allow_are_no_runs_without_the_event():
    """Five of the runs next to a border may be made: none of four and four is."""
    x = np.linspace(-1, 1, 21)[:, None]
    model = SimpleNamespace(
        points=x, numbers=np.where(x > 0.01, 1.0, np.nan), margins=np.nan * x, account=RunAccount(5)
    )
    model.evaluate = lambda plan, points: (_ for _ in ()).throw(AssertionError("not allowed"))
    occurrence = Occurrence(x, np.isfinite(model.numbers[:, 0]))
    shift, _ = discretization.estimate_limit_state_error(model, 0, occurrence, None)
    assert shift == 0.0


@pytest.mark.parametrize("jump", [0.0, 100.0])
def test_a_margin_that_jumps_in_finer_runs_moves_its_border_by_what_changes_sides(jump):
    """Runs from 0 to 0.1 change sides; their margins fall by 0.1, and one of two by 100."""
    x = np.linspace(-1, 1, 41)[:, None]
    fit = choose_fit(x, x[:, 0])
    happens = x[:, 0] >= 0
    occurrence = FittedOccurrence(x, happens, fit, fit.error)
    model = SimpleNamespace(
        points=x, numbers=np.where(happens[:, None], 1.0, np.nan), margins=x, account=RunAccount()
    )

    def evaluate(plan, points):
        fine = np.array(points) - 0.101
        other_comes_first = np.abs(np.array(points) - 0.05) < 0.01
        return np.where(fine >= 0, 1.0, np.nan), fine - jump * other_comes_first

    model.evaluate = evaluate
    shift, _ = discretization.estimate_limit_state_error(model, 0, occurrence, None)
    assert 0.1 <= shift <= 0.41


@pytest.mark.parametrize("happens", [True, False])
def test_stretches_lead_from_the_farthest_runs_that_differ_to_the_nearest_that_does_not(happens):
    """Eight at most, the farthest from the border first, and on their side of it."""
    x = np.arange(24.0)
    differ = x < 12
    sides = np.where(x < 20, happens, not happens)
    size = np.abs(x - 3.2)
    points = np.column_stack([x - 14.0, 0.5 * x, 0 * x])
    first, second = discretization._find_segments(points, sides, differ, size)
    assert (first[:, 0] + 14).tolist() == [11, 10, 9, 8, 7, 0, 6, 1]
    assert second.tolist() == [[-2.0, 6.0, 0.0]] * 8
    for none in discretization._find_segments(points, sides, sides == happens, size):
        assert none.shape == (0, 3), "all of that side differ"
    assert discretization._bisect_segments(None, 0, None, None, *[np.zeros((0, 3))] * 2) == 0.0


def test_a_border_that_no_number_tells_of_does_not_move():
    """All runs have the number, and none, or not all, tell by how much."""
    for margins in ([np.nan] * 4, [np.nan, 1.0, 1.0, 1.0]):
        model = SimpleNamespace(numbers=np.ones((4, 1)), margins=np.array(margins)[:, None])
        border, number = discretization.estimate_limit_state_error(
            model, 0, SimpleNamespace(is_mixed=False), None
        )
        assert border == 0.0 and np.isnan(number)


def test_the_places_that_decide_a_limit_are_simulated_before_a_statement_about_them():
    """Also where the iterations for bounds end before: of exp(a + b − 2), which is at most 0.7 in
    a box of 1 + ln(0.7)/2 of the widths."""
    model = ClosedBench(Closed("limit", 2, 11, 0.0), 9)
    model.of = SimpleNamespace(
        told=lambda unit, plan: (np.exp(unit.sum(axis=1) - 2), np.full(len(unit), np.nan))
    )
    model.numbers, _ = model.evaluate(model.plan, model.points)
    asked = LimitSpec("low", 0, "at_most", 0.7)
    converge_bounds(model, 1, [asked])
    found = assess_limits(model, model.surrogates(), [asked])
    assert model.find_missing(found.points) == []
    assert found.largest[0] == pytest.approx(1 + np.log(0.7) / 2, abs=1e-4)
    assert np.exp(found.failure_point.sum() - 2) > 0.7


@pytest.mark.parametrize("iterations", [0, 1, 2])
def test_a_time_that_grows_towards_where_it_ceases_is_never_told_an_upper_end(iterations):
    """Beside a separatrix, however few runs there are: minus the logarithm of the distance from it,
    which no margin tells."""
    model = ClosedBench(Closed("late", 2, 11, 0.0), 12)

    def told(unit, plan):
        energy = unit[:, 0] + 0.3 * unit[:, 1] ** 2 - 0.2
        with np.errstate(invalid="ignore"):
            time = 0.6 - 0.05 * np.log(np.where(energy > 0, energy, np.nan))
        return time, np.full(len(unit), np.nan)

    model.of = SimpleNamespace(told=told)
    model.numbers, model.margins = model.evaluate(model.plan, model.points)
    (end,) = converge_bounds(model, iterations)
    is_told = end.outer[1] == LATEST
    assert is_told or end.may_be_endless
    assert is_told == (iterations > 0)
    row = {"lower": 0.6, "upper": 1.8, "error": 0.6, "units": "s", "may_be_endless": True}
    assert interval(row) == "0.6 to 1.8 s (it may have no upper end)"


@pytest.mark.parametrize(
    ("shape", "is_endless"),
    [
        (lambda s: -0.02 * np.log(np.abs(s)), True),
        (lambda s: np.where(s > 0, -0.02, -0.03) * np.log(np.abs(s)), True),
        (lambda s: 0.02 * np.abs(s) ** -0.25, True),
        (lambda s: np.where(s > 0, -0.02 * np.log(np.abs(s)), np.nan), True),
        (lambda s: np.where(s > 0, 0.3 - 0.2 * np.sqrt(np.abs(s)), np.nan), False),
        (lambda s: 0.3 - 0.2 * np.sqrt(np.abs(s)), False),
        (lambda s: np.where(s > 0, 0.3 - 0.2 * np.sqrt(np.abs(s)), -0.2), False),
        (lambda s: 0.3 - 0.2 * np.abs(s), False),
        (lambda s: np.where(s > 0, 0.3 - 0.1 * s, -0.2), False),
        (lambda s: 0.3 - 0.2 * s**2, False),
    ],
)
def test_only_a_time_that_grows_with_every_halving_has_no_upper_end(shape, is_endless):
    """By the distance s from a curve in the box: logarithms and a power; roots, with and without
    the event beyond, a corner, a jump, a parabola."""
    model = ClosedBench(Closed("late", 2, 11, 0.0), 17)

    def told(unit, plan):
        distance = unit[:, 0] + 0.3 * unit[:, 1] ** 2 - 0.137
        return 0.6 + shape(distance) + 0.05 * unit[:, 1], np.full(len(unit), np.nan)

    model.of = SimpleNamespace(told=told)
    model.numbers, model.margins = model.evaluate(model.plan, model.points)
    start = model.points, model.numbers, model.margins
    (end,) = converge_bounds(model, 2)
    assert (end.outer[1] == LATEST or end.may_be_endless) == is_endless
    # The bounds are by all runs, also where too few follow the end to tell.
    model.points, model.numbers, model.margins = start
    model.refinements, model.max_refinements = [], 36
    (end,) = converge_bounds(model, 2)
    assert end.surrogate is model.surrogates()[0]


def test_a_number_that_finer_runs_lose_everywhere_leaves_all_open():
    """All runs have it, and that at an end no longer with half the step."""
    model = ClosedBench(Closed("latch", 1, 11, 0.0), 9)
    model.numbers[:] = 1.0 + model.points
    model.evaluate = lambda plan, points: (np.full((len(points), 1), np.nan),) * 2
    ends = converge_bounds(model, 0)
    beyond = np.array(
        estimate_fraction_errors(model, ends, estimate_discretization_errors(model, ends))
    )
    limits = assess_limits(model, model.surrogates(), [HAPPENS], beyond).limits
    assert share_of_box(limits, np.ones(1)) == (1.0, 1.0)


def verdict(kind, numbers, margins=np.nan, asked=HAPPENS, beyond=(0.0, 0.0), free=1.0):
    """`met` of runs with a number and a margin each, over a box of one direction."""
    unit = np.linspace(-1, 1, len(numbers))[:, None] * free
    model = ClosedBench(Closed(kind, 1, 0, 0.0), 9)
    model.around.box = Box(["a"], [0.0], [free])
    model.around.nominal = np.array([free / 2])
    model.points, model.numbers = unit, np.array(numbers, dtype=float)[:, None]
    model.margins = np.broadcast_to(margins, len(numbers))[:, None]
    found = assess_limits(model, model.surrogates(), [asked], np.array(beyond)[:, None])
    shares = limits._find_shares(model, found)
    return limits._judge_limits(model, found, (0,), shares)["met"]


X = np.linspace(-1, 1, 9)


def test_all_is_said_where_nothing_is_open_and_no_margin_is_below_its_error():
    at_most = LimitSpec("low", 0, "at_most", 2.0)
    assert verdict("limit", X, asked=at_most) == "all"
    assert verdict("limit", X, asked=at_most, beyond=(0.9, 0.0)) == "all"
    assert verdict("limit", X, asked=at_most, beyond=(1.1, 0.0)) == "undecided"
    assert verdict("limit", X + 1.5, asked=at_most) == "some"
    # A spline goes beyond the step by more than its error says; no run does.
    steps = np.where(np.abs(X) < 0.4, -1e3 * (X < 0), 1.99 * (X > 0) - 1e3 * (X < 0))
    assert verdict("limit", steps, asked=at_most) == "undecided"
    assert (
        verdict("limit", np.abs(np.sin(9 * X)), asked=LimitSpec("low", 0, "at_most", 1.05))
        == "undecided"
    )


def test_what_happened_in_all_runs_is_no_proof_without_a_margin():
    """A latch that catches in nine runs may miss between them; a crossing that goes far beyond its
    level may not, unless by less than step and mesh change."""
    assert verdict("latch", 0 * X + 1) == "undecided"
    assert verdict("latch", [1.0], free=0.0) == "all"
    assert verdict("margin", 0 * X + 1, 2 + X) == "all"
    assert verdict("margin", 0 * X + 1, 2 + X, beyond=(0.0, 1.1)) == "undecided"
    never = LimitSpec("never", 0, "happens", 0.0)
    assert verdict("latch", np.nan * X, asked=never) == "undecided"
    assert verdict("margin", np.nan * X, X - 2, asked=never) == "all"
    assert verdict("margin", np.nan * X, X - 2, asked=never, beyond=(0.0, 1.1)) == "undecided"
    assert verdict("latch", np.where(X > 0, 1, np.nan)) == "some"


def test_a_share_that_no_run_tells_is_open_with_half_an_interval_too():
    """No run of 64 has the event, which happens in 0.08 % of the box, and none refutes it."""

    def spot(x):
        return np.where(((x - [0.31, 0.17]) ** 2).sum(axis=1) < 1e-3, 1.0, np.nan)

    box = one_number("spot", 2, spot, np.inf)
    rows = play(box, "default", box.truth())
    assert [row["kind"] for row in rows] == ["fraction", *2 * ["halved", "gain"]]
    assert {row["said"] for row in rows} == {0.0} and {row["open"] for row in rows} == {1.0}


def test_a_fit_to_a_grid_is_tested_about_the_border_of_a_limit():
    """A step of 0.1 between two levels of the grid, beside which every fit to its runs is exact."""
    (box,) = (box for box in BOXES if box.name == "small step")
    rows = [row for row in play(box, "default", truths()[box.name]) if row["kind"] == "fraction"]
    assert [row["fraction"] for row in rows] == ["at most 0.2", "at most 0.5"]
    assert all(map(is_covered, rows)) and all(0 < row["open"] < 0.02 for row in rows)


@pytest.mark.parametrize(("count", "half"), [(24, 0.15), (32, 0.1)])
def test_a_band_in_which_one_run_lies_is_covered(count, half):
    """Of |x - 0.3 y - 0.2| below its half width: the smooth border closes about the run, and its
    own band is too narrow by half; the nearest runs tell more."""
    points = scan_points(np.ones(2, dtype=bool), count)
    happens = np.abs(points @ [1.0, -0.3] - 0.2) < half
    assert happens.sum() == 1
    limit = Limit(ScalarSurrogate(None, Occurrence(points, happens)), "happens", 1.0)
    share, open_ = share_of_box([limit], np.ones(2))
    assert 0.5 * open_ < half - share < open_ < share + 0.02


def test_further_runs_that_fail_end_the_search_and_not_the_campaign():
    """A third of the runs may fail, and every further one does."""
    model = ClosedBench(Closed("limit", 1, 11, 0.0), 9)
    model.around.solver.failures = 0.3

    def evaluate(plan, points):
        run = SimpleNamespace(id=tuple(points[0].tolist()), normalized=points[0])
        model.failures = [*model.failures, SimpleNamespace(run=run)]
        return np.full((2, 1, 1), np.nan)

    model.evaluate = evaluate
    for x in np.linspace(0.01, 0.99, 20):
        model.add([np.array([x])])
    runs = len(model.points) + len(model.failures)
    assert 0.3 * (runs - 1) < len(model.failures) <= 0.3 * runs + 1


@pytest.mark.parametrize("size", [0.0, 1e-14])
def test_what_only_rounding_varies_needs_no_further_runs(size):
    """Beside the 13 of the design, but one or two at the limit's worst place."""
    box = one_number("still", 2, lambda x: 2 + size * np.sin(50 * x[:, 0] + 31 * x[:, 1]), 3.0)
    (row, *_) = play(box, "default", box.truth())
    assert row["runs"] <= 15 and row["met"] == "all"


@pytest.mark.parametrize(
    ("free", "slack", "kind", "margins", "sure"),
    [
        ([False, False], 0.0, "largest", [0.0], True),  # one run is the whole box
        ([True, False], 0.09, "largest", [0.0], False),
        ([True, False], 0.11, "largest", [0.0], True),
        ([True, True], 0.11, "event", [1.0, 1.5, 2.0], True),
        ([True, True], 0.09, "event", [1.0, 1.5, 2.0], False),
        ([True, True], 0.11, "event", [0.1, 0.5, 0.9], False),  # may not happen between the runs
        ([True, True], 0.11, "event", [1.0, np.nan, 2.0], False),
        ([True, True], np.nan, "event", [1.0, 1.5, 2.0], False),
    ],
)
def test_what_no_run_breaks_is_sure_beyond_the_errors(free, slack, kind, margins, sure):
    """Of the number, 0.1, and of where it exists, 0.2; of a time without upper end, nothing is."""
    number = SimpleNamespace(always_exists=kind == "largest")
    box = SimpleNamespace(free=np.array(free))
    model = SimpleNamespace(
        experiment=SimpleNamespace(box=box, quantity_list=[number]),
        margins=np.array(margins)[:, None],
        points=np.linspace(-1, 1, len(margins))[:, None],
    )
    limit = SimpleNamespace(kind="at_most", error=0.1, border_error=0.2)
    for endless in ((), (0,)):
        result = SimpleNamespace(
            limits=[limit], specs=[SimpleNamespace(quantity=0)], worst=[(slack, None)],
            endless=endless,
        )  # fmt: skip
        assert limits.is_shown(model, result, 0) is (sure and not (endless and any(free)))
    # Of a limit that a run breaks, what it needs to exist may still fail between the runs.
    result.margins = -np.ones((1, len(margins)))
    is_sure_event = margins == [1.0, 1.5, 2.0]
    assert bool(limits.is_open(model, result, 0)) is (kind == "event" and not is_sure_event)


@pytest.mark.parametrize(
    ("kind", "level", "margins", "refuted"),
    [
        ("happens", 1.0, [-1.0, -1.5, -2.0], True),
        ("happens", 1.0, [-0.1, -0.5, -0.9], False),  # it may happen between the runs
        ("happens", 1.0, [np.nan, np.nan, np.nan], False),  # nothing is known between them
        ("happens", 0.0, [1.0, 1.5, 2.0], True),
        ("at_most", 0.7, [np.nan, np.nan, np.nan], False),
        ("at_most", 0.7, [-1.0, -1.5, -2.0], True),
    ],
)
def test_what_no_run_keeps_is_refuted_beyond_the_errors(kind, level, margins, refuted):
    number = SimpleNamespace(always_exists=False)
    model = SimpleNamespace(
        experiment=SimpleNamespace(
            box=SimpleNamespace(free=np.array([True])), quantity_list=[number]
        ),
        margins=np.array(margins)[:, None],
        points=np.linspace(-1, 1, 3)[:, None],
    )
    limit = SimpleNamespace(
        kind=kind, level=level, border_error=0.2, surrogate=SimpleNamespace(fit=None)
    )
    result = SimpleNamespace(limits=[limit], specs=[SimpleNamespace(quantity=0)])
    assert limits.is_refuted(model, result, 0) is refuted


@pytest.mark.parametrize(
    ("level", "error", "refuted"), [(0.2, 0.1, True), (0.2, 0.3, False), (1.5, 0.1, False)]
)
def test_a_level_that_no_run_keeps_is_refuted_by_the_bounds_and_their_error(level, error, refuted):
    """Of y = 0.5 + x / 10, at most a level."""
    x = np.linspace(-1, 1, 9)[:, None]
    surrogate = fit_scalar(x, 0.5 + x[:, 0] / 10)
    box = SimpleNamespace(free=np.array([True]))
    model = SimpleNamespace(experiment=SimpleNamespace(box=box))
    limit = Limit(surrogate, "at_most", level, run_error=error)
    result = SimpleNamespace(limits=[limit], specs=[SimpleNamespace(quantity=0)])
    assert limits.is_refuted(model, result, 0) is refuted


@pytest.mark.parametrize(
    ("kind", "level", "odd", "share", "place"),
    [
        ("at_most", 0.7, [], 0.5, 0.7003),  # a little beyond the border, from the nominal 0.4
        ("at_most", 0.7, [(0.55, 0.75), (0.95, 0.96)], 0.25, 0.55),  # the nearest run that fails
        ("at_most", 0.7, [(0.95, 0.96)], 0.5, 0.7003),
        ("at_most", 0.7, [(0.45, 0.7)], 0.5, 0.7003),  # just at the limit, which keeps it
        ("at_least", -0.3, [], 0.5, -0.3007),
        ("at_most", 1.5, [], 1.0, None),
        ("at_most", 1.5, [(-0.6, 1.6), (0.8, 1.7)], 2 / 3, 0.8),
    ],
)
def test_the_largest_box_ends_at_the_nearest_failure(kind, level, odd, share, place):
    """Of y = x over [-1, 1], where some runs are otherwise: by the surrogate or by a run."""
    x = np.linspace(-1, 1, 9)[:, None]
    surrogate = fit_scalar(x, x[:, 0])
    points = np.concatenate([x, np.array(odd).reshape(-1, 2)[:, :1]])
    numbers = np.concatenate([x, np.array(odd).reshape(-1, 2)[:, 1:]])
    box = SimpleNamespace(free=np.array([True]))
    model = SimpleNamespace(
        experiment=SimpleNamespace(box=box),
        nominal=np.array([0.4]),
        points=points,
        numbers=numbers,
        failed_points=np.zeros((0, 1)),
    )
    found = assess_limits(model, [surrogate], [LimitSpec("r", 0, kind, level)])
    assert found.largest[0] == pytest.approx(share, abs=1e-5)
    if place is None:
        assert found.failure_point is None and found.largest[1:] == (None, None)
    else:
        assert found.failure_point == pytest.approx([place], abs=1e-4) and found.largest[1] == 0
        assert found.points[-1] is found.failure_point
    expected = level - numbers[:, 0] if kind == "at_most" else numbers[:, 0] - level
    assert found.margins[0] == pytest.approx(expected)


def test_where_turns_of_several_parameters_meet_there_is_a_run():
    """As at the peak of a product of needles, which no line through the nominal values meets."""
    turns = {"a": [4.3], "b": [], "c": [-2.0, 5.0]}
    interval = SimpleNamespace(lower=-10.0, upper=10.0)
    experiment = SimpleNamespace(
        intervals=dict.fromkeys(turns, interval), nominal=[0.0, 1.0, 0.0], parameters=dict,
        scene_type=SimpleNamespace(find_turns=lambda values, name, *ends: turns[name]),
    )  # fmt: skip
    model = SimpleNamespace(
        experiment=experiment, numbers=np.zeros((1, 1)), nominal=np.array([0.0, 0.1, 0.0]),
        points=np.zeros((1, 3)),
    )  # fmt: skip
    points = np.round(_turning_points(model), 9).tolist()
    assert [0.43, 0.1, 0.0] in points and [0.0, 0.1, -0.2] in points
    assert [0.43, 0.1, -0.2] in points and [0.43, 0.1, 0.5] in points
    assert [0.43, 1.0, -0.2] in points and [0.43, -1.0, 0.5] in points


def test_a_halved_tolerance_that_leaves_a_limit_within_its_error_leaves_its_share_open():
    """t = x of x, y in [-1, 1]² with t <= 1.05 ± 0.1: only half of x gives more room than that."""
    points = scan_points(np.ones(2, dtype=bool), 25)
    limit = Limit(fit_scalar(points, points[:, 0]), "at_most", 1.05, run_error=0.1)
    spec = LimitSpec("r", 0, "at_most", 1.05)
    corner = np.ones(2)
    result = LimitAssessment(
        [spec], [limit], 1.05 - points[None, :, 0], [limit.worst(-corner, corner)],
        (1.0, None, None), None,
    )  # fmt: skip
    box = Box(["x", "y"], [-1.0, -1.0], [1.0, 1.0])
    model = SimpleNamespace(
        experiment=SimpleNamespace(box=box, quantity_list=[SimpleNamespace(always_exists=True)]),
        nominal=np.zeros(2), points=points, distinct_rows=np.arange(len(points)), rest_count=0,
        failed_points=np.zeros((0, 2)),
    )  # fmt: skip
    shares, halves = {(0,): (1.0, 0.0)}, _worst_of_halves(model, result)
    halved = _combine(model, result, shares, halves)["halved"]
    assert halved["x"]["share"] == halved["y"]["share"] == 1.0
    assert halved["x"]["share_uncertainty"] == 0.0
    assert halved["y"]["share_uncertainty"] == pytest.approx(3 / len(points))
