"""From the runs of a campaign to what of the box meets its requirements, `requirements.json`.

    requirements   [{name, met, share, limits}], met is all, some or none of the box
    limits         [{quantity, units, kind, level, margin, error, at, simulated}]: margin at the
                   worst place, and the estimated error of the surrogate
    together       {met, share, largest_share, fails}: of all; `fails` is the nearest place at which
                   one fails: {requirement, quantity, kind, level, units, at, simulated}
    runs, further_runs

Margins are below 0 where a limit is broken, null where something does not happen. A place is
parameter values by name; `simulated` is the quantity of the run there.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from campaign.answers.bench import SAME, Bench, number
from campaign.config.answers import LIMITS
from campaign.config.sections import Jobs, Verify
from campaign.files import write_result
from campaign.folder import Folder
from campaign.runs.progress import Tell

_BEYOND = 1e-3  # by how much farther from the nominal values than the border a run is made


@dataclass(frozen=True)
class Asked:
    """One limit: of which requirement, and of which quantity, by its number."""

    requirement: str
    quantity: int
    kind: str
    level: float


def answer(
    folder: Folder,
    requirements: Mapping[str, Mapping],
    verify: Verify,
    jobs: Jobs,
    tell: Tell,
    threads: int,
) -> None:
    """Write requirements.json of a campaign whose quantities have their intervals."""
    bench = Bench.of(folder, jobs, tell, threads, further=True)
    before = len(bench.further)
    asked = limits_of(requirements, list(bench.experiment.quantities))
    for turn in range(verify.rounds + 1):
        found = _judged(bench, asked)
        points = [at for at in found.places if bench.nearest(at)[1] > SAME]
        if turn == verify.rounds or not points:
            break
        bench.add(points)
    further = len(bench.further) - before
    if further:
        tell(f"{bench.experiment.name}: further runs for requirements: {further}")
    told = {
        "requirements": [_requirement(bench, found, name) for name in requirements],
        "together": _together(bench, found),
        "runs": len(bench.unit) + bench.left_out,
        "further_runs": len(bench.further),
    }
    write_result(folder.requirements, json.dumps(told, indent=1, allow_nan=False) + "\n")


def limits_of(requirements: Mapping[str, Mapping], quantities: list[str]) -> list[Asked]:
    """All limits that requirements set, in their order."""
    return [
        Asked(name, quantities.index(quantity), kind, float(kept[kind]))
        for name, limits in requirements.items()
        for quantity, kept in limits.items()
        for kind in LIMITS
        if kind in kept
    ]


@dataclass(frozen=True)
class Judged:
    """Limits (`intervals.scalars.Limit`) as asked for, the worst (slack, place) of each over the
    box, and (share, index, place) of the largest box that keeps all of them."""

    asked: list[Asked]
    limits: list[Any]
    worst: list[tuple[float, np.ndarray]]
    largest: tuple[float, int | None, np.ndarray | None]
    fails: np.ndarray | None

    @property
    def places(self) -> list[np.ndarray]:
        """Unit points (k) that decide."""
        return [at for _, at in self.worst] + ([] if self.fails is None else [self.fails])


def _judged(bench: Bench, asked: list[Asked]) -> Judged:
    from intervals.scalars import Limit, largest_share, share_reaching

    surrogates = bench.surrogates()
    limits = [Limit(surrogates[one.quantity], one.kind, one.level) for one in asked]
    upper = bench.experiment.box.free.astype(float)
    worst = [limit.worst(-upper, upper) for limit in limits]
    largest = largest_share(limits, bench.nominal)
    slack = np.array([
        limit.slack_of(bench.numbers[:, one.quantity])
        for one, limit in zip(asked, limits, strict=True)
    ])  # fmt: skip
    broken = np.flatnonzero(slack.min(axis=0) < 0)
    reached = share_reaching(bench.nominal, bench.unit[broken])
    fails = None
    if len(broken) and reached.min() < largest[0]:  # a run fails where the surrogates do not
        run = broken[reached.argmin()]
        fails = bench.unit[run]
        largest = float(reached.min()), int(slack[:, run].argmin()), fails
    elif largest[2] is not None:
        # A little beyond the border, so that the run there fails and does not only touch it.
        outward = np.clip((1 + _BEYOND) * (largest[2] - bench.nominal), -2, 2)
        fails = np.clip(bench.nominal + outward, -upper, upper)
    return Judged(asked, limits, worst, largest, fails)


def _met(bench: Bench, judged: Judged, chosen: list[int]) -> tuple[str, float]:
    """Whether all, some or none of the box keeps chosen limits, and which share.

    Runs decide where they differ from the surrogates: one that fails, or keeps them, is enough.
    """
    from intervals.scalars import share_of_box

    share = share_of_box([judged.limits[i] for i in chosen], bench.experiment.box.free)
    kept = np.min([_slack(bench, judged, i) for i in chosen], axis=0) >= 0
    worst = min(judged.worst[i][0] for i in chosen)
    if worst >= 0 and kept.all():
        return "all", 1.0
    return ("none" if share == 0 and not kept.any() else "some"), share


def _slack(bench: Bench, judged: Judged, i: int) -> np.ndarray:
    """Slack (R) of a limit in all runs."""
    return judged.limits[i].slack_of(bench.numbers[:, judged.asked[i].quantity])


def _requirement(bench: Bench, judged: Judged, name: str) -> dict:
    chosen = [i for i, one in enumerate(judged.asked) if one.requirement == name]
    met, share = _met(bench, judged, chosen)
    limits = [_limit(bench, judged, i) for i in chosen]
    return {"name": name, "met": met, "share": share, "limits": limits}


def _limit(bench: Bench, judged: Judged, i: int) -> dict:
    """The limit with its worst place: that of the surrogate, or a run that is worse."""
    slack, at = judged.worst[i]
    runs = _slack(bench, judged, i)
    if runs.min() < slack:
        slack, at = float(runs.min()), bench.unit[runs.argmin()]
    numbers = {"margin": slack, "error": judged.limits[i].surrogate.error}
    told = {name: number(value) for name, value in numbers.items()} | {"kept": bool(slack >= 0)}
    return {**_told(bench, judged.asked[i]), **told, **bench.place(at, judged.asked[i].quantity)}


def _told(bench: Bench, asked: Asked) -> dict:
    quantity = bench.experiment.numbers[asked.quantity]
    level = bool(asked.level) if asked.kind == "happens" else asked.level
    named = {"quantity": quantity.name, "units": quantity.unit}
    return {**named, "kind": asked.kind, "level": level}


def _together(bench: Bench, judged: Judged) -> dict:
    met, share = _met(bench, judged, list(range(len(judged.asked))))
    largest, which, _ = judged.largest
    if which is None:
        return {"met": met, "share": share, "largest_share": largest, "fails": None}
    asked = judged.asked[which]
    fails = {"requirement": asked.requirement, **_told(bench, asked)}
    fails |= bench.place(judged.fails, asked.quantity)
    simulated = np.nan if fails["simulated"] is None else fails["simulated"]
    fails["kept"] = bool(fails["ran"] and judged.limits[which].slack_of(simulated) >= 0)
    return {"met": met, "share": share, "largest_share": largest, "fails": fails}
