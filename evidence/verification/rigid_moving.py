"""Friction that sticks exactly, and motors that prescribe exactly: closed forms of a rod."""

import numpy as np

from deployable import fpm
from deployable.fpm.kinds import RigidFriction, RigidMotor
from evidence.verification.bench import Bench

G, L, STEP = 9.81, 1.0, 2e-4
J = L**2 / 3  # kg m² of 1 kg about the hinge
NONE = 1e-300  # m/s²: weight is there, and does nothing
AXIS = np.array([0.0, 0.0, 1.0])
TIMES = (0.0, 0.5003, 1.2, 2.0)


def rods(rate=0.0, moment=0.0, gravity=NONE, angle=0.0, turns=(0.0,) * 4) -> fpm.Scene:
    """A rod on friction, which turns at a rate (rad/s), and one on a motor; weight along -y."""
    scene = fpm.Scene("rods", gravity=(0.0, -gravity, 0.0))
    arm, aside = L / 2 * np.array([np.cos(angle), np.sin(angle), 0.0]), 5.0 * AXIS
    inertias = [[1.0] * 3, *[[0.1, J / 4, J / 4]] * 2]
    ground, one, two = scene.add_particles([0 * arm, arm, aside + arm], 1.0, inertias)
    scene.fix(ground)
    scene.spin[one], scene.velocity[one] = rate * AXIS, rate * np.cross(AXIS, arm)
    scene.add_hinge("rubs", (ground, one), 0 * arm, AXIS, opening=angle)
    scene.add_hinge("driven", (ground, two), aside, AXIS, opening=angle)
    scene.add(RigidMotor(1, angle, 1.0, scene.add_curve(TIMES, turns)))
    scene.add(RigidFriction(0, moment))
    return scene


def friction(bench: Bench) -> None:
    """It stops at J w²/(2 M) and stays; each swing against weight costs M times its way."""
    cases = {0.05: 0.5, 0.2: 1.0, 1.0: 2.0}
    scenes = [rods(rate, moment) for moment, rate in cases.items()]
    held = (0.99, 1.01)
    scenes += [rods(0.0, share * G / 2, G) for share in (1 / x for x in held)]
    scenes.append(rods(0.0, 0.3, G, 0.4))
    outcomes = bench.simulate(scenes, duration=6.0, instants=6001, step=STEP)
    for (moment, rate), outcome in zip(cases.items(), outcomes, strict=False):
        name, psi = f"M = {moment:g} N m", outcome.openings["rubs"]
        bench.check(f"stops at, {name} (rad)", psi[-1], J * rate**2 / (2 * moment), 1e-7,
                    "J w²/(2 M)")  # fmt: skip
        late = np.ptp(psi[outcome.time > J * rate / moment + 0.01])
        bench.check_small(f"moves afterwards, {name} (rad)", late, 1e-13, "it sticks", "1 rad")
        bench.check(f"lost, {name} (J)", outcome.energies["joint_loss"][-1], J * rate**2 / 2,
                    1e-6, "J w²/2")  # fmt: skip
    for share, outcome in zip(held, outcomes[3:5], strict=True):
        psi = outcome.openings["rubs"]
        if share < 1:
            worst = np.abs(psi).max()
            bench.check_small(f"falls under {share:g} M (rad)", worst, 1e-13, "it sticks", "1 rad")
        else:
            found, pull = 2 * psi[100] / outcome.time[100] ** 2, G / 2 / J
            bench.check(f"falls at, under {share:g} M (rad/s²)", found, (1 / share - 1) * pull,
                        1e-4, "(L - M)/J", pull, "of L/J")  # fmt: skip
    psi = outcomes[5].openings["rubs"]
    way = np.sign(np.diff(psi))
    turns = psi[1:-1][(way[1:] * way[:-1] < 0) & (np.abs(psi[1:-1] - psi[-1]) > 1e-3)]
    for k, (a, b) in enumerate(zip([0.4, *turns[:3]], turns[:4], strict=False), start=1):
        bench.check(f"swing {k}: energy over M (rad)", G / 2 * (np.sin(a) - np.sin(b)) / 0.3,
                    abs(a - b), 1e-4, "the way between its turns")  # fmt: skip
    worst = np.abs(outcomes[5].energies["balance"]).max() / (G / 2)
    bench.check_small("energy balance of the swings", worst, 1e-5, "no other loss", "m g l/2")
    figure = bench.figure("Swings against friction that sticks", "time (s)", "angle (rad)")
    figure.curve(outcomes[5].time, psi, "M = 0.3 N m")


def motors(bench: Bench) -> None:
    """Openings along curves with bends, their moments, and the work, blows among it."""
    for turns in ((0.0, 0.4, 0.1, 0.1), (0.0, 0.0, 1.5, -0.5)):
        (outcome,) = bench.simulate(rods(0.0, 1.0, G, turns=turns), duration=1.9, instants=1901,
                                    step=STEP)  # fmt: skip
        name, psi = f"curve to {turns[-1]:g}", outcome.openings["driven"]
        wanted = np.interp(outcome.time, TIMES, turns)
        bench.check_small(f"{name}: opening (rad)", np.abs(psi - wanted).max(), 1e-12,
                          "that prescribed", "1 rad")  # fmt: skip
        rates = np.diff(turns) / np.diff(TIMES)
        given = G / 2 * np.sin(psi[-1]) + J / 2 * (rates[-1] ** 2 - rates[0] ** 2)
        bench.check(f"{name}: work (J)", outcome.energies["motor_work"][-1], given, 1e-4,
                    "height, and speed less that at the start", G / 2, "of m g l/2")  # fmt: skip
        still = outcome.time > 1.3
        moment = outcome.recorded["motor_moment"].values[still, 0]
        worst = np.abs(moment - G / 2 * np.cos(psi[still])).max() / (G / 2)
        bench.check_small(f"{name}: moment at a constant rate", worst, 1e-6, "m g l/2 cos ψ",
                          "m g l/2")  # fmt: skip


PROBLEMS = {"rods on friction that sticks exactly": friction, "rods on rigid motors": motors}
