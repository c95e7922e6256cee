"""Static equilibrium by dynamic relaxation: damping near critical until the scene is at rest."""

from dataclasses import replace

import numpy as np

import fpm
from evidence.verification.bench import Bench
from fpm.scenes.timestep import deformation_modes, scaled_modes


def frequencies(scene: fpm.Scene) -> np.ndarray:
    """Angular frequencies (rad/s) of the scene at its start, hinges cut, zero ones first."""
    matrix = scaled_modes(scene, deformation_modes(scene)[0])[0]
    return np.sqrt(np.abs(np.linalg.eigvalsh((matrix.T @ matrix).toarray())))


def mode_shape(scene: fpm.Scene, frequency: float) -> np.ndarray:
    """Mode (n, 6) of the frequency (rad/s) closest to the given one: translations, rotations.

    Both in the particles' own axes, at unit kinetic energy for unit modal rate."""
    matrix = scaled_modes(scene, deformation_modes(scene)[0])[0]
    values, vectors = np.linalg.eigh((matrix.T @ matrix).toarray())
    shape = vectors[:, np.argmin(np.abs(values - frequency**2))].reshape(-1, 6)
    inertia = np.column_stack([np.tile(scene.mass, (3, 1)).T, scene.inertia])
    return np.sqrt(2 / inertia) * shape


def lowest_frequency(scene: fpm.Scene) -> float:
    """Lowest angular frequency (rad/s) above zero."""
    values = frequencies(scene)
    return float(values[values > 1e-7 * values[-1]][0])


RAMP, REST = 10.0, 25.0
"""Times in units of 1 / lowest frequency: while the loads grow, and from then to the end."""


class NotAtRest(RuntimeError):
    """A scene that did not come to rest in the time given to it."""


def settle(
    bench: Bench, scenes: list[fpm.Scene], rest: float = REST, record=()
) -> list[fpm.Outcome]:
    """Bring loads up slowly and run to rest, in lanes; the last instant is the equilibrium.

    Mass-proportional damping at twice the lowest frequency makes all modes die out like
    exp(-lowest frequency * t). NotAtRest if a scene is not at rest at the end."""
    lowest = min(lowest_frequency(scene) for scene in scenes)
    times = np.linspace(0.0, RAMP / lowest, 33)
    for scene in scenes:
        scene.damping = 2.0 * lowest
        curve = scene.add_curve(times, 0.5 - 0.5 * np.cos(np.pi * times / times[-1]))
        scene.loads = [replace(load, curve=curve) for load in scene.loads]
    duration = (RAMP + rest) / lowest
    outcomes = bench.simulate(scenes, duration=duration, instants=51, record=record)
    for outcome in outcomes:
        kinetic, strain = outcome.energies["kinetic"][-1], outcome.energies["strain"][-1]
        if not kinetic <= 1e-10 * strain:
            raise NotAtRest(
                f"{bench.problem}: not at rest, kinetic energy {kinetic:.3g} J beside "
                f"{strain:.3g} J of strain; relax for longer"
            )
    return outcomes
