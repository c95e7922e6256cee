"""What must not matter does not: offsets, scales, directions without width, when time begins."""

import numpy as np
import pytest
from datasets_for_tests import samples_of

from deployable.intervals import (
    Box,
    bounds_dataset,
    fit_spline,
    make_design,
    seek_points,
    spline_range,
)
from deployable.intervals.chebyshev import Surrogate, product_basis, tensor
from deployable.intervals.ranges import find_surrogate_range

TIME = np.linspace(0.0, 1.0, 41)
BOX = Box(["f", "g"], [0.9, 0.3], [1.1, 0.5])


def wave(values):
    f, g = values
    return np.sin(6 * TIME * f) + g * TIME**2 * f


def peak(order, at):
    """Coefficients of a kernel of degree `order` in each direction: 1 at the point `at` (k), and
    narrow; and its multi-indices."""
    indices = tensor((order,) * len(at))
    damping = (1.0 - indices / (order + 1)).prod(axis=1)
    c = product_basis(np.array([at]), indices)[0] * damping * 2.0 ** (indices > 0).sum(axis=1)
    return c / (product_basis(np.array([at]), indices)[0] @ c), indices


def test_the_outer_range_holds_a_peak_that_no_search_finds():
    """A broad hill of 30 draws every search; in it is a narrow peak, higher by 4.5."""
    at = np.array([0.613, -0.471, 0.287])
    c, indices = peak(20, at)
    hill = np.zeros(len(c))
    for j in range(3):  # 30 - sum of 4 (x + 0.5)^2, in Chebyshev polynomials
        unit = np.eye(3, dtype=int)[j]
        for degree, value in ((0, 4 * (0.5 + 0.25)), (1, 4.0), (2, 2.0)):
            hill[(indices == degree * unit).all(axis=1).argmax()] -= value
    hill[0] += 30.0
    c = (12.0 * c + hill)[:, None]
    surrogate = Surrogate(c, indices)
    there = float(surrogate.evaluate(at[None])[0, 0])
    found = find_surrogate_range(surrogate)
    assert there > 34.0 > 30.1 > float(found.inner_upper[0])  # else this would show nothing
    assert float(found.upper[0]) >= there
    below = find_surrogate_range(Surrogate(-c, indices))
    assert float(below.lower[0]) <= -there


@pytest.mark.parametrize(("free", "place"), [(2, 0), (2, 1), (2, 2), (1, 0), (1, 1)])
def test_a_direction_without_width_changes_no_spline(free, place):
    rng = np.random.default_rng(3)
    points = rng.uniform(-1, 1, (24, free))
    values = np.sin(3 * points[:, :1] + 5 * points[:, -1:] * np.linspace(0, 1, 30))
    if free == 1:
        points[1] = points[0] + 1e-5  # which counts as another run on a line only
        values[1] = values[0]
    alone, wider = fit_spline(points, values), np.insert(points, place, 0.0, axis=1)
    found = fit_spline(wider, values)
    assert len(found.points) == len(alone.points) == 24
    alone, found = spline_range(alone), spline_range(found)
    np.testing.assert_allclose(found.lower, alone.lower, atol=1e-12)
    np.testing.assert_allclose(found.upper, alone.upper, atol=1e-12)
    for side in ("argmin", "argmax"):
        there = np.delete(getattr(found, side), place, axis=-1)
        np.testing.assert_allclose(there, getattr(alone, side), atol=1e-9)
        assert not getattr(found, side)[..., place].any()


@pytest.mark.parametrize("unit", [1e-9, 1e9])
@pytest.mark.parametrize("held_out", [0, 9])
@pytest.mark.parametrize("model", ["polynomial", "spline", "scan"])
def test_bounds_and_their_errors_do_not_depend_on_the_unit(model, held_out, unit):
    design = make_design("tensor_lobatto", BOX, 4)
    found, other = (
        bounds_dataset(samples_of(function, BOX, design, TIME, held_out), design, model=model)
        for function in (wave, lambda values: unit * wave(values))
    )
    for name in ("lower", "upper", "inner_lower", "error", "largest_width"):
        np.testing.assert_allclose(other[name] / unit, found[name], rtol=1e-6, atol=1e-12)
    share = "error_share_of_width"
    np.testing.assert_allclose(other[share], found[share], rtol=1e-6, atol=1e-12)


def test_what_seeking_promises_does_not_depend_on_offsets_and_scales():
    unit = make_design("sobol", 2, samples=32).points
    values = np.stack([wave(BOX.from_unit(u)) for u in unit])[:, None]
    points, growth = seek_points(unit, values, 6, candidates=512)
    assert growth[0] > 0
    for scale, offset in ((1.0, 64.0), (1024.0, 0.0)):
        other, promised = seek_points(unit, scale * values + offset, 6, candidates=512)
        np.testing.assert_allclose(promised, growth, rtol=1e-3)
        assert len(other) == len(points)
