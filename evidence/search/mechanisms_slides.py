"""Boxes of slides and rotors with known bounds: slack, friction, stall, play, releases.

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


def stall(T, wn, k):
    """A motor that winds up a spring, and may stall before it has turned by 1 rad."""
    J, rest = 0.1, T / k
    w, d = np.sqrt(k / J), T / (2 * wn * J)
    times = np.linspace(0, 6, 121)

    def turn(t):
        return rest[:, None] + swing(t, *column(-rest, 0 * rest, w, d))

    reach = crossing(lambda t: turn(t) - 1, times)
    return reach, summit(turn, times)


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


def chain(ta, ka, JA, kb):
    """A panel let go at a time, whose latch, unless it is passed too fast, lets another go."""
    w = np.sqrt(ka / JA)
    rate = w * np.sqrt(1.2**2 - 0.2**2)
    latch = np.where(rate < 3, ta + np.arccos(1 - 1 / 1.2) / w, np.nan)
    last = np.where(rate < 3, 1.0, 1.2 * (1 - np.cos(w * (2.0 - ta))))
    return latch, latch + np.arccos(1 - 1 / 3) / np.sqrt(kb / 0.5), last


def settle(x, k, J, c):
    """When a damped hub has come to rest: one swing more or less is a jump."""
    times = np.linspace(0, 6, 241)

    def turn(t):
        return swing(t, *column(x, 0 * x, np.sqrt(k / J), c / (2 * J)))

    return (6 - crossing(lambda t: abs(turn(6 - t)) - 0.05, times, 1, 1),)


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
)
