"""The readings of the paper that are tried, and over which values of K_F."""

import math

import numpy as np

from evidence.calibration.scans import Reading
from evidence.linkage.rigid import RigidBennett
from evidence.linkage.runs import default

STARTS = (1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0)
MESHES = (8, 16, 32)
MU_B = 22.5


def grid(first: float, last: float, spacing: float) -> np.ndarray:
    """Evenly spaced values, free of rounding noise in their decimals."""
    return np.round(np.arange(first, last + spacing / 2, spacing), 6)


GRID = grid(4.8, 7.2, 0.05)

Plan = list[tuple[Reading, np.ndarray]]
"""Readings and the values of K_F (N/rad) of each."""


def defaults() -> Plan:
    """The scene's own reading, finely and over a wide range."""
    return [(Reading("default"), np.union1d(grid(3.0, 8.0, 0.1), grid(4.8, 7.2, 0.025)))]


def meshes() -> Plan:
    """Other meshes and half the step."""
    readings = [
        (Reading(f"{n} elements a link", (("elements", n),)), GRID)
        for n in MESHES
        if n != default("elements")
    ]
    return [*readings, (Reading("step × 0.5", (), 0.45), grid(5.2, 5.8, 0.05))]


def starts() -> Plan:
    """Other starts, those of the paper's angle μ_B among them."""
    starts = [start for start in STARTS if start != default("start")]
    readings = [(Reading(f"start {s:g}°", (("start", s),)), GRID) for s in starts]
    for label, angle in (("half", MU_B), ("whole", MU_B / 2)):
        start = round(start_of_half_angle(angle), 6)
        reading = Reading(f"start at μ_B as {label} angle at B", (("start", start),))
        readings.append((reading, grid(1.0, 7.0, 0.1)))
    return readings


def supports() -> Plan:
    """Other supports."""
    return [
        (Reading("A and C free", (("supports", "free"),)), grid(3.0, 7.0, 0.05)),
        (Reading("A pinned", (("supports", "pinned"),)), grid(3.0, 9.0, 0.1)),
    ]


def start_of_half_angle(degrees: float) -> float:
    """Start (degrees) at which half the angle between two bars' axes at B is `degrees`.

    The reading of mu_B = 22.5° as the angle from which the paper starts."""
    from scipy.optimize import brentq

    linkage = RigidBennett(lambda_deg=default("roll"), mu_deg=default("mu"))

    def excess(beta):
        axis = linkage.motion(beta)["rotation"][0] @ linkage.axis  # of bar AB; B is at x = 0
        return math.degrees(math.asin(abs(axis[0]))) - degrees

    beta = brentq(excess, linkage.beta_deployed, linkage.beta_folded)
    return math.degrees(linkage.folded_opening_b - linkage.motion(beta)["opening_b"][0])
