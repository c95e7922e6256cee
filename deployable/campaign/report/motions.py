"""Whole motions of runs on the page: the nominal one, and those at which bounds are attained."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.folder import Folder
from deployable.campaign.results.bounds import write_dataset
from deployable.campaign.results.response_bounds import read_bounds
from deployable.campaign.results.run_samples import (
    RunSamples,
    RunTable,
    check_mechanics,
    open_samples,
    read_refinement,
)
from fpm.files.seals import DamagedError, check
from fpm.solver.motion import whole_motion
from fpm.solver.simulate import HALVINGS

MOST_MOVING = 24
"""Runs that are shown, the nominal one among them; of more ends, those of quantities come first."""

MOST_PLACES = 90_000
"""Particles times frames of all motion on a page, below 3 MB; for it frames are left out."""

_FEW_RUNS, _FEW_FRAMES = 7, 100


@dataclass(frozen=True)
class ShownRun:
    """A run that the page shows moving: id, `values` (k) of the interval parameters, and `label`,
    what it is an end of; the page's legend has the first of these.
    row: index in `samples.nc`; None: it is in `refinement.nc`."""

    id: str
    values: np.ndarray
    label: str
    row: int | None


def shown_runs(path: Any) -> list[ShownRun]:
    """List the runs that a campaign's page shows moving, at most 24 (`MOST_MOVING`): the nominal
    one (or a scan's first), then those at the bounds of the quantities, then those with the least
    and largest value of each response when its bounds differ most. path: of the results."""
    folder = Folder(path)
    bounds = read_bounds(folder)
    with open_samples(folder) as samples:
        ends = [
            (_end_words(row.name), samples.extreme_runs(i, row.widest))
            for i, row in enumerate(bounds.responses)
        ]
        tables = [samples.table]
        extra_ids: Any = []
        if quantities := list(samples.experiment.quantities):
            table, extra_ids, _ = read_refinement(folder)
            tables.append(table)
            columns = dict(zip(quantities, RunTable.join(tables).numbers.T, strict=True))
            happens = {name: x for name, x in columns.items() if np.isfinite(x).any()}
            rows = samples.experiment.quantity_list
            words = {row.name: _end_words(row.name, row.is_time) for row in rows}
            ends = [
                (words[name], (int(np.nanargmin(x)), int(np.nanargmax(x))))
                for name, x in happens.items()
            ] + ends
        values = RunTable.join(tables).values
        labels, count = _label_runs(ends, values, samples.nominal), len(samples)
        rows = [run for run in labels if run < count]
        ids = dict(zip(rows, samples.ids(rows), strict=True))
    ids |= {count + i: name for i, name in enumerate(extra_ids)}
    return [
        ShownRun(ids[run], values[run], label, run if run < count else None)
        for run, label in labels.items()
    ]


def count_moving_runs(particles: int) -> int:
    """Return how many moving runs of a hundred frames a page has room for, 7 to 24."""
    room = MOST_PLACES // (_FEW_FRAMES * particles)
    return int(np.clip(room, _FEW_RUNS, MOST_MOVING))


def _end_words(name: str, is_time: bool = False) -> tuple[str, str]:
    """What the runs of the least and the largest value are called."""
    least, largest = ("earliest", "latest") if is_time else ("smallest", "largest")
    return f"{least} {name}", f"{largest} {name}"


def _label_runs(
    ends: Sequence[tuple[tuple[str, str], tuple[int, int]]], values: np.ndarray, nominal: int | None
) -> dict[int, str]:
    """Label the nominal run and the runs at the ends of quantities, by their indices among values
    (R, k). Runs with equal values share a label."""
    first = nominal or 0
    ends_by_run: dict[int, list[str]] = {}
    for words, runs in ends:
        for run, text in zip(runs, words, strict=True):
            twin = next((r for r in ends_by_run if (values[r] == values[run]).all()), run)
            ends_by_run.setdefault(twin, []).append(text)
    labels = {first: "first run" if nominal is None else "nominal run"}
    for run, texts in ends_by_run.items():
        if (values[run] != values[first]).any() and len(labels) < MOST_MOVING:
            labels[run] = ", ".join(texts)
    return labels


def motions_of(samples: RunSamples, runs: Sequence[ShownRun], frames: int = 401) -> list:
    """Simulate runs of a campaign again and return their whole motions; raises
    `fpm.InstabilityError` if one fails. frames: evenly spread over time, besides the instants at
    which a contact of the first run closes or opens. A run whose curves are not in `samples.nc`
    gets the variables `curves`, `impact` and `eventful`."""

    def read_curves(outcome: Any) -> dict:
        curves = np.array([response.evaluate(outcome) for response in experiment.response_list])
        impacts = outcome.impacts()
        return {
            "curves": (("response", "instant"), curves, {"long_name": "value of the response"}),
            "impact": (("impacts", "column"), impacts.events, {
                "long_name": "time (s), index into `eventful`, 1 if it closes"}),
            "eventful": ("named", np.array(impacts.names, dtype=object), {
                "long_name": "contact, stop or latch"}),
        }  # fmt: skip

    experiment, solver = samples.experiment, samples.experiment.solver
    points = [zip(experiment.intervals, run.values.tolist(), strict=True) for run in runs]
    scenes = [experiment.build(dict(point)) for point in points]
    first_row: Any = runs[0].row
    (events,) = samples.events([first_row])
    bare = {i for i, run in enumerate(runs) if run.row is None}
    return whole_motion(
        scenes,
        duration=solver.duration,
        instants=solver.instants,
        step=samples.time_step,
        halvings=HALVINGS,
        energy_tolerance=solver.energy_tolerance,
        record=experiment.record if bare else (),
        frames=frames,
        times=events[:, 0].tolist(),
        attributes=[{"run_id": run.id, "campaign": experiment.name} for run in runs],
        extra_variables=lambda i, outcome: read_curves(outcome) if i in bare else {},
    )


def make_motions(path: str | Path, frames: int = 401) -> list[Path]:
    """Simulate the runs that a campaign's page shows, write their whole motions into `path /
    "motions"`, files named after the runs' ids (.nc), and return the paths, first that of the
    nominal run (or a scan's first). path: of the campaign's results; frames: of each motion.
    Damaged motions of other runs are removed. Raises `CampaignError` where structure or mechanics
    changed since the runs were made."""
    folder = Folder(Path(path))
    runs = shown_runs(folder)
    with open_samples(folder) as samples:
        experiment = samples.experiment
        check_mechanics(experiment, samples.mechanics, folder)
        values = dict(zip(experiment.intervals, runs[0].values, strict=True))
        runs = runs[: count_moving_runs(len(experiment.build(values).position))]
        paths = [folder.motions / f"{run.id}.nc" for run in runs]
        for motion, path in zip(motions_of(samples, runs, frames), paths, strict=True):
            write_dataset(motion, path, "Whole motion of a run")
    for rest in set(folder.motions.glob("*.nc")) - set(paths):
        try:
            check(rest, rest.name)
        except DamagedError:  # which is no longer shown, and so never made again
            rest.unlink()
    return paths
