"""How answers are written: numbers with units, places in the box, tables in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from deployable.campaign.results.units import pretty


def place(values: Mapping[str, float | None], units: Mapping[str, str]) -> str:
    """Parameter values by name, each with its unit."""
    told = {name: value for name, value in values.items() if value is not None}
    return ", ".join(f"{name} = {with_unit(told[name], units[name], 6)}" for name in told)


def units_of(summary: Mapping) -> dict[str, str]:
    """The units of a summary's parameters, by name."""
    return {parameter["name"]: parameter["units"] for parameter in summary["parameters"]}


def escaped(text: str) -> str:
    """A name from outside as one line of Markdown that says just that."""
    return re.sub(r"([|<>`*\[\]\\])", r"\\\1", " ".join(text.split()))


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> list[str]:
    """Lines of a Markdown table."""
    head = list(head)
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    return lines + [f"| {' | '.join(row)} |" for row in rows]


_RUNS = {
    "design": "of the design",
    "checks": "on other meshes and in checks",
    "further": "further ones for quantities",
    "choice": "for the best choice",
}
"""What runs are made for."""


def runs_text(runs: Mapping[str, int]) -> str:
    """`28 runs: 23 of the design, 5 further ones ...`; only their number where all have one end."""
    parts = [f"{runs[name]} {what}" for name, what in _RUNS.items() if runs.get(name)]
    return f"{runs['all']} runs" + (f": {', '.join(parts)}" if len(parts) > 1 else "")


def percent(share: float) -> str:
    """`0.0749` as `7 %`; two digits below one per cent."""
    return f"{100 * share:.2g} %" if abs(share) < 0.01 else f"{100 * share:.0f} %"


def with_unit(value: float | None, units: str, digits: int, none: str = "unknown") -> str:
    """A number with its unit, or `none` where there is none."""
    if value is None:
        return none
    unit = pretty(units)
    return f"{value:.{digits}g}" + ("" if unit == "1" else f" {unit}")


def doubt_texts(doubts: Mapping[str, str]) -> list[str]:
    """Sentences that tell of responses and quantities, by name, why mesh and step decide them."""
    names: dict[str, list[str]] = {}
    for name, why in doubts.items():
        names.setdefault(why, []).append(name)
    return [f"Mesh and step decide {', '.join(own)}: {why}" for why, own in names.items()]


def doubt_mark(row: Mapping) -> str:
    """What stands beside the error of such a number, from its row of the summary."""
    return "; mesh and step decide it" if "doubt" in row else ""
