"""Speed against accuracy of one run: the choices, and how each is measured.

The paper's linkage is run with many meshes, steps, factors on the rotational inertia and lumpings
of the mass, and compared with a reference of 80 elements a link, whose step is more than twenty
times shorter than that of 12. Errors are told apart by phase of the motion: before the first
closure, between the closures, after the second; past an impact the curves of a finer mesh still
differ, and by how much two equally good runs differ is measured by changing the step a little.

Lumping "fitted" is a chain of few elements of unlike lengths (`CHAINS`), whose numbers are those of
a least-squares fit, at one step: first frequencies, below 700 Hz and as leapfrog has them, of the
paper's link with free, pinned, guided and clamped ends (for 3 elements instead its dynamic
stiffness at imaginary frequencies); its masses condensed to its ends; mass and inertia exactly; and
the highest frequency that the step allows."""

import time
from dataclasses import dataclass, replace

import numpy as np

import fpm
from evidence.linkage.runs import build, curves
from fpm.elements.bars.lumping import end_weights

DURATION = 1.2
INSTANTS = 2401
REFERENCE = 80


@dataclass(frozen=True)
class Choice:
    """How a run is made: elements a link, share of the stable step, factor f, lumping, factor on
    the axial stiffness."""

    elements: int
    safety: float = 0.9
    scale: float = 1.0
    lumping: str = "default"
    axial: float = 1.0


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


@dataclass(frozen=True)
class Chain:
    """Half of a fitted link, from an end to the middle: particles at shares of its length, their
    shares of its mass, rotational inertias over M L², and shares of the inertia about its axis."""

    places: tuple[float, ...]
    masses: tuple[float, ...]
    inertias: tuple[float, ...]
    polar: tuple[float, ...]


CHAINS = {
    3: Chain((0, 0.2758), (0.0793, 0.4207), (1.478e-4, 7.992e-4), (0.087, 0.413)),
    4: Chain(
        (0, 0.1943, 0.5), (0.0562, 0.2915, 0.3046), (1.013e-4, 4.572e-4, 1.376e-4),
        (0.075, 0.246, 0.358),
    ),
    5: Chain(
        (0, 0.1419, 0.3803), (0.0372, 0.2242, 0.2386), (1.066e-4, 2.312e-4, 1.118e-4),
        (0.059, 0.181, 0.26),
    ),
}  # fmt: skip
"""Fitted links by the number of elements, at steps of 1/10,000, 1/15,000 and 1/20,000 s."""


def fit_links(scene: fpm.Scene, elements: int) -> None:
    """Make all links of a scene fitted ones."""
    half = CHAINS[elements]
    count = len(scene.beams)
    other_half = slice(elements - len(half.places), None, -1)

    def whole(values: tuple[float, ...]) -> np.ndarray:
        return np.array((*values, *values[other_half]))

    places = np.array((*half.places, *(1 - x for x in half.places[other_half])))
    length, mass = scene.beams[0].length.sum(), scene.mass.sum() / count
    polar = scene.inertia[:, 0].sum() / count
    transverse = mass * length**2 * whole(half.inertias)
    inertia = np.column_stack([polar * whole(half.polar), transverse, transverse])
    scene.mass = np.tile(mass * whole(half.masses), count)
    scene.inertia = np.tile(inertia, (count, 1))
    for k, beams in enumerate(scene.beams):
        line = scene.position[k * (elements + 1) : (k + 1) * (elements + 1)]
        line[:] = line[0] + places[:, None] * (line[-1] - line[0])
        scene.beams[k] = replace(beams, length=length * np.diff(places))


def scene_of(choice: Choice) -> fpm.Scene:
    """The linkage for a choice; another lumping replaces the masses of all links."""
    scene = build(elements=choice.elements, inertia=choice.scale)
    if choice.axial != 1:
        section = replace(scene.beams[0].section, A=choice.axial * scene.beams[0].section.A)
        scene.beams[:] = [replace(beams, section=section) for beams in scene.beams]
    if choice.lumping == "fitted":
        fit_links(scene, choice.elements)
    elif choice.lumping != "default":
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
    [Choice(n) for n in (2, 4, 6, 7, 8, 9, 10, 12, 16, 24, 32)]
    + [Choice(n, safety=s) for n in (8, 12) for s in (0.95, 0.45, 0.2, 0.1)]
    + [Choice(n, scale=f) for n in (8, 12, 16) for f in (1.5, 2.0, 3.0)]
    + [Choice(n, lumping=k) for k in ("trapezium", "gregory-2", "gregory-3") for n in MESHES]
    + [Choice(n, lumping="fitted") for n in CHAINS]
    + [Choice(2, scale=13.0, axial=0.2)]
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
