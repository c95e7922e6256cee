"""Data of the page from a campaign's results, whose formats no other module of the report knows."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from deployable.campaign.files import open_dataset, open_netcdf, read_json
from deployable.campaign.folder import Folder
from deployable.campaign.report.data import (
    REFINEMENT,
    MovingRun,
    PageData,
    PageRun,
    ResponseBounds,
    RunVerdicts,
    WhatIf,
)
from deployable.campaign.report.failing_region import meets
from deployable.campaign.report.motions import ShownRun, shown_runs
from deployable.campaign.results.facts import along_of
from deployable.campaign.results.fitted_runs import FittedRuns
from deployable.campaign.results.run_roles import count_roles, keeps_extremes, read_ids, read_roles
from fpm.files.seals import DamagedError, check

if TYPE_CHECKING:
    import xarray

    from deployable.intervals.scalars import ScalarSurrogate


def from_results(folder: str | Path) -> PageData:
    """Read all data of a campaign's page. folder: of the results, with `samples.nc`, `bounds.nc`
    and `summary.json`, and for its quantities `quantities.nc` and `refinement.nc`; files that may
    be absent: `sensitivities.nc`, `batches/*.json` (times of the tasks) and `motions/*.nc` (of
    `make_motions`). Raises `DamagedError` for a damaged result."""
    folder = Path(folder)
    facts = read_json(folder / "summary.json")
    samples, bounds = _load(folder / "samples.nc", "values"), _load(folder / "bounds.nc")
    sensitivities = folder / "sensitivities.nc"
    movers = shown_runs(folder)
    rows = _rows(samples, movers)
    runs, moving = _moving(folder, _runs(samples, rows), rows, movers)
    moving_ids = {runs[mover.run].id for mover in moving}
    data = PageData(
        facts=facts,
        time=bounds["time"].values,
        responses=_responses(bounds, _load(sensitivities) if sensitivities.exists() else None),
        runs=runs,
        moving=moving,
        omitted_runs=tuple(run for run in movers if moving and run.id not in moving_ids),
        work=_work(folder, facts["runs"]),
        provenance=_provenance(bounds, samples, folder),
        config=json.dumps(json.loads(bounds.attrs["config"]), indent=1),
        verdicts=_verdicts(samples, folder, facts),
        what_if=_what_if(folder, facts),
    )
    curves = {m.run: m.motion["curves"].values for m in data.moving if "curves" in m.motion}
    runs = tuple(replace(run, curves=curves.get(i)) for i, run in enumerate(runs))
    if keeps_extremes(samples):
        return replace(data, runs=runs)
    drawn_runs = {*data.lines, *(mover.run for mover in data.moving)} - curves.keys()
    return replace(data, runs=_add_curves(runs, rows, folder / "samples.nc", drawn_runs))


def _load(path: Path, omit: str = "") -> xarray.Dataset:
    """A dataset in memory, without one of its variables."""
    with open_dataset(path) as dataset:
        return dataset.drop_vars(omit, errors="ignore").load()


def _responses(
    bounds: xarray.Dataset, sensitivities: xarray.Dataset | None
) -> tuple[ResponseBounds, ...]:
    def values(name: str, i: int, dataset: xarray.Dataset | None = bounds) -> np.ndarray | None:
        return None if dataset is None or name not in dataset else dataset[name].values[i]

    rows = []
    for i, name in enumerate(bounds["response"].values.tolist()):
        widths, error = (values(key, i, sensitivities) for key in ("width", "error"))
        if widths is not None and error is not None:  # below the error of the fit they are none
            widths = np.where(widths > error, widths, np.nan)
        curves = {
            key: values(key, i) for key in ("least", "most", "lower", "upper", "nominal", "error")
        }
        words = (str(bounds[f"response_{key}"].values[i]) for key in ("long_name", "units"))
        shares, abscissa = values("width_overall", i, sensitivities), along_of(bounds, i)
        curves |= {"shares": shares, "widths": widths, "abscissa": abscissa}
        rows.append(ResponseBounds(name, *words, **curves))
    return tuple(rows)


MOST_RUNS = 10_000
"""Runs that a page has, with their parameters; of more, it has those that move."""


def _rows(samples: xarray.Dataset, movers: Iterable[ShownRun]) -> np.ndarray:
    """Places among the samples of the runs that the page has."""
    if len(samples["value"]) <= MOST_RUNS and not keeps_extremes(samples):
        return np.arange(len(samples["value"]))
    return np.array(sorted(run.row for run in movers if run.row is not None))


def _runs(samples: xarray.Dataset, rows: np.ndarray) -> tuple[PageRun, ...]:
    contacts = samples["contact"].values.tolist() if "contact" in samples.coords else []
    events = [samples[f"event_{key}"].values[rows] for key in ("time", "contact", "closing")]
    names, values = read_ids(samples, rows), samples["value"].values[rows]
    run_roles = read_roles(samples)
    return tuple(
        PageRun(
            id=names[i], role=run_roles[rows[i]], values=values[i],
            events=tuple(
                {"time": float(t), "contact": contacts[int(contact)], "closing": bool(closing)}
                for t, contact, closing in sorted(zip(*(e[i] for e in events), strict=True))
                if np.isfinite(t)
            ),
        )
        for i in range(len(rows))
    )  # fmt: skip


def _add_curves(
    runs: tuple[PageRun, ...], rows: np.ndarray, path: Path, indices: Iterable[int]
) -> tuple[PageRun, ...]:
    """The runs, those at `indices` with their curves: a scan may have more than fit into memory."""
    new_runs = list(runs)
    with open_netcdf(path) as samples:
        for run in sorted(indices):
            new_runs[run] = replace(runs[run], curves=samples["values"][rows[run]])
    return tuple(new_runs)


def _moving(
    folder: Path, runs: tuple[PageRun, ...], rows: np.ndarray, movers: Iterable[ShownRun]
) -> tuple[tuple[PageRun, ...], tuple[MovingRun, ...]]:
    """Runs, with further ones that move, and those whose motion exists; none without the first."""
    moving: list[MovingRun] = []
    all_runs = list(runs)
    for mover in movers:
        try:
            motion = _load(Folder(folder).motions / f"{mover.id}.nc")
        except (FileNotFoundError, DamagedError):  # of a structure that has changed since
            if not moving:
                return runs, ()
            continue
        run = len(all_runs) if mover.row is None else int(np.searchsorted(rows, mover.row))
        if mover.row is None:
            all_runs.append(PageRun(mover.id, REFINEMENT, mover.values, events=_impacts(motion)))
        moving.append(MovingRun(run, mover.label, motion))
    return tuple(all_runs), tuple(moving)


def _verdicts(samples: xarray.Dataset, folder: Path, summary: Mapping) -> RunVerdicts | None:
    """The distinct runs and which meet the requirements, further ones too."""
    if not summary["quantities"]:
        return None
    parts = [samples]
    if (folder / "refinement.nc").exists():
        parts.append(_load(folder / "refinement.nc"))
    values, points, numbers = (
        np.concatenate([part[name].values for part in parts])
        for name in ("value", "normalized", "quantities")
    )
    points = np.round(points, 9) + 0.0
    rows = np.sort(np.unique(points, axis=0, return_index=True)[1])  # each run once
    values, numbers = values[rows], numbers[rows]
    limits = [limit for row in summary.get("requirements", ()) for limit in row["limits"]]
    return RunVerdicts(values, meets(limits, samples["quantity"].values.tolist(), numbers), numbers)


def _what_if(folder: Path, summary: Mapping) -> WhatIf:
    """What was fitted to quantities and, where bounds are a polynomial's, to responses."""
    place = Folder(folder)
    model = WhatIf({}, None, None)
    if summary["quantities"]:
        model = WhatIf(_surrogates(place, FittedRuns.read(place)), None, None)
    if "choice" in summary:
        record = read_json(place.choice)["fitted"]
        keys = ("points", "numbers", "margins")
        runs = FittedRuns(*(np.array(record[key], dtype=float) for key in keys))
        model = replace(
            model,
            choice_quantities=_surrogates(place, runs),
            choice_intervals={name: tuple(ends) for name, ends in record["intervals"].items()},
        )
    if "polynomial" not in summary["bounds"]:
        return model
    with open_netcdf(place.surrogate) as file:
        indices, coefficients = file["multi_index"][:], file["coefficient"][:]
    return replace(model, indices=indices, coefficients=coefficients)


def _surrogates(folder: Folder, runs: FittedRuns) -> dict[str, ScalarSurrogate]:
    """The surrogate of each quantity by its name, fitted to runs."""
    with open_netcdf(folder.quantities) as file:
        names = file["quantity"][:].tolist()
        return {name: runs.surrogate(file, q) for q, name in enumerate(names)}


def _impacts(motion: xarray.Dataset) -> tuple[dict, ...]:
    """The events of a run that is not among the samples."""
    names, rows = motion["eventful"].values.tolist(), sorted(motion["impact"].values.tolist())
    return tuple({"time": t, "contact": names[int(i)], "closing": c == 1} for t, i, c in rows)


def _work(folder: Path, run_counts: Mapping[str, int]) -> list[dict]:
    """Time in batches of runs, of all processes; run_counts: the summary's, by purpose."""
    patterns = ("batches/*.json", "rounds/*/batches/*.json")
    paths = sorted(path for pattern in patterns for path in folder.glob(pattern))
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


def _provenance(bounds: xarray.Dataset, samples: xarray.Dataset, folder: Path) -> dict[str, str]:
    attributes = bounds.attrs
    design = count_roles(samples)
    limit = f"{attributes['time_step_limit']:.4g} s, by {attributes['limiting_element']}"
    facts = {
        "Config digest": str(attributes["config_hash"]),
        "Design": f"{attributes.get('design_method', '')}, {design.nodes} runs fitted, "
        f"{design.held_out} held out",
        "Time step": f"{attributes['time_step']:.6g} s",
        "Largest stable step": limit,
    }
    if "mechanics" in attributes:
        facts["Digest of the mechanics"] = str(attributes["mechanics"])
    origin = json.loads(attributes["provenance"])
    facts["Program"] = f"{origin.pop('program')}, commit {origin.pop('commit')}"
    facts["Made"] = f"{check(folder / 'bounds.nc').get('made')}, on {origin.pop('processor')}"
    facts["Packages"] = ", ".join(f"{name} {version}" for name, version in origin.items())
    return facts
