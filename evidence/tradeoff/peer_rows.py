"""Peers on the same runs: how long their fits take, and how wrong their bounds are."""

from __future__ import annotations

from evidence.rows import Row, at_least, at_most, skipped

PARALLEL = "measured side by side"


def peer_rows(peers: dict) -> list[Row]:
    """The rows of all peers; those that are not installed are skipped."""
    own = {row["case"]: row for row in peers["fits"] if row["by"] == "intervals"}
    rows = []
    for row in peers["fits"]:
        if row["by"] != "intervals":
            rows += _fit_rows(row, own[row["case"]])
    ours = [row for row in peers["bounds"] if row["by"] == "intervals"]
    for row in peers["bounds"]:
        if row["by"] != "intervals":
            rows += _bound_rows(row, ours)
    return rows


def _fit_rows(row: dict, mine: dict) -> list[Row]:
    text = f"{row['case']}: fit of {mine['fits']} curves' points, {row['by']} over ours"
    if "skipped" in row:
        return [skipped(text, row["skipped"])]
    note = (
        f"{row['seconds']:.2g} s and {mine['seconds']:.2g} s; error on unseen runs "
        f"{row['error']:.4g} and {mine['error']:.4g} of the spread; version {row['version']}"
    )
    deviation = abs(row["error"] / mine["error"] - 1.0)
    return [
        at_least(f"{text}, time", row["seconds"] / mine["seconds"], 1.0, PARALLEL, note),
        at_most(f"{text}, error less 1", deviation, 0.01, PARALLEL,
                "same runs and the same basis: the errors must agree"),
    ]  # fmt: skip


def _bound_rows(row: dict, ours: list[dict]) -> list[Row]:
    """A peer's bounds against ours of each model, from as many runs at most."""
    if "skipped" in row:
        return [skipped(f"one: bounds of a few instants, {row['by']}", row["skipped"])]
    rows = []
    for model in ("polynomial", "spline"):
        fewer = [m for m in ours if m["calls"] <= row["calls"] and m["model"] == model]
        if fewer:
            rows.append(_bound_row(row, max(fewer, key=lambda m: m["calls"])))
    return rows


def _bound_row(row: dict, mine: dict) -> Row:
    count = len(row["errors"])
    theirs, own = (sum(m["errors"][:count]) / count for m in (row, mine))
    text = (
        f"one: bounds of vBz at an instant, error of {row['by']} {row['method']} "
        f"over our {mine['model']}'s"
    )
    note = (
        f"{row['calls']:.0f} runs, error {theirs:.3g} of the width, mean of {count} "
        f"instants, {row['seconds']:.2g} s an instant beside the runs; ours "
        f"{mine['method']}: {mine['calls']:.0f} runs, {own:.3g}, {mine['seconds']:.2g} s"
    )
    return at_least(text, theirs / own, 1.0, "the same runs or fewer, side by side", note)
