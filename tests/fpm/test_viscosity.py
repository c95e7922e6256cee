"""Bulk viscosity of beams: a rod that is pulled at once against the wave equation."""

from dataclasses import replace

import numpy as np
import pytest

import fpm
from fpm.elements import Viscosity
from fpm.elements.bars.beam import Material, Section
from fpm.reading.responses import Response
from fpm.reading.shocks import warn
from fpm.solver.pack import pack
from fpm.structures import loads

STEEL, BAR, FORCE = Material(210e9, 0.3, 7800.0), Section.square(0.01), 1000.0
SPEED = np.sqrt(STEEL.E / STEEL.rho)  # m/s, of waves
STRESS = [("stress", "all")]


def rod(elements, share=0.0) -> fpm.Scene:
    """A bar of 1 m along (1, 1, 0), clamped at its start and pulled at its end from t = 0 on."""
    scene = fpm.Scene("rod")
    along = np.array([1.0, 1.0, 0.0]) / np.sqrt(2)
    bar = scene.add_link((0, 0, 0), along, (0, 0, 1), BAR, STEEL, elements, "rod")
    scene.fix(int(bar.particles[0]))
    scene.add_load(int(bar.particles[-1]), force=FORCE * along)
    scene.add(Viscosity(share))
    return scene


def run(scene):
    step = 0.9 * fpm.find_stable_step(scene).step
    (outcome,) = fpm.simulate(scene, duration=4 / SPEED, instants=401, step=step, record=STRESS)
    assert outcome.failure is None
    return outcome


def test_an_end_that_is_led_from_the_start_on_has_its_rate():
    scene = rod(1, 0.1)
    scene.drive(1, velocity=(3.0, 1.0, 0.0))
    rate = pack([scene], 8, np.dtype(float), 2).part(Viscosity).history[0, 0]
    assert rate == pytest.approx(4.0 / np.sqrt(2))


@pytest.mark.slow
@pytest.mark.parametrize("elements", [20, 40])
def test_a_rod_that_is_pulled_at_once_bears_twice_the_wave_and_no_more(elements):
    """2 F/A at the clamp (d'Alembert): within 2 % with viscosity, a fifth more and above without.
    The energy balances, and what is taken out is a small part of what is given."""
    exact = 2 * FORCE / BAR.A
    plain, viscous = (run(rod(elements, share)) for share in (0.0, 0.2))
    assert plain.columns[STRESS[0]].max() > 1.2 * exact
    assert viscous.columns[STRESS[0]].max() == pytest.approx(exact, rel=0.02)
    for outcome in (plain, viscous):
        given = outcome.energies["load_work"]
        assert np.abs(outcome.energies["balance"]).max() < 1e-9 * np.abs(given).max()
    taken = viscous.energies["damping_work"]
    assert (np.diff(taken) > -1e-6 * taken[-1]).all()
    assert 0 < taken[-1] < 0.1 * np.abs(viscous.energies["load_work"]).max()


@pytest.mark.slow
def test_the_displacement_of_the_end_is_that_of_the_wave():
    """The viscosity does not touch what the mesh resolves: 2 F L/(E A) after a way there and back,
    back to zero after two (d'Alembert). Within 2 % of the most, but for the two kinks, which four
    elements round: 6 %."""
    scene = rod(40, 0.2)
    scene.add_point("end", int(scene.beams[0].nodes[-1, 1]))
    (outcome,) = fpm.simulate(
        scene, duration=4 / SPEED, instants=401, step=0.5 * fpm.find_stable_step(scene).step
    )
    moved = np.linalg.norm(outcome.points["end"][0], axis=1) - 1.0
    most = 2 * FORCE / (STEEL.E * BAR.A)
    way = outcome.time * SPEED
    exact = most * np.where(way < 2, way / 2, 2 - way / 2)
    off, round_kinks = np.abs(moved - exact) / most, np.abs(way - 3) > 0.9
    assert off[~round_kinks | (way < 1.9)].max() < 0.02
    assert off.max() < 0.06


def test_viscosity_counts_in_the_stable_step_where_it_is_more_than_bending():
    plain, some, much = (fpm.find_stable_step(rod(20, share)).step for share in (0.0, 0.2, 1.0))
    assert some == pytest.approx(plain, rel=0.02)
    # With h' = h sqrt(E/rho)/l, of equal masses: h'^2 + 4 h' = 1; at the ends these are lighter.
    assert much * SPEED * 20 == pytest.approx(np.sqrt(5) - 2, rel=0.1)


def test_a_structure_states_it_for_all_its_bars():
    text = """
name: rods
viscosity: 0.2
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7800 kg/m3}}
sections: {round: {type: circle, diameter: 1 cm}}
points: {a: [0, 0, 0], b: [1 m, 0, 0], c: [2 m, 0, 0]}
bars:
  one: {through: [a, b], section: round, material: steel, elements: 3}
  two: {through: [b, c], section: round, material: steel, elements: 2}
joints: {knee: {type: fixed, parts: [one, two], at: b}}
supports: {foot: {part: one, at: a}}
"""
    stated, plain = (loads(one).sample for one in (text, text.replace("viscosity: 0.2\n", "")))
    found = Viscosity.dampings(stated)
    assert found.stiffness == pytest.approx(0.2 * np.pi * 25e-6 * np.sqrt(210e9 * 7800), rel=1e-9)
    assert found.element.tolist() == [0, 1, 2, 3, 4]
    assert not Viscosity.find(plain)


@pytest.mark.parametrize("share", [-0.1, np.nan, np.inf])
def test_a_share_that_is_none_is_refused(share):
    with pytest.raises(fpm.SceneError, match="viscosity"):
        rod(4).add(Viscosity(share))


def test_a_load_at_once_is_in_doubt_without_viscosity_only():
    stress = Response("s", "stress", ("all",), "", "Pa", "stress", tuple(STRESS))
    assert "viscosity: 0.2" in warn(rod(4), stress)
    assert warn(rod(4, 0.2), stress) == ""
    for share, is_silent in ((0.05, False), (0.2, True)):  # as much by the material
        scene, damped = rod(4), replace(STEEL, stiffness_damping=share * 0.25 / SPEED)
        scene.beams[:] = [replace(beams, material=damped) for beams in scene.beams]
        assert (warn(scene, stress) == "") == is_silent
