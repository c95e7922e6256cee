"""Bounds of ratios, as margins are, over five parameters, against ten thousand evaluations."""

from types import SimpleNamespace

import numpy as np
import pytest
from datasets_for_tests import samples_of

from deployable.intervals import Box, bounds_dataset, make_design
from deployable.intervals.bounds import ratios_of
from deployable.intervals.estimates import ErrorEstimate
from deployable.intervals.ranges import Range

WAY = np.linspace(0.0, np.pi / 2, 31)
NOMINAL = np.array([0.1, np.pi, 0.003, 0.005, 0.02])
WIDTHS = np.array([0.1, 0.05, 0.5, 0.5, 0.5])


def margin(values, turn):
    """A spring against friction, harness, and a weight that drives or resists."""
    k, rest, dry, harness, heavy = (np.asarray(values)[..., i, None] for i in range(5))
    weight = heavy * np.cos(turn(WAY))
    drives = 0.8 * k * (rest - WAY) + 0.9 * np.maximum(weight, 0)
    return drives / (6 * (dry + harness * WAY) + 2.2 * np.maximum(-weight, 0)) - 1


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("turn", [lambda x: 2 * x, lambda x: np.pi - x, lambda x: x + 1])
def test_bounds_of_a_ratio_lie_within_their_errors(order, turn):
    box = Box(list("kpfhw"), list(NOMINAL * (1 - WIDTHS)), list(NOMINAL * (1 + WIDTHS)))
    design = make_design("smolyak", box, order)
    samples = samples_of(lambda v: margin(v, turn), box, design, WAY)
    plain = bounds_dataset(samples, design)
    bounds = bounds_dataset(samples.assign_coords(response_ratio=("response", [1.0])), design)
    draw = np.random.default_rng(1).uniform(-1, 1, (10_000, 5))
    corners = np.array(np.meshgrid(*[[-1, 1]] * 5)).reshape(5, -1).T
    exact = margin(NOMINAL * (1 + WIDTHS * np.vstack([draw, corners])), turn)
    for side, end in (("lower", exact.min(axis=0)), ("upper", exact.max(axis=0))):
        off = np.abs(bounds[side].values[0] - end)
        assert (off <= bounds["error"].values[0] + 1e-6).mean() >= 0.95, side
        assert off.max() <= np.abs(plain[side].values[0] - end).max(), side
        assert off.max() <= (0.1, 0.01)[order - 2] * np.abs(end).max(), side
    # the bounds are taken where they are said to be
    for side, end in (("argmin", exact.min(axis=0)), ("argmax", exact.max(axis=0))):
        at = margin(bounds[side].values[0], turn)[np.arange(31), np.arange(31)]
        assert at == pytest.approx(end, rel=1e-2, abs=1e-2), side
    assert bounds["nominal"].values[0] == pytest.approx(margin(NOMINAL, turn))


def test_the_error_of_a_ratio_is_that_at_either_end():
    share, off = np.array([[0.5]]), np.array([[0.01]])
    samples = SimpleNamespace(ratios=np.array([True]))
    place = np.zeros((1, 1, 1))
    found = Range(share, share + 0.1, share, share + 0.1, place - 1, place + 1)
    bounds, error = ratios_of(samples, found, ErrorEstimate(off, 2 * off, 0 * off))
    assert (bounds.lower, bounds.upper) == (pytest.approx(1 / 0.6 - 2), pytest.approx(0.0))
    assert (bounds.argmin, bounds.argmax) == (1.0, -1.0)
    assert error.total == pytest.approx(1 / 0.49 - 1 / 0.5)
    assert error.held_out == pytest.approx(1 / 0.48 - 1 / 0.5) and error.decay == 0.0
    wide = ErrorEstimate(off, 0.7 * off / off, 0 * off)  # to beyond a share of none
    assert ratios_of(samples, found, wide)[1].held_out == pytest.approx(1000 - 2)
