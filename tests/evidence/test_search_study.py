"""The study of bounds of quantities tells bounds that are wrong."""

from __future__ import annotations

import numpy as np
import pytest

from evidence.search import fractions, mechanisms, mechanisms_carts
from evidence.search.boxes import Box


def test_true_bounds_are_those_of_the_closed_form():
    """A crossing of 0.9 by an amplitude of 0.5 to 1.5 that happens in 60 % of the interval."""

    def crossing(u):
        level = 0.9 / (1 + 0.5 * u[:, 0])
        return np.where(level < 1, np.arcsin(np.clip(level, -1, 1)), np.nan)

    lower, upper = Box(1, crossing).true_bounds()
    assert (lower, upper) == (pytest.approx(np.arcsin(0.6)), pytest.approx(np.pi / 2, abs=1e-4))


@pytest.mark.slow  # compiles
def test_carts_move_as_their_closed_forms():
    (box,) = (box for box in mechanisms_carts.BOXES if box.name == "plateau")
    answer = mechanisms.play(
        box,
        mechanisms.truths("mechanisms_carts")[box.name],
        {"design": {"method": "smolyak", "order": 1}},
    )
    # As near as a search goes on, a thousandth of the width.
    assert max(bound["runs_off"] for bound in answer["bounds"]) < 1e-3


@pytest.mark.parametrize("name", ["step 1", "both", "rare"])
def test_stored_fractions_are_those_of_the_closed_forms(name):
    box = next(box for box in fractions.BOXES if box.name == name)
    truth, points = (
        fractions.truths()[name],
        np.random.default_rng(0).uniform(-1, 1, (40000, box.k)),
    )
    for key, mask in box.masks(points).items():
        assert mask.mean() == pytest.approx(truth[key], abs=0.01)
