"""Flexible bars in large motion: spin-up, right-angle cantilever, flying beam, free bodies."""

from functools import cache

import numpy as np

import fpm
from evidence.verification.bench import Bench
from evidence.verification.momentum import drift, momenta, watch
from fpm.elements.bars.beam import lump


def spin_angle(time) -> tuple[np.ndarray, np.ndarray]:
    """Prescribed angle (rad) and rate (rad/s) of the spin-up at times (n,)."""
    w = 2 * np.pi / 15
    is_ramp = time < 15
    angle = 6 / 15 * (time**2 / 2 + (np.cos(w * time) - 1) / w**2)
    rate = 6 / 15 * (time - np.sin(w * time) / w)
    return np.where(is_ramp, angle, 6 * time - 45), np.where(is_ramp, rate, 6.0)


def spin_up(bench: Bench) -> None:
    """A cantilever whose root is spun up to 6 rad/s in 15 s (Simo and Vu-Quoc)."""
    length, elements = 10.0, 10
    # EA = 2.8e7, EI = 1.4e4, rho A = 1.2, rho I = 6e-4
    section = fpm.Section(A=1.0, Iy=5e-4, Iz=5e-4, J=1e-3)
    scene = fpm.Scene("spin-up")
    material = fpm.Material(2.8e7, 0.3, 1.2)
    bar = scene.add_link((0, 0, 0), (length, 0, 0), (0, 0, 1), section, material, elements)
    times = np.linspace(0, 15.0, 1501)
    root = int(bar.particles[0])
    scene.drive(root, spin=(0, 0, 1.0), curve=scene.add_curve(times, spin_angle(times)[1]))
    scene.fix(bar.particles[1:], "z", "xy")
    scene.add_point("tip", int(bar.particles[-1]))
    scene.add_point("root axis", root, (1, 0, 0))
    duration = 20.0
    (outcome,) = bench.simulate(scene, duration=duration, instants=2001)
    axis, tip = (outcome.points[name][0] for name in ("root axis", "tip"))
    angle = np.unwrap(np.arctan2(axis[:, 1], axis[:, 0]))
    stretches = tip[:, 0] * np.cos(angle) + tip[:, 1] * np.sin(angle) - length
    lag = -tip[:, 0] * np.sin(angle) + tip[:, 1] * np.cos(angle)
    time = outcome.time
    source = "Simo and Vu-Quoc, J. Appl. Mech. 53 (1986) 855"
    row = np.argmin(lag)
    bench.check("largest tip lag (m)", lag[row], -0.574, 0.01, source)
    bench.check("time of the largest lag (s)", time[row], 6.76, 0.01, source)
    _, exact = linear_spin_up(length, 1.4e4, 1.2)
    bench.check("largest tip lag (m), own reference", lag[row], exact.min(), 0.01,
                "second-order rotating beam, 6 modes, DOP853")  # fmt: skip
    steady = stretches[time > 15.0].mean()
    stretch = 1.2 * 36 * length**3 / (3 * 2.8e7)
    bench.check("steady stretch (m)", steady, 5.143e-4, 0.01, "ρA ω² L³ / (3 EA); " + source)
    bench.check("steady stretch (m), closed form", steady, stretch, 0.01, "ρA ω² L³ / (3 EA)")
    rotation = spin_angle(time)[0]
    worst = np.abs(angle - rotation).max()
    bench.check_small("angle of the root (rad)", worst, 1e-4, "prescribed", "1")


@cache
def linear_spin_up(length, EI, line_mass, modes=6):
    """Time (n,) s and tip lag (n,) m of the spun-up cantilever by its bending modes.

    Deflections v in the rotating frame, to second order in the energies: centrifugal stiffening
    ρA ω²/2 (L² − x²) v'²/2 against the softening ρA ω² v²/2, driven by −ρA x dω/dt. Source: Kane,
    Ryan, Banerjee, J. Guidance 10 (1987) 139 (the same terms)."""
    from scipy.integrate import solve_ivp
    from scipy.optimize import brentq

    middles = np.pi * (np.arange(modes) + 0.5)
    roots = [brentq(lambda b: np.cos(b) * np.cosh(b) + 1, m - 0.4, m + 0.4) for m in middles]
    s, weights = np.polynomial.legendre.leggauss(200)
    s, weights = (s + 1) / 2, weights / 2
    shapes, slopes, tips = [], [], []
    for b in roots:
        c = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))

        def shape(x, b=b, c=c):
            return np.cosh(b * x) - np.cos(b * x) - c * (np.sinh(b * x) - np.sin(b * x))

        shapes.append(shape(s))
        slopes.append(b * (np.sinh(b * s) + np.sin(b * s) - c * (np.cosh(b * s) - np.cos(b * s))))
        tips.append(shape(1.0))
    shapes, slopes, tips = np.array(shapes), np.array(slopes), np.array(tips)
    mass = shapes * weights @ shapes.T
    geometric = slopes * (weights * (1 - s**2) / 2) @ slopes.T
    drive = shapes @ (weights * s) * length
    bending = np.array(roots) ** 4 * EI / (line_mass * length**4) * np.diag(mass)

    def rate(t, y):
        q, v = y[:modes], y[modes:]
        spin = spin_angle(np.array(t))[1]
        push = 6 / 15 * (1 - np.cos(2 * np.pi * t / 15)) if t < 15 else 0.0
        force = -bending * q - spin**2 * (geometric - mass) @ q - push * drive
        return np.concatenate([v, np.linalg.solve(mass, force)])

    time = np.linspace(0, 20, 401)
    solution = solve_ivp(rate, (0, 20), np.zeros(2 * modes), "DOP853", time, rtol=1e-7, atol=1e-9)
    return time, tips @ solution.y[:modes]


ELBOW_SOURCE = "Simo and Vu-Quoc, CMAME 66 (1988) 125"


def elbow_scene(elements: int) -> fpm.Scene:
    """Right-angle cantilever: leg along x clamped at the origin, leg along y, pushed along z.

    EA = 1e6, EI = GJ = 1e3, rho A = 1, rho I = 10, each leg 10 long; the rotational inertia is no
    section's, so stiffness and masses come from two sections."""
    length = 10.0
    elastic, heavy = fpm.Section(1.0, 1e-3, 1e-3, 2e-3), fpm.Section(1.0, 10.0, 10.0, 20.0)
    material = fpm.Material(1e6, 0.0, 1.0)
    mass, inertia = lump(length, elements, heavy, material)
    along_y = inertia[:, [1, 0, 2]]  # the second leg's own axis is y
    steps = np.linspace(0, length, elements + 1)[:, None]
    first, second = steps * np.array([1.0, 0, 0]), [length, 0, 0] + steps * np.array([0, 1.0, 0])
    scene = fpm.Scene("right-angle cantilever")
    particles = scene.add_particles(
        np.vstack([first, second[1:]]),
        np.concatenate([mass[:-1], [mass[-1] + mass[0]], mass[1:]]),
        np.vstack([inertia[:-1], inertia[-1] + along_y[0], along_y[1:]]),
    )
    nodes = np.column_stack([particles[:-1], particles[1:]])
    scene.add_beams(nodes[:elements], elastic, material, (0, 0, 1), "first leg")
    scene.add_beams(nodes[elements:], elastic, material, (0, 0, 1), "second leg")
    scene.fix(particles[0])
    push = scene.add_curve([0, 1, 2], [0, 50, 0])
    scene.add_load(elements, force=(0, 0, 1.0), curve=push)
    scene.add_point("elbow", elements)
    scene.add_point("tip", 2 * elements)
    return scene


def elbow(bench: Bench) -> None:
    """Right-angle cantilever pushed out of its plane: bending and torsion in large motion."""
    scene = elbow_scene(10 if bench.quick else 20)
    (outcome,) = bench.simulate(scene, duration=30.0, instants=3001)
    time, (tip, knee) = outcome.time, (outcome.points[p][0][:, 2] for p in ("tip", "elbow"))
    extremes = (
        ("first peak of the tip", tip, 1, (0, 12), 8.25, 7.44),
        ("trough of the tip", tip, -1, (10, 20), -9.73, 15.87),
        ("trough of the elbow", knee, -1, (8, 14), -4.06, 10.87),
    )
    for name, track, sign, (start, end), value, instant in extremes:
        window = np.flatnonzero((time > start) & (time < end))
        row = window[np.argmax(sign * track[window])]
        bench.check(f"{name} (m)", track[row], value, 0.03, ELBOW_SOURCE)
        bench.check(f"{name}, time (s)", time[row], instant, 0.15, ELBOW_SOURCE, 1.0, "absolute")


FLYING_SOURCE = "Simo and Vu-Quoc, J. Appl. Mech. 53 (1986) 849 and 855 (EI = 500)"


def flying_beam(bench: Bench) -> None:
    """A free inclined beam, pushed and turned at one end for 2.5 s, then free (in the plane)."""
    length, stop, duration, edge = 10.0, 2.5, 5.0, 1e-5
    elements = 10 if bench.quick else 20
    elastic, heavy = fpm.Section(1.0, 0.05, 0.05, 0.1), fpm.Section(1.0, 10.0, 10.0, 20.0)
    material = fpm.Material(1e4, 0.0, 1.0)
    lower, upper = np.array([6.0, 0, 0]), np.array([0, 8.0, 0])
    mass, inertia = lump(length, elements, heavy, material)
    scene = fpm.Scene("flying beam")
    steps = np.linspace(0, 1, elements + 1)[:, None]
    particles = scene.add_particles(lower + steps * (upper - lower), mass, inertia[:, [1, 1, 2]])
    nodes = np.column_stack([particles[:-1], particles[1:]])
    scene.add_beams(nodes, elastic, material, (0, 0, 1), "beam")
    # Half the load at the last instant of its time, so that the steps add up to the exact impulse.
    curve = scene.add_curve([stop - edge, stop + edge], [1.0, 0.0])
    force, moment = np.array([8.0, 0, 0]), np.array([0, 0, -80.0])
    scene.add_load(particles[0], force=force, moment=moment, curve=curve)
    watch(scene)
    (outcome,) = bench.simulate(scene, duration=duration, instants=501)
    time = outcome.time
    linear, angular, centre = momenta(outcome)
    push_time = np.minimum(time, stop)[:, None]
    expected = force * push_time
    area = push_time**2 / 2 + push_time * (time[:, None] - push_time)
    middle = (lower + upper) / 2 + force / mass.sum() * area
    source = "impulse and motion of the centre of mass"
    smooth = np.abs(time - stop) > 1e-9  # a mean of two half steps stands at the jump itself
    worst = np.abs(linear - expected)[smooth].max() / np.abs(expected).max()
    bench.check_small("linear momentum", worst, 1e-10, source, "its largest")
    worst = np.abs(centre - middle).max() / length
    bench.check_small("centre of mass", worst, 1e-10, source, "L")
    free = smooth & (time > stop)
    bench.check_small("angular momentum once free", drift(angular[free]), 1e-10, source, "it")
    ends = [outcome.points[f"{p}"][0][-1] for p in (particles[0], particles[-1])]
    names, places = ("pushed end", "other end"), ((5.623, 4.767), (15.413, 4.259))
    for name, end, published in zip(names, ends, places, strict=True):
        for axis, value, reference in zip("xy", end, published, strict=False):
            bench.check(f"{name} at 5 s, {axis} (m)", value, reference, 0.02, FLYING_SOURCE,
                        length, "share of L")  # fmt: skip


def free_bodies(bench: Bench) -> None:
    """Free bodies over a million steps: momenta to rounding, energy bounded and without drift."""
    section, material = fpm.Section.rectangle(0.04, 0.02), fpm.Material(2e8, 0.3, 1000.0)
    instants = 401
    # A million roundings of one sign would make 2e-10, of random sign 2e-13. A hinge may be open
    # by g < 1e-10 m besides, and its two impulses then make a moment.
    cases = (("bending bar", free_bar, 1e-11), ("hinged pair", free_pair, 1e-10))
    for name, build, rounding in cases:
        scene = build(section, material)
        watch(scene)
        step = 0.9 * fpm.find_stable_step(scene).step
        steps = 100_000 if bench.quick else 1_000_000
        output_steps = steps // (instants - 1)
        duration = step * output_steps * (instants - 1)
        (outcome,) = bench.simulate(scene, duration=duration, instants=instants, step=step)
        linear, angular, centre = momenta(outcome)
        source = f"free body, {outcome.steps:.0e} steps"
        bench.check_small(f"{name}: linear momentum", drift(linear), 1e-11, source, "it")
        bench.check_small(f"{name}: angular momentum", drift(angular), rounding, source, "it")
        path = centre[0] + outcome.time[:, None] * linear[0] / scene.mass.sum()
        worst = np.abs(centre - path).max() / np.abs(path - path[0]).max()
        bench.check_small(f"{name}: straight path of the centre", worst, 1e-11, source, "way")
        balance = outcome.energies["balance"]
        energy = sum(outcome.energies[k][0] for k in ("kinetic", "strain", "spring"))
        share = balance / energy
        bench.check_small(f"{name}: energy off its start", np.abs(share).max(), 2e-3, source,
                          "energy")  # fmt: skip
        # Drift: a line through the balance, against the scatter that leapfrog has anyway.
        slope, spread = np.polyfit(outcome.time / outcome.time[-1], share, 1)[0], share.std()
        # Four times the standard error of a slope through this scatter: one in 16,000 by chance.
        chance = 4 * spread * np.sqrt(12 / instants)
        bench.check_small(f"{name}: drift of the energy over all steps", abs(slope),
                          max(chance, 1e-12), source, "energy")  # fmt: skip


def free_bar(section, material) -> fpm.Scene:
    """A bar that flies, tumbles and vibrates in bending, stretch and torsion."""
    scene = fpm.Scene("free bar")
    bar = scene.add_link((-0.5, 0, 0), (0.5, 0, 0), (0, 0, 1), section, material, 4)
    x = scene.position[bar.particles]
    flight, bending = np.array([0.01, -0.02, 0.01]), np.array([0.2, 1.0, 0.0])
    scene.velocity[bar.particles] = flight + np.cross((0.5, 2.0, 3.0), x) + x[:, :1] ** 2 * bending
    scene.spin[bar.particles] = (0.5, 2.0, 3.0)
    scene.spin[bar.particles[-1]] += (3.0, 0, 0)
    return scene


def free_pair(section, material) -> fpm.Scene:
    """Two bars hinged at a corner, with a torsion spring, tumbling."""
    scene = fpm.Scene("free pair")
    first = scene.add_link((0, 0, 0), (0.5, 0, 0), (0, 0, 1), section, material, 2, "one").particles
    bar = scene.add_link((0, 0, 0), (0, 0.5, 0), (0, 0, 1), section, material, 2, "two")
    second = bar.particles
    hinge = scene.add_hinge("O", (first[0], second[0]), (0, 0, 0.01), (0, 0, 1), opening=np.pi / 2)
    scene.add_torsion_spring(hinge, 5.0, rest=1.2)
    flight = np.array([0.01, 0, 0.02])
    for particles in (first, second):
        scene.velocity[particles] = flight + np.cross((1, 2, 0.5), scene.position[particles])
        scene.spin[particles] = (1, 2, 0.5)
    return scene


PROBLEMS = {
    "spin-up": spin_up,
    "right-angle cantilever": elbow,
    "flying beam": flying_beam,
    "free bodies": free_bodies,
}
