"""Data of the page, read from a campaign's results: no other module here knows their formats."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from deployable.campaign.files import open_dataset, open_netcdf, read_json
from deployable.campaign.folder import Folder
from deployable.campaign.report.motions import ShownRun, shown_runs
from deployable.campaign.results.display import shown_bounds, shown_facts
from deployable.campaign.results.quantity_results import FittedRuns
from deployable.campaign.results.response_bounds import CampaignBounds, read_bounds
from deployable.campaign.results.run_samples import (
    RunSamples,
    RunTable,
    describe_events,
    open_samples,
    read_refinement,
)
from deployable.intervals.scalars import Limit
from fpm.files.seals import DamagedError, check

if TYPE_CHECKING:
    import xarray

    from deployable.campaign.config.sections import Experiment
    from deployable.campaign.results.response_bounds import ResponseBounds


REFINEMENT = "further"  # role of the runs that were made for the ends of quantities
MOST_LINES = 48  # runs that were not fitted, drawn as thin lines


@dataclass(frozen=True)
class PageRun:
    """A run on the page. id: hexadecimal; role: one of `files.contents.ROLES`; values (k): of the
    parameters; curves (n, T): its responses, None where they are not drawn; events: contacts that
    close or open in it, in order, dicts of `time` (s), `contact` (name), `closing`; label: what it
    is in words, if it is shown moving."""

    id: str
    role: str
    values: np.ndarray
    curves: Any = None
    events: Sequence[Mapping[str, Any]] = ()
    label: str = ""


@dataclass(frozen=True)
class RunVerdicts:
    """For R runs whether each meets all requirements, `met` (R, bool), with its k parameter
    `values` (R, k) and its q quantities, `numbers` (R, q), in their units, NaN: none."""

    values: np.ndarray
    met: np.ndarray
    numbers: np.ndarray


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
    `summary.json` in the units of `display`, which responses and verdicts have, too; runs: the
    planned ones (of a large scan those that move), then further ones that move; moving: whole
    motions (`fpm.solver.motion`) by index in `runs`, the nominal one first, then those at which
    quantities and bounds are attained; omitted_runs: of whose motion there is no room; provenance:
    what computed results; verdicts: None without quantities."""

    facts: Mapping[str, Any]
    time: np.ndarray
    responses: tuple[ResponseBounds, ...]
    runs: tuple[PageRun, ...]
    moving: Mapping[int, xarray.Dataset] = field(default_factory=dict)
    omitted_runs: tuple[ShownRun, ...] = ()
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


MOST_RUNS = 10_000  # runs that a page has, with their parameters; of more, it has those that move


def from_results(path: str | Path) -> PageData:
    """Read all data of a campaign's page. path: of the results' folder, with `samples.nc`,
    `bounds.nc` and `summary.json`, and for its quantities `refinement.nc`;
    files that may be absent: `sensitivities.nc` and `motions/*.nc` (of `make_motions`). Raises
    `DamagedError` for a damaged result."""
    folder = Folder(Path(path))
    facts, bounds = read_json(folder / "summary.json"), read_bounds(folder)
    movers = shown_runs(folder)
    with open_samples(folder) as samples:
        experiment = samples.experiment
        rows: Any = np.arange(len(samples))
        if len(samples) > MOST_RUNS:
            rows = np.array(sorted(run.row for run in movers if run.row is not None))
        copy, bounds = shown_facts(facts, experiment), shown_bounds(bounds, experiment.display)
        labels, values = {mover.row: mover.label for mover in movers}, samples.table.values
        runs = [
            PageRun(name, samples.roles[row], values[row], None,
                    describe_events(events, samples.contacts), labels.get(row, ""))
            for name, row, events in zip(samples.ids(rows), rows, samples.events(rows), strict=True)
        ]  # fmt: skip
        moving: dict[int, xarray.Dataset] = {}
        for mover in movers:
            try:
                with open_dataset(folder.motions / f"{mover.id}.nc") as dataset:
                    motion = dataset.load()
            except (FileNotFoundError, DamagedError):  # of a structure that has changed since
                if not moving:  # without the first, nothing moves
                    break
                continue
            index = len(runs) if mover.row is None else int(np.searchsorted(rows, mover.row))
            moving[index] = motion
            if mover.row is None:
                names = motion["eventful"].values.tolist()
                events = describe_events(motion["impact"].values, names)
                run = PageRun(mover.id, REFINEMENT, mover.values, None, events, mover.label)
                runs.append(run)
        moving_ids = {runs[i].id for i in moving}
        data = PageData(
            facts=copy,
            time=bounds.time,
            responses=tuple(bounds.responses),
            runs=tuple(runs),
            moving=moving,
            omitted_runs=tuple(run for run in movers if moving and run.id not in moving_ids),
            provenance=_provenance(bounds, facts["design"], folder),
            config=json.dumps(json.loads(bounds.attributes["config"]), indent=1),
            verdicts=_verdicts(samples, folder, facts, copy),
        )
        curves = {i: m["curves"].values for i, m in moving.items() if "curves" in m}
        drawn_runs = {*data.lines, *moving} - curves.keys()
        curves |= {run: samples.curves(rows[run]) for run in sorted(drawn_runs)}
    with_curves = (replace(run, curves=curves.get(i)) for i, run in enumerate(runs))
    what_if = _what_if(experiment, folder, facts)
    return replace(data, runs=tuple(with_curves), what_if=what_if)


def _verdicts(
    samples: RunSamples, folder: Folder, summary: Mapping, copy: Mapping
) -> RunVerdicts | None:
    """Return the distinct runs and which meet the requirements, further ones too, with numbers in
    the units of `copy`, the summary as it is shown."""
    if not summary["quantities"]:
        return None
    table = RunTable.join([samples.table, read_refinement(folder)[0]])
    points = np.round(table.points, 9) + 0.0
    rows = np.sort(np.unique(points, axis=0, return_index=True)[1])  # each run once
    values, numbers = table.values[rows], table.numbers[rows]
    limits = [limit for row in summary.get("requirements", ()) for limit in row["limits"]]
    flags = meets(limits, list(samples.experiment.quantities), numbers)
    box, scales = ([row["scale"] for row in copy[key]] for key in ("parameters", "quantities"))
    return RunVerdicts(values * box, flags, numbers * scales)


def _what_if(experiment: Experiment, folder: Folder, summary: Mapping) -> WhatIf:
    """Return the fits that the page evaluates: to quantities over the box, to quantities over the
    nominal values that may be chosen, and, where bounds come from a polynomial, to responses."""

    def surrogates(runs: FittedRuns) -> dict[str, Any]:
        return dict(zip(experiment.quantities, runs.surrogates(experiment), strict=True))

    fits: dict[str, Any] = {}
    fits["quantities"] = surrogates(FittedRuns.read(folder)) if experiment.quantities else {}
    if "choice" in summary:
        record = read_json(folder.choice)["fitted"]
        keys = ("points", "numbers", "margins")
        points, numbers, margins = (np.array(record[key], dtype=float) for key in keys)
        fits["choice_quantities"] = surrogates(FittedRuns(points, numbers, margins))
        fits["choice_intervals"] = {n: tuple(ends) for n, ends in record["intervals"].items()}
    if "polynomial" in summary["bounds"]:
        with open_netcdf(folder.surrogate) as file:
            fits |= {"indices": file["multi_index"][:], "coefficients": file["coefficient"][:]}
    return WhatIf(**fits)


def _provenance(bounds: CampaignBounds, design: Mapping, folder: Folder) -> dict[str, str]:
    attributes = bounds.attributes
    limit = f"{attributes['time_step_limit']:.4g} s, by {attributes['limiting_element']}"
    facts = {
        "Config digest": str(attributes["config_hash"]),
        "Design": f"{design['method']}, {design['nodes']} runs fitted, "
        f"{design['held_out']} held out",
        "Time step": f"{attributes['time_step']:.6g} s",
        "Largest stable step": limit,
    }
    if "mechanics" in attributes:
        facts["Digest of the mechanics"] = str(attributes["mechanics"])
    origin = json.loads(attributes["provenance"])
    facts["Program"] = f"{origin.pop('program')}, commit {origin.pop('commit')}"
    facts["Made"] = f"{check(folder.bounds).get('made')}, on {origin.pop('processor')}"
    facts["Packages"] = ", ".join(f"{name} {version}" for name, version in origin.items())
    return facts


def meets(limits: Iterable[Mapping], names: Sequence[str], numbers: np.ndarray) -> np.ndarray:
    """Mask (R) of the runs that meet all requirements' limits. limits: dicts in `summary.json` with
    quantity, kind ("at_most", "at_least", "happens") and level; names: of the q quantities; numbers
    (R, q): their values, NaN if absent, which breaks any limit but `happens: false`."""
    passes = np.ones(len(numbers), dtype=bool)
    for limit in limits:
        value = numbers[:, list(names).index(limit["quantity"])]
        passes &= Limit(None, limit["kind"], limit["level"]).find_margins(value) >= 0
    return passes
