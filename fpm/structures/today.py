"""What the mechanics cannot carry yet, refused by name. This file goes when they can."""

from fpm.structures.problems import Problems
from fpm.structures.reading import Table

LATER_KEYS = frozenset(["assemble"])
"""Keys of a file that are planned."""


def refuse_later(table: Table, problems: Problems) -> None:
    """Note the keys of a file that are planned."""
    for key in LATER_KEYS & table.entries.keys():
        problems.say(table.lines[key], f"{key}: comes later; allowed: a file without it")
