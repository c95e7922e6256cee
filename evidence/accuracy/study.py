"""The study of speed against accuracy: its rows, the table of all choices, its plot."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass

import fpm
from evidence import plots
from evidence.accuracy.choices import (
    CHOICES,
    REFERENCE,
    Choice,
    Phase,
    Result,
    measure,
    reproducibility,
    simulate,
)
from evidence.results import Report, table
from evidence.rows import Row, at_most


@dataclass(frozen=True)
class Measurement:
    """All results, the reference's outcome and cpu time (s), and how far two equal runs part."""

    results: list[Result]
    reference: fpm.Outcome
    cpu: float
    difference: Phase


def measure_all(quick: bool = False) -> Measurement:
    """Run all choices."""
    reference, cpu = simulate(Choice(REFERENCE))
    return Measurement(measure(CHOICES, reference), reference, cpu, reproducibility())


PARTS = {"choices": measure_all}


def report(parts: Mapping[str, Measurement]) -> Report:
    """What the study claims, and every choice as a table and in a plot."""
    m = parts["choices"]
    extra = {
        "reference": {"elements": REFERENCE, "step": m.reference.step, "cpu": m.cpu},
        "results": [asdict(result) for result in m.results],
    }
    text = "\n## Choices\n\n" + choices_table(m.results)
    return Report(claims(m), extra, text, {"errors": draw(m.results)})


def claims(m: Measurement) -> list[Row]:
    """What the study claims, as rows."""
    by_choice = {result.choice: result for result in m.results}
    source = f"{REFERENCE} elements a link, step {m.reference.step:.2g} s"

    def find_error(choice: Choice) -> float:
        return by_choice[choice].phases[1].bd

    rows = [
        at_most(
            f"12 elements: BD {phase.name} (m)", phase.bd, limit, source,
            f"velocity rms {phase.velocity_rms:.2g} m/s",
        )
        for phase, limit in zip(by_choice[Choice(12)].phases, (1e-4, 5e-4, 5e-3), strict=True)
    ]  # fmt: skip
    for n in (8, 12):
        for kind in ("trapezium", "gregory-2"):
            ratio = find_error(Choice(n)) / find_error(Choice(16, lumping=kind))
            name = f"{n} elements over 16 with {kind} masses: BD between"
            rows.append(at_most(name, ratio, 1.0, source))
    ratio = find_error(Choice(12)) / find_error(Choice(12, safety=0.1))
    name = "step at 0.9 of the limit over 0.1: BD between"
    rows.append(at_most(name, ratio, 1.5, source, "the step costs nothing"))
    name = "two runs whose steps differ: BD after the second closure (m)"
    note = f"velocity rms {m.difference.velocity_rms:.2g} m/s"
    return [*rows, at_most(name, m.difference.bd, 1e-3, source, note)]


def choices_table(results: list[Result]) -> str:
    """All results as a table."""
    header = ["elements", "share of limit", "f", "EA", "lumping", "steps", "element-steps", "cpu s"]
    for name in ("before", "between", "after"):
        header += [f"BD {name} (m)", f"vBz rms {name} (m/s)"]
    rows = []
    for r in results:
        c = r.choice
        row = [
            c.elements,
            c.safety,
            c.scale,
            c.axial,
            c.lumping,
            r.steps,
            float(r.element_steps),
            r.cpu,
        ]
        for phase in r.phases:
            row += [phase.bd, phase.velocity_rms]
        rows.append(row)
    return table(header, rows)


SERIES = {
    "mesh": (lambda c: c == Choice(c.elements), "o-", plots.BLUE),
    "step": (lambda c: c.safety != 0.9, "s", plots.ORANGE),
    "inertia scale f": (lambda c: c.scale != 1 and c.axial == 1, "^", plots.VERMILION),
    "fitted links": (lambda c: c.lumping == "fitted", "*-", plots.BLACK),
    "mesh, 3rd order ends": (lambda c: c.lumping == "gregory-3", "1--", plots.PURPLE),
    "mesh, 2nd order ends": (lambda c: c.lumping == "gregory-2", "v--", plots.GREEN),
    "mesh, trapezium": (lambda c: c.lumping == "trapezium", "x--", plots.GREY),
}
"""Label -> the choices drawn as one line, and how."""


def draw(results: list[Result]):
    """Error of BD against element-steps, one panel for each phase."""
    figure, panels = plots.panels(1, 3, (11, 3.6), sharey=True)
    titles = ("before the first closure", "between the closures", "after the second")
    for k, (axes, title) in enumerate(zip(panels, titles, strict=True)):
        for label, (selects, style, colour) in SERIES.items():
            group = sorted((r for r in results if selects(r.choice)), key=lambda r: r.element_steps)
            x, y = [r.element_steps for r in group], [r.phases[k].bd for r in group]
            axes.loglog(x, y, style, color=colour, label=label, markersize=4)
        axes.set(title=title, xlabel="element-steps")
    panels[0].set(ylabel="largest error of BD (m)")
    panels[2].legend(fontsize=7)
    return figure
