"""Rows of a study's results and their files: summary.json, table.md and figures."""

import json
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from campaign.files import write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Row:
    """One comparison. `passed` is whether value lies within tolerance of the reference, or, for a
    refusal, whether the run was refused as it should be; `source` says where the reference is from
    and `note` what a reader should know. A row that fails stays a failing row.
    """

    name: str
    value: float | str
    reference: float | str
    tolerance: float | str
    passed: bool
    source: str
    note: str = ""


def cell(value: object) -> str:
    """A table cell: numbers with four digits."""
    if isinstance(value, bool):
        return "yes" if value else "NO"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def table(header: Sequence[str], rows: Sequence[Sequence]) -> str:
    """A Markdown table."""
    lines = ["| " + " | ".join(header) + " |", "|" + " --- |" * len(header)]
    lines += ["| " + " | ".join(cell(v) for v in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def write_results(folder: str | os.PathLike, rows: Sequence[Row], more: dict | None = None) -> None:
    """summary.json ({"rows": [...], **more}) and table.md in a folder."""
    folder = Path(folder)
    summary = {"rows": [asdict(row) for row in rows], **(more or {})}
    write_text(folder / "summary.json", json.dumps(summary, indent=1, allow_nan=False) + "\n")
    header = ("name", "value", "reference", "tolerance", "passed", "source", "note")
    body = [[getattr(row, name) for name in header] for row in rows]
    write_text(folder / "table.md", table(header, body))


def save(figure: "Figure", path: Path) -> None:
    """Write a figure as `path`.png and .pdf, and close it."""
    from matplotlib import pyplot as plt

    path.parent.mkdir(parents=True, exist_ok=True)
    for kind in ("png", "pdf"):
        figure.savefig(path.with_suffix(f".{kind}"), dpi=150)
    plt.close(figure)
