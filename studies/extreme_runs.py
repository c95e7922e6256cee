"""Extremes of how a run is made: starts, meshes, durations, damping, precision, intervals."""

import time

import numpy as np

import fpm
from studies.judge import attempt, compare, judge, refusal
from studies.linkage import BALANCE, build, closing_time, curves, distance, first_closing, imbalance
from studies.linkage import simulate as run
from studies.rows import Row

CLOSED = 120.0
"""Opening at B (degrees) between the folded bundle and closure."""


def rest(name: str, parameters: dict, tolerance: float = 1e-9) -> Row:
    """A linkage without a force that moves it stays where it is."""
    outcome = run(0.2, **parameters)
    if outcome.failure:
        return Row(name, str(outcome.failure), 0.0, tolerance, False, "nothing moves (m)")
    moved = max(float(np.abs(x - x[0]).max()) for x, _ in outcome.points.values())
    return Row(name, moved, 0.0, tolerance, moved <= tolerance, "nothing moves (m)")


def starts() -> list[Row]:
    rows = []
    for degrees in (0.0, 0.01):
        name = f"start {degrees:g}° from the folded bundle"
        rows += judge(name, {"start_deg": degrees}, 0.002)
        stiff = {"start_deg": degrees, "E": 2.1e11}
        rows += judge(f"{name}, E = 2.1e11 Pa", stiff, 0.002, against="rigid")
    # So near to closure the linkage moves by micrometres, and the links' own bending as much.
    stiff = {"start_deg": CLOSED - 0.01, "E": 2.1e11}
    rows += judge("start 0.01° from closure, E = 2.1e11 Pa", stiff, 0.02, against="rigid",
                  duration=0.02, past_closure=True)  # fmt: skip
    rows += judge("start 0.01° from closure", {"start_deg": CLOSED - 0.01}, 0.04,
                  duration=0.02, past_closure=True)  # fmt: skip
    rows.append(rest("start at closure", {"start_deg": CLOSED}))
    rows.append(rest("K_F = 0", {"K_F": 0.0}))
    return rows


def meshes() -> list[Row]:
    """1 to 64 elements a link, against 80; the tolerance is what a mesh promises."""
    duration = closing_time()
    expected = run(duration, elements_per_link=80)
    rows = []
    for elements, tolerance in (
        (1, 0.3), (2, 0.005), (4, 0.002), (8, 5e-4), (16, 1e-4), (32, 5e-5), (64, 2e-5),
    ):  # fmt: skip
        name = f"{elements} elements a link"
        outcome, error = attempt(duration, (elements, 0.9), {})
        if outcome is None:
            rows.append(refusal(name, error))
            continue
        until = 0.98 * min(first_closing(expected), first_closing(outcome))
        source = "80 elements a link"
        row = compare(name, outcome, curves(expected), until, tolerance, source)
        rows.append(row)
    return rows


def durations() -> list[Row]:
    rows = []
    (long,) = fpm.simulate([build()], duration=20.0, instants=4001)
    off, gap, tilt = imbalance(long), long.gap.max(), long.axis_gap.max()
    rows += [
        Row("20 s: energy from nowhere", off, 0.0, 0.02, off <= 0.02, "energy balance"),
        Row("20 s: gap of a hinge (m)", float(gap), 0.0, 1e-10, bool(gap <= 1e-10), "hinge"),
        Row("20 s: tilt of a hinge (rad)", float(tilt), 0.0, 1e-9, bool(tilt <= 1e-9), "hinge"),
    ]
    # So short a time is less than a wave needs from one end of a link to the other.
    short, fine = (curves(run(1e-4, instants=11, elements_per_link=n))["BD"] for n in (8, 64))
    error = float(np.abs(short - fine).max())
    source = "64 elements a link; BD itself is 0.6 m"
    rows.append(Row("1e-4 s: error of BD (m)", error, 0.0, 5e-6, error <= 5e-6, source))
    return rows


def oscillator(rate: float, angle: float, times: np.ndarray) -> np.ndarray:
    """Angle of theta'' + rate theta' + theta = 0 from rest at `angle`; frequency 1 rad/s."""
    root = np.sqrt(complex(rate**2 / 4 - 1)) or 1e-5
    fast, slow = -rate / 2 - root, -rate / 2 + root
    shares = fast / (fast - slow), -slow / (fast - slow)
    return (angle * (shares[0] * np.exp(slow * times) + shares[1] * np.exp(fast * times))).real


def damping() -> list[Row]:
    """A stiff bar on a torsion spring: closed form, from light damping to far beyond critical."""
    rows = []
    pendulum = fpm.scenes.get("pendulum")
    length, side, rho = 1.0, 0.05, 1000.0
    inertia = rho * side**2 * length * (length**2 / 3 + side**2 / 12)
    frequency = 10.0
    for share in (0.01, 0.5, 1.0, 2.0, 20.0, 1e3, 1e5):
        rate = 2 * share * frequency
        scene = pendulum.build(
            L=length, a=side, rho=rho, E=2.1e11, g=0.0, angle_deg=30.0, elements=2,
            K_F=inertia * frequency**2, damping=rate,
        )  # fmt: skip
        duration = 4 * np.pi / frequency
        (outcome,) = fpm.simulate([scene], duration=duration, instants=201)
        theory = oscillator(rate / frequency, np.radians(30.0), outcome.time * frequency)
        error = float(np.abs(outcome.openings["O"] - theory).max() / np.radians(30.0))
        passed = error <= 2e-3 and imbalance(outcome) <= BALANCE
        name = f"damping {share:g} times critical"
        note = f"energy {imbalance(outcome):.1g}, rate {rate:g} /s"
        rows.append(Row(name, error, 0.0, 2e-3, passed, "damped oscillator, closed form", note))
    return rows


def precision() -> list[Row]:
    """Single against double precision: sixteen lanes against eight of the same register."""
    duration = closing_time()
    scenes = [build(a=0.035 * (1 + 1e-3 * i), elements_per_link=8) for i in range(16)]
    found, cost = {}, {}
    for dtype in (np.float64, np.float32):
        fpm.simulate(scenes, duration=1e-4, instants=2, dtype=dtype)  # compile
        begun = time.process_time()
        found[dtype] = fpm.simulate(
            scenes, duration=duration, instants=401, dtype=dtype, step=2.5e-5, energy_tolerance=1.0
        )
        cost[dtype] = time.process_time() - begun
    double, single = found[np.float64][0], found[np.float32][0]
    inside = double.time < 0.98 * first_closing(double)
    position, velocity = distance(curves(single), curves(double), inside)
    off = imbalance(single)
    refused = fpm.simulate(scenes[0], duration=duration, instants=401, dtype=np.float32)[0].failure
    source = "the same 16 runs in 64 bits"
    saved = 1 - cost[np.float32] / cost[np.float64]
    note = f"velocity of B {velocity:.2g}, energy from nowhere {off:.2g}"
    good = position <= 0.002 and off <= BALANCE
    rows = [
        Row("32-bit floats: error of BD", position, 0.0, 0.002, bool(good or refused), source, note)
    ]
    text = "measured, no target"
    rows.append(Row("32-bit floats: share of cpu time saved", saved, 0.5, text, True, source))
    if refused:
        rows.append(refusal("32-bit floats", refused))
    return rows


def intervals() -> list[Row]:
    """Wide intervals and intervals of no width, through the interval library."""
    from intervals import Box, fit, make_design, surrogate_range

    def responses(names, values):
        scenes = [build(**dict(zip(names, map(float, row), strict=True))) for row in values]
        outcomes = fpm.simulate(scenes, duration=0.2, instants=201)
        return np.array([curves(o)["BD"] for o in outcomes])

    rows = []
    for name, parameters in (
        ("K_F ± 50 %", {"K_F": (2.5, 7.5)}),
        ("a ± 50 %", {"a": (0.0175, 0.0525)}),
        ("E ± 50 %", {"E": (0.5e9, 1.5e9)}),
    ):
        names = tuple(parameters)
        lower, upper = zip(*parameters.values(), strict=True)
        box = Box(names, lower, upper)
        design = make_design("tensor_roots", box, 8)
        surrogate = fit(design, responses(names, box.from_unit(design.points)))
        bounds = surrogate_range(surrogate)
        scan = responses(names, np.linspace(lower, upper, 33))
        worst = float(
            max(np.abs(scan.min(0) - bounds.lower).max(), np.abs(scan.max(0) - bounds.upper).max())
        )
        span = float(np.ptp(scan))
        rows.append(
            Row(
                f"interval {name}, order 8: bounds of BD", worst / span, 0.0, 0.01,
                worst / span <= 0.01, "33 runs across the interval",
            )
        )  # fmt: skip
    box = Box(("K_F", "a"), (5.0, 0.035), (5.0, 0.035))
    design = make_design("tensor_roots", box, 3)
    surrogate = fit(design, responses(box.names, box.from_unit(design.points)))
    bounds = surrogate_range(surrogate)
    curve = responses(box.names, [[5.0, 0.035]])[0]
    worst = float(max(np.abs(bounds.lower - curve).max(), np.abs(bounds.upper - curve).max()))
    rows.append(
        Row("intervals of zero width: bounds of BD (m)", worst, 0.0, 1e-12, worst <= 1e-12,
            "the run itself", f"{len(design.points)} run")
    )  # fmt: skip
    return rows
