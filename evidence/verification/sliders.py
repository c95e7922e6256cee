"""Joints whose second part slides and turns, on a part that swings: Lagrange's equations."""

import numpy as np
from scipy.integrate import solve_ivp

import fpm
from evidence.verification.bench import Bench, observed_orders
from fpm.elements import Damper
from fpm.elements.joints.joint_types import TYPES
from fpm.structures import loads

STEPS = 5e-3, 2.5e-3, 1.25e-3  # a whole number of them between instants
GRAVITY = np.array([2.0, -3.0, -9.0])
HUB, ARM = np.array([0.1, 0.2, -0.1]), np.array([0.4, 0.1, 0.2])
OFFSET = np.array([0.1, -0.2, 0.15])
MASSES, INERTIA = (2.0, 1.0), (0.02, 0.03, 0.04)
PIVOT, AXIS = np.array([0.0, 0.6, 0.8]), np.array([0.48, 0.6, 0.64])
X = np.array([0.8, 0.0, -0.6])
DIRECTIONS = {"axis": AXIS, "x": X, "y": np.cross(AXIS, X)}
LEAD, START = -0.07, (0.4, -0.1, 0.2)
STIFFNESS, DAMPING = (3.0, 2.0, 30.0, 20.0), (0.1, 0.05, 0.4, 0.3)
JOINTS = "cylindrical", "planar", "screw", "pin in slot"
KINDS = [(type, swap) for type in JOINTS for swap in (0, 1)]


def scene_of_all() -> fpm.Scene:
    """A body that swings on the ground, and another on it by each of the joints, either one first;
    springs and dampers are on all openings."""
    scene = fpm.Scene("all", GRAVITY)
    scene.fix(scene.add_particles(np.zeros(3), 1.0, 1.0))
    for number, (type, swap) in enumerate(KINDS):
        place = np.array([3.0 * number, 0.0, 0.0])
        pair = scene.add_particles([place + HUB, place + ARM + OFFSET], MASSES, INERTIA)
        name = f"{type}{swap}"
        first = scene.add_hinge(f"{name}_root", (0, pair[0]), place, PIVOT)
        pair = pair[::-1] if swap else pair
        x, lead = (None, LEAD) if type == "screw" else (X, 0.0)
        openings = START[: len(TYPES[type].openings)]
        scene.add_sliding_joint(name, type, pair, place + ARM, AXIS, openings, x, lead)
        for k, hinge in enumerate(range(first, len(scene.hinges))):
            scene.add_torsion_spring(hinge, STIFFNESS[k])
            scene.add(Damper(hinge, DAMPING[k]))
    return scene


def points_of(q, type: str, swap: int) -> np.ndarray:
    """Positions (..., 12, 3) of point masses that stand for both bodies, of a sixth of each's mass,
    by the pivot's angle and the openings' changes q (..., n), complex ones as well."""

    def turn(axis, angle):
        cross = np.cross(np.eye(3), axis)
        angle = np.asarray(angle)[..., None, None]
        return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross

    root = turn(PIVOT, q[..., 0])
    frame_b = root @ turn(AXIS, -q[..., 1] if swap else q[..., 1])
    shift_local = np.zeros((*q.shape[:-1], 3), q.dtype)
    for k, (_, direction) in enumerate(TYPES[type].openings):
        shift_local = shift_local + (
            DIRECTIONS[direction] * q[..., k + 1, None] if direction else 0.0
        )
    if type == "screw":
        shift_local = LEAD * q[..., 1, None] * AXIS
    shift = np.einsum("...ij,...j->...i", -frame_b if swap else root, shift_local)
    centres = root @ HUB, root @ ARM + shift + frame_b @ OFFSET
    return np.concatenate(
        [
            centre[..., None, :] + sign * np.swapaxes(frame * np.sqrt(length), -1, -2)
            for centre, frame, mass in zip(centres, (root, frame_b), MASSES, strict=True)
            for length in [3 / mass * (sum(INERTIA) / 2 - np.array(INERTIA))]
            for sign in (1, -1)
        ],
        axis=-2,
    )


def exact(time, type: str, swap: int) -> np.ndarray:
    """Openings (n, t) by Lagrange's equations, derivatives of the positions by complex steps."""
    count = 1 + len(TYPES[type].openings)
    start = np.array([0.0, *START[: count - 1]])
    masses = np.repeat(MASSES, 6) / 6
    stiffness, damping = np.array(STIFFNESS[:count]), np.array(DAMPING[:count])

    def jacobian(change):
        values = points_of(change + 1e-30j * np.eye(count), type, swap)
        return values.imag / 1e-30  # (n, 12, 3)

    def slopes(_, y):
        change, rates = y[:count] - start, y[count:]
        rows, span = jacobian(change), 1e-4 / (1e-9 + np.abs(rates).max())
        bend = (jacobian(change + span * rates) - jacobian(change - span * rates)) / (2 * span)
        inertial = np.einsum("npi,n->pi", bend, rates)
        matrix = np.einsum("p,npi,mpi->nm", masses, rows, rows)
        force = np.einsum("p,npi,pi->n", masses, rows, GRAVITY - inertial)
        force -= stiffness * y[:count] + damping * rates
        return [*rates, *np.linalg.solve(matrix, force)]

    options = {"method": "DOP853", "t_eval": time, "rtol": 1e-9, "atol": 1e-11}
    return solve_ivp(slopes, (0, time[-1]), [*start, *np.zeros(count)], **options).y[:count]


def bodies(bench: Bench) -> None:
    """Each of the joints between two bodies, either one first, with springs and dampers."""
    scene, errors = scene_of_all(), []
    motions = [exact(np.linspace(0.0, 0.6, 13), *kind) for kind in KINDS]
    for step in STEPS:
        (outcome,) = bench.simulate(scene, duration=0.6, instants=13, step=step)
        openings = iter(outcome.openings[hinge.name] for hinge in scene.hinges)
        errors.append([])
        for motion in motions:
            errors[-1].append(max(np.abs(next(openings) - values).max() for values in motion))
    source = "Lagrange's equations, DOP853"
    for (joint, swap), *misses in zip(KINDS, *errors, strict=True):
        name = f"{joint}, {'second' if swap else 'first'} part swings"
        bench.check_small(f"{name}: openings at 1.25 ms", misses[-1], 1e-3, source, "1 rad or 1 m")
        bench.check_at_least(f"{name}: order", observed_orders(misses).min(), 1.95, source)
    bench.check_small("energy balance", _balance_error(outcome), 1e-3, "required", "energy")


CRANK, CRANK_INERTIA, YOKE_MASS = 0.3, 0.01, 2.0
YOKE = f"""
parameters: {{rate: {{value: 5, unit: rad/s}}}}
points: {{o: [0, 0, 0], p: [{CRANK}, 0, 0]}}
bodies:
  crank: {{mass: 1, centre: o, points: [p], inertia: [0.1, 0.1, {CRANK_INERTIA}]}}
  yoke: {{mass: {YOKE_MASS}, centre: p, inertia: [0.1, 0.1, 0.1]}}
joints:
  axle: {{type: revolute, parts: [ground, crank], at: o, axis: z}}
  guide: {{type: prismatic, parts: [ground, yoke], at: p, axis: x, opening: {CRANK}}}
  pin: {{type: pin in slot, parts: [yoke, crank], at: p, axis: z, x: y}}
"""
DRIVE = """
curves: {one: {times: [0, 9], values: [1, 1]}}
actions: {motor: {type: motor, joint: axle, rate: rate, curve: one}}
"""


def yoke(bench: Bench) -> None:
    """A Scotch yoke: led by a motor x = r cos wt; and spun and let go."""
    (outcome,) = bench.simulate(loads(YOKE + DRIVE).build(), duration=2.0, instants=101, step=0.005)
    travel = CRANK * np.cos(5.0 * outcome.time)
    error = np.abs(outcome.openings["guide"] - travel).max() / CRANK
    bench.check_small("led: way of the yoke", error, 1e-8, "r cos wt", "r")
    error = np.abs(outcome.openings["pin_slide"] - CRANK * np.sin(5.0 * outcome.time)).max() / CRANK
    bench.check_small("led: way in the slot", error, 1e-8, "r sin wt", "r")

    def slopes(_, y):
        inertia = CRANK_INERTIA + YOKE_MASS * (CRANK * np.sin(y[0])) ** 2
        pull = YOKE_MASS * CRANK**2 * np.sin(y[0]) * np.cos(y[0])
        return [y[1], -pull * y[1] ** 2 / inertia]

    scene = loads(YOKE + "opening_rates: {spin: {joint: axle, rate: rate}}").build()
    errors, source = [], "(J + m r² sin² φ) φ'² = constant, DOP853"
    for step in STEPS:
        (outcome,) = bench.simulate(scene, duration=2.0, instants=101, step=step)
        options = {"t_eval": outcome.time, "rtol": 1e-11, "atol": 1e-12}
        turn = solve_ivp(slopes, (0, 2), [0.0, 5.0], "DOP853", **options).y[0]
        motions = {"axle": turn, "guide": CRANK * np.cos(turn), "pin_slide": CRANK * np.sin(turn)}
        misses = [np.abs(outcome.openings[n] - x).max() / np.ptp(x) for n, x in motions.items()]
        errors.append(max(misses))
    bench.check_small("spun: openings at 1.25 ms", errors[-1], 1e-3, source, "their ranges")
    bench.check_at_least("spun: order", observed_orders(errors).min(), 1.95, source)
    bench.check_small("energy balance", _balance_error(outcome), 1e-3, "required", "energy")


def _balance_error(outcome: fpm.Outcome) -> float:
    energies = dict(outcome.energies)
    balance = np.abs(energies.pop("balance")).max()
    return float(balance / max(np.abs(energy).max() for energy in energies.values()))


PROBLEMS = {"bodies on sliding joints": bodies, "Scotch yoke": yoke}
