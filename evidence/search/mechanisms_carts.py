"""Carts on slides and flaps on hinges, with latches, stops and friction: closed forms."""

from __future__ import annotations

import numpy as np

from evidence.search.mechanisms import Mechanism

UNITS = {"k": "N/m", "k2": "N/m", "r": "m", "r2": "m", "v": "m/s", "mass": "kg", "c": "N s/m",
         "F": "N", "d": "m", "q": "N/m", "idle": "kg", "kt": "N m/rad", "M": "N m", "h": "N m",
         "phi": "rad"}  # fmt: skip
PHASES, WEIGHTS = np.polynomial.legendre.leggauss(160)
SPRING = "push: {type: spring, joint: rail, stiffness: k, rest: %s}; "
PIN = "pin: {type: latch, joint: rail, position: %s, side: below}"
SLOW = ", max_capture_rate: %s m/s}"
X, RATE = {"opening": "rail"}, {"opening_rate": "rail"}
CATCH = {"event": "latches", "of": "pin"}
Values = np.ndarray


def structure(intervals: dict, actions: str, bodies: str = "", joints: str = "", top: str = "",
              opening: str = "0 m") -> str:  # fmt: skip
    """Text of a cart on the slide `rail`, or of a flap on a hinge, and what acts on it."""
    parameters = "".join(
        f"  {name}: {{value: {sum(ends) / 2!r}, unit: {UNITS[name]}, description: {name}}}\n"
        for name, ends in intervals.items()
    )
    kind = "revolute" if "kt" in intervals else "prismatic"
    mass = "mass" if "mass" in intervals else "1 kg"
    start = "opening_rates: {go: {joint: rail, rate: v}}" if "v" in intervals else ""
    pull = "loads: {pull: {part: cart, at: a, force: [-F, 0, 0]}}" if "F" in intervals else ""
    blocks = (
        f"name: cart\nparameters:\n{parameters}points: "
        "{a: [0, 0, 0], b: [0, 2, 0], e: [0, 4, 0]}",
        f"bodies:\n  cart: {{mass: {mass}, centre: a, inertia: [1, 1, 1]}}; {bodies}",
        f"joints:\n  rail: {{type: {kind}, parts: [ground, cart], at: a, "
        f"axis: x, opening: {opening}}}; {joints}",
        f"actions:\n  {actions}",
        start, pull, top,
    )  # fmt: skip
    return "\n".join(block.rstrip("; ").replace("; ", "\n  ") for block in blocks if block) + "\n"


def box(name: str, intervals: dict, quantities: dict, model, actions: str, responses=None,
        duration: float = 3.0, instants: int = 401, margins=None,
        **texts: str) -> Mechanism:  # fmt: skip
    """A mechanism by its intervals and what acts."""
    text = structure(intervals, actions, **texts)
    responses = {"x": X} if responses is None else responses
    return Mechanism(name, text, intervals, responses, quantities, model, duration, instants,
                     margins=margins or {})  # fmt: skip


def reach(x: Values, v: Values, w: Values, level: Values) -> Values:
    """Time at which a harmonic motion, from x below a level with rate v, first reaches it."""
    radius = np.hypot(x, v / w)
    ratio = np.where(radius >= level, level / radius, np.nan)
    return np.mod(np.arctan2(v / w, x) - np.arccos(ratio), 2 * np.pi) / w


def columns(*values: Values) -> Values:
    """Values as columns."""
    return np.stack(np.broadcast_arrays(*values), axis=1)


def exists(condition: Values, values: Values) -> Values:
    """Values where something holds."""
    return np.where(condition, values, np.nan)


def race(v: Values, r: Values, k: Values) -> Values:
    """Times of the first of two latches, 0.5 ahead and 0.4 behind, and of each."""
    w = np.sqrt(k)
    rise, fall = reach(-r, v, w, 0.5 - r), reach(r, -v, w, 0.4 + r)
    first = np.fmin(rise, fall)
    return columns(first, exists(rise == first, rise), exists(fall == first, fall))


def ratchet(v: Values, k: Values, r: Values) -> Values:
    """Times of the second and third tooth, and where it comes to rest on one."""
    w = np.sqrt(k)
    second, third = (reach(r, v, w, r + level) for level in (0.4, 0.6))
    tooth = 0.2 + 0.2 * np.isfinite(second) + 0.2 * np.isfinite(third)
    return columns(second, third, (20e3 * tooth - k * r) / (20e3 + k))


def stick(kt: Values, M: Values, phi: Values) -> Values:
    """Where a flap that dry friction holds stops, its highest rate, and when it passes 0.2."""
    reach_half = np.maximum(phi - M / kt, 0.0)
    passes = np.arccos(1 - np.where(reach_half > 0.1, 0.2 / reach_half, np.nan)) / np.sqrt(kt)
    return columns(2 * reach_half, reach_half * np.sqrt(kt), passes)


def latch(k: Values, r: Values, d: Values = 1.0) -> Values:
    """Time and rate with which a cart is caught that a spring pushes from rest."""
    w = np.sqrt(k)
    time = reach(-r, 0 * r, w, d - r)
    rate = w * np.sqrt(np.maximum(2 * r * d - d * d, 0))
    return columns(time, np.where(np.isfinite(time), rate, 0.0))


def amplitude(k: Values, c: Values, m: Values = 1.0) -> Values:
    """Root mean square, over 12 s, of what sin(10 t) drives from rest."""
    k, c, m = np.broadcast_arrays(k, c, m)
    t, decay = 6 * (PHASES + 1), c / (2 * m)
    size = 1 / (k - 100 * m + 10j * c)
    w = np.sqrt(k / m - decay**2)
    x = -size.imag
    v = -10 * size.real + decay * x
    answer = (size[:, None] * np.exp(10j * t)).imag
    transient = np.exp(-decay[:, None] * t) * (
        x[:, None] * np.cos(w[:, None] * t) + (v / w)[:, None] * np.sin(w[:, None] * t)
    )
    return np.sqrt((answer + transient) ** 2 @ WEIGHTS / 2)[:, None]


def plateau(v: Values, m: Values) -> Values:
    """How far a cart goes into a spring of two slopes, up to a latch at 0.5."""
    energy = m * v**2 / 2
    stretch = np.minimum(2 * np.sqrt(0.9 + energy) - 1.8, 0.5)  # 1 + energy - 0.1 under the root
    return columns(np.where(energy < 0.1, np.sqrt(energy / 2.5), stretch))


def stop(v: Values, k: Values) -> Values:
    """When a stop at 0.25 is hit, how far it is pressed in, and its force."""
    w, q = np.sqrt(k), 400.0
    time = reach(0 * v, v, w, 0.25)
    energy = np.maximum(v**2 - k * 0.0625, 0)
    deep = (np.sqrt(k**2 * 0.0625 + (k + q) * energy) - 0.25 * k) / (k + q)
    return columns(time, np.where(energy > 0, 0.25 + deep, v / w), -q * deep)


def margin(kt: Values, M: Values, h: Values) -> Values:
    """Least margin of a spring against friction and a harness, at 0.7 rad or at the end."""
    return columns(kt / 3 * np.minimum(1.8 / (M + h), (2.5 - np.pi / 2) / M) - 1)


def separatrix(v: Values, q: Values) -> Values:
    """Time at which a cart that is pushed back before 0, and away behind it, comes to 0.5."""
    w = np.sqrt(q)
    growth, decay = (v / w - 0.5) / 2, (-0.5 - v / w) / 2
    growth = np.where(growth > 0, growth, np.nan)
    times = [
        np.log((level + np.sqrt(level**2 - 4 * growth * decay)) / (2 * growth)) / w
        for level in (0.45, 0.5)
    ]
    return columns(*(exists(time <= 3, time) for time in times))


def capture(v: Values, k: Values) -> Values:
    """Times at which a latch at 0.3 catches, and at which it is passed too fast."""
    time = reach(0 * v, v, np.sqrt(k), 0.3)
    fast = v**2 - 0.09 * k > 0.64
    return columns(exists(~fast, time), exists(fast, time))


def swings(v: Values, k: Values, c: Values) -> Values:
    """Time at which a damped cart comes up to 0.2 slowly enough, at most 0.9, and how fast."""
    a = c / 2
    w = np.sqrt(k - a**2)
    x = lambda t: v / w * np.exp(-a * t) * np.sin(w * t)  # noqa: E731
    rate = lambda t: v * np.exp(-a * t) * (np.cos(w * t) - a / w * np.sin(w * t))  # noqa: E731
    catch = np.full(len(v), np.nan)
    for number in range(4):
        peak = (np.arctan2(w, a) + 2 * np.pi * number) / w
        low = np.maximum(peak - np.pi / w, 0)
        high, rises = peak, x(peak) >= 0.2
        for _ in range(60):
            middle = (low + high) / 2
            side = x(middle) >= 0.2
            low, high = np.where(side, low, middle), np.where(side, middle, high)
        catches = rises & (rate(high) <= 0.9) & np.isnan(catch) & (high <= 3)
        catch = np.where(catches, high, catch)
    return columns(catch, np.where(np.isfinite(catch), rate(catch), 0.0))


def of_columns(function):
    """A model of points (P, k) from a function of their columns."""
    return lambda points: function(*np.asarray(points, dtype=float).T)


RACE = ("up: {type: latch, joint: rail, position: 0.5 m, side: below}; "
        "down: {type: latch, joint: rail, position: -0.4 m, side: above}")  # fmt: skip
FIRST = {"first": {"event": "latches"}, "ahead": {"event": "latches", "of": "up"},
         "behind": {"event": "latches", "of": "down"}}  # fmt: skip
TEETH = "; ".join(
    f"{name}: {{type: latch, joint: rail, position: {level} m, side: below, holds: one way, "
    "stiffness: 20 kN/m, damping: 100 N s/m}"
    for name, level in (("one", 0.2), ("two", 0.4), ("three", 0.6))
)
CATCH_QUANTITIES = {"t": CATCH, "rate": {"final": "caught"}}
WITH_RATE = {"x": X, "caught": {"latch_rate": "pin"}}
DRIVE = ("curves: {wave: {expression: sin(10 rad/s * t), over: [0, 12 s]}}\n"
         "loads: {push: {part: cart, at: a, force: [1 N, 0, 0], curve: wave}}")  # fmt: skip
DAMPER = "oil: {type: damper, joint: rail, damping: c}"
RMS = {"size": {"rms": "x"}}

BOXES = (
    box("race, three parameters", {"v": (0.4, 2.2), "r": (-0.2, 0.2), "k": (6, 12)}, FIRST,
        of_columns(race), SPRING % "r" + RACE),
    box("ratchet", {"v": (1.3, 2.2), "k": (4, 8), "r": (0.1, 0.3)},
        {"t2": {"event": "latches", "of": "two"}, "t3": {"event": "latches", "of": "three"},
         "end": {"final": "x"}}, of_columns(ratchet), SPRING % "-r" + TEETH),
    box("stick and slip", {"kt": (2, 4), "M": (0.6, 1.5), "phi": (0.35, 0.45)},
        {"end": {"final": "x"}, "fastest": {"largest": "w"},
         "passes": {"crossing": "x", "level": 0.2, "way": "rising"}}, of_columns(stick),
        "push: {type: torsion spring, joint: rail, stiffness: kt, rest: phi}; "
        "dry: {type: friction, joint: rail, moment: M, sticks: exactly}",
        {"x": X, "w": RATE}, opening="0"),
    box("latch in 5 %", {"k": (15, 25), "r": (0.4, 0.54), "d": (1.0, 1.2)}, CATCH_QUANTITIES,
        of_columns(latch), SPRING % "r" + PIN % "d", WITH_RATE),
    box("needle, two parameters", {"k": (60, 140), "c": (0.2, 0.6)}, RMS, of_columns(amplitude),
        SPRING % "0 m" + DAMPER, duration=12, instants=1201, top=DRIVE),
    box("plateau", {"v": (0.3, 1.1), "mass": (0.8, 1.2)}, {"far": {"largest": "x"}},
        of_columns(plateau), "bent: {type: tabulated spring, joint: rail, "
        "positions: [0 m, 0.2 m, 0.6 m], forces: [0 N, -1 N, -1.2 N]}; " + PIN % "0.5 m"),
    box("stop hit or not", {"v": (0.4, 1.2), "k": (4, 8)},
        {"t": {"event": "hits"}, "far": {"largest": "x"}, "force": {"smallest": "f"}},
        of_columns(stop), SPRING % "0 m"
        + "end: {type: stop, joint: rail, upper: 0.25 m, stiffness: 400 N/m}",
        {"x": X, "f": {"joint_moment": "rail", "part": "stop"}}, duration=1.2),
    box("margin", {"kt": (0.8, 1.2), "M": (0.1, 0.2), "h": (0.05, 0.25)}, {}, of_columns(margin),
        "push: {type: torsion spring, joint: rail, stiffness: kt, rest: 2.5 rad}; "
        "dry: {type: friction, joint: rail, moment: M}; wires: {type: tabulated spring, "
        "joint: rail, angles: [0, 0.7 rad, 1.4 rad], moments: [0, -h, 0]}", {}, duration=0.001,
        opening="0",
        margins={"sheet": {"along": "rail", "to": "90 deg", "standard": "nasa-std-5017b"}}),
    box("separatrix", {"v": (0.8, 1.6), "q": (3.5, 4.5)},
        {"t": {"crossing": "x", "level": 0.45, "way": "rising"}, "t2": CATCH},
        of_columns(separatrix), "away: {type: tabulated spring, joint: rail, "
        "positions: [-1 m, 1 m], forces: [-q*(1 m), q*(1 m)]}; " + PIN % "0.5 m", opening="-0.5 m"),
    box("passed too fast", {"v": (0.6, 1.4), "k": (2, 6)},
        {"t": CATCH, "missed": {"event": "misses"}}, of_columns(capture),
        SPRING % "0 m" + (PIN % "0.3 m").replace("}", SLOW % 0.8), duration=1),
    box("caught by a later swing", {"v": (0.8, 2), "k": (9, 16), "c": (0.4, 0.8)}, CATCH_QUANTITIES,
        of_columns(swings),
        SPRING % "0 m" + DAMPER + "; " + (PIN % "0.2 m").replace("}", SLOW % 0.9),
        WITH_RATE),
)  # fmt: skip
