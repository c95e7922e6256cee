"""Rows of the study "error against cost": what is claimed, against what was measured."""

from campaign.presets import MODEL
from studies.rows import Row, cell
from studies.tradeoff_presets import cost_of

_ISSUE = "prototype of this project: 401-run scan, other spring and start"
_HERE = "this study: dense scan of the same level"
_FINEST = "this study: dense scan of the finest level"


def all_rows(cases: dict[str, dict], peers: dict | None) -> list[Row]:
    """All rows, from the measured cases by name."""
    rows = []
    for case in cases.values():
        rows += _reference_rows(case) + _estimate_rows(case) + _lane_rows(case)
    if "one" in cases:
        rows += _prototype_rows(cases["one"]) + _mesh_rows(cases["one"])
    rows += _spline_rows(cases) + _alignment_rows(cases) + _preset_rows(cases)
    if peers:
        rows += _fit_rows(peers) + _bound_rows(peers)
    return rows


def pick(case: dict, elements: int, choice: str, safety: float = 0.9) -> dict:
    """The record of a choice by its label; KeyError where there is none."""
    for record in case["records"]:
        if (record["elements"], record["choice"], record["safety"]) == (elements, choice, safety):
            return record
    raise KeyError(f"{case['case']}: no {choice} with {elements} elements")


def worst(record: dict, of: str, phase: str = "all", key: str = "hausdorff_integrated") -> float:
    """Largest of a metric over the responses."""
    return max(row[phase][key] for row in record[of])


def _kind(record: dict) -> str:
    """Plain surrogates and plain scans, told from splines and aligned ones."""
    if record["align"] != "none" or record["model"] == "spline":
        return "other"
    return "surrogates" if record["order"] else "scans"


def _at_most(name, value, limit, source, note="") -> Row:
    return Row(name, value, f"at most {cell(float(limit))}", 0.0, value <= limit, source, note)


def _at_least(name, value, limit, source, note="") -> Row:
    return Row(name, value, f"at least {cell(float(limit))}", 0.0, value >= limit, source, note)


def _reference_rows(case: dict) -> list[Row]:
    """The reference's own error against that of the cheapest surrogate which it judges."""
    reference = case["reference"]
    missing = [row["all"]["hausdorff_integrated"] for row in reference["missing"]]
    same = [r for r in case["records"] if r["elements"] == reference["elements"]]
    surrogates = [r for r in same if r["order"] and r["model"] == "polynomial"]
    error = worst(min(surrogates, key=lambda r: r["runs"]), "total")
    told = (
        f"growth still to come after {reference['rounds']} rounds of runs that widen the bounds"
        if reference["rounds"]
        else "growth from half its scan"
    )
    best = [
        min(r["total"][i]["all"]["hausdorff_integrated"] for r in same) for i in range(len(missing))
    ]
    each = ", ".join(
        f"{name} {m:.2g} (best choice judged by it: {b:.2g})"
        for name, m, b in zip(case["responses"], missing, best, strict=False)
    )
    return [
        _at_most(
            f"{case['case']}: what the reference misses, share of the width",
            max(missing),
            error / 10,
            "a tenth of the error of the smallest surrogate",
            f"{told}; {reference['elements']} elements, {reference['runs']} runs; {each}",
        )
    ]


def _estimate_rows(case: dict) -> list[Row]:
    """Does the held-out estimate cover the true error, and by how much is it too large."""
    kinds = {
        "surrogates": [r for r in case["records"] if _kind(r) == "surrogates"],
        "aligned": [r for r in case["records"] if r["align"] != "none"],
        "splines": [r for r in case["records"] if r["model"] == "spline"],
        "scans": [r for r in case["records"] if _kind(r) == "scans"],
        "presets": [r for r in case["presets"] if r["model"] == MODEL],
    }
    rows = []
    for kind, records in kinds.items():
        found = [row["all"] for r in records if "estimate" in r for row in r["estimate"]]
        if not found:
            continue
        covered = sum(row["covered"] for row in found) / len(found)
        ratios = sorted(row["ratio"] for row in found)
        note = (
            f"estimate over truth, integrated: median {ratios[len(ratios) // 2]:.2g}, "
            f"{ratios[0]:.2g} to {ratios[-1]:.2g}; worst gap {max(r['worst'] for r in found):.2g} "
            "of the largest width"
        )
        name = f"{case['case']}: instants at which the error estimate covers the error, {kind}"
        if kind == "scans":
            note += "; the growth of a scan tells its size, it is no bound"
            rows.append(_at_most(name, covered, 0.9, _HERE, note))
        else:
            rows.append(_at_least(name, covered, 0.9, _HERE, note))
    return rows


def _lane_rows(case: dict) -> list[Row]:
    one, full = case["lanes"]
    name = f"{case['case']}: cpu time of {full['lanes']} runs side by side over one run"
    note = f"{one['cpu']:.3g} s and {full['cpu']:.3g} s"
    return [_at_most(name, full["cpu"] / one["cpu"], 3.0, "a third of the lanes' number", note)]


def _prototype_rows(case: dict) -> list[Row]:
    """The rms errors of the velocity's bounds that the prototype had at orders 3, 9 and 33."""
    rows = []
    for order, known in ((3, 0.067), (9, 0.024), (33, 0.010)):
        record = pick(case, 8, f"tensor_roots {order}")
        value = record["surrogate"][1]["all"]["hausdorff_rms"]
        between = record["surrogate"][1]["between"]["hausdorff_rms"]
        passed = known / 3 <= between <= 3 * known
        name = f"one: vBz, rms error of the bounds between closures, order {order} (m/s)"
        note = f"over all time {value:.3g}, with the second closure"
        rows.append(Row(name, between, known, "factor 3", passed, _ISSUE, note))
    return rows


def _mesh_rows(case: dict) -> list[Row]:
    """What single runs are off by: mesh against step, and both against the surrogate."""
    rows = []
    found = {(t["elements"], t["safety"]): t for t in case["trajectories"]}
    for i, name in enumerate(case["responses"]):
        mesh = found[8, 0.225]["rms"][i]["between"]
        finer = found[16, 0.9]["rms"][i]["between"]
        surrogate = pick(case, 8, "tensor_lobatto 4")["surrogate"][i]["between"]["hausdorff_rms"]
        step = found[8, 0.9]["rms_step"][i]["between"]
        note = f"rms between closures: mesh {mesh:.2g}, step {step:.2g}, 16 elements {finer:.2g}"
        rows.append(
            _at_least(
                f"one: {name}, error of 8 elements over that of the step at 0.9 of its limit",
                mesh / step,
                3.0,
                "single runs against 64 elements",
                note,
            )
        )
        rows.append(
            _at_least(
                f"one: {name}, error of 8 elements over that of an order-4 surrogate",
                mesh / surrogate,
                1.0,
                "single runs against 64 elements; bounds against a scan",
                "spend on the mesh before the order",
            )
        )
    return rows


def _spline_rows(cases: dict[str, dict]) -> list[Row]:
    """What a spline through all runs does, as docs/tradeoff.md states it."""
    told = (
        ("one", "tensor_lobatto 4, spline", "tensor_lobatto 4", 0.6, "the same runs"),
        ("spring", "tensor_lobatto 4, spline", "tensor_lobatto 4", 0.6, "the same runs"),
        ("three", "scan 64, spline", "smolyak 4", 0.8, "64 runs against 57 + 8"),
        ("three", "scan 64, spline", "scan 64", 0.8, "the same runs"),
        ("smooth", "smolyak 4, spline", "smolyak 4", 1.0, "the same runs"),
    )
    rows = []
    for name, spline, rival, limit, note in told:
        if name not in cases:
            continue
        case = cases[name]
        ours, theirs = (pick(case, 8, label)["surrogate"] for label in (spline, rival))
        for i, response in enumerate(case["responses"]):
            a, b = (row[i]["all"]["hausdorff_integrated"] for row in (ours, theirs))
            text = f"{name}: {response}, error of {spline} over {rival}"
            told_errors = f"{note}: {a:.3g} and {b:.3g} of the width"
            rows.append(_at_most(text, a / b, limit, _HERE, told_errors))
    return rows


def _alignment_rows(cases: dict[str, dict]) -> list[Row]:
    """What alignment does to the velocity between the closures, as docs/tradeoff.md states it."""
    rows = []
    told = {
        "one": ("tensor_lobatto 4", False),
        "three": ("total_degree 3", False),
        "spring": ("tensor_lobatto 4", True),
    }
    for name, (design, helps) in told.items():
        if name not in cases:
            continue
        case = cases[name]
        for i, response in enumerate(case["responses"]):
            plain, aligned = (
                pick(case, 8, label)["surrogate"][i]["between"]["hausdorff_integrated"]
                for label in (design, f"{design}, shift 1")
            )
            ratio = aligned / plain
            helpful = helps and response == "vBz"
            limit = _at_most if helpful else _at_least
            note = f"{design}: {plain:.3g} plain, {aligned:.3g} aligned, shares of the width"
            text = f"{name}: {response} between closures, error aligned over plain"
            rows.append(limit(text, ratio, 0.6 if helpful else 0.8, _HERE, note))
        aligned = pick(case, 8, f"{design}, shift 1")
        scans = [
            r
            for r in case["records"]
            if _kind(r) == "scans" and r["elements"] == 8 and "surrogate" in r
        ]
        rival = max((r for r in scans if r["cpu"] <= aligned["cpu"]), key=lambda r: r["runs"])
        ratio = worst(aligned, "surrogate") / worst(rival, "surrogate")
        note = f"{aligned['cpu']:.2g} s of cpu time against {rival['choice']} in {rival['cpu']:.2g}"
        text = f"{name}: error aligned over that of a plain scan in the same time"
        rows.append(_at_least(text, ratio, 1.0, _HERE, note + " s: the scan is the better use"))
    return rows


# Share of the width that a preset's bounds may be off by in its worst response.
LIMITS = {"draft": 0.18, "standard": 0.12, "reference": 0.05}


def _preset_rows(cases: dict[str, dict]) -> list[Row]:
    """The presets' errors, and for comparison those of the model that they do not take."""
    rows = []
    for name, case in cases.items():
        errors = {}
        for record in case["presets"]:
            share = [row["all"]["hausdorff_integrated"] for row in record["total"]]
            rms = [row["all"]["hausdorff_rms"] for row in record["total"]]
            runs, cost = cost_of(record)
            note = f"{runs} runs, {cost:.2g} s of cpu time; " + ", ".join(
                f"{r} {s:.1%} of the width, rms {e:.2g}"
                for r, s, e in zip(case["responses"], share, rms, strict=True)
            )
            errors[record["preset"], record["model"]] = max(share), note
        for (preset, model), (error, note) in errors.items():
            if model != MODEL:
                continue
            rival, rival_note = errors[preset, "polynomial"]
            text = f"{name}: preset {preset}, error of the bounds"
            share = f"{text} as a share of their width"
            rows.append(_at_most(share, error, LIMITS[preset], _FINEST, note))
            rows.append(
                _at_most(f"{text} over the polynomial's", error / rival, 1.0, _FINEST, rival_note)
            )
    return rows


def _fit_rows(peers: dict) -> list[Row]:
    rows = []
    own = {row["case"]: row for row in peers["fits"] if row["by"] == "intervals"}
    for row in peers["fits"]:
        mine = own[row["case"]]
        if row["by"] == "intervals":
            continue
        text = f"{row['case']}: fit of {mine['fits']} curves' points, {row['by']} over ours"
        if "skipped" in row:
            rows.append(_skipped(text, row["skipped"]))
            continue
        note = (
            f"{row['seconds']:.2g} s and {mine['seconds']:.2g} s; error on unseen runs "
            f"{row['error']:.4g} and {mine['error']:.4g} of the spread; version {row['version']}"
        )
        ratio = row["seconds"] / mine["seconds"]
        rows.append(_at_least(f"{text}, time", ratio, 1.0, "measured side by side", note))
        same = abs(row["error"] / mine["error"] - 1.0)
        note = "same runs and the same basis: the errors must agree"
        rows.append(_at_most(f"{text}, error less 1", same, 0.01, "measured side by side", note))
    return rows


def _bound_rows(peers: dict) -> list[Row]:
    rows = []
    own = [row for row in peers["bounds"] if row["by"] == "intervals"]
    for row in peers["bounds"]:
        if "skipped" in row:
            rows.append(_skipped(f"one: bounds of a few instants, {row['by']}", row["skipped"]))
            continue
        if row["by"] == "intervals":
            continue
        for model in ("polynomial", "spline"):
            fewer = [m for m in own if m["calls"] <= row["calls"] and m["model"] == model]
            if not fewer:
                continue
            mine = max(fewer, key=lambda m: m["calls"])
            count = len(row["errors"])
            theirs, ours = (sum(m["errors"][:count]) / count for m in (row, mine))
            text = (
                f"one: bounds of vBz at an instant, error of {row['by']} {row['method']} "
                f"over our {model}'s"
            )
            note = (
                f"{row['calls']:.0f} runs, error {theirs:.3g} of the width, mean of {count} "
                f"instants, {row['seconds']:.2g} s an instant beside the runs; ours "
                f"{mine['method']}: {mine['calls']:.0f} runs, {ours:.3g}, {mine['seconds']:.2g} s"
            )
            source = "the same runs or fewer, side by side"
            rows.append(_at_least(text, theirs / ours, 1.0, source, note))
    return rows


def _skipped(name: str, why: str) -> Row:
    return Row(name, "skipped", "", "", True, "optional peer", why)
