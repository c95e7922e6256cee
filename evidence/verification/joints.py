"""Hinges, torsion springs and contact against closed forms of rigid bodies and stiff bars."""

import numpy as np
from scipy.integrate import solve_ivp

import fpm
from deployable.campaign.config.sections import scene_type
from evidence.verification.bench import Bench, observed_orders
from evidence.verification.rotation import crossings
from fpm.elements import Contact
from fpm.structures import loads

MASS, INERTIA, ARM = 2.0, 0.3, 0.5  # kg; kg m² about the centre; m from the hinge to the centre
ABOUT_HINGE = INERTIA + MASS * ARM**2
AXIS = np.array([0.0, -1.0, 0.0])  # openings grow as the body swings up towards +x


def swinging_body(angle: float, gravity: float = 0.0, rate: float = 0.0) -> fpm.Scene:
    """A rigid body on hinge O at the origin, `angle` (rad) from hanging down, turning at `rate`."""
    scene = fpm.Scene("pendulum", gravity=(0, 0, -gravity))
    direction = np.array([np.sin(angle), 0, -np.cos(angle)])
    ground = scene.add_particles((0, 0, 0), 1.0, 1.0)[0]
    scene.fix(ground)
    body = scene.add_particles(
        ARM * direction, MASS, INERTIA, velocity=rate * ARM * np.cross(AXIS, direction),
        spin=rate * AXIS,
    )[0]  # fmt: skip
    scene.add_hinge("O", (ground, body), (0, 0, 0), AXIS, opening=angle)
    scene.add_point("centre", body)
    return scene


def period(time, swing) -> float:
    """Period (s) of an oscillation about zero (t,), from all its sign changes."""
    times = crossings(time, swing)
    return 2 * float(np.polyfit(np.arange(len(times)), times, 1)[0])


def pendulum(bench: Bench) -> None:
    """Physical pendulums with large swings: a rigid body in lanes, and a stiff bar of elements."""
    from scipy.special import ellipk

    g, angles = 9.81, np.radians([5.0, 60.0, 120.0, 170.0])
    scenes = [swinging_body(angle, g) for angle in angles]
    outcomes = bench.simulate(scenes, duration=20.0, instants=4001, step=1e-3)
    source = "T = 4 √(I / m g d) K(sin θ₀/2)"
    for angle, outcome in zip(angles, outcomes, strict=True):
        name = f"{np.degrees(angle):.0f}°"
        exact = 4 * np.sqrt(ABOUT_HINGE / (MASS * g * ARM)) * ellipk(np.sin(angle / 2) ** 2)
        swing = outcome.openings["O"]
        bench.check(f"period, swing {name} (s)", period(outcome.time, swing), exact, 1e-3, source)
        worst = np.abs(outcome.energies["balance"]).max() / np.ptp(outcome.energies["kinetic"])
        bench.check_small(f"energy balance, swing {name}", worst, 1e-3, "no damping", "energy")

    length, angle = 1.0, np.radians(60.0)
    values = {"L": length, "E": 2e11, "g": g, "angle": 60.0}
    scene = scene_type("pendulum").build(**values, elements=2 if bench.quick else 4)
    section = fpm.Section.square(0.05)
    inertia = length**2 / 3 + section.Iy / section.A
    exact = 4 * np.sqrt(inertia / (g * length / 2)) * ellipk(np.sin(angle / 2) ** 2)
    (outcome,) = bench.simulate(scene, duration=4.0, instants=2001)
    swing = outcome.openings["O"]
    bench.check("period, bar of elements (s)", period(outcome.time, swing), exact, 1e-3, source)
    gap, tilt = (outcome.records[f"hinge_{name}gap"].values.max() for name in ("", "axis_"))
    bench.check_small("gap of the hinge", gap / length, 1e-10, "required", "L")
    bench.check_small("tilt of the hinge (rad)", tilt, 1e-9, "required", "1")


def contact_bounce(bench: Bench) -> None:
    """A body runs into the contact: half a sine of contact, and back at the speed it came with."""
    rate = 0.8
    stiffnesses = np.array([1e3, 1e4, 1e5])
    scenes = []
    for stiffness in stiffnesses:
        scene = swinging_body(0.1, rate=-rate)
        scene.add(Contact(0, stiffness))
        scenes.append(scene)
    outcomes = bench.simulate(scenes, duration=0.25, instants=2501, step=2e-5)
    source = "half sine: π √(I / k), ω₀ √(I / k)"
    for stiffness, outcome in zip(stiffnesses, outcomes, strict=True):
        name = f"k = {stiffness:.0e} N m/rad"
        scale = np.sqrt(ABOUT_HINGE / stiffness)
        closure, release = outcome.events[:, 0]
        swing = outcome.openings["O"]
        speed = (swing[-1] - swing[-2]) / (outcome.time[-1] - outcome.time[-2])
        bench.check(f"contact at, {name} (s)", closure, 0.1 / rate, 1e-3, "free flight")
        bench.check(f"time of contact, {name} (s)", release - closure, np.pi * scale, 1e-3, source)
        bench.check(f"deepest overlap, {name} (rad)", -swing.min(), rate * scale, 1e-3, source)
        bench.check(f"rate after contact, {name} (rad/s)", speed, rate, 1e-3, "elastic contact")


PENDULUM = """
points: {pivot: [0, 0, 0], c: [(0.5 m)*sin(ANGLE), 0, (-0.5 m)*cos(ANGLE)]}
bodies: {bob: {mass: 2, centre: c, points: [pivot], inertia: [0.3, 0.3, 0.3]}}
curves: {path: {times: TIMES, values: VALUES}}
drives:
  lead:
    {part: bob, at: pivot, velocity: WAY, translations: xz, rotations: none, curve: path}
supports: {plane: {part: bob, at: pivot, translations: y, rotations: none}}
gravity: [0, 0, -9.81]
record: {c: {part: bob, at: c}}
"""


def led_pendulum(bench: Bench) -> None:
    """A body whose point is led along x and z, free to turn about it: aside to and fro; and up and
    down so fast that it stands upright (Kapitza), where a slower motion lets it fall."""
    source = "Lagrange's equations in the momentum of the angle, DOP853"
    ramps = np.linspace(0.0, 2.0, 5), np.array([0.0, 1.0, -0.5, 0.7, 0.0])
    outcome = _check_pendulum(bench, "to and fro", 0.6, (2.0, 0.0, 0.5), ramps, source)
    force = outcome.columns["reaction_force", "lead z"]
    pull = 2 * outcome.columns["reaction_force", "lead x"] + 0.5 * force
    power = np.interp(outcome.time, *ramps) * pull
    bench.check("work of the drive (J)", np.trapezoid(power, outcome.time),
                outcome.energies["load_work"][-1] + MASS * 9.81 * outcome.points["c"][0][-1, 2]
                - MASS * 9.81 * outcome.points["c"][0][0, 2], 0.01,
                "reactions times velocities")  # fmt: skip
    times = np.linspace(0.0, 1.0, 801)
    for speed, stands in ((9.0, True), (1.0, False)):
        sway = times, np.sin(2 * np.pi * 40 * times)
        case = f"up and down with {speed:g} m/s"
        outcome = _check_pendulum(bench, case, np.pi - 0.1, (0.0, 0.0, speed), sway, source)
        pivot = speed * (1 - np.cos(2 * np.pi * 40 * outcome.time)) / (2 * np.pi * 40)
        height = (outcome.points["c"][0][:, 2] - pivot).min() / ARM
        bench.check(f"{case}, stands", float(height > 0.9), float(stands), 0.1,
                    "stands where (m d v)² / 2 > I m g d")  # fmt: skip


def _check_pendulum(bench: Bench, case: str, angle: float, velocity, curve, source: str):
    """Hold a led pendulum against Lagrange's equations, with steps that are halved."""
    words = {"ANGLE": f"{angle!r} rad", "TIMES": curve[0].tolist(), "VALUES": curve[1].tolist()}
    words["WAY"] = list(velocity)
    text = PENDULUM
    for word, value in words.items():
        text = text.replace(word, str(value))
    scene, duration = loads(text).build(), float(curve[0][-1])
    record = [("reaction_force", f"lead {axis}") for axis in "xz"]
    outcomes = [
        bench.simulate(scene, duration=duration, instants=101, step=step, record=record)[0]
        for step in duration / 800 / np.array([1, 2, 4])
    ]
    couple, weight = MASS * ARM, MASS * ARM * 9.81

    def slopes(time, y):
        shift, _, lift = np.interp(time, *curve) * np.array(velocity)
        sine, cosine = np.sin(y[0]), np.cos(y[0])
        rate = (y[1] - couple * (shift * cosine + lift * sine)) / ABOUT_HINGE
        return [rate, couple * rate * (lift * cosine - shift * sine) - weight * sine]

    times, longest = outcomes[0].time, float(np.diff(curve[0]).min())
    exact = solve_ivp(slopes, (0, duration), [angle, 0], "DOP853", times, rtol=1e-9, atol=1e-10,
                      max_step=longest).y[0]  # fmt: skip
    fine = np.linspace(0.0, duration, 8001)
    values = np.interp(fine, *curve)
    path = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(fine))])
    pivot = np.interp(times, fine, path)[:, None] * np.array(velocity)
    place = pivot + ARM * np.stack([np.sin(exact), 0 * exact, -np.cos(exact)], axis=1)
    errors = np.array([np.abs(o.points["c"][0] - place).max() for o in outcomes])
    bench.check_small(f"{case}, centre (m)", errors[-1] / ARM, 1e-3, source, "the arm")
    bench.check_at_least(f"{case}, order", observed_orders(errors).min(), 1.9, source)
    return outcomes[-1]


TROLLEY = """
parameters: {trolley: {value: 0.05, unit: kg}}
points: {o: [0, 0, 0], c: [0.5, 0, 0], tip: [1, 0, 0], rail: [1, 0, 2]}
bodies:
  panel: {mass: 2, centre: c, points: [o, tip], box: [1, 0.5, 0]}
  trolley: {mass: trolley, centre: rail, box: [0.1, 0.1, 0.1]}
joints:
  hinge: {type: revolute, parts: [ground, panel], at: o, axis: -y}
  rail: {type: prismatic, parts: [ground, trolley], at: rail, axis: x}
struts:
  cable: {type: constant force, between: [{part: trolley, at: rail}, tip], force: -9.81 N}
actions: {spring: {type: torsion spring, joint: hinge, stiffness: 0.3, rest: 80 deg}}
gravity: [0, 0, -9.81]
"""


def off_loaded_panel(bench: Bench) -> None:
    """A panel that a spring swings up, half its weight on a cable of constant force below a trolley
    on a rail: the panel and the trolley together, and how near that is to no weight at all."""
    structure, inertia, rest = loads(TROLLEY), 2 / 3, np.radians(80.0)
    scene, duration, trolley = structure.build(), 2.0, 0.05
    outcomes = [
        bench.simulate(scene, duration=duration, instants=101, step=step)[0]
        for step in (4e-3, 2e-3, 1e-3)
    ]

    def slopes(_, y):
        angle, place, rate, speed = y
        tip = np.array([np.cos(angle), np.sin(angle)])
        pull = np.array([1 + place, 2.0]) - tip
        pull *= 9.81 / np.hypot(*pull)
        moment = tip[0] * pull[1] - tip[1] * pull[0] - 2 * 9.81 * 0.5 * tip[0]
        return [rate, speed, (moment + 0.3 * (rest - angle)) / inertia, -pull[0] / trolley]

    times = outcomes[0].time
    exact = solve_ivp(slopes, (0, duration), np.zeros(4), "DOP853", times, rtol=1e-11, atol=1e-12).y
    source = "J t'' and m x'' of panel and trolley, DOP853"
    for joint, reference, noun in (("hinge", exact[0], "angle"), ("rail", exact[1], "way")):
        errors = np.array([np.abs(o.openings[joint] - reference).max() for o in outcomes])
        bench.check_small(f"{noun} at 1 ms", errors[-1], 1e-3, source, "1 rad, 1 m")
        bench.check_at_least(f"order of the {noun}", observed_orders(errors).min(), 1.9, source)
    weightless = rest * (1 - np.cos(np.sqrt(0.3 / inertia) * times))
    worst = np.abs(outcomes[-1].openings["hinge"] - weightless).max() / weightless.max()
    bench.check_small("angle off that without weight", worst, 0.05, "1 - cos(w t)", "the largest")


PROBLEMS = {
    "off-loaded panel": off_loaded_panel,
    "led pendulum": led_pendulum,
    "pendulum": pendulum,
    "contact bounce": contact_bounce,
}
