"""The study of extremes: ``python -m studies.extremes --output results/extremes``.

Every row is within its stated accuracy, a clear refusal, or a failing row. ``--strict`` makes
failing rows an exit status of 1; without it the status tells only whether the study ran.
"""

import argparse
import math
import sys
from collections.abc import Callable
from pathlib import Path

from studies import extreme_parameters as parameters
from studies import extreme_runs as runs
from studies import stable_step
from studies.rows import Row, save, write_results

GROUPS: dict[str, Callable[[], list[Row]]] = {
    "stable step": stable_step.study,
    "materials": parameters.materials,
    "sections": parameters.sections,
    "lengths": parameters.lengths,
    "stiffnesses": parameters.stiffnesses,
    "starts": runs.starts,
    "meshes": runs.meshes,
    "durations": runs.durations,
    "damping": runs.damping,
    "precision": runs.precision,
    "intervals": runs.intervals,
    "refusals": parameters.refusals,
}


def plot_steps(rows: list[Row], path: Path) -> None:
    """Ratio of the estimated to the true stable step, case by case."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    ratios = [float(row.value) for row in rows]
    figure, axes = plt.subplots(figsize=(7, 0.16 * len(rows) + 1), layout="constrained")
    axes.barh(range(len(rows)), ratios, color="#0072b2", height=0.7)
    axes.axvline(1.0, color="black", linewidth=0.8)
    axes.set_yticks(range(len(rows)), [r.name.removeprefix("stable step: ") for r in rows])
    axes.tick_params(axis="y", labelsize=6)
    axes.set(xlim=(stable_step.LOWEST, 1.02), xlabel="estimated / true stable step")
    axes.margins(y=0.005)
    axes.invert_yaxis()
    save(figure, path)


def plot_errors(rows: list[Row], path: Path) -> None:
    """Error over tolerance of every row that has both; refusals as open marks at the left."""
    from matplotlib import pyplot as plt

    names, shares, refused = [], [], []
    for row in rows:
        if isinstance(row.value, str):
            refused.append(len(names))
            names.append(row.name)
            shares.append(math.nan)
        elif isinstance(row.tolerance, float) and row.reference == 0.0:
            names.append(row.name)
            shares.append(max(abs(row.value) / row.tolerance, 1e-6))
    figure, axes = plt.subplots(figsize=(7, 0.16 * len(names) + 1), layout="constrained")
    axes.plot(shares, range(len(names)), "o", color="#0072b2", markersize=4, label="error")
    axes.plot([1e-6] * len(refused), refused, "x", color="#d55e00", markersize=4, label="refused")
    axes.axvline(1.0, color="black", linewidth=0.8)
    axes.set_yticks(range(len(names)), names)
    axes.tick_params(axis="y", labelsize=5)
    axes.set(xscale="log", xlabel="error / stated accuracy")
    axes.margins(y=0.005)
    axes.invert_yaxis()
    axes.legend(loc="lower left")
    save(figure, path)


def main(arguments: list[str] | None = None) -> int:
    """Parse the command line, run, write; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m studies.extremes", description=__doc__)
    parser.add_argument("--output", type=Path, default=Path("results/extremes"))
    parser.add_argument("--strict", action="store_true", help="fail if a row fails")
    parser.add_argument("groups", nargs="*", help=f"all by default: {', '.join(GROUPS)}")
    options = parser.parse_args(arguments)
    unknown = [name for name in options.groups if name not in GROUPS]
    if unknown:
        parser.error(f"unknown group {unknown[0]!r}; known are: {', '.join(GROUPS)}")
    found = {}
    for name in options.groups or GROUPS:
        found[name] = GROUPS[name]()
        print(
            f"{name}: {sum(r.passed for r in found[name])} of {len(found[name])} passed", flush=True
        )
    rows = [row for group in found.values() for row in group]
    write_results(options.output, rows)
    if "stable step" in found:
        plot_steps(found.pop("stable step"), options.output / "stable-step")
    plot_errors([row for group in found.values() for row in group], options.output / "errors")
    failed = [row for row in rows if not row.passed]
    for row in failed:
        print(f"failed: {row.name}: {row.value} (tolerance {row.tolerance}); {row.note}")
    return 1 if options.strict and failed else 0


if __name__ == "__main__":
    sys.exit(main())
