"""Bulk viscosity of beams: a rod that is pulled at once against the wave equation."""

from dataclasses import replace

import numpy as np
import pytest

import fpm
from fpm.elements import BarDamping
from fpm.elements.bars.bar_damping_kernels import RATE
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
    scene.add(BarDamping(share))
    return scene


def test_an_end_that_is_led_from_the_start_on_has_its_rate():
    scene = rod(1, 0.1)
    scene.drive(1, velocity=(3.0, 1.0, 0.0))
    rate = pack([scene], 2).part(BarDamping).history[0, RATE]
    assert rate == pytest.approx(4.0 / np.sqrt(2))


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
    found = BarDamping.dampings(stated)
    damping = found.stiffness[found.stiffness > 0]
    assert damping == pytest.approx(0.2 * np.pi * 25e-6 * np.sqrt(210e9 * 7800), rel=1e-9)
    assert found.element[found.stiffness > 0].tolist() == [0, 1, 2, 3, 4]
    assert not BarDamping.find(plain)


@pytest.mark.parametrize("share", [-0.1, np.nan, np.inf])
def test_a_share_that_is_none_is_refused(share):
    with pytest.raises(fpm.SceneError, match="viscosity"):
        rod(4).add(BarDamping(share))


def test_a_load_at_once_is_in_doubt_without_viscosity_only():
    stress = Response("s", "stress", ("all",), "", "Pa", "stress", tuple(STRESS))
    assert "viscosity: 0.2" in warn(rod(4), stress)
    assert warn(rod(4, 0.2), stress) == ""
    for share, is_silent in ((0.05, False), (0.2, True)):  # as much by the material
        scene, damped = rod(4), replace(STEEL, stiffness_damping=share * 0.25 / SPEED)
        scene.beams[:] = [replace(beams, material=damped) for beams in scene.beams]
        assert (warn(scene, stress) == "") == is_silent
