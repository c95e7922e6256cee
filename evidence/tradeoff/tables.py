"""Every number of a case as tables: all designs of all levels, then single runs."""

from collections.abc import Sequence

from evidence.results import table

KEYS = ("hausdorff_integrated", "hausdorff_largest", "width_ratio")


def case_text(case: dict) -> str:
    """The tables of a case as Markdown."""
    text = (
        f"\n## {case['title']}\n\nErrors are Hausdorff distances integrated over time, as a share "
        "of the integrated width, except the largest one, in the response's unit.\n\n"
    )
    return text + _choices(case) + (_single_runs(case) if case["trajectories"] else "")


def _choices(case: dict) -> str:
    header = ["level", "design", "runs", "cpu (s)"]
    for name in case["responses"]:
        header += [f"{name} surrogate", f"{name} total", f"{name} largest", f"{name} width ratio"]
    header += ["covered by the estimate", "runs in the bounds"]
    return table(header, [_choice(case, record) for record in case["records"]])


def _choice(case: dict, record: dict) -> list:
    row = [record["level"], record["choice"], record["runs"], float(record["cpu"])]
    for i in range(len(case["responses"])):
        gap = record["surrogate"][i]["all"]["hausdorff_integrated"] if "surrogate" in record else ""
        row += [gap, *(record["total"][i]["all"][key] for key in KEYS)]
    row.append(_least([x["all"]["covered"] for x in record.get("estimate", [])]))
    row.append(_least([x["coverage"] for x in record.get("scan", [])]))
    return row


def _least(values: Sequence[float]) -> float | str:
    return min(values) if values else ""


def _single_runs(case: dict) -> str:
    names, phases = case["responses"], case["phases"]
    header = ["elements", "share of the stable step", "cpu of a run (s)"]
    header += [f"{name} {phase}" for name in names for phase in phases]
    body = [
        [t["elements"], t["safety"], float(t["cpu"])]
        + [t["rms"][i][phase] for i in range(len(names)) for phase in phases]
        for t in case["trajectories"]
    ]
    return "\nSingle runs against the finest, rms over time:\n\n" + table(header, body)
