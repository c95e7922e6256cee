"""Scenes with each kind that gives, stores or takes energy, and how far their balances are off."""

import numpy as np

import fpm
from fpm import elements as k

Z = (0.0, 0.0, 1.0)
J = (0.1, 0.3, 0.35)  # kg m², about the centre


def flap(rate=1.0, coupled=False, gravity=0.0, angle=0.0, second=False) -> fpm.Scene:
    """A body on a hinge, its centre 0.5 m off; with `second` another one hinged to its end."""
    scene = fpm.Scene("flap", gravity=(0, -gravity, 0))
    way = np.array([np.cos(angle), np.sin(angle), 0.0])
    ground, body = (int(p) for p in scene.add_particles([0 * way, 0.5 * way], 1.0, [[1.0] * 3, J]))
    scene.fix(ground)
    scene.spin[body], scene.velocity[body] = (0, 0, rate), rate * np.cross(Z, 0.5 * way)
    scene.add_hinge("hinge", (ground, body), 0 * way, Z)
    if second:
        other = int(scene.add_particles(1.5 * way, 0.5, J)[0])
        scene.velocity[other] = rate * np.cross(Z, way)
        scene.add_hinge("elbow", (body, other), way, Z)
    scene.add_curve([0.0, 0.24, 1.0], [0.0, 1.0, 0.5])
    return scene


def acting(make, **more):
    """Makes the flap, with what `make` adds to it."""

    def build() -> fpm.Scene:
        scene = flap(**more)
        make(scene)
        return scene

    return build


def on(element, **more):
    """Makes the flap with an element on it."""
    return acting(lambda scene: scene.add(element), **more)


def tumbling(**load) -> fpm.Scene:
    """A free body that spins about no principal axis, under a load."""
    scene = fpm.Scene("tumbling")
    (body,) = scene.add_particles((0.0, 0, 0), 1.0, J, spin=(1.0, 2.0, 0.5))
    scene.add_curve([0.0, 0.24, 1.0], [0.0, 1.0, 0.5])
    scene.add_load(int(body), **load)
    return scene


def blown() -> fpm.Scene:
    """The tumbling body with a plate on it, in wind."""
    scene = tumbling(**TURN)
    arm = scene.arm_to(0, (0.3, 0.2, -0.1))
    scene.add(k.Drag(arm, 0.3, np.array([0.0, 0.6, 0.8]), "along", (1.0, -2.0, 0.5)))
    return scene


def braced() -> fpm.Scene:
    """The flap on a damped strut by a table."""
    scene = flap(rate=1.0)
    ends = scene.arm_to(0, (0.4, -0.8, 0.3)), scene.arm_to(1, (1.0, 0.1, 0.2))
    table = (0.9, 1.0, 1.1, 1.4), (20.0, 5.0, -15.0, -10.0)
    scene.add(k.Strut("strut", ends, *table, slopes=(-50.0, 20.0), damping=2.0))
    return scene


def worn(law: str) -> fpm.Scene:
    """A body that spins on a pin with play, pressed by its weight."""
    scene = fpm.Scene("worn", gravity=(0, -9.81, 0))
    ground, body = (int(p) for p in scene.add_particles(np.zeros((2, 3)), 1.0, J, spin=(0, 0, 5.0)))
    scene.fix(ground)
    pair, zeros = (ground, body), (0.0, 0.0, 0.0)
    turn = scene.add_sliding_joint("pin", "pin with play", pair, zeros, (0, 0, 1), zeros)
    scene.add(k.Journal(turn, 0.05, 50.0, 0.1, law, 0.8, 0.3, 0.2, 0.05))
    return scene


def driven(**load) -> fpm.Scene:
    """A body that is driven, with another hinged to it, and a load on it."""
    scene = flap(rate=0.0, second=True)
    ramp = scene.add_curve([0.0, 0.12, 1.0], [0.0, 2.0, 1.0])
    free = fpm.Scene("driven")
    arm, body = (int(p) for p in free.add_particles([(0, 0, 0), (0.5, 0, 0)], 1.0, J))
    free.curves = scene.curves
    free.add_hinge("hinge", (arm, body), (0.2, 0, 0), (0, 0.6, 0.8))
    free.drive(arm, (0.1, 0, 0.2), (0, 0, 1.0), ramp)
    if load:
        free.add_load(arm, **load)
    return free


def bar(viscosity=0.0, beta=0.0) -> fpm.Scene:
    """A soft bar in space whose end was pushed aside and outwards."""
    scene = fpm.Scene("bar")
    wood = fpm.Material(1e5, 0.3, 500.0, beta)
    link = scene.add_link((0, 0, 0), (1, 0, 0), (0, 0, 1), fpm.Section.square(0.05), wood, 2)
    scene.velocity[link.particles[-1]] = (0.1, 0.2, 0.0)
    if viscosity:
        scene.add(k.BarDamping(viscosity))
    if beta:
        scene.beams[:] = [beams.with_strain(0.02, 0.3) for beams in scene.beams]
    return scene


def cable(friction=None) -> fpm.Scene:
    """A mass on a winch's cable over a fixed eyelet."""
    scene = fpm.Scene("cable", gravity=(0, 0, -9.81))
    post, mass = (int(p) for p in scene.add_particles([(0, 0, 0), (1, 0, -1)], 1.0, J))
    scene.fix(post)
    scene.add_curve([0.0, 0.24, 1.0], [0.0, 1.0, 0.5])
    points = [(post, (-1.0, 0, 0)), (post, (0.0, 0, 0)), (mass, None)]
    scene.add_cable("rope", points, 2000.0, preload=10.0, reel=0.1, curve=0, friction=friction)
    return scene


PULL = {"force": (1.0, -3.0, 2.0), "arm": (0.3, 0.2, -0.1)}
TURN = {"moment": (0.5, -0.3, 0.4)}

FALLING = {"gravity": 9.81, "second": True}

SCENES = {
    "gravity": lambda: flap(gravity=9.81),
    "gravity, coupled": lambda: flap(**FALLING),
    "load off the centre": acting(lambda s: s.add_load(1, (2, 3, 0), (0, 0, 0), (0.3, 0.2, 0))),
    "load, tumbling": lambda: tumbling(**PULL),
    "load by a curve, tumbling": lambda: tumbling(**PULL, curve=0),
    "moment, tumbling": lambda: tumbling(**TURN),
    "moment by a curve, tumbling": lambda: tumbling(**TURN, curve=0),
    "drive": driven,
    "drive against a load": lambda: driven(**PULL, **TURN),
    "damping": acting(lambda s: setattr(s, "damping", 1.5)),
    "damping, coupled": acting(lambda s: setattr(s, "damping", 1.5), second=True),
    "drag in wind, tumbling": blown,
    "drag": acting(lambda s: s.add(k.Drag(s.arm_to(1, (1.0, 0.1, 0.2)), 0.3))),
    "bar": bar,
    "viscous bar": lambda: bar(0.2),
    "damped bent bar": lambda: bar(beta=2e-3),
    "torsion spring": on(k.TorsionSpring(0, 20.0, 1.0)),
    "contact": on(k.Contact(0, 200.0), rate=-1.0),
    "table": on(k.TableSpring(0, (-2.0, 0.1, 0.3, 2.0), (3.0, -1.0, -4.0, 2.0))),
    "damper": on(k.Damper(0, 0.7)),
    "friction": on(k.Friction(0, 0.5, 0.01), rate=0.7),
    "stop": on(k.Stop(0, 0.2, "above", 100.0, 1.0)),
    "latch": on(k.Latch(0, 0.2, 100.0, 1.0)),
    "release": on(k.Release(0, 100.0, 0.5, 0.0, time=0.231)),
    "motor": on(k.Motor(0, 50.0, 1.0, 0.0, 1.0, 0)),
    "motor by its rate": on(k.Motor(0, 50.0, 1.0, 0.0, 1.0, 0, True), rate=0.0),
    "torque motor": on(k.TorqueMotor(0, 2.0, 0, 5.0)),
    "motor with backlash": on(k.Motor(0, 50.0, 1.0, 0.0, 1.0, 0, backlash=0.1)),
    "loop with backlash": on(
        k.SyncLoop("belt", (0, 1), (0.2, 0.1), 500.0, backlash=0.02), second=True
    ),
    "loop": on(k.SyncLoop("belt", (0, 1), (0.2, 0.1), 2000.0), second=True),
    "cable": cable,
    "rubbing cable": lambda: cable(0.2),
    "strut": braced,
    "pin with play": lambda: worn("hertz"),
    "pin with play, linear": lambda: worn("linear"),
    "exact release": on(k.Release(1, time=0.231), **FALLING),
    "exact motor": on(k.Motor(0, None, 0.0, 0.0, 1.0, 0), rate=0.0, **FALLING),
    "exact motor by its rate": on(k.Motor(0, None, 0.0, 0.0, 1.0, 0, True), rate=0.0, **FALLING),
    "exact friction": on(k.Friction(0, 0.5, None), **FALLING),
    "exact latch": on(k.Latch(1, 0.05), **FALLING),
}
DURATION, INSTANTS, STEPS = 0.48, 13, (10e-3, 5e-3)


def off(scene: fpm.Scene, step: float) -> float:
    """The largest error of the balance, as a share of the largest energy."""
    (outcome,) = fpm.simulate(
        scene, duration=DURATION, instants=INSTANTS, step=step, energy_tolerance=1e9
    )
    if outcome.failure:
        raise outcome.failure
    energies = dict(outcome.energies)
    balance = energies.pop("balance")
    return float(np.abs(balance).max() / max(np.abs(e).max() for e in energies.values()))
