"""Rows of the benchmark, and the files that they end in: summary.json and table.md."""

import json
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path


@dataclass(frozen=True)
class Row:
    """One figure.

    target: what it should be, as a number, or None for a figure that is only told. passed: None
    where there is no target or where the row was skipped. skipped: why, with the command that
    installs what is missing. A row that misses its target stays a failing row.
    """

    group: str
    name: str
    value: float | str | None
    unit: str
    target: float | None = None
    sense: str = ""
    passed: bool | None = None
    skipped: str = ""
    note: str = ""

    @property
    def verdict(self) -> str:
        """The row's last column."""
        if self.skipped:
            return "skipped"
        return {None: "", True: "yes", False: "NO"}[self.passed]


def told(group: str, name: str, value: float | str, unit: str, note: str = "") -> Row:
    """A figure without a target."""
    return Row(group, name, value, unit, note=note)


def at_most(group, name: str, value: float, target: float, unit: str, note: str = "") -> Row:
    """A figure that must not exceed its target."""
    passed = bool(value <= target)
    return Row(group, name, float(value), unit, target, "at most", passed, note=note)


def at_least(group, name: str, value: float, target: float, unit: str, note: str = "") -> Row:
    """A figure that must reach its target."""
    passed = bool(value >= target)
    return Row(group, name, float(value), unit, target, "at least", passed, note=note)


def skipped(group: str, name: str, unit: str, reason: str) -> Row:
    """A figure that cannot be measured here; `reason` says what would make it possible."""
    return Row(group, name, None, unit, skipped=reason)


def cell(value: object) -> str:
    """A table cell: numbers with three digits."""
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.0f}" if 1000 <= abs(value) < 1e7 else f"{value:.3g}"
    return str(value)


def table(rows: Sequence[Row]) -> str:
    """The rows as Markdown, one table a group."""
    lines = []
    for group in dict.fromkeys(row.group for row in rows):
        lines += ["", f"## {group}", "", "| what | value | unit | target | met | note |"]
        lines.append("| --- | ---: | --- | --- | --- | --- |")
        for row in rows:
            if row.group == group:
                target = "" if row.target is None else f"{row.sense} {cell(row.target)}"
                shown = (row.name, cell(row.value), row.unit, target, row.verdict)
                lines.append("| " + " | ".join((*shown, row.skipped or row.note)) + " |")
    return "\n".join(lines).lstrip() + "\n"


def write_results(folder: str | os.PathLike, rows: Sequence[Row], machine: dict) -> None:
    """summary.json ({"machine": ..., "rows": [...]}) and table.md in a folder."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    summary = {"machine": machine, "rows": [asdict(row) for row in rows]}
    about = ", ".join(f"{key}: {value}" for key, value in machine.items())
    head = f"# Benchmark\n\nMachine: {about}.\n\n"
    for name, text in (
        ("summary.json", json.dumps(summary, indent=1, allow_nan=False) + "\n"),
        ("table.md", head + table(rows)),
    ):
        part = folder / f".{name}.{os.getpid()}.part"
        part.write_text(text)
        os.replace(part, folder / name)
