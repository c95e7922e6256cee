"""Matrices in either form, and the equations of static balance in both."""

import numpy as np
import pytest
from hinged import hinged

from fpm.assembly.conditions import ParticlePoses, conditions_of
from fpm.assembly.matrices import full, saddle_solver, scale_matrix, sparse
from fpm.assembly.search import StaticEquations
from fpm.elements import Gravity
from fpm.elements.bars.beam import Material, Section
from fpm.travel.path import balance_of

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


def test_a_step_to_balance_is_the_same_in_both_forms():
    """Of a panel on a bar, with a spring and weight, moved from where it is at rest."""
    scene = hinged(0.2)
    scene.add_torsion_spring(0, 0.1, np.pi)
    scene.kinds[Gravity] = [Gravity(np.array([0, -1.0, 0]))]
    shape = Section.square(0.02), Material(1e9, 0.3, 800.0)
    link = scene.add_link((0, 0, 0), (0, 1, 0), (0, 0, 1), *shape, elements=2)
    scene.fix(link.particles[0])
    start = ParticlePoses(scene.position, scene.frame)
    poses = start.displace(0.01 * RANDOM.standard_normal(scene.fixed.size))
    conditions, balance = conditions_of(scene), balance_of(scene)
    impulses = RANDOM.standard_normal(len(conditions.joint))
    steps = []
    for form in (sparse, full):
        equations = StaticEquations(scene, balance, conditions, form)
        solve, gradient = equations.linearise(poses, impulses, 1e-3)
        steps.append(np.concatenate([gradient, *solve(-gradient, conditions.gaps(poses))]))
    assert np.abs(steps[0]).max() > 0.01
    assert steps[0] == pytest.approx(steps[1], rel=1e-6, abs=1e-6 * np.abs(steps[0]).max())
