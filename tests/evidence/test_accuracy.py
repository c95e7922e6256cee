"""The study of speed against accuracy: its lumpings, its phases, and what it concludes."""

import numpy as np
import pytest

from evidence.accuracy import choices as accuracy
from evidence.accuracy import study
from evidence.accuracy.choices import Choice


@pytest.mark.parametrize("kind", ["trapezium", "gregory-2", "gregory-3"])
@pytest.mark.parametrize("elements", [2, 5, 8])
def test_lumpings_keep_the_mass_and_the_second_the_inertia(kind, elements):
    weights = accuracy.weights(kind, elements)
    x = np.linspace(-0.5, 0.5, elements + 1)
    inertia = {"trapezium": 1 + 2 / elements**2, "gregory-2": 1.0, "gregory-3": 1.0}[kind]
    assert weights.sum() == pytest.approx(elements)
    assert weights @ x**2 / elements == pytest.approx(inertia / 12)


def test_another_lumping_changes_the_masses_only():
    plain, other = (accuracy.scene_of(Choice(6, lumping=k)) for k in ("default", "trapezium"))
    assert other.mass.sum() == pytest.approx(plain.mass.sum())
    assert np.abs(other.mass - plain.mass).max() > 0.1 * plain.mass.max()
    assert np.array_equal(other.inertia, plain.inertia)


@pytest.mark.slow
def test_the_mesh_and_the_lumping_count_and_the_step_does_not():
    """A small version of the study, against 24 elements."""
    reference, _ = accuracy.simulate(Choice(24))
    choices = [Choice(4), Choice(8), Choice(8, safety=0.45), Choice(8, scale=3.0),
               Choice(8, lumping="trapezium")]  # fmt: skip
    results = accuracy.measure(choices, reference)
    names = [phase.name for phase in results[0].phases]
    assert names == ["before", "between", "after"]
    coarse, plain, small_step, scaled, trapezium = (r.phases[1].bd for r in results)
    assert coarse > 4 * plain
    assert small_step == pytest.approx(plain, rel=0.3)
    assert scaled > 2 * plain
    assert trapezium > 8 * plain
    table = study.choices_table(results)
    assert table.count("\n") == 2 + len(choices)


def test_a_run_against_itself_has_no_error():
    reference, _ = accuracy.simulate(Choice(4))
    for phase in accuracy.errors(reference, reference):
        assert phase.bd == phase.velocity == 0.0
