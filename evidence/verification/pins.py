"""Pins with play: a ball in a bore, Flores' slider-crank, and a shaft that rubs in its bearing."""

import math

import numpy as np

from evidence.verification.bench import Bench, observed_orders
from fpm.structures import loads

SPEED, MASS = 0.3, 0.2
BALL = f"""
parameters:
  restitution: {{value: 0.9, range: [0.1, 1]}}
points: {{O: [0, 0, 0]}}
bodies: {{ball: {{mass: {MASS}, centre: O, inertia: [1e-5, 1e-5, 1e-5], points: [O]}}}}
joints:
  bore:
    {{type: pin with play, parts: [ground, ball], at: O, axis: z, x: x,
     clearance: 0.5 mm, load: 1 kN, depth: 6 um, restitution: restitution, opening_x: 0.1 mm}}
initial_velocities: {{throw: {{part: ball, about: O, velocity: [{SPEED}, 0, 0]}}}}
record: {{O: {{part: ball, at: O}}}}
"""


def ball(bench: Bench) -> None:
    """A ball that is thrown at a bore comes back at the speed of its restitution."""
    for restitution in (1.0, 0.9, 0.5, 0.1):
        scene, errors = loads("name: ball\n" + BALL).build(restitution=restitution), []
        for step in (4e-7, 2e-7, 1e-7):
            (outcome,) = bench.simulate([scene], duration=1.9e-3, instants=20, step=step)
            errors.append(abs(outcome.points["O"][1][-1, 0] / SPEED / restitution + 1))
        source = "restitution times the speed before"
        name = f"restitution {restitution:g}"
        bench.check_small(f"speed at 0.1 µs, {name}", errors[-1], 1e-5, source, "the speed")
        if restitution < 1:
            bench.check_at_least(f"order, {name}", observed_orders(errors).min(), 1.9, source)


CRANK, ROD = 0.05, 0.12  # m
RATE = 5000 * 2 * math.pi / 60
ROD_MASS, ROD_INERTIA, SLIDER = 0.21, 2.5e-4, 0.14
RADIUS, RESTITUTION = 0.01, 0.9
LOAD = 5000.0


def stiffness(clearance: float) -> float:
    """Hertz's stiffness (N/m^1.5) of a steel pin of 10 mm, as Lankarani and Nikravesh have it."""
    compliance = 2 * (1 - 0.3**2) / 207e9
    return 4 / (3 * compliance) * math.sqrt((RADIUS + clearance) * RADIUS / clearance)


def slider_crank(clearance: float) -> str:
    """Flores' slider-crank, with play between rod and slider."""
    depth = (LOAD / stiffness(clearance)) ** (2 / 3)
    return f"""
name: slider_crank
points:
  O: [0, 0, 0]
  A: [{CRANK}, 0, 0]
  B: [{CRANK + ROD}, 0, 0]
  G: [{CRANK / 2}, 0, 0]
  H: [{CRANK + ROD / 2}, 0, 0]
bodies:
  crank: {{mass: 0.3, centre: G, inertia: [1e-4, 1e-4, 1e-4], points: [O, A]}}
  rod: {{mass: {ROD_MASS}, centre: H, inertia: [{ROD_INERTIA}, {ROD_INERTIA}, {ROD_INERTIA}],
        points: [A, B]}}
  slider: {{mass: {SLIDER}, centre: B, inertia: [1e-4, 1e-4, 1e-4], points: [B]}}
curves: {{one: {{times: [0, 1], values: [1, 1]}}}}
joints:
  root: {{type: revolute, parts: [ground, crank], at: O, axis: z}}
  middle: {{type: revolute, parts: [crank, rod], at: A, axis: z}}
  way: {{type: prismatic, parts: [ground, slider], at: B, axis: x}}
  pin:
    {{type: pin with play, parts: [rod, slider], at: B, axis: z, x: x, clearance: {clearance},
     load: {LOAD}, depth: {depth}, restitution: {RESTITUTION}}}
actions: {{drive: {{type: motor, joint: root, rate: {RATE}, curve: one}}}}
opening_rates:
  crank: {{joint: root, rate: {RATE}}}
  rod: {{joint: middle, rate: {-RATE * (1 + CRANK / ROD)}}}
  slider: {{joint: way, rate: 0}}
record: {{B: {{part: slider, at: B}}}}
"""


def damping_factor(restitution: float) -> float:
    """The c with the integral of u/(1 + c u) from -restitution to 1 being 0, by halving."""
    low, high = 1e-3, 1 / restitution - 1e-9
    while high - low > 1e-14:
        c = (low + high) / 2
        is_low = math.log((1 + c) / (1 - restitution * c)) < (1 + restitution) * c
        low, high = (c, high) if is_low else (low, c)
    return low


def solve_slider_crank(clearance: float, duration: float, step: float, instants: int) -> np.ndarray:
    """Place of the slider (m) and eccentricity (m) at instants (instants, 2), by Runge and Kutta's
    method of order 4 from the equations of motion: angle of the rod and place of the slider."""
    hertz, factor = stiffness(clearance), damping_factor(RESTITUTION)
    inertia = ROD_INERTIA + ROD_MASS * ROD**2 / 4

    def slopes(time, state, fastest):
        angle, spin, x, speed = state
        crank, sine, cosine = RATE * time, math.sin(angle), math.cos(angle)
        a_x, a_y = CRANK * math.cos(crank), CRANK * math.sin(crank)
        q_x, q_y = x - a_x - ROD * cosine, -a_y - ROD * sine
        u_x, u_y = speed + RATE * a_y + ROD * sine * spin, -RATE * a_x - ROD * cosine * spin
        distance = math.hypot(q_x, q_y) or 1e-300
        rate, force = (q_x * u_x + q_y * u_y) / distance, 0.0
        if distance > clearance:
            damping = factor * rate / (max(fastest, abs(rate)) or 1e-300)
            force = max(hertz * (distance - clearance) ** 1.5 * (1 + damping), 0.0)
        f_x, f_y = force * q_x / distance, force * q_y / distance  # on the rod
        lever = ROD * (cosine * f_y - sine * f_x)
        mass = ROD_MASS * ROD / 2 * RATE**2 * (cosine * a_y - sine * a_x)
        slope = spin, (lever + mass) / inertia, speed, -f_x / SLIDER
        return slope, distance, rate

    state, fastest, rows = (0.0, -RATE * CRANK / ROD, CRANK + ROD, 0.0), 0.0, []
    count = round(duration / step)
    for n in range(count + 1):
        first, distance, rate = slopes(n * step, state, fastest)
        fastest = max(fastest, abs(rate)) if distance > clearance else 0.0
        if n % (count // (instants - 1)) == 0:
            rows.append((state[2], distance))
        stages = [first]
        for share in (0.5, 0.5, 1.0):
            trial = [y + share * step * k for y, k in zip(state, stages[-1], strict=True)]
            stages.append(slopes((n + share) * step, trial, fastest)[0])
        state = tuple(
            y + step / 6 * (a + 2 * b + 2 * c + d)
            for y, a, b, c, d in zip(state, *stages, strict=True)
        )
    return np.array(rows)


def flores(bench: Bench) -> None:
    """Flores, Ambrosio et al. (2006): 5000 rpm, 0.5 mm of play, no friction; half a turn."""
    duration, instants = (3e-3, 61) if bench.quick else (6e-3, 121)
    exact = solve_slider_crank(0.5e-3, duration, 1e-7, instants)
    scene, errors = loads(slider_crank(0.5e-3)).build(), []
    for step in (4e-7, 2e-7, 1e-7):
        (outcome,) = bench.simulate([scene], duration=duration, instants=instants, step=step)
        distance = outcome.records["pin_eccentricity"].values[:, 0]
        places = np.column_stack([outcome.points["B"][0][:, 0], distance])
        errors.append(np.abs(places - exact).max() / 0.5e-3)
    source = "Runge and Kutta on the same equations"
    bench.check_small("slider and eccentricity at 0.1 µs", errors[-1], 1e-3, source, "the play")
    bench.check_at_least("order", observed_orders(errors).min(), 1.8, source)
    energies = outcome.energies
    worst = np.abs(energies["balance"]).max() / energies["kinetic"].max()
    bench.check_small("energy balance", worst, 1e-6, "required", "the kinetic energy")


def ideal(bench: Bench) -> None:
    """Where the play goes to 0, the slider-crank is the one with a hinge."""
    errors, plays = [], (0.8e-3, 0.4e-3, 0.2e-3)
    for play in plays:
        scene = loads(slider_crank(play)).build()
        (outcome,) = bench.simulate([scene], duration=12e-3, instants=121, step=4e-7)
        crank = RATE * outcome.time
        exact = CRANK * np.cos(crank) + np.sqrt(ROD**2 - (CRANK * np.sin(crank)) ** 2)
        errors.append(np.abs(outcome.points["B"][0][:, 0] - exact).max())
    source = "r cos + √(l² - r² sin²): a hinge"
    for play, error in zip(plays, errors, strict=True):
        name = f"place of the slider, play {1e3 * play:g} mm"
        bench.check_small(name, error / play, 1.5, source, "the play")
    bench.check_at_least("order in the play", observed_orders(errors).min(), 0.9, source)


SHAFT_MASS, SHAFT_INERTIA, SHAFT_RADIUS, PLAY = 0.5, 2e-4, 0.02, 0.5e-3
WEIGHT, FRICTION, DEPTH = 5.0, 0.2, 2e-6
SHAFT = f"""
name: shaft
parameters:
  spin: {{value: 100, unit: rad/s}}
  friction: {{value: {FRICTION}}}
  x: {{value: 0, unit: m}}
  y: {{value: 0, unit: m}}
gravity: [0, -{WEIGHT / SHAFT_MASS}, 0]
points: {{O: [0, 0, 0]}}
bodies:
  shaft: {{mass: {SHAFT_MASS}, centre: O, inertia: [1e-4, 1e-4, {SHAFT_INERTIA}], points: [O]}}
joints:
  bearing:
    {{type: pin with play, parts: [ground, shaft], at: O, axis: z, x: x,
     clearance: {PLAY}, load: 20, depth: {DEPTH}, law: linear, restitution: 0.5, friction: friction,
     radius: {SHAFT_RADIUS}, bristle_deflection: 0.1 um, opening_x: x, opening_y: y}}
initial_velocities: {{spin: {{part: shaft, about: O, spin: [0, 0, spin]}}}}
"""


def shaft(bench: Bench) -> None:
    """A shaft that spins in its bearing climbs to the angle of friction and is braked there; one
    that is put aside rolls to and fro in it."""
    force = WEIGHT / math.hypot(1, FRICTION)
    distance, angle = PLAY + force * DEPTH / 20, math.atan(FRICTION)
    x, y = -distance * math.sin(angle), -distance * math.cos(angle)
    scene = loads(SHAFT).build(x=x, y=y)
    (outcome,) = bench.simulate([scene], duration=0.02, instants=21, step=2e-6)
    time, turn = outcome.time, outcome.records["opening"].values[:, 0]
    exact = 100 * time - SHAFT_RADIUS * FRICTION * force / SHAFT_INERTIA * time**2 / 2
    source = "m r F/√(1 + m²) brakes it"
    bench.check_small("turn that is braked", np.abs(turn - exact).max(), 1e-6, source, "1 rad")
    distance, swing = PLAY + WEIGHT * DEPTH / 20, 0.01
    x, y = distance * math.sin(swing), -distance * math.cos(swing)
    rate = math.sqrt(WEIGHT / (PLAY * (SHAFT_MASS + SHAFT_INERTIA / SHAFT_RADIUS**2)))
    scene = loads(SHAFT).build(x=x, y=y, spin=0.0, friction=0.8)
    (outcome,) = bench.simulate([scene], duration=4 * math.pi / rate, instants=41, step=1e-6)
    sway = outcome.records["slide_opening"].values[:, 0] / distance / swing
    source = "√(F/(play (m + J/r²))): it rolls"
    error = np.abs(sway - np.cos(rate * outcome.time)).max()
    bench.check_small("swing of a shaft that rolls", error, 0.02, source, "the swing")


PROBLEMS = {
    "ball in a bore": ball,
    "slider-crank with play": flores,
    "play that goes to 0": ideal,
    "shaft in a bearing": shaft,
}
