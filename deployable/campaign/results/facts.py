"""Facts of a campaign, its results as plain numbers and texts: the content of `summary.json`, from
which the templates in this folder make the summary and the page."""

import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict
from functools import partial
from typing import Any

import numpy as np

from deployable.campaign.files import open_netcdf, read_json
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import ROUNDING, Plan, read_plan
from deployable.campaign.results.run_roles import count_roles, nominal_row
from deployable.campaign.text.numbers import percent
from deployable.campaign.text.words import words_of
from deployable.intervals.estimates import MAX_TAIL_RATIO
from fpm.elements import Contact, Latch, RigidLatch
from fpm.errors import SceneError

PARTS = ("surrogate", "step", "mesh")
"""Parts of an error."""

SMALL, LARGE = 0.05, 0.25
"""Shares of the largest difference: below the first an error is small, from the second large."""

SOFT = 0.05
"""Overlap (rad) from which faces that touch are said to pass through each other."""

_SIZES = {"rad": 1.0, "m": 1e-3}
"""Least sizes by unit, beside which a width is rounding: of directions 1, of structures 1 mm."""

_SCAN = ("drawn_runs", "share_outside", "share_outside_95")
_ERRORS = ("error_step", "error_mesh", "error_whole")
_INFLUENCE = ("share", "alone", "fixed", "halved")
_NUMBERS = ("lower", "upper", "simulated_lower", "simulated_upper", "surrogate_lower",
            "surrogate_upper", "nominal", "error", "happens",
            "happens_uncertainty")  # fmt: skip


def facts_of(
    folder: Folder,
    published: Mapping[str, float],
    requirements: bool = False,
    choice: bool = False,
    measured: bool = False,
) -> dict[str, Any]:
    """Collect a campaign's results as plain data for JSON: the content of `summary.json`, whose
    keys `summary.schema.json` describes. Other functions call it the facts. folder: the campaign's
    files, which are read; published: largest width (upper less lower bound) that somebody has
    published, by name of response, in its unit; requirements, choice, measured: whether the
    campaign has requirements, a choice of parameters or measured curves, to read
    `requirements.json`, `choice.json` or `measured.json`."""
    plan = read_plan(folder.plan)
    experiment = plan.experiment
    with open_netcdf(folder.bounds) as bounds, open_netcdf(folder.samples) as samples:
        facts = bounds_facts(bounds, samples, published)
        facts["check_runs"] = bounds_checks = int(getattr(bounds, "check_runs", 0))
        has_quantities = "quantities" in samples.variables
    if folder.sensitivities.exists():
        with open_netcdf(folder.sensitivities) as data:
            shares = data["width_overall"][:] if "width_overall" in data.variables else []
            for row, values in zip(facts["responses"], shares, strict=False):
                row["shares"] = dict(
                    zip(data["parameter"][:].tolist(), map(_number, values), strict=True)
                )
    facts |= _structure(experiment, facts["parameters"])
    facts["quantities"], refinements = [], 0
    if has_quantities:
        with open_netcdf(folder.quantities) as data:
            facts["quantities"] = quantity_rows(data, experiment.solver.duration)
            refinements = int(data.further_runs)
            facts["check_runs"] += int(data.check_runs)
        for row, quantity in zip(facts["quantities"], experiment.quantity_list, strict=True):
            row |= words_of(quantity)
            if not row["runs_with"] and (approach := _approach(quantity, experiment, folder)):
                row["reached"] = approach
        if requirements:
            assessment = read_json(folder.requirements)
            facts |= {name: assessment[name] for name in ("requirements", "together")}
            refinements = assessment["further_runs"]
        if choice:
            facts["choice"] = read_json(folder.choice)
            del facts["choice"]["fitted"]
    if measured:
        facts["measured"] = read_json(folder.measured)
    facts["further_runs"] = refinements
    rows = [*facts["responses"], *facts["quantities"]]
    if (rounds := plan.adaptive) is not None:
        facts["adaptive"] = {"rounds": [asdict(r) for r in rounds.rounds]}
    if experiment.is_adaptive:
        for row in rows:
            row["errors"]["target"] = experiment.accuracy.tolerances[row["name"]]
        mark_constant(facts)
        facts["accuracy"] = _accuracy(plan, rows)
        in_rounds = facts["accuracy"]["runs"] - facts["design"]["runs"]
        facts["check_runs"] += in_rounds - bounds_checks
    for row in rows:
        if row["name"] in experiment.doubts:
            row["doubt"] = experiment.doubts[row["name"]]
    mark_constant(facts)
    if facts["overlap"] > SOFT:
        facts["contacts"] = _contact_names(experiment, facts["fixed"])
    runs = {"design": facts["design"]["runs"], "further": facts.pop("further_runs", 0)}
    runs["choice"] = facts.get("choice", {}).get("runs", 0)
    runs["checks"] = facts.pop("check_runs", 0)
    facts["runs"] = {**runs, "all": sum(runs.values())}
    return facts


def mark_constant(facts: dict) -> None:
    """Mark the responses and quantities that do not vary over the box of parameters. In their dicts
    `constant` becomes True, `shares` is removed, `grade` "none", the `share` of each influence 0,
    that of the errors None; facts: the campaign's results as plain data (`facts_of`), changed in
    place. They are those whose upper and lower bound differ by rounding alone: by at most
    `ROUNDING` (1e-12) times the largest value that any of them with that unit has, at least 1 rad,
    1 mm, the duration (s), or 1 rad or 1 mm per duration (of rates); other units have no least."""
    rows, duration = [*facts["responses"], *facts["quantities"]], facts["duration"]
    sizes = {"s": duration} | _SIZES
    sizes |= {f"{unit} s-1": size / duration for unit, size in _SIZES.items()}
    for row in rows:
        ends = [row.get("size"), row["lower"], row["upper"]]
        largest = max(abs(end or 0.0) for end in ends)
        sizes[row["units"]] = max(sizes.get(row["units"], 0.0), largest)
    for row in rows:
        width = row.get("largest_difference")
        if width is None and row["lower"] is not None and not row.get("censored_at"):
            width = row["upper"] - row["lower"]
        if width is None or width > ROUNDING * sizes[row["units"]]:
            continue
        row["constant"] = True
        row.pop("shares", None)
        if "grade" in row:
            row["grade"] = "none"
        for influence in row.get("influence", {}).values():
            influence["share"] = 0.0
        if "errors" in row:
            row["errors"]["share"] = None


def varies(row: Mapping) -> bool:
    """Whether a response or quantity depends on the parameters: its value does, or a quantity
    occurs in some runs only. row: its dict in the results (`facts_of`)."""
    if "constant" in row:
        return bool(row.get("runs_with") and row.get("runs_without"))
    return row.get("lower") is not None


def bounds_facts(bounds: Any, samples: Any, published: Mapping[str, float]) -> dict[str, Any]:
    """Collect what `bounds.nc` and `samples.nc` tell as plain data, a part of `summary.json`:
    parameters, design, contacts that close in the nominal run, and bounds by response. bounds,
    samples: those files, open; published: largest difference in the literature by response."""
    count, time = count_roles(samples), bounds["time"][:]
    keys = ("parameter", "box_units", "box_lower", "box_nominal", "box_upper")
    names = ("name", "units", "lower", "nominal", "upper")
    facts = {
        "campaign": bounds.campaign,
        "scene": bounds.scene,
        "config_hash": bounds.config_hash,
        "duration": float(time[-1] - time[0]),
        "parameters": [
            dict(zip(names, row, strict=True))
            for row in zip(*(bounds[key][:].tolist() for key in keys), strict=True)
        ],
        "design": {
            "method": bounds.design_method,
            "order": np.atleast_1d(bounds.design_order).tolist(),
            "nodes": count.nodes,
            "held_out": count.held_out,
            "runs": count.runs,
            "nominal_among_them": count.has_nominal,
        },
        "bounds": bounds.bounds_kind,
        "time_step": float(bounds.time_step),
        "overlap": float(samples["overlap"][:].max()),
        "assembly_energy": float(getattr(samples, "assembly_energy", 0.0)),
        "closures": closures(samples, nominal_row(samples)),
        "responses": [
            _response(bounds, i, name, published.get(name))
            for i, name in enumerate(bounds["response"][:])
        ],
    }
    if "growth_quarter" in bounds.variables:
        facts["scan"] = {key: bounds.getncattr(key).item() for key in _SCAN}
    return facts


def _structure(experiment: Any, parameters: list[dict]) -> dict[str, Any]:
    """What the structure is, its parameters that are no intervals, and what the others mean."""
    definitions = experiment.scene_type.parameters
    for parameter in parameters:
        parameter["description"] = definitions[parameter["name"]].description
    settings = experiment.scene.parameters
    values = {name: settings.get(name, x.default) for name, x in definitions.items()}
    fixed = [
        {"name": name, "value": value, "units": definitions[name].unit or "1",
         "description": definitions[name].description}
        for name, value in values.items()
        if name not in experiment.intervals and value is not None
    ]  # fmt: skip
    description = experiment.scene_type.description.strip().rstrip(".")
    return {"about": description, "fixed": fixed}


def _contact_names(experiment: Any, fixed: Iterable[Mapping]) -> list[str]:
    """Which parameters the stiffness of contacts is proportional to."""

    def stiffness(**values: float) -> np.ndarray:
        return np.array([contact.stiffness for contact in Contact.find(experiment.build(values))])

    nominal, variations = dict(zip(experiment.intervals, experiment.nominal, strict=True)), {}
    in_proportion = 1.01 * stiffness(**nominal)
    for parameter in fixed:
        if type(parameter["value"]) is float and parameter["value"] > 0:
            with suppress(SceneError):  # a value that it may not have
                change = {parameter["name"]: 1.01 * parameter["value"]}
                variations[parameter["name"]] = stiffness(**nominal, **change)
    return [name for name, variation in variations.items() if np.allclose(variation, in_proportion)]


def drop_unknown_error(kind: str, error: float) -> float | None:
    """Return the estimated error of bounds, or None (unknown) where it is 0 only because the bounds
    are those of a scan (least and largest sample), which the second half of its runs did not
    change. kind: attribute `bounds_kind` of `bounds.nc`; error: in the response's unit."""
    return None if kind.startswith("least") and not error else error


def _response(bounds: Any, i: int, name: str, published: float | None) -> dict[str, Any]:
    time, lower, upper = bounds["time"][:], bounds["lower"][i], bounds["upper"][i]
    width = upper - lower
    instant = int(width.argmax())
    row = {
        "name": name,
        "long_name": bounds["response_long_name"][i],
        "units": bounds["response_units"][i],
        "largest_difference": float(width[instant]),
        "time_of_largest_difference": float(time[instant]),
        "lower": float(lower[instant]),
        "upper": float(upper[instant]),
        "size": float(max(np.abs(lower).max(), np.abs(upper).max())),
        "published": published,
        "ratio_to_published": None if not published else float(width[instant] / published),
        "mean_difference": float(np.trapezoid(width, time) / (time[-1] - time[0])),
        "error_at_largest_difference": None,
    }
    if abscissa := along_of(bounds, i):
        row["along"] = abscissa
    if "error" in bounds.variables:
        error = bounds["error"][i]
        worst = int(error.argmax())
        row["largest_error"] = drop_unknown_error(bounds.bounds_kind, float(error[worst]))
        row["time_of_largest_error"] = float(time[worst])
        row["error_at_largest_difference"] = drop_unknown_error(
            bounds.bounds_kind, float(error[instant])
        )
        if extrapolation := _extrapolated_error(bounds, i, instant):
            row["extrapolated_error"] = extrapolation
    row["grade"] = grade(row["error_at_largest_difference"], row["largest_difference"])
    row["trusted"] = _largest_trusted(bounds, i)
    if "growth_quarter" in bounds.variables:
        row["largest_growth_quarter"] = float(bounds["growth_quarter"][i].max())
    if "worst_violation" in bounds.variables:
        row["runs_outside_by"] = float(bounds["worst_violation"][i])
        coverage = bounds["coverage"][i] if "coverage" in bounds.variables else np.nan
        row["share_outside"] = float(1.0 - coverage) if np.isfinite(coverage) else None
    if errors := _response_errors(bounds, i):
        row["errors"] = errors
    row["impossible_by"] = float(bounds["largest_impossible"][i])
    row["time_of_impossible"] = float(bounds["largest_impossible_time"][i])
    return row


def _largest_trusted(bounds: Any, i: int) -> dict[str, float] | None:
    """The largest difference between the bounds of response `i` where these are drawn, with the
    error of either and the time; None where there are no errors, or none is small enough."""
    if "error" not in bounds.variables:
        return None
    width, error = bounds["upper"][i] - bounds["lower"][i], bounds["error"][i]
    is_sure = error < LARGE * width.max()
    if not is_sure.any():
        return None
    instant = int(np.where(is_sure, width, -np.inf).argmax())
    values = width[instant], error[instant], bounds["time"][instant]
    return dict(zip(("difference", "error", "time"), map(float, values), strict=True))


def along_of(data: Any, i: int) -> dict[str, Any] | None:
    """Describe the horizontal axis of response `i` (index) where it is not time, such as a hinge's
    opening angle; None where it is time. data: an open `bounds.nc` or `sensitivities.nc`. Keys:
    `words`, `unit`, `first` and `last` value, and `duration` (s), onto which they are mapped."""
    variable = data.variables.get("response_along")
    abscissa = json.loads(str(np.asarray(variable[i]))) if variable is not None else None
    return abscissa and abscissa | {"duration": float(data["time"][-1])}


def grade(error: float | None, width: float) -> str:
    """Return a word for an error relative to `width`, the difference of the bounds in its unit:
    `small` below 5 %, `large` from 25 %, `noticeable` between, `unknown` for None or width 0."""
    if error is None or not width > 0:
        return "unknown"
    relative = error / width
    return "small" if relative < SMALL else "large" if relative >= LARGE else "noticeable"


def _extrapolated_error(bounds: Any, i: int, instant: int) -> dict[str, float]:
    """By how much the fit of response `i` misses runs, and how many, if its error is far beyond."""
    if "polynomial" not in bounds.bounds_kind:
        return {}
    decay, residual = (float(bounds[f"error_{name}"][i][instant]) for name in ("decay", "held_out"))
    runs = int(bounds.held_out_runs)
    return {"missed": residual, "runs": runs} if decay > MAX_TAIL_RATIO * residual else {}


def _response_errors(bounds: Any, i: int) -> dict[str, float]:
    """Mean errors of response `i` by part and `share` of the mean width; empty if unchecked."""
    if f"error_{PARTS[0]}" not in bounds.variables:
        return {}
    time = bounds["time"][:]

    def mean(curve: np.ndarray) -> float:
        return float(np.trapezoid(curve, time) / (time[-1] - time[0]))

    names = [name for name in PARTS if f"error_{name}" in bounds.variables]
    errors = {name: mean(bounds[f"error_{name}"][i]) for name in names}
    return _add_total_error(errors, mean(bounds["upper"][i] - bounds["lower"][i]))


def quantity_errors(row: Mapping) -> dict[str, float | None]:
    """Collect the errors of a quantity's bounds by source (surrogate, step, mesh) in its unit,
    their sum `whole`, and `share`, the sum over the interval's width. row: the quantity's dict
    (`quantity_rows`). None stands for unknown; empty where time step and mesh were not refined."""
    if "error_whole" not in row:
        return {}
    keys = {"surrogate": "error", "step": "error_step", "mesh": "error_mesh"}
    errors = {name: row[key] for name, key in keys.items() if key in row}
    width = None if row["lower"] is None else row["upper"] - row["lower"]
    return _add_total_error(errors, width)


def _add_total_error(parts: Mapping[str, float | None], width: float | None) -> dict:
    values = list(parts.values())
    whole = None if None in values else sum(values)
    if not width:  # nothing varies, or there is no interval
        return {**parts, "whole": whole, "share": 0.0 if whole == 0 and width == 0 else None}
    return {**parts, "whole": whole, "share": None if whole is None else whole / width}


def _accuracy(plan: Plan, rows: Iterable[Mapping]) -> dict[str, Any]:
    """Whether an accuracy is `met`, by the last `errors` of responses and quantities (rows, with
    `name` and what is `asked`), which are `unmet`; why rounds and searches ended, as sentences;
    mesh, runs, core seconds."""
    last, experiment = plan.adaptive.rounds[-1], plan.experiment
    mesh = experiment.accuracy.mesh
    intervals = [
        row
        for row in rows
        if row.get("lower", 0.0) is not None
        and not ("constant" in row and row.get("runs_with", 2) > 1)
    ]
    unmet_rows = [row for row in intervals if not _is_met(row["errors"])]
    unmet = [row["name"] for row in unmet_rows]
    reasons = [] if plan.adaptive.met else [f"The rounds ended as {last.reason}"]
    reasons += [
        f"The search for the bounds of {row['name']} ended as {row['search_end']}"
        for row in unmet_rows
        if row.get("search_end")
    ]
    reason = (
        ". ".join(text.removesuffix(".") for text in reasons)
        or "Finer steps and meshes change bounds too much"
    )
    if not unmet and intervals:
        row = max(intervals, key=lambda row: row["errors"]["share"] / row["errors"]["target"])
        share, target = row["errors"]["share"], row["errors"]["target"]
        reason = f"nearest to its limit is {row['name']}, {percent(share)} for {percent(target)}"
    return {
        "met": not unmet,
        "unmet": unmet,
        "others": len(intervals) - len(unmet),
        "reason": reason,
        "rounds": len(plan.adaptive.rounds),
        "mesh": {mesh: experiment.scene.parameters[mesh]} if mesh else {},
        "runs": last.runs,
        "seconds": last.seconds,
    }


def _is_met(errors: Mapping[str, float | None]) -> bool:
    """As it is printed: with three digits."""
    return errors["share"] is not None and float(f"{errors['share']:.3g}") <= errors["target"]


def quantity_rows(data: Any, duration: float = np.inf) -> list[dict[str, Any]]:
    """Make one dict for each quantity, as in `summary.json`: its interval, errors, numbers of runs
    with and without it, parameter values at both bounds, and the influence of each parameter. data:
    the open `quantities.nc`, whose NaN become None; duration: of the runs (s), noted as
    `censored_at` of a time that some runs lack and whose upper bound reaches the end of the runs
    (else None)."""
    parameters = data["parameter"][:].tolist()
    rows = []
    for i, name in enumerate(data["quantity"][:]):
        row: dict[str, Any] = {
            "name": str(name),
            "long_name": str(data["quantity_long_name"][i]),
            "units": str(data["quantity_units"][i]),
            "fit": str(data["fit"][i]),
        }
        if "search_end" in data.variables and data["search_end"][i]:
            row["search_end"] = str(data["search_end"][i])
        for key in (*_NUMBERS, *(key for key in _ERRORS if key in data.variables)):
            row[key] = _number(data[key][i])
        if errors := quantity_errors(row):
            row["errors"] = errors
        row |= {key: int(data[key][i]) for key in ("runs_with", "runs_without")}
        row["predicted_ends"] = [
            side
            for side in ("lower", "upper")
            if data[f"unconverged_{side}"][i] and row[side] != row[f"simulated_{side}"]
        ]
        ends = data["is_time"][i] and row["runs_without"] and (row["upper"] or 0.0) >= duration
        row["censored_at"] = duration if ends else None
        for key in ("argmin", "argmax"):
            row[key] = dict(zip(parameters, map(_number, data[key][i]), strict=True))
        row["influence"] = {
            parameter: {key: _number(data[key][i, j]) for key in _INFLUENCE}
            for j, parameter in enumerate(parameters)
        }
        rows.append(row)
    return rows


def _approach(quantity: Any, experiment: Any, folder: Folder) -> dict[str, Any]:
    """How far the response of a crossing, or of a latch's joint, comes to its level over the box,
    when (s), and whether it `moves` then, at the end of the run; nothing where there is none."""
    response, level = quantity.response, quantity.level
    if quantity.event == "latches":
        scene = experiment.nominal_scene
        latches = {
            name: latch
            for kind in (Latch, RigidLatch)
            for name, latch in zip(kind.names(scene), kind.find(scene), strict=True)
        }
        latch = latches[quantity.places[0]]
        opening = "opening", (scene.hinges[latch.hinge].name,)
        matches = (c for c in experiment.response_list if (c.kind, c.subjects) == opening)
        response = next(matches, None)
        level = latch.angle
    elif quantity.kind != "crossing":
        response = None
    if response is None:
        return {}
    with open_netcdf(folder.bounds) as bounds:
        row = list(bounds["response"][:]).index(response.name)
        curves = np.array([bounds["lower"][row], bounds["upper"][row]])
        time = bounds["time"][:]
    side, instant = np.unravel_index(np.argmin(np.abs(curves - level)), curves.shape)
    value = float(curves[side, instant]) + 0.0  # no -0
    return {"name": response.name, "units": response.unit, "value": value, "level": level,
            "time": float(time[instant]), "moves": bool(instant >= 0.98 * len(time))}  # fmt: skip


def _number(value: Any) -> float | None:
    return float(value) if np.isfinite(value) else None


def decisive(row: Mapping) -> str | None:
    """Name the parameter that contributes most to the width of a quantity's interval; None if none
    does, or the campaign has one alone. row: the quantity's dict (`quantity_rows`)."""
    shares = {name: influence["share"] or 0.0 for name, influence in row["influence"].items()}
    most = max(shares, key=shares.__getitem__)
    return most if shares[most] > 0 and len(shares) > 1 else None


def has_effect(influence: Mapping, row: Mapping) -> bool:
    """Return whether a parameter changes the width of a quantity's interval by more than the error
    of its surrogate, alone or beside the others. influence: what is said of the parameter in `row`,
    the quantity's dict (`quantity_rows`)."""
    width = (row["surrogate_upper"] or 0.0) - (row["surrogate_lower"] or 0.0)
    is_constant = "constant" in row or influence["fixed"] is None
    effect = 0.0 if is_constant else width - influence["fixed"]
    return bool(influence["share"]) or effect > (row["error"] or 0.0)


def scarcest(limits: Iterable[Mapping]) -> Mapping | None:
    """Return the limit whose margin is the least for its error; None if none has both. limits: of
    the best choice, dicts with `margin` and `error` in the unit of their quantity."""
    rows = [limit for limit in limits if limit["margin"] is not None and limit.get("error")]
    return min(rows, key=lambda limit: limit["margin"] / limit["error"], default=None)


def happens_only(row: Mapping, quantities: Iterable[Mapping]) -> str | None:
    """Name the quantity of a requirement that fails in part of the box only because the quantity
    (an event's time, say) does not occur there: where it occurs, its bounds keep all limits by
    their error. None for any other requirement. row: the requirement's dict in the results as plain
    data (`facts_of`); quantities: dicts of all quantities there."""
    rows = {quantity["name"]: quantity for quantity in quantities}
    limits = [limit for limit in row["limits"] if limit["kind"] != "happens"]
    names = {limit["quantity"] for limit in limits}
    if row["met"] != "some" or not row["share"] < 1 or len(names) != 1:
        return None
    quantity = rows[names.pop()]
    is_kept = quantity["happens"] == row["share"] and all(map(partial(_keeps, quantity), limits))
    return quantity["name"] if is_kept else None


def _keeps(quantity: Mapping, limit: Mapping) -> bool:
    """Whether a quantity's bounds keep a limit by their error."""
    error = quantity.get("errors", {}).get("whole", quantity["error"])
    if quantity["lower"] is None or error is None:
        return False
    if limit["kind"] == "at_most":
        return quantity["censored_at"] is None and quantity["upper"] + error <= limit["level"]
    return quantity["lower"] - error >= limit["level"]


def closures(samples: Any, run: int) -> list[dict[str, Any]]:
    """List the contacts, stops and latches that close in one run, in order of time: dicts of `time`
    (s) and `contact` (name). samples: the open `samples.nc`; run: index of the run in it."""
    names = list(samples["contact"][:])
    keys = ("event_time", "event_closing", "event_contact")
    rows = zip(*(samples[key][run] for key in keys), strict=True)
    events = [
        {"time": float(time), "contact": names[int(contact)]}
        for time, closing, contact in rows
        if np.isfinite(time) and closing == 1
    ]
    return sorted(events, key=lambda row: row["time"])


def moments(rows: Iterable[Mapping]) -> dict[str, list[str]]:
    """Group closures of contacts by time, written as `0.3100 s`: lists of the contacts' names, each
    once. rows: dicts of time (s) and contact (`closures`)."""
    contacts: dict[str, list[str]] = {}
    for row in rows:
        names = contacts.setdefault(f"{row['time']:.4f} s", [])
        names += [row["contact"]] * (row["contact"] not in names)
    return contacts
