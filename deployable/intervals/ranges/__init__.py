"""Ranges over the box: what bounds a function of the parameters, guaranteed or attained.

`surrogate_range` is that of a polynomial; the others are what it is made of.
"""

from .line_range import line_range
from .range import Range, attained, raised
from .surrogate_range import surrogate_range

__all__ = ["Range", "attained", "line_range", "raised", "surrogate_range"]
