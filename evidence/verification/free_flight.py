"""A free hub with two hinged panels on springs, against Kane's equations in 12 digits."""

import numpy as np

from evidence.verification.bench import Bench, observed_orders
from fpm.structures import loads

STEPS = 2e-3, 1e-3, 5e-4
START = np.radians(5.0)
HUB, PANEL1, PANEL2 = (
    np.array(place)
    for place in ([0, 0, 1], [0.5 + 1.5 * np.cos(START), 0, 1 + 1.5 * np.sin(START)], [-2, 0, 1])
)
CENTRE, VELOCITY, SPIN = np.array([0.1, -0.4, 0.3]), np.array([-0.2, 0.5, 0.1]), [0.1, -0.1, 0.1]
HINGE = np.array([0.5, 0.0, 1.0])
SHIFT = CENTRE - (750 * HUB + 100 * PANEL1 + 100 * PANEL2) / 950
X = np.cos(START), 0.0, np.sin(START)

HUB_TEXT = """
name: hub
points: {{centre: {centre}, hub: {hub}, a: {a}, b: {b}, c1: {c1}, c2: {c2}}}
bodies:
  hub: {{mass: 750, centre: hub, inertia: [900, 800, 600], points: [a, b]}}
  panel1: {{mass: 100, centre: c1, inertia: [100, 50, 50], x: {x}, up: {up}, points: [a]}}
  panel2: {{mass: 100, centre: c2, inertia: [100, 50, 50], points: [b]}}
joints:
  one: {{type: revolute, parts: [hub, panel1], at: a, axis: -y, opening: 5 deg}}
  two: {{type: revolute, parts: [hub, panel2], at: b, axis: y}}
actions:
  spring1: {{type: torsion spring, joint: one, stiffness: 100}}
  spring2: {{type: torsion spring, joint: two, stiffness: 100}}
initial_velocities:
  hub: {{part: hub, about: centre, velocity: {v}, spin: {w}}}
  panel1: {{part: panel1, about: centre, velocity: {v}, spin: {w}}}
  panel2: {{part: panel2, about: centre, velocity: {v}, spin: {w}}}
"""
ORIGIN = -0.15832794740649, 1.12248171674725, -0.37975995949383
RODRIGUES = 0.06170318243240, -0.07089090074413, 0.06409500412693
ANGLES = -0.05667757476663, 0.04749171331939


def hub(bench: Bench) -> None:
    """A hub that floats and turns, with two panels on springs, one of them let go at 5 degrees."""
    places = {"centre": CENTRE, "hub": HUB + SHIFT, "c1": PANEL1 + SHIFT,
              "c2": PANEL2 + SHIFT, "a": HINGE + SHIFT, "b": HINGE + SHIFT - [1, 0, 0],
              "v": VELOCITY}  # fmt: skip
    text = HUB_TEXT.format(
        x=[*map(float, X)], up=[-float(X[2]), 0.0, float(X[0])], w=SPIN,
        **{name: place.tolist() for name, place in places.items()},
    )  # fmt: skip
    scene, exact = loads(text).build(), np.array([*ORIGIN, *RODRIGUES, *ANGLES])
    errors = []
    for step in STEPS:
        (outcome,) = bench.simulate(scene, duration=2.5, instants=11, step=step)
        frame = outcome.final.frame[0]
        cosine = np.sqrt(1 + np.trace(frame)) / 2
        vector = np.array([frame[2, 1] - frame[1, 2], frame[0, 2] - frame[2, 0],
                           frame[1, 0] - frame[0, 1]]) / (4 * cosine)  # fmt: skip
        origin = outcome.final.position[0] - frame @ [0, 0, 1]
        angles = [outcome.openings[name][-1] for name in ("one", "two")]
        errors.append(np.abs([*origin, *vector / (1 + cosine), *angles] - exact).max())
    source = "Kane's equations, 12 digits (references of an open astrodynamics library)"
    bench.check_small("largest error at 1 ms (m, rad, 1)", errors[1], 1e-8, source, "one")
    bench.check_at_least("order", observed_orders(errors).min(), 1.95, source)


PROBLEMS = {"free hub with two panels": hub}
