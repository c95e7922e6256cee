"""Facts of a mechanism for its review sheet: travels of openings, torque margins with their
budgets, latches and stops, and the energies that the motion exchanges."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from deployable.campaign.config.sections import corners
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from fpm.elements import Latch, Motor, RigidLatch, Stop
from fpm.files.outcome import BALANCE
from fpm.files.trajectory import read_curves
from fpm.reading import margins
from fpm.reading.responses import parse
from fpm.reading.standards import STANDARDS
from fpm.travel import classes_of_kinds, parts_of, springs_of

OPENING_TOLERANCE = 1e-6
"""Difference of openings (share of the travel) that is none."""


def mechanism_of(folder: Folder, quantities: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Margins by the names of their quantities, names of the latches, and `motion` (`motion_of`),
    as the review sheet needs them beside the facts.

    quantities: rows of the facts.
    """
    plan = read_plan(folder.plan)
    experiment, scene = plan.experiment, plan.experiment.nominal_scene
    rows = {row["name"]: row for row in quantities}
    least = [
        number for number in experiment.numbers
        if number.kind == "smallest" and number.response.kind == "margin"
    ]  # fmt: skip
    scenes = [experiment.build(corner) for corner in corners(experiment.intervals)] if least else []
    sweep = _travel_sweep(experiment)
    return {
        "margins": {
            q.name: margin_of(experiment, scenes, q.response, rows[q.name], sweep) for q in least
        },
        "latches": [name for kind in (Latch, RigidLatch) for name in kind.names(scene)],
        "motion": motion_of(folder, plan),
    }


def motion_of(folder: Folder, plan: Any) -> dict[str, float] | None:
    """Energies (J) of the nominal run of a plan: the largest change of one, `exchanged`, the
    `largest`, and the largest error of the energy balance, `off`; None where the trajectory was not
    stored."""
    path = folder.runs("trajectories") / f"{plan.runs[0].id}.nc"
    if not path.exists():
        return None
    energies = dict(read_curves(path).energies)
    balance = energies.pop(BALANCE.name)
    return {
        "exchanged": float(max((np.ptp(x) for x in energies.values()), default=0.0)),
        "largest": float(max((np.abs(x).max() for x in energies.values()), default=0.0)),
        "off": float(np.abs(balance).max()),
    }


def margin_of(
    experiment: Any, scenes: Sequence[Any], response: Any, row: Mapping[str, Any], sweep: Callable
) -> dict[str, Any]:
    """Facts of a torque margin: standard, factors, stretch of the travel, and the budget at its
    worst position.

    experiment: of the campaign; scenes: at the corners of the box; response: the margin's; row: its
    quantity's facts; sweep: function of parameter values (k,) and a response that returns curves of
    the work of all components along the travel.
    """
    definition, standard = experiment.responses[response.name], standard_of(response)
    nominal, positions = scenes[0], response.along
    openings = response.subjects[: response.subjects.index(standard)]
    worst = tuple(row["argmin"].values())
    worst = tuple(experiment.nominal) if None in worst else worst
    curves, label = sweep(worst, response), response.columns[0][1]
    budget = margins.torque_budget(response, curves)
    drives = set()
    for sweep_curves in (curves, sweep(tuple(experiment.nominal), response)):
        drives |= set(margins.driving({
            margins.read_label(column)[1]: work
            for (name, column), work in sweep_curves.columns.items() if name == margins.WORK
        }))  # fmt: skip
    stowed = margins.read_label(label)[0].first is None
    starts = [hinge.opening for s in scenes for hinge in s.hinges if hinge.name == openings[0]]
    indices = {i for i, hinge in enumerate(nominal.hinges) if hinge.name in openings}
    low, high = sorted((positions.first, positions.last))
    room = OPENING_TOLERANCE * (high - low)
    return {
        "name": response.name,
        "standard": standard,
        "evidence": evidence_of(response),
        "openings": list(openings),
        "without": left_out(response),
        "locked": list(definition.get("locked", ())),
        "starts_vary": bool(stowed and np.ptp(starts) > OPENING_TOLERANCE),
        "first": positions.first,
        "last": positions.last,
        "unit": positions.unit,
        "travel": travel_of(scenes, openings, positions, stowed),
        "latches": [
            latch.label(nominal) for kind in (Latch, RigidLatch) for latch in kind.of(nominal)
            if latch.hinge in indices and low + room < latch.angle < high - room
        ],
        "motors": [nominal.hinges[motor.hinge].name for motor in Motor.of(nominal)],
        "own": own_settings(nominal, definition, response),
        "weaker": weaker_classes(nominal, response),
        "added": [f"{key} {definition[key]:g}" for key in ("accelerate", "deliver")
                  if definition.get(key)],
        "springs": [name for name in springs_of(nominal) if name in drives],
        "drives": sorted(drives),
        "at": dict(zip(experiment.intervals, worst, strict=True)),
        "budget": {**budget._asdict(), "rows": [share._asdict() for share in budget.rows]},
    }  # fmt: skip


def _travel_sweep(experiment: Any) -> Callable:
    """A function that leads a margin's travel at values (k) of the interval parameters: curves of
    the work of all parts, those that are left out too; each travel once."""

    @cache
    def scene(values: tuple[float, ...]) -> Any:
        return experiment.build(dict(zip(experiment.intervals, values, strict=True)))

    @cache
    def curves(values: tuple[float, ...], columns: tuple) -> Any:
        return margins.led_curves(scene(values), [replace(experiment.curves[0], columns=columns)])

    def sweep(values: tuple[float, ...], response: Any) -> Any:
        definition = {
            key: value for key, value in experiment.responses[response.name].items()
            if key not in ("without", "evidence")
        }  # fmt: skip
        intact = parse(response.name, definition, experiment.nominal_scene)
        return curves(values, tuple(dict.fromkeys([*intact.columns, *response.columns])))

    return sweep


def standard_of(margin: Any) -> str:
    """Name of the standard of a margin, a response of `fpm.reading.margins`: a key of
    `STANDARDS`."""
    return next(word for word in margin.subjects if word in STANDARDS)


def evidence_of(margin: Any) -> str:
    """What the uncertainty factors of a margin rest on, such as theory or measurement."""
    return margin.subjects[margin.subjects.index(standard_of(margin)) + 1]


def left_out(margin: Any) -> list[str]:
    """Names of the components that a margin leaves out."""
    return list(margin.subjects[margin.subjects.index(standard_of(margin)) + 2 :])


def travel_of(
    scenes: Iterable[Any], openings: Sequence[str], positions: Any, stowed: bool
) -> list[float] | None:
    """First and last opening of the whole travel of a margin's coordinate, in rad or m; None where
    no latch and no stop ends it.

    It reaches from the start to the farthest latch, without one to the nearest stop, in any of the
    scenes. openings: names, the first that of the coordinate; positions: of the margin, with
    `first` and `last` opening; stowed: whether the travel begins at `first` instead of each scene's
    own start.
    """
    sign = 1.0 if positions.last > positions.first else -1.0
    starts, ends = [], []
    for scene in scenes:
        hinges = {hinge.name: (i, hinge.opening) for i, hinge in enumerate(scene.hinges)}
        zero = hinges[openings[0]][1]
        starts.append(zero)
        latches, stops = [], []
        for number, start in (hinges[name] for name in openings):
            side = "above" if sign > 0 else "below"
            own = [x for kind in (Latch, RigidLatch) for x in kind.of(scene) if x.hinge == number]
            latches += [zero + latch.angle - start for latch in own]
            own = [x for x in Stop.of(scene) if x.hinge == number and x.side == side]
            stops += [zero + stop.angle - start for stop in own]
        latches, stops = (
            [sign * end for end in candidates if sign * (end - zero) > 0]
            for candidates in (latches, stops)
        )
        ends += [max(latches)] if latches else [min(stops)] if stops else []
    starts = [positions.first] if stowed else starts
    return [sign * min(sign * start for start in starts), sign * max(ends)] if ends else None


def own_settings(scene: Any, definition: Mapping[str, Any], response: Any) -> list[str]:
    """Factors and classes of a margin that differ from those of the standard or the structure, in
    words. scene: `fpm.Scene`; definition: of the margin in the config; response: the margin, as
    parsed."""
    standard = STANDARDS[standard_of(response)]
    resists, parts = standard.resists[evidence_of(response)], parts_of(scene)
    return [
        *(f"{name} {x:g} for {resists[name]:g}"
          for name, x in definition.get("uncertainty_factors", {}).items()),
        *(f"driving {name} {x:g} for {standard.drives[name]:g}"
          for name, x in definition.get("actuation_factors", {}).items()),
        *(f"{part} as {name} for {parts[part]}"
          for part, name in definition.get("classes", {}).items()),
    ]  # fmt: skip


def weaker_classes(scene: Any, response: Any) -> list[str]:
    """Components that the structure's file assigns to a class with weaker factors than that of
    their type, in words. scene: `fpm.Scene`; response: a margin, whose standard has the factors."""
    standard, parts = STANDARDS[standard_of(response)], parts_of(scene)
    drives, resists = standard.drives, standard.resists[evidence_of(response)]
    return [
        f"{part} as {parts[part]} for {own}" for part, own in classes_of_kinds(scene).items()
        if resists[parts[part]] < resists[own] or drives[parts[part]] > drives[own]
    ]  # fmt: skip
