"""Rows and tables of the study "error against cost": what is claimed, against what was measured."""

from dataclasses import replace

from evidence.results import table
from evidence.rows import Row, at_least, at_most

SCAN = "this study: dense scan of the same mesh"


def all_rows(cases: dict[str, dict]) -> list[Row]:
    """All rows, from the measured cases by name; each is of the group of its case."""
    rows = [row for case in cases.values() for row in _estimate_rows(case)]
    if "one" in cases:
        rows += _mesh_rows(cases["one"])
    rows += _spline_rows(cases)
    return [replace(row, group=row.name.partition(":")[0]) for row in rows]


def pick(case: dict, elements: int, choice: str) -> dict:
    """The record of a choice by its label; KeyError where there is none."""
    for record in case["records"]:
        if (record["elements"], record["choice"]) == (elements, choice):
            return record
    raise KeyError(f"{case['case']}: no {choice} with {elements} elements")


def _estimate_rows(case: dict) -> list[Row]:
    """Does the held-out estimate cover the true error, and by how much is it too large."""
    rows = []
    for kind in ("polynomials", "splines", "scans"):
        estimates = [e for r in case["records"] if r["kind"] == kind for e in r["estimate"]]
        if not estimates:
            continue
        coverage = sum(e["covered"] for e in estimates) / len(estimates)
        ratios = sorted(e["ratio"] for e in estimates)
        note = f"estimate over truth: median {ratios[len(ratios) // 2]:.2g}, "
        note += f"{ratios[0]:.2g} to {ratios[-1]:.2g}"
        name = f"{case['case']}: instants at which the error estimate covers the error, {kind}"
        if kind == "scans":
            note += "; the growth of a scan tells its size, it is not a bound"
            rows.append(at_most(name, coverage, 0.9, SCAN, note))
        else:
            rows.append(at_least(name, coverage, 0.9, SCAN, note))
    return rows


def _mesh_rows(case: dict) -> list[Row]:
    """The mesh counts before the order does."""
    choice = "tensor_lobatto 8"
    coarse, fine = (pick(case, n, choice)["total"] for n in (4, 8))
    return [
        at_least(f"one: {name}, error of 4 elements over that of 8, {choice}", a / b, 2.0,
                 "this study: dense scan of 32 elements")
        for name, a, b in zip(case["responses"], coarse, fine, strict=True)
    ]  # fmt: skip


SPLINES = (
    ("one", "tensor_lobatto 4, spline", "tensor_lobatto 4", 0.6, "the same runs"),
    ("three", "scan 64, spline", "smolyak 4", 0.8, "64 runs against 57 + 8"),
    ("three", "scan 64, spline", "scan 64", 0.8, "the same runs"),
)
"""Case, spline, rival, and the largest ratio of errors."""


def _spline_rows(cases: dict[str, dict]) -> list[Row]:
    """What a spline through all runs does."""
    rows = []
    for name, spline, rival, limit, note in SPLINES:
        if name not in cases:
            continue
        case = cases[name]
        pair = (pick(case, 8, label)["surrogate"] for label in (spline, rival))
        for response, a, b in zip(case["responses"], *pair, strict=True):
            text = f"{name}: {response}, error of {spline} over {rival}"
            rows.append(at_most(text, a / b, limit, SCAN, f"{note}: {a:.3g} and {b:.3g}"))
    return rows


def case_text(case: dict) -> str:
    """Every number of a case as a table."""
    reference, header = case["reference"], ["elements", "design", "runs", "cpu (s)"]
    growth = ", ".join(f"{100 * share:.2g} %" for share in reference["growth"])
    for name in case["responses"]:
        header += [f"{name} surrogate", f"{name} total"]
    lines = []
    for record in case["records"]:
        line = [record["elements"], record["choice"], record["runs"], float(record["cpu"])]
        for pair in zip(record["surrogate"], record["total"], strict=True):
            line += pair
        lines.append(line)
    text = (
        f"\n## {case['title']}\n\nErrors are Hausdorff distances integrated over time, as a share "
        f"of the integrated width. The reference has {reference['elements']} elements and "
        f"{reference['runs']} runs; its last round of runs widened it by {growth}.\n\n"
    )
    return text + table(header, lines)
