"""Curves of time by expressions and smooth tables: exact values, integrals and rates; what they
move, against closed forms and another solver; and what is refused."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from fpm.scenes.curve import Curve
from fpm.solver.simulate import simulate
from fpm.structures import StructureError
from fpm.structures.text_file import loads
from fpm.travel.components import components_of

FUNCTIONS = {
    "polynomial": (lambda u: 10 * u**3 - 15 * u**4 + 6 * u**5, 2),
    "thirteenth": (lambda u: u**13, 2),
    "sine": (lambda u: np.sin(20 * np.pi * u), 60),
    "pulse": (lambda u: np.exp(-(((u - 0.31) / 0.01) ** 2)), 40),
    "kink": (lambda u: abs(2 * u - 0.6), 100),
    "zero": (lambda u: 0.0, 2),
    "large": (lambda u: 1e6 + np.sin(6 * u), 10),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_are_followed_to_their_bound_with_integral_rate_and_extremes(name):
    function, most = FUNCTIONS[name]
    curve = Curve.fit(function, -0.3, 1.2)
    times = np.linspace(-0.5, 1.5, 2001)
    exact = np.array([function(u) for u in np.clip((times + 0.3) / 1.5, 0, 1)])
    assert curve.value(times) == pytest.approx(exact, rel=0, abs=4e-12 * np.abs(exact).max())
    assert len(curve.times) <= most
    low, high = curve.extremes()
    assert low <= exact.min() + 1e-9 * abs(low) + 1e-12 and high >= exact.max() * (1 - 1e-11)
    for time in (0.0, 0.4, 1.4):
        value = quad(curve.value, 0, time, points=(0.12, 0.15, 0.18, 1.2), limit=200)[0]
        assert curve.integral(time) == pytest.approx(value, rel=1e-9, abs=1e-9)
        slope = (curve.value(time + 1e-6) - curve.value(time + 1e-9)) / (1e-6 - 1e-9)
        assert curve.rate_after(time) == pytest.approx(slope, rel=1e-3, abs=1e-3 * high)


@pytest.mark.parametrize("place", [0.3125, 0.4, 0.71828])
def test_a_needle_of_a_few_ten_thousandths_is_seen(place):
    curve = Curve.fit(lambda u: max(0.0, 1 - abs(u - place) / 3e-4), 0.0, 1.0)
    assert curve.extremes() == pytest.approx((0, 1), abs=1e-9)
    assert curve.integral(1.0) == pytest.approx(3e-4, rel=1e-9)


ROOT_PI = np.sqrt(np.pi)
NARROW = {  # integral and feature
    "exp(-((t - 0.5013 s)/(1 us))**2)": (1e-6 * ROOT_PI, 1.77e-6),
    "exp(-((u - 0.2)/1e-6)**2) - 2*exp(-((u - 0.2003)/2e-7)**2)": (0.6e-6 * ROOT_PI, 3.5e-7),
    "1e6*max(0, u - 0.4)*max(0, 0.40004 - u)": (1e6 * 4e-5**3 / 6, 2.67e-5),
    "max(0, u - 0.3)/1e-6*exp(-max(0, u - 0.3)/1e-6)": (1e-6, 2.7e-6),
    "exp(-((max(0, 1 - abs(u - 0.3)/1e-5) - 0.523)/0.05)**2)": (1e-6 * ROOT_PI, 9e-7),
    "interpolate(t, 0 s, 0, 0.5 s, 0, 0.500001 s, 1, 0.500002 s, 0, 1 s, 0)": (1e-6, 1e-6),
    "max(0, min(1, (t - 0.3 s)/(1 us), (0.30001 s - t)/(1 us)))": (9e-6, 9e-6),
    "min(1, max(0, (t - 0.3 s)/(1 us)))": (0.7 - 5e-7, np.inf),
} | {
    f"max(0, 1 - abs(t - {place} s)/({width} us))": (width * 1e-6, width * 1e-6)
    for place, width in ((0.5013, 0.2), (0.51234, 40), (0.51234, 100))
}  # fmt: skip


@pytest.mark.parametrize("expression", NARROW)
def test_an_expression_narrower_than_its_sampling_is_followed_where_its_parts_turn(expression):
    text = BALL.format(curve=f"expression: '{expression}', over: [0, 1 s]", rest="")
    (curve,) = loads(text).build().curves
    integral, feature = NARROW[expression]
    assert curve.integral(1.0) == pytest.approx(integral, rel=1e-6)
    assert curve.find_feature(1.0) == pytest.approx(feature, rel=0.15)


def test_kinks_are_where_the_rate_jumps_and_nowhere_else():
    smooth, kink, hat = (
        Curve.fit(function, 0.0, 1.0)
        for function in (
            FUNCTIONS["polynomial"][0],
            FUNCTIONS["kink"][0],
            lambda u: u**2 * (1 - u) ** 2,
        )
    )
    assert np.isinf(smooth.kinks).all() and np.isinf(hat.kinks).all()
    places = np.unique(kink.kinks)
    assert {0.0, 1.0} <= {*places} and np.abs(places[1:-1] - 0.3).max() < 1e-5
    assert places[np.searchsorted(places, 0.29)] == pytest.approx(0.3, abs=1e-8)


PENDULUM = """
gravity: {{acceleration: [0, 0, -9.81], curve: g}}
points: {{O: [0, 0, 0], C: [0.1, 0, 0]}}
bodies: {{arm: {{mass: 1, centre: C, points: [O], inertia: [0.01, 0.01, 0.01]}}}}
joints: {{hinge: {{type: revolute, parts: [ground, arm], at: O, axis: -y}}}}
curves:
  g: {{expression: 1 + sin(5 rad/s * t), over: [0, 2 s]}}
  swing: {{expression: sin(2*pi*u)*exp(-u), over: [0, 1 s]}}
actions: {{a: {{type: {action}, joint: hinge, curve: swing}}}}
"""
ACTIONS = {
    "torque motor, torque: 2 N m": lambda t, psi, rate: 2 * swing(t),
    "motor, turn: 40 deg, stiffness: 9 N m/rad, damping: 0.2 N m s/rad": lambda t, psi, rate: (
        9 * (np.radians(40) * swing(t) - psi)
        + 0.2 * (np.radians(40) * (swing(t + 1e-6) - swing(t - 1e-6)) / 2e-6 * (0 < t < 1) - rate)
    ),
}


def swing(time):
    u = np.clip(time, 0, 1)
    return np.sin(2 * np.pi * u) * np.exp(-u)


@pytest.mark.slow
@pytest.mark.parametrize("action", ACTIONS)
def test_gravity_and_motors_by_expressions_move_a_pendulum_as_another_solver_does(action):
    def slopes(t, state):
        weight = -9.81 * (1 + np.sin(5 * t)) * 0.1 * np.cos(state[0])
        return [state[1], (ACTIONS[action](t, *state) + weight) / 0.02]

    scene, errors = loads(PENDULUM.format(action=action)).build(), []
    for step in (2e-3, 1e-3):
        (outcome,) = simulate(scene, duration=1.2, instants=25, step=step)
        exact = []
        for start, end in ((0.0, 1.0), (1.0, 1.2)):  # the curve ends with a kink
            last = exact[-1].y[:, -1] if exact else [0, 0]
            exact.append(solve_ivp(slopes, (start, end), last, rtol=1e-9, atol=1e-11,
                                   dense_output=True, max_step=0.01))  # fmt: skip
        values = [exact[int(t > 1)].sol(t)[0] for t in outcome.time]
        errors.append(np.abs(outcome.openings["hinge"] - values).max())
    energies = dict(outcome.energies)
    assert errors[1] < 0.3 * errors[0] and errors[1] < 2e-4
    assert np.abs(energies["balance"]).max() < 2e-4 * np.abs(energies["load_work"]).max()


BALL = """
points: {{c: [0, 0, 0], d: [2, 0, 0]}}
bodies: {{ball: {{mass: 2, centre: c, inertia: [1, 1, 1]}}}}
curves: {{f: {{{curve}}}}}
record: {{c: {{part: ball, at: c}}}}
{rest}
"""


PULSED = """
gravity: {{acceleration: [0, 0, 2], curve: f}}
points: {{c: [0, 0, 0], d: [2, 0, 0], e: [4, 0, 0], w: [5, 0, 0]}}
bodies:
  ball: {{mass: 2, centre: c, inertia: [1, 1, 1]}}
  led: {{mass: 1, centre: d, inertia: [1, 1, 1]}}
  wheel: {{mass: 1, centre: e, points: [w], inertia: [2, 2, 4]}}
joints:
  axle: {{type: revolute, parts: [ground, wheel], at: e, axis: z}}
  rail: {{type: prismatic, parts: [ground, ball], at: c, axis: [1, 0, 1]}}
curves: {{f: {{{curve}}}}}
loads: {{push: {{part: ball, at: c, force: [1000 N, 0, 0], curve: f}}}}
drives: {{go: {{part: led, at: d, velocity: [3, 0, 0], curve: f}}}}
actions: {{turn: {{type: torque motor, joint: axle, torque: 20 N m, curve: f}}}}
record: {{c: {{part: ball, at: c}}, d: {{part: led, at: d}}, w: {{part: wheel, at: w}}}}
"""
PULSES = {
    "times: [0.5012, 0.5018, 0.5024], values: [0, 1, 0]": (6e-4, 6e-4),
    "times: [0.5, 0.505, 0.51], values: [0, 1, 0]": (5e-3, 5e-3),
    "times: [0, 0.0001, 0.5, 0.5001], values: [0, 1, 1, 0]": (0.5, 1e-4),
    "times: [0.4, 0.401, 0.403], values: [0, 1, 0], smooth: true": (1.5e-3, 1e-3 / 1.5),
    "expression: exp(-((t - 0.5 s)/(1 ms))**2), over: [0, 1 s]": (
        1e-3 * np.sqrt(np.pi), 1e-3 * np.sqrt(np.e / 2)
    ),
    "expression: sin(100*pi*t/(1 s)), over: [0, 0.99 s]": (2 / (100 * np.pi), 1 / (100 * np.pi)),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("curve", PULSES)
def test_impulses_of_pulses_shorter_than_a_step_are_exact_at_any_step(curve):
    scene, (integral, feature) = loads(PULSED.format(curve=curve)).build(), PULSES[curve]
    assert scene.curves[0].find_feature(1.0) == pytest.approx(feature, rel=0.1)
    for step in (None, 0.1, 0.01, 0.003):
        (outcome,) = simulate(scene, duration=1, instants=11, step=step)
        speed = outcome.points["c"][1][-1]
        assert speed == pytest.approx([251 * integral, 0, 251 * integral], rel=1e-10, abs=1e-13)
        assert outcome.points["d"][0][-1, 0] == pytest.approx(2 + 3 * integral, rel=1e-12)
        rate = np.linalg.norm(outcome.points["w"][1][-1])
        assert rate == pytest.approx(5 * integral, rel=1e-10)
        energies = dict(outcome.energies)
        assert energies["kinetic"][-1] == pytest.approx(speed @ speed + 2 * rate**2, rel=1e-9)
        assert np.abs(energies["balance"]).max() < 1e-9 * energies["kinetic"].max()
        assert step is not None or 0.2 * feature < outcome.step < 0.26 * feature


@pytest.mark.slow
def test_a_rise_in_the_last_step_of_a_run_is_resolved():
    scene = loads(PULSED.format(curve="times: [0.999, 1], values: [0, 1]")).build()
    (outcome,) = simulate(scene, duration=1, instants=11)
    assert outcome.points["c"][1][-1] == pytest.approx([0.1255, 0, 0.1255], rel=0.01)


RAIL = "joints: {rail: {type: prismatic, parts: [ground, ball], at: c, axis: x}}\n"
MOTOR = "actions: {m: {type: motor, joint: rail, travel: 1 m, stiffness: 8 N/m, curve: f"
WINCH = "cables: {w: {through: [{part: ground, at: d}, c], EA: 2 kN, curve: f, "
LATE, EARLY = (
    "times: [0.5012, 0.5018, 0.5024], values: [0, 1, 0]",
    "times: [0, 0.0012], values: [1, 0]",
)
SPRUNG = {  # way at 1 s after a pulse of 6e-4 s, as an impulse; and the first force
    "late": (LATE, MOTOR + "}}", lambda t: 2 * np.sin(2 * t), 0),
    "early": (EARLY, MOTOR + "}}", lambda t: 2 * np.sin(2 * (t + 4e-4)), 8),
    "damped": (LATE, MOTOR + ", damping: 1.6 N s/m}}", lambda t: np.exp(-0.4 * t) * (
        0.8 * np.cos(np.sqrt(3.84) * t) + 3.68 / np.sqrt(3.84) * np.sin(np.sqrt(3.84) * t)), 0),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("step", [None, 0.01, 0.003])
@pytest.mark.parametrize("case", SPRUNG)
def test_a_pulse_of_a_sprung_motor_is_an_impulse_at_any_step(case, step):
    curve, actor, way, first = SPRUNG[case]
    scene = loads(BALL.format(curve=curve, rest=RAIL + actor)).build()
    (outcome,) = simulate(scene, duration=1, instants=101, step=step)
    right = 6e-4 * way(1 - (0.5018 if curve == LATE else 4e-4))
    assert outcome.openings["rail"][-1] == pytest.approx(right, rel=0.01)
    assert outcome.records["slide_motor_force"].values[0, 0] == pytest.approx(first)
    assert np.abs(outcome.energies["balance"]).max() < 2e-11  # J, of 4 J in the drive train


@pytest.mark.slow
def test_a_winch_acts_by_its_mean_and_its_tension_at_the_start_is_as_stated():
    actor = WINCH + "rest: 2 m, reel: 1 cm}}"
    scene = loads(BALL.format(curve=LATE, rest=RAIL + actor)).build()
    (outcome,) = simulate(scene, duration=1, instants=101, step=0.003)
    assert outcome.openings["rail"][-1] == pytest.approx(3e-3 * 0.4982, rel=0.01)
    actor = WINCH + "preload: 100 N, reel: 1 m}}"
    scene = loads(BALL.format(curve="times: [0, 9], values: [0, -9]", rest=RAIL + actor)).build()
    (outcome,) = simulate(scene, duration=0.1, instants=11, step=0.01)
    assert outcome.records["cable_tension"].values[0, 0] == pytest.approx(100, rel=1e-9)


PASSING = {
    "drives: {d: {part: ball, at: c, velocity: [1, 0, 0], curve: f, rotations: none}}": 1.0,
    "actions: {m: {type: motor, joint: rail, rate: 1 m/s, curve: f}}": 1.0,
    # Taut for 1.2 ms, by twice the mean of 5 mm: 1 kN/m give 2 kg a velocity of 3 mm/s.
    WINCH + "rest: 2 m, reel: 10 mm}}": 3e-3 * 0.4982 / 6e-4,
}


@pytest.mark.slow
@pytest.mark.parametrize("actor", PASSING)
def test_energy_that_passes_between_two_checks_counts_in_the_balance(actor):
    """It is given and taken back within 1.2 ms, and what is left is rounding, or a 2000th of it."""
    scene = loads(BALL.format(curve=LATE, rest=RAIL + actor)).build()
    (outcome,) = simulate(scene, duration=1, instants=101, energy_tolerance=0.005, halvings=0)
    assert outcome.failure is None
    assert outcome.openings["rail"][-1] == pytest.approx(6e-4 * PASSING[actor], rel=5e-3)


def test_margins_and_the_step_count_curves_at_their_extremes_between_points():
    text = PENDULUM.format(action="torque motor, torque: 2 N m, no_load: 3 rad/s")
    scene = loads(text).build()
    parts = {part.name: part for part in components_of(scene)}
    weights = [e.acceleration[2] for e in parts["weight 0"].elements]
    assert weights == pytest.approx([0.0, -2 * 9.81], abs=1e-11)
    assert Curve.fit(lambda u: min(1.0, max(0.0, 3 * u - 1)), 0.0, 1.0).extremes()[0] == 0.0
    peak = np.abs(swing(np.linspace(0, 1, 100001))).max()
    assert parts["a"].element.torque == pytest.approx(2 * peak, rel=1e-9)
    (motor,) = scene.kinds[type(parts["a"].element)]
    assert motor.damping_in(scene) == pytest.approx(2 * peak / 3, rel=1e-9)


@pytest.mark.parametrize(
    ("curve", "words"),
    [
        ("expression: u", "expression: 'expression' is not allowed; .*`expression` and `over`"),
        ("expression: u, over: [1 s, 1 s]", r"over: \[1.0, 1.0\] is not allowed; .* later"),
        ("expression: u, over: [1 m, 2 m]", "over: '1 m' is m; allowed"),
        ("expression: t, over: [0, 1 s]", "expression: 't' is s; allowed: a number, by arithmetic"),
        ("expression: 1/u, over: [0, 1 s]", "expression: '1/u' .* at 0 s it is no finite number"),
        ("expression: sqrt(u), over: [3 s, 4 s]", r"'sqrt\(u\)' .* at 3 s .* is too steep"),
        ("expression: 1/(u - 0.3), over: [0, 1 s]", "at 0.3 s it jumps, or is too steep"),
        ("expression: sin(1e5*pi*u), over: [0, 1 s]", "it has taken 4000 polynomials"),
        ("expression: v, over: [0, 1 s]", "there is no number called 'v'"),
        ("expression: u, over: [0, 1 s], smooth: true", "smooth: 'true' is not allowed"),
        ("times: [0, 1], values: [0, 1], smooth: yes", "smooth: 'yes' .* allowed: true, false"),
        ("times: [0, 1], values: [0, 1], over: [0, 1]", "over: 'times, values, over'"),
        ("times: [0, 1], values: [1e308, -1e308], smooth: true", "values: .* do not differ by"),
    ],
)
def test_what_is_refused_of_a_curve(curve, words):
    with pytest.raises(StructureError, match=words):
        loads(BALL.format(curve=curve, rest=""))


@pytest.mark.parametrize(
    ("rest", "words"),
    [
        ("gravity: {acceleration: [0, 0, 1], curve: h}", "there is no curve 'h'"),
        ("gravity: {curve: f}", "gravity: .* is not allowed; .*{acceleration: such numbers, curve"),
        ("gravity: {acceleration: [0, 0, 1 m], curve: f}", "gravity.acceleration: '1 m' is m"),
        ("let: {u: 3, three: u}", "here|structure's own number u"),
    ],
)
def test_what_is_refused_of_gravity_and_names(rest, words):
    with pytest.raises(StructureError, match=words):
        loads(BALL.format(curve="expression: u, over: [0, 1 s]", rest=rest))
