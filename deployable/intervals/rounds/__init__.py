"""Rounds of runs: what they have shown, which design comes next, and where to look further."""

from .decide import Decision, Progress, Specification, decide
from .measure import measure_round
from .places import Places, deciding_places
from .seek import seek_points

__all__ = [
    "Decision",
    "Places",
    "Progress",
    "Specification",
    "decide",
    "deciding_places",
    "measure_round",
    "seek_points",
]
