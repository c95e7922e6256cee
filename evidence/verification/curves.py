"""Curves of time by expressions: a slider led by a smooth step, and a load by a sine."""

import numpy as np

from evidence.verification.bench import Bench, observed_orders
from fpm.structures import loads

STEPS = 8e-3, 4e-3, 2e-3
BALL = """
points: {c: [0, 0, 0]}
bodies: {ball: {mass: 2, centre: c, inertia: [1, 1, 1]}}
record: {c: {part: ball, at: c}}
"""
SLIDER = f"""{BALL}
joints: {{rail: {{type: prismatic, parts: [ground, ball], at: c, axis: x}}}}
curves: {{lift: {{expression: 10*u**3 - 15*u**4 + 6*u**5, over: [0.2 s, 1.2 s]}}}}
actions: {{drive: {{type: motor, joint: rail, travel: 0.3 m, curve: lift}}}}
"""
BALL_UNDER_LOAD = f"""{BALL}
curves: {{sway: {{expression: sin(pi*u), over: [0, 1 s]}}}}
loads: {{push: {{part: ball, at: c, force: [3 N, 0, 0], curve: sway}}}}
"""


def slider(bench: Bench) -> None:
    """A mass led by the 10-15-6 step: no impact at its ends, and the force is that of its rate."""
    errors = []
    for step in STEPS:
        (outcome,) = bench.simulate(loads(SLIDER).build(), duration=1.6, instants=101, step=step)
        u = np.clip(outcome.time - 0.2, 0, 1)
        force = 2 * 0.3 * (60 * u - 180 * u**2 + 120 * u**3)
        motor_force = outcome.records["slide_motor_force"].values[:, 0]
        errors.append(np.abs(motor_force - force)[(u > 0.02) & (u < 0.98)].max())
    exact = 0.3 * (10 * u**3 - 15 * u**4 + 6 * u**5)
    source, peak = "10u³ - 15u⁴ + 6u⁵ and its derivatives", np.abs(force).max()
    travel = np.abs(outcome.openings["rail"] - exact).max()
    bench.check_small("travel (m)", travel, 1e-12, source, "1 m")
    bench.check_small("force at 2 ms", errors[-1] / peak, 1e-4, source, "its peak")
    bench.check_at_least("order of the force", observed_orders(errors).min(), 1.95, source)
    end_error = np.abs(motor_force - force).max() / peak
    bench.check_small("force at the ends of the motion", end_error, 5e-3, source, "its peak")
    _balance(bench, outcome)


def half_sine(bench: Bench) -> None:
    """A free mass under half a sine: its path is that integrated twice."""
    errors = []
    for step in STEPS:
        scene = loads(BALL_UNDER_LOAD).build()
        (outcome,) = bench.simulate(scene, duration=1.6, instants=101, step=step)
        t, rest = np.minimum(outcome.time, 1.0), np.maximum(outcome.time - 1.0, 0.0)
        speed = 1.5 / np.pi * (1 - np.cos(np.pi * t))
        exact = 1.5 / np.pi * (t - np.sin(np.pi * t) / np.pi) + rest * speed
        errors.append(np.abs(outcome.points["c"][0][:, 0] - exact).max() / exact.max())
    source = "half a sine, integrated twice"
    bench.check_small("path at 2 ms", errors[-1], 1e-5, source, "the path")
    bench.check_at_least("order of the path", observed_orders(errors).min(), 1.95, source)
    work = (1.5 / np.pi * 2) ** 2
    bench.check("work of the load (J)", outcome.energies["load_work"][-1], work, 1e-5, source)
    _balance(bench, outcome)


def _balance(bench: Bench, outcome) -> None:
    energies = dict(outcome.energies)
    error = np.abs(energies.pop("balance")).max() / max(np.abs(e).max() for e in energies.values())
    bench.check_small("energy balance", float(error), 1e-12, "required", "energy")


PROBLEMS = {"slider led by a smooth step": slider, "mass under half a sine": half_sine}
