"""Requirements and the best choice in words: sentences, rows of tables, Markdown."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from deployable.campaign.results.units import pretty
from deployable.campaign.results.words import place, table, with_unit

_TOLD = 0.05
"""Per cent of the box from which it is said by how much a share may be off."""


def requirement_lines(
    rows: list[Mapping], together: Mapping, units: Mapping[str, str]
) -> list[str]:
    """Which requirements are met, in Markdown; units: of the parameters, by name."""
    lines = ["", "## Requirements", "", f"**{verdict(together)}**", ""]
    lines += table(
        ("requirement", "met by", "limit", "margin at the worst", "where", "simulated there"),
        [
            (
                row["name"],
                met(row),
                limit_text(one),
                margin_text(one),
                place(one["at"], units),
                with_unit(one["simulated"], one["units"], 6, "none"),
            )
            for row in rows
            for one in row["limits"]
        ],
    )
    return [*lines, "", *together_lines(together, units)]


def verdict(together: Mapping) -> str:
    """One sentence about all requirements."""
    told = met(together)
    return f"{told[0].upper()}{told[1:]} of the box meets all requirements."


def together_lines(together: Mapping, units: Mapping[str, str]) -> list[str]:
    """How large a box would meet all requirements, and where the nearest failure is."""
    fails = together["fails"]
    if fails is None:
        return []
    share = together["largest_share"]
    text = (
        f"Intervals of {share_text(share)} of their widths about the nominal values meet all, by "
        "what was fitted and in all runs made there"
        if share > 0
        else "The nominal values fail"
    )
    failure = f"of {fails['requirement']} ({limit_text(fails)}) at {place(fails['at'], units)}"
    if not fails["ran"]:
        return [f"{text}. By the surrogate the nearest failure is {failure}; no run was made."]
    simulated = with_unit(fails["simulated"], fails["units"], 6, "does not happen")
    kept = ", which meets it: the surrogate is off by that much" if fails["kept"] else ""
    return [
        f"{text}. The nearest failure is {failure}; simulated there: {fails['quantity']} = "
        f"{simulated}{kept}."
    ]


def share_text(share: float, open_: float = 0.0) -> str:
    """A share in per cent, never rounded to all or nothing, with by how much it may be more or less
    (rounded up to one digit), and as many digits as that leaves: `81 ± 2 %`, `at least 98 %`."""
    percent = 100 * share
    if 100 * open_ < _TOLD:
        if 0 < percent < 0.01 or 99.99 < percent < 100:
            return "less than 0.01 %" if percent < 50 else "more than 99.99 %"
        return f"{percent:.4g} %"
    places = _places(open_)
    least = 10.0**-places
    off = np.ceil(100 * open_ / least - 1e-9) * least
    if percent + off >= 100:
        return f"at least {np.floor((percent - off) / least + 1e-9) * least:.{places}f} %"
    if percent - off <= 0:
        return f"at most {np.ceil((percent + off) / least - 1e-9) * least:.{places}f} %"
    return f"{percent:.{places}f} ± {off:.{places}f} %"


def _places(open_: float) -> int:
    """Decimal places of per cent that are worth telling."""
    return max(0, -int(np.floor(np.log10(100 * open_))))


def met(row: Mapping) -> str:
    """By how much of the box a requirement is met: `all`, `none` or a share."""
    sure = row["met"] != "some" and 100 * row["open"] < _TOLD
    return row["met"] if sure else share_text(row["share"], row["open"])


def where_it_happens(row: Mapping, happens: Mapping[str, float]) -> str:
    """`all where t happens`, of a requirement that fails only where its quantity does not happen;
    happens: shares of the box, by quantity."""
    limits = {limit["quantity"] for limit in row["limits"] if limit["kind"] != "happens"}
    only = [name for name in limits if happens[name] == row["share"] < 1]
    return f"all where {only[0]} happens" if only and row["met"] == "some" else ""


def limit_text(row: Mapping) -> str:
    """`t at most 2.1 s`."""
    if row["kind"] == "happens":
        return f"{row['quantity']} {'happens' if row['level'] else 'does not happen'}"
    how = row["kind"].replace("_", " ")
    return f"{row['quantity']} {how} {row['level']:.6g} {pretty(row['units'])}"


def margin_text(row: Mapping) -> str:
    """The margin with its unit, and whether it is below the error of the surrogate; where a
    quantity does not happen, or whether it happens is what is asked, that in its place."""
    if row["margin"] is None:
        if "kept" not in row:
            return ""  # written before this was told
        happens = row["kind"] == "happens" and row["kept"] == row["level"]
        return "happens" if happens else "does not happen"
    text = with_unit(row["margin"], row["units"], 3)
    error = row.get("error")
    return f"{text} (below the error estimate)" if error and abs(row["margin"]) < error else text


def choice_lines(choice: Mapping, units: Mapping[str, str]) -> list[str]:
    """The best choice in Markdown."""
    lines = ["", "## Best choice", "", f"**{choice_verdict(choice)}**", ""]
    head = ("worst case of it", "by the surrogate", "where", "simulated there")
    return [*lines, *table(head, choice_rows(choice, units))]


def choice_rows(choice: Mapping, units: Mapping[str, str]) -> list[tuple[str, str, str, str]]:
    """Goals and limits of the best choice: which, by the surrogate, where, simulated there."""
    units = {**units, **{each["name"]: each["units"] for each in choice["parameters"]}}
    goals = [
        (
            f"{goal['sense']} {goal['end']}({goal['quantity']})",
            with_unit(goal["value"], goal["units"], 6),
            place(goal["at"], units),
            with_unit(goal["simulated"], goal["units"], 6, "none"),
        )
        for goal in choice["goals"]
    ]
    return goals + [
        (
            f"{limit['requirement']}: {limit_text(limit)}",
            "margin " * (limit["margin"] is not None) + margin_text(limit),
            place(limit["at"], units),
            with_unit(limit["simulated"], limit["units"], 6, "none"),
        )
        for limit in choice["limits"]
    ]


def choice_verdict(choice: Mapping) -> str:
    """One sentence about the best choice."""
    best = ", ".join(
        f"{p['name']} = {p['value']:.6g} {pretty(p['units'])}" for p in choice["parameters"]
    )
    if choice["kept"]:
        goal = choice["goals"][0]
        value = with_unit(goal["value"], goal["units"], 4)
        return f"Best choice: {best}, with {goal['end']}({goal['quantity']}) = {value}."
    return f"No choice meets all requirements over its intervals; {best} misses them least."
