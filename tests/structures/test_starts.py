"""How runs begin: motors that turn at once, light bodies in loops, rates as curves."""

import numpy as np
import pytest

import fpm
from evidence.verification.rigid_motors import rocker
from fpm.elements.openings.opening import turning_at_start
from fpm.reading.responses import parse
from fpm.solver.start import check_masses, consistent_scene
from fpm.structures import loads
from fpm.structures.plausible import warnings

RSSR = """
name: rssr
description: Crank, coupler with two ball ends, rocker
parameters:
  coupler: {value: 1.5, unit: kg, range: [0, 10], description: mass of the coupler}
let:
  dx: 0.7 m - P.x
  dy: 0.3 m - P.y
  dz: 0.4 m
  psi: atan2(dz, dy) - acos((1 m2 - dx**2 - dy**2 - dz**2 - 0.25 m2)/(1 m*sqrt(dy**2 + dz**2)))
points:
  O: [0, 0, 0]
  P: [0.2, 0, 0]
  R: [0.7, 0.3, 0.4]
  Q: [0.7, "0.3 m + 0.5 m*cos(psi)", "0.4 m + 0.5 m*sin(psi)"]
  middle: [(P.x + Q.x)/2, (P.y + Q.y)/2, (P.z + Q.z)/2]
bodies:
  crank: {mass: 1, centre: O, points: [P], inertia: [0.01, 0.01, 0.01]}
  rod:
    {mass: coupler, centre: middle, points: [P, Q], box: [1, 1 mm, 1 mm], x: {from: P, to: Q},
     up: [0, Q.z - P.z, P.y - Q.y]}
  rocker: {mass: 1, centre: R, points: [Q], inertia: [0.8, 0.8, 0.8]}
joints:
  crank: {type: revolute, parts: [ground, crank], at: O, axis: z}
  pin: {type: spherical, parts: [crank, rod], at: P}
  ball: {type: spherical, parts: [rod, rocker], at: Q}
  rocker: {type: revolute, parts: [ground, rocker], at: R, axis: x, opening: psi}
curves:
  even: {times: [0, 1], values: [0, 1]}
actions:
  motor: {type: motor, joint: crank, turn: 10 rad, curve: even}
record:
  Q: {part: rocker, at: Q}
"""


@pytest.mark.parametrize("mass", [1.5, 1e-6, 1e-7])
def test_a_loop_begins_with_the_rates_that_its_motor_gives(mass):
    scene = loads(RSSR).build(coupler=mass)
    begun = consistent_scene(scene)
    rate = 10 * np.ptp(rocker(np.array([-1e-5, 1e-5]))) / 2e-5
    np.testing.assert_allclose(begun.spin[scene.bodies["crank"]], [0, 0, 10], atol=1e-9)
    np.testing.assert_allclose(begun.spin[scene.bodies["rocker"]], [rate, 0, 0], atol=1e-8)
    assert not scene.spin.any()


@pytest.mark.parametrize("mass", [1e-8, 1e-9, 1e-15])
def test_masses_too_far_apart_are_refused_by_that_reason(mass):
    with pytest.raises(fpm.SceneError, match=r"masses of joined bodies.*double precision"):
        loads(RSSR).build(coupler=mass)


def test_a_light_body_at_the_end_and_redundant_conditions_are_not_refused():
    """What hangs on one joint hides nothing; conditions that others imply are no sign of masses."""
    scene = fpm.Scene()
    places = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)]
    bodies = [int(p) for p in scene.add_particles(places, [1, 1, 1, 1e-12], 1.0)]
    scene.fix(bodies[0])
    for k, pair in enumerate([(0, 1), (1, 2), (2, 3), (0, 2)]):
        scene.add_joint(f"j{k}", "fixed", [bodies[p] for p in pair], places[pair[1]])
    check_masses(scene)


def test_a_motion_that_fits_and_a_scene_at_rest_are_left_as_they_are():
    scene = loads(RSSR.replace("turn: 10 rad", "turn: 0 rad")).build()
    assert consistent_scene(scene) is scene
    begun = consistent_scene(loads(RSSR).build())
    assert consistent_scene(begun) is begun


def test_a_motor_beside_a_latch_on_its_joint_turns_it_from_the_start():
    """The latch, stated later, has no rate at the start, and took the motor's away."""
    latched = RSSR.replace("record:", "  pawl: {type: latch, joint: crank, angle: 9 rad}\nrecord:")
    scenes = [consistent_scene(loads(text).build()) for text in (RSSR, latched)]
    assert scenes[0].spin.any()
    np.testing.assert_array_equal(scenes[1].spin, scenes[0].spin)


SPUN = """
name: spun
points: {a: [0, 0, 0], b: [1, 0, 0]}
bodies:
  sheet: {mass: 1 kg, centre: b, inertia: [0.1, 0.1, 0.1], points: [a]}
joints:
  h: {type: revolute, parts: [ground, sheet], at: a, axis: AXIS}
initial_velocities:
  go: {part: sheet, about: a, spin: [0, 0, 3 rad/s]}
record:
  b: {part: sheet, at: b}
"""
HELD = SPUN.replace("initial", "actions: {hold: {type: release, joint: h, time: 1 s}}\ninitial")


@pytest.mark.parametrize(
    ("text", "axis", "words"),
    [
        (SPUN, "z", None),
        (SPUN, "y", "have 4.95 J; joints, motors, drives and what is held then leave 0 J"),
        (HELD, "z", "have 4.95 J; joints, motors, drives and what is held then leave 0 J"),
    ],
)
def test_a_motion_that_joints_do_not_allow_is_told(text, axis, words):
    """m v²/2 and I w²/2 at 1 m from the axis: (1 + 0.1) 9/2 J."""
    sentences = [s for s in warnings(loads(text.replace("AXIS", axis)).build()) if "velocit" in s]
    assert words in sentences[0] if words else not sentences


RATES = "opening_rates:\n  start: {joint: crank, rate: 10 rad/s}\nrecord:"


def test_a_stated_rate_starts_a_linkage_as_a_motor_does():
    led = consistent_scene(loads(RSSR).build())
    head, _, tail = RSSR.partition("actions:\n  motor: {type: motor, joint: crank, turn: 10 rad, c")
    free = consistent_scene(loads(head + RATES + tail.partition("record:")[2]).build())
    assert free.velocity == pytest.approx(led.velocity, abs=1e-9)
    assert free.spin == pytest.approx(led.spin, abs=1e-9)
    with pytest.raises(fpm.SceneError, match=r"rate: 12 is not .* 10 rad/s, to which motor"):
        loads(RSSR.replace("record:", RATES.replace("10 rad", "12 rad"))).build()
    twice = RATES.replace("record:", "  again: {joint: crank, rate: 0}\nrecord:")
    with pytest.raises(fpm.SceneError, match="joints that have no other rate"):
        loads(head + twice + tail.partition("record:")[2]).build()


FLOATS = """
name: floats
points: {hub: [0, 0, 0], pin: [0.3, 0.2, 0], panel: [0.8, 0.1, 0.2]}
bodies:
  hub: {mass: 5, centre: hub, inertia: [0.5, 0.6, 0.7], points: [pin]}
  panel: {mass: 2, centre: panel, inertia: [0.1, 0.2, 0.25], points: [pin]}
joints:
  h: {type: TYPE, parts: [hub, panel], at: pin, axis: y}
opening_rates:
  go: {joint: h, rate: RATE}
record:
  panel: {part: panel, at: panel}
"""


@pytest.mark.parametrize(
    ("kind", "rate"), [("revolute", "2 rad/s"), ("prismatic", "2 m/s"), ("revolute", "-2 rad/s")]
)
def test_a_stated_rate_of_what_floats_gives_it_no_momentum(kind, rate):
    start = consistent_scene(loads(FLOATS.replace("TYPE", kind).replace("RATE", rate)).build())
    assert turning_at_start(start, [0]) == pytest.approx([float(rate.split()[0])])
    momenta = start.mass[:, None] * start.velocity
    spins = np.einsum("nij,nj,nkj,nk->ni", start.frame, start.inertia, start.frame, start.spin)
    assert np.abs(momenta).max() > 0.1
    assert momenta.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-9)
    total = (np.cross(start.position, momenta) + spins).sum(axis=0)
    assert total == pytest.approx(np.zeros(3), abs=1e-9)


WHEELS = """
name: wheels
points: {o: [0, 0, 0]}
bodies:
  hub: {mass: 1, centre: o, inertia: [0.01, 0.015, 0.02]}
  wheel: {mass: 1, centre: o, inertia: [0.01, 0.015, 0.02]}
joints:
  h: {type: revolute, parts: [ground, hub], at: o, axis: z}
  g: {type: revolute, parts: [hub, wheel], at: o, axis: z}
curves: {even: {times: [0, 1], values: [0, 1]}}
record: {o: {part: wheel, at: o}}
"""
TURNS = {
    "free": "opening_rates: {a: {joint: h, rate: 50 rad/s}, b: {joint: g, rate: -102 rad/s}}",
    "driven": "drives: {d: {part: hub, at: o, spin: [0, 0, 50]}}",
    "led": "actions: {m: {type: motor, joint: g, turn: -102 rad, curve: even}}",
    "latched": """
opening_rates: {a: {joint: h, rate: 50 rad/s}, b: {joint: g, rate: -102 rad/s}}
actions: {l: {type: latch, joint: g, angle: -31 rad, side: above}}""",
}


@pytest.mark.parametrize("rate", [98, -102, 900])
def test_a_free_wheel_turns_by_its_rate_whatever_the_step(rate):
    text = WHEELS[: WHEELS.index("  g:")].replace("  wheel: ", "  #")
    text += f"record: {{o: {{part: hub, at: o}}}}\nopening_rates: {{a: {{joint: h, rate: {rate}}}}}"
    for step in (1.0, 0.1, 0.03, 0.01):
        (outcome,) = fpm.simulate(loads(text).build(), duration=1, instants=2, step=step)
        assert outcome.openings["h"][-1] == pytest.approx(rate, abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.1, 0.05, 0.01])
@pytest.mark.parametrize(
    ("case", "hub", "wheel"),
    [
        ("free", 50, -102),
        ("driven", 50, -50),
        ("led", 51, -102),
        # From 31/102 s on both have half of the momentum, J (50 - 52).
        ("latched", 50 * 31 / 102 - (1 - 31 / 102), -31),
    ],
)
def test_several_turns_in_a_step_are_counted(case, hub, wheel, step):
    text = WHEELS + TURNS[case]
    if case == "driven":
        text = text.replace("  h: {type: revolute, parts: [ground, hub], at: o, axis: z}\n", "")
    (outcome,) = fpm.simulate(loads(text).build(), duration=1, instants=11, step=step)
    assert outcome.failure is None
    assert outcome.openings["g"][-1] == pytest.approx(wheel, abs=1e-6)
    if case != "driven":
        assert outcome.openings["h"][-1] == pytest.approx(hub, abs=1e-6)


LATCHES = """
opening_rates: {a: {joint: h, rate: 1 rad/s}, b: {joint: g, rate: 2 rad/s}}
actions:
"""


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.1, 0.05, 0.01])
@pytest.mark.parametrize(
    ("latches", "hub", "times"),
    [
        ([("g", 0.31, ""), ("g", 0.3, "")], 0.15 + 2 * 0.85, [0.15]),
        ([("h", 0.155, ""), ("g", 0.3, "")], 0.155, [0.15, 0.1525]),
        # What would be missed at 2 rad/s is passed at 1 rad/s; from then on g turns at 3 rad/s.
        (
            [("h", 0.149, ", max_capture_rate: 1.5 rad/s"), ("g", 0.3, "")],
            0.149,
            [0.149, 0.149 + 0.002 / 3],
        ),
    ],
)
def test_latches_passed_in_one_step_catch_in_order(latches, hub, times, step):
    """Once g is caught, both turn at the mean of their rates of 1 and 3 rad/s."""
    lines = [
        f"  l{n}: {{type: latch, joint: {joint}, angle: {angle} rad{more}}}\n"
        for n, (joint, angle, more) in enumerate(latches)
    ]
    scene = loads(WHEELS + LATCHES + "".join(lines)).build()
    (outcome,) = fpm.simulate(scene, duration=1, instants=11, step=step)
    assert outcome.failure is None
    assert outcome.openings["g"][-1] == pytest.approx(0.3, abs=1e-9)
    assert outcome.openings["h"][-1] == pytest.approx(hub, abs=1e-9)
    found = sorted(outcome.events[outcome.events[:, 2] == 0][:, 0])
    assert found == pytest.approx(times, abs=1e-9)


def carts(places, rates, masses) -> str:
    """A row of carts, each on a slide on the one before, with an exact latch at one of `places`
    (m), at `rates` (m/s) over the one before."""
    rows = {
        "bodies": "c{k}: {{mass: {mass}, centre: o, inertia: [1, 1, 1]}}",
        "joints": "j{k}: {{type: prismatic, parts: [{last}, c{k}], at: o, axis: x}}",
        "actions": "l{k}: {{type: latch, joint: j{k}, position: {place} m}}",
        "opening_rates": "r{k}: {{joint: j{k}, rate: {rate} m/s}}",
    }
    text = "points: {o: [0, 0, 0]}\nrecord: {o: {part: c0, at: o}}\n"
    for key, row in rows.items():
        text += f"{key}:\n"
        for k, (place, rate, mass) in enumerate(zip(places, rates, masses, strict=True)):
            last = f"c{k - 1}" if k else "ground"
            text += f"  {row.format(k=k, last=last, place=place, rate=rate, mass=mass)}\n"
    return text


def impacts_of_carts(places, rates, masses, end):
    """Openings (m) at `end` (s), and times (s; inf: none) and impulses (N s) of inelastic impacts,
    one after the other."""
    count = len(places)
    sums = np.tril(np.ones((count, count)))
    inverse = np.linalg.inv(sums.T @ np.diag(masses) @ sums)
    openings, rates, held, time = np.zeros(count), np.array(rates), [], 0.0
    times, impulses = np.full(count, np.inf), np.zeros(count)
    while True:
        waits = np.divide(places - openings, rates, out=np.full(count, np.inf), where=rates != 0)
        waits[waits <= 0], waits[held] = np.inf, np.inf
        wait, k = waits.min(), int(waits.argmin())
        if time + wait > end:
            return openings + rates * (end - time), times, impulses
        openings, time, held = openings + rates * wait, time + wait, [*held, k]
        impulse = -np.linalg.solve(inverse[np.ix_(held, held)], rates[held])
        rates = rates + inverse[:, held] @ impulse
        rates[held], times[k], impulses[k] = 0.0, time, impulse[-1]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("step", [0.01, 0.004])
def test_latches_in_one_step_or_the_next_have_times_and_impulses_of_their_own(seed, step):
    rng = np.random.default_rng(seed)
    count = rng.integers(2, 5)
    masses = rng.uniform(0.2, 3, count)
    rates = rng.uniform(0.3, 2, count) * rng.choice([-1, 1], count)
    places = rates * (0.5 + rng.uniform(0, rng.choice([0.003, 0.01, 0.03]), count))
    openings, times, impulses = impacts_of_carts(places, rates, masses, 0.8)
    (outcome,) = fpm.simulate(
        loads(carts(places, rates, masses)).build(), duration=0.8, instants=81, step=step
    )
    found = np.sort(outcome.events[outcome.events[:, 2] == 0][:, 0])
    assert found == pytest.approx(np.sort(times[np.isfinite(times)]), abs=1e-9)
    for k in range(count):
        words = {"latch_impact": f"l{k}", "component": "signed"}
        impact = parse("impact", words, outcome.scene).evaluate(outcome)[-1]
        assert impact == pytest.approx(impulses[k], rel=1e-6, abs=1e-9)
        assert outcome.openings[f"j{k}"][-1] == pytest.approx(openings[k], abs=1e-9)


STOPPED = """
points: {o: [0, 0, 0], q: [0, 0, 1]}
bodies:
  b: {mass: 2, centre: o, inertia: [0.1, 0.1, 0.1]}
  c: {mass: 2, centre: q, inertia: [1, 1, 1]}
joints:
  h: {type: revolute, parts: [ground, b], at: o, axis: x}
  k: {type: revolute, parts: [ground, c], at: q, axis: x}
opening_rates: {g: {joint: h, rate: 3 rad/s}}
actions:
  a: ACTION
record: {o: {part: b, at: o}}
"""


OIL = "  oil: {type: damper, joint: h, damping: 0.5}\nrecord"
PUSH = "loads: {push: {part: b, at: o, force: [0, 0, 0], moment: [2, 0, 0]}}\nrecord"


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.05, 0.025, 0.0125, 0.005])
@pytest.mark.parametrize(
    ("action", "more", "opening"),
    [
        ("{type: latch, joint: h, angle: 0.012 rad}", "record", 0.012),
        ("{type: latch, joint: h, angle: 0.012 rad}", PUSH, 0.012),
        ("{type: latch, joint: h, angle: 0.012 rad}", OIL, 0.012),
        ("{type: friction, joint: h, moment: 20, sticks: exactly}", "record", 0.45 / 20),
        ("{type: friction, joint: h, moment: 40, sticks: exactly}", PUSH, 0.45 / 38),
    ],
)
def test_what_stops_a_joint_in_the_first_steps_takes_all_of_its_energy(action, more, opening, step):
    """It is J w²/2 and the work of a load, however long the first kick is, by whose momenta the
    energy is told."""
    scene = loads(STOPPED.replace("ACTION", action).replace("record", more)).build()
    asked = [("joint_work", f"h {action[7:].split(',')[0]}")]
    (outcome,) = fpm.simulate(scene, duration=0.3, instants=7, step=step, record=asked)
    assert outcome.openings["h"][-1] == pytest.approx(opening, abs=1e-9)
    kinetic, loss = outcome.energies["kinetic"], outcome.energies["joint_loss"]
    work, given = outcome.columns[asked[0]], 2.0 * opening if more == PUSH else 0.0
    if more == "record" or opening < 0.5 * step:  # else weight and loads err by step squared
        np.testing.assert_allclose(kinetic[[0, -1]], [0.45, 0], atol=1e-8)
        np.testing.assert_allclose(loss[[0, -1]], [0, 0.45 + given], atol=1e-8)
    if more != OIL:
        np.testing.assert_allclose(work, -loss, atol=1e-9)
    assert np.abs(outcome.energies["balance"]).max() < 1e-8
    for words in ({"energy": "kinetic"}, {"loss": "all"}, {"energy": "joint_loss"}):
        response = parse("e", words, scene)
        assert response.least == 0.0 <= response.evaluate(outcome).min()
    assert parse("e", {"energy": "balance"}, scene).least is None
