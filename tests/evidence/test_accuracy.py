"""The study of speed against accuracy: its lumpings, its phases, and what it concludes."""

import numpy as np
import pytest

from evidence.accuracy import choices as accuracy
from evidence.accuracy import study
from evidence.accuracy.choices import Choice
from fpm.scenes.timestep import find_stable_step


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


@pytest.mark.parametrize("elements", accuracy.CHAINS)
def test_fitted_links_keep_mass_and_inertia(elements):
    plain, fitted = (accuracy.scene_of(Choice(elements, lumping=k)) for k in ("default", "fitted"))
    assert fitted.mass.sum() == pytest.approx(plain.mass.sum())
    assert fitted.inertia[:, 0].sum() == pytest.approx(plain.inertia[:, 0].sum())

    def inertia(scene):  # of the first link across its axis, about its middle
        link = slice(0, elements + 1)
        ends = scene.position[[0, elements]]
        squares = np.sum((scene.position[link] - ends.mean(axis=0)) ** 2, axis=1)
        return scene.mass[link] @ squares + scene.inertia[link, 1].sum()

    assert inertia(fitted) == pytest.approx(inertia(plain), rel=1e-4)
    beams = fitted.beams[0]
    chords = np.diff(fitted.position[: elements + 1], axis=0)
    assert np.linalg.norm(chords, axis=1) == pytest.approx(beams.length)
    assert beams.length.sum() == pytest.approx(plain.beams[0].length.sum())


def test_rotational_inertia_sets_the_step_and_axial_stiffness_does_not():
    plain, soft, heavy = (accuracy.scene_of(Choice(12, axial=a)) for a in (1.0, 0.01, 1.0))
    heavy.inertia *= 100
    step, soft_step, heavy_step = (find_stable_step(s).step for s in (plain, soft, heavy))
    assert soft_step == pytest.approx(step, rel=0.01)
    assert heavy_step > 1.7 * step


@pytest.mark.slow
def test_the_mesh_and_the_lumping_count_and_the_step_does_not():
    """A small version of the study, against 24 elements."""
    reference, _ = accuracy.simulate(Choice(24))
    choices = [Choice(4), Choice(8), Choice(8, safety=0.45), Choice(8, scale=3.0),
               Choice(8, lumping="trapezium"), Choice(5), Choice(5, lumping="fitted")]  # fmt: skip
    results = accuracy.measure(choices, reference)
    names = [phase.name for phase in results[0].phases]
    assert names == ["before", "between", "after"]
    coarse, plain, small_step, scaled, trapezium, five, fitted = (r.phases[1].bd for r in results)
    assert coarse > 4 * plain
    assert small_step == pytest.approx(plain, rel=0.3)
    assert scaled > 2 * plain
    assert trapezium > 8 * plain
    assert fitted < 0.25 * five
    assert fitted < 1.5 * plain
    assert results[-1].steps < 0.65 * results[1].steps
    table = study.choices_table(results)
    assert table.count("\n") == 2 + len(choices)


def test_a_run_against_itself_has_no_error():
    reference, _ = accuracy.simulate(Choice(4))
    for phase in accuracy.errors(reference, reference):
        assert phase.bd == phase.velocity == 0.0
