"""Bars that are longer or curved without stress, as by heat, against closed forms."""

import numpy as np
import pytest
from structures_for_tests import FOURBAR, changed, refused

import fpm
from fpm.solver.pack import topology
from fpm.structures import loads
from fpm.travel import sweep

ALPHA, WIDE, HIGH = 23e-6, 0.02, 0.01  # 1/°C, m, m
BAR = """
name: heated
assemble: true
parameters:
  T: {value: 20, range: [-200, 200]}
  across: {value: 0, range: [-200, 200]}
let: {alpha: 23e-6}
points: {a: [0, 0, 0], b: [1, 0, 0]}
materials:
  al: {E: "interpolate(T, 20, 70 GPa, 100, 66 GPa)", nu: 0.3, rho: 2700}
sections: {strip: {type: rectangle, width: 20 mm, height: 10 mm}}
bars:
  bar:
    through: [a, b]
    section: strip
    material: al
    elements: 8
    up: z
    strain: alpha*(T - 20)
    curvature: alpha*across/(10 mm)
joints:
  left: {type: fixed, parts: [ground, bar], at: a}
  right: {type: fixed, parts: [bar, ground], at: b}
record:
  b: {part: bar, at: b}
"""
FREE = changed(BAR, ("  right: {type: fixed, parts: [bar, ground], at: b}\n", ""))


def test_a_bar_with_a_free_end_takes_its_new_form_without_stress():
    found = loads(FREE).build(T=60.0, across=30.0)
    longer, curvature = 1 + ALPHA * 40, ALPHA * 30 / HIGH
    turn = curvature * longer
    tip = np.array([np.sin(turn), 0, np.cos(turn) - 1]) / curvature
    assert found.position[-1] == pytest.approx(tip, abs=1e-5)  # eight straight elements of an arc
    assert found.assembly.energy < 1e-15
    assert found.frame[-1, :, 0] == pytest.approx([np.cos(turn), 0, -np.sin(turn)], abs=1e-6)


@pytest.mark.slow
def test_a_bar_between_fixed_ends_bears_the_force_and_the_moment_of_heat():
    """E A alpha dT, and E I alpha dT/height: at rest, with the modulus of its temperature."""
    record = [("section_force", "bar at 0.3 axial"), ("section_moment", "bar at 0.3 bending_y")]
    made = loads(BAR)
    scenes = [made.build(T=30.0), made.build(across=30.0), made.build()]  # it buckles from 34
    for scene, e, curvature in zip(scenes, (ALPHA * 10, 0, 0), (0, ALPHA * 30 / HIGH, 0),
                                   strict=True):  # fmt: skip
        (run,) = fpm.simulate(scene, duration=1e-3, instants=3, record=record)
        force, moment = (run.columns[column] for column in record)
        modulus = 69.5e9 if e else 70e9
        assert force == pytest.approx(-modulus * WIDE * HIGH * e / (1 + e) + 0 * force, rel=1e-9)
        inertia = WIDE * HIGH**3 / 12
        assert np.abs(moment) == pytest.approx(modulus * inertia * curvature + 0 * moment, rel=1e-3)


def test_hot_and_cold_run_side_by_side():
    made = loads(BAR)
    scenes = [made.build(T=t, across=a) for t in (20.0, -80.0) for a in (0.0, 10.0)]
    assert len({topology(scene) for scene in scenes}) == 1


def test_a_linkage_with_a_heated_coupler_opens_as_its_geometry_says():
    """A is held; D and the coupler follow from circles about B and D."""
    heated = changed(
        FOURBAR,
        ("  slack: {value: 10", "  hot: {value: 0, range: [0, 500]}\n  slack: {value: 0"),
        ("through: [B, end],", "through: [B, end], strain: 2e-5*hot,"),
    )
    scene = loads(heated).build(hot=400.0)
    hinges = {hinge.name: hinge for hinge in scene.hinges}
    coupler = 1 + 2e-5 * 400
    # C: coupler from B (0, 1), and 1 m from D (1, 0)
    way = np.sqrt(2.0)
    along = (coupler**2 - 1 + way**2) / (2 * way)
    across = np.sqrt(coupler**2 - along**2)
    at_c = np.array([0, 1]) + (along * np.array([1, -1]) + across * np.array([1, 1])) / way
    turned = np.arctan2(at_c[1], at_c[0] - 1) - np.pi / 2
    assert abs(turned) > 5e-3
    assert abs(hinges["D"].opening) == pytest.approx(abs(turned), rel=1e-6)
    assert scene.assembly.energy < 1e-12


def test_a_spring_by_a_table_of_temperature_drives_by_it():
    spring = "{type: torsion spring, joint: left, rest: 90 deg, stiffness: stiff}"
    table = "interpolate(T, -100, 0.2 N m/rad, 100, 0.1 N m/rad)"
    warm = changed(
        FREE,
        ("type: fixed, parts: [ground, bar], at: a", "type: revolute, parts: [ground, bar], at: a"),
        ("at: a}", "at: a, axis: -y}"),
        ("record:", f"actions:\n  s: {spring}\nrecord:"),
        ("let: {alpha: 23e-6}", f"let:\n  alpha: 23e-6\n  stiff: {table}"),
        ("assemble: true", "assemble: {hold: [left]}"),
    )
    for t, stiffness in ((-100.0, 0.2), (0.0, 0.15), (150.0, 0.1)):
        found = sweep(loads(warm).build(T=t), "left", 0.0, 1.0, positions=5)
        expected = stiffness * (np.pi / 2 - found.opening)
        assert found.work["s"] == pytest.approx(expected, rel=1e-6)


def test_heat_without_assembly_is_refused():
    text = changed(BAR, ("assemble: true\n", ""))
    loads(text).build()
    with pytest.raises(ValueError, match=r"strain: 0\.00046.*allowed: 0, or `assemble: true`"):
        loads(text).build(T=40.0)
    refused(BAR, "alpha*(T - 20)", "alpha*(T - 20)*(1 m)", "allowed: a number above -0.5")


@pytest.mark.parametrize("curvature", ["alpha*across/(10 mm)", "0*across/(1 m)"])
@pytest.mark.parametrize(
    "section", ["type: square, side: 20 mm", "type: tube, diameter: 20 mm, thickness: 1 mm"]
)
def test_a_curvature_needs_the_side_that_is_longer(section, curvature):
    """Where the section is alike along all axes no other key asks for `up`."""
    alike = changed(FREE, ("type: rectangle, width: 20 mm, height: 10 mm", section),
                    ("curvature: alpha*across/(10 mm)", f"curvature: {curvature}"))  # fmt: skip
    loads(alike).build()
    refused(alike, "    up: z\n", "", "bar.up: missing; allowed: the direction")
    straight = (
        ("    up: z\n", ""),
        (f"    curvature: {curvature}\n", "    inertia_scale: 1 + 0*across\n"),
    )
    loads(changed(alike, *straight)).build()


BOW = """
name: bow
assemble: true
parameters:
  e: {value: 0.001, range: [-0.4, 0.4]}
  kappa: {value: 0.01, unit: /m, range: [-10, 10]}
  h: {value: 50, unit: mm, range: [0.1, 100]}
  elements: {value: 4, whole: true, range: [1, 200]}
points: {a: [0, 0, 0], b: [1, 2, 2]}
materials: {m: {E: 70 GPa, nu: 0.33, rho: 2700}}
sections: {s: {type: rectangle, width: 6*h, height: h}}
bars:
  bar:
    through: [a, b]
    section: s
    material: m
    elements: elements
    up: [0, -1, 1]
    strain: e
    curvature: kappa
supports: {root: {part: bar, at: a}}
record: {b: {part: bar, at: b}}
"""


@pytest.mark.parametrize(
    ("elements", "height", "kappa"),
    [(8, 5.0, 0.1), (8, 0.3, -1.0), (24, 0.3, 0.1),
     pytest.param(128, 0.3, -1.0, marks=pytest.mark.slow)],
)  # fmt: skip
def test_slender_bars_bow_on_any_mesh(elements, height, kappa):
    """600 and 10,000 times as long as high: an arc, at the second order in the mesh. Lengthened by
    0.1 % they are pressed by 40 to 10,000 times their buckling load before they are let go."""
    made = loads(BOW).build(elements=elements, h=height, kappa=kappa)
    turn = 3 * 1.001 * kappa
    along, across = np.array([1, 2, 2]) / 3, np.array([0, -1, 1]) / np.sqrt(2)
    tip = (np.sin(turn) * along + (np.cos(turn) - 1) * across) / kappa
    off = np.linalg.norm(made.position[-1] - tip)
    assert off == pytest.approx(
        np.sinc(turn / 2 / np.pi) * 3 * turn**2 / 24 / elements**2, rel=0.03
    )
    assert made.assembly.energy < 1e-18


def test_what_does_not_come_to_rest_is_not_told_as_an_open_joint(monkeypatch):
    monkeypatch.setattr("fpm.assembly.search.POSITIONS", 8)
    refused(BOW, "kappa: {value: 0.01", "kappa: {value: 1", "assembly: 'bar bar ")


PINNED = changed(
    BOW,
    ("b: [1, 2, 2]", "b: [1, 0, 0]"),
    ("up: [0, -1, 1]", "up: z"),
    ("supports: {root: {part: bar, at: a}}",
     "joints:\n  a: {type: revolute, parts: [ground, bar], at: a, axis: y}\n"
     "  b: {type: revolute, parts: [ground, bar], at: b, axis: y}"),
)  # fmt: skip


@pytest.mark.parametrize(("strain", "elements"), [(1e-4, 16), (1e-3, 4)])
def test_a_bowed_bar_between_pins_lies_to_the_side_of_its_bow(strain, elements):
    """Newton's method alone ends in positions to the other side, of more energy, that snap."""
    made, kappa = loads(PINNED), 0.05
    heights = []
    for sign in (1, -1):
        scene = made.build(e=strain, kappa=sign * kappa, h=5.0, elements=elements)
        bow = scene.position[:, 2] * sign
        assert bow.min() > -1e-12
        heights.append(bow.max())
        area, inertia = 0.03 * 0.005, 0.03 * 0.005**3 / 12
        straight = 70e9 * (area * strain**2 + inertia * kappa**2) / 2
        assert scene.assembly.energy < straight
    assert heights[0] == pytest.approx(heights[1], rel=1e-9)
    if (strain, elements) == (1e-4, 16):  # the solution of the boundary value problem: 6.13 mm
        assert heights[0] == pytest.approx(6.13e-3, rel=0.01)


@pytest.mark.parametrize(("strain", "buckles"), [(2.0e-5, False), (2.2e-5, True), (1e-3, True)])
def test_a_straight_bar_is_refused_beyond_its_buckling_load(strain, buckles):
    """π² h²/12 L² = 2.06e-5: beyond it to which side is not stated."""
    made = loads(PINNED)
    if buckles:
        with pytest.raises(ValueError, match=r"unstable position' .* snaps to either of two"):
            made.build(e=strain, kappa=0.0, h=5.0, elements=16)
        return
    scene = made.build(e=strain, kappa=0.0, h=5.0, elements=16)
    assert np.abs(scene.position[:, 2]).max() < 1e-12
