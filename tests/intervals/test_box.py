"""The box and its map to the unit cube."""

import numpy as np
import pytest

from deployable.intervals import Box, IntervalError


def test_corners_are_exact_and_round_trip():
    box = Box(["a", "E"], [0.1, 1e9], [0.3, 1.1e9])
    for end in (1.0, np.nextafter(1.0, 2.0)):  # searches compute coordinates
        assert (box.from_unit(np.array([[-end, end]])) == [[0.1, 1.1e9]]).all()
    unit = np.random.default_rng(0).uniform(-1, 1, (50, 2))
    np.testing.assert_allclose(box.to_unit(box.from_unit(unit)), unit, atol=1e-12)


def test_zero_width_collapses():
    box = Box(["a", "b"], [0.1, 2.0], [0.1, 3.0])
    assert box.free.tolist() == [False, True]
    assert box.corners().shape == (2, 2)
    assert (box.from_unit(np.array([0.7, 1.0])) == [0.1, 3.0]).all()
    assert (box.to_unit(np.array([0.1, 2.5])) == [0.0, 0.0]).all()


@pytest.mark.parametrize(
    ("names", "lower", "upper", "key"),
    [
        (["a"], [2.0], [1.0], "interval a"),
        (["a"], [0.0], [np.inf], "interval a"),
        (["a", "a"], [0.0, 0.0], [1.0, 1.0], "intervals"),
        (["a", "b"], [0.0], [1.0], "lower, upper"),
        ([f"p{i}" for i in range(61)], [0.0] * 61, [1.0] * 61, "intervals"),
    ],
)
def test_wrong_boxes_are_refused_with_key_and_value(names, lower, upper, key):
    with pytest.raises(IntervalError) as caught:
        Box(names, lower, upper)
    assert caught.value.key == key
    assert caught.value.allowed in str(caught.value)


@pytest.mark.parametrize("side", ["lower", "upper"])
def test_a_box_cannot_be_changed(side):
    box = Box(["a"], [0.1], [0.2])
    with pytest.raises(ValueError, match="read-only"):
        getattr(box, side)[0] = 0.15
