"""Drag of air by the square of the speed against closed forms and another solver."""

import numpy as np

from evidence.verification.bench import Bench, observed_orders
from fpm.structures import loads

STEPS = 0.02, 0.01, 0.005
GRAVITY, DENSITY, COEFFICIENT, WIDTH = 9.81, 1.2, 1.2, 0.02
AIR = f"coefficient: {COEFFICIENT}, density: {DENSITY}"

FALL = f"""
points: {{c: [0, 0, 0]}}
bodies: {{ball: {{mass: 0.1, centre: c, inertia: [1e-4, 1e-4, 1e-4]}}}}
drags: {{air: {{part: ball, through: [c], area: 0.1, {AIR}}}}}
gravity: [0, 0, {-GRAVITY}]
record: {{c: {{part: ball, at: c}}}}
"""
ROD = f"""
parameters:
  gravity: {{value: 0, unit: m/s2}}
  rate: {{value: 0, unit: rad/s}}
points: {{o: [0, 0, 0], c: [0.5, 0, 0], tip: [1, 0, 0]}}
bodies: {{rod: {{mass: 0.1, centre: c, points: [o, tip], box: [1, 0, 0.001]}}}}
joints: {{pin: {{type: revolute, parts: [ground, rod], at: o, axis: y}}}}
drags: {{air: {{part: rod, through: [o, tip], area: {WIDTH}, {AIR}}}}}
initial_velocities: {{turn: {{part: rod, about: o, spin: [0, rate, 0]}}}}
gravity: [0, 0, -gravity]
"""
INERTIA = 0.1 * (1 / 3 + 1e-6 / 12)
MOMENT = DENSITY * COEFFICIENT * WIDTH / 8  # of the rod, over the square of its rate


def fall(bench: Bench) -> None:
    """A mass that falls from rest: v = v∞ tanh(g t/v∞)."""
    scene, last = loads(FALL).build(), np.sqrt(2 * 0.1 * GRAVITY / (DENSITY * COEFFICIENT * 0.1))
    outcomes = [_run(bench, scene, 2.0, step) for step in STEPS]
    exact = -last * np.tanh(GRAVITY * outcomes[0].time / last)
    speeds = [outcome.points["c"][1][:, 2] for outcome in outcomes]
    errors = [np.abs(speed - exact).max() / last for speed in speeds]
    source = "v∞ tanh(g t/v∞), v∞² = 2 m g/(ρ Cd A)"
    bench.check_small("speed at 5 ms", errors[-1], 1e-4, source, "v∞")
    bench.check_at_least("order of the speed", observed_orders(errors).min(), 1.95, source)
    bench.check_small("energy balance", _balance_error(outcomes[-1]), 1e-12, "required", "energy")


def spin(bench: Bench) -> None:
    """A rod on a hinge at its end, without weight: w = w₀/(1 + k w₀ t)."""
    scene, rate = loads(ROD).build(rate=5.0), MOMENT / INERTIA
    outcomes = [_run(bench, scene, 4.0, step) for step in STEPS]
    exact = np.log1p(5.0 * rate * outcomes[0].time) / rate
    errors = [np.abs(outcome.openings["pin"] - exact).max() for outcome in outcomes]
    source = "ln(1 + k w₀ t)/k, k = ρ Cd b L⁴/(8 J)"
    bench.check_small("angle at 5 ms (rad)", errors[-1] / exact[-1], 1e-4, source, "the angle")
    bench.check_at_least("order of the angle", observed_orders(errors).min(), 1.95, source)
    work = 0.5 * INERTIA * (25 - (5 / (1 + 5 * rate * 4)) ** 2)
    bench.check("work of the drag (J)", outcomes[-1].energies["damping_work"][-1], work, 1e-3,
                "energy of the rod")  # fmt: skip
    bench.check_small("energy balance", _balance_error(outcomes[-1]), 1e-3, "required", "energy")


def _run(bench: Bench, scene, duration: float, step: float):
    return bench.simulate(scene, duration=duration, instants=101, step=step)[0]


def _balance_error(outcome) -> float:
    energies = dict(outcome.energies)
    balance = np.abs(energies.pop("balance")).max()
    return float(balance / max(np.abs(energy).max() for energy in energies.values()))


PROBLEMS = {"fall through air": fall, "rod in air": spin}
