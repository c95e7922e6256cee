"""The budget of errors: what surrogate, step and mesh add to the error of every response and
quantity, as plain numbers for `summary.json` and as a table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from deployable.campaign.plan.plan import Plan
from deployable.campaign.results.words import percent, table, with_unit

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


def foretold_text(bounds: Any, i: int, at: int) -> str:
    """Why the error of response `i` at instant `at` is so much larger than what any run showed, in
    words; nothing where it is not, from the open `bounds.nc`."""
    from deployable.intervals.estimates import BEYOND

    if "polynomial" not in bounds.bounds_kind:
        return ""
    decay, missed = (float(bounds[f"error_{name}"][i][at]) for name in ("decay", "held_out"))
    if decay <= BEYOND * missed:
        return ""
    count = int(bounds.held_out_runs)
    told = "that is what the coefficients of its polynomial foretell, which no run tests"
    if count:
        most = with_unit(missed, bounds["response_units"][i], 2)
        told = (
            "that is what the coefficients of its polynomial foretell; the polynomial is off by at "
            f"most {most} from the {count} runs that were not fitted, too few to overrule that"
        )
    return f"{told}: more of them (`held_out`) may"


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
    if not width:  # nothing varies, or there is no interval
        return {**parts, "whole": whole, "share": 0.0 if whole == 0 and width == 0 else None}
    return {**parts, "whole": whole, "share": None if whole is None else whole / width}


def parts_text(errors: Mapping[str, float | None]) -> str:
    """A budget as shares of the width: `surrogate 1 %, mesh 2 %, together 3 %`; nothing where it is
    not known."""
    if not errors.get("share"):
        return ""
    width = errors["whole"] / errors["share"]
    parts = [f"{name} {percent(errors[name] / width)}" for name in PARTS if name in errors]
    asked = f"; asked for {percent(errors['asked'])}" if "asked" in errors else ""
    return f"{', '.join(parts)}, together {percent(errors['share'])}{asked}"


def accuracy_facts(plan: Plan, rows: list[Mapping]) -> dict[str, Any]:
    """Whether an accuracy is `met`, by the `errors` of responses and quantities as they are told
    last (rows, with `name` and what is `asked`), and by which not, `unmet`; why the rounds ended;
    the mesh; and by estimate the runs and the seconds of a core that they took, with those of
    checks. A quantity that happens in no run has no interval that could be wrong."""
    last, experiment = plan.adaptive.rounds[-1], plan.experiment
    mesh = experiment.accuracy.mesh
    told = [row for row in rows if row.get("lower", 0.0) is not None]
    unmet = [row for row in told if not _is_met(row["errors"])]
    reason = last.reason
    if not unmet and told:
        near = max(told, key=lambda row: row["errors"]["share"] / row["errors"]["asked"])
        reason = f"nearest to what was asked for is {near['name']}, {_share_text(near['errors'])}"
    elif plan.adaptive.met:
        reason = "the rounds found it met; runs for the ends of quantities showed more"
    return {
        "met": not unmet,
        "unmet": [row["name"] for row in unmet],
        "reason": reason,
        "rounds": len(plan.adaptive.rounds),
        "mesh": {mesh: experiment.scene.parameters[mesh]} if mesh else {},
        "runs": last.runs,
        "seconds": last.seconds,
    }


def _is_met(errors: Mapping[str, float | None]) -> bool:
    return errors["share"] is not None and errors["share"] <= errors["asked"]


def _share_text(errors: Mapping[str, float | None]) -> str:
    """`16 % for 5 %`."""
    share = "unknown" if errors["share"] is None else percent(errors["share"])
    return f"{share} for {percent(errors['asked'])}"


def accuracy_lines(found: Mapping, rows: list[Mapping]) -> list[str]:
    """The same in Markdown; rows: those of the summary."""
    mesh = "".join(f", with {name} = {number}" for name, number in found["mesh"].items())
    unmet = [row for row in rows if row["name"] in found["unmet"]]
    names = ", ".join(f"{row['name']} ({_share_text(row['errors'])})" for row in unmet)
    others = " and is by all others" * (len(unmet) < len(rows))
    met = "is met" if found["met"] else f"is not met by {names}{others}"
    seconds = "less than 1 s" if found["seconds"] < 1 else f"{found['seconds']:.2g} s"
    rounds = f"{found['rounds']} round{'s' * (found['rounds'] != 1)}"
    return ["", (
        f"The accuracy that was asked for {met}, after {rounds} of {found['runs']} "
        f"runs in all ({seconds} of a core, by estimate){mesh}: {found['reason']}."
    )]  # fmt: skip


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
    if any("asked" in row["errors"] for row in rows):
        head.append("asked for")
        for row, line in zip(rows, cells, strict=True):
            line.append(percent(row["errors"]["asked"]))
    note = "Errors of responses, and their widths, are means over time."
    return ["", "## Errors", "", *table(head, cells), "", note]
