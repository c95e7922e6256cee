"""Data of the page, independent of the files that they come from."""

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
    """Bounds of a response over time, arrays (t,) in `units`, with nominal run and error.

    error: estimated error of the bounds; shares (k,), widths (k, t): contribution of each
    parameter, overall and at every instant, NaN where it is not above the error of the fit;
    abscissa: as of `results.facts.along_of`, None: time; least: lowest possible value. None stands
    for what is not known.
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
    """A run of the page: its role (nominal, node, held_out or further), parameter values (k,) and
    events.

    curves (response, t): None for a run that is not drawn.
    """

    id: str
    role: str
    values: np.ndarray
    curves: np.ndarray | None = None
    events: tuple[Event, ...] = ()


@dataclass(frozen=True)
class MovingRun:
    """A run that is shown moving: its index among the runs, a label in words, and its whole motion,
    a dataset of `fpm.motions`."""

    run: int
    label: str
    motion: xarray.Dataset


@dataclass(frozen=True)
class OmittedRun:
    """A run that would be shown moving if the page had room: its id, and its label in words."""

    id: str
    label: str


@dataclass(frozen=True)
class RunVerdicts:
    """Runs with their parameter values (R, k), whether they meet all requirements (R,), and their
    quantities (R, q), NaN for one that does not occur."""

    values: np.ndarray
    met: np.ndarray
    numbers: np.ndarray


@dataclass(frozen=True)
class WhatIf:
    """Surrogates that the page's sliders evaluate: of quantities by name (`intervals.scalars`), and
    of all responses as polynomials.

    coefficients (n, M, t): of the products with orders `indices` (M, k); both None where bounds are
    not those of polynomials.
    """

    quantities: Mapping[str, Any]
    indices: np.ndarray | None
    coefficients: np.ndarray | None


@dataclass(frozen=True)
class Work:
    """Time that a task took: seconds of wall-clock time and, None if unknown, of processor time."""

    task: str
    clock: float
    cpu: float | None = None


@dataclass(frozen=True)
class PageData:
    """All data that the page shows.

    facts: content of `summary.json`; time (t,): s; responses: their bounds; runs: those of the
    design, and refinement runs that move; moving: the nominal run first, then those at which
    quantities and bounds are attained; omitted: runs for whose motion the page has no room; work:
    times that tasks took; provenance: texts by name; config: text of a config that repeats the
    campaign; verdicts: None without quantities; what_if: surrogates of the sliders.
    """

    facts: Mapping[str, Any]
    time: np.ndarray
    responses: tuple[ResponseBounds, ...]
    runs: tuple[PageRun, ...]
    moving: tuple[MovingRun, ...] = ()
    omitted: tuple[OmittedRun, ...] = ()
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
        """Indices of the runs drawn as thin lines: those not fitted, at most `MOST_LINES`, evenly
        chosen."""
        runs = [i for i in self.unfitted if self.runs[i].role != "nominal"]
        indices = np.unique(np.linspace(0, len(runs) - 1, min(len(runs), MOST_LINES)).round())
        return [runs[int(i)] for i in indices] if runs else []
