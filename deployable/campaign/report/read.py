"""Data of the page from a campaign's results, whose formats no other module of the report knows."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.files import open_dataset, open_netcdf, read_json
from deployable.campaign.folder import Folder
from deployable.campaign.report.data import (
    REFINEMENT,
    MovingRun,
    PageData,
    PageRun,
    RunVerdicts,
    WhatIf,
)
from deployable.campaign.report.failing_region import meets
from deployable.campaign.report.motions import ShownRun, shown_runs
from deployable.campaign.results.quantity_results import FittedRuns, QuantityResults
from deployable.campaign.results.response_bounds import CampaignBounds, read_bounds
from deployable.campaign.results.run_samples import (
    RunSamples,
    RunTable,
    describe_events,
    open_samples,
    read_refinement,
)
from fpm.files.seals import DamagedError, check


def from_results(path: str | Path) -> PageData:
    """Read all data of a campaign's page. path: of the results' folder, with `samples.nc`,
    `bounds.nc` and `summary.json`, and for its quantities `quantities.nc` and `refinement.nc`;
    files that may be absent: `sensitivities.nc`, `batches/*.json` (times of the tasks) and
    `motions/*.nc` (of `make_motions`). Raises `DamagedError` for a damaged result."""
    folder = Folder(Path(path))
    facts, bounds = read_json(folder / "summary.json"), read_bounds(folder)
    movers = shown_runs(folder)
    with open_samples(folder) as samples:
        rows = _rows(samples, movers)
        runs, moving = _moving(folder, _runs(samples, rows), rows, movers)
        moving_ids = {runs[mover.run].id for mover in moving}
        data = PageData(
            facts=facts,
            time=bounds.time,
            responses=tuple(  # without widths below the error of the fit, which are none
                r
                if r.widths is None
                else replace(r, widths=np.where(r.widths > r.width_error, r.widths, np.nan))
                for r in bounds.responses
            ),
            runs=runs,
            moving=moving,
            omitted_runs=tuple(run for run in movers if moving and run.id not in moving_ids),
            work=_work(folder, facts["runs"]),
            provenance=_provenance(bounds, facts["design"], folder),
            config=json.dumps(json.loads(bounds.attributes["config"]), indent=1),
            verdicts=_verdicts(samples, folder, facts),
            what_if=_what_if(samples, folder, facts),
        )
        curves = {m.run: m.motion["curves"].values for m in data.moving if "curves" in m.motion}
        if not samples.keeps_extremes:  # of which a scan may have more than fit into memory
            drawn_runs = {*data.lines, *(mover.run for mover in data.moving)} - curves.keys()
            curves |= {run: samples.curves(rows[run]) for run in sorted(drawn_runs)}
    with_curves = (replace(run, curves=curves.get(i)) for i, run in enumerate(runs))
    return replace(data, runs=tuple(with_curves))


MOST_RUNS = 10_000  # runs that a page has, with their parameters; of more, it has those that move


def _rows(samples: RunSamples, movers: Iterable[ShownRun]) -> Any:
    """Places among the samples of the runs that the page has."""
    if len(samples) <= MOST_RUNS and not samples.keeps_extremes:
        return np.arange(len(samples))
    return np.array(sorted(run.row for run in movers if run.row is not None))


def _runs(samples: RunSamples, rows: Any) -> tuple[PageRun, ...]:
    values, events = samples.table.values, samples.events(rows)
    return tuple(
        PageRun(name, samples.roles[row], values[row], None, describe_events(e, samples.contacts))
        for name, row, e in zip(samples.ids(rows), rows, events, strict=True)
    )


def _moving(
    folder: Folder, runs: tuple[PageRun, ...], rows: np.ndarray, movers: Iterable[ShownRun]
) -> tuple[tuple[PageRun, ...], tuple[MovingRun, ...]]:
    """Runs, with further ones that move, and those whose motion exists; none without the first."""
    moving: list[MovingRun] = []
    all_runs = list(runs)
    for mover in movers:
        try:
            with open_dataset(folder.motions / f"{mover.id}.nc") as dataset:
                motion = dataset.load()
        except (FileNotFoundError, DamagedError):  # of a structure that has changed since
            if not moving:
                return runs, ()
            continue
        run = len(all_runs) if mover.row is None else int(np.searchsorted(rows, mover.row))
        if mover.row is None:
            events = describe_events(motion["impact"].values, motion["eventful"].values.tolist())
            all_runs.append(PageRun(mover.id, REFINEMENT, mover.values, None, events))
        moving.append(MovingRun(run, mover.label, motion))
    return tuple(all_runs), tuple(moving)


def _verdicts(samples: RunSamples, folder: Folder, summary: Mapping) -> RunVerdicts | None:
    """Return the distinct runs and which meet the requirements, further ones too."""
    if not summary["quantities"]:
        return None
    table = RunTable.join([samples.table, read_refinement(folder)[0]])
    points = np.round(table.points, 9) + 0.0
    rows = np.sort(np.unique(points, axis=0, return_index=True)[1])  # each run once
    values, numbers = table.values[rows], table.numbers[rows]
    limits = [limit for row in summary.get("requirements", ()) for limit in row["limits"]]
    return RunVerdicts(values, meets(limits, list(samples.experiment.quantities), numbers), numbers)


def _what_if(samples: RunSamples, folder: Folder, summary: Mapping) -> WhatIf:
    """Return the fits to quantities and, where bounds come from a polynomial, to responses."""
    limits = QuantityResults.read(folder).limits if summary["quantities"] else ()

    def surrogates(runs: FittedRuns) -> dict[str, Any]:
        return dict(zip(samples.experiment.quantities, runs.surrogates(limits), strict=True))

    fits: dict[str, Any] = {"quantities": surrogates(FittedRuns.read(folder)) if limits else {}}
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


def _work(folder: Folder, run_counts: Mapping[str, int]) -> list[dict]:
    """Time in batches of runs, of all processes; run_counts: the summary's, by purpose."""
    patterns = ("batches/*.json", "rounds/*/batches/*.json")
    paths = sorted(path for pattern in patterns for path in folder.path.glob(pattern))
    if not (manifests := list(map(read_json, paths))):
        return []
    total = np.sum([m["seconds"] for m in manifests], axis=0)
    solver = np.sum([m["seconds_integrating"] for m in manifests], axis=0)
    runs = sum(m["simulated"] for m in manifests)
    extra_runs = run_counts.get("further", 0) + run_counts.get("choice", 0)
    rest = f", {extra_runs} for quantities and choice not counted" if extra_runs else ""
    tasks = {f"Integrating {runs} runs{rest}": solver}
    tasks["Starting, compiling or loading the kernels, writing"] = total - solver
    return [{"task": task, "clock": t[0], "cpu": t[1]} for task, t in tasks.items()]


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
