"""A chain of panels on a wall, for tests of travels and margins."""

import fpm


def hinged(*angles, mass=2.0):
    """A chain of panels on a wall, each folded by an angle (rad) against the one before."""
    scene = fpm.Scene("chain")
    bodies = [int(scene.add_particles((0, 0, 0), 1.0, 1.0)[0])]
    scene.fix(bodies[0])
    for i, angle in enumerate(angles):
        bodies.append(int(scene.add_particles((0.5 + i, 0, 0), mass, 0.1)[0]))
        scene.add_hinge(f"h{i + 1}", bodies[-2:], (i, 0, 0), (0, 0, 1), opening=angle)
    return scene
