"""Exact motions that structures of the library are compared with."""

import numpy as np
from scipy.integrate import solve_ivp


def zfold(k, fold, gyration, times):
    """Tip angles (t, 2) of two rigid panels of 1 m and 1 kg, both from the x axis, in rad.

    The root's spring rests at pi/2, the knee's with the panels folded onto each other.
    """
    turning = 1 / 3 + gyration**2

    def slopes(_, y):
        one, two, rate1, rate2 = y
        cosine, sine = np.cos(one - two) / 2, np.sin(one - two) / 2
        matrix = np.array([[turning + 1, cosine], [cosine, turning]])
        knee = k * (one - two)
        right = [
            -k * (one - np.pi / 2) - knee - sine * rate2**2,
            knee + sine * rate1**2,
        ]
        return [rate1, rate2, *np.linalg.solve(matrix, right)]

    start = [fold, np.pi - fold, 0, 0]
    run = solve_ivp(slopes, (0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-13)
    return run.y[:2].T


def solar_array(n, k=0.4, c=0.0, hub=150.0, mass=6.0, length=1.0, thickness=0.025, angle=np.pi / 2):
    """Time (s), rate (rad/s) and turn of the hub (rad) when an array's root is open by `angle`.

    Rigid, and ideally synchronised: the root opens by q, the panels by 2 q each, in a plane, with
    springs that rest at pi and 2 pi and dampers c on all hinges. No momentum comes from outside, so
    that hub and centre of mass follow from q: with the angular momentum B q' + C p' = 0 of the
    motion about the centre, p being the hub's turn, the inertia of q is A - B²/C.
    """
    side = 1.0  # of the hub
    masses = np.array([hub, *[mass] * n])
    turning = np.array([hub * side**2 / 6, *[mass * (length**2 + thickness**2) / 12] * n])
    signs = np.array([0, *((-1) ** i for i in range(n))])

    def inertias(q):
        """That of q, and the share B/C by which the hub turns."""
        place, slope, pin, pin_slope = [complex(length / 2, -side / 2)], [0j], 0j, 0j
        for sign in signs[1:]:
            turn = np.exp(1j * sign * q)
            middle = turn * complex(sign * length, thickness) / 2
            place.append(pin + middle)
            slope.append(pin_slope + 1j * sign * middle)
            pin, pin_slope = pin + 2 * middle, pin_slope + 2j * sign * middle
        place, slope = (x - masses @ x / masses.sum() for x in map(np.array, (place, slope)))
        a = masses @ abs(slope) ** 2 + turning @ signs**2
        b = masses @ (place.conj() * slope).imag + turning @ signs
        whole = masses @ abs(place) ** 2 + turning.sum()
        return a - b**2 / whole, b / whole

    def slopes(_, y):
        q, rate, _ = y
        near = 1e-5
        inertia, share = inertias(q)
        slope = (inertias(q + near)[0] - inertias(q - near)[0]) / (2 * near)
        force = k * (np.pi - q) + 4 * (n - 1) * k * (np.pi - q) - c * (4 * n - 3) * rate
        return [rate, (force - slope * rate**2 / 2) / inertia, -share * rate]

    def reached(_, y):
        return y[0] - angle

    reached.terminal = True
    run = solve_ivp(slopes, (0, 1e3), [0, 0, 0], "DOP853", events=reached, rtol=1e-10, atol=1e-12)
    return run.t[-1], run.y[1, -1], run.y[2, -1]


PUSH, TIRED, TRAVEL, DAMPING, RUB, TUBE, HEAD = 20.0, 0.6, 0.8, 2.0, 0.5, 1.5, 4.0
MASSES = np.array([TUBE, TUBE, TUBE + HEAD])


def on_a_line(until=2.5) -> tuple[list[float], list[float]]:
    """Times (s) and rates (m/s) at which the slides latch: tubes as points, slides held until the
    one before has opened by nine tenths, velocities changed by impacts that stop a tube alone."""
    held, latched = [False, True, True], [False] * 3
    time, state = 0.0, np.zeros(6)
    times, rates = [], []
    stiffness = TIRED * PUSH / TRAVEL

    def slides(state):
        places, speeds = state[:3], state[3:]
        return np.diff(places, prepend=0.0), np.diff(speeds, prepend=0.0)

    def motion(_, state):
        ways, speeds = slides(state)
        force = PUSH - stiffness * ways - DAMPING * speeds - RUB
        free = np.array([not (h or x) for h, x in zip(held, latched, strict=True)])
        # With held slides their force is unknown: M a + B' l = f, B a = 0.
        pull = np.where(free, force, 0.0)
        right = pull - np.append(pull[1:], 0.0)
        rows = np.eye(3) - np.eye(3, k=-1)
        rows = rows[~free]
        matrix = np.block([[np.diag(MASSES), rows.T], [rows, np.zeros((len(rows),) * 2)]])
        found = np.linalg.solve(matrix, np.append(right, np.zeros(len(rows))))
        return np.append(state[3:], found[:3])

    while not all(latched) and time < until:
        now = latched.index(False)
        waits = now + 1 < 3 and held[now + 1]
        level = 0.9 * TRAVEL if waits else TRAVEL

        def opened(_, state, now=now, level=level):
            return slides(state)[0][now] - level

        opened.terminal = True
        found = solve_ivp(motion, (time, until), state, events=opened, rtol=1e-10, atol=1e-12)
        time, state = found.t[-1], found.y[:, -1].copy()
        if waits:
            held[now + 1] = False
            continue
        times.append(time)
        rates.append(slides(state)[1][now])
        latched[now] = True
        state[3 : 4 + now] = 0.0  # the tubes up to this one stand still
    return times, rates
