"""Requirements and the best choice in words: sentences, rows of tables, Markdown."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from campaign.results.units import pretty
from campaign.results.words import place, table, with_unit

_TOLD = 0.05
"""Per cent of the box from which they are said to be open."""


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
    whole = {"all": "All", "none": "None"}.get(together["met"])
    share = share_text(together["share"], together["open"])
    told = share if whole is None else whole + share.partition(" %")[2]
    return f"{told} of the box meets all requirements."


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
    """A share in per cent, never rounded to all or nothing, with what is open of it, and as many
    digits as that leaves: `81 % (open: 2 %)`."""
    percent, more = 100 * share, 100 * open_
    if more < _TOLD:
        digits, least, told = f"{percent:.4g}", 0.01, ""
    else:
        places = max(0, -int(np.floor(np.log10(more))))
        least = 10.0**-places
        digits, more = f"{percent:.{places}f}", np.ceil(more / least - 1e-9) * least
        told = f" (open: {more:.{places}f} %)"
    if 0 < percent < least or 100 - least < percent < 100:
        return f"{f'Less than {least:g}' if percent < 50 else f'More than {100 - least:g}'} %{told}"
    return f"{digits} %{told}"


def met(row: Mapping) -> str:
    """By how much of the box a requirement is met."""
    share = share_text(row["share"], row["open"])
    return f"some: {share}" if row["met"] == "some" else row["met"] + share.partition(" %")[2]


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
