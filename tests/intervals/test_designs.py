"""Designs: counts, nested points, exactness, refusals."""

import numpy as np
import pytest
from scipy.stats import qmc

from deployable.intervals import Box, IntervalError, fit, held_out_points, make_design
from deployable.intervals.box import find_other_runs, match_points
from deployable.intervals.chebyshev import (
    count_smolyak,
    lobatto,
    product_basis,
    roots,
    smolyak,
    tensor,
    total_degree,
)
from deployable.intervals.designs import complete_runs, scan_points
from deployable.intervals.sobol import sobol


def keys(points):
    return {tuple(p) for p in points}


def test_roots_are_those_of_the_paper():
    n = 3
    paper = np.cos((2 * np.arange(1, n + 2) - 1) / (n + 1) * np.pi / 2)
    np.testing.assert_allclose(np.sort(paper), roots(n), atol=1e-15)
    assert make_design("tensor_roots", 2, n).run_count == (n + 1) ** 2


@pytest.mark.parametrize("order", [1, 2, 3, 5, 8, 16, 32])
def test_lobatto_points_of_the_doubled_order_contain_the_old_ones_to_the_last_bit(order):
    assert set(lobatto(order)) <= set(lobatto(2 * order))
    box = Box(["a", "E"], [0.03465, 0.95e9], [0.03535, 1.05e9])
    few = box.from_unit(make_design("tensor_lobatto", 2, min(order, 8)).points)
    many = box.from_unit(make_design("tensor_lobatto", 2, 2 * min(order, 8)).points)
    assert keys(few) <= keys(many)
    assert keys(box.from_unit(box.corners())) <= keys(few)


@pytest.mark.parametrize(("dimension", "seed"), [(1, 0), (3, 2**32 - 1), (60, 7)])
def test_sobol_points_are_those_of_scipy_to_the_last_bit(dimension, seed):
    points = qmc.Sobol(dimension, rng=seed).random(1 << 9)
    assert (sobol(500, dimension, seed) == points[:500]).all()


def test_smolyak_and_scan_are_nested_too():
    assert keys(make_design("smolyak", 3, 2).points) <= keys(make_design("smolyak", 3, 4).points)
    few, many = (make_design("sobol", 2, samples=n).points for n in (64, 200))
    assert keys(few) <= keys(many)


@pytest.mark.parametrize(("k", "order"), [(1, 5), (2, 4), (3, 3), (6, 2), (8, 2), (3, [5, 3, 0])])
def test_sets_of_polynomials_are_those_of_their_definitions(k, order):
    """A Smolyak set is the union of the tensor sets of nested rules over a total-degree set."""
    orders = [order] * k if isinstance(order, int) else order
    everything = tensor(orders)
    shares = everything @ np.array([1 / n if n else 0.0 for n in orders])
    rows = {tuple(row) for row in everything[shares <= 1 + 1e-9].tolist()}
    assert {tuple(row) for row in total_degree(orders).tolist()} == rows
    nested = [0, *(max(2, 1 << (n - 1).bit_length()) for n in range(1, max(orders) + 1))]
    union = {tuple(i) for row in rows for i in tensor([nested[n] for n in row]).tolist()}
    assert {tuple(row) for row in smolyak(orders).tolist()} == union
    assert count_smolyak(orders) == len(union)


@pytest.mark.parametrize("k", [1, 2, 3, 4])
@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("method", ["tensor_roots", "tensor_lobatto", "smolyak"])
def test_every_method_reproduces_polynomials_of_its_total_degree(method, k, order):
    generator = np.random.default_rng(k + 10 * order)
    indices = total_degree([order] * k)
    weights = generator.standard_normal((len(indices), 2))
    design = make_design(method, k, order)
    surrogate = fit(design, product_basis(design.points, indices) @ weights)
    test = generator.uniform(-1, 1, (20, k))
    np.testing.assert_allclose(
        surrogate.evaluate(test), product_basis(test, indices) @ weights, atol=1e-10
    )


@pytest.mark.parametrize("k", [1, 2, 3])
@pytest.mark.parametrize("method", ["tensor_roots", "tensor_lobatto", "smolyak"])
def test_a_design_may_have_as_many_runs_as_are_allowed_and_no_more(method, k):
    runs = make_design(method, k, 4).run_count
    assert make_design(method, k, 4, max_runs=runs).run_count == runs
    with pytest.raises(IntervalError, match=f"not {runs}"):
        make_design(method, k, 4, max_runs=runs - 1)


def test_zero_width_contributes_one_point():
    box = Box(["a", "b", "c"], [0.0, 5.0, 0.0], [1.0, 5.0, 1.0])
    for method, runs in (("tensor_roots", 16), ("smolyak", None)):
        design = make_design(method, box, 3)
        assert runs in (None, design.run_count)
        assert not design.points[:, 1].any()
    point = Box(["a"], [2.0], [2.0])
    for method in ("tensor_roots", "tensor_lobatto", "smolyak", "sobol"):
        assert make_design(method, point, 3).run_count == 1
    assert len(held_out_points(point.free, 4)) == 0


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_other_runs_are_those_at_no_point_of_the_design(dimension):
    """Also where they share all coordinates but one with some of its points."""
    nodes = make_design("tensor_lobatto", dimension, 2).points
    others = held_out_points(np.ones(dimension, dtype=bool), 5, nodes)
    others = np.concatenate([others, nodes[:1] * [*[1.0] * (dimension - 1), 0.5]])
    unit = np.concatenate([others[:2], nodes + 1e-12, others[2:]])
    found = find_other_runs(unit, nodes)
    np.testing.assert_array_equal(unit[found], others)
    assert match_points(nodes, unit).tolist() == list(range(2, 2 + len(nodes)))


@pytest.mark.parametrize(
    ("arguments", "options", "key"),
    [
        (("chebyshev", 1, 3), {}, "method"),
        (("tensor_roots", 1, 0), {}, "order"),
        (("tensor_roots", 1, 65), {}, "order"),
        (("tensor_roots", 1, 2.5), {}, "order"),
        (("tensor_roots", 1, None), {}, "order"),
        (("tensor_roots", 2, [1, 2, 3]), {}, "order"),
        (("tensor_roots", 8, 9), {}, "order"),
        (("tensor_roots", 61, 1), {}, "box dimension"),
        (("tensor_roots", 9, 1), {}, "method"),
        (("tensor_roots", 1, 3), {"seed": 1}, "design option"),
        (("sobol", 2), {"samples": 0}, "samples"),
        (("sobol", 3, 9), {"samples": 10}, "samples"),
    ],
)
def test_wrong_designs_are_refused_with_key_value_and_what_is_allowed(arguments, options, key):
    with pytest.raises(IntervalError) as caught:
        make_design(*arguments, **options)
    assert caught.value.key == key
    assert caught.value.allowed


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_a_scan_has_the_corners_unless_they_took_more_than_half_of_it(dimension):
    corners = 2**dimension
    for samples in range(1, 4 * corners):
        points = make_design("sobol", dimension, samples=samples).points
        found = (np.abs(points) == 1.0).all(axis=1).sum()
        assert found == (corners if 2 * corners <= samples else 0), samples


@pytest.mark.parametrize("method", ["tensor_roots", "smolyak"])
def test_runs_that_failed_are_predicted_within_the_error_that_is_told(method):
    """Of the 25 nodes two failed; the function is known there."""
    design = make_design(method, 2, 4)
    points = np.concatenate([design.points, scan_points(np.ones(2, bool), 12, corners=False)])
    values = np.stack([np.exp(0.5 * points[:, 0]), points[:, 0] * np.sin(points[:, 1])], axis=1)
    kept = np.delete(np.arange(len(points)), [3, 9])
    found, error = complete_runs(design, points[kept], values[kept], points[[3, 9]])
    truth = values[: design.run_count]
    assert (np.abs(found - truth) <= error).all() and (found[[3, 9]] != truth[[3, 9]]).all()
    assert (error < 0.2).all()
    rest = np.delete(np.arange(design.run_count), [3, 9])
    np.testing.assert_array_equal(found[rest], truth[rest])
    with pytest.raises(IntervalError, match="no run at 1 of"):
        complete_runs(design, points[kept], values[kept], points[[3]])
