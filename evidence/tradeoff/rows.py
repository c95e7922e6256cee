"""Rows of the study "error against cost": what is claimed, against what was measured."""

from dataclasses import replace

from evidence.rows import Row, at_least, at_most
from evidence.tradeoff.peer_rows import peer_rows

PROTOTYPE = "prototype of this project: 401-run scan, other spring and start"
SCAN = "this study: dense scan of the same level"
SINGLE = "single runs against 64 elements"


def all_rows(cases: dict[str, dict], peers: dict | None) -> list[Row]:
    """All rows, from the measured cases by name; each is of the group of its case."""
    rows = []
    for case in cases.values():
        rows += [_reference_row(case), *_estimate_rows(case), _lane_row(case)]
    if "one" in cases:
        single = cases["one"]
        rows += _prototype_rows(single) + _mesh_rows(single)
    rows += _spline_rows(cases)
    rows += peer_rows(peers) if peers else []
    return [replace(row, group=row.name.partition(":")[0]) for row in rows]


def pick(case: dict, elements: int, choice: str) -> dict:
    """The record of a choice by its label; KeyError where there is none."""
    for record in case["records"]:
        if (record["elements"], record["choice"], record["safety"]) == (elements, choice, 0.9):
            return record
    raise KeyError(f"{case['case']}: no {choice} with {elements} elements")


def worst(
    record: dict, key: str, phase: str = "all", metric: str = "hausdorff_integrated"
) -> float:
    """Largest of a metric over the responses."""
    return max(row[phase][metric] for row in record[key])


def _kind(record: dict) -> str:
    """What a record's bounds are."""
    if record["model"] == "spline":
        return "splines"
    return "surrogates" if record["order"] else "scans"


def _reference_row(case: dict) -> Row:
    """The reference's own error against that of the cheapest surrogate which it judges."""
    reference = case["reference"]
    missing = [row["all"]["hausdorff_integrated"] for row in reference["missing"]]
    records = [r for r in case["records"] if r["elements"] == reference["elements"]]
    surrogates = [r for r in records if r["order"] and r["model"] == "polynomial"]
    error = worst(min(surrogates, key=lambda r: r["runs"]), "total")
    note = (
        f"growth still to come after {reference['rounds']} rounds of runs that widen the bounds"
        if reference["rounds"]
        else "growth from half its scan"
    )
    best = [
        min(r["total"][i]["all"]["hausdorff_integrated"] for r in records)
        for i in range(len(missing))
    ]
    details = ", ".join(
        f"{name} {m:.2g} (best choice judged by it: {b:.2g})"
        for name, m, b in zip(case["responses"], missing, best, strict=False)
    )
    return at_most(
        f"{case['case']}: what the reference misses, share of the width",
        max(missing),
        error / 10,
        "a tenth of the error of the smallest surrogate",
        f"{note}; {reference['elements']} elements, {reference['runs']} runs; {details}",
    )


def _estimate_rows(case: dict) -> list[Row]:
    """Does the held-out estimate cover the true error, and by how much is it too large."""
    kinds: dict[str, list] = {"surrogates": [], "splines": [], "scans": []}
    for record in case["records"]:
        kinds[_kind(record)].append(record)
    rows = []
    for kind, records in kinds.items():
        estimates = [row["all"] for r in records for row in r.get("estimate", ())]
        if estimates:
            rows.append(_estimate_row(case, kind, estimates))
    return rows


def _estimate_row(case: dict, kind: str, estimates: list[dict]) -> Row:
    coverage = sum(row["covered"] for row in estimates) / len(estimates)
    ratios = sorted(row["ratio"] for row in estimates)
    note = (
        f"estimate over truth, integrated: median {ratios[len(ratios) // 2]:.2g}, "
        f"{ratios[0]:.2g} to {ratios[-1]:.2g}; worst gap {max(r['worst'] for r in estimates):.2g} "
        "of the largest width"
    )
    name = f"{case['case']}: instants at which the error estimate covers the error, {kind}"
    if kind == "scans":
        note += "; the growth of a scan tells its size, it is no bound"
        return at_most(name, coverage, 0.9, SCAN, note)
    return at_least(name, coverage, 0.9, SCAN, note)


def _lane_row(case: dict) -> Row:
    single, full = case["lanes"]
    name = f"{case['case']}: cpu time of {full['lanes']} runs side by side over one run"
    note = f"{single['cpu']:.3g} s and {full['cpu']:.3g} s"
    return at_most(name, full["cpu"] / single["cpu"], 3.0, "a third of the lanes' number", note)


def _prototype_rows(case: dict) -> list[Row]:
    """The rms errors of the velocity's bounds that the prototype had at orders 3, 9 and 33."""
    rows = []
    for order, reference in ((3, 0.067), (9, 0.024), (33, 0.010)):
        errors = pick(case, 8, f"tensor_roots {order}")["surrogate"][1]
        error = errors["between"]["hausdorff_rms"]
        name = f"one: vBz, rms error of the bounds between closures, order {order} (m/s)"
        note = f"over all time {errors['all']['hausdorff_rms']:.3g}, with the second closure"
        is_met = reference / 3 <= error <= 3 * reference
        sense = "within a factor 3 of"
        rows.append(Row(name, error, "", sense, reference, None, is_met, PROTOTYPE, note))
    return rows


def _mesh_rows(case: dict) -> list[Row]:
    """Errors of single runs: mesh against step, and both against the surrogate."""
    rows = []
    runs = {(t["elements"], t["safety"]): t for t in case["trajectories"]}
    for i, name in enumerate(case["responses"]):
        mesh = runs[8, 0.225]["rms"][i]["between"]
        finer = runs[16, 0.9]["rms"][i]["between"]
        order = 8 if name.startswith("v") else 4
        choice = pick(case, 8, f"tensor_lobatto {order}")
        surrogate = choice["surrogate"][i]["between"]["hausdorff_rms"]
        step = runs[8, 0.9]["rms_step"][i]["between"]
        note = f"rms between closures: mesh {mesh:.2g}, step {step:.2g}, 16 elements {finer:.2g}"
        text = f"one: {name}, error of 8 elements over that of"
        rows += [
            at_least(f"{text} the step at 0.9 of its limit", mesh / step, 1.0, SINGLE, note),
            at_least(f"{text} an order-{order} surrogate", mesh / surrogate, 1.0,
                     f"{SINGLE}; bounds against a scan", "spend on the mesh before the order"),
        ]  # fmt: skip
    return rows


SPLINES = (
    ("one", "tensor_lobatto 4, spline", "tensor_lobatto 4", 0.6, "the same runs"),
    ("spring", "tensor_lobatto 4, spline", "tensor_lobatto 4", 0.6, "the same runs"),
    ("three", "scan 64, spline", "smolyak 4", 0.8, "64 runs against 57 + 8"),
    ("three", "scan 64, spline", "scan 64", 0.8, "the same runs"),
    ("smooth", "smolyak 4, spline", "smolyak 4", 1.0, "the same runs"),
)
"""Case, spline, rival, and the largest ratio of errors, as docs/tradeoff.md states it."""


def _spline_rows(cases: dict[str, dict]) -> list[Row]:
    """What a spline through all runs does."""
    rows = []
    for name, spline, rival, limit, note in SPLINES:
        if name not in cases:
            continue
        case = cases[name]
        spline_rows, rival_rows = (pick(case, 8, label)["surrogate"] for label in (spline, rival))
        for i, response in enumerate(case["responses"]):
            a, b = (row[i]["all"]["hausdorff_integrated"] for row in (spline_rows, rival_rows))
            text = f"{name}: {response}, error of {spline} over {rival}"
            detail = f"{note}: {a:.3g} and {b:.3g} of the width"
            rows.append(at_most(text, a / b, limit, SCAN, detail))
    return rows
