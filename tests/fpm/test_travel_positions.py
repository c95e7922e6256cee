"""Positions of a travel, of functions in closed form: which are taken, and what lies between."""

import numpy as np
import pytest

from fpm.travel import MAX_POSITIONS, SMALLEST_DISTANCE, SampledTravel, interpolate


def places(function, count=5):
    """SampledTravel of a function, evenly at first."""
    found = SampledTravel(lambda place, left: (np.array([function(place)]), None))
    for place in np.linspace(0.0, 1.0, count):
        found.add(float(place))
    return found


def by(most):
    """How far values are off, in shares of what may be."""
    return lambda expected, values, distance: float(np.abs(values - expected).max()) / most


def worst(found, function):
    """The largest error of what is interpolated."""
    at = np.linspace(0.0, 1.0, 10_001)
    return np.abs(interpolate(*found.arrays(), at)[:, 0] - function(at)).max()


def test_values_are_taken_from_the_state_at_the_nearest_place_before():
    starts = []
    found = SampledTravel(lambda place, left: (starts.append((place, left)) or np.zeros(1), place))
    for place in (0.0, 1.0, 0.5, 0.25, 0.75):
        found.add(place)
    found.look(0.6)
    assert starts == [
        (0.0, None), (1.0, 0.0), (0.5, 0.0), (0.25, 0.0), (0.75, 0.5), (0.6, 0.5),
    ]  # fmt: skip


@pytest.mark.parametrize("most", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("at", [0.0, 0.37, 1.0])
def test_places_are_added_until_what_lies_between_is_within_what_may_be(most, at):
    """Of a peak, however far off the first places are."""

    def peak(x):
        return 1.0 / (1.0 + (6.0 * (x - at)) ** 2)

    found = places(peak)
    assert found.refine(by(most))
    assert worst(found, peak) <= 1.5 * most
    assert len(found.positions) < 400


def test_a_jump_stands_twice_where_it_is():
    jump = np.sqrt(0.5)
    found = places(lambda x: np.where(x < jump, x, x + 1.0))
    assert found.refine(by(1e-6))
    at, _ = found.arrays()
    (twice,) = np.nonzero(np.diff(at) == 0)
    assert np.abs(at[twice] - jump).max() <= 10 * SMALLEST_DISTANCE
    assert worst(found, lambda x: np.where(x < jump, x, x + 1.0)) <= 1e-6


def test_a_known_bend_takes_no_places_about_it():
    found = places(lambda x: abs(x - 0.3))
    found.add_bend(0.3)
    assert found.refine(by(1e-6))
    assert len(found.positions) == 6 + 5, "the middles, at which nothing is missed"


def test_what_bends_everywhere_takes_too_many_places():
    found = places(lambda x: np.sin(1e5 * x))
    assert not found.refine(by(1e-6))
    assert len(found.positions) == MAX_POSITIONS
