"""Parts that do not meet are forced together: closed forms, rest, and what is refused."""

import numpy as np
import pytest
from structures_for_tests import FOURBAR

import fpm
from fpm.assembly import MisfitError, assemble
from fpm.assembly.conditions import ParticlePoses, conditions_of
from fpm.structures import StructureError, loads
from fpm.structures.describe import describe

STEEL, ROD = fpm.Material(210e9, 0.3, 7850.0), fpm.Section.circle(0.02)

# Three bars from the ground meet at a pin, in a plane; one is longer than its place by `slack`.
STAR = """
assemble: true
parameters:
  slack: {value: 0.1, unit: mm, range: [-10, 10]}
let:
  half: sqrt(3)/2*(1 m)
points:
  middle: [0, 0, 0]
  end: [slack, 0, 0]
  A: [-1 m, 0, 0]
  B: [0.5 m, half, 0]
  C: [0.5 m, -half, 0]
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850}}
sections: {rod: {type: circle, diameter: 40 mm}}
bars:
  a: {through: [A, end], section: rod, material: steel, elements: 2}
  b: {through: [B, middle], section: rod, material: steel, elements: 2}
  c: {through: [C, middle], section: rod, material: steel, elements: 2}
joints:
  pin: {type: revolute, parts: [b, a, c], at: {a: end, b: middle, c: middle}, axis: z}
  A: {type: revolute, parts: [ground, a], at: A, axis: z}
  B: {type: revolute, parts: [ground, b], at: B, axis: z}
  C: {type: revolute, parts: [ground, c], at: C, axis: z}
record:
  pin: {part: b, at: middle}
"""


def bar(length: float, elements: int = 8) -> tuple[fpm.Scene, int, fpm.scenes.scene.Link]:
    """A bar along x, clamped at its start; the scene, the ground and the bar."""
    scene = fpm.Scene("bar")
    ground = int(scene.add_particles((0, 0, 0), 1.0, 1.0)[0])
    scene.fix(ground)
    link = scene.add_link((0, 0, 0), (length, 0, 0), (0, 0, 1), ROD, STEEL, elements)
    scene.add_joint("clamp", "fixed", (ground, link.particles[0]), (0, 0, 0))
    return scene, ground, link


@pytest.mark.parametrize("turn", [2.5, np.pi])
def test_axes_that_come_to_lie_opposite_are_refused(turn):
    """Directions at right angles to the axis are so to the opposite one, too."""
    scene = fpm.Scene("flipped")
    ground, body = (int(p) for p in scene.add_particles([(0, 0, 0), (0.5, 0, 0)], 1.0, 1.0))
    scene.fix(ground)
    axes = [(0, 0, 1), (0, np.sin(turn), np.cos(turn))]
    scene.add_hinge("pin", (ground, body), (0, 0, 0), axes)
    with pytest.raises(MisfitError, match="joint pin = 'opposite directions of its parts'"):
        assemble(scene)


def test_a_tilt_before_the_assembly_is_an_angle():
    scene = fpm.Scene("tilted")
    ground, body = (int(p) for p in scene.add_particles([(0, 0, 0), (0.5, 0, 0)], 1.0, 1.0))
    scene.fix(ground)
    axes = [(0, 0, 1), (0, np.sin(1.0), np.cos(1.0))]
    scene.add_hinge("pin", (ground, body), (0, 0, 0), axes)
    assemble(scene)
    assert scene.assembly.tilt == pytest.approx(1.0, rel=1e-12)


@pytest.mark.slow
def test_what_was_forced_together_is_at_rest_and_its_energy_counts_from_the_start():
    scenes = [loads(STAR).build(slack=slack) for slack in (0.1, -2.0, 0.0)]
    together = fpm.simulate(scenes, duration=2e-3, instants=11)
    for scene, outcome in zip(scenes, together, strict=True):
        stored = outcome.energies["strain"]
        assert outcome.failure is None
        assert stored[0] == pytest.approx(scene.assembly.energy, rel=1e-9, abs=1e-18)
        assert stored == pytest.approx(stored[0], rel=1e-6, abs=1e-15)
        assert outcome.energies["kinetic"].max() <= 1e-9 * stored[0] + 1e-15
        assert np.abs(outcome.energies["balance"]).max() <= 1e-9 * stored[0] + 1e-15
    alone = fpm.simulate(
        loads(STAR).build(slack=-2.0), duration=2e-3, instants=11, step=together[0].step
    )[0]
    assert np.array_equal(alone.energies["strain"], together[1].energies["strain"])
    assert np.array_equal(alone.points["pin"][0], together[1].points["pin"][0])
    data = together[0].dataset()
    assert data["assembly_energy"] == scenes[0].assembly.energy
    assert float(data["assembly_gap"]) == pytest.approx(1e-4, rel=1e-9)


def test_a_load_and_a_recorded_point_stay_where_they_are_on_their_bar():
    text = STAR.replace("record:", "loads: {push: {part: a, at: end, force: [1 N, 0, 0]}}\nrecord:")
    scene = loads(text).build(slack=1)
    assert scene.loads[0].beam.arm == pytest.approx(0, abs=1e-15)
    assert scene.points["pin"].arm == pytest.approx(0, abs=1e-15)


# A hub and a rod, rigid both; the rod's end b is off by `off` of 23 mm.
PAIR = """
assemble: true
parameters: {off: {value: 1, range: [0, 1]}}
points: {a: [0, 0, 0], b: "off*[3 mm, 20 mm, 10 mm]", g: [0, 0, -0.3], t: [1, 0.1, 0]}
bodies:
  hub: {mass: 30, centre: g, box: [0.5, 0.5, 0.4], points: [a]}
  rod: {type: rod, from: b, to: t, mass: 2, diameter: 20 mm}
joints: {j: {TYPE, parts: [hub, rod], at: {hub: a, rod: b}}}
record: {g: {part: hub, at: g}}
"""


@pytest.mark.parametrize(("off", "drive"), [(1, ""), (0.03, "xz")])
@pytest.mark.parametrize(
    "joint",
    ["revolute, axis: -y", "cylindrical, axis: y", "prismatic, axis: z", "spherical", "fixed",
     '"screw", axis: x, pitch: 20 mm', '"pin in slot", axis: z, x: x', "planar, axis: z, x: x",
     "universal, axis: x, other: y"],
)  # fmt: skip
def test_two_rigid_bodies_close_moving_no_more_than_they_must(joint, off, drive):
    """What is free keeps its centre of mass; what a drive leads stays, as if supported."""
    text = PAIR.replace("TYPE", f"type: {joint}")
    if drive:
        rest = "" if drive == "xyz" else f", translations: {drive}, rotations: none"
        text += f"drives: {{d: {{part: hub, at: g, velocity: [0.1, 0, 0]{rest}}}}}\n"
    scene = loads(text).build(off=off)
    closed = conditions_of(scene).gaps(ParticlePoses(scene.position, scene.frame))
    assert np.abs(closed).max() < 1e-11
    motion = (scene.position - scene.unstrained_position)[:2]
    assert np.abs(motion).max() < 0.025 * off
    axes = ["xyz".index(axis) for axis in drive]
    assert motion[0, axes] == pytest.approx(0, abs=1e-11)
    assert drive or scene.mass[:2] @ motion == pytest.approx(0, abs=1e-9 * off)


def test_what_cannot_be_forced_together_is_refused_with_the_joint_and_the_misfit():
    found = loads(FOURBAR)
    with pytest.raises(StructureError, match=r"line 2: assemble: joint C: '.* m.*apart' is not"):
        found.build(slack=4000)


def test_rigid_bodies_whose_lengths_contradict_each_other_are_refused():
    scene = fpm.Scene("rigid")
    ground, body = (int(p) for p in scene.add_particles([(0, 0, 0), (0.5, 0, 0)], 1.0, 1.0))
    scene.fix(ground)
    scene.add_joint("one", "spherical", (ground, body), (0, 0, 0))
    scene.add_joint("two", "spherical", (ground, body), [(1, 0, 0), (1.1, 0, 0)])
    with pytest.raises(MisfitError, match=r"joint (one|two) = '0.05 m apart' is not allowed"):
        assemble(scene)


def test_scenes_in_which_nothing_moves_are_assembled_or_refused():
    assemble(fpm.Scene("empty"))
    scene = fpm.Scene("held")
    pair = scene.add_particles([(0, 0, 0), (1, 0, 0)], 1.0, 1.0)
    scene.fix(pair)
    scene.add_joint("closed", "spherical", pair, (0.5, 0, 0))
    assemble(scene)
    assert scene.assembly.gap == scene.assembly.energy == 0.0
    scene.add_joint("open", "spherical", pair, [(0, 0, 0), (0.1, 0, 0)])
    with pytest.raises(MisfitError, match=r"joint open = '0.1 m apart' is not allowed"):
        assemble(scene)


def test_an_opening_that_forcing_changes_is_told_beside_the_stated_one():
    """A strut that is 2 mm too long moves a sled on its rail."""
    text = """
assemble: true
parameters:
  slack: {value: 2, unit: mm, range: [-10, 10], description: error of the strut's length}
points:
  origin: [0, 0, 0]
  high: [0, 0, 0.3 m]
  far: [0.4 m, 0, 0]
  end: [0.4 m + slack, 0, 0]
materials:
  steel: {E: 200 GPa, nu: 0.3, rho: 7800 kg/m3}
sections:
  rod: {type: square, side: 10 mm}
bars:
  strut: {through: [high, end], section: rod, material: steel, elements: 2}
bodies:
  sled: {mass: 1, centre: far, points: [origin], box: [0.1 m, 0.1 m, 0.1 m]}
joints:
  rail: {type: prismatic, parts: [ground, sled], at: origin, axis: x, opening: 0.4 m}
  top: {type: revolute, parts: [ground, strut], at: high, axis: y}
  foot: {type: revolute, parts: [strut, sled], at: {strut: end, sled: far}, axis: y}
record:
  far: {part: sled, at: far}
"""
    lines = describe(loads(text)).splitlines()
    assert "  rail (slide, opening 0.402 m, stated as 0.4 m)" in lines
    assert "  top (opening 0 deg)" in lines
