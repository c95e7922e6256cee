"""Up to 60 intervals: where the first runs are, which pairs are told, what the search finds, on
functions of 40 parameters whose bounds are known in closed form or by long searches."""

from __future__ import annotations

import numpy as np
import pytest

from deployable.intervals import held_out_points, make_design
from deployable.intervals.box import axis_points
from deployable.intervals.designs import fit
from deployable.intervals.ranges import find_surrogate_range
from deployable.intervals.scalars import estimate_bounds, find_influence, fit_scalar

K, MOST = 40, 400
SLOPES = np.random.default_rng(0).uniform(0.05, 1.0, K) * np.resize([1.0, -1.0, -1.0], K)
SUM = np.abs(SLOPES).sum()


def bent(u):
    """Two that are not monotone: a peak inside and a trough, of known place and height."""
    return 0.2 * u @ SLOPES - (u[:, 0] - 0.3) ** 2 + np.cos(3 * u[:, 1])


BENT = np.abs(0.2 * SLOPES[2:]).sum()
LINE = np.linspace(-1, 1, 20001)
BENT_PARTS = (
    0.2 * SLOPES[0] * LINE - (LINE - 0.3) ** 2,
    0.2 * SLOPES[1] * LINE + np.cos(3 * LINE),
)
BOXES = {
    "step": (lambda u: np.tanh(u @ SLOPES), -np.tanh(SUM), np.tanh(SUM)),
    "bent": (
        bent,
        sum(p.min() for p in BENT_PARTS) - BENT,
        sum(p.max() for p in BENT_PARTS) + BENT,
    ),
    "product": (
        lambda u: np.prod(1 + 0.05 * u, axis=1),
        0.95**K,
        1.05**K,
    ),
}


def search(function, most=MOST):
    """Runs of a search as a campaign makes it: first those of the design, then further ones."""
    free = np.ones(K, dtype=bool)
    points = make_design("screening", K).points
    points = np.concatenate([points, held_out_points(free, 4, points)])
    values = function(points)
    while True:
        surrogate = fit_scalar(points, values)
        estimates = estimate_bounds(surrogate, points, values)
        found = np.unique(np.concatenate([e.points for e in estimates]), axis=0)
        new = [p for p in found if np.abs(points - p).max(axis=1).min() > 1e-6]
        new = new[: most - len(points)]
        if not new:
            return surrogate, estimates, values
        points = np.concatenate([points, new])
        values = np.concatenate([values, function(np.array(new))])


@pytest.mark.parametrize("k", [1, 9, 20, 33, 60])
def test_first_runs_are_ends_alone_and_a_fold_over_with_clear_main_effects(k):
    points = make_design("screening", k).points
    corners = points[1 + 2 * k :]
    assert len(points) <= 1 + 4 * k + 24
    assert (points[1 : 1 + 2 * k] == axis_points(np.ones(k, dtype=bool))).all()
    assert np.allclose(corners.T @ corners, len(corners) * np.eye(k))
    assert (corners[::2] == -corners[1::2]).all()
    if k > 8:
        first, second = np.triu_indices(k, 1)
        pairs = corners[:, first] * corners[:, second]
        alike = np.abs(pairs.T @ pairs) / len(corners) - np.eye(len(first))
        assert alike.max() < 0.7  # no pair is taken for another


def test_curves_are_bounded_by_sums_of_single_parameters():
    design = make_design("screening", K)
    values = design.points @ SLOPES + design.points[:, 5] ** 2
    bounds = find_surrogate_range(fit(design, values[:, None]))
    line = SLOPES[5] * LINE + LINE**2
    rest = SUM - abs(SLOPES[5])
    assert bounds.lower == pytest.approx(line.min() - rest, abs=1e-6)
    assert bounds.upper == pytest.approx(line.max() + rest, abs=1e-6)


def test_pairs_that_act_only_together_are_found():
    points = make_design("screening", K).points
    values = points @ (0.1 * SLOPES)
    pairs = [(3, 17), (5, 30), (8, 21)]
    for size, (i, j) in zip((1.0, 0.7, -0.4), pairs, strict=True):
        values -= points[:, [i, j]] @ (0.1 * SLOPES[[i, j]])
        values += size * points[:, i] * points[:, j]
    function = fit_scalar(points, values).fit.function
    found = {tuple(np.flatnonzero(i)) for i in function.multi_indices if (i > 0).sum() == 2}
    assert found == set(pairs)


@pytest.mark.slow
@pytest.mark.parametrize("name", BOXES)
def test_both_bounds_of_forty_parameters_in_400_runs(name):
    function, least, largest = BOXES[name]
    _, estimates, values = search(function)
    width = largest - least
    assert len(values) <= MOST
    for found, estimate, truth in zip(
        (values.min(), values.max()), estimates, (least, largest), strict=True
    ):
        assert abs(found - truth) < 0.02 * width
        assert abs(estimate.value - truth) <= estimate.error + 0.02 * width


def test_contributions_are_those_of_fixing_each():
    surrogate, _, values = search(lambda u: u @ SLOPES + 2 * u[:, 3] * u[:, 17])
    fixed = find_influence(surrogate, np.zeros(K)).fixed
    pair = np.ptp([s * SLOPES[3] + t * SLOPES[17] + 2 * s * t for s in (-1, 1) for t in (-1, 1)])
    rest = 2 * (SUM - abs(SLOPES[3]) - abs(SLOPES[17]))
    expected = pair + rest - 2 * np.abs(SLOPES)
    expected[[3, 17]] = rest + 2 * np.abs(SLOPES[[17, 3]])
    assert np.ptp(values) == pytest.approx(pair + rest)
    assert np.abs(fixed - expected).max() < 0.03 * np.ptp(values)
