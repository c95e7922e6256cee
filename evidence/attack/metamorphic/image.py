"""A structure in other words, and how to read what it does."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from evidence.attack.metamorphic.structure_text import Structure
from fpm.arithmetic.units import unit

Entries = dict[str, dict[str, Any]]


@dataclass
class Image:
    """A structure in other words, and how to read what it does.

    Positions (m) are `matrix` times those of the original plus `shift`, all times the factors of
    their units (`factor`); openings are a sign times the original's plus a zero (`opening_maps`, by
    joint); `names` that are others; all happens `delay` (s) later. is_exact: by the same arithmetic
    but for rounding, else to the order of the step. omits: kinds of curves that are not the same;
    skips: so many instants at the start are not."""

    structure: Structure
    matrix: np.ndarray = field(default_factory=lambda: np.eye(3))
    shift: np.ndarray = field(default_factory=lambda: np.zeros(3))
    units: tuple[float, float, float] = (1.0, 1.0, 1.0)
    opening_maps: dict[str, tuple[float, float]] = field(default_factory=dict)
    names: dict[str, str] = field(default_factory=dict)
    delay: float = 0.0
    is_exact: bool = True
    omits: frozenset[str] = frozenset()
    skips: int = 0

    def factor(self, name: str) -> float:
        """What a unit's numbers grow by; `units`: those of kg, m and s."""
        return scale(self.units, name)


def scale(units: tuple[float, float, float], name: str) -> float:
    """The factor of numbers in a unit where those in kg, m and s have `units`."""
    powers = unit(name).dimension.powers
    return float(np.prod([u**power for u, power in zip(units, powers, strict=True)]))


def entries(structure: Structure, group: str) -> Entries:
    """The entries of a group; none where there is none."""
    return structure.get(group, {})
