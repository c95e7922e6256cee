"""What a study leaves: summary.json, table.md and a plot of each problem."""

import json
import re
from pathlib import Path

from verification.bench import Bench, Figure, Row

# Okabe and Ito's colours, told apart by colour-blind readers.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999")
MARKERS = "osD^vP*X"


def write_summary(rows: list[Row], path: Path) -> None:
    """Write the rows as a list of objects."""
    path.write_text(
        json.dumps([row.as_dict() for row in rows], indent=1, ensure_ascii=False) + "\n",
        encoding="utf-8",
    )


def table(benches: list[Bench]) -> str:
    """The rows as Markdown, failing ones first to be seen, then a table per problem."""
    rows = [row for bench in benches for row in bench.rows]
    failed = [row for row in rows if not row.passed]
    steps, cpu = sum(row.element_steps for row in rows), sum(row.cpu for row in rows)
    lines = [
        "# Verification",
        "",
        f"{len(rows)} rows, {len(failed)} failed; {steps:.3g} element-steps in {cpu:.1f} s of cpu "
        "time. The error is |value − reference| over what the column says; a row of measure "
        "“at least” passes if the value is not below the reference.",
        "",
    ]
    lines += ["![Overview](overview.png)", ""]
    lines += [f"- **failed**: {row.name}, error {row.error:.3g}" for row in failed]
    for bench in benches:
        rows = bench.rows
        steps, cpu = sum(row.element_steps for row in rows), sum(row.cpu for row in rows)
        lines += [
            "",
            f"## {bench.problem}",
            "",
            f"Cost: {steps:.3g} element-steps, {cpu:.2f} s.",
            "",
            "| row | value | reference | error | tolerance | measure | passed | source |",
            "|---|---|---|---|---|---|---|---|",
        ]
        for row in rows:
            name = row.name.removeprefix(f"{bench.problem}: ")
            lines.append(
                f"| {name} | {row.value:.6g} | {row.reference:.6g} | {row.error:.2g} "
                f"| {row.tolerance:.2g} | {row.measure} | {'yes' if row.passed else '**no**'} "
                f"| {row.source.replace('|', '∣')} |"
            )
        lines += ["", *(f"![{f.title}]({file_name(f)})" for f in bench.figures)]
    return "\n".join(lines) + "\n"


def file_name(figure: Figure) -> str:
    """Name of the plot's file."""
    words = re.findall(r"\w+", figure.title.lower().replace("°", " degree"))
    return "-".join(words) + ".png"


def draw(figure: Figure, folder: Path) -> None:
    """Draw a plot as PNG: computed lines solid with markers if few points, references dashed."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure as Canvas

    canvas = Canvas(figsize=(6.4, 4.2), layout="constrained")
    FigureCanvasAgg(canvas)
    axes = canvas.add_subplot()
    for i, curve in enumerate(figure.curves):
        axes.plot(
            curve.x,
            curve.y,
            label=curve.label,
            color="#444444" if curve.reference else COLOURS[i % len(COLOURS)],
            linestyle="--" if curve.reference else "-",
            linewidth=1.2,
            marker=MARKERS[i % len(MARKERS)]
            if len(curve.x) <= 50 and not curve.reference
            else None,
            markersize=4,
            zorder=3 if curve.reference else 2,
        )
    if figure.logarithmic:
        axes.set(xscale="log", yscale="log")
    if figure.equal:
        axes.set_aspect("equal", adjustable="datalim")
    axes.set(title=figure.title, xlabel=figure.x_label, ylabel=figure.y_label)
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    canvas.savefig(folder / file_name(figure), dpi=150)


def draw_overview(benches: list[Bench], folder: Path) -> None:
    """Draw how far each row is from its tolerance, and what each problem cost (overview.png)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure as Canvas

    canvas = Canvas(figsize=(9.6, 0.32 * len(benches) + 1.4), layout="constrained")
    FigureCanvasAgg(canvas)
    shares, costs = canvas.subplots(1, 2, sharey=True, width_ratios=(2, 1))
    for i, bench in enumerate(benches):
        for row in bench.rows:
            share = row.error / row.tolerance if row.tolerance > 0 else float("nan")
            if row.passed and not share > 0:
                continue  # rows without a tolerance, and errors of zero
            shares.plot(
                max(share, 1e-6) if share > 0 else 10.0,
                i,
                "o" if row.passed else "X",
                color=COLOURS[0] if row.passed else COLOURS[1],
                alpha=0.6,
                markersize=5 if row.passed else 9,
            )
        costs.barh(i, sum(row.cpu for row in bench.rows), color=COLOURS[5])
    shares.axvline(1.0, color="#444444", linestyle="--", linewidth=1)
    shares.set(xscale="log", xlabel="error / tolerance (crosses: failed)")
    shares.set_yticks(range(len(benches)), [bench.problem for bench in benches])
    shares.invert_yaxis()
    costs.set(xlabel="cpu time (s)")
    for axes in (shares, costs):
        axes.grid(alpha=0.3)
    canvas.savefig(folder / "overview.png", dpi=150)


def write(benches: list[Bench], folder: Path) -> None:
    """Write the plots, the table and, last, the summary into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for bench in benches:
        for figure in bench.figures:
            draw(figure, folder)
    draw_overview(benches, folder)
    (folder / "table.md").write_text(table(benches), encoding="utf-8")
    write_summary([row for bench in benches for row in bench.rows], folder / "summary.json")
