"""Boxes of small structures with rigid parts, whose bounds are known from models of their own.

Each goes through the whole program: once with `accuracy`, and with presets to compare its cost.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Mechanism:
    """A structure, its box and a model of it that shares nothing with the program.

    structure: text in the language of structures, whose real parameters have SI units; intervals:
    least and largest value by parameter; responses, quantities: as in a config; model: values
    (P, quantities) at points (P, parameters) in SI units, in the order of `quantities` and
    `intervals`, NaN where a quantity does not happen; duration: of a run, s; design: in place of
    `accuracy`, where there are more than eight intervals.
    """

    name: str
    structure: str
    intervals: Mapping[str, tuple[float, float]]
    responses: Mapping[str, Any]
    quantities: Mapping[str, Any]
    model: Callable[[np.ndarray], np.ndarray]
    duration: float = 1.0
    instants: int = 401
    design: Mapping[str, Any] | None = None
