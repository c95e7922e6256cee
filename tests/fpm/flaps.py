"""A rigid flap on a hinge with one of everything that acts on openings: one loop for all."""

import fpm
from fpm.elements import Damper, Friction, Latch, Stop, TableSpring

J = 1 / 3  # kg m², the flap's about the hinge
FAR = 1e3  # rad, where nothing comes


def bare(rate=0.0, opening=0.0, inertia=J) -> fpm.Scene:
    """The flap, at an opening (rad) and turning at a rate (rad/s)."""
    scene = fpm.Scene("flap")
    inertias = [[1.0] * 3, [inertia] * 3]
    ground, body = (int(p) for p in scene.add_particles([(0, 0, 0)] * 2, 1.0, inertias))
    scene.fix(ground)
    scene.add_hinge("hinge", (ground, body), (0, 0, 0), (0, 0, 1), opening=opening)
    scene.spin[body] = (0, 0, rate)
    return scene


def flap(
    rate=0.0, opening=0.0, spring=(0.0, 0.0), latch=None, damper=0.0, friction=None, stop=None,
    table=((0.0, 1.0, 2.0, 3.0, 4.0), (0.0,) * 5),
) -> fpm.Scene:  # fmt: skip
    """The flap with all of them; what is not stated is there, and does nothing."""
    scene = bare(rate, opening)
    scene.add_torsion_spring(0, *spring)
    scene.add(Latch(0, **(latch or {"angle": FAR, "stiffness": 0.0})))
    scene.add(Damper(0, damper))
    scene.add(Friction(0, **(friction or {"moment": 0.0})))
    scene.add(Stop(0, **(stop or {"angle": FAR, "side": "above", "stiffness": 0.0})))
    scene.add(TableSpring(0, *table))
    return scene
