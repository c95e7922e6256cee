"""Event-aligned surrogates on a bouncing ball, against a dense scan and the plain surrogate."""

import numpy as np
import pytest
from ball import ball, bounces
from datasets_for_tests import ball_reference, ball_samples

from deployable.intervals import (
    IntervalError,
    bounds_dataset,
    compare_bounds,
    make_design,
    split_design,
)
from deployable.intervals.models.aligned.composed import EventModel, fit_event_model
from deployable.intervals.models.aligned.elements import Element, split_elements
from deployable.intervals.models.aligned.impacts import (
    add_anchors,
    anchor_delays,
    common_prefix,
    find_impacts,
)
from deployable.intervals.models.aligned.model import _fit_element, _with_runs
from deployable.intervals.models.aligned.search import event_range
from deployable.intervals.surrogate import Surrogate


@pytest.fixture(scope="module")
def reference():
    return ball_reference()


def integrated(bounds, name, reference):
    time, low, high = reference
    row = ["z", "v"].index(name)
    lower, upper = (bounds[key].sel(response=name).values for key in ("lower", "upper"))
    return compare_bounds(time, lower, upper, low[row], high[row])["hausdorff_integrated"]


def test_orders_hardly_help_the_plain_surrogate(reference):
    ratio = {}
    for order in (3, 33):
        design = make_design("tensor_roots", 1, order)
        bounds = bounds_dataset(ball_samples(design), design, ["v"])
        ratio[order] = integrated(bounds, "v", reference)
    assert ratio[3] == pytest.approx(0.132, abs=0.01)
    assert ratio[33] == pytest.approx(0.08, abs=0.01)


def test_the_aligned_surrogate_needs_three_runs(reference):
    design = make_design("tensor_roots", 1, 2)
    bounds = bounds_dataset(ball_samples(design), design, model="aligned")
    assert integrated(bounds, "v", reference) < 1e-4
    assert integrated(bounds, "z", reference) < 1e-4
    assert (bounds["unresolved"] == 0).all()
    assert bounds.attrs["elements"] == 1


def test_shifting_instead_of_stretching_gives_the_same_bounds(reference):
    design = make_design("tensor_roots", 1, 2)
    bounds = bounds_dataset(ball_samples(design), design, ["v"], alignment="shift", model="aligned")
    assert integrated(bounds, "v", reference) < 1e-4
    assert float(bounds["error_share_of_width"].sel(response="v")) < 1e-3


@pytest.mark.parametrize("alignment", ["stretch", "shift"])
@pytest.mark.parametrize("duration", [2.0, 1.75])
def test_its_bounds_are_attained_where_they_are_said_to_be(alignment, duration):
    """Also of a box that is split, as some runs lack the third impact, from 1.71 s to 1.75 s on."""
    design = make_design("tensor_roots", 1, 4)
    samples = ball_samples(design, duration=duration)
    bounds = bounds_dataset(samples, design, ["z"], model="aligned", alignment=alignment)
    time = bounds["time"].values
    assert (float(bounds.attrs["elements"]) > 1) == (duration < 2.0)
    for side, values in (("argmin", "inner_lower"), ("argmax", "inner_upper")):
        for t in range(0, int((time < 1.7).sum()), 97):
            (height,) = bounds[side].values[0, t]
            there = ball(time, height)[0][t]
            assert there == pytest.approx(float(bounds[values][0, t]), abs=1e-3), (side, time[t])


def test_a_ringing_impact_is_better_shifted():
    """A vibration of fixed frequency that an impact excites, and a second impact later."""
    time = np.linspace(0.0, 1.0, 2001)
    unit = np.cos(np.pi * np.array([0.125, 0.375, 0.625, 0.875]))[:, None]
    impacts = np.stack([0.3 + 0.01 * unit[:, 0], 0.9 + 0.04 * unit[:, 0]], axis=1)
    curves = np.where(time > impacts[:, :1], np.sin(500 * (time - impacts[:, :1])), 0.0)
    delays = anchor_delays(impacts, 0.0, 1.0)
    held = np.array([[0.5]])
    truth = np.where(time > 0.305, np.sin(500 * (time - 0.305)), 0.0)
    error = {}
    basis = np.arange(4)[:, None]
    for name, table in (("stretch", impacts), ("shift", add_anchors(impacts, 0.0, delays))):
        model = fit_event_model(unit, basis, time, curves, table)
        error[name] = np.abs(model.evaluate(held, time)[0] - truth)[time < 0.7].max()
    assert error["shift"] < 1e-3 < 0.1 < error["stretch"]


def test_the_error_estimates_see_what_is_wrong(reference):
    _, low, high = reference
    design = make_design("tensor_roots", 1, 3)
    samples = ball_samples(design)
    plain = bounds_dataset(samples, design)
    aligned = bounds_dataset(samples, design, model="aligned")
    for row, name in enumerate(("z", "v")):
        lower, upper = (plain[key].sel(response=name).values for key in ("lower", "upper"))
        true = np.maximum(np.abs(lower - low[row]), np.abs(upper - high[row]))
        told = plain["error"].sel(response=name).values
        assert (true > told + 1e-4).mean() < 0.01
        assert (true > told + 0.02).mean() == 0
    # 0.13 of the width is wrong in the plain one; the estimate says so, and that the other is good
    assert float(plain["error_share_of_width"].sel(response="v")) > 0.13
    assert float(aligned["error_share_of_width"].sel(response="v")) < 1e-3


def test_the_model_predicts_unseen_runs_with_their_jumps():
    design = make_design("tensor_roots", 1, 2)
    samples = ball_samples(design)
    time = samples["time"].values
    impacts = np.array([bounces(h) for h in samples["value"].values[:3, 0]])
    model = fit_event_model(
        design.points,
        design.multi_indices,
        time,
        samples["values"].sel(response="v").values[:3],
        impacts,
    )
    height = 1.0 + 0.05 * 0.613
    found = model.evaluate(np.array([[0.613]]), time)[0]
    away = np.abs(time[:, None] - bounces(height)).min(axis=1) > 2e-4
    np.testing.assert_allclose(found[away], ball(time, height)[1][away], atol=1e-3)
    pairs = model.evaluate_pairs(np.full((len(time), 1), 0.613), time)
    np.testing.assert_allclose(pairs, found, atol=1e-10)


@pytest.mark.slow
def test_a_late_impact_that_some_runs_lack_splits_the_box_or_is_reported():
    duration = 1.772  # the third impact comes before the end for the lower half of the heights only
    reference = ball_reference(duration)
    design = make_design("tensor_roots", 1, 9)
    bounds = bounds_dataset(ball_samples(design, duration), design, model="aligned")
    assert bounds.attrs["elements"] == 2
    assert bounds.attrs["unresolved_share_at_end"] == 0
    assert 0 < bounds.attrs["cut_share"] < 0.2
    plain = bounds_dataset(ball_samples(design, duration), design)
    ours, theirs = (integrated(b, "v", reference) for b in (bounds, plain))
    assert ours < 1e-3 < 0.05 < theirs

    few = make_design("tensor_roots", 1, 2)  # three runs cannot be split into two linear fits
    bounds = bounds_dataset(ball_samples(few, duration), few, model="aligned")
    assert bounds["unresolved"].values[-1] == 1
    assert bounds["unresolved"].values[0] == 0
    late = bounds["unresolved"].values > 0
    node_values = ball_samples(few, duration)["values"].sel(response="v").values[:3]
    assert (node_values[:, late] <= bounds["upper"].sel(response="v").values[late]).all()
    assert (node_values[:, late] >= bounds["lower"].sel(response="v").values[late]).all()


@pytest.mark.parametrize("place", [0, 1])
def test_values_next_to_an_impact_count_on_either_side_of_it(place):
    """Before it a spike upwards, after it one downwards, each too narrow for any sample of a line;
    also beside a direction without width."""
    from scipy.interpolate import CubicSpline

    s, none = np.linspace(0, 1, 20_001), np.zeros(20_001)
    rise, fall = 2 * np.exp((s - 1) / 5e-4), -2 * np.exp(-s / 5e-4)
    pieces = [CubicSpline(s, np.stack([row, none], axis=1)) for row in (rise, fall)]
    free = np.arange(2) != place
    indices = np.array([[0, 0], free.astype(int)])
    impacts = Surrogate(np.array([[0.5], [0.1]]), indices)
    model = EventModel(np.where(free, -1.0, 0.0), 1.0 * free, 0.0, 1.0, impacts, pieces)
    time = np.linspace(0.41, 0.59, 37)
    low, high, at_low, at_high = event_range(model, time)
    np.testing.assert_allclose(high, 2.0, rtol=1e-6)
    np.testing.assert_allclose(low, -2.0, rtol=1e-6)
    for at in (at_low, at_high):
        np.testing.assert_allclose(model.edges(at)[:, 1], time, atol=1e-9)
        assert not at[:, place].any()


@pytest.mark.parametrize("runs", [1, 2, 3, 4])
def test_the_model_of_an_element_goes_through_its_runs_however_few(runs):
    design, time = make_design("tensor_roots", 1, 3), np.linspace(0.0, 1.0, 101)
    own = np.arange(runs)
    values = np.cos(5 * time) + np.exp(2 * design.points[own])
    impacts = 0.5 + 0.1 * design.points[own]
    element = Element(-np.ones(1), np.ones(1), own, impacts, np.inf)
    model = _fit_element(design, element, impacts, time, values)
    np.testing.assert_allclose(model.evaluate(design.points[own], time), values, atol=1e-6)


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_run_beyond_the_model_is_the_bound_and_where_it_is_attained(sign):
    values = sign * np.array([[0.0, 3.0, 5.0, 1.0], [1.0, 4.0, 2.0, 1.0]])
    unit = np.array([[-0.5, 0.1], [0.5, 0.2]])
    bound, argument = sign * np.full(4, 2.0), np.tile([0.9, 0.9], (4, 1))
    late = np.array([False, True, True, True])
    bound, argument = _with_runs(sign, bound, argument, late, values, unit)
    assert (sign * bound).tolist() == [2.0, 4.0, 5.0, 2.0]
    assert argument.tolist() == [[0.9, 0.9], [0.5, 0.2], [-0.5, 0.1], [0.9, 0.9]]


def test_two_parameters():
    time = np.linspace(0.0, 1.5, 601)
    design = make_design("total_degree", 2, 3)

    def value(u):
        return 1.0 + 0.05 * u[0], 0.8 + 0.02 * u[1]

    curves = np.array([ball(time, *value(u))[1] for u in design.points])
    impacts = np.array([bounces(*value(u), duration=1.5) for u in design.points])
    model = fit_event_model(design.points, design.multi_indices, time, curves, impacts)
    low, high, at_low, _ = event_range(model, time)
    grid = np.linspace(-1, 1, 41)
    scan = np.array([ball(time, *value((x, y)))[1] for x in grid for y in grid])
    found = compare_bounds(time, low, high, scan.min(axis=0), scan.max(axis=0))
    assert found["hausdorff_integrated"] < 0.02  # of which the scan's coarse steps are the most
    assert at_low.shape == (601, 2)
    assert (scan.min(axis=0) >= low - 0.02).all()


def test_chatter_of_several_contacts_is_one_impact():
    times = np.array([[0.5, 0.5, 0.51, 0.512, 0.513, 0.52, 0.9, np.nan]])
    contact = np.array([[0, 1, 0, 1, 0, 0, 1, np.nan]])
    closing = np.array([[1, 1, 0, 0, 1, 0, 1, np.nan]])
    (found,) = find_impacts(times, contact, np.nan_to_num(closing), gap=0.02)
    assert found.tolist() == [0.5, 0.9]
    (found,) = find_impacts(times, gap=0.0015, end=0.9)
    assert found.tolist() == [0.5, 0.51, 0.512, 0.52]


def test_a_long_contact_is_not_taken_for_a_new_impact():
    times = np.array([[0.1, 0.5, 0.6]])
    (found,) = find_impacts(times, np.zeros((1, 3)), np.array([[1, 0, 1]]), gap=0.2)
    assert found.tolist() == [0.1]


def test_common_prefix_and_elements_in_two_directions():
    table, later = common_prefix([np.array([1.0, 2.0, 3.0]), np.array([1.1, 2.1])])
    assert table.tolist() == [[1.0, 2.0], [1.1, 2.1]]
    assert later == 3.0
    points = make_design("tensor_lobatto", 2, 4).points
    impacts = [np.arange(2.0 if p[1] > 0.1 else 1.0) for p in points]
    elements = split_elements(points, impacts, np.ones(2, dtype=bool))
    assert len(elements) == 2
    assert sum(e.volume for e in elements) == pytest.approx(1.0)
    assert all(np.isinf(e.unresolved_from) for e in elements)


def test_designs_without_order_or_split_are_refused():
    halves = split_design(make_design("tensor_lobatto", 1, 2), [([-1.0], [0.0]), ([0.0], [1.0])])
    for design in (make_design("scan", 1, samples=8), halves):
        with pytest.raises(IntervalError, match="order, of the whole box"):
            bounds_dataset(ball_samples(design, instants=201), design, model="aligned")


def test_samples_without_events_are_refused():
    design = make_design("tensor_roots", 1, 2)
    with pytest.raises(IntervalError, match="event_time"):
        bounds_dataset(ball_samples(design).drop_vars("event_time"), design, model="aligned")
