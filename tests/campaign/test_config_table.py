"""The page of config keys follows the schema."""

from __future__ import annotations

from pathlib import Path

from deployable.campaign.config.check import schema
from deployable.campaign.config.table import rows, table

PAGE = Path(__file__).parents[2] / "docs" / "config.md"


def test_the_page_is_what_the_schema_gives():
    assert PAGE.read_text(encoding="utf-8") == table(), (
        "make it again: python -m deployable keys > docs/config.md"
    )


def test_nested_keys_are_in_the_table():
    keys = [row[0] for row in rows(schema())]
    for key in ("campaign", "solver.step", "intervals.<name>.relative", "jobs.group"):
        assert key in keys
