"""What a study leaves: summary.json and table.md, in one form for all."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from deployable.campaign.files import write_text
from evidence.rows import Row


@dataclass(frozen=True)
class Report:
    """What follows from what a study measured.

    extra: further entries of summary.json; text: further Markdown below the rows."""

    rows: list[Row]
    extra: Mapping[str, Any] = field(default_factory=dict)
    text: str = ""


def cell(value: object) -> str:
    """A table cell: numbers with four digits or all before the point, nothing for None."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "**NO**"
    if isinstance(value, float):
        return f"{value:.0f}" if 1000 <= abs(value) < 1e7 else f"{value:.4g}"
    return str(value).replace("|", "∣")


def table(header: Sequence[str], rows: Sequence[Sequence]) -> str:
    """A Markdown table."""
    lines = ["| " + " | ".join(header) + " |", "|" + " --- |" * len(header)]
    lines += ["| " + " | ".join(map(cell, row)) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def expected(row: Row) -> str:
    """What a row should be, in words."""
    if row.sense == "within":
        return f"{cell(row.reference)} ± {cell(row.tolerance)}"
    return f"{row.sense} {cell(row.reference)}".strip()


def rows_text(rows: Sequence[Row]) -> str:
    """Rows as Markdown: how many, which failed, then a table for each group."""
    failures = [row for row in rows if row.is_failed]
    left_out = sum(bool(row.skipped) for row in rows)
    suffix = f", {left_out} skipped" if left_out else ""
    parts = [f"{len(rows)} rows, {len(failures)} failed{suffix}.\n"]
    parts += [f"- **failed**: {row.name}: {cell(row.value)}, {expected(row)}\n" for row in failures]
    for group in dict.fromkeys(row.group for row in rows):
        parts.append(f"## {group or 'Rows'}\n")
        parts.append(_group_table(group, [row for row in rows if row.group == group]))
    return "\n".join(parts)


def _group_table(group: str, rows: Sequence[Row]) -> str:
    """The rows of a group; columns that none of them fills are left out."""
    columns = {
        "row": [row.name.removeprefix(f"{group}: ") for row in rows],
        "value": [cell(row.value) for row in rows],
        "unit": [row.unit for row in rows],
        "expected": [expected(row) for row in rows],
        "passed": ["skipped" if row.skipped else cell(row.passed) for row in rows],
        "source": [row.source for row in rows],
        "note": [row.skipped or row.note for row in rows],
    }
    columns = {name: cells for name, cells in columns.items() if any(cells)}
    return table(list(columns), list(zip(*columns.values(), strict=True)))


def write(folder: str | os.PathLike, study: str, report: Report) -> None:
    """Write the table and, last, the summary: {"study", "rows", and more}."""
    folder = Path(folder)
    text = f"# {study.capitalize()}\n\n" + rows_text(report.rows) + report.text
    write_text(folder / "table.md", text)
    summary = {"study": study, "rows": [row.plain() for row in report.rows], **report.extra}
    write_text(folder / "summary.json", as_json(summary))


def as_json(data: object) -> str:
    """Text of a JSON file; rows become plain. ValueError for numbers that are not finite."""
    text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False, default=Row.plain)
    return text + "\n"
