"""Two bars in a chain, whose knee is held exactly, and their motion in generalised coordinates."""

import numpy as np

import fpm
from fpm.elements import Latch, Release

FAR = 1e3  # rad, where nothing comes
NONE = 1e-300  # m/s²: weight is there, and does nothing
M = np.array([2.0, 1.0])  # kg
J = np.array([0.2, 0.1])  # kg m² about their middles
L = 1.0  # m


def bars(
    angles=(0.0, 0.0), rates=(0.0, 0.0), gravity=NONE, latch=FAR, hold=None, **more
) -> fpm.Scene:
    """The bars at angles to x, turning at rates about z; weight acts along -y.

    latch: angle at the knee; hold: when a release at the root lets go (time, or watch and level);
    more: of the latch. A door that stays shut has a release too: one loop serves for all.
    """
    scene = fpm.Scene("two bars", gravity=(0.0, -gravity, 0.0))
    one, two = ((np.cos(a), np.sin(a), 0.0) for a in np.asarray(angles, float))
    knee = L * np.array(one)
    places = [np.zeros(3), knee / 2, knee + L * np.array(two) / 2, (0.0, 0.0, 5.0)]
    inertia = [[1.0] * 3, [0.1, J[0], J[0]], [0.1, J[1], J[1]], [1.0] * 3]
    ground, a, b, door = (int(p) for p in scene.add_particles(places, [1.0, *M, 1.0], inertia))
    scene.fix(ground)
    across = np.array([-np.array(one)[1], one[0], 0.0]), np.array([-two[1], two[0], 0.0])
    scene.spin[a], scene.spin[b] = (0, 0, rates[0]), (0, 0, rates[1])
    scene.velocity[a] = rates[0] * L / 2 * across[0]
    scene.velocity[b] = rates[0] * L * across[0] + rates[1] * L / 2 * across[1]
    z = (0.0, 0.0, 1.0)
    scene.add_hinge("root", (ground, a), (0, 0, 0), z, opening=angles[0])
    scene.add_hinge("knee", (a, b), knee, z, opening=angles[1] - angles[0])
    scene.add_hinge("door", (ground, door), (0.0, 0.0, 5.0), z)
    scene.add(Release(2, time=1e9))
    if hold is not None:
        scene.add(Release(0, **hold))
    scene.add(Latch(1, latch, **more))
    return scene
