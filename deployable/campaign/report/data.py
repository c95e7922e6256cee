"""What the page tells, independent of the files that it comes from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray


FURTHER = "further"
"""Role of the runs that were made for the ends of quantities."""

MOST_LINES = 48
"""Runs that were not fitted, drawn as thin lines."""


@dataclass(frozen=True)
class ResponseBounds:
    """A response with its bounds over time, arrays (t,) in `units`.

    error: estimated error of the bounds; shares (k,), widths (k, t): what each parameter
    contributes, overall and at every instant, not a number where that is not above the error of the
    fit. abscissa: over what it lies instead of time (`results.facts.along_of`); least: what it can
    not be below.
    """

    name: str
    long_name: str
    units: str
    lower: np.ndarray
    upper: np.ndarray
    nominal: np.ndarray | None = None
    error: np.ndarray | None = None
    shares: np.ndarray | None = None
    widths: np.ndarray | None = None
    abscissa: Mapping[str, Any] | None = None
    least: float | None = None

    @property
    def widest(self) -> int:
        """Index of the instant of the largest difference of the bounds."""
        return int((self.upper - self.lower).argmax())


@dataclass(frozen=True)
class Event:
    """A contact that closes, or opens, at a time (s)."""

    time: float
    contact: str
    closing: bool


@dataclass(frozen=True)
class PageRun:
    """A run: role (nominal, node, held_out or further), parameter values (k,).

    curves (response, t): runs that are not drawn need none.
    """

    id: str
    role: str
    values: np.ndarray
    curves: np.ndarray | None = None
    events: tuple[Event, ...] = ()


@dataclass(frozen=True)
class MovingRun:
    """A run that is shown moving: its index among the runs, why, and its `fpm.motion` dataset."""

    run: int
    label: str
    motion: xarray.Dataset


@dataclass(frozen=True)
class LeftOut:
    """A run that could be shown moving, and is not: its id, and why it would be."""

    id: str
    label: str


@dataclass(frozen=True)
class RunVerdicts:
    """Runs with their parameter values (R, k), which of them meet all requirements (R,), and their
    quantities (R, q), not a number where there is none."""

    values: np.ndarray
    met: np.ndarray
    numbers: np.ndarray


@dataclass(frozen=True)
class WhatIf:
    """What was fitted, which sliders ask: the surrogate of each quantity (`intervals.scalars`), and
    of all responses the polynomial, coefficients (n, M, t) of the products `indices` (M, k); None
    where the bounds are not those of a polynomial."""

    quantities: Mapping[str, Any]
    indices: np.ndarray | None
    coefficients: np.ndarray | None


@dataclass(frozen=True)
class Work:
    """A piece of work: task, seconds of the clock and of the processor (if known)."""

    task: str
    clock: float
    cpu: float | None = None


@dataclass(frozen=True)
class PageData:
    """All that the page shows.

    facts: what `summary.json` holds; time (t,) s; runs: those of the design, and of those for the
    ends of quantities the ones that move;
    moving: the nominal run first, then those at which quantities and bounds are attained;
    omitted: those of them that do not move, since the page would be too large;
    provenance: name -> text; config: text to start from again;
    verdicts: the runs with their quantities, and which meet the requirements, if there are any;
    what_if: what sliders ask.
    """

    facts: Mapping[str, Any]
    time: np.ndarray
    responses: tuple[ResponseBounds, ...]
    runs: tuple[PageRun, ...]
    moving: tuple[MovingRun, ...] = ()
    omitted: tuple[LeftOut, ...] = ()
    work: tuple[Work, ...] = ()
    provenance: Mapping[str, str] = field(default_factory=dict)
    config: str = ""
    verdicts: RunVerdicts | None = None
    what_if: WhatIf | None = None

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """The interval parameters: name, description, units, lower, nominal, upper."""
        return self.facts["parameters"]

    @property
    def nominal(self) -> PageRun | None:
        """The nominal run, if there is one."""
        return next((run for run in self.runs if run.role == "nominal"), None)

    @property
    def unfitted(self) -> tuple[int, ...]:
        """Indices of the runs that no surrogate was fitted to; the nominal run is among them."""
        fitted_ids = {run.id for run in self.runs if run.role in ("node", FURTHER)}
        return tuple(i for i, run in enumerate(self.runs) if run.id not in fitted_ids)

    @property
    def lines(self) -> list[int]:
        """Indices of the runs drawn as thin lines: unfitted ones, evenly chosen where many are."""
        runs = [i for i in self.unfitted if self.runs[i].role != "nominal"]
        indices = np.unique(np.linspace(0, len(runs) - 1, min(len(runs), MOST_LINES)).round())
        return [runs[int(i)] for i in indices] if runs else []
