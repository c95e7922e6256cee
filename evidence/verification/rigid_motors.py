"""Friction that sticks exactly, and motors that prescribe exactly: closed forms of a rod."""

import numpy as np

import fpm
from evidence.verification.bench import Bench
from evidence.verification.mechanisms import on_ground, rod
from fpm.elements import Friction, Motor, TorsionSpring

G, L, STEP = 9.81, 1.0, 2e-4
J = L**2 / 3  # kg m² of 1 kg about the hinge
NEGLIGIBLE = 1e-300  # m/s², N m/rad: weight and spring are there, and do nothing
AXIS = np.array([0.0, 0.0, 1.0])
TIMES = (0.0, 0.5003, 1.2, 2.0)


def rods(rate=0.0, moment=0.0, gravity=NEGLIGIBLE, angle=0.0, turns=(0.0,) * 4,
         stiffness=NEGLIGIBLE) -> fpm.Scene:  # fmt: skip
    """A rod on friction and a spring (N m/rad), which turns at a rate (rad/s), and one on a motor;
    weight along -y."""
    scene = fpm.Scene("rods", gravity=(0.0, -gravity, 0.0))
    arm, offset = L / 2 * np.array([np.cos(angle), np.sin(angle), 0.0]), 5.0 * AXIS
    inertias = [[1.0] * 3, *[[0.1, J / 4, J / 4]] * 2]
    ground, first, second = scene.add_particles([0 * arm, arm, offset + arm], 1.0, inertias)
    scene.fix(ground)
    scene.spin[first], scene.velocity[first] = rate * AXIS, rate * np.cross(AXIS, arm)
    scene.add_hinge("rubs", (ground, first), 0 * arm, AXIS, opening=angle)
    scene.add_hinge("driven", (ground, second), offset, AXIS, opening=angle)
    scene.add(TorsionSpring(0, stiffness))
    scene.add(Motor(1, None, 0.0, angle, 1.0, scene.add_curve(TIMES, turns)))
    scene.add(Friction(0, moment, None))
    return scene


def friction(bench: Bench) -> None:
    """It stops at J w²/(2 M) and stays; each swing against weight costs M times its way."""
    cases = {0.05: 0.5, 0.2: 1.0, 1.0: 2.0}
    scenes = [rods(rate, moment) for moment, rate in cases.items()]
    ratios = (0.99, 1.01)
    scenes += [rods(0.0, share * G / 2, G) for share in (1 / x for x in ratios)]
    scenes.append(rods(0.0, 0.3, G, 0.4))
    outcomes = bench.simulate(scenes, duration=6.0, instants=6001, step=STEP)
    for (moment, rate), outcome in zip(cases.items(), outcomes, strict=False):
        name, psi = f"M = {moment:g} N m", outcome.openings["rubs"]
        bench.check(f"stops at, {name} (rad)", psi[-1], J * rate**2 / (2 * moment), 1e-7,
                    "J w²/(2 M)")  # fmt: skip
        motion = np.ptp(psi[outcome.time > J * rate / moment + 0.01])
        bench.check_small(f"moves afterwards, {name} (rad)", motion, 1e-13, "it sticks", "1 rad")
        bench.check(f"lost, {name} (J)", outcome.energies["joint_loss"][-1], J * rate**2 / 2,
                    1e-6, "J w²/2")  # fmt: skip
    for share, outcome in zip(ratios, outcomes[3:5], strict=True):
        psi = outcome.openings["rubs"]
        if share < 1:
            worst = np.abs(psi).max()
            bench.check_small(f"falls under {share:g} M (rad)", worst, 1e-13, "it sticks", "1 rad")
        else:
            fall, pull = 2 * psi[100] / outcome.time[100] ** 2, G / 2 / J
            bench.check(f"falls at, under {share:g} M (rad/s²)", fall, (1 / share - 1) * pull,
                        1e-4, "(L - M)/J", pull, "of L/J")  # fmt: skip
    psi = outcomes[5].openings["rubs"]
    direction = np.sign(np.diff(psi))
    turns = psi[1:-1][(direction[1:] * direction[:-1] < 0) & (np.abs(psi[1:-1] - psi[-1]) > 1e-3)]
    for k, (a, b) in enumerate(zip([0.4, *turns[:3]], turns[:4], strict=False), start=1):
        bench.check(f"swing {k}: energy over M (rad)", G / 2 * (np.sin(a) - np.sin(b)) / 0.3,
                    abs(a - b), 1e-4, "the way between its turns")  # fmt: skip
    worst = np.abs(outcomes[5].energies["balance"]).max() / (G / 2)
    bench.check_small("energy balance of the swings", worst, 1e-5, "no other loss", "m g l/2")


def oscillator(time, start, stiffness, moment):
    """Angle (rad) of a rod on a spring that is let go at `start`: each half swing is a cosine about
    ± moment/stiffness, so that the turns come closer by 2 moment/stiffness, and the last one stays.
    """
    w, shift = np.sqrt(stiffness / J), moment / stiffness
    count = int((start / shift - 1) // 2) + 1  # of half swings
    swing = np.minimum(time * w // np.pi, count)
    turn = (-1.0) ** swing * (start - 2 * shift * swing)
    centre = (-1.0) ** swing * shift
    angle = centre + (turn - centre) * np.cos(w * time - np.pi * swing)
    return np.where(swing == count, turn, angle)


def swings(bench: Bench) -> None:
    """A rod on a spring and friction: its way through every turn, to the second order."""
    stiffness, moment, start, steps = 10.0, 0.6, 1.0, (3.2e-3, 1.6e-3, 8e-4, 4e-4)
    scene = rods(0.0, moment, angle=start, stiffness=stiffness)
    errors = []
    for step in steps:
        (outcome,) = bench.simulate(scene, duration=6.4, instants=2001, step=step)
        psi = outcome.openings["rubs"]
        exact = oscillator(outcome.time, start, stiffness, moment)
        errors.append(np.abs(psi - exact).max())
    bench.check("stands at (rad)", psi[-1], exact[-1], 1e-6, "closed form", 1.0, "of 1 rad")
    bench.check_small("way, at most off (rad)", errors[-1], 2e-5, "closed form", "1 rad")
    order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    bench.check_at_least("order in the step", order, 1.9, "locates its turns within a step")


def motors(bench: Bench) -> None:
    """Openings along curves with bends, their moments, and the work, impacts among it."""
    for turns in ((0.0, 0.4, 0.1, 0.1), (0.0, 0.0, 1.5, -0.5)):
        (outcome,) = bench.simulate(rods(0.0, 1.0, G, turns=turns), duration=1.9, instants=1901,
                                    step=STEP)  # fmt: skip
        name, psi = f"curve to {turns[-1]:g}", outcome.openings["driven"]
        reference = np.interp(outcome.time, TIMES, turns)
        bench.check_small(f"{name}: opening (rad)", np.abs(psi - reference).max(), 1e-12,
                          "that prescribed", "1 rad")  # fmt: skip
        rates = np.diff(turns) / np.diff(TIMES)
        work = G / 2 * np.sin(psi[-1]) + J / 2 * (rates[-1] ** 2 - rates[0] ** 2)
        bench.check(f"{name}: work (J)", outcome.energies["motor_work"][-1], work, 1e-4,
                    "height, and speed less that at the start", G / 2, "of m g l/2")  # fmt: skip
        is_steady = outcome.time > 1.3
        moment = outcome.records["motor_moment"].values[is_steady, 0]
        worst = np.abs(moment - G / 2 * np.cos(psi[is_steady])).max() / (G / 2)
        bench.check_small(f"{name}: moment at a constant rate", worst, 1e-6, "m g l/2 cos ψ",
                          "m g l/2")  # fmt: skip


def rocker(crank):
    """Angle (rad) of the rocker of a spatial four-bar at that of its crank, by geometry."""
    x, y, z = 0.7 - 0.2 * np.cos(crank), 0.3 - 0.2 * np.sin(crank), 0.4
    return np.arctan2(z, y) - np.arccos((0.75 - x**2 - y**2 - z**2) / np.hypot(y, z))


def spatial_four_bar(coupler: float) -> fpm.Scene:
    """A crank on a motor, a coupler (kg) between two balls, and a rocker of 0.8 kg m²."""
    scene, ground = on_ground("spatial four-bar", (0.0, 0.0, 0.0))
    psi = rocker(0.0)
    ball = np.array([0.7, 0.3 + 0.5 * np.cos(psi), 0.4 + 0.5 * np.sin(psi)])
    crank = int(scene.add_particles((0.0, 0, 0), 1.0, 0.01)[0])
    link = rod(scene, (0.2, 0, 0), ball, 1e-3, coupler)
    swing = int(scene.add_particles((0.7, 0.3, 0.4), 1.0, 0.8)[0])
    scene.add_hinge("crank", (ground, crank), (0, 0, 0), AXIS)
    scene.add_hinge("rocker", (ground, swing), (0.7, 0.3, 0.4), (1, 0, 0), opening=psi)
    scene.add_joint("pin", "spherical", (crank, link), (0.2, 0, 0))
    scene.add_joint("ball", "spherical", (link, swing), ball)
    scene.add(Motor(0, None, 0.0, 0.0, 10.0, scene.add_curve([0.0, 1.0], [0.0, 1.0])))
    return scene


def light_coupler(bench: Bench) -> None:
    """The motor moves the rocker alone where the coupler has no mass: M = J ψ' ψ'' w²."""
    for step in (1e-3, 5e-4):
        (outcome,) = bench.simulate(spatial_four_bar(1e-6), duration=0.1, instants=101, step=step)
        angle, delta = 10 * outcome.time, 1e-3
        low, exact, high = (rocker(angle + k * delta) for k in (-1, 0, 1))
        moment = 0.8 * (high - low) / (2 * delta) * (high - 2 * exact + low) / delta**2 * 100
        result = outcome.records["motor_moment"].values[:, 0]
        name = f"step {1e3 * step:g} ms"
        worst = np.abs(outcome.openings["rocker"] - exact).max()
        bench.check_small(f"rocker, {name} (rad)", worst, 1e-8, "its geometry", "1 rad")
        worst = np.abs(result - moment).max() / np.abs(moment).max()
        bench.check_small(f"moment, {name}", worst, 3e-4, "J ψ' ψ'' w²", "the largest")
        bench.check(f"first moment, {name} (N m)", result[0], moment[0], 3e-4, "J ψ' ψ'' w²")


def by_rate(bench: Bench) -> None:
    """A mass that a motor accelerates evenly, by its rate."""
    for step in (1e-3, 2e-4, 1e-4, 1e-5):
        scene, ground = on_ground("lift", (0.0, 0.0, 0.0))
        mass = int(scene.add_particles((0.0, 0, 0), 10.0, 1.0)[0])
        scene.add_slide("rail", (ground, mass), (0, 0, 0), (1, 0, 0))
        ramp = scene.add_curve([0.0, 1.0, 2.0], [0.0, 1.0, 0.0])
        scene.add(Motor(0, None, 0.0, 0.0, 1.0, ramp, by_rate=True))
        (outcome,) = bench.simulate(scene, duration=400 * step, instants=401, step=step)
        force = outcome.records["slide_motor_force"].values[:, 0]
        worst = np.abs(force - 10.0).max() / 10.0
        bench.check_small(f"force, step {1e3 * step:g} ms", worst, 1e-9, "m a", "10 N")


PROBLEMS = {
    "rods on friction that sticks exactly": friction,
    "rod on a spring and friction that sticks exactly": swings,
    "rods on rigid motors": motors,
    "coupler of nearly no mass": light_coupler,
    "motor by its rate": by_rate,
}
