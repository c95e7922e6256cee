"""Scenes of rigid bodies whose joints are solved together: pairs, a chain, cranks on a platform."""

import numpy as np

import fpm

AXIS = (0.0, 1.0, 0.0)


def pairs(count: int = 50) -> fpm.Scene:
    """Free pairs of bodies, each with a joint."""
    scene = fpm.Scene("pairs")
    for x in 3.0 * np.arange(count):
        pair = scene.add_particles([(x - 0.5, 0, 0), (x + 0.5, 0, 0)], 1.0, 0.1)
        scene.add_joint(f"pin {x:g}", "revolute", pair, (x, 0, 0), AXIS)
    return scene


def chain(bodies: int) -> fpm.Scene:
    """A free chain of bodies."""
    scene = fpm.Scene("chain")
    particles = scene.add_particles([(float(k), 0, 0) for k in range(bodies)], 1.0, 0.1)
    for k in range(bodies - 1):
        scene.add_hinge(f"pin {k}", particles[k : k + 2], (k + 0.5, 0, 0), AXIS)
    return scene


def platform(cranks: int) -> fpm.Scene:
    """A platform that hangs on parallel cranks of 1 m."""
    scene = fpm.Scene("platform")
    ground, body = (int(p) for p in scene.add_particles([(0, 0, 0), (1, 0, -1)], 1.0, 1.0))
    scene.fix(ground)
    for k, x in enumerate(np.linspace(0, 2, cranks)):
        crank = int(scene.add_particles((x, 0, -0.5), 1.0, 0.1)[0])
        scene.add_hinge(f"root {k}", (ground, crank), (x, 0, 0), AXIS)
        scene.add_hinge(f"pin {k}", (crank, body), (x, 0, -1), AXIS)
    return scene
