"""What the runs of the design tell of a campaign's quantities: by how much an event is missed, and
which peaks follow the first contact."""

from typing import Any

import numpy as np

from deployable.campaign.folder import Folder
from deployable.campaign.results.quantity_results import QuantityResults
from deployable.campaign.results.response_bounds import CampaignBounds
from deployable.campaign.results.run_samples import RunSamples
from deployable.campaign.text import words_of
from fpm.elements import Latch


def quantity_facts(folder: Folder, samples: RunSamples, bounds: CampaignBounds) -> list[dict]:
    """Return the rows of all quantities (`QuantityResults`) with their words, what the design's
    runs without an event do at their end (`unfinished`, or `reached` where none has it), and the
    times in an expression that may have no upper end (`late_parts`)."""
    experiment = samples.experiment
    rows = QuantityResults.read(folder).rows if experiment.quantities else []
    endless_times = {row["name"] for row in rows if row["censored_at"] or row["may_be_endless"]}
    for i, (row, quantity) in enumerate(zip(rows, experiment.quantity_list, strict=True)):
        row |= words_of(quantity)
        parts = getattr(quantity, "parts", ())
        row["late_parts"] = [part.name for part in parts if part.name in endless_times]
        if counts := _late_runs(i, quantity, samples, bounds.time):
            row["unfinished"] = counts
        if not row["runs_with"] and (approach := _approach(quantity, experiment, bounds)):
            row["reached"] = approach
    return rows


def late_peaks(samples: RunSamples, closures: list[dict], time: np.ndarray) -> list[str]:
    """Return the quantities that are peaks after the first contact, in the nominal run."""
    responses, names = samples.experiment.response_list, []
    for quantity in samples.experiment.quantity_list if closures else ():
        choose = {"largest": np.argmax, "smallest": np.argmin}.get(quantity.kind)
        if choose and quantity.response in responses:
            nominal: Any = samples.nominal
            (curve,) = samples.curves(nominal, [responses.index(quantity.response)])
            names += [quantity.name] * bool(time[choose(curve)] > closures[0]["time"])
    return names


def _approach(quantity: Any, experiment: Any, bounds: CampaignBounds) -> dict[str, Any]:
    """Return how close the response of an event comes to its level over the box, when (s), and
    whether it still `moves` then, at the end of the run. Empty if there is no such response."""
    response, level = _find_level(quantity, experiment)
    if response is None:
        return {}
    row = next(row for row in bounds.responses if row.name == response.name)
    curves, time = np.array([row.lower, row.upper]), row.time
    side, instant = np.unravel_index(np.argmin(np.abs(curves - level)), curves.shape)
    value = float(curves[side, instant]) + 0.0  # no -0
    return {"name": response.name, "units": response.unit, "value": value, "level": level,
            "time": float(time[instant]), "moves": bool(instant >= 0.98 * len(time))}  # fmt: skip


def _find_level(quantity: Any, experiment: Any) -> tuple[Any, float | None]:
    """Return the response of a crossing, or of a latch's joint, and the level that it has to reach;
    None for both if there is no such response."""
    if quantity.event == "latches":
        scene = experiment.nominal_scene
        latch = Latch.find(scene)[Latch.names(scene).index(quantity.places[0])]
        opening = "opening", (scene.hinges[latch.hinge].name,)
        matches = (c for c in experiment.response_list if (c.kind, c.subjects) == opening)
        return next(matches, None), latch.angle
    return (quantity.response, quantity.level) if quantity.kind == "crossing" else (None, None)


def _late_runs(index: int, quantity: Any, samples: RunSamples, time: np.ndarray) -> dict[str, Any]:
    """Count the design's runs without an event, whose quantity has this index, by what they do at
    their end: those that are `late` would reach the level within another duration at their last
    rate; those that are `stuck` would not, one of them `at` a place. Empty where nothing tells."""
    response, level = _find_level(quantity, samples.experiment)
    rows = np.flatnonzero(np.isnan(samples.table.numbers[:, index]))
    if response is None or not len(rows):
        return {}
    number = samples.experiment.response_list.index(response)
    last = np.searchsorted(time[:-1], time[0] + 0.98 * (time[-1] - time[0]), "right") - 1
    gaps = np.array([abs(samples.curves(int(r), [number])[0, [last, -1]] - level) for r in rows])
    rates = (gaps[:, 0] - gaps[:, 1]) / (time[-1] - time[last])
    stuck = rows[rates * (time[-1] - time[0]) < gaps[:, 1]]
    names = samples.experiment.intervals
    place = (
        dict(zip(names, samples.table.values[stuck[0]].tolist(), strict=True)) if len(stuck) else {}
    )
    return {"name": response.name, "late": len(rows) - len(stuck), "stuck": len(stuck), "at": place,
            "duration": float(time[-1] - time[0])}  # fmt: skip
