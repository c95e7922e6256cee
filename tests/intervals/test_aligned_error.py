"""Error estimates of aligned models: what must not matter does not, and known errors are told."""

import numpy as np
import pytest
from datasets_for_tests import ball_samples, samples_of

from deployable.intervals import Box, bounds_dataset, make_design
from deployable.intervals.designs.multi_indices import total_degree
from deployable.intervals.models.aligned.composed import fit_event_model
from deployable.intervals.models.aligned.estimate import aligned_error
from deployable.intervals.models.aligned.search import event_range

TIME = np.linspace(0.0, 1.0, 101)
PARTS = ("error", "error_held_out", "error_decay")


@pytest.mark.parametrize("alignment", ["stretch", "shift"])
@pytest.mark.parametrize(("pace", "start"), [(1.0, 7.0), (40.0, 0.0), (0.01, -3.0)])
def test_they_do_not_depend_on_when_time_begins_nor_on_its_pace(pace, start, alignment):
    design = make_design("tensor_roots", 1, 2)
    samples = ball_samples(design, instants=301)
    moved = samples.assign_coords(time=start + pace * samples["time"])
    moved = moved.assign(event_time=start + pace * samples["event_time"])
    first, other = (
        bounds_dataset(data, design, model="aligned", alignment=alignment)
        for data in (samples, moved)
    )
    for name in ("lower", "upper", *PARTS):
        np.testing.assert_allclose(other[name], first[name], rtol=1e-6, atol=1e-7, err_msg=name)


@pytest.mark.parametrize(("held_out", "parts"), [(0, PARTS), (4, ("error_held_out",))])
def test_without_impacts_they_are_those_of_the_polynomial(held_out, parts):
    """Of one piece from the beginning to the end. (A polynomial's held-out runs may overrule what
    its coefficients foretell.)"""
    box = Box(["f", "g"], [0.9, 0.3], [1.1, 0.5])
    design = make_design("tensor_lobatto", box, 2)

    def wave(v):
        return np.sin(6 * TIME * v[0]) * np.exp(v[1] * TIME)

    samples = samples_of(wave, box, design, TIME, held_out)
    none = np.full((samples.sizes["run"], 2), np.nan)
    samples = samples.assign(event_time=(("run", "event"), none))
    plain, aligned = (
        bounds_dataset(samples, design, model=model, window=0.0)
        for model in ("polynomial", "aligned")
    )
    assert float(plain[parts[-1]].max()) > 1e-4
    for name in parts:
        np.testing.assert_allclose(aligned[name], plain[name], rtol=1e-6, atol=1e-9, err_msg=name)


def steps(late):
    """A model of a step at 0.5 + 0.1 u s, and its error estimate where the one run that tests it,
    at u = 0.3, steps `late` s later than the model says."""
    points = np.cos(np.pi * (np.arange(4) + 0.5) / 4)[:, None]
    impacts = 0.5 + 0.1 * points
    values = (impacts <= TIME).astype(float)
    model = fit_event_model(points, total_degree([3]), TIME, values, impacts)
    low, high, *_ = event_range(model, TIME)
    table = np.array([0.53 + late])
    own = (table <= TIME).astype(float)[None]
    tested = np.array([[0.3]])
    return aligned_error(model, TIME, tested, own, [table], (low, high), window=0.0).total


@pytest.mark.parametrize("late", [-0.035, 0.035])
def test_an_impact_that_comes_at_another_time_counts_on_both_sides_of_where_it_may_be(late):
    """The upper bound jumps at 0.4 s, the lower one at 0.6 s: both may do so 0.035 s off."""
    error = steps(late)
    near = (np.abs(TIME - 0.4) < 0.024) | (np.abs(TIME - 0.6) < 0.024)
    far = (np.abs(TIME - 0.4) > 0.046) & (np.abs(TIME - 0.6) > 0.046)
    np.testing.assert_allclose(error[near], 1.0, atol=1e-9)
    np.testing.assert_allclose(error[far], 0.0, atol=1e-9)


def test_an_impact_at_the_time_that_the_model_says_leaves_no_error():
    np.testing.assert_allclose(steps(0.0), 0.0, atol=1e-9)


def test_without_held_out_runs_the_coefficients_tell_the_size_of_the_error():
    """e^(3 u) in either piece, between two impacts: the cubic errs by 0.5, of 20."""
    box = Box(["u"], [-1.0], [1.0])
    design = make_design("tensor_roots", box, 3)
    samples = samples_of(lambda v: np.exp(3 * v[0]) * (1 + TIME), box, design, TIME, held_out=0)
    impacts = 0.5 + 0.05 * samples["value"].values
    bounds = bounds_dataset(
        samples.assign(event_time=(("run", "event"), impacts)), design, model="aligned"
    )
    true = np.maximum(
        np.abs(bounds["upper"].values[0] - np.exp(3) * (1 + TIME)),
        np.abs(bounds["lower"].values[0] - np.exp(-3) * (1 + TIME)),
    )
    assert true.min() > 0.1
    told = bounds["error"].values[0]
    assert (told > 0.5 * true).all() and (told < 10 * true).all()
