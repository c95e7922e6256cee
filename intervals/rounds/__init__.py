"""Rounds of runs: what they have shown, which design comes next, and where to look further."""

from .decide import Decision, Progress, Specification, decide
from .measure import measure_round
from .seek import seek_points

__all__ = ["Decision", "Progress", "Specification", "decide", "measure_round", "seek_points"]
