"""The reference of config keys follows the models."""

from __future__ import annotations

from deployable.campaign.config.keys import rows, table
from deployable.campaign.config.read import whole


def test_every_key_is_in_the_reference():
    page = table(whole())
    assert all(f"| `{row[0]}` |" in page for row in rows(whole()))


def test_nested_keys_are_in_the_table():
    keys = [row[0] for row in rows(whole())]
    for key in ("campaign", "solver.step", "intervals.<name>.relative", "jobs.group"):
        assert key in keys
