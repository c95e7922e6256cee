"""The answers as plain numbers, for `summary.json`, and as Markdown, for `summary.md`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from campaign.results.units import pretty


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


_INFLUENCE = ("share", "alone", "fixed", "halved")


def _number(value: Any) -> float | None:
    return float(value) if np.isfinite(value) else None


def quantity_lines(rows: list[Mapping], runs: int, further: int) -> list[str]:
    """The quantities' intervals in Markdown, after `further` further ones of all `runs`."""
    lines = ["", "## Quantities", ""]
    lines += table(
        ("quantity", "interval", "lower end at", "upper end at", "error estimate", "ends"),
        [
            (
                f"{row['name']}: {row['long_name']}",
                interval(row),
                place(row["argmin"]),
                place(row["argmax"]),
                _with_unit(row["error"], row["units"], 2),
                "never happens" if row["lower"] is None else _ends(row),
            )
            for row in rows
        ],
    )
    lines += ["", f"Ends were sought with {further} further runs, {runs} in all."]
    for row in rows:
        if row["runs_without"]:
            lines += ["", occurrence(row)]
    if any(len(row["influence"]) > 1 for row in rows):
        lines += ["", "### Which tolerance to pay for", ""]
        lines += _influence(rows)
    return lines


def interval(row: Mapping) -> str:
    """`0.31 to 0.34 s`, with as many digits as its width needs."""
    lower, upper = row["lower"], row["upper"]
    if lower is None:
        return ""
    digits = digits_for(lower, upper)
    return f"{lower:.{digits}g} to {upper:.{digits}g} {pretty(row['units'])}"


def digits_for(lower: float, upper: float) -> int:
    """Significant digits that tell two ends apart to a thousandth of their difference."""
    size, width = max(abs(lower), abs(upper)), upper - lower
    return int(np.clip(np.ceil(np.log10(size / width)) + 3, 4, 9)) if width > 0 < size else 6


def _ends(row: Mapping) -> str:
    if row["verified"]:
        return "simulated"
    parts = []
    for side in ("lower", "upper"):
        if row[f"simulated_{side}"] != row[side]:
            parts.append(f"{side} simulated only to {row[f'simulated_{side}']:.6g}")
    return ", ".join(parts) or "simulated"


def occurrence(row: Mapping) -> str:
    """In which part of the box it happens."""
    total = row["runs_with"] + row["runs_without"]
    share = f"about {100 * row['happens']:.3g} % of the box"
    if not row["runs_with"]:
        return f"{row['name']} does not happen in any of the {total} runs."
    return (
        f"{row['name']} happens in {share}: in {row['runs_with']} of {total} runs. Of "
        f"{100 * row['open']:.2g} % of the box they do not tell. "
        "The interval is that of the part in which it happens."
    )


def _influence(rows: Iterable[Mapping]) -> list[str]:
    """The widths that are left when one parameter is known better."""
    rows = [row for row in rows if row["lower"] is not None]
    parameters = list(rows[0]["influence"]) if rows else []
    head = ["quantity", "width"]
    head += [f"{name} {how}" for name in parameters for how in ("fixed", "halved")]
    cells = []
    for row in rows:
        unit, width = pretty(row["units"]), row["surrogate_upper"] - row["surrogate_lower"]
        line = [row["name"], f"{width:.3g} {unit}"]
        for found in row["influence"].values():
            if not found["share"]:
                line += ["not told apart from the error", ""]
            else:
                line += [f"{found[key]:.3g} {unit}" for key in ("fixed", "halved")]
        cells.append(line)
    return table(head, cells)


def place(values: Mapping[str, float | None]) -> str:
    """Parameter values by name."""
    return ", ".join(f"{n} = {v:.6g}" for n, v in values.items() if v is not None)


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> list[str]:
    """Lines of a Markdown table."""
    head = list(head)
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    return lines + [f"| {' | '.join(row)} |" for row in rows]


def _with_unit(value: float | None, units: str, digits: int) -> str:
    return "unknown" if value is None else f"{value:.{digits}g} {pretty(units)}"
