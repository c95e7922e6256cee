"""The answers as plain numbers, for `summary.json`, and as Markdown, for `summary.md`."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from campaign.files import open_netcdf
from campaign.folder import Folder
from campaign.results.units import pretty
from fpm.sealed import check


def answer_rows(folder: Folder, requirements: bool, choice: bool) -> dict:
    """What a summary tells of quantities, and of requirements and the best choice if asked for."""
    with open_netcdf(folder.quantities) as data:
        found = {"quantities": quantity_rows(data), "runs": {}}
        for name in ("runs", "further_runs"):
            found["runs"][name] = int(data.getncattr(name))
    if requirements:
        judged = read_json(folder.requirements)
        found |= {name: judged[name] for name in ("requirements", "together")}
        found["runs"] = {name: judged[name] for name in found["runs"]}
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
    lines = []
    if "requirements" in summary:
        lines += requirement_lines(summary["requirements"], summary["together"])
    if "choice" in summary:
        lines += choice_lines(summary["choice"])
    return lines + quantity_lines(summary["quantities"], **summary["runs"])


def requirement_lines(rows: list[Mapping], together: Mapping) -> list[str]:
    """Which requirements are met, in Markdown."""
    lines = ["", "## Requirements", "", f"**{verdict(together)}**", ""]
    lines += table(
        ("requirement", "met by", "limit", "margin at the worst", "where", "simulated there"),
        [
            (
                row["name"],
                met(row),
                limit_text(one),
                margin_text(one),
                place(one["at"]),
                _with_unit(one["simulated"], one["units"], 6, "none"),
            )
            for row in rows
            for one in row["limits"]
        ],
    )
    return [*lines, "", *together_lines(together)]


def verdict(together: Mapping) -> str:
    """One sentence about all requirements."""
    if together["met"] == "all":
        return "All of the box meets all requirements."
    if together["met"] == "none":
        return "None of the box meets all requirements."
    return f"{share_text(together['share'])} of the box meets all requirements."


def together_lines(together: Mapping) -> list[str]:
    """How large a box would meet all requirements, and where the nearest failure is."""
    fails = together["fails"]
    if fails is None:
        return []
    share = together["largest_share"]
    text = (
        f"Intervals of {share_text(share)} of their widths about the nominal values meet all"
        if share > 0
        else "The nominal values fail"
    )
    simulated = _with_unit(fails["simulated"], fails["units"], 6, "does not happen")
    return [
        f"{text}. The nearest failure is of {fails['requirement']} ({limit_text(fails)}) at "
        f"{place(fails['at'])}; simulated there: {fails['quantity']} = {simulated}."
    ]


def share_text(share: float) -> str:
    """A share in per cent, never rounded to all or nothing."""
    percent = 100 * share
    if 0 < percent < 0.01 or 99.99 < percent < 100:
        return "Less than 0.01 %" if percent < 1 else "More than 99.99 %"
    return f"{percent:.4g} %"


def met(row: Mapping) -> str:
    """By how much of the box a requirement is met."""
    return {"all": "all", "none": "none"}.get(row["met"]) or f"some: {share_text(row['share'])}"


def limit_text(row: Mapping) -> str:
    """`t at most 2.1 s`."""
    if row["kind"] == "happens":
        return f"{row['quantity']} {'happens' if row['level'] else 'does not happen'}"
    how = row["kind"].replace("_", " ")
    return f"{row['quantity']} {how} {row['level']:.6g} {pretty(row['units'])}"


def margin_text(row: Mapping) -> str:
    """The margin with its unit, and whether it is below the error of the surrogate."""
    if row["margin"] is None:
        return ""
    text = _with_unit(row["margin"], row["units"], 3)
    error = row.get("error")
    return f"{text} (below the error estimate)" if error and abs(row["margin"]) < error else text


def choice_lines(choice: Mapping) -> list[str]:
    """The best choice in Markdown."""
    best = ", ".join(
        f"{p['name']} = {p['value']:.6g} {pretty(p['units'])}" for p in choice["parameters"]
    )
    lines = ["", "## Best choice", "", f"**{choice_verdict(choice)}**", ""]
    goals = [
        (
            f"{goal['sense']} {goal['end']}({goal['quantity']})",
            _with_unit(goal["value"], goal["units"], 6),
            place(goal["at"]),
            _with_unit(goal["simulated"], goal["units"], 6, "none"),
        )
        for goal in choice["goals"]
    ]
    limits = [
        (
            f"{limit['requirement']}: {limit_text(limit)}",
            f"margin {margin_text(limit)}",
            place(limit["at"]),
            _with_unit(limit["simulated"], limit["units"], 6, "none"),
        )
        for limit in choice["limits"]
    ]
    head = (f"worst case of {best}", "by the surrogate", "where", "simulated there")
    return [*lines, *table(head, goals + limits), "", f"It took {choice['runs']} runs."]


def choice_verdict(choice: Mapping) -> str:
    """One sentence about the best choice."""
    best = ", ".join(
        f"{p['name']} = {p['value']:.6g} {pretty(p['units'])}" for p in choice["parameters"]
    )
    if choice["kept"]:
        goal = choice["goals"][0]
        value = _with_unit(goal["value"], goal["units"], 4)
        return f"Best choice: {best}, with {goal['end']}({goal['quantity']}) = {value}."
    return f"No choice meets all requirements over its intervals; {best} misses them least."


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


def quantity_lines(rows: list[Mapping], runs: int, further_runs: int) -> list[str]:
    """The quantities' intervals in Markdown; some of all runs were made for answers."""
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
    lines += ["", f"Answers took {further_runs} further runs, {runs} in all."]
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


def _with_unit(value: float | None, units: str, digits: int, none: str = "unknown") -> str:
    return none if value is None else f"{value:.{digits}g} {pretty(units)}"
