"""From the runs of a campaign to what of the box meets its requirements, `requirements.json`.

    requirements   [{name, met, share, share_uncertainty, runs, limits}], met is all, some or none
                   of the box; "undecided" where nothing fails, in so many runs or by what was
                   fitted, and errors or what only happens or does not leave open whether all does;
                   share_uncertainty: by how much the share may be more or less, by all runs and
                   estimated errors
    limits         [{quantity, units, kind, level, margin, error, at, simulated, met, share,
                   share_uncertainty, runs}]: margin at the worst place, and the estimated error,
                   of mesh and step too if known; met and what follows of this limit alone
    together       {met, share, share_uncertainty, runs, largest_share, fails, whole}: of all;
                   `fails` is the nearest place at which one fails: {requirement, quantity, kind,
                   level, units, at, simulated}; whole: whether errors have those of step and mesh
    halved         (in together) {name: {share, share_uncertainty}}: if the interval of one
                   parameter were half as wide about its nominal value
    runs, further_runs

The runs that decide were made with those of the quantities' ends. Margins are below 0 where a limit
is broken, null where something does not happen. A place is parameter values by name; `simulated` is
the quantity of the run there.
"""

from __future__ import annotations

import json
from collections.abc import Mapping

import numpy as np

from deployable.campaign.answers.bench import Bench, number
from deployable.campaign.answers.limits import Judged, is_sure, judged, limits_of, told
from deployable.campaign.config.sections import Jobs
from deployable.campaign.files import open_netcdf, write_result
from deployable.campaign.folder import Folder
from deployable.campaign.runs.progress import Tell


def answer(folder: Folder, requirements: Mapping[str, Mapping], jobs: Jobs, tell: Tell) -> None:
    """Write requirements.json of a campaign whose quantities have their intervals."""
    bench = Bench.of(folder, jobs, tell, further=True)
    asked = limits_of(requirements, list(bench.experiment.quantities))
    beyond = _of_the_runs(folder)
    found = judged(bench, bench.surrogates(), asked, beyond)
    rows = {
        "requirements": [_requirement(bench, found, name) for name in requirements],
        "together": {**_together(bench, found), "whole": beyond is not None},
        "runs": len(bench.different) + bench.left_out,
        "further_runs": len(bench.further),
    }
    write_result(folder.requirements, json.dumps(rows, indent=1, allow_nan=False) + "\n")


def _of_the_runs(folder: Folder) -> np.ndarray | None:
    """Errors (2, q) by mesh and step of quantities and of where they happen; None where these were
    not looked at."""
    with open_netcdf(folder.quantities) as data:
        if "error_limit" not in data.variables:
            return None
        return np.array([data[name][:] for name in ("error_limit", "error_border")])


def _met(bench: Bench, found: Judged, chosen: list[int]) -> dict:
    """Whether all, some or none of the box keeps chosen limits, which share, and what is open.

    Runs decide where they differ from the surrogates: one that fails, or keeps them, is enough.
    """
    from deployable.intervals.scalars import share_of_box

    share, open_ = share_of_box([found.limits[i] for i in chosen], bench.experiment.box.free)
    kept = found.slack[chosen].min(axis=0) >= 0
    told = {
        "share": share,
        "share_uncertainty": open_,
        "runs": len(bench.different) + bench.left_out,
    }
    if min(found.worst[i][0] for i in chosen) >= 0 and kept.all():
        sure = not open_ and all(is_sure(bench, found, i) for i in chosen)
        return {"met": "all" if sure else "undecided", **told, "share": 1.0}
    return {"met": "none" if share == 0 and not kept.any() else "some", **told}


def _requirement(bench: Bench, found: Judged, name: str) -> dict:
    chosen = [i for i, one in enumerate(found.asked) if one.requirement == name]
    met = _met(bench, found, chosen)
    alone = [met if len(chosen) == 1 else _met(bench, found, [i]) for i in chosen]
    limits = [_limit(bench, found, i) | own for i, own in zip(chosen, alone, strict=True)]
    return {"name": name, **met, "limits": limits}


def _limit(bench: Bench, found: Judged, i: int) -> dict:
    """The limit with its worst place: that of the surrogate, or a run that is worse."""
    (slack, at), runs, asked = found.worst[i], found.slack[i], found.asked[i]
    if runs.min() < slack:
        slack, at = float(runs.min()), bench.unit[runs.argmin()]
    error = number(found.limits[i].error)
    margin = {"margin": number(slack), "error": error, "kept": bool(slack >= 0)}
    return {**told(bench, asked), **margin, **bench.place(at, asked.quantity)}


def _together(bench: Bench, found: Judged) -> dict:
    largest, which, _ = found.largest
    all_ = {**_met(bench, found, list(range(len(found.asked)))), "largest_share": largest}
    all_["halved"] = _halved(bench, found)
    if which is None:
        return {**all_, "fails": None}
    asked = found.asked[which]
    fails = {"requirement": asked.requirement, **told(bench, asked)}
    fails |= bench.place(found.fails, asked.quantity)
    simulated = np.nan if fails["simulated"] is None else fails["simulated"]
    fails["kept"] = bool(fails["ran"] and found.limits[which].slack_of(simulated) >= 0)
    return {**all_, "fails": fails}


def _halved(bench: Bench, found: Judged) -> dict[str, dict[str, float]]:
    """The share that meets all if one interval were half as wide, by the parameter's name."""
    from deployable.intervals.scalars import share_of_box

    box, rows = bench.experiment.box, {}
    for j in np.flatnonzero(box.free):
        lower, upper = -np.ones(box.dimension), np.ones(box.dimension)
        lower[j], upper[j] = (0.5 * (bench.nominal[j] + end) for end in (-1.0, 1.0))
        share, open_ = share_of_box(found.limits, box.free, lower, upper)
        rows[box.names[j]] = {"share": share, "share_uncertainty": open_}
    return rows
