"""Errors that a user is meant to read."""

from __future__ import annotations


class CampaignError(Exception):
    """Something that the user can mend; `str()` is the whole message."""


class ConfigError(CampaignError):
    """All problems found in a config, one sentence each.

    Parameters
    ----------
    source : name of the file, or what else the config came from.
    problems : sentences that start with the key.
    """

    def __init__(self, source: str, problems: list[str]):
        self.source = source
        self.problems = list(problems)
        count = "1 problem" if len(problems) == 1 else f"{len(problems)} problems"
        super().__init__(f"{source} has {count}:\n" + "\n".join(f"  {p}" for p in problems))
