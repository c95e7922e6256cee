"""Joints whose second part slides and turns: closed forms, and equations written from scratch."""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from evidence.verification.bench import Bench, observed_orders
from fpm.structures import loads

STEPS = 0.004, 0.002, 0.001
G, MASS, ARM, STIFF, SPRING = 9.81, 2.0, 0.3, 1.5, 40.0
INERTIA = MASS * (0.1**2 + 0.2**2) / 12  # of the box about its centre, along the axis
TILT = 0.6  # rad, of the axis against the vertical

BODY = f"bodies: {{b: {{mass: {MASS}, centre: c, points: [o], box: [10 cm, 20 cm, 5 cm]"
AXIS = f"[sin({TILT} rad), 0, cos({TILT} rad)]"
AXES = f"x: [cos({TILT} rad), 0, -sin({TILT} rad)], up: {AXIS}"
SCREW = f"""
gravity: [0, 0, {-G}]
points: {{o: [0, 0, 0], c: [0, 0, 0]}}
{BODY}, {AXES}}}}}
joints: {{s: {{type: screw, parts: [ground, b], at: o, axis: {AXIS}, pitch: 0.3 m}}}}
actions: {{k: {{type: torsion spring, joint: s, stiffness: {STIFF}}}}}
"""
SHAFT = f"""
gravity: [0, 0, {-G}]
points: {{o: [0, 0, 0], c: [0, {ARM}, 0]}}
{BODY}, {AXES}}}}}
joints: {{s: {{type: cylindrical, parts: [ground, b], at: o, axis: {AXIS}}}}}
opening_rates: {{spin: {{joint: s_turn, rate: 9 rad/s}}, throw: {{joint: s_slide, rate: 2 m/s}}}}
"""
PLANE = f"""
points: {{o: [0, 0, 0], c: [0, {ARM}, 0]}}
{BODY}}}}}
joints: {{s: {{type: planar, parts: [ground, b], at: o, axis: z, x: x, opening_x: 0.2 m}}}}
actions:
  k: {{type: spring, joint: s_x, stiffness: {SPRING}}}
  l: {{type: spring, joint: s_y, stiffness: {2 * SPRING}}}
  t: {{type: torsion spring, joint: s_turn, stiffness: {STIFF}}}
opening_rates:
  spin: {{joint: s_turn, rate: 3 rad/s}}
  x: {{joint: s_x, rate: 0}}
  y: {{joint: s_y, rate: 0}}
"""
YOKE = f"""
parameters: {{rate: {{value: 5, unit: rad/s}}}}
points: {{o: [0, 0, 0], p: [{ARM}, 0, 0]}}
bodies:
  crank: {{mass: 1, centre: o, points: [p], inertia: [0.1, 0.1, {INERTIA}]}}
  yoke: {{mass: {MASS}, centre: p, inertia: [0.1, 0.1, 0.1]}}
joints:
  axle: {{type: revolute, parts: [ground, crank], at: o, axis: z}}
  guide: {{type: prismatic, parts: [ground, yoke], at: p, axis: x, opening: {ARM}}}
  pin: {{type: pin in slot, parts: [yoke, crank], at: p, axis: z, x: y}}
"""
DRIVE = """
curves: {one: {times: [0, 9], values: [1, 1]}}
actions: {motor: {type: motor, joint: axle, rate: rate, curve: one}}
"""


def screw(bench: Bench) -> None:
    """A nut that falls along a tilted thread, and turns against a spring."""
    lead = 0.3 / (2 * np.pi)
    inertia, moment = INERTIA + MASS * lead**2, -MASS * G * np.cos(TILT) * lead

    def exact(time):
        return {"s": moment / STIFF * (1 - np.cos(np.sqrt(STIFF / inertia) * time))}

    _compare(bench, SCREW, exact, "(J + m (p/2π)²) ψ'' = -m g p/2π cos t - k ψ")


def shaft(bench: Bench) -> None:
    """A rod that hangs on a tilted shaft, thrown up along it and with spin about it."""
    inertia = INERTIA + MASS * ARM**2

    def slopes(_, y):
        return [y[1], -MASS * G * np.sin(TILT) * ARM * np.cos(y[0]) / inertia]

    def exact(time):
        turn = _solve(slopes, [0.0, 9.0], time)[0]
        return {"s_turn": turn, "s_slide": 2.0 * time - 0.5 * G * np.cos(TILT) * time**2}

    _compare(bench, SHAFT, exact, "J ψ'' = -m g a sin t cos ψ; s'' = -g cos t")


def plane(bench: Bench) -> None:
    """A plate on a plane, held by springs beside its centre of mass, thrown with spin."""

    def slopes(_, y):
        x, z, turn, *rates = y
        arm = ARM * np.array([-np.sin(turn), np.cos(turn)])
        normal = np.array([-arm[1], arm[0]])
        matrix = MASS * np.eye(3)
        matrix[:2, 2] = matrix[2, :2] = MASS * normal
        matrix[2, 2] = INERTIA + MASS * ARM**2
        forces = np.array([-SPRING * x, -2 * SPRING * z, -STIFF * turn])
        forces[:2] += MASS * arm * rates[2] ** 2
        return [*rates, *np.linalg.solve(matrix, forces)]

    def exact(time):
        states = _solve(slopes, [0.2, 0, 0, 0, 0, 3.0], time)
        return dict(zip(("s_x", "s_y", "s_turn"), states, strict=False))

    _compare(bench, PLANE, exact, "Lagrange's equations of x, y and ψ, DOP853")


def yoke(bench: Bench) -> None:
    """A Scotch yoke: led by a motor x = r cos wt; and spun and let go."""
    (outcome,) = bench.simulate(loads(YOKE + DRIVE).build(), duration=2.0, instants=101, step=0.005)
    travel = ARM * np.cos(5.0 * outcome.time)
    error = np.abs(outcome.openings["guide"] - travel).max() / ARM
    bench.check_small("led: way of the yoke", error, 1e-8, "r cos wt", "r")
    error = np.abs(outcome.openings["pin_slide"] - ARM * np.sin(5.0 * outcome.time)).max() / ARM
    bench.check_small("led: way in the slot", error, 1e-8, "r sin wt", "r")

    def slopes(_, y):
        inertia = INERTIA + MASS * (ARM * np.sin(y[0])) ** 2
        return [y[1], -MASS * ARM**2 * np.sin(y[0]) * np.cos(y[0]) * y[1] ** 2 / inertia]

    def exact(time):
        turn = _solve(slopes, [0.0, 5.0], time)[0]
        travel = ARM * np.cos(turn)
        return {"axle": turn, "guide": travel, "pin_slide": ARM * np.sin(turn), "pin_turn": turn}

    text = YOKE + "opening_rates: {spin: {joint: axle, rate: rate}}"
    _compare(bench, text, exact, "(J + m r² sin² φ) φ'² = constant, DOP853")


def _solve(slopes, start, time) -> np.ndarray:
    options = {"method": "DOP853", "t_eval": time, "rtol": 1e-11, "atol": 1e-12}
    return solve_ivp(slopes, (0, time[-1]), start, **options).y


def _compare(bench: Bench, text: str, exact: Callable, source: str) -> None:
    """Rows of all openings against `exact`, with the order in the step, and of the balance."""
    scene = loads(text).build()
    outcomes = [bench.simulate(scene, duration=2.0, instants=101, step=step)[0] for step in STEPS]
    for name, values in exact(outcomes[-1].time).items():
        size = np.ptp(values)
        errors = [np.abs(o.openings[name] - values).max() / size for o in outcomes]
        bench.check_small(f"{name}: at 1 ms", errors[-1], 1e-3, source, "its range")
        if errors[0] > 1e-9:  # else exact but for rounding, as under a constant force
            orders = observed_orders(errors)
            bench.check_at_least(f"{name}: order", orders.min(), 1.95, source)
    energies = dict(outcomes[-1].energies)
    balance = np.abs(energies.pop("balance")).max()
    largest = max(np.abs(energy).max() for energy in energies.values())
    bench.check_small("energy balance", balance / largest, 1e-3, "required", "energy")


PROBLEMS = {
    "nut on a screw": screw,
    "rod on a shaft": shaft,
    "plate on a plane": plane,
    "Scotch yoke": yoke,
}
