"""Two bars in a chain, whose knee is held exactly, and their motion in generalised coordinates."""

import numpy as np
from scipy.integrate import solve_ivp

import fpm
from fpm.elements import RigidLatch, RigidRelease

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
    scene.add(RigidRelease(2, time=1e9))
    if hold is not None:
        scene.add(RigidRelease(0, **hold))
    scene.add(RigidLatch(1, latch, **more))
    return scene


def mass_matrix(angles) -> np.ndarray:
    """Of the two angles (2, 2)."""
    couple = M[1] * L * L / 2 * np.cos(angles[1] - angles[0])
    own = J + M * L**2 / 4 + [M[1] * L**2, 0.0]
    return np.array([[own[0], couple], [couple, own[1]]])


def kinetic(angles, rates) -> float:
    """Kinetic energy, J."""
    return float(rates @ mass_matrix(angles) @ rates) / 2


def caught(angles, rates) -> tuple[np.ndarray, float]:
    """Rates after the knee is caught, and the impulse at it (N m s): M dq' = B p, B·q' = 0."""
    way = np.array([-1.0, 1.0])
    response = np.linalg.solve(mass_matrix(angles), way)
    impulse = -(way @ rates) / (way @ response)
    return rates + impulse * response, float(impulse)


def free(time, state, gravity):
    """d(angles, rates)/dt of the chain."""
    angles, rates = state[:2], state[2:]
    swing = M[1] * L * L / 2 * np.sin(angles[1] - angles[0])
    force = [swing * rates[1] ** 2, -swing * rates[0] ** 2]
    force -= gravity * L * np.cos(angles) * [M[0] / 2 + M[1], M[1] / 2]
    return np.concatenate([rates, np.linalg.solve(mass_matrix(angles), force)])


def held(time, state, gravity):
    """The same where the knee is held: one body about the root."""
    rate = state[2]
    stiff = mass_matrix(state[:2]).sum()
    force = -gravity * L * np.cos(state[:2]) @ [M[0] / 2 + M[1], M[1] / 2]
    return np.array([rate, rate, force / stiff, force / stiff])


def motion(rule, start, span, gravity, until=None):
    """The exact motion over a span of time (s), as solve_ivp has it; until: opening of the knee at
    which it ends."""
    event = None
    if until is not None:
        event = lambda time, state, gravity: state[1] - state[0] - until  # noqa: E731
        event.terminal = True
    return solve_ivp(
        rule, span, start, args=(gravity,), events=event, rtol=1e-11, atol=1e-12, dense_output=True
    )
