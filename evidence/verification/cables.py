"""Cables against closed forms: slack and tight, running, wound, with friction, static."""

import numpy as np
from scipy.integrate import solve_ivp

import fpm
from evidence.verification.bench import Bench, observed_orders
from fpm.elements import Motor, TorqueMotor

G = 9.81


def hanging_mass(mass: float, EA: float, rest: float, start: float) -> fpm.Scene:
    """A mass let go `start` m below the point from which a cable of `rest` m hangs."""
    scene = fpm.Scene("hung", gravity=(0, 0, -G))
    top = int(scene.add_particles((0, 0, 0), 1.0, 1.0)[0])
    scene.fix(top)
    body = int(scene.add_particles((0, 0, -start), mass, 1.0)[0])
    scene.add_cable("rope", [(top, None), (body, None)], EA, rest=rest)
    scene.add_point("mass", body)
    return scene


def bounce(bench: Bench) -> None:
    """A mass that falls into a slack cable, again and again."""
    mass, rest, drop = 2.0, 1.0, 0.2
    stiffnesses = (1e3, 1e4, 1e5)
    fall = np.sqrt(2 * drop / G)
    scenes = [hanging_mass(mass, EA, rest, rest - drop) for EA in stiffnesses]
    outcomes = bench.simulate(scenes, duration=2.0, instants=4001, step=1e-4)
    for EA, outcome in zip(stiffnesses, outcomes, strict=True):
        rate = np.sqrt(EA / rest / mass)
        flight = 2 / rate * (np.pi - np.arctan(G * fall * rate / G))
        name, times = f"EA = {EA:.0e} N", outcome.events[:, 0]
        bench.check(f"tight at, {name} (s)", times[0], fall, 1e-4, "free fall, √(2 d / g)")
        bench.check(f"time tight, {name} (s)", times[1] - times[0], flight, 2e-3,
                    "2 (π - atan(v ω / g)) / ω")  # fmt: skip
        turns = (len(times) - 1) // 2
        period = (times[2 * turns] - times[0]) / turns
        bench.check(f"period of {turns}, {name} (s)", period, 2 * fall + flight, 1e-3,
                    "free flight and part of a swing")  # fmt: skip
        tension = outcome.records["cable_tension"].values[:, 0]
        most = mass * G + np.hypot(mass * G, mass * rate * G * fall)
        bench.check(f"largest tension, {name} (N)", tension.max(), most, 1e-3,
                    "m g + √((m g)² + m k v²)")  # fmt: skip
        worst = np.abs(outcome.energies["balance"]).max() / (mass * G * drop)
        bench.check_small(f"energy balance, {name}", worst, 1e-3, "no damping", "m g d")


def atwood(bench: Bench) -> None:
    """Two masses on one cable over a fixed point."""
    pairs = ((3.0, 2.0), (2.0, 1.9), (1.0, 0.1))
    scenes = []
    for heavy, light in pairs:
        scene = fpm.Scene("atwood", gravity=(0, 0, -G))
        places = [(0.0, 0, 0), (0, 0, -1.0), (0, 0, -4.0)]
        top, first, second = (int(p) for p in scene.add_particles(places, [1, heavy, light], 1.0))
        scene.fix(top)
        tension = 2 * heavy * light * G / (heavy + light)
        scene.add_cable("rope", [(p, None) for p in (first, top, second)], 1e6, preload=tension)
        scene.add_point("left", first)
        scenes.append(scene)
    outcomes = bench.simulate(scenes, duration=0.5, instants=101, step=1e-4)
    for (heavy, light), outcome in zip(pairs, outcomes, strict=True):
        name, exact = f"{heavy:g} and {light:g} kg", G * (heavy - light) / (heavy + light)
        drop = outcome.points["left"][0][0, 2] - outcome.points["left"][0][-1, 2]
        bench.check(f"acceleration, {name} (m/s²)", 8 * drop, exact, 1e-4, "g (m₁-m₂)/(m₁+m₂)")
        tension = outcome.records["cable_tension"].values[:, 0]
        exact = 2 * heavy * light * G / (heavy + light)
        stretches = outcome.records["stretch_tension"].values
        for label, pull in zip(("", " of stretch 1", " of stretch 2"),
                               (tension, *stretches.T), strict=True):  # fmt: skip
            worst = np.abs(pull / exact - 1).max()
            bench.check_small(f"tension{label}, {name}", worst, 1e-4, "2 m₁ m₂ g/(m₁+m₂)", "it")
        slip = outcome.records["cable_slip"].values[-1, 0]
        bench.check(f"slip over the point, {name} (m)", slip, -drop, 1e-4, "as the masses move")


def vee(bench: Bench) -> None:
    """A weight on a V of two cables, and on one that runs through it, settled by damping."""
    mass, EA, spans = 5.0, 1e4, ((0.6, 0.8), (0.3, 1.0))
    for is_one in (False, True):
        scenes = []
        for span in spans:
            scene = fpm.Scene("vee", gravity=(0, 0, -G), damping=5.0)
            start, stop = -span[0], span[1]
            ends = scene.add_particles([(start, 0, 0), (stop, 0, 0)], 1.0, 1.0)
            scene.fix(ends)
            body = int(scene.add_particles((0, 0, -0.7), mass, 1.0)[0])
            if is_one:
                points = [(int(p), None) for p in (ends[0], body, ends[1])]
                scene.add_cable("rope", points, EA, rest=2.0)
            else:
                for name, end in zip("ab", ends, strict=True):
                    rest = np.hypot(span["ab".index(name)], 0.7)
                    scene.add_cable(name, [(int(end), None), (body, None)], EA, rest=rest)
            scene.add_point("mass", body)
            scenes.append(scene)
        outcomes = bench.simulate(scenes, duration=24.0, instants=3, step=5e-4)
        for span, outcome in zip(spans, outcomes, strict=True):
            name = f"{'running through' if is_one else 'two cables'}, {span[0]} + {span[1]} m"
            tensions = outcome.records["cable_tension"].values[-1]
            place = outcome.points["mass"][0][-1]
            exact = _hangs_in_one(span, mass, EA, 2.0) if is_one else _hangs(span, mass, EA, 0.7)
            for label, value, reference in zip(("x", "z"), place[[0, 2]], exact[0], strict=True):
                bench.check(
                    f"{name}: {label} (m)", value, reference, 1e-6, "statics", 1.0, "absolute"
                )
            for k, (value, reference) in enumerate(zip(tensions, exact[1], strict=True)):
                bench.check(f"{name}: tension {k + 1} (N)", value, reference, 1e-5, "statics")


def _hangs(span, mass, EA, depth) -> tuple[tuple[float, float], list[float]]:
    """Place (x, z) m and tensions (N) where two cables hold a weight."""
    from scipy.optimize import root

    anchors = np.array([[-span[0], 0.0], [span[1], 0.0]])
    rests = np.hypot(span, depth)

    def pulls(place):
        vectors = anchors - place
        lengths = np.linalg.norm(vectors, axis=1)
        return EA * (lengths / rests - 1), vectors / lengths[:, None]

    def force(place):
        tension, units = pulls(place)
        return tension @ units - [0.0, mass * G]

    place = root(force, [0.0, -depth], tol=1e-12).x
    return tuple(place), list(pulls(place)[0])


def _hangs_in_one(span, mass, EA, rest) -> tuple[tuple[float, float], list[float]]:
    """The same for one cable that runs through it: both halves at the same slope, cos a = w/L."""
    from scipy.optimize import brentq

    wide = sum(span)
    longer = brentq(
        lambda L: 2 * EA * (L / rest - 1) * np.sqrt(1 - (wide / L) ** 2) - mass * G,
        rest * (1 + 1e-9), 2 * rest, xtol=1e-14,
    )  # fmt: skip
    depth = np.sqrt(longer**2 - wide**2) / 2  # supports are level: the weight hangs in the middle
    return (0.5 * (span[1] - span[0]), -depth), [EA * (longer / rest - 1)]


def reel(bench: Bench) -> None:
    """A winch lifts a mass: height, and the work that it gives."""
    mass, EA, reel, duration = 2.0, 1e4, 0.5, 2.0
    scene = fpm.Scene("winch", gravity=(0, 0, -G), damping=0.0)
    top, body = (int(p) for p in scene.add_particles([(0, 0, 0), (0, 0, -1.0)], [1.0, mass], 1.0))
    scene.fix(top)
    time = np.linspace(0, duration, 401)
    curve = scene.add_curve(time, 0.5 - 0.5 * np.cos(np.pi * time / duration))
    points = [(top, None), (body, None)]
    scene.add_cable("rope", points, EA, preload=mass * G, reel=reel, curve=curve)
    scene.add_point("mass", body)
    (outcome,) = bench.simulate(scene, duration=duration, instants=401, step=2e-4)
    strain = mass * G / EA
    z = outcome.points["mass"][0][:, 2]
    height = z[-1] - z[0]
    bench.check("lifted (m)", height, reel * (1 + strain), 1e-3, "reel (1 + m g / EA)")
    # The strain energy that leaves on the drum is not the structure's: m g reel (1 + e/2).
    exact = mass * G * reel * (1 + strain / 2)
    bench.check("work of the winch (J)", outcome.energies["reel"][-1], exact, 1e-3,
                "m g reel (1 + m g / 2 EA), slowly")  # fmt: skip
    worst = np.abs(outcome.energies["balance"]).max() / exact
    bench.check_small("energy balance", worst, 1e-5, "no damping", "the work")


def capstan(bench: Bench) -> None:
    """A weight on a cable that rubs on pins, lifted and lowered; and masses that slide or stick."""
    mass, pins, speed, damping = 2.0, 5, 0.1, 5.0
    cases = [(mu, sign) for mu in (0.05, 0.2, 0.5) for sign in (1, -1)]
    for mu, sign in cases:
        scene = fpm.Scene("capstan", gravity=(0, 0, -G), damping=damping)
        places = [(-np.cos(a), 0, np.sin(a)) for a in np.linspace(0, np.pi, pins)]
        anchors = scene.add_particles([(-1.0, 0, -1.0), *places], 1.0, 1.0)
        scene.fix(anchors)
        body = int(scene.add_particles((1.0, 0, -1.0), mass, 1.0)[0])
        curve = scene.add_curve([0.2, 3.2], [0, sign])
        points = [(int(p), None) for p in (*anchors, body)]
        scene.add_cable("rope", points, 1e4, preload=mass * G, reel=3 * speed, curve=curve,
                        friction=mu)  # fmt: skip
        (outcome,) = bench.simulate(scene, duration=3.2, instants=321, step=2e-4)
        is_steady = outcome.time > 2.2
        exact = mass * (G + sign * damping * speed) * np.exp(sign * mu * np.pi)
        name = f"{'lifted' if sign > 0 else 'lowered'}, μ = {mu:g}"
        pull = outcome.select_columns("cable_tension")["rope"][is_steady].mean()
        bench.check(f"{name}: pull of the winch (N)", pull, exact, 1e-3, "T exp(± μ π)")
        reel_work = outcome.energies["reel"]
        worst = np.abs(outcome.energies["balance"]).max() / np.abs(reel_work).max()
        bench.check_small(f"{name}: energy balance", worst, 1e-5, "with what friction took", "work")


def drum(bench: Bench) -> None:
    """A torque motor winds a cable on a drum and lifts a mass, stiff and soft."""
    mass, radius, spin = 2.0, 0.05, 0.01

    def hoist(torque: float, EA: float) -> fpm.Scene:
        scene = fpm.Scene("hoist", gravity=(0, 0, -G))
        places = [(0, 0, 0), (0, 0, 0), (0, 0, -1.0)]
        base, reel_body, body = (int(p) for p in scene.add_particles(places, [1, 1, mass], spin))
        scene.fix(base)
        winch = scene.add_hinge("winch", (base, reel_body), (0, 0, 0), (0, 1, 0))
        scene.add(TorqueMotor(winch, torque))
        scene.add_cable("rope", [(base, None), (body, None)], EA, preload=mass * G, drum=winch,
                        radius=radius)  # fmt: skip
        scene.add_point("mass", body)
        return scene

    torques = (3.0, 1.5, 0.4)
    outcomes = bench.simulate([hoist(t, 1e7) for t in torques], duration=0.4, instants=41)
    for torque, outcome in zip(torques, outcomes, strict=True):
        exact = (torque - mass * G * radius) * radius / (spin + mass * radius**2)
        height = outcome.points["mass"][0][-1, 2] + 1
        bench.check(f"acceleration, {torque:g} N m (m/s²)", 2 * height / 0.4**2, exact, 1e-3,
                    "(M - m g r) r/(J + m r²)")  # fmt: skip
    torque, EA = 1.2, 60.0
    rest, errors = 1 / (1 + mass * G / EA), []

    def slope(_, state):
        height, speed, turn, rate = state
        strain = max(-height / (rest - radius * turn) - 1, 0.0)
        pull = EA * strain
        return (speed, pull / mass - G, rate, (torque - radius * pull * (1 + strain / 2)) / spin)

    for step in (2e-3, 1e-3, 5e-4):
        (outcome,) = bench.simulate(hoist(torque, EA), duration=0.4, instants=41, step=step)
        exact = solve_ivp(slope, (0, 0.4), [-1.0, 0, 0, 0], t_eval=outcome.time, rtol=1e-11,
                          atol=1e-13).y[0]  # fmt: skip
        errors.append(np.abs(outcome.points["mass"][0][:, 2] - exact).max())
    source = "equations of motion (solve_ivp)"
    bench.check_small("EA = 60 N: height, step 0.5 ms", errors[-1], 1e-5, source, "1 m")
    bench.check_at_least("order of the height", observed_orders(errors).min(), 1.95, source)
    scale = np.abs(outcome.energies["motor_work"]).max()
    worst = np.abs(outcome.energies["balance"]).max() / scale
    bench.check_small("EA = 60 N: energy balance", worst, 1e-4, "nothing but the motor", "its work")


def turning_post(bench: Bench) -> None:
    """A weight on a cable over a post that a motor turns towards it."""
    mass, radius = 2.0, 0.1
    angles = np.linspace(0, np.pi, 5)
    rim = radius * np.stack([-np.cos(angles), 0 * angles, np.sin(angles)], axis=1)
    for friction in (0.1, 0.3):
        scene = fpm.Scene("post", gravity=(0, 0, -G))
        places = [(0, 0, 0), (0, 0, 0), (radius, 0, -1.0)]
        base, post, body = (int(p) for p in scene.add_particles(places, [1, 1, mass], 0.01))
        scene.fix(base)
        axle = scene.add_hinge("axle", (base, post), (0, 0, 0), (0, 1, 0))
        rate = scene.add_curve([0, 0.05, 1.0], [0, 1, 1])
        scene.add(Motor(axle, None, 0.0, 0.0, 0.4, rate, by_rate=True))
        points = [(base, (-radius, 0, -1.0)), *((post, place) for place in rim), (body, None)]
        scene.add_cable("rope", points, 1e4, preload=mass * G, friction=friction)
        scene.add_point("mass", body)
        (outcome,) = bench.simulate(scene, duration=0.8, instants=81, step=2e-4)
        turn, place = outcome.openings["axle"][-1], outcome.points["mass"][0][-1]
        cos, sin = np.cos(turn), np.sin(turn)
        rim_now = rim @ np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]).T
        ends = rim_now[0] - [-radius, 0, -1.0], place - rim_now[-1]
        units = [end / np.linalg.norm(end) for end in ends]
        bend = np.arccos(np.dot(*units))
        tensions = outcome.records["stretch_tension"].values[-1]
        bench.check(f"μ = {friction:g}: T₂/T₁", tensions[0] / tensions[-1],
                    np.exp(friction * bend), 1e-6, "exp(μ a), a by the last places")  # fmt: skip
        energies = outcome.energies
        worst = np.abs(energies["balance"]).max() / energies["cable_friction"][-1]
        name = f"μ = {friction:g}: energy balance"
        bench.check_small(name, worst, 1e-5, "with what friction took", "it")


PROBLEMS = {
    "mass on a cable": bounce,
    "Atwood's machine": atwood,
    "weight in a V": vee,
    "winch": reel,
    "capstan": capstan,
    "mass on a drum's cable": drum,
    "cable on a turning post": turning_post,
}
