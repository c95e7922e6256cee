"""Extremes of how a run is made: starts, durations, damping."""

from dataclasses import replace

import numpy as np

import fpm
from deployable.campaign.config.sections import scene_type
from evidence.extremes.judge import judge, persist
from evidence.linkage.runs import BALANCE, curves, imbalance
from evidence.linkage.runs import simulate as run
from evidence.rows import Row, at_most

CLOSURE = 120.0
"""Opening at B (degrees) between the folded bundle and closure."""

WAVES = (0.002, 0.1)
"""Accuracy of BD and of B's velocity where the linkage moves by micrometres, and waves in its links
as much."""


def rest(name: str, parameters: dict, tolerance: float = 1e-9) -> Row:
    """A linkage without a force that moves it stays where it is."""
    outcome = run(0.2, **parameters)
    if outcome.failure:
        return Row(name, str(outcome.failure), passed=False, source="nothing moves (m)")
    motion = max(float(np.abs(x - x[0]).max()) for x, _ in outcome.points.values())
    return at_most(name, motion, tolerance, "nothing moves (m)")


def starts() -> list[Row]:
    rows = []
    for degrees in (0.0, 0.01):
        name = f"start {degrees:g}° from the folded bundle"
        rows += judge(name, {"start": degrees})
        stiff = {"start": degrees, "E": 2.1e11}
        rows += judge(f"{name}, E = 2.1e11 Pa", stiff, reference="rigid")
    name, close = "start 0.01° from closure", {"start": CLOSURE - 0.01}
    options = {"duration": 0.02, "is_whole_run": True}
    rows += judge(f"{name}, E = 2.1e11 Pa", {**close, "E": 2.1e11}, reference="rigid", **options)
    rows += judge(name, close, WAVES, **options)
    rows.append(rest("start at closure", {"start": CLOSURE}))
    rows.append(rest("K_F = 0", {"K_F": 0.0}))
    return rows


def durations() -> list[Row]:
    """A hundred closures; and less time than a wave needs from one end of a link to the other."""
    rows, name, _, long = persist("20 s", 20.0, {}, instants=4001)
    if long is None:
        return rows
    energy_error, names = imbalance(long), ("hinge_gap", "hinge_axis_gap")
    gap, tilt = (float(long.records[n].values.max()) if n in long.records else 0.0 for n in names)
    rows += [
        at_most(f"{name}: energy from nowhere", energy_error, BALANCE, "energy balance"),
        at_most(f"{name}: gap of a hinge (m)", gap, 1e-10, "hinge"),
        at_most(f"{name}: tilt of a hinge (rad)", tilt, 1e-9, "hinge"),
    ]
    # Bending has spread by sqrt(c r t) = 34 mm then: less than an element of twelve to a link.
    fine = curves(run(1e-4, instants=11, elements=128, safety=0.45))["BD"]
    span = float(np.ptp(fine))
    for elements, tolerance in ((12, 0.5), (32, 0.1), (64, 0.02)):
        bd = curves(run(1e-4, instants=11, elements=elements))["BD"]
        error = float(np.abs(bd - fine).max()) / span
        name = f"1e-4 s, {elements} elements: BD, as a share of its way"
        note = f"BD is 54 mm and moves by {span:.2g} m"
        rows.append(at_most(name, error, tolerance, "128 elements a link", note))
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
    pendulum = scene_type("pendulum")
    length, side, rho = 1.0, 0.05, 1000.0
    inertia = rho * side**2 * length * (length**2 / 3 + side**2 / 12)
    frequency = 10.0
    for share in (0.01, 0.5, 1.0, 2.0, 20.0, 1e3, 1e5):
        rate = 2 * share * frequency
        scene = pendulum.build(L=length, a=side, rho=rho, E=2.1e11, g=0.0, angle=30.0, elements=2)
        scene.add_torsion_spring(0, inertia * frequency**2)
        scene.damping = rate
        duration = 4 * np.pi / frequency
        (outcome,) = fpm.simulate([scene], duration=duration, instants=201)
        theory = oscillator(rate / frequency, np.radians(30.0), outcome.time * frequency)
        error = float(np.abs(outcome.openings["O"] - theory).max() / np.radians(30.0))
        name = f"damping {share:g} times critical"
        energy_error = imbalance(outcome)
        note = f"energy {energy_error:.1g}, rate {rate:g} /s"
        row = at_most(name, error, 2e-3, "damped oscillator, closed form", note)
        rows.append(replace(row, passed=row.passed and energy_error <= BALANCE))
    return rows
