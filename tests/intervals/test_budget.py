"""Budgets of errors, and the places that decide."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from deployable import intervals


def test_places_follow_where_bounds_are_attained():
    """Bounds that are attained at one end, then at the other: these are the places."""
    argmin = np.where(np.arange(50) < 30, -1.0, 1.0).reshape(1, 50, 1)
    places = intervals.choose_bound_points(argmin, -argmin, np.ones((1, 50)), 8)
    assert sorted(places.points[:, 0]) == [-1.0, 1.0]
    assert (places.points[places.lower, 0] == argmin[..., 0]).all()
    assert (places.points[places.upper, 0] == -argmin[..., 0]).all()


def test_a_response_without_width_decides_no_places():
    attained = np.random.default_rng(5).uniform(-1, 1, (1, 60, 2))
    alone = intervals.choose_bound_points(attained, -attained, np.ones((1, 60)), 5)
    still = np.concatenate([np.full((1, 60, 2), 0.9), attained])
    width = np.concatenate([np.zeros((1, 60)), np.ones((1, 60))])
    both = intervals.choose_bound_points(still, -still, width, 5)
    np.testing.assert_array_equal(both.points, alone.points)
    np.testing.assert_array_equal(both.lower[1], alone.lower[0])
    np.testing.assert_array_equal(both.upper[1], alone.upper[0])


def test_errors_of_places_are_those_of_the_nearest():
    argmin, argmax = np.full((1, 4, 1), -1.0), np.full((1, 4, 1), 1.0)
    places = intervals.choose_bound_points(argmin, argmax, np.ones((1, 4)), 8)
    changes = np.zeros((2, 1, 4))
    changes[int(places.lower[0, 0]), 0] = [0.1, -0.3, 0.0, 0.2]
    changes[int(places.upper[0, 0]), 0] = [-0.2, 0.1, 0.0, 0.2]
    assert places.errors(changes)[0].tolist() == [0.2, 0.3, 0.0, 0.2]


def test_a_budget_adds_its_parts():
    time = np.linspace(0.0, 1.0, 5)
    levels = {"lower": 0.0, "upper": 2.0, "inner_lower": 0.0, "inner_upper": 2.0, "error": 0.1}
    curves = {
        name: (("response", "time"), np.full((1, 5), level)) for name, level in levels.items()
    }
    places = (("response", "time", "parameter"), np.zeros((1, 5, 1)))
    curves |= {"argmin": places, "argmax": places}
    numbers = ("largest_error", "largest_error_time", "error_share_of_width")
    curves |= {name: ("response", [0.0]) for name in numbers}
    bounds = xr.Dataset(curves, coords={"time": time})
    mesh = np.array([[0.0, 0.0, -0.4, 0.0, 0.0]])
    found = intervals.add_errors(bounds, {"mesh": mesh})
    assert found["error"].values[0].tolist() == pytest.approx([0.1, 0.1, 0.5, 0.1, 0.1])
    assert float(found["largest_error_time"][0]) == 0.5
    assert float(found["share_surrogate"][0]) == pytest.approx(0.05)
    assert float(found["share_mesh"][0]) == pytest.approx(0.4 * 0.25 / 2)
    share = float(found["error_share_of_width"][0])
    assert share == pytest.approx(0.05 + 0.4 * 0.25 / 2)
