"""Vectors in expressions, and bodies by their shape: rods, tubes, plates."""

import numpy as np
import pytest
from structures_for_tests import changed, refused

import fpm
from fpm.structures import loads
from fpm.structures.plausible import warnings

TEXT = """
parameters:
  L: {value: 2, unit: m}
  stow: {value: 30, unit: deg}
let:
  span: Q - P
  n: unit(cross(span, z))
  w: [L, 0, 1 m]
  k: w.x + norm(w)
points:
  P: [100 mm, 0, 0]
  Q: P + rotate([L, 0, 0], -y, stow)
  R: P + 0.3*(Q - P) + (10 mm)*n
  S: [Q.x, R.y, k]
bodies:
  b: {mass: 1, centre: R, points: [P, Q], box: [1, 1, 1], x: span, up: n}
joints:
  j: {type: revolute, parts: [ground, b], at: P, axis: n}
loads:
  f: {part: b, at: Q, force: "(5 N)*n + [1 N, 0, 0]"}
gravity: (-9.81 m/s2)*z
record:
  P: {part: b, at: P}
  Q: {part: b, at: Q}
  S: {part: ground, at: S}
repeat:
  bay:
    count: 2
    index: i
    let: {step: "i*(0.5 m)*x"}
    points:
      O: [0, 0, 0]
      A: P + step
      B: A + (1 m)*y - O
    bodies:
      rod: {type: rod, from: A, to: B, mass: 1}
    joints:
      pin: {type: revolute, parts: [rod, ground], at: A, axis: z}
    initial_velocities:
      push: {part: rod, about: A, velocity: (1 /s)*(next.A - A)}
"""


def test_points_axes_and_forces_are_what_vectors_say():
    scene = loads(TEXT).build(stow=60.0, L=1.0)
    p, span, n = np.array([0.1, 0, 0]), np.array([0.5, 0, np.sqrt(0.75)]), np.array([0, -1.0, 0])
    places = {
        name: scene.position[beam.particle] + scene.frame[beam.particle] @ beam.arm
        for name, beam in scene.points.items()
    }
    assert places["P"] == pytest.approx(p, abs=1e-15)
    assert places["Q"] == pytest.approx(p + span, abs=1e-15)
    assert places["S"] == pytest.approx([0.6, -0.01, 1 + np.sqrt(2)], abs=1e-15)
    assert scene.position[scene.bodies["b"]] == pytest.approx(p + 0.3 * span + 0.01 * n)
    assert scene.position[scene.bodies["bay2.rod"]] == pytest.approx([1.1, 0.5, 0])
    assert scene.hinges[0].axes[0] == pytest.approx(n, abs=1e-15)
    assert scene.frame[scene.bodies["b"]][:, 0] == pytest.approx(span)
    assert scene.gravity == pytest.approx([0, 0, -9.81])
    assert fpm.elements.Load.find(scene)[0].force == pytest.approx([1, -5, 0])
    rods = [scene.bodies[f"bay{k}.rod"] for k in (1, 2)]  # the last has no neighbour
    assert scene.velocity[rods] == pytest.approx(np.array([[0.5, 0, 0], [0, 0, 0]]))


VECTOR_REFUSALS = (  # what is replaced, by what, and what is said
    ("k: w.x + norm(w)", "k: w.x*w", "points.S: k is a vector in m2; allowed: m"),
    ("k: w.x + norm(w)", "k: L.x", "dot takes vectors such as [x, y, z] or Q - P, not m"),
    ("k: w.x + norm(w)", "k: w**2", "a vector has no power; allowed: dot(v, v), norm(v)**2"),
    ("k: w.x + norm(w)", "k: L/w", "nothing can be divided by a vector"),
    ("k: w.x + norm(w)", "k: abs(w)", "abs takes numbers, not a vector in m; allowed: norm(v)"),
    ("w: [L, 0, 1 m]", "w: [L, 0, 1 s]", "m and s cannot be in one vector"),
    ("w: [L, 0, 1 m]", "w: [L, span, 0]", "a vector [x, y, z] is of numbers"),
    ("P + 0.3*(Q - P)", "P + 0.3*(R - P)", "points.R: defined by itself (point R -> point R)"),
    ("P + 0.3*(Q - P)", "P*Q", "two vectors cannot be multiplied; allowed: dot(a, b)"),
    ("P + 0.3*(Q - P)", "P + 0.3 m", "a vector in m and m cannot be added"),
    ("P + 0.3*(Q - P) + (10 mm)*n", "n", "n is a vector without unit; allowed: a vector in m"),
    ("[L, 0, 0], -y, stow", "[L, 0, 0], -y, 30", "rotate turns by an angle with a unit"),
    ("[L, 0, 0], -y, stow", "[L, 0], -y, stow", "[...] of 2; allowed: a vector [x, y, z]"),
    ("span: Q - P", "span: (0 m)*x", "the direction of a vector of length 0"),
    ("k: w.x + norm(w)", "S: 2*w\n  k: 1 m", "let.S: a vector called S; allowed: a name that no p"),
    ("let: {step:", "let: {z: n, step:", "repeat.bay.let.z: a vector called z"),
    ("axis: n", "axis: up", "axis: 'up' is not allowed; allowed: x, y, z"),
    ("axis: n", "axis: Q", "one point is not a direction"),
    ("axis: n", "axis: 0*n", "a direction that is not zero"),
    (
        "mass: 1,",
        "mass: w,",
        "'w' is a vector in m (let.w on line 8); allowed: a value in kg above 0",
    ),
    (
        "box: [1, 1, 1]",
        "box: [P, 1, 1]",
        "'P' is a vector in m (let.span on line 6); allowed: three numbers",
    ),
    ("gravity: (-9.81 m/s2)*z", "gravity: 9.81 m/s2", "'9.81 m/s2' is one number; allowed: three"),
    ("{value: 2, unit: m}", "{value: 'cross([1, 0, 0], [0, 1, 0])'}", "in the parameter's"),
)


@pytest.mark.parametrize(("old", "new", "words"), VECTOR_REFUSALS)
def test_what_is_no_vector_or_number_is_refused(old, new, words):
    refused(TEXT, old, new, words)


SHAPE = """
points: {A: [0, 0, 0], B: [0.3, 0, 0.4], C: [1, 0, 0], D: [1, 0.5, 0], E: [0, 0.5, 0]}
let: {turn: 0 deg}
bodies:
  body: {BODY}
joints: {ball: {type: spherical, parts: [ground, body], at: A}}
"""


def body(words: str, text: str = SHAPE):
    """Mass, place and inertia tensor (3, 3) of a body about its centre."""
    scene = loads(text.replace("BODY", words)).build()
    i = scene.bodies["body"]
    return scene.mass[i], scene.position[i], scene.frame[i] * scene.inertia[i] @ scene.frame[i].T


def test_a_tube_is_a_rod_less_a_rod_and_a_rod_is_the_closed_form():
    ends, along = "from: A, to: B, density: 1000", np.array([0.6, 0, 0.8])
    across = np.eye(3) - np.outer(along, along)
    outer, inner, tube = (
        body(f"type: {words}, {ends}")
        for words in ("rod, diameter: 0.2", "rod, diameter: 0.12",
                      "tube, diameter: 0.2, thickness: 0.04")
    )  # fmt: skip
    mass = 1000 * np.pi * 0.1**2 * 0.5
    assert outer[0] == pytest.approx(mass)
    exact = mass * ((3 * 0.1**2 + 0.5**2) / 12 * across + 0.1**2 / 2 * np.outer(along, along))
    assert outer[2] == pytest.approx(exact)
    for k in (0, 2):
        assert tube[k] == pytest.approx(outer[k] - inner[k])
    mass, place, line = body("type: rod, from: A, to: B, mass: 2")
    assert (mass, *place) == pytest.approx((2, 0.15, 0, 0.2))
    assert across @ line == pytest.approx(2 * 0.5**2 / 12 * across, rel=1e-12)
    for words in ("box: [0.5, 0, 0]", "inertia: [0, 2/48, 2/48]"):
        same = body(f"mass: 2, centre: A, {words}, x: B - A, up: y")
        assert same[2] == pytest.approx(line, rel=1e-12)


SHAPE_REFUSALS = (
    ("type: rod, from: A, to: A, mass: 1", "bodies.body.to: 'A' is not allowed"),
    ("type: rod, from: A, to: B", "mass: missing; allowed: either `mass` or `density`"),
    ("type: rod, from: A, to: B, density: 2", "allowed: `mass`, or also a `diameter`"),
    ("type: plate, corners: [A, C, D, E], density: 2", "`mass`, or also a `thickness`"),
    ("type: plate, corners: [A, D, C, E], mass: 1", "corners in order around an area"),
    ("type: plate, corners: [A, C, D, B], mass: 1", "corners in one plane"),
    ("type: plate, corners: [A, C], mass: 1", "a list of 3 to 1000"),
    ("from: A, to: B, mass: 1", "bodies.body.type: missing; allowed: rod, tube, plate"),
    ("mass: 1, centre: A, inertia: [0, 0, 2]", "at most one 0"),
)


@pytest.mark.parametrize(("words", "reason"), SHAPE_REFUSALS)
def test_what_is_no_rod_tube_or_plate_is_refused(words, reason):
    refused(SHAPE, "BODY", words, reason)


def test_a_line_that_is_turned_about_itself_is_told_and_no_other():
    hinge = ("ball: {type: spherical, parts: [ground, body], at: A}",
             "pin: {type: revolute, parts: [ground, body], at: A, axis: AXIS}}\n"
             "actions: {m: {type: torque motor, joint: pin, torque: 1}")  # fmt: skip
    text = changed(SHAPE, hinge).replace("BODY", "type: rod, from: A, to: B, mass: 1 WIDTH")
    for axis, width, doubts in (("A - B", "", 1), ("A - B", ", diameter: 1 cm", 0), ("y", "", 0)):
        scene = loads(text.replace("AXIS", axis).replace("WIDTH", width)).build()
        assert sum("has no width" in text for text in warnings(scene)) == doubts
