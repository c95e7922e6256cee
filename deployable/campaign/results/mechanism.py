"""Facts of a mechanism for its review sheet: travels, torque margins, latches, stops, energies."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from deployable.campaign.config.sections import corners
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from fpm.elements import Latch, Motor, Stop
from fpm.files.outcome import BALANCE
from fpm.files.seals import read_seal
from fpm.files.trajectory import read_curves
from fpm.reading import margins
from fpm.reading.responses import parse
from fpm.reading.standards import STANDARDS
from fpm.travel.components import classes_of_kinds, component_classes, springs_of
from fpm.travel.path import Path

OPENING_TOLERANCE = 1e-6  # difference of openings (share of the travel) that is none


def mechanism_of(folder: Folder, quantities: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Collect what a review sheet needs beside the facts: `margins`, torque margins by quantity
    (dicts of `margin_of`); `latches`, their names; and `motion`, the energies of `motion_of`."""
    plan = read_plan(folder.plan)
    experiment, scene = plan.experiment, plan.experiment.nominal_scene
    rows = {row["name"]: row for row in quantities}
    least = [
        number for number in experiment.quantity_list
        if number.kind == "smallest" and number.response.kind == "margin"
    ]  # fmt: skip
    scenes = [experiment.build(corner) for corner in corners(experiment.intervals)] if least else []
    sweep = _travel_sweep(experiment)
    return {
        "margins": {
            q.name: margin_of(experiment, scenes, q.response, rows[q.name], sweep) for q in least
        },
        "latches": Latch.names(scene),
        "motion": motion_of(folder, plan),
    }


def motion_of(folder: Folder, plan: Any) -> dict[str, float] | None:
    """Energies (J) of the nominal run: largest `change` of any one kind over the run, `largest`
    size of one, `imbalance`; None where its trajectory was not stored."""
    run, paths = plan.runs[0].id, sorted(folder.runs("trajectories").glob("*.nc"))
    path = next((path for path in paths if run in read_seal(path)[0].get("runs", "")), None)
    if path is None:
        return None
    energies = dict(read_curves(path, runs=[run])[run].energies)
    balance = energies.pop(BALANCE.name)
    return {
        "exchanged": float(max((np.ptp(x) for x in energies.values()), default=0.0)),
        "largest": float(max((np.abs(x).max() for x in energies.values()), default=0.0)),
        "imbalance": float(np.abs(balance).max()),
    }


def margin_of(
    experiment: Any, scenes: Sequence[Any], response: Any, row: Mapping[str, Any], sweep: Callable
) -> dict[str, Any]:
    """Facts of a torque margin (a `Response`) for its review sheet. scenes: the nominal structure,
    then corners of the box; row: its least value in the facts; sweep: function of parameter values
    and the margin that returns curves of the work of all components."""
    definition, standard = experiment.responses[response.name], standard_of(response)
    nominal, positions = scenes[0], response.along
    openings = response.subjects[: response.subjects.index(standard)]
    worst = tuple(row["argmin"].values())
    worst = tuple(experiment.nominal) if None in worst else worst
    curves, label = sweep(worst, response), response.columns[0][1]
    budget = margins.make_torque_budget(response, curves)
    drives = set()
    for sweep_curves in (curves, sweep(tuple(experiment.nominal), response)):
        drives |= set(margins.find_drives({
            margins.read_label(column)[1]: work
            for (name, column), work in sweep_curves.columns.items() if name == margins.WORK
        }))  # fmt: skip
    is_stowed = margins.read_label(label)[0].first is None
    path = Path(nominal, openings[:1], definition.get("locked", ()))
    starts = [hinge.opening for s in scenes for hinge in s.hinges if hinge.name == openings[0]]
    indices = {i for i, hinge in enumerate(nominal.hinges) if hinge.name in openings}
    low, high = sorted((positions.first, positions.last))
    room = OPENING_TOLERANCE * (high - low)
    return {
        "name": response.name,
        "standard": standard,
        "evidence": evidence_of(response),
        "openings": list(openings),
        "apart": path.find_apart(openings[1:]),
        "without": list(response.subjects[response.subjects.index(standard) + 2 :]),
        "locked": list(definition.get("locked", ())),
        "starts_vary": bool(is_stowed and np.ptp(starts) > OPENING_TOLERANCE),
        "first": positions.first,
        "last": positions.last,
        "unit": positions.unit,
        "travel": travel_of(scenes, openings, positions, is_stowed),
        "latches": [
            latch.label(nominal) for latch in Latch.find(nominal)
            if latch.hinge in indices and low + room < latch.angle < high - room
        ],
        "motors": [
            nominal.hinges[m.hinge].name for m in Motor.find(nominal) if not m.is_exact
        ],
        "own": list_deviations(nominal, definition, response),
        "weaker": weaker_classes(nominal, response),
        "added": [f"{key} {definition[key]:g}"
                  for key in ("specified_acceleration", "output_torque") if definition.get(key)],
        "springs": [name for name in springs_of(nominal) if name in drives],
        "drives": sorted(drives),
        "at": dict(zip(experiment.intervals, worst, strict=True)),
        "budget": {**budget._asdict(), "rows": [share._asdict() for share in budget.rows]},
    }  # fmt: skip


def _travel_sweep(experiment: Any) -> Callable:
    """Function of values (k) of interval parameters: work of all parts along a margin's travel."""

    @cache
    def scene(values: tuple[float, ...]) -> Any:
        return experiment.build(dict(zip(experiment.intervals, values, strict=True)))

    @cache
    def curves(values: tuple[float, ...], columns: tuple) -> Any:
        response = replace(experiment.response_list[0], columns=columns)
        return margins.sweep_travel(scene(values), [response])

    def sweep(values: tuple[float, ...], response: Any) -> Any:
        definition = {
            key: value for key, value in experiment.responses[response.name].items()
            if key not in ("without", "evidence")
        }  # fmt: skip
        intact = parse(response.name, definition, experiment.nominal_scene)
        return curves(values, tuple(dict.fromkeys([*intact.columns, *response.columns])))

    return sweep


def standard_of(margin: Any) -> str:
    """Key in `STANDARDS` of a torque margin's standard: `aiaa-s-114`, say; margin: `Response`."""
    return next(word for word in margin.subjects if word in STANDARDS)


def evidence_of(margin: Any) -> str:
    """Return the evidence behind the uncertainty factors of a torque margin (its `Response`), such
    as `theory` or `measurement`: a key of `resists` in its standard."""
    return margin.subjects[margin.subjects.index(standard_of(margin)) + 1]


def travel_of(
    scenes: Iterable[Any], openings: Sequence[str], positions: Any, is_stowed: bool
) -> list[float] | None:
    """First and last opening (rad, m) of the travel of the joint that a margin follows, from the
    start (is_stowed: `first`) to the farthest latch, else the nearest stop, of all scenes; None
    without either. openings: joints that move together, first the one followed."""
    sign = 1.0 if positions.last > positions.first else -1.0
    side = "above" if sign > 0 else "below"
    starts, ends = [], []
    for scene in scenes:
        hinges = {hinge.name: (i, hinge.opening) for i, hinge in enumerate(scene.hinges)}
        joints, zero = dict(hinges[name] for name in openings), hinges[openings[0]][1]
        starts.append(sign * zero)
        stops = [stop for stop in Stop.find(scene) if stop.side == side]
        for parts, choose in ((Latch.find(scene), max), (stops, min)):
            angles = (zero + x.angle - joints[x.hinge] for x in parts if x.hinge in joints)
            if distances := [sign * angle for angle in angles if sign * (angle - zero) > 0]:
                ends.append(choose(distances))
                break
    first = positions.first if is_stowed else sign * min(starts)
    return [first, sign * max(ends)] if ends else None


def list_deviations(scene: Any, definition: Mapping[str, Any], response: Any) -> list[str]:
    """List the factors and classes of a margin that differ from those of the standard or the
    structure, a text each, own before other: `HM 2 for 3` (class of motors)."""
    standard = STANDARDS[standard_of(response)]
    resists, parts = standard.resists[evidence_of(response)], component_classes(scene)
    return [
        *(f"{name} {x:g} for {resists[name]:g}"
          for name, x in definition.get("uncertainty_factors", {}).items()),
        *(f"driving {name} {x:g} for {standard.drives[name]:g}"
          for name, x in definition.get("actuation_factors", {}).items()),
        *(f"{part} as {name} for {parts[part]}"
          for part, name in definition.get("classes", {}).items()),
    ]  # fmt: skip


def weaker_classes(scene: Any, response: Any) -> list[str]:
    """List the components that the structure's file puts into a class with weaker factors than
    their kind has in the standard of a margin, a text each."""
    standard, parts = STANDARDS[standard_of(response)], component_classes(scene)
    drives, resists = standard.drives, standard.resists[evidence_of(response)]
    return [
        f"{part} as {parts[part]} for {label}" for part, label in classes_of_kinds(scene).items()
        if resists[parts[part]] < resists[label] or drives[parts[part]] > drives[label]
    ]  # fmt: skip
