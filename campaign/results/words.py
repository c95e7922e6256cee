"""How answers are written: numbers with units, places in the box, tables in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from campaign.results.units import pretty


def place(values: Mapping[str, float | None]) -> str:
    """Parameter values by name."""
    return ", ".join(f"{n} = {v:.6g}" for n, v in values.items() if v is not None)


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> list[str]:
    """Lines of a Markdown table."""
    head = list(head)
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    return lines + [f"| {' | '.join(row)} |" for row in rows]


def percent(share: float) -> str:
    """`0.0749` as `7 %`; two digits below one per cent."""
    return f"{100 * share:.2g} %" if abs(share) < 0.01 else f"{100 * share:.0f} %"


def with_unit(value: float | None, units: str, digits: int, none: str = "unknown") -> str:
    """A number with its unit, or `none` where there is none."""
    return none if value is None else f"{value:.{digits}g} {pretty(units)}"
