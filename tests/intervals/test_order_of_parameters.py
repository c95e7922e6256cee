"""In which order the parameters are named does not matter, for any design and model."""

from dataclasses import replace

import numpy as np
import pytest
from datasets_for_tests import samples_of

from deployable.intervals import (
    METHODS,
    MODELS,
    Box,
    bounds_dataset,
    make_design,
    sensitivity_dataset,
)

TIME = np.linspace(0.0, 1.0, 13)
NAMES, LOWER, UPPER = ("f", "g", "h"), np.array([0.9, 0.3, 0.0]), np.array([1.1, 0.3, 0.2])
ORDERS = ([0, 1, 2], [1, 0, 2], [2, 0, 1])  # g has no width, and every place in turn


def wave(values):
    f, g, h = (values[name] for name in NAMES)
    return np.sin(6 * TIME * f) * np.exp(h) + g * TIME


def made(method, order):
    """Box, design and samples of the wave with the parameters in another order."""
    box = Box([NAMES[j] for j in order], LOWER[order], UPPER[order])
    options = {"samples": 24} if "samples" in METHODS[method].options else {}
    design = make_design(method, box, None if method == "screening" else 3, **options)
    return design, samples_of(
        lambda v: wave(dict(zip(box.names, v, strict=True))), box, design, TIME
    )


def permuted(design, samples, order):
    """The same runs with the columns of the parameters in another order."""
    moved = replace(
        design,
        points=design.points[:, order],
        multi_indices=design.multi_indices[:, order],
        order=tuple(design.order[j] for j in order),
        lines=None,  # that belongs to the order of the runs
    )
    return moved, samples.isel(parameter=order)


@pytest.mark.parametrize("method", METHODS)
def test_designs_have_as_many_runs_and_the_same_polynomials_and_points(method):
    """Points that depend on the order are those of a sequence, and of no other design."""
    counts, points = set(), set()
    for order in ORDERS:
        design, _ = made(method, order)
        back = np.argsort(order)
        basis = sorted(map(tuple, design.multi_indices[:, back]))
        counts.add((design.run_count, len(design.points), tuple(basis)))
        points.add(tuple(sorted(map(tuple, design.points[:, back]))))
    assert len(counts) == 1
    assert (len(points) == 1) == (method != "sobol")


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("method", METHODS)
def test_the_same_runs_have_the_same_bounds(method, model):
    design, samples = made(method, ORDERS[0])
    first = bounds_dataset(samples, design, model=model)
    slack = 1e-6 * float(np.abs(samples["values"]).max())
    gap = float((first["inner_lower"] - first["lower"]).max())
    other = bounds_dataset(*reversed(permuted(design, samples, ORDERS[2])), model=model)
    assert other["parameter"].values.tolist() == [NAMES[j] for j in ORDERS[2]]
    for name in ("inner_lower", "inner_upper", "error"):
        np.testing.assert_allclose(other[name], first[name], atol=slack, err_msg=name)
    for name in ("lower", "upper"):
        np.testing.assert_allclose(other[name], first[name], atol=gap + slack)


@pytest.mark.parametrize("method", METHODS)
def test_the_same_runs_have_the_same_sensitivities(method):
    design, samples = made(method, ORDERS[0])
    first = sensitivity_dataset(samples, design)
    for order in ORDERS[1:]:
        other = sensitivity_dataset(*reversed(permuted(design, samples, order)))
        for name in ("width", "width_overall"):
            wanted = first[name].sel(parameter=other["parameter"])
            np.testing.assert_allclose(other[name], wanted, atol=1e-9)
