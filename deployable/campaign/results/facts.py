"""All that is said of a campaign, as plain numbers: what `summary.json` holds, and from which the
templates beside make the summary and the page."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict
from typing import Any

import numpy as np

from deployable.campaign.files import open_netcdf, read_json
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import Plan, read_plan
from deployable.campaign.results.which import counts, nominal_row
from deployable.campaign.text.numbers import percent
from deployable.campaign.text.words import words_of
from deployable.intervals.estimates import MAX_TAIL_RATIO
from fpm.elements import Contact, Latch, RigidLatch
from fpm.errors import SceneError

PARTS = ("surrogate", "step", "mesh")
"""Parts of an error."""

SMALL, LARGE = 0.05, 0.25
"""Shares of the largest difference below which an estimated error is called small, and from which
it is called large."""

SOFT = 0.05
"""Overlap (rad) from which faces that touch are said to pass through each other."""

ROUNDING = 1e-12
"""Share of the size of what has a unit below which a width is rounding: thousands of steps leave
some 1e-13 of it (a step, 1e-16)."""

_SIZES = {"rad": 1.0, "m": 1e-3}
"""Least sizes: angles come from directions, of size 1, and no structure is below a millimetre, so
that what a joint that sticks leaves is rounding beside them, not beside itself."""

_SCAN = ("drawn_runs", "share_outside", "share_outside_95")
_ERRORS = ("error_step", "error_mesh", "error_whole")
_INFLUENCE = ("share", "alone", "fixed", "halved")
_NUMBERS = ("lower", "upper", "simulated_lower", "simulated_upper", "surrogate_lower",
            "surrogate_upper", "nominal", "error", "happens",
            "happens_uncertainty")  # fmt: skip


def facts_of(
    folder: Folder, published: Mapping[str, float], requirements: bool = False, choice: bool = False
) -> dict[str, Any]:
    """The facts of the results in a folder; published: largest differences by response.

    requirements, choice: whether the campaign has them.
    """
    plan = read_plan(folder.plan)
    experiment = plan.experiment
    with open_netcdf(folder.bounds) as bounds, open_netcdf(folder.samples) as samples:
        found = of_bounds(bounds, samples, published)
        has_quantities = "quantities" in samples.variables
    if folder.sensitivities.exists():
        with open_netcdf(folder.sensitivities) as data:
            shares = data["width_overall"][:] if "width_overall" in data.variables else []
            for row, own in zip(found["responses"], shares, strict=False):
                row["shares"] = dict(
                    zip(data["parameter"][:].tolist(), map(_number, own), strict=True)
                )
    found |= _structure(experiment, found["parameters"])
    found["quantities"], further = [], 0
    if has_quantities:
        with open_netcdf(folder.quantities) as data:
            found["quantities"] = quantity_rows(data, experiment.solver.duration)
            further = int(data.further_runs)
        for row, quantity in zip(found["quantities"], experiment.numbers, strict=True):
            row |= words_of(quantity)
            if not row["runs_with"] and (far := _reached(quantity, experiment, folder)):
                row["reached"] = far
        if requirements:
            judged = read_json(folder.requirements)
            found |= {name: judged[name] for name in ("requirements", "together")}
            further = judged["further_runs"]
        if choice:
            found["choice"] = read_json(folder.choice)
    found["further_runs"] = further
    rows = [*found["responses"], *found["quantities"]]
    if (rounds := plan.adaptive) is not None:
        found["adaptive"] = {"rounds": [asdict(r) for r in rounds.rounds]}
    if experiment.is_sought:
        for row in rows:
            row["errors"]["asked"] = experiment.accuracy.tolerances[row["name"]]
        found["accuracy"] = _accuracy(plan, rows)
    for row in rows:
        if row["name"] in experiment.doubts:
            row["doubt"] = experiment.doubts[row["name"]]
    mark_constant(found)
    if found["overlap"] > SOFT:
        found["contacts"] = _of_contacts(experiment, found["fixed"])
    found["runs"] = _run_counts(found)
    return found


def mark_constant(found: dict) -> None:
    """Mark responses and quantities whose width is rounding beside the largest value of their unit
    as `constant`: no share of that width, and no error beside it, means anything."""
    rows, duration = [*found["responses"], *found["quantities"]], found["duration"]
    sizes = {"s": duration} | _SIZES
    sizes |= {f"{unit} s-1": size / duration for unit, size in _SIZES.items()}
    for row in rows:
        ends = [row.get("size"), row["lower"], row["upper"]]
        largest = max(abs(end or 0.0) for end in ends)
        sizes[row["units"]] = max(sizes.get(row["units"], 0.0), largest)
    for row in rows:
        width = row.get("largest_difference")
        if width is None and row["lower"] is not None and not row.get("beyond"):
            width = row["upper"] - row["lower"]
        if width is None or width > ROUNDING * sizes[row["units"]]:
            continue
        row["constant"] = True
        row.pop("shares", None)
        if "grade" in row:
            row["grade"] = "none"
        for one in row.get("influence", {}).values():
            one["share"] = 0.0
        if "errors" in row:
            row["errors"]["share"] = None


def varies(row: Mapping) -> bool:
    """Whether a response or quantity depends on the parameters: its value, or whether it is."""
    if "constant" in row:
        return bool(row.get("runs_with") and row.get("runs_without"))
    return row.get("lower") is not None


def of_bounds(bounds: Any, samples: Any, published: Mapping[str, float]) -> dict[str, Any]:
    """The facts of the open `bounds.nc` and `samples.nc`."""
    count, time = counts(samples), bounds["time"][:]
    keys = ("parameter", "box_units", "box_lower", "box_nominal", "box_upper")
    names = ("name", "units", "lower", "nominal", "upper")
    found = {
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
            "nominal_among_them": count.nominal_among_them,
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
        found["scan"] = {key: bounds.getncattr(key).item() for key in _SCAN}
    return found


def _structure(experiment: Any, parameters: list[dict]) -> dict[str, Any]:
    """What the structure is, its parameters that are no intervals, and what the others mean."""
    known = experiment.scene_type.parameters
    for parameter in parameters:
        parameter["description"] = known[parameter["name"]].description
    given = experiment.scene.parameters
    values = {name: given.get(name, one.default) for name, one in known.items()}
    fixed = [
        {"name": name, "value": value, "units": known[name].unit or "1",
         "description": known[name].description}
        for name, value in values.items()
        if name not in experiment.intervals and value is not None
    ]  # fmt: skip
    about = experiment.scene_type.description.strip().rstrip(".")
    return {"about": about, "fixed": fixed}


def _of_contacts(experiment: Any, fixed: Iterable[Mapping]) -> list[str]:
    """Which parameters the stiffness of contacts is proportional to."""

    def stiffness(**values: float) -> np.ndarray:
        return np.array([one.stiffness for one in Contact.of(experiment.build(values))])

    nominal, more = dict(zip(experiment.intervals, experiment.nominal, strict=True)), {}
    in_proportion = 1.01 * stiffness(**nominal)
    for one in fixed:
        if type(one["value"]) is float and one["value"] > 0:
            with suppress(SceneError):  # a value that it may not have
                more[one["name"]] = stiffness(**nominal, **{one["name"]: 1.01 * one["value"]})
    return [name for name, found in more.items() if np.allclose(found, in_proportion)]


def _run_counts(found: dict) -> dict[str, int]:
    """How many runs were made, by what for, and in `all`."""
    runs = {"design": found["design"]["runs"], "further": found.pop("further_runs", 0)}
    runs["choice"] = found.get("choice", {}).get("runs", 0)
    sought = found.get("accuracy", {}).get("runs", 0)  # those of its checks among them
    runs["checks"] = max(0, sought - runs["design"] - runs["further"])
    return {**runs, "all": sum(runs.values())}


def known_error(kind: str, error: float) -> float | None:
    """An estimated error of bounds of a kind; None where it tells nothing: bounds of a scan that
    did not grow with the second half of its runs."""
    return None if kind.startswith("least") and not error else error


def _response(bounds: Any, i: int, name: str, published: float | None) -> dict[str, Any]:
    time, lower, upper = bounds["time"][:], bounds["lower"][i], bounds["upper"][i]
    width = upper - lower
    at = int(width.argmax())
    row = {
        "name": name,
        "long_name": bounds["response_long_name"][i],
        "units": bounds["response_units"][i],
        "largest_difference": float(width[at]),
        "time_of_largest_difference": float(time[at]),
        "lower": float(lower[at]),
        "upper": float(upper[at]),
        "size": float(max(np.abs(lower).max(), np.abs(upper).max())),
        "published": published,
        "ratio_to_published": None if not published else float(width[at] / published),
        "mean_difference": float(np.trapezoid(width, time) / (time[-1] - time[0])),
        "error_at_largest_difference": None,
    }
    if along := along_of(bounds, i):
        row["along"] = along
    if "error" in bounds.variables:
        error = bounds["error"][i]
        worst = int(error.argmax())
        row["largest_error"] = known_error(bounds.bounds_kind, float(error[worst]))
        row["time_of_largest_error"] = float(time[worst])
        row["error_at_largest_difference"] = known_error(bounds.bounds_kind, float(error[at]))
        if foretold := _foretold(bounds, i, at):
            row["extrapolated_error"] = foretold
    row["grade"] = grade(row["error_at_largest_difference"], row["largest_difference"])
    if "growth_quarter" in bounds.variables:
        row["largest_growth_quarter"] = float(bounds["growth_quarter"][i].max())
    if "worst_violation" in bounds.variables:
        row["runs_outside_by"] = float(bounds["worst_violation"][i])
        inside = bounds["coverage"][i] if "coverage" in bounds.variables else np.nan
        row["share_outside"] = float(1.0 - inside) if np.isfinite(inside) else None
    if errors := _response_errors(bounds, i):
        row["errors"] = errors
    row["impossible_by"] = float(bounds["largest_impossible"][i])
    row["time_of_impossible"] = float(bounds["largest_impossible_time"][i])
    return row


def along_of(data: Any, i: int) -> dict[str, Any] | None:
    """Over what response `i` of an open file lies, and the `duration` that this takes on the axis
    of time; None: over time."""
    found = data.variables.get("response_along")
    along = json.loads(str(np.asarray(found[i]))) if found is not None else None
    return along and along | {"duration": float(data["time"][-1])}


def grade(error: float | None, width: float) -> str:
    """An estimated error beside a width: small, noticeable, large or unknown."""
    if error is None or not width > 0:
        return "unknown"
    share = error / width
    return "small" if share < SMALL else "large" if share >= LARGE else "noticeable"


def _foretold(bounds: Any, i: int, at: int) -> dict[str, float]:
    """By how much the fit of response `i` misses runs at instant `at`, and how many, where the
    error is foretold by its coefficients and is far beyond that; else nothing."""
    if "polynomial" not in bounds.bounds_kind:
        return {}
    decay, missed = (float(bounds[f"error_{name}"][i][at]) for name in ("decay", "held_out"))
    runs = int(bounds.held_out_runs)
    return {"missed": missed, "runs": runs} if decay > MAX_TAIL_RATIO * missed else {}


def _response_errors(bounds: Any, i: int) -> dict[str, float]:
    """Errors of response `i` by part, means over time, and the `share` of the mean width that they
    are together; nothing where step and mesh were not looked at."""
    if f"error_{PARTS[0]}" not in bounds.variables:
        return {}
    time = bounds["time"][:]

    def mean(curve: np.ndarray) -> float:
        return float(np.trapezoid(curve, time) / (time[-1] - time[0]))

    names = [name for name in PARTS if f"error_{name}" in bounds.variables]
    found = {name: mean(bounds[f"error_{name}"][i]) for name in names}
    return _with_whole(found, mean(bounds["upper"][i] - bounds["lower"][i]))


def quantity_errors(row: Mapping) -> dict[str, float | None]:
    """The same of a quantity, from its row; None for what is not known."""
    if "error_whole" not in row:
        return {}
    known = {"surrogate": "error", "step": "error_step", "mesh": "error_mesh"}
    found = {name: row[key] for name, key in known.items() if key in row}
    width = None if row["lower"] is None else row["upper"] - row["lower"]
    return _with_whole(found, width)


def _with_whole(parts: Mapping[str, float | None], width: float | None) -> dict:
    values = list(parts.values())
    whole = None if None in values else sum(values)
    if not width:  # nothing varies, or there is no interval
        return {**parts, "whole": whole, "share": 0.0 if whole == 0 and width == 0 else None}
    return {**parts, "whole": whole, "share": None if whole is None else whole / width}


def _accuracy(plan: Plan, rows: Iterable[Mapping]) -> dict[str, Any]:
    """Whether an accuracy is `met`, by the last `errors` of responses and quantities (rows, with
    `name` and what is `asked`), and by which not, `unmet`; why the rounds ended; the mesh; and by
    estimate the runs and the seconds of a core that they took, with those of checks. A quantity
    that happens in no run has no interval that could be wrong."""
    last, experiment = plan.adaptive.rounds[-1], plan.experiment
    mesh = experiment.accuracy.mesh
    known = [row for row in rows if row.get("lower", 0.0) is not None]
    unmet = [row["name"] for row in known if not _is_met(row["errors"])]
    reason = last.reason
    if not unmet and known:
        near = max(known, key=lambda row: row["errors"]["share"] / row["errors"]["asked"])
        share, asked = near["errors"]["share"], near["errors"]["asked"]
        reason = f"nearest to its limit is {near['name']}, {percent(share)} for {percent(asked)}"
    elif plan.adaptive.met:
        reason = "the rounds found it met; runs for the ends of quantities showed more"
    return {
        "met": not unmet,
        "unmet": unmet,
        "reason": reason,
        "rounds": len(plan.adaptive.rounds),
        "mesh": {mesh: experiment.scene.parameters[mesh]} if mesh else {},
        "runs": last.runs,
        "seconds": last.seconds,
    }


def _is_met(errors: Mapping[str, float | None]) -> bool:
    return errors["share"] is not None and errors["share"] <= errors["asked"]


def quantity_rows(data: Any, duration: float = np.inf) -> list[dict[str, Any]]:
    """Plain numbers of each quantity, from the open `quantities.nc`; None for what is no number.

    duration: of the runs (s); a time that reaches it goes on `beyond` what was simulated.
    """
    parameters = data["parameter"][:].tolist()
    rows = []
    for i, name in enumerate(data["quantity"][:]):
        row: dict[str, Any] = {
            "name": str(name),
            "long_name": str(data["quantity_long_name"][i]),
            "units": str(data["quantity_units"][i]),
            "fit": str(data["fit"][i]),
        }
        for key in (*_NUMBERS, *(key for key in _ERRORS if key in data.variables)):
            row[key] = _number(data[key][i])
        if errors := quantity_errors(row):
            row["errors"] = errors
        row |= {key: int(data[key][i]) for key in ("runs_with", "runs_without")}
        row["predicted_ends"] = [
            side for side in ("lower", "upper") if data[f"unconverged_{side}"][i]
        ]
        ends = row["units"] == "s" and row["runs_without"] and (row["upper"] or 0.0) >= duration
        row["beyond"] = duration if ends else None
        for key in ("argmin", "argmax"):
            row[key] = dict(zip(parameters, map(_number, data[key][i]), strict=True))
        row["influence"] = {
            parameter: {key: _number(data[key][i, j]) for key in _INFLUENCE}
            for j, parameter in enumerate(parameters)
        }
        rows.append(row)
    return rows


def _reached(quantity: Any, experiment: Any, folder: Folder) -> dict[str, Any]:
    """How far the response of a crossing, or of a latch's joint, comes to its level over the box,
    when (s), and whether it `moves` then, at the end of the run; nothing where there is none."""
    response, level = quantity.response, quantity.level
    if quantity.event == "latches":
        scene = experiment.nominal_scene
        latches = {
            name: latch
            for kind in (Latch, RigidLatch)
            for name, latch in zip(kind.names(scene), kind.of(scene), strict=True)
        }
        latch = latches[quantity.places[0]]
        of = "opening", (scene.hinges[latch.hinge].name,)
        response = next((c for c in experiment.curves if (c.kind, c.subjects) == of), None)
        level = latch.angle
    elif quantity.kind != "crossing":
        response = None
    if response is None:
        return {}
    with open_netcdf(folder.bounds) as bounds:
        row = list(bounds["response"][:]).index(response.name)
        curves = np.array([bounds["lower"][row], bounds["upper"][row]])
        time = bounds["time"][:]
    side, at = np.unravel_index(np.argmin(np.abs(curves - level)), curves.shape)
    value = float(curves[side, at]) + 0.0  # no -0
    return {"name": response.name, "units": response.unit, "value": value, "level": level,
            "time": float(time[at]), "moves": bool(at >= 0.98 * len(time))}  # fmt: skip


def _number(value: Any) -> float | None:
    return float(value) if np.isfinite(value) else None


def decisive(row: Mapping) -> str | None:
    """The parameter that widens the interval of a quantity most; None where none does."""
    shares = {name: found["share"] or 0.0 for name, found in row["influence"].items()}
    most = max(shares, key=shares.__getitem__)
    return most if shares[most] > 0 and len(shares) > 1 else None


def happens_only(row: Mapping, quantities: Iterable[Mapping]) -> str | None:
    """The quantity where it exists a requirement is met everywhere: it fails only where that does
    not happen; None if it fails elsewhere."""
    shares = {quantity["name"]: quantity["happens"] for quantity in quantities}
    limits = {limit["quantity"] for limit in row["limits"] if limit["kind"] != "happens"}
    only = [name for name in limits if shares[name] == row["share"] < 1]
    return only[0] if only and row["met"] == "some" else None


def closures(samples: Any, run: int) -> list[dict[str, Any]]:
    """Contacts of one run that close: time (s) and name of the contact, in order of time."""
    names = list(samples["contact"][:])
    keys = ("event_time", "event_closing", "event_contact")
    rows = zip(*(samples[key][run] for key in keys), strict=True)
    found = [
        {"time": float(time), "contact": names[int(contact)]}
        for time, closing, contact in rows
        if np.isfinite(time) and closing == 1
    ]
    return sorted(found, key=lambda row: row["time"])


def moments(rows: Iterable[Mapping]) -> dict[str, list[str]]:
    """Names of contacts that close, by the moment as it is written."""
    found: dict[str, list[str]] = {}
    for row in rows:
        names = found.setdefault(f"{row['time']:.4f} s", [])
        names += [row["contact"]] * (row["contact"] not in names)
    return found
