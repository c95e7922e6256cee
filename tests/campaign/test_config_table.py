"""The page of config keys follows the models."""

from __future__ import annotations

from pathlib import Path

from deployable.campaign.config.keys import rows, table
from deployable.campaign.config.read import whole

PAGE = Path(__file__).parents[2] / "docs" / "config.md"


def test_the_page_is_what_the_models_give():
    assert PAGE.read_text(encoding="utf-8") == table(whole()), (
        "make it again: python -m deployable keys > docs/config.md"
    )


def test_nested_keys_are_in_the_table():
    keys = [row[0] for row in rows(whole())]
    for key in ("campaign", "solver.step", "intervals.<name>.relative", "jobs.group"):
        assert key in keys
