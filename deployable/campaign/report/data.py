"""Data of the page, independent of the files that they come from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray

    from deployable.campaign.report.motions import ShownRun
    from deployable.campaign.results.response_bounds import ResponseBounds


REFINEMENT = "further"  # role of the runs that were made for the ends of quantities
MOST_LINES = 48  # runs that were not fitted, drawn as thin lines


@dataclass(frozen=True)
class PageRun:
    """A run on the page. id: hexadecimal; role: one of `files.contents.ROLES`; values (k): of the
    parameters; curves (n, T): its responses, None where they are not drawn; events: contacts that
    close or open in it, in order, dicts of `time` (s), `contact` (name), `closing`."""

    id: str
    role: str
    values: np.ndarray
    curves: Any = None
    events: Sequence[Mapping[str, Any]] = ()


@dataclass(frozen=True)
class MovingRun:
    """A run that the page shows moving: `run`, its index in `PageData.runs`, `label`, what it is in
    words, and `motion`, its whole motion, a dataset as `fpm.motions` makes it."""

    run: int
    label: str
    motion: xarray.Dataset


@dataclass(frozen=True)
class RunVerdicts:
    """For R runs whether each meets all requirements, `met` (R, bool), with its k parameter
    `values` (R, k) and its q quantities, `numbers` (R, q), in their units, NaN: none."""

    values: np.ndarray
    met: np.ndarray
    numbers: np.ndarray

    @property
    def tell_apart(self) -> bool:
        """Whether some runs fail and some meet all requirements."""
        return 0 < self.met.sum() < len(self.met)


@dataclass(frozen=True)
class WhatIf:
    """What the page's sliders evaluate: `quantities`, `ScalarSurrogate` by name, and polynomials of
    the responses: coefficients (n, M, T) of M products of Chebyshev polynomials, whose degrees are
    indices (M, k); both None where the bounds are not those of polynomials. With a choice also the
    quantities over all choices, and what its runs span, (lower, upper) by parameter."""

    quantities: Mapping[str, Any]
    indices: Any = None
    coefficients: np.ndarray | None = None
    choice_quantities: Mapping[str, Any] = field(default_factory=dict)
    choice_intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class PageData:
    """All that a campaign's page shows, as `from_results` reads it. facts: content of
    `summary.json`; runs: the planned ones (of a large scan those that move), then further ones that
    move; moving: the nominal one first, then those at which quantities and bounds are attained;
    omitted_runs: for whose motion the page has no room; work: dicts of `task`, `clock` and `cpu`
    (s); provenance: what computed the results; config: text; verdicts: None without quantities."""

    facts: Mapping[str, Any]
    time: np.ndarray
    responses: tuple[ResponseBounds, ...]
    runs: tuple[PageRun, ...]
    moving: tuple[MovingRun, ...] = ()
    omitted_runs: tuple[ShownRun, ...] = ()
    work: Sequence[Mapping[str, Any]] = ()
    provenance: Mapping[str, str] = field(default_factory=dict)
    config: str = ""
    verdicts: Any = None
    what_if: Any = None

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """The interval parameters, a dict each: name, description, units, lower, nominal, upper."""
        return self.facts["parameters"]

    @property
    def nominal(self) -> PageRun | None:
        """The run at nominal parameters; None if there is none."""
        return next((run for run in self.runs if run.role == "nominal"), None)

    @property
    def unfitted_runs(self) -> tuple[int, ...]:
        """Indices in `runs` of those that no surrogate was fitted to: held out, or the nominal."""
        fitted_ids = {run.id for run in self.runs if run.role in ("node", REFINEMENT)}
        return tuple(i for i, run in enumerate(self.runs) if run.id not in fitted_ids)

    @property
    def lines(self) -> list[int]:
        """Indices in `runs` of those drawn as thin lines: neither fitted nor nominal, at most 48
        (`MOST_LINES`), evenly chosen."""
        runs = [i for i in self.unfitted_runs if self.runs[i].role != "nominal"]
        indices = np.unique(np.linspace(0, len(runs) - 1, min(len(runs), MOST_LINES)).round())
        return [runs[int(i)] for i in indices] if runs else []
