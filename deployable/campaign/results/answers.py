"""The answers as plain numbers, for `summary.json`, and as Markdown, for `summary.md`."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.files import open_netcdf
from deployable.campaign.folder import Folder
from deployable.campaign.results.budget import quantity_errors
from deployable.campaign.results.decisions import choice_lines, requirement_lines, share_text
from deployable.campaign.results.units import pretty
from deployable.campaign.results.words import doubt_mark, place, table, units_of, with_unit
from fpm.sealed import check


def answer_rows(folder: Folder, requirements: bool, choice: bool) -> dict:
    """What a summary tells of quantities, and of requirements and the best choice if asked for."""
    with open_netcdf(folder.quantities) as data:
        found = {"quantities": quantity_rows(data), "further_runs": int(data.further_runs)}
    if requirements:
        judged = read_json(folder.requirements)
        found |= {name: judged[name] for name in ("requirements", "together")}
        found["further_runs"] = judged["further_runs"]
    if choice:
        found["choice"] = read_json(folder.choice)
    return found


def read_json(path: Path) -> dict:
    """A result in JSON; raises `fpm.sealed.DamagedError`."""
    check(path, path.name)
    data = json.loads(path.read_text(encoding="utf-8"))
    return {name: value for name, value in data.items() if name != "seal"}


def answer_lines(summary: Mapping) -> list[str]:
    """What a summary tells of quantities, requirements and the best choice, in Markdown."""
    lines, units = [], units_of(summary)
    if "requirements" in summary:
        lines += requirement_lines(summary["requirements"], summary["together"], units)
    if "choice" in summary:
        lines += choice_lines(summary["choice"], units)
    return lines + quantity_lines(summary["quantities"], units)


def quantity_rows(data: Any) -> list[dict]:
    """Plain numbers of each quantity, from the open `quantities.nc`; None for what is no number."""
    parameters = data["parameter"][:].tolist()
    rows = []
    for i, name in enumerate(data["quantity"][:]):
        row: dict[str, Any] = {
            "name": str(name),
            "long_name": str(data["quantity_long_name"][i]),
            "units": str(data["quantity_units"][i]),
            "fit": str(data["fit"][i]),
        }
        for key in ("lower", "upper", "simulated_lower", "simulated_upper", "surrogate_lower",
                    "surrogate_upper", "nominal", "error", "happens", "open"):  # fmt: skip
            row[key] = _number(data[key][i])
        for key in _ERRORS:
            if key in data.variables:
                row[key] = _number(data[key][i])
        if errors := quantity_errors(row):
            row["errors"] = errors
        row |= {key: int(data[key][i]) for key in ("runs_with", "runs_without")}
        row["verified"] = not (data["moving_lower"][i] or data["moving_upper"][i])
        for key in ("argmin", "argmax"):
            row[key] = dict(zip(parameters, map(_number, data[key][i]), strict=True))
        row["influence"] = {
            parameter: {key: _number(data[key][i, j]) for key in _INFLUENCE}
            for j, parameter in enumerate(parameters)
        }
        rows.append(row)
    return rows


_ERRORS = ("error_step", "error_mesh", "error_whole")
_INFLUENCE = ("share", "alone", "fixed", "halved")


def _number(value: Any) -> float | None:
    return float(value) if np.isfinite(value) else None


def quantity_lines(rows: list[Mapping], units: Mapping[str, str]) -> list[str]:
    """The quantities' intervals in Markdown."""
    lines = ["", "## Quantities", ""]
    lines += table(
        ("quantity", "interval", "lower end at", "upper end at", "error estimate", "ends"),
        [
            (
                f"{row['name']}: {row['long_name']}",
                interval(row),
                place(row["argmin"], units),
                place(row["argmax"], units),
                with_unit(row["error"], row["units"], 2) + doubt_mark(row),
                "never happens" if row["lower"] is None else ends(row),
            )
            for row in rows
        ],
    )
    for row in rows:
        if row["runs_without"]:
            lines += ["", occurrence(row)]
    if any(len(row["influence"]) > 1 for row in rows):
        lines += ["", "### Which tolerance to pay for", "", *_influence(rows), ""]
        lines += ["A dash: its effect is not above the error of the surrogate."]
    return lines


def interval(row: Mapping) -> str:
    """`0.31 to 0.34 s`, with as many digits as its width needs."""
    lower, upper = row["lower"], row["upper"]
    if lower is None:
        return ""
    digits, size = digits_for(lower, upper), max(abs(lower), abs(upper))
    places = digits - 1 - int(np.floor(np.log10(size))) if size else 0
    form = f".{places}f" if 0 <= places <= 9 else f".{digits}g"  # both ends to the same place
    return f"{lower:{form}} to {upper:{form}} {pretty(row['units'])}"


def digits_for(lower: float, upper: float) -> int:
    """Significant digits that tell two ends apart to a thousandth of their difference."""
    size, width = max(abs(lower), abs(upper)), upper - lower
    return int(np.clip(np.ceil(np.log10(size / width)) + 3, 4, 9)) if width > 0 < size else 6


_VERIFIED = 1e-3
"""Share of the width by which a run may be short of an end that counts as simulated."""


def ends(row: Mapping) -> str:
    """Whether the ends were simulated."""
    if row["verified"]:
        return "simulated"
    least = _VERIFIED * (row["upper"] - row["lower"])
    parts = [
        f"{side} simulated only to {row[f'simulated_{side}']:.6g}"
        for side in ("lower", "upper")
        if abs(row[f"simulated_{side}"] - row[side]) > least
    ]
    return f"not verified: {', '.join(parts)}" if parts else "simulated"


def occurrence(row: Mapping) -> str:
    """In which part of the box it happens."""
    total = row["runs_with"] + row["runs_without"]
    if not row["runs_with"]:
        return f"{row['name']} does not happen in any of the {total} runs."
    return (
        f"{row['name']} happens in {share_text(row['happens'], row['open'])} of the box: in "
        f"{row['runs_with']} of {total} runs. The interval is that of the part in which it happens."
    )


def _influence(rows: list[Mapping]) -> list[str]:
    """The widths that are left when one parameter is known better, as a table."""
    parameters = list(rows[0]["influence"])
    head = ["quantity", "width"]
    head += [f"{name} {how}" for name in parameters for how in ("fixed", "halved")]
    return table(head, width_rows(rows))


def width_rows(rows: Iterable[Mapping]) -> list[list[str]]:
    """Of each quantity its name, its width, and those with each parameter fixed and halved.

    A dash where the parameter's effect cannot be told from the error of the surrogate.
    """
    cells = []
    for row in rows:
        if row["lower"] is None:
            continue
        line = [row["name"]]
        widths = [row["surrogate_upper"] - row["surrogate_lower"]]
        for found in row["influence"].values():
            widths += [found[key] if found["share"] else None for key in ("fixed", "halved")]
        cells.append(line + [with_unit(width, row["units"], 3, "–") for width in widths])
    return cells
