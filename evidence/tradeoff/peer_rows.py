"""Peers on the same runs: how long their fits take, and the errors of their bounds."""

from evidence.rows import Row, at_least, at_most, skip_row

PARALLEL = "measured side by side"


def peer_rows(peers: dict) -> list[Row]:
    """The rows of all peers; those that are not installed are skipped."""
    fits = {row["case"]: row for row in peers["fits"] if row["by"] == "intervals"}
    rows = []
    for row in peers["fits"]:
        if row["by"] != "intervals":
            rows += _fit_rows(row, fits[row["case"]])
    bounds = [row for row in peers["bounds"] if row["by"] == "intervals"]
    for row in peers["bounds"]:
        if row["by"] != "intervals":
            rows += _bound_rows(row, bounds)
    return rows


def _fit_rows(row: dict, fit: dict) -> list[Row]:
    text = f"{row['case']}: fit of {fit['fits']} curves' points, {row['by']} over ours"
    if "skipped" in row:
        return [skip_row(text, row["skipped"])]
    note = (
        f"{row['seconds']:.2g} s and {fit['seconds']:.2g} s; error on unseen runs "
        f"{row['error']:.4g} and {fit['error']:.4g} of the spread; version {row['version']}"
    )
    deviation = abs(row["error"] / fit["error"] - 1.0)
    return [
        at_least(f"{text}, time", row["seconds"] / fit["seconds"], 1.0, PARALLEL, note),
        at_most(f"{text}, error less 1", deviation, 0.01, PARALLEL,
                "same runs and the same basis: the errors must agree"),
    ]  # fmt: skip


def _bound_rows(row: dict, bounds: list[dict]) -> list[Row]:
    """A peer's bounds against the least wrong of ours from as many runs at most."""
    if "skipped" in row:
        return [skip_row(f"one: bounds of a few instants, {row['by']}", row["skipped"])]
    count = len(row["errors"])
    fewer = [m for m in bounds if m["calls"] <= row["calls"]]
    return [_bound_row(row, min(fewer, key=lambda m: sum(m["errors"][:count])))]


def _bound_row(row: dict, bound: dict) -> Row:
    count = len(row["errors"])
    peer_error, error = (sum(m["errors"][:count]) / count for m in (row, bound))
    text = (
        f"one: bounds of vBz at an instant, error of {row['by']} {row['method']} "
        "over the least of ours"
    )
    note = (
        f"{row['calls']:.0f} runs, error {peer_error:.3g} of the width, mean of {count} "
        f"instants, {row['seconds']:.2g} s an instant beside the runs; ours "
        f"{bound['method']}: {bound['calls']:.0f} runs, {error:.3g}, {bound['seconds']:.2g} s"
    )
    return at_least(
        text, peer_error / max(error, 1e-15), 1.0, "the same runs or fewer, side by side", note
    )
