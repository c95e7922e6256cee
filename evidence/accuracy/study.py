"""What one run costs and gets wrong: over mesh, step and lumping of the mass.

The paper's linkage is compared with a reference of 80 elements a link, whose step is more than
twenty times shorter than that of 12. Errors are told apart by phase of the motion: before the first
closure, between the closures, after the second; past an impact the curves of a finer mesh still
differ, and by how much two equally good runs differ is measured by changing the step a little."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

import numpy as np

import fpm
from evidence.linkage.runs import build, curves
from evidence.results import Report, table
from evidence.rows import Row, at_most

DURATION, INSTANTS, REFERENCE = 1.2, 2401, 80


@dataclass(frozen=True)
class Choice:
    """How a run is made: elements a link, share of the stable step, and whether half of each
    element's mass is at either end (the trapezium rule)."""

    elements: int
    safety: float = 0.9
    is_trapezium: bool = False


CHOICES = (
    *(Choice(n) for n in (4, 6, 8, 10, 12, 16, 24)),
    *(Choice(n, safety=0.1) for n in (8, 12)),
    *(Choice(n, is_trapezium=True) for n in (8, 12, 16, 24)),
)


@dataclass(frozen=True)
class Result:
    """What one choice costs, and its largest error of BD (m) and rms error of B's z-velocity (m/s)
    in each phase."""

    choice: Choice
    steps: int
    cpu: float
    bd: tuple[float, ...]
    velocity: tuple[float, ...]


def scene_of(choice: Choice) -> fpm.Scene:
    """The linkage for a choice."""
    scene, count = build(elements=choice.elements), choice.elements
    if choice.is_trapezium:
        shares = np.ones(count + 1) / count
        shares[[0, -1]] /= 2
        links = len(scene.beams)
        scene.mass = np.tile(scene.mass.sum() / links * shares, links)
    return scene


def simulate(choice: Choice) -> tuple[fpm.Outcome, float]:
    """The outcome of one choice and its cpu time (s), for a full register of samples."""
    scene = scene_of(choice)
    start = time.process_time()
    (outcome,) = fpm.simulate([scene], duration=DURATION, instants=INSTANTS, safety=choice.safety)
    if outcome.failure:
        raise outcome.failure
    return outcome, time.process_time() - start


def phases_of(reference: fpm.Outcome) -> list[tuple[float, float]]:
    """Start and end (s) of the three phases, with a margin of 5 ms about the impacts."""
    closings = reference.events[reference.events[:, 2] == 1, 0]
    openings = reference.events[reference.events[:, 2] == 0, 0]
    second = closings[closings > closings[0] + 0.1][0]
    largest = openings[openings < second - 0.1].max()
    last = max(openings.max(), second + 0.02)
    return [
        (0.0, closings[0] - 5e-3),
        (largest + 5e-3, second - 5e-3),
        (last + 5e-3, DURATION),
    ]


def errors(outcome: fpm.Outcome, reference: fpm.Outcome) -> tuple[tuple[float, ...], ...]:
    """Errors of one outcome: largest of BD, and rms of B's z-velocity, in each phase."""
    result, expected = curves(outcome), curves(reference)
    bd, velocity = (result[key] - expected[key] for key in ("BD", "vBz"))
    spans = phases_of(reference)
    windows = [(reference.time >= a) & (reference.time <= b) for a, b in spans]
    return (
        tuple(float(np.abs(bd[window]).max()) for window in windows),
        tuple(float(np.sqrt(np.mean(velocity[window] ** 2))) for window in windows),
    )


def measure(choices: Sequence[Choice], reference: fpm.Outcome) -> list[Result]:
    """Results of all choices."""
    results = []
    for choice in choices:
        outcome, cpu = simulate(choice)
        results.append(Result(choice, outcome.steps, cpu, *errors(outcome, reference)))
    return results


def measure_all(quick: bool = False) -> list[dict]:
    """All choices against the reference, and last the default at a step a little shorter."""
    reference, _ = simulate(Choice(REFERENCE))
    results = measure(CHOICES, reference)
    (default, _), (repeat, cpu) = simulate(Choice(12)), simulate(Choice(12, 0.85))
    results.append(Result(Choice(12, 0.85), repeat.steps, cpu, *errors(repeat, default)))
    return results


PARTS = {"choices": measure_all}


def report(parts: Mapping[str, list[Result]]) -> Report:
    """What the study claims, and every choice as a table."""
    *results, repeat = parts["choices"]
    extra = {"results": [asdict(result) for result in results]}
    text = "\n## Choices\n\n" + choices_table(results)
    return Report(claims(results, repeat), extra, text)


def claims(results: Sequence[Result], repeat: Result) -> list[Row]:
    """What the study claims, as rows. repeat: the default at another step, against the default."""
    by_choice = {result.choice: result for result in results}
    source = f"{REFERENCE} elements a link"
    default = by_choice[Choice(12)]
    rows = [
        at_most(f"12 elements: BD {name} (m)", error, limit, source)
        for name, error, limit in zip(PHASES, default.bd, (1e-4, 5e-4, 5e-3), strict=True)
    ]
    ratio = by_choice[Choice(8)].bd[1] / by_choice[Choice(16, is_trapezium=True)].bd[1]
    rows.append(at_most("8 elements over 16 with trapezium masses: BD between", ratio, 1.0, source))
    ratio = default.bd[1] / by_choice[Choice(12, safety=0.1)].bd[1]
    name = "step at 0.9 of the limit over 0.1: BD between"
    rows.append(at_most(name, ratio, 1.5, source, "the step costs nothing"))
    name = "two runs whose steps differ: BD after the second closure (m)"
    note = f"velocity rms {repeat.velocity[2]:.2g} m/s"
    return [*rows, at_most(name, repeat.bd[2], 1e-3, source, note)]


PHASES = ("before", "between", "after")


def choices_table(results: Sequence[Result]) -> str:
    """All results as a table."""
    header = ["elements", "share of limit", "masses", "steps", "cpu s"]
    header += [f"BD {name} (m)" for name in PHASES] + [f"vBz rms {name} (m/s)" for name in PHASES]
    rows = []
    for r in results:
        masses = "trapezium" if r.choice.is_trapezium else "default"
        head = [r.choice.elements, r.choice.safety, masses, r.steps, r.cpu]
        rows.append([*head, *r.bd, *r.velocity])
    return table(header, rows)
