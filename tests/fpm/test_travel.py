"""An opening led slowly: the virtual work of what acts, against closed forms and against kinematics
that is worked out here."""

import re
from pathlib import Path

import numpy as np
import pytest
from hinged import hinged
from scipy.optimize import brentq

import fpm
from fpm import structures
from fpm.elements import Friction, SyncLoop, TableSpring
from fpm.errors import SceneError
from fpm.travel import POSITIONS, sweep
from fpm.travel.components import component_classes

STRUCTURES = Path(__file__).parents[2] / "config/structures"


def test_a_panel_on_one_hinge():
    scene = hinged(0.0)
    scene.add_torsion_spring(0, 0.1, np.pi)
    scene.add(Friction(0, 0.01))
    scene.add(TableSpring(0, (0.0, 3.0), (0.0, -0.015)))
    scene.gravity = (0, -1.0, 0)
    found = sweep(scene, "h1", 0.0, np.pi / 2)
    angle = found.opening
    assert component_classes(scene).keys() == found.work.keys()
    expected = {
        "weight 0": -2.0 * 0.5 * np.cos(angle),
        "torsion spring h1": 0.1 * (np.pi - angle),
        "friction h1": -0.01,
        "spring h1": -0.005 * angle,
    }
    for part, work in expected.items():
        assert found.work[part] == pytest.approx(work + 0 * angle, rel=1e-6, abs=1e-9), part
    assert found.inertia == pytest.approx(0.1 + 2.0 * 0.25)


def test_two_panels_with_a_synchronising_loop():
    """By virtual work on the first: k1 (psi1 - th) + 2 k2 (psi2 - 2 th) against f1 + 2 f2."""
    scene = hinged(0.0, 0.0)
    scene.add_torsion_spring(0, 0.4, np.pi)
    scene.add_torsion_spring(1, 0.3, 2 * np.pi)
    for hinge, moment in enumerate((0.02, 0.03)):
        scene.add(Friction(hinge, moment))
    scene.add(SyncLoop("belt", (0, 1), (0.06, 0.03), 1e8))
    found = sweep(scene, "h1", 0.0, np.pi / 2)
    angle, work = found.opening, found.work
    drives = 0.4 * (np.pi - angle) + 2 * 0.3 * (2 * np.pi - 2 * angle)
    assert work["torsion spring h1"] + work["torsion spring h2"] == pytest.approx(drives, rel=1e-4)
    assert work["friction h1"] + work["friction h2"] == pytest.approx(-0.08, rel=1e-4)
    assert np.abs(work["loop belt"]).max() < 1e-4


@pytest.mark.parametrize("unit", [1.0, 20.0])
def test_a_joint_that_springs_and_a_cable_hold_goes_by_their_balance(unit):
    """The second of two panels hangs between a spring, a cable and its weight; its rate decides the
    works of all. In lengths of any size: the moments are the same."""
    size, pull, weight, k = unit, 3.0, 0.4, 0.5
    scene = fpm.Scene("chain")
    wall, first, second = (
        int(scene.add_particles((x * size, 0, 0), 2.0, 0.1)[0]) for x in (0.0, 0.5, 1.5)
    )
    scene.fix(wall)
    scene.add_hinge("h1", (wall, first), (0, 0, 0), (0, 0, 1), opening=0.0)
    scene.add_hinge("h2", (first, second), (size, 0, 0), (0, 0, 1), opening=0.0)
    scene.add_torsion_spring(1, k, 0.3)
    ends = [(wall, (size, 2.0 * size, 0.0)), (second, (2.0 * size, 0.0, 0.0))]
    scene.add_cable("stay", ends, EA=pull / size, rest=1.5 * size)
    scene.gravity = (0, -weight / (2.0 * 0.5 * size), 0)

    def energies(one, two):  # of the spring, the cable and the weight, by lengths of 1
        heights = 0.5 * np.sin(one) + np.sin(one) + 0.5 * np.sin(one + two)
        tip = np.cos(one) + np.cos(one + two), np.sin(one) + np.sin(one + two)
        stretch = np.hypot(1 - tip[0], 2 - tip[1]) / 1.5 - 1
        return np.array([k * (two - 0.3) ** 2 / 2, pull * 1.5 * max(stretch, 0) ** 2 / 2,
                         2 * weight * heights])  # fmt: skip

    def slope(of, at, step=1e-5):
        return (of(at + step) - of(at - step)) / (2 * step)

    def balanced(one):
        return brentq(lambda two: slope(lambda x: energies(one, x).sum(), two), -2, 2, xtol=1e-13)

    found = sweep(scene, "h1", 0.0, 0.6, positions=7)
    expected = [slope(lambda x: -energies(x, balanced(x)), one, 1e-4) for one in found.opening]
    names = ("torsion spring h2", "cable stay", "weight 0")
    works = np.array([found.work[name] for name in names]).T
    assert works == pytest.approx(np.array(expected), rel=1e-4, abs=1e-5)
    assert np.abs(works).max(axis=0).min() > 0.05, "each of them does work"


def test_an_opening_that_leaves_others_free_is_refused():
    scene = hinged(0.1, 0.1)
    with pytest.raises(fpm.SceneError, match="not the only freedom"):
        sweep(scene, "h1", 0.1, 1.0)
    scene.add_torsion_spring(0, 1.0, 2.0)
    found = sweep(scene, "h1", 0.1, 1.0, locked=["h2"])
    assert found.work["torsion spring h1"][-1] == pytest.approx(1.0)


@pytest.mark.slow
def test_what_cannot_be_reached_is_told():
    scene = structures.load(STRUCTURES / "bennett.yaml").build(elements=2)
    start = scene.hinges[0].opening
    with pytest.raises(fpm.SceneError, match="openings that it can reach"):
        sweep(scene, "A", start, start + 0.8)
    with pytest.raises(fpm.SceneError, match="singular position"):
        sweep(scene, "A", 0.0, 1.5)


def test_a_slide_is_led_by_its_way():
    scene = fpm.Scene("slide")
    wall, cart = scene.add_particles([(0, 0, 0), (0.3, 0, 0)], 2.0, 1.0)
    scene.fix(wall)
    slide = scene.add_slide("rail", (wall, cart), (0.3, 0, 0), (1, 0, 0), opening=0.1)
    scene.add_torsion_spring(slide, 5.0, 1.0)
    scene.add(Friction(slide, 0.7, 1e-4))
    scene.gravity = (-1.0, 0, 3.0)
    scene.bearings = {slide: 0.25}
    found = sweep(scene, "rail", 0.2, 0.6)
    assert found.work["spring rail"] == pytest.approx(5.0 * (1.0 - found.opening))
    assert found.work["friction rail"] == pytest.approx(-0.7)
    assert found.work["weight 0"] == pytest.approx(-2.0)
    assert found.work["bearing rail"] == pytest.approx(-0.25 * 6.0)
    assert found.inertia == pytest.approx(2.0)


def test_the_scissor_mast_by_virtual_work():
    """Its pins open alike, from 2 q, q being the angle of the bars to the mast; weights go with the
    length n L cos(q) of the mast, each bay's at the middle of its own."""
    n, k, g = 2, 1.5, 3.0
    scene = structures.load(STRUCTURES / "scissor.yaml").build(n=n, k=k, E=1e4, elements=2)
    scene.gravity = (-g, 0, 0)
    found = sweep(scene, "bay1.pin", np.radians(160), np.radians(120), positions=5)
    way = found.opening  # falls, so that work is per unit of -opening
    springs = sum(found.work[f"bay{i + 1}.spring"] for i in range(n))
    assert springs == pytest.approx(n * k * way, rel=1e-3)
    rises = 0.5 * np.sin(way / 2)  # d(cos q)/d(-2 q), for L = 1 m
    expected = -g * 2 * 1.0 * rises * sum(i + 0.5 for i in range(n))
    assert found.work["weight 0"] == pytest.approx(expected, rel=1e-3)


def test_the_ring_truss_by_virtual_work():
    """Its cable against the length of its way, 2 n diagonals of the bays."""
    bay, height, n, EA = 0.5, 0.4, 3, 20.0
    made = structures.load(STRUCTURES / "ring_truss.yaml")
    scene = made.build(n=n, stow=60.0, mu=0.0, E=1000.0, EA=EA / 1e3)
    bays = [f"pair{i + 1}.bay{k}" for i in range(n) for k in (1, 2)]
    found = sweep(scene, bays, np.radians(60), np.radians(70), positions=5)

    def through(slope):
        return 2 * n * np.sqrt(bay**2 + height**2 + 2 * bay * height * np.sin(slope))

    slope, step = found.opening, 1e-5
    rest = through(np.radians(60))
    tension = EA * (through(slope) - rest) / rest
    rate = (through(slope + step) - through(slope - step)) / (2 * step)
    expected = -tension * rate
    work = found.work["cable hoist"]
    assert work == pytest.approx(expected, rel=1e-3, abs=1e-3 * np.abs(expected).max())


CRANK = """
name: crank
parameters:
  r: {value: 0.2, unit: m, range: [0.01, 1]}
  t0: {value: 10, unit: deg, range: [-360, 360]}
  mu: {value: 0, range: [0, 5]}
  rub: {value: 0, unit: N, range: [0, 10]}
  push: {value: 0, unit: N, range: [-10, 10]}
points:
  O: [0, 0, 0]
  A: [r*cos(t0), r*sin(t0), 0]
  B: [r*cos(t0) + sqrt((0.5 m)**2 - (r*sin(t0))**2), 0, 0]
bodies:
  crank: {mass: 1, centre: O, points: [O, A], inertia: [0.1, 0.1, 0.1]}
  rod: {mass: 1, centre: A, points: [A, B], inertia: [0.1, 0.1, 0.1]}
  piston: {mass: 1, centre: B, points: [B], inertia: [0.1, 0.1, 0.1]}
joints:
  main: {type: revolute, parts: [ground, crank], at: O, axis: z, opening: t0}
  pin: {type: revolute, parts: [crank, rod], at: A, axis: z}
  wrist: {type: revolute, parts: [rod, piston], at: B, axis: z}
  rail: {type: prismatic, parts: [ground, piston], at: B, axis: x}
actions:
  spring: {type: torsion spring, joint: main, stiffness: 0.5 N m/rad, rest: 250 deg}
  dry: {type: friction, joint: rail, force: rub}
  guide: {type: bearing, joint: rail, mu: mu}
loads:
  p: {part: piston, at: B, force: [push, 0, 0]}
record:
  b: {part: piston, at: B}
"""
CENTRED, ROD = structures.loads(CRANK), 0.5


def piston(angle, r=0.2):
    """The rate of the piston per unit of the crank, and the sine of the rod's angle to the rail."""
    sine = r * np.sin(angle) / ROD
    return -r * np.sin(angle) * (1 + r * np.cos(angle) / (ROD * np.sqrt(1 - sine**2))), sine


@pytest.mark.parametrize("end", [182.7, 361])
def test_friction_of_a_joint_that_turns_back_slips_the_way_it_goes(end):
    """A slide at and beyond the dead centre of its crank; there is a position at each."""
    found = sweep(CENTRED.build(rub=3.0), "main", np.radians(10), np.radians(end))
    rate, _ = piston(found.opening)
    assert found.work["dry"] == pytest.approx(-3.0 * np.abs(rate), abs=1e-9)
    assert np.abs(found.opening - np.pi).min() < 1e-7


@pytest.mark.parametrize(
    ("start", "end"), [
        (0.5, 100),
        *(pytest.param(*way, marks=pytest.mark.slow) for way in ((2, 175), (178, 1))),
    ],
)  # fmt: skip
def test_a_way_from_near_a_dead_centre_stays_on_its_assembly(start, end):
    """The crank of a slide that is led; on the mirrored assembly its spring would be longer."""
    scene = CENTRED.build(t0=float(start))

    def place(degrees):
        angle = np.radians(degrees)
        return 0.2 * np.cos(angle) + np.sqrt(ROD**2 - (0.2 * np.sin(angle)) ** 2)

    found = sweep(scene, "rail", 0.0, place(end) - place(start), positions=POSITIONS)
    x = place(start) + found.opening
    angle = np.arccos((0.2**2 + x**2 - ROD**2) / (0.4 * x))
    expected = 0.5 * (np.radians(250) - angle) / piston(angle)[0]
    # Per unit of the way that it is led, inwards where the crank turns on.
    work = found.work["spring"] * np.sign(found.opening[-1])
    assert work == pytest.approx(expected, rel=1e-6)


def test_bearings_rub_by_forces_in_the_balance_with_their_friction():
    """The piston bears P tan a/(1 - mu tan a) across its rail where the rod presses it against P at
    the angle a, and P tan a/(1 + mu tan a) where P drives it."""
    for mu, sign in ((0.3, 1), (0.3, -1), (1.2, 1)):
        scene = CENTRED.build(push=4.0 * sign, mu=mu)
        found = sweep(scene, "main", np.radians(200), np.radians(290), positions=5)
        rate, sine = piston(found.opening)
        slope = np.abs(sine) / np.sqrt(1 - sine**2)
        expected = 4.0 * slope / (1 + sign * mu * slope)
        assert found.work["bearing rail"] == pytest.approx(-mu * expected * np.abs(rate), rel=1e-6)


def test_the_couple_of_a_bearing_acts_about_its_hinge_however_far_that_has_turned():
    """The piston's bearing at the wrist, of lever m = mu r: with the force F along x from the load
    P and N across it, the rod's balance about the pin is P l sin a - N l cos a = m |(P, N)|, or
    with the other sign where the rod turns back."""
    text = CRANK.replace("{type: bearing, joint: rail, mu: mu}",
                         "{type: bearing, joint: wrist, mu: mu, radius: 100 mm}")  # fmt: skip
    scene = structures.loads(text).build(push=4.0, mu=0.4, t0=10.0)
    found = sweep(scene, "main", np.radians(10), np.radians(170), positions=17)
    angle, lever = found.opening, 0.04
    sine = 0.2 * np.sin(angle) / ROD
    turn = -0.2 * np.cos(angle) / (ROD * np.sqrt(1 - sine**2))  # of the rod, against the ground
    force = np.full_like(angle, 4.0)
    for _ in range(100):
        couple = lever * force * np.sign(turn)
        across = (4.0 * ROD * sine - couple) / (ROD * np.sqrt(1 - sine**2))
        force = np.hypot(4.0, across)
    expected = -lever * force * np.abs(turn)
    assert found.work["bearing wrist"] == pytest.approx(expected, rel=1e-4, abs=1e-9)


@pytest.mark.parametrize(("mu", "locks"), [(0.29, False), (0.31, True)])
def test_a_way_on_which_a_bearing_locks_itself_is_refused(mu, locks):
    """The rod's largest slope to the rail is 0.48/sqrt(0.5^2 - 0.48^2) = 3.43 = 1/0.2917."""
    scene = CENTRED.build(r=0.48, push=4.0, mu=mu, t0=10.0)
    if locks:
        with pytest.raises(SceneError, match="bearing rail = 'locks where opening main is 1"):
            sweep(scene, "main", np.radians(10), np.radians(170))
    else:
        found = sweep(scene, "main", np.radians(10), np.radians(170), positions=9)
        rate, sine = piston(found.opening, 0.48)
        slope = sine / np.sqrt(1 - sine**2)
        expected = 4.0 * slope / (1 - mu * slope)
        assert found.work["bearing rail"] == pytest.approx(-mu * expected * np.abs(rate), rel=1e-5)


@pytest.mark.slow
def test_a_planar_loop_with_bearings_is_led_alike_however_it_lies_in_space():
    """Out of its plane forces are not determined, and rounding turns with the axes."""
    axes = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    axes[:, 2] *= np.linalg.det(axes)
    flat = CRANK.replace(
        "  guide:", "  round: {type: bearing, joint: wrist, mu: mu, radius: 9 mm}\n  guide:"
    )
    turned = flat
    for name, x, y in (("A", "r*cos(t0)", "r*sin(t0)"),
                       ("B", "r*cos(t0) + sqrt((0.5 m)**2 - (r*sin(t0))**2)", "0 m")):  # fmt: skip
        place = ", ".join(f"({a:.17g})*({x}) + ({b:.17g})*({y})" for a, b in axes[:, :2])
        turned = re.sub(rf"  {name}: \[.*\]", f"  {name}: [{place}]", turned)
    z, x = (str([float(a) for a in axes[:, i]]) for i in (2, 0))
    turned = turned.replace("axis: z", f"axis: {z}").replace("axis: x", f"axis: {x}")
    force = ", ".join(f"({a:.17g})*push" for a in axes[:, 0])
    turned = turned.replace("force: [push, 0, 0]", f"force: [{force}]")
    works = []
    for text in (flat, turned):
        scene = structures.loads(text).build(push=4.0, mu=0.3, rub=0.5)
        way = sweep(scene, "main", np.radians(10), np.radians(200))
        at = np.radians(np.linspace(11, 199, 40))
        works.append([np.interp(at, way.opening, way.work[name]) for name in
                      ("bearing rail", "bearing wrist", "dry", "spring")])  # fmt: skip
    np.testing.assert_allclose(works[1], works[0], atol=2e-3)
