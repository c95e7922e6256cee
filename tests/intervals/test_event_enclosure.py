"""The enclosure of composed models: nothing leaves it, and halving closes the gap."""

import numpy as np
import pytest
from ball import ball, bounces
from datasets_for_tests import ball_samples
from hypothesis import given, settings
from hypothesis import strategies as st

from deployable.intervals import bounds_dataset, make_design
from deployable.intervals.designs.multi_indices import total_degree
from deployable.intervals.models.aligned.composed import fit_event_model
from deployable.intervals.models.aligned.enclosure import _expansions, _window, event_enclosure
from deployable.intervals.models.aligned.impacts import add_anchors, anchor_delays
from deployable.intervals.models.aligned.search import event_range


def random_model(k, order, jumps, seed, anchors=False):
    """A composed model of noise: pieces that fit nothing, impacts that may cross each other."""
    generator = np.random.default_rng(seed)
    design = make_design("total_degree", k, order)
    time = np.linspace(0.0, 1.0, 61)
    spread = 0.15 if jumps > 1 else 0.3
    places = (np.arange(jumps) + 1.0) / (jumps + 1)
    impacts = places + spread / (jumps + 1) * generator.uniform(-1, 1, (design.runs, jumps))
    values = generator.standard_normal((design.runs, 61)).cumsum(axis=1)
    if anchors:
        impacts = add_anchors(impacts, 0.0, anchor_delays(impacts, 0.0, 1.0))
    lower, upper = -np.ones(k), np.ones(k)
    upper[0] = 0.3  # an element, not the whole box
    points = lower * (1 - design.points) / 2 + upper * (1 + design.points) / 2
    model = fit_event_model(points, total_degree([order] * k), time, values, impacts, lower, upper)
    return model, time, generator


@pytest.mark.slow
@settings(max_examples=15, deadline=None)
@given(
    st.integers(1, 3),
    st.integers(1, 3),
    st.integers(0, 2),
    st.booleans(),
    st.integers(1, 60),
    st.integers(0, 10**6),
)
def test_nothing_leaves_the_enclosure(k, order, jumps, anchors, budget, seed):
    model, time, generator = random_model(k, order, jumps, seed, anchors and jumps > 0)
    local = np.concatenate(
        [generator.uniform(-1, 1, (300, k)), generator.choice([-1.0, 0.0, 1.0], (50, k))]
    )
    unit = model.lower * (1 - local) / 2 + model.upper * (1 + local) / 2
    values = model.evaluate(unit, time)
    low, high, _, _ = event_range(model, time)
    lower, upper = event_enclosure(model, time, low, high, budget=budget)
    assert (values >= lower).all()
    assert (values <= upper).all()
    assert (low >= lower).all()
    assert (high <= upper).all()
    # also without a good attained range to prune with, and at instants between the recorded ones
    middle = model.evaluate_pairs(np.repeat(unit[:1], 60, axis=0), time[1:] - 0.007)
    lower, upper = event_enclosure(model, time[1:] - 0.007, middle, middle, budget=budget)
    values = model.evaluate(unit, time[1:] - 0.007)
    assert (values >= lower).all()
    assert (values <= upper).all()


@pytest.mark.parametrize(("k", "wanted"), [(1, 0.01), (2, 0.02)])
def test_the_gap_closes_with_halving(k, wanted):
    time = np.linspace(0.0, 1.5, 301 if k == 1 else 101)
    design = make_design("total_degree", k, 3)

    def value(u):
        return 1.0 + 0.05 * u[0], 0.8 + 0.02 * u[-1]

    curves = np.array([ball(time, *value(u))[1] for u in design.points])
    impacts = np.array([bounces(*value(u), duration=1.5) for u in design.points])
    model = fit_event_model(design.points, design.multi_indices, time, curves, impacts)
    low, high, _, _ = event_range(model, time)
    gaps = []
    for budget in (1, 8, 64, 512):
        lower, upper = event_enclosure(model, time, low, high, budget=budget)
        gaps.append(float(((upper - high) + (low - lower)).sum() / (high - low).sum()))
    assert gaps == sorted(gaps, reverse=True)
    assert gaps[0] > 5 * gaps[2]
    assert gaps[3] < wanted


def test_expansions_on_a_sub_box_are_exact():
    matrix = _expansions(np.array([0.3, -0.5]), np.array([0.2, 0.5]), 7)
    y = np.linspace(-1, 1, 9)
    for i in range(8):
        for row, (centre, half) in enumerate(((0.3, 0.2), (-0.5, 0.5))):
            expected = np.cos(i * np.arccos(centre + half * y))
            found = np.polynomial.chebyshev.chebval(y, matrix[row, i])
            np.testing.assert_allclose(found, expected, atol=1e-12)


def test_windows_bound_the_spline_and_are_sharp():
    from scipy.interpolate import CubicSpline

    knots = np.linspace(0, 1, 21)
    spline = CubicSpline(knots, np.random.default_rng(0).standard_normal((21, 1)))
    low, high = np.array([0.0, 0.31, 0.5, 0.999]), np.array([0.02, 0.78, 0.5, 1.0])
    row, cubic, size = _window(spline, low, high)
    assert (size[:, None] >= np.abs(cubic[..., 0]) * (1 - 1e-12)).all()
    for i in range(4):
        dense = spline(np.linspace(low[i], high[i], 400))[:, 0]
        mine = cubic[row == i, :, 0]
        assert mine.min() <= dense.min() + 1e-12
        assert mine.max() >= dense.max() - 1e-12
        # Bernstein coefficients of a cell are no farther off than a fraction of its spread
        assert mine.max() - mine.min() <= 1.5 * np.ptp(dense) + 1e-12


def test_large_terms_that_cancel_round_within_the_enclosure():
    """1e8 times a square, made of Chebyshev polynomials: next to its least value they cancel."""
    design = make_design("total_degree", 1, 4)
    time = np.linspace(0.0, 1.0, 61)
    points = design.points
    values = 1e8 * (points - 0.1234) ** 4 + np.zeros(61)
    impacts = 0.5 + 0.1 * points
    one = np.ones(1)
    model = fit_event_model(points, design.multi_indices, time, values, impacts, -one, one)
    unit = 0.1234 + np.linspace(-1e-3, 1e-3, 4001)[:, None]
    found = model.evaluate(unit, time)
    assert found.min() < -1e-9  # rounding, as the square is not negative
    low, high, _, _ = event_range(model, time)
    lower, upper = event_enclosure(model, time, low + 1e-6, high, tolerance=0.0)
    assert (found >= lower).all()
    assert (found <= upper).all()


@pytest.mark.slow
def test_bounds_that_enclose_contain_those_that_are_attained():
    design = make_design("tensor_roots", 1, 2)
    samples = ball_samples(design, instants=501)
    attained = bounds_dataset(samples, design, model="aligned")
    enclosed = bounds_dataset(samples, design, enclose=True, model="aligned")
    for name in ("z", "v"):
        for side in ("lower", "upper"):
            same = enclosed[f"inner_{side}"].sel(response=name) == attained[side].sel(response=name)
            assert same.all()
        assert (enclosed["lower"].sel(response=name) <= attained["lower"].sel(response=name)).all()
        assert (enclosed["upper"].sel(response=name) >= attained["upper"].sel(response=name)).all()
        assert 0 < float(enclosed["gap_share_of_width"].sel(response=name)) < 0.01
    assert "enclosed" in enclosed.attrs["bounds_kind"]
