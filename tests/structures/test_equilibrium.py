"""Starts in equilibrium: against closed forms and solutions by other means, at rest, refusals."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation
from structures_for_tests import changed, problems_of, refused

import fpm
from fpm.structures import loads
from fpm.structures.describe import describe
from fpm.travel import sweep

G = 9.81


ROD = f"""
start: equilibrium
parameters: {{n: {{value: 16, whole: true, range: [2, 200]}}, g: {{value: {G}, unit: m/s2}}}}
gravity: [0, 0, -g]
points: {{P: [0, 0, 0], Q: [2 m, 0, 0]}}
materials: {{steel: {{E: 210 GPa, nu: 0.3, rho: 7850}}}}
sections: {{wire: {{type: circle, diameter: 4 mm}}}}
bars: {{rod: {{through: [P, Q], section: wire, material: steel, elements: n}}}}
supports: {{root: {{part: rod, at: P}}}}
record: {{tip: {{part: rod, at: Q}}}}
"""

# A body of 2 kg, 0.5 m from its joint.
ARM = """
start: equilibrium
gravity: [0, 0, -9.81]
points: {P: [0, 0, 0], c: [0.5 m, 0, 0]}
bodies: {arm: {mass: 2 kg, centre: c, box: [1 m, 50 mm, 60 mm], points: [P]}}
joints: {pin: {type: revolute, parts: [ground, arm], at: P, axis: y}}
record: {c: {part: arm, at: c}}
"""

BALL = ARM.replace("type: revolute", "type: spherical").replace(", axis: y", "")

# A body of 3 kg that slides down: its way is where all forces on it are in balance.
SLIDE = """
start: equilibrium
gravity: [0, 0, -9.81]
points: {P: [0, 0, 0], top: [0, 0, 1 m], side: [1 m, 0, 0]}
bodies: {load: {mass: 3 kg, centre: P, box: [0.1, 0.1, 0.1]}}
joints: {rail: {type: prismatic, parts: [ground, load], at: P, axis: -z}}
curves: {part: {times: [-1, 1, 9], values: [0, 0.5, 7]}}
"""


@pytest.mark.parametrize(
    ("turn", "parts"), [([0, 0, 0], "ground, arm"), ([0.3, -1.2, 2.0], "arm, ground")]
)
def test_an_arm_on_a_spring_hangs_where_both_moments_meet(turn, parts):
    axes = Rotation.from_rotvec(turn).apply([[0, 0, -G], [0.5, 0, 0], [0, 1, 0]]).tolist()
    spring = "actions: {k: {type: torsion spring, joint: pin, stiffness: 20 N m/rad}}"
    text = ARM + spring
    for old, new in zip(("[0, 0, -9.81]", "[0.5 m, 0, 0]", "axis: y"), axes, strict=True):
        text = text.replace(old, f"axis: {new}" if "axis" in old else str(new))
    text = text.replace("parts: [ground, arm]", f"parts: [{parts}]")
    angle = brentq(lambda a: 20 * a - 2 * G * 0.5 * np.cos(a), 0, 1.5, xtol=1e-14)
    sign = 1 if parts == "ground, arm" else -1
    assert loads(text).build().hinges[0].opening == pytest.approx(sign * angle, abs=1e-12)


WEIGHT = 3 * G
FORCES = {  # statement, and the sum of forces (N) down along the way x (m)
    "spring": ("actions: {s: {type: spring, joint: rail, stiffness: 400 N/m, rest: -10 mm}}",
               lambda x: WEIGHT - 400 * (x + 0.01)),
    "stop": ("actions: {s: {type: stop, joint: rail, upper: 70 mm, stiffness: 1e6 N/m}}",
             lambda x: WEIGHT - 1e6 * max(x - 0.07, 0)),
    "table": ("actions: {s: {type: tabulated spring, joint: rail, positions: [0, 0.1, 0.3], "
              "forces: [-20, -28, -60]}}",
              lambda x: WEIGHT - np.interp(x, [0, 0.1, 0.3], [20, 28, 60])),
    "cable": ("cables: {c: {through: [{part: ground, at: top}, P], EA: 5 kN, rest: 1.2 m}}",
              lambda x: WEIGHT - 5e3 * max((1 + x) / 1.2 - 1, 0)),
    "strut": ("struts: {c: {between: [{part: ground, at: side}, P], type: constant force, "
              "force: -90 N}}", lambda x: WEIGHT - 90 * x / np.hypot(1, x)),
    "motor": ("actions: {m: {type: motor, joint: rail, travel: 0.2 m, curve: part, "
              "stiffness: 500 N/m}}", lambda x: WEIGHT - 500 * (x - 0.2 * 0.25)),
    "release": ("actions: {m: {type: release, joint: rail, hold: 30 mm, time: 1, "
                "stiffness: 500 N/m}}", lambda x: WEIGHT - 500 * (x - 0.03)),
    "load": ("loads: {f: {part: load, at: P, force: [0, 0, 8 N], curve: part}}\n"
             "actions: {s: {type: spring, joint: rail, stiffness: 400 N/m}}",
             lambda x: WEIGHT - 8 * 0.25 - 400 * x),
    "wind": ("drags: {d: {part: load, through: [P], area: 0.1, coefficient: 2, density: 1.2, "
             "wind: [0, 0, -9]}}\nactions: {s: {type: spring, joint: rail, stiffness: 400 N/m}}",
             lambda x: WEIGHT + 0.12 * 81 - 400 * x),
    "friction": ("actions:\n  s: {type: spring, joint: rail, stiffness: 400 N/m}\n"
                 "  f: {type: friction, joint: rail, force: 99 N}\n"
                 "  d: {type: damper, joint: rail, damping: 9 N s/m}\n"
                 "  l: {type: latch, joint: rail, position: 20 mm, stiffness: 1e5 N/m}",
                 lambda x: WEIGHT - 400 * x),
}  # fmt: skip


@pytest.mark.parametrize("kind", FORCES)
def test_a_slide_rests_where_its_forces_are_in_balance(kind):
    statement, force = FORCES[kind]
    scene = loads(SLIDE + statement).build()
    expected = brentq(force, -0.5, 1.5, xtol=1e-13)
    assert scene.hinges[0].opening == pytest.approx(expected, abs=1e-10)
    assert scene.equilibrium.imbalance < 1e-9


def chain(seed: int) -> tuple[str, list]:
    """A random chain of rods, slender to thick, on joints with one to three axes, with loads and
    springs; and of each rod its way (m), mass, load, and the joint's axes, springs and rests."""
    draw, parts = np.random.default_rng(seed), []
    points, lists = [np.zeros(3)], {"bodies": [], "joints": [], "loads": [], "actions": []}
    for i in range(draw.integers(1, 5)):
        axes = Rotation.random(random_state=draw).as_matrix()[: draw.integers(1, 4)]
        way, mass, size = draw.standard_normal(3), draw.uniform(0.1, 3), 10 ** draw.uniform(-3, 0)
        load = draw.choice([0, 0.1, 10]) * draw.standard_normal(3)
        springs = draw.choice([0, 20], len(axes)) * (len(axes) < 3)
        rests, type_ = draw.uniform(-1, 1, 3), ["revolute", "universal", "spherical"][len(axes) - 1]
        words = "".join(f", {k}: {a.tolist()}" for k, a in zip(("axis", "other"), axes))  # noqa: B905
        joint = f"parts: [{f'b{i - 1}' if i else 'ground'}, b{i}], at: p{i}"
        joint += words * (len(axes) < 3)
        lists["joints"].append(f"j{i}: {{type: {type_}, {joint}}}")
        rod = f"from: p{i}, to: p{i + 1}, mass: {mass}, diameter: {size}"
        lists["bodies"].append(f"b{i}: {{type: rod, {rod}}}")
        lists["loads"].append(f"l{i}: {{part: b{i}, at: p{i + 1}, force: {load.tolist()}}}")
        names = [f"j{i}_axis", f"j{i}_other"] if len(axes) == 2 else [f"j{i}"]
        lists["actions"] += [
            f"s{n}: {{type: torsion spring, joint: {n}, stiffness: {k} N m/rad, rest: {r} rad}}"
            for n, k, r in zip(names, springs, rests)  # noqa: B905
            if k
        ]
        points.append(points[-1] + way)
        parts.append((way, mass, load, axes, springs, rests, names))
    lists["points"] = [f"p{i}: {point.tolist()}" for i, point in enumerate(points)]
    text = f"start: equilibrium\ngravity: [0, 0, -{G}]\n"
    for key, lines in lists.items():
        text += f"{key}:\n  " + "\n  ".join(lines) + "\n" if lines else ""
    return text, parts


@pytest.mark.parametrize("seed", [4, 5, 8, 9])  # all joints, springs and loads are in them
def test_a_chain_of_rods_that_turn_in_space_rests_where_its_potential_is_least(seed):
    """Its slopes and curvatures by turns about all axes of all joints, from where it was found."""
    text, parts = chain(seed)
    scene = loads(text).build()
    openings = {hinge.name: hinge.opening for hinge in scene.hinges}
    bodies = [scene.bodies[f"b{i}"] for i in range(len(parts))]
    found = [np.eye(3), *scene.frame[bodies] @ scene.unstrained[bodies].transpose(0, 2, 1)]

    def potential(angles):
        energy, end, turn, angles = 0.0, np.zeros(3), Rotation.identity(), iter(angles)
        for i, (way, mass, load, axes, springs, rests, names) in enumerate(parts):
            for k, axis in enumerate(axes):  # the other axis of a universal joint is the rod's
                angle = next(angles)
                turn *= Rotation.from_rotvec(angle * found[i + (len(axes) == 2 and k)] @ axis)
                opening = angle + openings.get((names * 3)[k], 0.0)
                energy += springs[k] * (opening - rests[k]) ** 2 / 2
            step = turn.apply(found[i + 1] @ way)
            energy += mass * G * (end + step / 2)[2] - load @ (end + step)
            end = end + step
        return energy

    nudges = 1e-4 * np.eye(sum(len(part[3]) for part in parts))
    slopes = [potential(a) - potential(-a) for a in nudges]
    curvatures = [
        [potential(a + b) - potential(a - b) - potential(b - a) + potential(-a - b) for a in nudges]
        for b in nudges
    ]
    values = np.linalg.eigvalsh(curvatures) / 4e-8
    assert np.abs(slopes).max() / 2e-4 < 1e-7 * values[-1]
    assert values[0] > -1e-6 * values[-1]


@pytest.mark.parametrize(
    ("size", "start", "force"),
    [(1e-3, "[1, 0, 0]", 0.1), (1e-3, "[0, 0, 1]", 0), (0.1, "[0.6, 0, 0.8]", 3)],
)
def test_a_rod_on_a_ball_hangs_along_half_its_weight_and_what_pulls_its_end(size, start, force):
    rod = f"{{rod: {{type: rod, from: P, to: Q, mass: 1, diameter: {size}}}}}"
    joint = "{ball: {type: spherical, parts: [ground, rod], at: P}}"
    load = f"{{pull: {{part: rod, at: Q, force: [0, {force}, 0]}}}}"
    text = f"start: equilibrium\ngravity: [0, 0, -{G}]\npoints: {{P: [0, 0, 0], Q: {start}}}\n"
    centre = loads(f"{text}bodies: {rod}\njoints: {joint}\nloads: {load}").build().position[-1]
    pull = np.array([0, force, -G / 2])
    assert centre == pytest.approx(pull / np.linalg.norm(pull) / 2, abs=1e-9)


@pytest.mark.parametrize(
    ("place", "loss"),
    [((0, 0), ""), ((-0.6, -0.8), ", restitution: 0.2, friction: 0.4, radius: 5 mm")],
)
def test_a_pin_with_play_hangs_at_the_lowest_place_of_its_bearing(place, loss):
    pin = "type: pin with play, x: x, clearance: 1 mm, load: 100 N, depth: 1 um, "
    pin += f"opening_x: {place[0]} mm, opening_y: {place[1]} mm{loss}"
    text = changed(ARM, ("c: [0.5 m, 0, 0]", "c: [0, 0, -0.5 m]"), ("type: revolute", pin))
    x, y = (hinge.opening for hinge in loads(text).build().hinges[1:])
    depth = 1e-6 * (2 * G / 100) ** (2 / 3)
    assert (x, abs(y)) == pytest.approx((0, 1e-3 + depth), abs=1e-10)


def test_what_is_still_on_its_way_is_not_told_to_have_no_balance(monkeypatch):
    monkeypatch.setattr("fpm.assembly.search.POSITIONS", 10)
    pin = "type: pin with play, clearance: 1 mm, load: 100 N, depth: 1 um"
    with pytest.raises(fpm.SceneError, match=r"nearer to the balance, .* 10 steps"):
        loads(changed(ARM, ("type: revolute", pin))).build()


def test_joints_are_led_to_where_releases_hold_them():
    """Two links of 1 kg, their knee held at 60 deg: the middle of both masses hangs below."""
    text = """
start: equilibrium
gravity: [0, 0, -9.81]
points: {P: [0, 0, 0], a: [0.5 m, 0, 0], Q: [1 m, 0, 0], b: [1.5 m, 0, 0]}
bodies:
  a: {mass: 1, centre: a, inertia: [0.01, 0.1, 0.1], points: [P, Q]}
  b: {mass: 1, centre: b, inertia: [0.01, 0.1, 0.1], points: [Q]}
joints:
  hip: {type: revolute, parts: [ground, a], at: P, axis: y}
  knee: {type: revolute, parts: [a, b], at: Q, axis: y}
actions: {r: {type: release, joint: knee, hold: 60 deg, time: 1 ms}}
record: {b: {part: b, at: b}}
"""
    scene = loads(text).build()
    hip, knee = (hinge.opening for hinge in scene.hinges)
    middle = 1.5 + 0.5 * np.exp(1j * np.pi / 3)
    assert knee == np.pi / 3
    assert hip == pytest.approx(np.pi / 2 - np.angle(middle), abs=1e-12)
    assert "knee (opening 60 deg, stated as 0 deg)" in describe(loads(text))
    refused(text, "start: equilibrium", "", "or `start: equilibrium`")


@pytest.mark.parametrize(("turn", "backlash"), [(0.0, 0.0), (0.1, 0.2), (0.6, 0.3)])
def test_weight_by_a_curve_and_drive_trains_with_backlash_are_as_at_the_start(turn, backlash):
    """Half the weight at t = 0, against a drive train at half its turn: on the far side of it."""
    text = ARM.replace("[0, 0, -9.81]", "{acceleration: [0, 0, -9.81], curve: half}")
    motor = f"turn: {turn} rad, curve: half, stiffness: 10 N m/rad, backlash: {backlash} rad"
    text += "curves: {half: {times: [0, 1], values: [0.5, 1]}}\n"
    text += f"actions: {{drive: {{type: motor, joint: pin, {motor}}}}}\n"

    def moment(psi):
        return 10 * (psi - turn / 2 - backlash / 2) - 9.81 * 0.5 * np.cos(psi)

    found = loads(text).build().hinges[0].opening
    assert found == pytest.approx(brentq(moment, 0, 2), abs=1e-9)


def test_what_is_stressed_alone_in_space_comes_to_rest_about_its_centre_of_mass():
    text = """
start: equilibrium
points: {P: [0, 0, 0], Q: [1 m, 0, 0]}
bodies: {a: {mass: 1, centre: P, box: [1, 1, 1]}, b: {mass: 3, centre: Q, box: [1, 1, 1]}}
struts: {s: {between: [P, Q], type: spring, stiffness: 500 N/m, rest: 1.4 m}}
"""
    places = loads(text).build().position
    assert places == pytest.approx(np.array([[-0.3, 0, 0], [1.1, 0, 0]]), abs=1e-12)


def test_a_margin_begins_where_a_pendant_hangs():
    bob = ("c: [0.5 m, 0, 0]}", "c: [0.5 m, 0, 0], Q: [1 m, 0, 0], b: [1.3 m, 0.2 m, 0.1 m]}")
    body = "bob: {mass: 1.5 kg, centre: b, box: [0.1, 0.1, 0.1], points: [Q]}}"
    part = ("points: [P]}}", "points: [P, Q]}, " + body)
    ball = ("axis: y}}", "axis: -y}, ball: {type: spherical, parts: [arm, bob], at: Q}}")
    hold = "actions: {r: {type: release, joint: pin, time: 1, hold: 10 deg}}"
    scene = loads(changed(ARM, bob, part, ball) + hold).build()
    travel = sweep(scene, "pin", scene.hinges[0].opening, 1.0, positions=3)
    expected = -(2 * 0.5 + 1.5) * G * np.cos([np.radians(10), np.radians(5) + 0.5, 1.0])
    assert travel.work["weight 0"] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (BALL.replace("[ground, arm]", "[other, arm]").replace(
            "bodies: {", "bodies: {other: {mass: 9, centre: P, box: [1, 1, 1]}, "),
         " moves on along (0, 0, -1)'"),
        pytest.param(ARM + "actions: {m: {type: torque motor, joint: pin, torque: 10 N m}}",
                     "start: 'body arm turns on about (0, 1, 0)'", marks=pytest.mark.slow),
        (ARM.replace("c: [0.5 m, 0, 0]", "c: [0, 0, 0.5 m]")
         + "actions: {k: {type: torsion spring, joint: pin, stiffness: 5 N m/rad}}",
         "snaps to either of two"),
        pytest.param(ROD.replace("[2 m, 0, 0]", "[0, 0, 4 m]").replace("value: 16", "value: 4"),
                     "none was found downhill", marks=pytest.mark.slow),
        (ROD.replace("4 mm", "0.2 mm").replace("value: 16", "value: 2"), "bent or twisted"),
        (ROD.replace("start: equilibrium", "start: rest"), "as stated, equilibrium"),
    ],
)  # fmt: skip
def test_what_has_no_balance_is_refused(text, said):
    assert any(said in problem for problem in problems_of(text)), problems_of(text)


@pytest.mark.slow
@pytest.mark.parametrize("text", [ROD, BALL])
def test_what_is_in_balance_stays_there(text):
    scene = loads(text).build()
    outcome = fpm.simulate(scene, duration=0.02, instants=5)[0]
    rate = 1e-8 * G * 0.02
    assert outcome.energies["kinetic"].max() <= scene.mass[1:].sum() * rate**2 / 2
    assert np.ptp(outcome.energies["strain"]) <= 1e-12 * (1 + outcome.energies["strain"][0])
