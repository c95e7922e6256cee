"""Large rotations: rigid motion without strain, the tumbling body, the heavy top."""

import numpy as np

import fpm
from evidence.verification.bench import Bench, observed_orders
from evidence.verification.momentum import drift, momenta, motion, watch

MATERIAL = fpm.Material(1e9, 0.3, 1000.0)
SECTION = fpm.Section.rectangle(0.03, 0.02)


def lead(scene: fpm.Scene, spins, path, times) -> None:
    """Prescribe a rigid motion of all particles, step by step.

    spins (n, 3) rad/s about the global axes, turned one after another in each step; path (n+1, 3) m
    of the global origin; times (n,) s: the middles of the steps."""
    from scipy.spatial.transform import Rotation

    step = times[1] - times[0]
    turn, places = Rotation.identity(), [scene.position + path[0]]
    for spin, origin in zip(spins, path[1:], strict=True):
        for axis in np.diag(spin * step):
            turn = Rotation.from_rotvec(axis) * turn
        places.append(turn.apply(scene.position) + origin)
    velocity = np.diff(places, axis=0) / step
    scene.position = places[0]
    # A step takes the mean of a curve: stairs have that of each.
    edges = times[:, None] + step * np.array([-0.5 + 1e-10, 0.5 - 1e-10])

    def stairs(rates: np.ndarray) -> int:
        return scene.add_curve(edges.ravel(), np.repeat(rates, 2))

    spin_curves = [stairs(spins[:, k]) for k in range(3)]
    for p in range(len(scene.position)):
        for k, axis in enumerate(np.eye(3)):
            # A particle's place follows chords, so its velocity has a curve for each component.
            scene.drive(p, velocity=axis, curve=stairs(velocity[:, p, k]))
            scene.drive(p, spin=axis, curve=spin_curves[k])


def rigid_motion(bench: Bench) -> None:
    """Any rigid motion, however large, leaves elements without force and strain energy."""
    steps, duration = 1000, 1.0
    times = (np.arange(steps) + 0.5) * duration / steps
    rates = np.sin(3 * times) + 1, np.cos(5 * times) - 0.5, np.sin(7 * times + 1)
    spins = 15.0 * np.column_stack(rates)
    ends = np.linspace(0.0, duration, steps + 1)[:, None]
    path = np.hstack([20 * ends**2, 5 * np.sin(4 * ends), -7 * ends])
    corners = {
        "one element": [(0.1, 0.2, 0.3), (0.4, 0.3, 0.1)],
        "chain of 6 elements": [
            (0, 0, 0), (0.3, 0, 0), (0.3, 0.2, 0), (0.3, 0.2, 0.4), (0.5, 0.1, 0.5),
            (0.9, 0.1, 0.5), (1.0, 0.5, 0.1),
        ],
    }  # fmt: skip
    for name, places in corners.items():
        scene = fpm.Scene(name)
        particles = scene.add_particles(places, 1.0, 1.0)
        nodes = np.column_stack([particles[:-1], particles[1:]])
        scene.add_beams(nodes, SECTION, MATERIAL, (0.3, 0.4, -0.86))
        lead(scene, spins, path, times)
        # There is no energy that the balance could be held against.
        (outcome,) = bench.simulate(
            scene, duration=duration, instants=steps + 1, step=duration / steps,
            energy_tolerance=1e30,
        )  # fmt: skip
        length = sum(b.length.sum() for b in scene.beams)
        stiffness = MATERIAL.E * SECTION.A
        strain = np.sqrt(2 * outcome.energies["strain"].max() / (stiffness * length))
        distance = np.linalg.norm(np.diff(path, axis=0), axis=1).sum() * len(particles)
        kinetic = outcome.energies["kinetic"]  # drives give the particles theirs, too
        work = outcome.energies["load_work"] - (kinetic - kinetic[0])
        force = np.abs(work).max() / distance / stiffness
        source = "rigid motion: no strain"
        bench.check_small(f"{name}: strain, from the largest energy", strain, 1e-12, source, "1")
        bench.check_small(f"{name}: mean force, from its work", force, 1e-12, source, "EA")

    # Free: flying along a slanted line and spinning about it, slower than its lowest bending mode
    # (129 rad/s): a shaft that is not square whirls by itself between its two critical speeds.
    direction = np.array([2.0, -1.0, 2.0]) / 3
    scene = fpm.Scene("arrow")
    bar = scene.add_link((0, 0, 0), direction, (0, 0, 1), SECTION, MATERIAL, 4)
    scene.velocity[bar.particles] = 30 * direction
    scene.spin[bar.particles] = 100 * direction
    watch(scene)
    (outcome,) = bench.simulate(scene, duration=1.0, instants=101)
    for name, track in (("velocity", 1), ("spin", 3)):
        worst = max(drift(motion(outcome, p)[track]) for p in bar.particles)
        bench.check_small(f"arrow: change of {name}", worst, 1e-10, "no force on it", name)


def tumble(bench: Bench) -> None:
    """A free body spinning about its middle axis turns over again and again (Dzhanibekov)."""
    inertia, spin = np.array([1.0, 2.0, 3.0]), np.array([0.01, 5.0, 0.01])
    scene = fpm.Scene("tumbling body")
    scene.add_particles((0, 0, 0), 1.0, inertia, spin=spin)
    watch(scene)
    flips = []
    for step in (1e-3, 5e-4, 2.5e-4):
        (outcome,) = bench.simulate(scene, duration=20.0, instants=4001, step=step)
        *_, frame, rate = motion(outcome, 0)
        local = np.einsum("tji,tj->ti", frame, rate)
        flips.append(crossings(outcome.time, local[:, 1]))
    time = outcome.time
    first, *_, last = flips[-1] if len(flips[-1]) > 1 else (np.nan, np.nan)
    exact_time = euler_top(inertia, spin, time)
    source = "Euler's equations (DOP853, 1e-12)"
    bench.check("first flip (s)", first, 2.742, 1e-3, "required; " + source)
    bench.check("first flip (s), own reference", first, exact_time[0], 1e-3, source)
    bench.check("last flip in 20 s (s)", last, exact_time[-1], 1e-3, source)
    bench.check("flips in 20 s", len(flips[-1]), 4, 0, "required; " + source, 1.0, "absolute")
    orders = observed_orders([abs(f[-1:].sum() - exact_time[-1]) for f in flips])
    bench.check_at_least("order of the last flip in the time step", orders[-1], 1.8, "order 2")
    angular = momenta(outcome)[1]
    bench.check_small("drift of the angular momentum", drift(angular), 1e-12, "free body", "it")
    energy = outcome.energies["kinetic"]
    worst = np.abs(energy - energy[0]).max() / energy[0]
    bench.check_small("energy off its start", worst, 1e-4, "free body", "the energy")


def crossings(time, values) -> np.ndarray:
    """Times (k,) at which a track (t,) changes sign, by linear interpolation."""
    i = np.flatnonzero(values[:-1] * values[1:] < 0)
    return time[i] - values[i] * (time[i + 1] - time[i]) / (values[i + 1] - values[i])


def euler_top(inertia, spin, time):
    """Times of the sign changes of the second body rate of a free body."""
    from scipy.integrate import solve_ivp

    def rate(_t, w):
        return np.cross(inertia * w, w) / inertia

    options = {"rtol": 1e-12, "atol": 1e-13, "events": lambda _t, w: w[1]}
    return solve_ivp(rate, (0, time[-1]), spin, "DOP853", time, **options).t_events[0]


def heavy_top(bench: Bench) -> None:
    """A symmetric top under gravity, started on its two steady precessions."""
    transverse, polar, spin, moment, tilt = 5.0, 1.0, 50.0, 20.0, 0.3
    # J1 cos(tilt) p^2 - J3 w3 p + m g l = 0
    rates = np.sort(np.roots([transverse * np.cos(tilt), -polar * spin, moment]))
    axis = np.array([np.sin(tilt), 0, np.cos(tilt)])
    scenes = []
    for rate in rates:
        scene = fpm.Scene("heavy top")
        frame = np.column_stack([np.cross((0, 1, 0), axis), (0, 1, 0), axis])
        total = rate * np.array([0, 0, 1.0]) + (spin - rate * np.cos(tilt)) * axis
        inertia = transverse, transverse, polar
        top = scene.add_particles((0, 0, 0), 1.0, inertia, frame=frame, spin=total)
        scene.fix(top, "xyz", "")
        scene.add_load(top[0], force=(0, 0, -moment), arm=axis)
        scene.add_point("tip", top[0], axis)
        scenes.append(scene)
    duration = 5.0 if bench.quick else 20.0
    outcomes = bench.simulate(scenes, duration=duration, instants=2001, step=2e-4)
    columns = ("slow", "fast"), rates, (0.4166, 10.05), outcomes
    for name, rate, published, outcome in zip(*columns, strict=True):
        tip = outcome.points["tip"][0]
        azimuth = np.unwrap(np.arctan2(tip[:, 1], tip[:, 0]))
        speed = np.polyfit(outcome.time, azimuth, 1)[0]
        source = "J1 cos θ p² − J3 ω3 p + m g l = 0 (steady precession)"
        bench.check(f"{name} precession (rad/s)", speed, rate, 1e-3, source)
        bench.check(f"{name} precession, to the printed digits (rad/s)", speed, published, 1e-3,
                    "required; " + source)  # fmt: skip
        lean = np.arccos(tip[:, 2])
        bench.check_small(f"{name} precession: nutation", np.ptp(lean) / tilt, 1e-3, source, "θ")


def pull_rod(bench: Bench) -> None:
    """A free rod, pulled by its tip: a pendulum about its centre, which falls evenly."""
    from scipy.integrate import solve_ivp

    force, inertia = 10.0, 1 / 12
    scene = fpm.Scene("pulled rod")
    rod = int(scene.add_particles((0.0, 0, 0), 1.0, (0.01, inertia, inertia))[0])
    scene.add_load(rod, force=(0, -force, 0), arm=(0.5, 0, 0))
    scene.add_point("tip", rod, (0.5, 0, 0))

    def slopes(_, y):
        return [y[1], -0.5 * force / inertia * np.cos(y[0])]

    exact = solve_ivp(slopes, (0.0, 0.4), [0.0, 0.0], "DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    work = force * (0.5 * force * 0.4**2 - 0.5 * np.sin(exact[0]))
    errors = []
    for step in (4e-3, 2e-3, 1e-3):
        (outcome,) = bench.simulate(scene, duration=0.4, instants=101, step=step)
        name, energies = f"step {1e3 * step:g} ms", outcome.energies
        errors.append(np.abs(energies["balance"]).max())
        bench.check(f"work of the pull, {name} (J)", energies["load_work"][-1], work,
                    100 * step**2, "F (F t²/2m - l/2 sin θ), J θ'' = -F l/2 cos θ")  # fmt: skip
    order = observed_orders(errors).min()
    bench.check_at_least("order of the energy balance", order, 1.95, "leapfrog")


PROBLEMS = {
    "rigid motion": rigid_motion,
    "tumbling body": tumble,
    "heavy top": heavy_top,
    "pulled rod": pull_rod,
}
