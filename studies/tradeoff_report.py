"""summary.json, table.md and the plots of the study "error against cost"."""

from collections.abc import Sequence
from pathlib import Path

from campaign.files import write_text
from studies.rows import table, write_results
from studies.tradeoff_rows import all_rows

_MARKS = {
    "tensor_roots": ("o", "tensor_roots (the paper's)"),
    "tensor_lobatto": ("s", "tensor_lobatto"),
    "total_degree": ("^", "total_degree"),
    "smolyak": ("D", "smolyak"),
    "scan": ("x", "plain scan"),
    "aligned": ("*", "event-aligned"),
    "spline": ("P", "spline through all runs"),
}
# Okabe and Ito's colours, which colour-blind people can tell apart
_COLOURS = ("#E69F00", "#0072B2", "#009E73", "#CC79A7", "#56B4E9", "#D55E00")


def write_report(measured: Sequence[dict], folder: Path) -> None:
    """Write everything that the measured cases and peers give."""
    folder = Path(folder)
    cases = {data["case"]: data for data in measured if data["case"] != "peers"}
    peers = next((data for data in measured if data["case"] == "peers"), None)
    rows = all_rows(cases, peers)
    write_results(folder, rows)
    claims = (folder / "table.md").read_text()
    parts = ["# Error against cost\n", claims]
    parts += [_case_text(case) for case in cases.values()]
    write_text(folder / "table.md", "\n".join(parts))
    for case in cases.values():
        draw_pareto(case, folder / f"pareto_{case['case']}.png")


def _case_text(case: dict) -> str:
    """The tables of a case: every design of every level, then single runs."""
    names = case["responses"]
    header = ["level", "design", "runs", "cpu (s)"]
    for name in names:
        header += [f"{name} surrogate", f"{name} total", f"{name} largest", f"{name} width ratio"]
    header += ["covered by the estimate", "runs in the bounds"]
    body = []
    for r in case["records"]:
        row = [r["level"], r["choice"], r["runs"], float(r["cpu"])]
        for i in range(len(names)):
            own = r["surrogate"][i]["all"] if "surrogate" in r else None
            total = r["total"][i]["all"]
            row += [own["hausdorff_integrated"] if own else "", total["hausdorff_integrated"]]
            row += [total["hausdorff_largest"], total["width_ratio"]]
        for key, value in (("estimate", "covered"), ("scan", "coverage")):
            found = [x["all"][value] if key == "estimate" else x[value] for x in r.get(key, [])]
            row.append(min(found) if found else "")
        body.append(row)
    text = (
        f"\n## {case['title']}\n\nErrors are Hausdorff distances integrated over time, as a share "
        "of the integrated width, except the largest one, in the response's unit.\n\n"
    )
    text += table(header, body)
    if case["trajectories"]:
        phases = list(case["phases"])
        header = ["elements", "share of the stable step", "cpu of a run (s)"]
        header += [f"{name} {phase}" for name in names for phase in phases]
        body = [
            [t["elements"], t["safety"], float(t["cpu"])]
            + [t["rms"][i][phase] for i in range(len(names)) for phase in phases]
            for t in case["trajectories"]
        ]
        text += "\nSingle runs against the finest, rms over time:\n\n" + table(header, body)
    return text


def pareto(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points (cost, error) that no other one beats in both, by rising cost."""
    front = []
    for cost, error in sorted(points):
        if not front or error < front[-1][1]:
            front.append((cost, error))
    return front


def _mark(record: dict) -> str:
    """What a record is drawn as."""
    if record["align"] != "none":
        return "aligned"
    return "spline" if record["model"] == "spline" else record["method"]


def draw_pareto(case: dict, path: Path) -> None:
    """Error against cpu time: a row for each response, the surrogate's error beside the total."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    count = len(case["responses"])
    figure, axes = pyplot.subplots(
        count, 2, figsize=(11, 4 * count), layout="constrained", squeeze=False
    )
    levels = list(dict.fromkeys(record["level"] for record in case["records"]))
    colours = dict(zip(levels, _COLOURS, strict=False))
    for i, name in enumerate(case["responses"]):
        for axis, kind in zip(axes[i], ("surrogate", "total"), strict=True):
            points: dict[str, list] = {}
            for record in case["records"]:
                if kind not in record:
                    continue
                error = record[kind][i]["all"]["hausdorff_integrated"]
                shape, colour = _MARKS[_mark(record)][0], colours[record["level"]]
                axis.plot(record["cpu"], error, shape, color=colour, markersize=6)
                # levels are rivals only where all are judged by the same reference
                group = record["level"] if kind == "surrogate" else "all"
                points.setdefault(group, []).append((record["cpu"], error))
            for group, found in points.items():
                style = {"color": colours.get(group, "0.6"), "linewidth": 1, "zorder": 0}
                axis.step(*zip(*pareto(found), strict=True), where="post", **style)
            axis.set(xscale="log", yscale="log", xlabel="cpu time (s)")
            against = "a scan of its own level" if kind == "surrogate" else "the finest level"
            axis.set_title(f"{name}: bounds against {against}", fontsize=10)
            axis.grid(alpha=0.3, which="both", linewidth=0.5)
        axes[i][0].set_ylabel("error, share of the width")
    used = {_mark(record) for record in case["records"]}
    handles = [
        pyplot.Line2D([], [], color="k", marker=_MARKS[m][0], linestyle="", label=_MARKS[m][1])
        for m in _MARKS
        if m in used
    ]
    handles += [pyplot.Line2D([], [], color=c, linewidth=4, label=n) for n, c in colours.items()]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=9)
    figure.suptitle(case["title"])
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=130)
    pyplot.close(figure)
