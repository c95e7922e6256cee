"""Speed against accuracy of one run: the choices, and how each is measured.

The paper's linkage is run with many meshes, steps, factors on the rotational inertia and lumpings
of the mass, and compared with a reference of 80 elements a link, whose step is more than twenty
times shorter than that of 12. Errors are told apart by phase of the motion: before the first
closure, between the closures, after the second; past an impact the curves of a finer mesh still
differ, and by how much two equally good runs differ is measured by changing the step a little."""

import time
from dataclasses import dataclass

import numpy as np

import fpm
from evidence.linkage.runs import build, curves
from fpm.elements.bars.lumping import end_weights

DURATION = 1.2
INSTANTS = 2401
REFERENCE = 80


@dataclass(frozen=True)
class Choice:
    """How a run is made: elements a link, share of the stable step, factor f, lumping."""

    elements: int
    safety: float = 0.9
    scale: float = 1.0
    lumping: str = "default"


@dataclass(frozen=True)
class Phase:
    """Errors of one phase: largest and root mean square, of BD (m) and of B's z-velocity (m/s)."""

    name: str
    bd: float
    bd_rms: float
    velocity: float
    velocity_rms: float


@dataclass(frozen=True)
class Result:
    """What one choice costs and what it gets wrong."""

    choice: Choice
    steps: int
    element_steps: int
    cpu: float
    phases: tuple[Phase, ...]


def weights(kind: str, elements: int) -> np.ndarray:
    """Shares (n+1,) of an element's mass: trapezium rule, or Gregory's of second or third order.

    Second order with the end shift n / (12 (n - 1)), which keeps the link's inertia exact."""
    shares = end_weights(elements, 2 if kind == "gregory-3" else 0)
    if kind == "gregory-2":
        shift = elements / (12 * (elements - 1))
        shares[[0, -1]] -= shift
        shares[1] += shift
        shares[-2] += shift
    return shares


def scene_of(choice: Choice) -> fpm.Scene:
    """The linkage for a choice; another lumping replaces the masses of all links."""
    scene = build(elements=choice.elements, inertia=choice.scale)
    if choice.lumping != "default":
        whole = scene.mass.sum() / len(scene.beams) / choice.elements
        scene.mass = np.tile(whole * weights(choice.lumping, choice.elements), len(scene.beams))
    return scene


def simulate(choice: Choice) -> tuple[fpm.Outcome, float]:
    """The outcome of one choice and its cpu time (s), for a full register of samples."""
    scene = scene_of(choice)
    start = time.process_time()
    (outcome,) = fpm.simulate([scene], duration=DURATION, instants=INSTANTS, safety=choice.safety)
    if outcome.failure:
        raise outcome.failure
    return outcome, time.process_time() - start


def phases_of(reference: fpm.Outcome) -> list[tuple[str, float, float]]:
    """Name, start and end (s) of the phases, with a margin of 5 ms about the impacts."""
    closings = reference.events[reference.events[:, 2] == 1, 0]
    openings = reference.events[reference.events[:, 2] == 0, 0]
    second = closings[closings > closings[0] + 0.1][0]
    largest = openings[openings < second - 0.1].max()
    last = max(openings.max(), second + 0.02)
    return [
        ("before", 0.0, closings[0] - 5e-3),
        ("between", largest + 5e-3, second - 5e-3),
        ("after", last + 5e-3, DURATION),
    ]


def errors(outcome: fpm.Outcome, reference: fpm.Outcome) -> tuple[Phase, ...]:
    """Errors of one outcome by phase."""
    result, expected = curves(outcome), curves(reference)
    rows = []
    for name, first, last in phases_of(reference):
        window = (reference.time >= first) & (reference.time <= last)
        bd = np.abs(result["BD"] - expected["BD"])[window]
        velocity = np.abs(result["vBz"] - expected["vBz"])[window]
        rms = [float(np.sqrt(np.mean(e**2))) for e in (bd, velocity)]
        rows.append(Phase(name, float(bd.max()), rms[0], float(velocity.max()), rms[1]))
    return tuple(rows)


MESHES = (4, 8, 12, 16, 24)
CHOICES = (
    [Choice(n) for n in (2, 4, 6, 8, 10, 12, 16, 24, 32)]
    + [Choice(n, safety=s) for n in (8, 12) for s in (0.95, 0.45, 0.2, 0.1)]
    + [Choice(n, scale=f) for n in (8, 12, 16) for f in (1.5, 2.0, 3.0)]
    + [Choice(n, lumping=k) for k in ("trapezium", "gregory-2", "gregory-3") for n in MESHES]
)


def measure(choices: list[Choice], reference: fpm.Outcome) -> list[Result]:
    """Results of all choices."""
    results = []
    for choice in choices:
        outcome, cpu = simulate(choice)
        elements = 4 * choice.elements
        phases = errors(outcome, reference)
        results.append(Result(choice, outcome.steps, elements * outcome.steps, cpu, phases))
    return results


def reproducibility() -> Phase:
    """How far two equally good runs part by the end: the default mesh, the step 1 % shorter."""
    first, second = (simulate(Choice(12, s))[0] for s in (0.9, 0.85))
    return errors(first, second)[-1]
