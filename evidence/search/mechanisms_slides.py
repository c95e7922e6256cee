"""Boxes of slides and rotors with known bounds: slack, friction, stall, play, contacts, releases.

Masses on slides and bodies on hinges, so that each run has a closed form or one equation of motion.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from evidence.search.mechanisms import Mechanism

G = 9.81
HUB = "hub: {mass: 1, centre: o, inertia: [Iz, Iz, Iz]}"
ROTOR = f"""
bodies: {{{HUB}}}
joints: {{axle: {{type: revolute, parts: [ground, hub], at: o, axis: z, opening: START}}}}
"""
SLIDE = """
bodies: {block: {mass: mass, centre: o, box: [2 cm, 2 cm, 2 cm]}}
joints: {slide: {type: prismatic, parts: [ground, block], at: o, axis: x, opening: START}}
"""


def compose_text(parameters: str, body: str, start: str = "0") -> str:
    """A structure, from `name unit least largest` of its parameters, and what stands below them."""
    lines = []
    for name, unit, *ends in (line.split() for line in parameters.split(",")):
        a, b = map(float, ends)
        ends, unit_text = (
            [1.1 * a - 0.1 * b, 1.1 * b - 0.1 * a],
            f"unit: {unit.replace('_', ' ')}, ",
        )
        lines.append(
            f"  {name}: {{value: {(a + b) / 2!r}, {unit_text if unit != '1' else ''}range: {ends}, "
            f"description: {name}}}"
        )
    points = "" if "points:" in body else "points: {o: [0, 0, 0]}\n"
    return "\n".join(
        [f"name: box\n{points}parameters:", *lines, body.strip().replace("START", start), ""]
    )


def mechanism(
    name: str, parameters: str, body: str, model: Callable, responses: dict, quantities: dict,
    start: str = "0", **settings,
) -> Mechanism:  # fmt: skip
    """A box of a structure, whose model takes its parameters as arrays (P), by position."""
    rows = [line.split() for line in parameters.split(",")]
    intervals = {row[0]: (float(row[2]), float(row[3])) for row in rows}
    return Mechanism(
        name, compose_text(parameters, body, start), intervals, responses, quantities,
        lambda points: np.column_stack(model(*np.asarray(points, float).T)), **settings,
    )  # fmt: skip


def crossing(
    function: Callable[[np.ndarray], np.ndarray],
    times: np.ndarray,
    number: int = 1,
    travel: int = 0,
) -> np.ndarray:
    """Time (P) of the nth zero of a function of times (P or 1, T), NaN where there is none.

    way: 1 rising, -1 falling, 0 either.
    """
    values = function(times[None])
    low, middle, high = values[:, :-2], values[:, 1:-1], values[:, 2:]
    top = np.where(
        (middle - low) * (high - middle) < 0, (low - high) / (low - 2 * middle + high), 0
    )
    instants = np.repeat(times[None], len(values), axis=0)
    instants[:, 1:-1] += top / 2 * times[1]  # where it turns: a crossing there is not missed
    signs = function(instants) > 0
    turns = signs[:, 1:] != signs[:, :-1]
    if travel:
        turns &= signs[:, 1:] == (travel > 0)
    column = (np.cumsum(turns, axis=1) < number).sum(axis=1)
    exists = column < turns.shape[1]
    rows, column = np.arange(len(signs)), np.minimum(column, turns.shape[1] - 1)
    low, high, side = instants[rows, column], instants[rows, column + 1], signs[rows, column]
    for _ in range(45):
        middle = (low + high) / 2
        equality = (function(middle[:, None])[:, 0] > 0) == side
        low, high = np.where(equality, middle, low), np.where(equality, high, middle)
    return np.where(exists, low, np.nan)


def swing(t, x, v, w, d):
    """Damped oscillation from x with the rate v: frequency w, decay rate d, both (P, 1)."""
    root = np.maximum(np.sqrt(abs(w**2 - d**2)), 1e-6)
    cosine, sine, slow = np.cos(root * t), np.sin(root * t), (d > w)[:, 0]
    if slow.any():
        turn = (root * t)[slow]
        cosine[slow], sine[slow] = np.cosh(turn), np.sinh(turn)
    return np.exp(-d * t) * (x * cosine + (v + d * x) / root * sine)


def summit(function: Callable[[np.ndarray], np.ndarray], times: np.ndarray) -> np.ndarray:
    """Largest value (P) of a function of times (P or 1, T), by thirds about the largest instant."""
    largest = times[np.argmax(function(times[None]), axis=1)][:, None]
    low, high = np.maximum(largest - times[1], 0), np.minimum(largest + times[1], times[-1])
    for _ in range(60):
        a, b = low + (high - low) / 3, high - (high - low) / 3
        remainder = function(a) > function(b)
        low, high = np.where(remainder, low, a), np.where(remainder, b, high)
    return function(low)[:, 0]


def peak(values: np.ndarray) -> np.ndarray:
    """Largest of values (P, T), by the parabola through the largest and its neighbours."""
    indices = np.clip(values.argmax(axis=1), 1, values.shape[1] - 2)
    a, b, c = (values[np.arange(len(values)), indices + j] for j in (-1, 0, 1))
    return b + (a - c) ** 2 / (8 * (2 * b - a - c))


def column(*arrays: np.ndarray) -> list[np.ndarray]:
    """Arrays (P, 1) of arrays (P)."""
    return [a[:, None] for a in arrays]


def integrate(
    rates: Callable[[float, np.ndarray], np.ndarray], state: np.ndarray, duration: float, steps: int
) -> np.ndarray:
    """States (steps + 1, n, P) by the classical Runge-Kutta method."""
    h, states = duration / steps, [state]
    for number in range(steps):
        t, y = number * h, states[-1]
        a = rates(t, y)
        b = rates(t + h / 2, y + h / 2 * a)
        c = rates(t + h / 2, y + h / 2 * b)
        states.append(y + h / 6 * (a + 2 * b + 2 * c + rates(t + h, y + h * c)))
    return np.array(states)


def cubic_crossing(
    x: np.ndarray, v: np.ndarray, h: float, number: int = 1, travel: int = 0
) -> np.ndarray:
    """Time (P) of the nth zero of values x (T, P) with rates v, by cubics between instants."""

    def value(t: np.ndarray) -> np.ndarray:
        i = np.clip((t / h + 1e-9).astype(int), 0, len(x) - 2)
        s, lanes = np.clip(t / h - i, 0, 1), np.arange(x.shape[1])[:, None]
        a, b, p, q = x[i, lanes], x[i + 1, lanes], h * v[i, lanes], h * v[i + 1, lanes]
        return (
            (1 + 2 * s) * (1 - s) ** 2 * a + s * (1 - s) ** 2 * p
            + s**2 * (3 - 2 * s) * b - s**2 * (1 - s) * q
        )  # fmt: skip

    return crossing(value, h * np.arange(len(x)), number, travel)


def hang(v, m, EA):
    """What hangs on a cable and is kicked up: when the cable goes slack, and is tight again."""
    k = EA + m * G
    w, weight, amplitude, level = np.sqrt(k / m), m * G, v * np.sqrt(k * m), 1.0
    ends, phase = (np.arcsin(np.clip((weight - x) / amplitude, -1, 1)) / w for x in (0, level))
    flight = 2 * np.sqrt(np.maximum(v**2 - m * G**2 / k, 0)) / G
    loose, low = amplitude > weight, amplitude > weight - level
    second = np.where(loose, 2 * ends + flight - phase, np.pi / w - phase)
    return (
        np.maximum(weight - amplitude, 0), weight + amplitude,
        np.where(low, phase, np.nan), np.where(low, second, np.nan),
    )  # fmt: skip


HUMP, TABLE = [-2, 0, 0.6, 1, 1.6, 2.4, 4], [2, 0, -1, 0, 1, 0, -2]


def creep(w, M, a):
    """A hub with dry friction on a spring with a hump, which it passes or comes back from."""
    p, f = np.array(HUMP[:-1], float), np.multiply.outer(a, TABLE[:-1])
    rise = np.multiply.outer(a, np.diff(TABLE) / np.diff(HUMP))
    steps = f * np.diff(HUMP) + rise * np.diff(HUMP) ** 2 / 2
    work = np.cumsum(np.column_stack([0 * a, steps[:, :-1]]), axis=1)
    rows, x, energy = np.arange(len(a)), 0 * a, 0.25 * w**2
    moves, side, largest = np.ones(len(a), bool), np.ones(len(a)), x
    for _ in range(20):
        i = np.clip(np.searchsorted(HUMP, x, "right") - 1, 0, len(p) - 1)
        z = x - p[i]
        level = energy - (work + f * 0)[rows, i] - f[rows, i] * z - rise[rows, i] * z**2 / 2
        slope, drag = f - (M * side)[:, None], (M * side * x)[:, None]
        rest = level[:, None] + work + drag - (M * side)[:, None] * p
        root = np.sqrt(slope**2 - 2 * rise * rest)
        flat = rise == 0
        ends = [
            np.where(flat, -rest / slope, (-slope + travel * root) / rise) for travel in (1, -1)
        ]
        validity = [(y >= 0) & (y <= np.diff(HUMP)) for y in ends]
        travels = [side[:, None] * (y + p - x[:, None]) for y in ends]
        travels = [
            np.where(ok & (d > 1e-6), d, np.inf) for d, ok in zip(travels, validity, strict=True)
        ]
        x = np.where(moves, x + side * np.min(travels, axis=(0, 2)), x)
        largest = np.maximum(largest, x)
        pull = a * np.interp(x, HUMP, TABLE)
        moves = moves & (abs(pull) > M)
        side, energy = np.where(moves, np.sign(pull), side), 0 * a
    return x, largest


def stall(T, wn, k):
    """A motor that winds up a spring, and may stall before it has turned by 1 rad."""
    J, rest = 0.1, T / k
    w, d = np.sqrt(k / J), T / (2 * wn * J)
    times = np.linspace(0, 6, 121)

    def turn(t):
        return rest[:, None] + swing(t, *column(-rest, 0 * rest, w, d))

    reach = crossing(lambda t: turn(t) - 1, times)
    return reach, summit(turn, times)


def tilt(b, w0, L, i):
    """A rod that is let go in gravity of a direction b, tilted out of its plane by i."""
    pull = 1.5 * G * np.cos(i) / L

    def rates(t, y):
        return np.array([y[1], pull * np.sin(b - y[0])])

    x, v = np.moveaxis(integrate(rates, np.array([0 * b, w0]), 2.0, 1000), 1, 0)
    speed = np.sqrt(w0**2 + 2 * pull * (1 - np.cos(b)))
    return cubic_crossing(x - 2.9, v, 0.002), speed


def play(r, k, J, b):
    """A hub on a motor of even rate, whose drive train has play: it lags, is hit, leads."""
    w, lead = np.sqrt(k / J), r / 2
    first, cycle = (b / r)[:, None], (np.pi / w + 2 * b / r)[:, None]

    def turn(t):
        number, phase = np.divmod(np.maximum(t - first, 0), cycle)
        push = (lead / w)[:, None] * np.sin(np.minimum(phase * w[:, None], np.pi))
        lag = b[:, None] / 2 + push - lead[:, None] * np.maximum(phase - np.pi / w[:, None], 0)
        lag = np.where(number % 2 == 0, lag, -lag)
        return r[:, None] * t - np.where(t < first, lead[:, None] * t, lag)

    times = np.linspace(0, 2, 401)
    return (
        lead * np.sqrt(k * J), crossing(lambda t: turn(t) - 1, times),
        turn(np.full((1, 1), 1.1))[:, 0],
    )  # fmt: skip


def clash(ma, mb, v, kb):
    """A mass that hits another one, which a spring sends back to hit again."""

    def rates(t, y):
        push = 2000 * np.maximum(y[0] - y[2] - 0.1, 0)
        return np.array([y[1], -push / ma, y[3], (push - kb * y[2]) / mb])

    zero = 0 * ma
    y = integrate(rates, np.array([zero, v, zero, zero]), 1.2, 1200)
    force = 2000 * (y[:, 0] - y[:, 2] - 0.1)
    slope = 2000 * (y[:, 1] - y[:, 3])
    return peak(force.T), cubic_crossing(force - 1, slope, 1e-3, 2, 1), y[-1, 1]


def chain(ta, ka, JA, kb):
    """A panel let go at a time, whose latch, unless it is passed too fast, lets another go."""
    w = np.sqrt(ka / JA)
    rate = w * np.sqrt(1.2**2 - 0.2**2)
    latch = np.where(rate < 3, ta + np.arccos(1 - 1 / 1.2) / w, np.nan)
    last = np.where(rate < 3, 1.0, 1.2 * (1 - np.cos(w * (2.0 - ta))))
    return latch, latch + np.arccos(1 - 1 / 3) / np.sqrt(kb / 0.5), last


def strike(F, m, k, d):
    """A mass that a force drives against an elastic stop, once and again."""
    hit, w = np.sqrt(2 * d * m / F), np.sqrt(k / m)
    phase = np.arctan2(F * hit / m / w, -F / k)
    return -F - np.sqrt(F**2 + 2 * k * F * d), hit + 2 * phase / w


def settle(x, k, J, c):
    """When a damped hub has come to rest: one swing more or less is a jump."""
    times = np.linspace(0, 6, 241)

    def turn(t):
        return swing(t, *column(x, 0 * x, np.sqrt(k / J), c / (2 * J)))

    return (6 - crossing(lambda t: abs(turn(6 - t)) - 0.05, times, 1, 1),)


def overshoot(J, k, c):
    """A hub on a damped spring: it goes beyond where it comes to rest, or creeps there."""
    w, d, times = np.sqrt(k / J), c / (2 * J), np.linspace(0, 6, 121)

    def turn(t):
        unity = np.ones_like(J)
        return 1 + swing(t, *column(-unity, 0 * unity, w, d))

    return np.maximum(summit(turn, times) - 1, 0), crossing(lambda t: turn(t) - 1.02, times)


def third(x, J, k, c):
    """When a hub whose swings fade passes a level for the second time on its way up."""
    times = np.linspace(0, 6, 241)

    def turn(t):
        return swing(t, *column(x, 0 * x, np.sqrt(k / J), c / (2 * J)))

    return (crossing(lambda t: turn(t) - 0.3, times, 2, 1),)


def ratio(F, c, m):
    """A mass that a force drives through oil."""

    def travel(t):
        return (F / c)[:, None] * (t - (m / c)[:, None] * -np.expm1(-t * (c / m)[:, None]))

    end = F / c * -np.expm1(-8 * c / m)
    return (
        crossing(lambda t: travel(t) - 1, np.linspace(0, 8, 17)),
        end,
        travel(np.full((1, 1), 2.0))[:, 0],
    )


def eight(m, ka, kb, ca, cb, x, v, i):
    """A mass between two springs and dampers on a tilted slide, kicked."""
    rest, w, d = m * G * np.sin(i) / (ka + kb), np.sqrt((ka + kb) / m), (ca + cb) / (2 * m)
    times = np.linspace(0, 2, 81)

    def travel(t):
        return rest[:, None] + swing(t, *column(x - rest, v, w, d))

    return (
        crossing(lambda t: travel(t) - 0.1, times, 1, 1), summit(travel, times),
        travel(np.full((1, 1), 0.5))[:, 0],
    )  # fmt: skip


def speed(u, v, w):
    """Speed of a body that is thrown: limits of it are balls."""
    return (np.sqrt(u**2 + v**2 + w**2),)


def corner(x, v, F, H):
    """When a latch catches that forces drive a mass to: in time in a corner of the box."""
    a, travel = F + H, 1.3 - x
    times = 2 * travel / (v + np.sqrt(v**2 + 2 * a * travel))
    return np.where(times < 1, times, np.nan), np.where(times < 1, 1.3, x + v + a / 2)


def band(u, v, w, M, p):
    """A hub that dry friction stops: it stays short of a latch, is caught, or is too fast."""
    rate = u + v + w
    remainder = rate**2 - 2 * M * p
    catch = (remainder > 0) & (remainder < 1)
    times = (rate - np.sqrt(np.maximum(remainder, 0))) / M
    return np.where(catch, times, np.nan), np.where(catch, p, rate**2 / (2 * M))


def outer(a, b, c, d):
    """When a mass comes to a latch: in time outside of a ball."""
    times = 0.9 / np.sqrt(a**2 + b**2 + c**2 + d**2)
    return (np.where(times < 1, times, np.nan),)


ANGLE, TRAVEL = {"angle": {"opening": "axle"}}, {"way": {"opening": "slide"}}
CONSTANT = "curves: {one: {times: [0, 10 s], values: [1, 1]}}\n"

BOXES = (
    mechanism(
        "cable slack",
        "v m/s 0.15 0.7,mass kg 0.9 1.1,EA N 900 1100",
        "let: {g: 9.81 m/s2}\npoints: {o: [0, 0, 0], top: [1 m, 0, 0]}"
        + SLIDE
        + """
opening_rates: {kick: {joint: slide, rate: v}}
cables:
  rope: {through: [{part: ground, at: top}, {part: block, at: o}], EA: EA, preload: mass*g}
gravity: [-9.81, 0, 0]
""",
        hang,
        {"pull": {"tension": "rope"}},
        {
            "least": {"smallest": "pull"},
            "peak": {"largest": "pull"},
            "slack": {"crossing": "pull", "level": 1, "way": "falling"},
            "tight": {"crossing": "pull", "level": 1, "way": "rising"},
        },
        duration=0.215,
        instants=431,
        edges={  # a dip that just reaches the level, after a quarter of the period
            "slack": (np.nan, np.pi / 2 / np.sqrt((900 + 1.1 * G) / 1.1)),
            "tight": (np.pi / 2 / np.sqrt((1100 + 0.9 * G) / 0.9), np.nan),
        },
    ),
    mechanism(
        "friction and hump",
        "w rad/s 1.1 1.6,M N_m 0.12 0.18,a N_m 0.4 0.6",
        ROTOR.replace("Iz", "0.5")
        + """
opening_rates: {kick: {joint: axle, rate: w}}
actions:
  dry: {type: friction, joint: axle, moment: M, sticks: exactly}
  hump: {type: tabulated spring, joint: axle, moments: [2*a, 0, -a, 0, a, 0, -2*a],
    angles: [-2 rad, 0, 0.6 rad, 1 rad, 1.6 rad, 2.4 rad, 4 rad]}
""",
        creep,
        ANGLE,
        {"stays": {"final": "angle"}, "farthest": {"largest": "angle"}},
        duration=20.0,
        instants=1001,
    ),
    mechanism(
        "motor stalls",
        "T N_m 1 2,wn rad/s 1 3,k N_m/rad 1.2 1.8",
        ROTOR.replace("Iz", "0.1")
        + """
actions:
  drive: {type: torque motor, joint: axle, torque: T, no_load: wn}
  wind: {type: torsion spring, joint: axle, stiffness: k, rest: 0}
""",
        stall,
        ANGLE,
        {"t_one": {"crossing": "angle", "level": 1}, "farthest": {"largest": "angle"}},
        duration=6.0,
        instants=1201,
    ),
    mechanism(
        "direction of gravity",
        "b rad 1.25 1.6,w rad/s 0 1.5,L m 0.4 0.6,i rad 0 0.5",
        """
points: {o: [0, 0, 0], end: [L, 0, 0]}
bodies: {rod: {type: rod, from: o, to: end, mass: 1, diameter: 1 mm}}
joints: {axle: {type: revolute, parts: [ground, rod], at: o, axis: z, opening: 0}}
opening_rates: {kick: {joint: axle, rate: w}}
gravity: [(9.81 m/s2)*cos(b)*cos(i), (9.81 m/s2)*sin(b)*cos(i), (9.81 m/s2)*sin(i)]
""",
        tilt,
        ANGLE | {"rate": {"opening_rate": "axle"}},
        {"t_over": {"crossing": "angle", "level": 2.9}, "fastest": {"largest": "rate"}},
        duration=2.0,
        instants=801,
        edges={"t_over": (np.nan, 0.778633)},  # from rest at b = 1.45, by quadrature
    ),
    mechanism(
        "play of a drive",
        "r rad/s 0.8 1.2,k N_m/rad 20 40,Iz kg_m2 0.4 0.6,b rad 0.02 0.1",
        ROTOR
        + CONSTANT
        + """
opening_rates: {kick: {joint: axle, rate: r/2}}
actions: {drive: {type: motor, joint: axle, rate: r, curve: one, stiffness: k, backlash: b}}
""",
        play,
        ANGLE | {"moment": {"joint_moment": "axle", "part": "motor"}},
        {
            "peak": {"largest": "moment"},
            "t_one": {"crossing": "angle", "level": 1},
            "late": {"value": "angle", "at": 1.1},
        },
        duration=2.0,
        instants=1001,
    ),
    mechanism(
        "masses that clash",
        "ma kg 0.5 1.5,mb kg 0.5 1.5,v m/s 0.5 1,kb N/m 2 20",
        """
points: {o: [0, 0, 0], far: [0.3 m, 0, 0]}
bodies:
  a: {mass: ma, centre: o, box: [2 cm, 2 cm, 2 cm]}
  b: {mass: mb, centre: far, box: [2 cm, 2 cm, 2 cm]}
joints:
  slide: {type: prismatic, parts: [ground, a], at: o, axis: x, opening: 0}
  other: {type: prismatic, parts: [ground, b], at: far, axis: x, opening: 0}
opening_rates: {kick: {joint: slide, rate: v}}
struts:
  contact: {type: spring, between: [{part: a, at: o}, {part: b, at: far}], stiffness: 2000,
    rest: 0.2 m, acts: push}
actions: {back: {type: spring, joint: other, stiffness: kb, rest: 0}}
record: {a: {part: a, at: o}}
""",
        clash,
        {"force": {"strut_force": "contact"}, "va": {"velocity": "a", "component": "x"}},
        {
            "peak": {"largest": "force"},
            "again": {"crossing": "force", "level": 1, "way": "rising", "number": 2},
            "leaves": {"final": "va"},
        },
        duration=1.2,
        instants=1201,
    ),
    mechanism(
        "release by a latch",
        "ta s 0.1 0.2,ka N_m/rad 2 4,JA kg_m2 0.4 0.6,kb N_m/rad 1 2",
        """
points: {o: [0, 0, 0], far: [0.3 m, 0, 0]}
bodies:
  a: {mass: 1, centre: o, inertia: [JA, JA, JA]}
  b: {mass: 1, centre: far, inertia: [0.5, 0.5, 0.5]}
joints:
  axle: {type: revolute, parts: [ground, a], at: o, axis: z, opening: 0}
  other: {type: revolute, parts: [ground, b], at: far, axis: z, opening: 0}
actions:
  bolt: {type: release, joint: axle, time: ta}
  push: {type: torsion spring, joint: axle, stiffness: ka, rest: 1.2 rad}
  pin: {type: latch, joint: axle, angle: 1 rad, side: below, max_capture_rate: 3 rad/s}
  hook: {type: release, joint: other, watch: pin}
  pull: {type: torsion spring, joint: other, stiffness: kb, rest: 3 rad}
""",
        chain,
        ANGLE | {"second": {"opening": "other"}},
        {
            "t_latch": {"event": "latches", "of": "pin"},
            "t_second": {"crossing": "second", "level": 1},
            "stays": {"final": "angle"},
        },
        duration=2.0,
        instants=801,
    ),
    mechanism(
        "blow on a stop",
        "F N 2 4,mass kg 0.5 1,k N/m 500 1000,d m 0.05 0.1",
        SLIDE
        + """
loads: {push: {part: block, at: o, force: [F, 0, 0]}}
actions: {end: {type: stop, joint: slide, upper: d, stiffness: k}}
""",
        strike,
        {"blow": {"joint_moment": "slide", "part": "stop"}},
        {"hardest": {"smallest": "blow"}, "t_off": {"event": "leaves", "of": "slide"}},
        duration=1.0,
        instants=1001,
    ),
    mechanism(
        "settling",
        "x rad 0.4 0.6,k N_m/rad 15 40,Iz kg_m2 0.4 0.6,c N_m_s/rad 0.6 1.4",
        ROTOR
        + """
actions:
  wind: {type: torsion spring, joint: axle, stiffness: k, rest: 0}
  oil: {type: damper, joint: axle, damping: c}
""",
        settle,
        ANGLE,
        {"t_rest": {"settling": "angle", "within": 0.05, "about": 0}},
        start="x",
        duration=6.0,
        instants=1201,
    ),
    mechanism(
        "overshoot",
        "Iz kg_m2 0.3 0.7,k N_m/rad 8 16,c N_m_s/rad 2 8",
        ROTOR
        + """
actions:
  wind: {type: torsion spring, joint: axle, stiffness: k, rest: 1 rad}
  oil: {type: damper, joint: axle, damping: c}
""",
        overshoot,
        ANGLE,
        {
            "over": {"overshoot": "angle", "about": 1},
            "t_over": {"crossing": "angle", "level": 1.02},
        },
        duration=6.0,
        instants=1201,
        edges={"t_over": (np.nan, np.pi / np.sqrt(8 / 0.7 * (1 - 0.779703**2)))},  # a summit of 2 %
    ),
    mechanism(
        "second crossing",
        "x rad 0.9 1.1,Iz kg_m2 0.4 0.6,k N_m/rad 8 12,c N_m_s/rad 0.2 0.8",
        ROTOR
        + """
actions:
  wind: {type: torsion spring, joint: axle, stiffness: k, rest: 0}
  oil: {type: damper, joint: axle, damping: c}
""",
        third,
        ANGLE,
        {"t_up": {"crossing": "angle", "level": 0.3, "way": "rising", "number": 2}},
        start="x",
        duration=6.0,
        instants=1201,
        edges={"t_up": (np.nan, 3.459788)},  # t = 4 pi / sqrt(8 / 0.6 - (log(1.1 / 0.3) / t)**2)
    ),
    mechanism(
        "ratio",
        "F N 1 4,c N_s/m 1 4,mass kg 0.5 2",
        SLIDE
        + """
loads: {push: {part: block, at: o, force: [F, 0, 0]}}
actions: {oil: {type: damper, joint: slide, damping: c}}
record: {block: {part: block, at: o}}
""",
        ratio,
        TRAVEL | {"speed": {"velocity": "block", "component": "x"}},
        {
            "t_one": {"crossing": "way", "level": 1},
            "end": {"final": "speed"},
            "at_two": {"value": "way", "at": 2},
        },
        duration=8.0,
        instants=1601,
    ),
    mechanism(
        "eight parameters",
        "mass kg 0.8 1.2,ka N/m 10 14,kb N/m 8 12,ca N_s/m 0.2 0.6,cb N_s/m 0.1 0.5,"
        "x m -0.1 0.05,v m/s 0.2 0.6,i rad -0.1 0.1",
        SLIDE
        + """
opening_rates: {kick: {joint: slide, rate: v}}
actions:
  a: {type: spring, joint: slide, stiffness: ka, rest: 0}
  b: {type: spring, joint: slide, stiffness: kb, rest: 0}
  oil: {type: damper, joint: slide, damping: ca}
  more: {type: damper, joint: slide, damping: cb}
gravity: [(9.81 m/s2)*sin(i), 0, -(9.81 m/s2)*cos(i)]
""",
        eight,
        TRAVEL,
        {
            "t_in": {"crossing": "way", "level": 0.1, "way": "rising"},
            "farthest": {"largest": "way"},
            "half": {"value": "way", "at": 0.5},
        },
        start="x",
        duration=2.0,
        instants=801,
        edges={"t_in": (np.nan, 0.701177)},  # by SQP: the latest summit at the level
    ),
    mechanism(
        "ball of three",
        "u m/s -1 1,v m/s -1 1,w m/s -1 1",
        """
bodies: {block: {mass: 1, centre: o, box: [5 cm, 5 cm, 5 cm]}}
initial_velocities: {throw: {part: block, about: o, velocity: [u, v, w]}}
record: {block: {part: block, at: o}}
""",
        speed,
        {"speed": {"velocity": "block", "component": "norm"}},
        {"end": {"final": "speed"}},
        duration=0.1,
        instants=11,
    ),
    mechanism(
        "corner of four",
        "x m -0.5 0,v m/s 0 1,F N 0 1,H N 0 0.6",
        SLIDE.replace("mass: mass", "mass: 1")
        + """
opening_rates: {kick: {joint: slide, rate: v}}
loads:
  push: {part: block, at: o, force: [F, 0, 0]}
  more: {part: block, at: o, force: [H, 0, 0]}
actions: {pin: {type: latch, joint: slide, position: 1.3 m, side: below}}
""",
        corner,
        TRAVEL,
        {"t_latch": {"event": "latches"}, "stays": {"final": "way"}},
        start="x",
        duration=1.0,
        instants=401,
    ),
    mechanism(
        "band of five",
        "u rad/s 0.4 0.7,v rad/s 0.4 0.7,w rad/s 0.4 0.7,M N_m 0.6 1,p rad 1 1.2",
        ROTOR.replace("Iz", "1")
        + """
opening_rates: {kick: {joint: axle, rate: u + v + w}}
actions:
  dry: {type: friction, joint: axle, moment: M, sticks: exactly}
  pin: {type: latch, joint: axle, angle: p, side: below, max_capture_rate: 1 rad/s}
""",
        band,
        ANGLE,
        {"t_latch": {"event": "latches"}, "stays": {"final": "angle"}},
        duration=4.0,
        instants=801,
    ),
    mechanism(
        "outside of a ball",
        "a m/s -1 1,b m/s -1 1,c m/s -1 1,d m/s -1 1",
        SLIDE.replace("mass: mass", "mass: 1")
        + """
opening_rates: {kick: {joint: slide, rate: sqrt(a*a + b*b + c*c + d*d)}}
actions: {pin: {type: latch, joint: slide, position: 0.9 m, side: below}}
""",
        outer,
        TRAVEL,
        {"t_latch": {"event": "latches"}},
        duration=1.0,
        instants=101,
    ),
)
