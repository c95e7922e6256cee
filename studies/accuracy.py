"""Speed against accuracy of one run: ``python -m studies.accuracy --output results/accuracy``.

The paper's linkage is run with many meshes, steps, factors on the rotational inertia and lumpings
of the mass, and compared with a reference of 80 elements a link, whose step is more than twenty
times shorter than that of 12. Errors are told apart by phase of the motion: before the first
closure, between the closures, after the second; past an impact the curves of a finer mesh still
differ, and by how much two equally good runs differ is measured by changing the step a little.
"""

import argparse
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

import fpm
from campaign.files import write_text
from fpm.elements.lumping import end_weights
from studies.linkage import build, curves
from studies.rows import Row, save, table, write_results

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

    Second order with the end shift n / (12 (n - 1)), which keeps the link's inertia exact.
    """
    out = end_weights(elements, 2 if kind == "gregory-3" else 0)
    if kind == "gregory-2":
        moved = elements / (12 * (elements - 1))
        out[[0, -1]] -= moved
        out[1] += moved
        out[-2] += moved
    return out


def scene_of(choice: Choice) -> fpm.Scene:
    """The linkage for a choice; another lumping replaces the masses of all links."""
    scene = build(elements_per_link=choice.elements, inertia_scale=choice.scale)
    if choice.lumping != "default":
        whole = scene.mass.sum() / len(scene.beams) / choice.elements
        scene.mass = np.tile(whole * weights(choice.lumping, choice.elements), len(scene.beams))
    return scene


def simulate(choice: Choice) -> tuple[fpm.Outcome, float]:
    """The outcome of one choice and its cpu time (s), for a full register of samples."""
    scene = scene_of(choice)
    begun = time.process_time()
    (outcome,) = fpm.simulate([scene], duration=DURATION, instants=INSTANTS, safety=choice.safety)
    if outcome.failure:
        raise outcome.failure
    return outcome, time.process_time() - begun


def phases_of(reference: fpm.Outcome) -> list[tuple[str, float, float]]:
    """Name, start and end (s) of the phases, with a margin of 5 ms about the impacts."""
    closings = reference.events[reference.events[:, 2] == 1, 0]
    openings = reference.events[reference.events[:, 2] == 0, 0]
    second = closings[closings > closings[0] + 0.1][0]
    parted = openings[openings < second - 0.1].max()
    last = max(openings.max(), second + 0.02)
    return [
        ("before", 0.0, closings[0] - 5e-3),
        ("between", parted + 5e-3, second - 5e-3),
        ("after", last + 5e-3, DURATION),
    ]


def errors(outcome: fpm.Outcome, reference: fpm.Outcome) -> tuple[Phase, ...]:
    """Errors of one outcome by phase."""
    found, expected = curves(outcome), curves(reference)
    rows = []
    for name, first, last in phases_of(reference):
        inside = (reference.time >= first) & (reference.time <= last)
        bd = np.abs(found["BD"] - expected["BD"])[inside]
        velocity = np.abs(found["vBz"] - expected["vBz"])[inside]
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


def rows_of(results: list[Result], reference: fpm.Outcome, apart: Phase) -> list[Row]:
    """What the study claims, as rows."""
    by = {r.choice: r for r in results}
    source = f"{REFERENCE} elements a link, step {reference.step:.2g} s"

    def compare(name, value, limit, note=""):
        return Row(name, float(value), 0.0, float(limit), bool(value <= limit), source, note)

    default = by[Choice(12)]
    rows = [
        compare(
            f"12 elements: BD {p.name} (m)", p.bd, limit, f"velocity rms {p.velocity_rms:.2g} m/s"
        )
        for p, limit in zip(default.phases, (1e-4, 5e-4, 5e-3), strict=True)
    ]
    for n in (8, 12):
        for kind in ("trapezium", "gregory-2"):
            old, better = by[Choice(16, lumping=kind)], by[Choice(n)]
            rows.append(
                compare(f"{n} elements over 16 with {kind} masses: BD between",
                        better.phases[1].bd / old.phases[1].bd, 1.0)
            )  # fmt: skip
    full, tenth = by[Choice(12)], by[Choice(12, safety=0.1)]
    rows.append(
        compare("step at 0.9 of the limit over 0.1: BD between",
                full.phases[1].bd / tenth.phases[1].bd, 1.5, "the step costs nothing")
    )  # fmt: skip
    rows.append(
        compare("two runs whose steps differ: BD after the second closure (m)", apart.bd, 1e-3,
                f"velocity rms {apart.velocity_rms:.2g} m/s")
    )  # fmt: skip
    return rows


def markdown(results: list[Result]) -> str:
    """All results as a table."""
    header = ["elements", "share of limit", "f", "lumping", "steps", "element-steps", "cpu s"]
    for name in ("before", "between", "after"):
        header += [f"BD {name} (m)", f"vBz rms {name} (m/s)"]
    rows = []
    for r in results:
        c = r.choice
        row = [c.elements, c.safety, c.scale, c.lumping, r.steps, float(r.element_steps), r.cpu]
        for phase in r.phases:
            row += [phase.bd, phase.velocity_rms]
        rows.append(row)
    return table(header, rows)


def plot(results: list[Result], path: Path) -> None:
    """Error of BD against element-steps, one panel for each phase."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    series = {
        "mesh": (lambda c: c == Choice(c.elements), "o-", "#0072b2"),
        "step": (lambda c: c.safety != 0.9, "s", "#e69f00"),
        "inertia scale f": (lambda c: c.scale != 1, "^", "#d55e00"),
        "mesh, 3rd order ends": (lambda c: c.lumping == "gregory-3", "1--", "#cc79a7"),
        "mesh, 2nd order ends": (lambda c: c.lumping == "gregory-2", "v--", "#009e73"),
        "mesh, trapezium": (lambda c: c.lumping == "trapezium", "x--", "#888888"),
    }
    figure, panels = plt.subplots(1, 3, figsize=(11, 3.6), sharey=True, layout="constrained")
    for k, axes in enumerate(panels):
        for label, (chosen, style, colour) in series.items():
            some = sorted((r for r in results if chosen(r.choice)), key=lambda r: r.element_steps)
            axes.loglog(
                [r.element_steps for r in some], [r.phases[k].bd for r in some], style,
                color=colour, label=label, markersize=4,
            )  # fmt: skip
        axes.set(title=f"{results[0].phases[k].name} the closures", xlabel="element-steps")
    panels[0].set(title="before the first closure", ylabel="largest error of BD (m)")
    panels[2].set(title="after the second")
    panels[2].legend(fontsize=7)
    save(figure, path)


def main(arguments: list[str] | None = None) -> int:
    """Parse the command line, run, write; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m studies.accuracy", description=__doc__)
    parser.add_argument("--output", type=Path, default=Path("results/accuracy"))
    options = parser.parse_args(arguments)
    fpm.warm_up()
    reference, cpu = simulate(Choice(REFERENCE))
    results = measure(CHOICES, reference)
    apart = reproducibility()
    rows = rows_of(results, reference, apart)
    more = {
        "reference": {"elements": REFERENCE, "step": reference.step, "cpu": cpu},
        "results": [asdict(r) for r in results],
    }
    write_results(options.output, rows, more)
    write_text(options.output / "choices.md", markdown(results))
    plot(results, options.output / "errors")
    for row in rows:
        print("passed" if row.passed else "FAILED", row.name, row.value, row.note)
    return 0


if __name__ == "__main__":
    sys.exit(main())
