"""The budget of errors: what surrogate, step and mesh add to the error of every response and
quantity, as plain numbers for `summary.json` and as a table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from campaign.results.words import percent, table, with_unit

PARTS = ("surrogate", "step", "mesh")


def response_errors(bounds: Any, i: int) -> dict[str, float]:
    """Errors of response `i` by part, means over time, and the `share` of the mean width that they
    are together, from the open `bounds.nc`; nothing where step and mesh were not looked at."""
    if f"error_{PARTS[0]}" not in bounds.variables:
        return {}
    time = bounds["time"][:]

    def mean(curve: np.ndarray) -> float:
        return float(np.trapezoid(curve, time) / (time[-1] - time[0]))

    names = [name for name in PARTS if f"error_{name}" in bounds.variables]
    found = {name: mean(bounds[f"error_{name}"][i]) for name in names}
    width = mean(bounds["upper"][i] - bounds["lower"][i])
    return _with_whole(found, width)


def quantity_errors(row: Mapping) -> dict[str, float | None]:
    """The same of a quantity, from its row of the summary; None for what is not known."""
    if "error_whole" not in row:
        return {}
    known = {"surrogate": "error", "step": "error_step", "mesh": "error_mesh"}
    found = {name: row[key] for name, key in known.items() if key in row}
    width = None if row["lower"] is None else row["upper"] - row["lower"]
    return _with_whole(found, width)


def _with_whole(parts: Mapping[str, float | None], width: float | None) -> dict:
    values = list(parts.values())
    whole = None if None in values else sum(values)
    share = whole / width if whole is not None and width else None
    return {**parts, "whole": whole, "share": share}


def parts_text(errors: Mapping[str, float | None]) -> str:
    """A budget as shares of the width: `surrogate 1 %, mesh 2 %, together 3 %`; nothing where it is
    not known."""
    if not errors.get("share"):
        return ""
    width = errors["whole"] / errors["share"]
    parts = [f"{name} {percent(errors[name] / width)}" for name in PARTS if name in errors]
    return f"{', '.join(parts)}, together {percent(errors['share'])}"


def error_lines(rows: list[Mapping]) -> list[str]:
    """The budget of those rows (with `name`, `units`, `errors`) that have one, in Markdown."""
    rows = [row for row in rows if row.get("errors")]
    if not rows:
        return []
    parts = [name for name in PARTS if any(name in row["errors"] for row in rows)]
    cells = []
    for row in rows:
        errors = row["errors"]
        numbers = [with_unit(errors.get(part), row["units"], 2) for part in (*parts, "whole")]
        share = errors["share"]
        cells.append([row["name"], *numbers, "unknown" if share is None else percent(share)])
    head = ["error of", *parts, "together", "share of the width"]
    note = "Errors of responses, and their widths, are means over time."
    return ["", "## Errors", "", *table(head, cells), "", note]
