"""Slides and universal joints, and what acts on them: closed forms of rigid bodies."""

import numpy as np
from scipy.integrate import solve_ivp

import fpm
from evidence.verification.bench import Bench
from fpm.elements import Damper, Friction, Latch, Motor, Release, Stop

G = 9.81  # m/s², along -y
X, Y = np.eye(3)[:2]
SLOPE = np.array([0.6, 0.64, 0.48])
J = np.array([0.02, 0.03, 0.05])  # kg m²
FREE = (2.0, 1.0)  # kg, of two bodies that nothing else holds
MASS_RATIO = 2.0 / 3.0


def _ground(name: str) -> fpm.Scene:
    scene = fpm.Scene(name, gravity=(0.0, -G, 0.0))
    scene.fix(scene.add_particles((0.0, 0.0, 0.0), 1.0, 1.0))
    return scene


def _block(scene, name: str, axis=X, mass=1.0, speed=0.0, opening=0.0) -> int:
    """A block on a slide of the ground, its centre beside the axis."""
    place = np.array([0.0, 0.0, 1.0 + len(scene.position)])
    (block,) = scene.add_particles(place + 0.1, mass, J, velocity=speed * axis)
    return scene.add_slide(name, (0, block), place, axis, opening)


def _pair(scene, name: str, speed: float) -> int:
    """Two bodies that fall freely; the second slides along x on the first."""
    place = np.array([0.0, 0.0, 1.0 + len(scene.position)])
    first, second = scene.add_particles([place, place + 0.3 * X], FREE, J)
    scene.velocity[second] = speed * X
    return scene.add_slide(name, (first, second), place + 0.2 * X, X)


def _add_cross(scene, name: str, spin) -> int:
    """A body on a cross at its centre, about x of the ground and y of its own."""
    place = np.array([0.0, 0.0, 1.0 + len(scene.position)])
    (body,) = scene.add_particles(place, 1.0, J, spin=spin)
    return scene.add_universal(name, (0, body), place, X, Y)


def scene_of_all(speed=1.0) -> fpm.Scene:
    """What acts on slides and crosses, one on each, in one scene: one loop serves for all.

    speed (m/s): of the block that meets a stop."""
    scene = _ground("slides")
    swing = _block(scene, "swing", SLOPE, 2.0, 0.3, 0.05)
    scene.add_torsion_spring(swing, 50.0, 0.2)
    scene.add(Damper(swing, 1.5))
    scene.add_torsion_spring(_pair(scene, "pair", 0.5), 60.0, 0.1)
    scene.add(Latch(_block(scene, "latched", X, 2.0, 1.0), 0.3, 800.0))
    scene.add(Stop(_block(scene, "stopped", X, 2.0, speed), 0.3, "above", 800.0))
    scene.add(Friction(_block(scene, "rubbed", X, 2.0, 1.0), 3.0, 1e-5))
    for name, spin in (("first", X), ("second", Y)):
        cross = _add_cross(scene, name, 2.0 * spin)
        scene.add_torsion_spring(cross, 0.2)
        scene.add_torsion_spring(cross + 1, 0.5)
    joint = _add_cross(scene, "both", 0.01 * X + 0.02 * Y)
    scene.add_torsion_spring(joint, 0.2)
    scene.add_torsion_spring(joint + 1, 0.5)
    # A bead on a rod that turns freely about y.
    place = np.array([0.0, 0.0, 1.0 + len(scene.position)])
    rod, bead = scene.add_particles([place, place + 0.4 * X], [1.0, 0.5], [J, J])
    scene.spin[[rod, bead]], scene.velocity[bead] = 3.0 * Y, 0.4 * np.cross(3.0 * Y, X)
    scene.add_hinge("axle", (0, rod), place, Y)
    scene.add_torsion_spring(scene.add_slide("bead", (rod, bead), place, X, 0.4), 20.0, 0.4)
    # What holds exactly.
    scene.add(Latch(_pair(scene, "caught", 1.0), 0.5))
    cross = _add_cross(scene, "crossed", 2.0 * Y)
    scene.add(Latch(cross + 1, 0.7))
    fall = np.array([0.0, -1.0, 0.0])
    scene.add(Release(_block(scene, "let_go", fall), time=0.40005))
    times = np.linspace(0.0, 1.0, 10001)
    ramp = scene.add_curve(times, 0.5 - 0.5 * np.cos(np.pi * times))
    scene.add(Motor(_block(scene, "driven", X, 2.0), None, 0.0, 0.0, 0.8, ramp))
    return scene


def slides(bench: Bench) -> None:
    """Springs, dampers, stops, latches and friction on slides, springs on crosses; latches,
    releases and motors that hold exactly."""
    (outcome,) = bench.simulate(scene_of_all(), duration=2.0, instants=2001, step=1e-4)
    time, opening = outcome.time, outcome.openings

    def curve(name, exact, tolerance, source):
        size = np.abs(exact).max()
        worst = np.abs(opening[name] - exact).max() / size
        bench.check_small(f"{name}: opening", worst, tolerance, source, "the largest")

    mass, stiffness, damping = 2.0, 50.0, 1.5
    omega, rest = np.sqrt(stiffness / mass), 0.2 - mass * G * SLOPE[1] / stiffness
    decay = damping / (2 * mass)
    omega_d = np.sqrt(omega**2 - decay**2)
    start = 0.05 - rest
    cosine, sine = np.cos(omega_d * time), np.sin(omega_d * time)
    exact = start * cosine + (0.3 + decay * start) / omega_d * sine
    exact = rest + np.exp(-decay * time) * exact
    curve("swing", exact, 1e-6, "m s'' = -k (s - l) - c s' + m g·a")
    omega = np.sqrt(60.0 / MASS_RATIO)
    exact = 0.1 * (1 - np.cos(omega * time)) + 0.5 / omega * np.sin(omega * time)
    curve("pair", exact, 1e-5, "ω² = k (1/m + 1/M)")
    for name, k, inertia in (("first_axis", 0.2, J[0]), ("second_other", 0.5, J[1])):
        omega = np.sqrt(k / inertia)
        curve(name, 2.0 / omega * np.sin(omega * time), 1e-5, "J φ'' = -k φ")
    for rate, k, inertia, end in ((0.01, 0.2, J[0], "axis"), (0.02, 0.5, J[1], "other")):
        omega = np.sqrt(k / inertia)
        curve(f"both_{end}", rate / omega * np.sin(omega * time), 1e-3, "both small")

    omega = np.sqrt(800.0 / 2.0)
    exact = np.where(time < 0.3, time, 0.3 + np.sin(omega * (time - 0.3)) / omega)
    curve("latched", exact, 1e-6, "m s'' = -k (s - s_c) from s_c on")
    impulse = outcome.records["slide_latch_impulse"].values[:, 0]
    exact = np.where(time < 0.3, 0.0, 2.0 * (np.cos(omega * (time - 0.3)) - 1.0))
    bench.check_small("latched: impulse", np.abs(impulse - exact).max() / 4.0, 1e-3,
                      "m (s' - v)", "2 m v")  # fmt: skip
    free = 0.3 + np.pi / omega
    exact = np.where(time < free, np.where(time < 0.3, time, exact * 0 + 0.3), 0.3 - (time - free))
    contact = (time >= 0.3) & (time < free)
    exact[contact] += np.sin(omega * (time[contact] - 0.3)) / omega
    curve("stopped", exact, 1e-6, "m s'' = -k (s - s_c) beyond s_c")
    stand = opening["rubbed"][-1]
    bench.check("rubbed: comes to rest at (m)", stand, 2.0 / (2 * 3.0), 1e-4, "m v²/(2 F)")
    drift = np.ptp(opening["rubbed"][time > 1.5])
    bench.check_small("rubbed: moves then (m)", drift, 1e-9, "it sticks", "1 m")

    def motion(_, state):
        s, rate = state
        inertia = 2 * J[1] + 0.5 * s**2
        spin = 3.0 * (2 * J[1] + 0.5 * 0.4**2) / inertia
        return [rate, s * spin**2 - 20.0 / 0.5 * (s - 0.4)]

    exact = solve_ivp(motion, (0, 2), (0.4, 0.0), t_eval=time, rtol=1e-11, atol=1e-12).y[0]
    curve("bead", exact, 1e-5, "m s'' = m s w² - k (s - l), L = w (J + m s²)")
    _check_exact_holds(bench, outcome)
    worst = np.abs(outcome.energies["balance"]).max() / outcome.energies["kinetic"].max()
    bench.check_small("energy balance", worst, 1e-6, "what is lost is counted", "most kinetic")


def _check_exact_holds(bench: Bench, outcome: fpm.Outcome) -> None:
    """Latches, releases and motors that hold slides and crosses exactly."""
    time, opening, records = outcome.time, outcome.openings, outcome.records
    is_caught = time >= 0.5
    exact = np.where(is_caught, 0.5, time)
    bench.check_small("caught: opening (m)", np.abs(opening["caught"] - exact).max(), 1e-9,
                      "v t, then held", "1 m")  # fmt: skip
    impulse = records["slide_latch_impact"].values[-1, 0]
    bench.check("caught: impulse (N s)", impulse, -MASS_RATIO, 1e-6, "-v m M/(m + M)")
    angle = np.minimum(2.0 * time, 0.7)
    worst = np.abs(opening["crossed_other"] - angle).max()
    bench.check_small("crossed: angle (rad)", worst, 1e-9, "w t, then held", "1 rad")
    impulse = records["latch_impact"].values[-1, 0]
    bench.check("crossed: impulse (N m s)", impulse, -2.0 * J[1], 1e-6, "-J w")
    exact = np.where(time < 0.40005, 0.0, G * (time - 0.40005) ** 2 / 2)
    bench.check_small("let go: falls by (m)", np.abs(opening["let_go"] - exact).max(), 1e-6,
                      "g t²/2", "1 m")  # fmt: skip
    exact = 0.4 * (1 - np.cos(np.pi * np.minimum(time, 1.0)))
    bench.check_small("driven: opening (m)", np.abs(opening["driven"] - exact).max(), 1e-6,
                      "the curve", "1 m")  # fmt: skip
    force, pull = records["slide_motor_force"].values[:, 0], 2.0 * 0.4 * np.pi**2
    exact = pull * np.cos(np.pi * time)
    middle = (time > 0.01) & (time < 0.99)
    worst = np.abs(force - exact)[middle].max() / pull
    bench.check_small("driven: force", worst, 1e-3, "m s''", "the largest")
    work = outcome.energies["motor_work"]
    exact = 2.0 * (0.4 * np.pi * np.sin(np.pi * np.minimum(time, 1.0))) ** 2 / 2
    worst = np.abs(work - exact).max() / exact.max()
    bench.check_small("driven: work", worst, 1e-3, "m s'²/2", "the largest")


PROBLEMS = {"slides and crosses with what acts on them": slides}
