"""A design or a model of one's own: one definition and one line in a registry."""

import numpy as np
import pytest
from datasets_for_tests import samples_of

from deployable.intervals import (
    METHODS,
    MODELS,
    Box,
    IntervalError,
    Model,
    bounds_dataset,
    fit,
    make_design,
)
from deployable.intervals.chebyshev import total_degree
from deployable.intervals.designs import Design, Method
from deployable.intervals.estimates import estimate_error
from deployable.intervals.ranges import to_range

TIME = np.linspace(0.0, 1.0, 21)
BOX = Box(["a", "b", "c"], [0.9, 2.0, -0.1], [1.1, 2.0, 0.1])  # b has no width


def star(orders, free, limit, *, arm=1.0):
    """The centre and two points on each axis, for linear polynomials."""
    limit(1 + 2 * int(free.sum()))
    axes = arm * np.eye(len(free))[free]
    points = np.concatenate([np.zeros((1, len(free))), axes, -axes])
    return Design(points, total_degree(np.minimum(orders, 1)))


class Nearest(Model):
    """Every point has the values of the nearest run: the extreme runs, wrong by a quarter."""

    kind = "attained range of the nearest runs"

    def __init__(self, samples, design, *, share=0.25):
        self.samples, self.share = samples, share
        self.attributes = {"share": share}

    def range(self):
        values, points = self.samples.values, self.samples.points
        where = points[values.argmin(axis=0)], points[values.argmax(axis=0)]
        return to_range(values.min(axis=0), values.max(axis=0), *where)

    def error(self, found):
        error = self.share * (found.upper - found.lower)
        return estimate_error(self.samples.time, error, np.zeros_like(error))


def plane(v):
    return np.stack([v[0] + v[2] * TIME, v[1] * v[0] * TIME])


@pytest.fixture
def registered(monkeypatch):
    monkeypatch.setitem(METHODS, "star", Method(star))
    monkeypatch.setitem(MODELS, "nearest", Nearest)


def test_a_design_of_ones_own_is_made_fitted_and_refused(registered):
    design = make_design("star", BOX, 2, arm=0.5)
    assert (design.method, design.order, design.run_count) == ("star", (2, 0, 2), 5)
    samples = samples_of(plane, BOX, design, TIME, names=("x", "y"))
    bounds = bounds_dataset(samples, design)
    np.testing.assert_allclose(bounds["lower"][0], 0.9 - 0.1 * TIME, atol=1e-12)
    np.testing.assert_allclose(bounds["upper"][1], 2.2 * TIME, atol=1e-12)
    assert float(bounds["error_held_out"].max()) < 1e-12
    assert fit(design, design.points).coefficients.shape == (3, 3)
    with pytest.raises(IntervalError, match=r"'legs'.*one of arm"):
        make_design("star", BOX, 2, legs=3)
    with pytest.raises(IntervalError, match="at most 4 runs, not 5"):
        make_design("star", BOX, 2, max_runs=4)


def test_a_model_of_ones_own_has_bounds_like_any_other(registered):
    design = make_design("star", BOX, 1)
    samples = samples_of(plane, BOX, design, TIME, names=("x", "y"))
    bounds = bounds_dataset(samples, design, model="nearest", share=0.5)
    assert bounds.attrs["bounds_kind"] == Nearest.kind
    assert bounds.attrs["share"] == 0.5
    values = samples["values"].values
    np.testing.assert_array_equal(bounds["lower"], values.min(axis=0))
    np.testing.assert_array_equal(bounds["argmax"][1, -1, 0], 1.1)
    width = bounds["upper"] - bounds["lower"]
    assert (bounds["error"] >= 0.5 * width).all()
    with pytest.raises(IntervalError, match=r"'tolerance'.*one of share"):
        bounds_dataset(samples, design, model="nearest", tolerance=0.1)
