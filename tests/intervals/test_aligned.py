"""Curves through events against closed forms: stops, events in part of the box, swaps."""

import itertools

import numpy as np
import pytest
import xarray as xr
from scipy.stats import qmc

from deployable.intervals import bounds_dataset
from deployable.intervals.alignment import (
    difference_across,
    name_events,
    shared_events,
    unseen_difference,
)
from deployable.intervals.chebyshev import tensor
from deployable.intervals.designs import Design

TIME = np.linspace(0.0, 2.0, 400)  # no run at a corner has its event at an instant


def stop(x):
    """A mass at the speed v comes to a stop at L, and leaves it at 0.6 v: position and speed."""
    v, length = 2 + 0.3 * x[0], 1.5 + 0.2 * x[1]
    hit = length / v
    position = np.where(hit > TIME, v * TIME, length - 0.6 * v * (TIME - hit))
    return [position, np.where(hit > TIME, v, -0.6 * v)], [(hit, 0, 1)]


def brake(x):
    """A mass that brakes evenly, and comes to a stop only if it is fast enough."""
    v, length = 2 + 0.5 * x[0], 1.6 + 0.15 * x[1]
    free = [v * TIME - TIME**2 / 2, v - TIME]
    rest = v * v - 2 * length
    if rest <= 0 or (hit := v - np.sqrt(rest)) > TIME[-1]:
        return free, []
    after, back = TIME - hit, 0.5 * (v - hit)
    behind = length - back * after - after**2 / 2, -back - after
    return [np.where(after < 0, *pair) for pair in zip(free, behind, strict=True)], [(hit, 0, 1)]


def spring(x):
    """A mass meets a stiff spring and leaves it little more than an instant later."""
    v, length, omega = 2 + 0.3 * x[0], 1.5 + 0.2 * x[1], np.pi / 0.006
    since = TIME - length / v
    angle, away = np.clip(omega * since, 0.0, np.pi), np.maximum(since - 0.006, 0.0)
    position = np.where(since < 0, v * TIME, length + v / omega * np.sin(angle) - v * away)
    return [position, v * np.cos(angle)], [(length / v, 0, 1), (length / v + 0.006, 0, -1)]


def swap(x):
    """Two jumps, either of which may come first."""
    one, other = 1 + 0.3 * x[0], 1 + 0.3 * x[1]
    jumps = (one < TIME) - 0.7 * (other < TIME) * (1 + 0.2 * x[0])
    return [np.sin(2 * TIME) + jumps], [(one, 0, 1), (other, 1, 1)]


def samples(motion, points):
    """A samples dataset of the runs at points (R, 2)."""
    values, events = zip(*map(motion, points), strict=True)
    table = np.full((len(points), 2, 3), np.nan)
    for row, found in zip(table, events, strict=True):
        row[: len(found)] = np.reshape(found, (-1, 3))
    names = [f"r{i}" for i in range(len(values[0]))]
    axes = ("event_time", "event_contact", "event_closing")
    return xr.Dataset(
        {
            "values": (("run", "response", "time"), np.array(values)),
            "normalized": (("run", "parameter"), points),
            "value": (("run", "parameter"), points),
            **{name: (("run", "event"), table[..., i]) for i, name in enumerate(axes)},
        },
        coords={"time": TIME, "response": names, "parameter": ["a", "b"]},
    )


def runs(order):
    """A tensor grid (N, 2) with its design, and four further points."""
    line = np.cos(np.pi * np.arange(order + 1) / order)
    nodes = np.array(list(itertools.product(line, line)))
    design = Design(nodes, tensor((order, order)), "tensor_lobatto", (order, order))
    return design, np.concatenate([nodes, qmc.Sobol(2, seed=7).random(4) * 2 - 1])


@pytest.fixture(scope="module")
def dense():
    """Points (P, 2) by which bounds are known."""
    return np.concatenate([qmc.Sobol(2, seed=1).random(4096) * 2 - 1, runs(1)[0].points])


def errors(bounds, motion, dense):
    """Integrated errors (n) of bounds over the widths, and the share (n) of the instants at which
    the dense runs are within the bounds and their errors."""
    true = np.array([motion(x)[0] for x in dense])
    low, high = true.min(axis=0), true.max(axis=0)
    lower, upper, error = (bounds[name].values for name in ("lower", "upper", "error"))
    off = np.maximum(np.abs(lower - low), np.abs(upper - high)).sum(axis=1)
    slack = error + 1e-6 * np.ptp(true)
    inside = (low >= lower - slack) & (high <= upper + slack)
    return off / (high - low).sum(axis=1), inside.mean(axis=1)


@pytest.mark.parametrize("motion", [stop, spring, pytest.param(swap, marks=pytest.mark.slow)])
def test_the_model_that_predicts_left_out_runs_best_is_taken(motion, dense):
    design, points = runs(4)
    bounds = bounds_dataset(samples(motion, points), design, model="auto")
    off, inside = errors(bounds, motion, dense)
    assert (off < 0.01).all()
    assert (inside >= 0.99).all()
    assert len(np.unique(bounds["model"])) > 1


def test_without_a_held_out_run_values_of_a_parameter_are_left_out_together(dense):
    """The response depends on one parameter: other runs at its value predict each single one."""
    nodes = np.array(list(itertools.product(np.sqrt(0.75) * np.arange(-1, 2), repeat=2)))
    design = Design(nodes, tensor((2, 2)), "tensor_roots", (2, 2))
    for model in ("aligned", "spline"):

        def motion(x, jump=model == "aligned"):
            hit = 1 / (1 + 0.3 * x[0])
            return [np.sin(4 * TIME * (1 + 0.1 * x[0])) + jump * (hit < TIME)], [(hit, 0, 1)]

        bounds = bounds_dataset(samples(motion, nodes), design, model=model)
        assert errors(bounds, motion, dense)[1] >= 0.95


def test_an_event_of_part_of_the_box_that_cannot_be_divided_counts_as_an_error(dense):
    """Of 13 runs three in one plane have no event: nothing tells how they go on to the border."""
    design, points = runs(2)
    bounds = bounds_dataset(samples(brake, points), design, model="auto")
    _, inside = errors(bounds, brake, dense)
    assert (inside >= 0.95).all()
    earliest = min(events[0][0] for _, events in map(brake, points) if events)
    assert bounds.attrs["undivided_from"] == pytest.approx(earliest)
    assert (bounds["error"].sel(time=slice(0, earliest - 0.1)) < 0.02).all()


def test_an_event_of_some_runs_may_come_earlier_than_in_any():
    """Inverse squares of its times are even over the box: it comes from 0.877 s on."""
    points = np.array(list(itertools.product([-0.8, 0.0, 0.8], [-0.8, 0.0, 0.8])))
    times = (1 + 0.3 * points[:, 0]) ** -0.5
    runs = [{(0, 1, 0): t} if t < 1.1 else {} for t in times]
    values = np.array([[(t <= TIME) & (t < 1.1)] for t in times], dtype=float)
    change = difference_across(points, values, TIME, runs)[0]
    assert (change[(TIME > 0.885) & (TIME < 1.1)] == 1).all() and not change[TIME < 0.87].any()


@pytest.mark.parametrize("limit", [1.5, 2.5])
def test_an_event_that_no_run_misses_counts_as_an_error_if_margins_vanish_in_the_box(limit, dense):
    """The margin is a rate less its limit, as of a latch that does not catch what is too fast; runs
    are where x + y < 1. A limit of 1.5 leaves a corner out, where masses go on; 2.5 leaves none."""
    _, points = runs(3)
    points = points[points.sum(axis=1) < 1]
    data = samples(stop, points)
    margins = limit - points.sum(axis=1, keepdims=True)
    data["event_margin"] = ("run", "contact"), margins
    design = Design(points, np.zeros((0, 2), int), "adaptive")
    bounds = bounds_dataset(data, design, model="auto")
    if limit > 2:
        assert "unseen_from" not in bounds.attrs
        return
    first = min(stop(x)[1][0][0] for x in points)
    assert bounds.attrs["unseen_from"] == pytest.approx(first)
    missed = dense[dense.sum(axis=1) > 1.5]
    position = np.multiply.outer(2 + 0.3 * missed[:, 0], TIME)
    upper = (bounds["upper"] + bounds["error"]).values[0]
    assert (position <= upper + 1e-9)[:, TIME < 1.4].all()
    assert (bounds["error"].sel(time=slice(0, first - 0.1)) < 0.02).all()


def test_margins_that_no_spline_predicts_tell_only_where_they_are_near_zero():
    """Margins of 24 or 69, at random: the spline through them is below 0 in between."""
    points = qmc.Sobol(2, seed=3).random(64) * 2 - 1
    margins = np.where(np.random.default_rng(1).random((64, 1)) < 0.2, 69.0, 24.0)
    runs = [{(0, 1, 0): 1.0}] * 64
    assert unseen_difference(points, margins, TIME, runs) == np.inf
    assert unseen_difference(points, margins - 20, TIME, runs) == 1.0


def test_events_that_not_all_runs_have_or_that_come_together_are_not_shared():
    tables = np.full((3, 3, 3), np.nan)
    for i, row in enumerate(tables):
        row[0] = 0.5 + 0.1 * i, 0, 1
        row[1] = 0.5001 + 0.1 * i, 1, 1  # at the same instant
    tables[0, 2] = 1.5, 2, 1
    times = shared_events(name_events(tables), TIME)
    np.testing.assert_allclose(times[:, 0], [0.5, 0.6, 0.7])
    assert times.shape == (3, 1)


def test_without_events_the_choice_is_between_polynomial_and_spline():
    design, points = runs(4)
    data = samples(stop, points).drop_vars(["event_time", "event_contact", "event_closing"])
    bounds = bounds_dataset(data, design, model="auto")
    assert bounds.attrs["models"] == ["polynomial", "spline"]


@pytest.mark.parametrize("motion", [stop, swap])
def test_without_a_polynomial_left_out_runs_decide_between_the_splines(motion):
    """So it is with an accuracy. Before the events of `swap` nothing has to be aligned."""
    _, points = runs(4)
    data = samples(motion, points)
    bounds = bounds_dataset(data, Design(points, np.zeros((0, 2), int), "adaptive"), model="auto")
    assert bounds.attrs["models"] == ["spline", "aligned"]
    assert (bounds["model"] == 1).any()
    if motion is swap:
        assert (bounds["model"][:, :100] == 0).all()
