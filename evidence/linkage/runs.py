"""Runs of the Bennett linkage, their curves, and how far two of them are apart."""

from dataclasses import replace
from typing import Any

import numpy as np

import fpm
from deployable.campaign.config.sections import scene_type

INSTANTS = 801
BALANCE = 0.005
"""Largest share of the energy that may come from nowhere; with 0.02 wrong curves have passed."""


SUPPORTS = {"plane": {"A": "z", "C": "z"}, "pinned": {"A": "xyz"}, "free": {}}
"""Global axes along which the hinge points are held; the structure's own are the first."""


def build(supports: str = "plane", **parameters) -> fpm.Scene:
    """The paper's linkage with some parameters changed, on some supports."""
    scene, axes = scene_type("bennett").build(**parameters), SUPPORTS[supports]
    scene.hinges = [replace(hinge, support=axes.get(hinge.name, "")) for hinge in scene.hinges]
    return scene


def default(name: str) -> Any:
    """Default of one of the linkage's parameters."""
    return scene_type("bennett").parameters[name].default


def complete(parameters: dict) -> dict:
    """All parameters of the linkage: those given, and the defaults of the others."""
    types = scene_type("bennett").parameters
    return {**{name: p.default for name, p in types.items()}, **parameters}


def closing_time(**parameters) -> float:
    """Time (s) of the first closure by dimensional analysis, fitted to the paper's linkage.

    Springs of K_F a rad move masses rho a² L over lengths L: t ~ sqrt(rho a L³ / K_F)."""
    p = complete(parameters)
    return 0.453 * float(np.sqrt(p["rho"] * p["a"] * p["L"] ** 3 / p["K_F"]))


def simulate(
    duration: float,
    *,
    safety: float = 0.9,
    instants: int = INSTANTS,
    **parameters,
) -> fpm.Outcome:
    """One run of the linkage, refused where the error of its energy balance exceeds BALANCE."""
    (outcome,) = fpm.simulate(
        [build(**parameters)],
        duration=duration,
        instants=instants,
        safety=safety,
        energy_tolerance=BALANCE,
    )
    return outcome


def curves(outcome: fpm.Outcome) -> dict[str, np.ndarray]:
    """BD (m) and the z-velocity of B (m/s) at the recorded instants."""
    b, d = outcome.points["B"], outcome.points["D"]
    return {"BD": np.linalg.norm(b[0] - d[0], axis=1), "vBz": b[1][:, 2]}


def first_closing(outcome: fpm.Outcome) -> float:
    """Time (s) of the first contact; infinity if there is none."""
    closing = outcome.events[outcome.events[:, 2] == 1, 0]
    return float(closing[0]) if closing.size else np.inf


def distance(
    result: dict[str, np.ndarray], expected: dict[str, np.ndarray], window: np.ndarray
) -> tuple[float, float]:
    """Largest error of BD and root mean square error of vBz over instants, as shares of the range.

    The velocity carries waves of all lengths, which the release of the springs at rest starts; they
    are finer than any mesh, so its largest error is a matter of chance."""
    error = {k: result[k][window] - expected[k][window] for k in result}
    span = {k: np.ptp(expected[k][window]) or 1.0 for k in result}
    return (
        float(np.abs(error["BD"]).max() / span["BD"]),
        float(np.sqrt(np.mean(error["vBz"] ** 2)) / span["vBz"]),
    )


def imbalance(outcome: fpm.Outcome) -> float:
    """Largest energy from nowhere, as a share of the largest energy held."""
    energies = outcome.energies
    energy = sum(energies[k] for k in ("kinetic", "strain", "spring", "contact"))
    return float(np.abs(energies["balance"]).max() / max(np.abs(energy).max(), 1e-300))
