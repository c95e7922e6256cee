"""Matrices in either form, and the equations of static balance in both."""

import numpy as np
import pytest

from fpm.assembly.matrices import full, saddle_solver, scale_matrix, sparse

RANDOM = np.random.default_rng(4)


def test_both_forms_sum_entries_at_the_same_places():
    rows, columns = RANDOM.integers(0, 5, (3, 6, 1)), RANDOM.integers(0, 4, (3, 1, 2))
    values = RANDOM.standard_normal((3, 6, 2))
    expected = np.zeros((5, 4))
    np.add.at(expected, (rows, columns), values)
    for form in (sparse, full):
        matrix = form(values, rows, columns, (5, 4))
        assert abs(matrix - expected).max() < 1e-15
        scaled = scale_matrix(matrix, np.arange(5.0), np.arange(4.0) + 1)
        assert abs(scaled - expected * np.outer(np.arange(5.0), np.arange(4.0) + 1)).max() < 1e-14


@pytest.mark.parametrize("form", [sparse, full])
def test_no_entries_make_a_matrix_of_zeros(form):
    matrix = form(np.zeros((0, 12)), np.zeros((0, 1), int), np.zeros((0, 12), int), (3, 2))
    assert matrix.shape == (3, 2) and not abs(matrix).sum()


@pytest.mark.parametrize("form", [sparse, full])
def test_equations_that_are_exactly_singular_have_no_solution(form):
    places = np.arange(2)
    solve = saddle_solver(
        form(np.zeros(2), places, places, (2, 2)), form(*[places[:0]] * 3, (0, 2)), 1
    )
    assert np.isnan(solve(np.ones(2))).all()
