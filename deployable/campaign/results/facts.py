"""Facts of a campaign, its results as plain numbers and texts: the content of `summary.json`, from
which the templates in this folder make the summary and the page."""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict
from typing import Any

import numpy as np

from deployable.campaign.files import read_json
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import Plan, read_plan
from deployable.campaign.results.quantity_results import (
    QuantityResults,
    add_total_error,
    number,
    whole_error,
)
from deployable.campaign.results.response_bounds import (
    COMPONENTS,
    LARGE,
    CampaignBounds,
    ResponseBounds,
    read_bounds,
)
from deployable.campaign.results.run_samples import (
    RunSamples,
    describe_events,
    describe_failures,
    open_samples,
    read_refinement,
)
from deployable.campaign.text import name_response, words_of
from deployable.campaign.text.numbers import code, percent
from deployable.intervals.box import ROUNDING
from deployable.intervals.estimates import MAX_TAIL_RATIO
from fpm.elements import Contact, Latch
from fpm.errors import SceneError

SMALL = 0.05  # share of the largest difference below which an error is small
SOFT = 0.05  # overlap (rad) from which faces that touch are said to pass through each other

_SIZES = {"rad": 1.0, "m": 1e-3}
"""Least sizes by unit, beside which a width is rounding: of directions 1, of structures 1 mm."""

_SCAN = ("drawn_runs", "share_outside", "share_outside_95")


def facts_of(
    folder: Folder, published: Mapping[str, float], answers: Iterable[str] = ()
) -> dict[str, Any]:
    """Collect a campaign's results as plain data for JSON: the content of `summary.json`, whose
    keys `summary.schema.json` describes. Other functions call it the facts. published: largest
    width that somebody has published, by response; answers: which results in JSON the campaign has,
    "requirements", "choice" or "measured"."""
    plan = read_plan(folder.plan)
    experiment, bounds = plan.experiment, read_bounds(folder)
    with open_samples(folder) as samples:
        facts, failures = bounds_facts(bounds, samples, published), [*samples.failures]
        peaks = _late_peaks(samples, facts["closures"], bounds.time)
        late_runs = [_late_runs(i, quantity, samples, bounds.time)
                     for i, quantity in enumerate(experiment.quantity_list)]  # fmt: skip
    facts |= _structure(experiment, facts["parameters"])
    facts["quantities"], by_name = [], {}
    bounds_checks = int(bounds.attributes.get("check_runs", 0))
    runs = {"design": facts["design"]["runs"], "further": 0, "choice": 0, "checks": bounds_checks}
    if experiment.quantities:
        results = QuantityResults.read(folder)
        facts["quantities"], runs["further"] = results.rows, results.further_runs
        runs["checks"] += results.check_runs
        failures += read_refinement(folder)[2]
        by_name = {row["name"]: row for row in facts["quantities"]}
        for row, quantity, counts in zip(
            facts["quantities"], experiment.quantity_list, late_runs, strict=True
        ):
            row |= words_of(quantity) | ({"unfinished": counts} if counts else {})
            parts = [by_name[part.name] for part in getattr(quantity, "parts", ())]
            row["late_parts"] = [  # times that go on beyond the runs, or may have no upper end
                part["name"] for part in parts if part["censored_at"] or part["may_be_endless"]
            ]
            if not row["runs_with"] and (approach := _approach(quantity, experiment, bounds)):
                row["reached"] = approach
    for name in answers:
        answer = read_json(folder / f"{name}.json")
        keys = ("requirements", "together") if name == "requirements" else ()
        facts |= {key: answer[key] for key in keys} or {name: answer}
    least = {
        quantity.name: quantity.least if quantity.always_exists else None
        for quantity in experiment.quantity_list
    }
    for limit in (limit for row in facts.get("requirements", ()) for limit in row["limits"]):
        name = limit["quantity"]
        if reason := why_idle(limit, by_name[name], least[name]):
            limit["idle"] = reason
    if choice := facts.get("choice"):
        runs["choice"] = choice["runs"]
        del choice["fitted"]
    facts["failures"] = describe_failures(failures, experiment.intervals)
    facts["failures"] += facts.get("choice", {}).pop("failures", [])
    facts |= (
        {"unvaried": names}
        if (names := experiment.box.constant_names(plan.runs.normalized))
        else {}
    )
    runs["measured"] = facts.get("measured", {}).get("runs", 0)
    runs["failed"] = len(facts["failures"])
    rows = [*facts["responses"], *facts["quantities"]]
    mark_constant(facts)
    if plan.adaptive is not None:
        facts["adaptive"] = {"rounds": [asdict(r) for r in plan.adaptive.rounds]}
    if experiment.is_adaptive:
        for row in rows:
            row["errors"]["target"] = experiment.accuracy.tolerances[row["name"]]
        facts["accuracy"] = _accuracy(plan, rows)
        runs["checks"] += facts["accuracy"]["runs"] - runs["design"] - bounds_checks
    for row in rows:
        if row["name"] in experiment.doubts:
            row["doubt"] = experiment.doubts[row["name"]]
    if "unseen_from" in bounds.attributes:
        facts["unseen_from"] = float(bounds.attributes["unseen_from"])
    if facts["overlap"] > SOFT:
        facts["contacts"] = _contact_names(experiment, facts["fixed"])
        facts["late_peaks"] = peaks
    facts["runs"] = {**runs, "all": sum(runs.values())}
    return facts


def why_idle(limit: Mapping, row: Mapping, least: float | None) -> str | None:
    """Return why a limit cannot fail, so that to meet it says nothing: its quantity has a physical
    lower bound, or the other sign in all runs, as where the size of a signed number is meant; None
    if it can fail. limit: its dict in the results; row: that of the quantity; least: that bound."""
    sign = {"at_most": 1, "at_least": -1}.get(limit["kind"], 0)
    if sign < 0 and least is not None and limit["level"] <= least:
        return f"is never below {least:g}"
    end = row["upper" if sign > 0 else "lower"]
    if not sign or end is None or not sign * limit["level"] > 0 > sign * end:
        return None
    return f"is {'negative' if sign > 0 else 'positive'} in all runs"


def mark_constant(facts: dict) -> None:
    """Mark the responses and quantities of the facts that do not vary over the box: `constant`
    becomes True, `shares` is removed, `grade` "none", the `share` of each influence 0, that of the
    errors None. Their bounds differ by rounding alone: by at most `ROUNDING` times the largest
    value that any of them with that unit has, at least 1 rad, 1 mm, the duration (s), or 1 rad or 1
    mm per duration."""
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
    """Return whether a response or quantity depends on the parameters: its value does, or a
    quantity occurs in some runs only. row: its dict in the results (`facts_of`)."""
    if "constant" in row:
        return bool(row.get("runs_with") and row.get("runs_without"))
    return row.get("lower") is not None


def bounds_facts(
    bounds: CampaignBounds, samples: RunSamples, published: Mapping[str, float]
) -> dict[str, Any]:
    """Collect what `bounds.nc` and `samples.nc` tell, a part of `summary.json`."""
    time, attributes = bounds.time, bounds.attributes
    nominal: Any = samples.nominal
    (events,) = samples.events([nominal])
    facts = {
        **{key: attributes[key] for key in ("campaign", "scene", "config_hash")},
        "duration": float(time[-1] - time[0]),
        "parameters": bounds.parameters,
        "design": {
            "method": attributes["design_method"],
            "order": np.atleast_1d(attributes["design_order"]).tolist(),
            **samples.count(),
        },
        "bounds": attributes["bounds_kind"],
        "time_step": float(attributes["time_step"]),
        "finest_step": samples.finest_step,
        "overlap": samples.overlap,
        "assembly_energy": samples.assembly_energy,
        "closures": [
            {"time": event["time"], "contact": event["contact"]}
            for event in describe_events(events, samples.contacts) if event["closing"]
        ],
        "responses": [
            _response(row, bounds, published.get(row.name)) | {"words": name_response(response)}
            for row, response in zip(
                bounds.responses, samples.experiment.response_list, strict=True
            )
        ],
    }  # fmt: skip
    if bounds.responses[0].growth is not None:
        facts["scan"] = {key: attributes[key].item() for key in _SCAN}
    return facts


def _structure(experiment: Any, parameters: list[dict]) -> dict[str, Any]:
    """Describe the structure, its parameters that are not intervals, and the meaning of those that
    are."""
    definitions = experiment.scene_type.parameters
    for parameter in parameters:
        parameter["description"] = definitions[parameter["name"]].text
    fixed = [
        {"name": name, "value": value, "units": definitions[name].unit or "1",
         "description": definitions[name].text}
        for name, value in experiment.parameters({}).items()
        if name not in experiment.intervals and value is not None
    ]  # fmt: skip
    description = experiment.scene_type.description.strip().rstrip(".")
    return {"about": description, "fixed": fixed}


def _late_peaks(samples: RunSamples, closures: list[dict], time: np.ndarray) -> list[str]:
    """Return the quantities that are peaks after the first contact, in the nominal run."""
    responses, names = samples.experiment.response_list, []
    for quantity in samples.experiment.quantity_list if closures else ():
        choose = {"largest": np.argmax, "smallest": np.argmin}.get(quantity.kind)
        if choose and quantity.response in responses:
            nominal: Any = samples.nominal
            (curve,) = samples.curves(nominal, [responses.index(quantity.response)])
            names += [quantity.name] * bool(time[choose(curve)] > closures[0]["time"])
    return names


def _contact_names(experiment: Any, fixed: Iterable[Mapping]) -> list[str]:
    """Return the parameters to which the stiffness of contacts is proportional."""

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


def _response(
    bounds: ResponseBounds, campaign: CampaignBounds, published: float | None
) -> dict[str, Any]:
    time, width, instant = bounds.time, bounds.width, bounds.widest
    row: dict[str, Any] = {key: getattr(bounds, key) for key in ("name", "long_name", "units")}
    row |= {
        "largest_difference": float(width[instant]),
        "time_of_largest_difference": float(time[instant]),
        "lower": float(bounds.lower[instant]),
        "upper": float(bounds.upper[instant]),
        "size": float(max(np.abs(bounds.lower).max(), np.abs(bounds.upper).max())),
        "published": published,
        "ratio_to_published": None if not published else float(width[instant] / published),
        "mean_difference": _mean(width, time),
        "error_at_largest_difference": None,
    }
    if bounds.abscissa:
        row["along"] = bounds.abscissa
    if bounds.error is not None:
        largest = int(bounds.error.argmax())
        error, worst = (
            None if bounds.is_unknown(bounds.error[i]) else float(bounds.error[i])
            for i in (instant, largest)
        )
        row |= {"largest_error": worst, "time_of_largest_error": float(time[largest]),
                "error_at_largest_difference": error}  # fmt: skip
        runs = int(campaign.attributes["held_out_runs"])
        if extrapolation := _extrapolated_error(bounds, instant, runs):
            row["extrapolated_error"] = extrapolation
    row["grade"] = grade(row["error_at_largest_difference"], row["largest_difference"])
    row["trusted"] = _largest_trusted(bounds)
    if (start := campaign.attributes.get("undivided_from", np.inf)) <= time[instant]:
        row["undivided_from"] = float(start)
    if bounds.growth is not None:
        row["largest_growth_quarter"] = float(bounds.growth.max())
    if COMPONENTS[0] in bounds.errors:
        parts = [name for name in COMPONENTS if name in bounds.errors]
        errors = {name: _mean(bounds.errors[name], time) for name in parts}
        row["errors"] = add_total_error(errors, _mean(width, time))
    row["impossible_by"], row["time_of_impossible"] = bounds.impossible
    if bounds.shares is not None:
        names = [parameter["name"] for parameter in campaign.parameters]
        row["shares"] = dict(zip(names, map(number, bounds.shares), strict=True))
    return row


def _extrapolated_error(bounds: ResponseBounds, instant: int, runs: int) -> dict[str, float]:
    """Return how far the fit misses `runs` runs, and `runs`, if the decay of the coefficients
    predicts a far larger error; else nothing."""
    if "polynomial" not in bounds.kind:
        return {}
    decay, residual = (float(bounds.errors[name][instant]) for name in ("decay", "held_out"))
    return {"missed": residual, "runs": runs} if decay > MAX_TAIL_RATIO * residual else {}


def _mean(curve: np.ndarray, time: np.ndarray) -> float:
    """Return the mean of a curve (T) over time (T)."""
    return float(np.trapezoid(curve, time) / (time[-1] - time[0]))


def _largest_trusted(bounds: ResponseBounds) -> dict[str, float] | None:
    """Return the largest difference between the bounds of a response where these are drawn, with
    the error of either and the time; None where there are no errors, or none is small enough."""
    width, error = bounds.width, bounds.error
    if error is None or not (is_sure := error < LARGE * width.max()).any():
        return None
    instant = int(np.where(is_sure, width, -np.inf).argmax())
    values = width[instant], error[instant], bounds.time[instant]
    return dict(zip(("difference", "error", "time"), map(float, values), strict=True))


def grade(error: float | None, width: float) -> str:
    """Return a word for an error relative to `width`, the difference of the bounds in its unit:
    `small` below 5 %, `large` from 25 %, `noticeable` between, `unknown` for None or width 0."""
    if error is None or not width > 0:
        return "unknown"
    relative = error / width
    return "small" if relative < SMALL else "large" if relative >= LARGE else "noticeable"


def _accuracy(plan: Plan, rows: Iterable[Mapping]) -> dict[str, Any]:
    """Return whether an accuracy is `met`, by the last errors of responses and quantities (rows),
    which are `unmet`; why rounds and searches ended, as sentences; mesh, runs, core seconds."""
    last, experiment = plan.adaptive.rounds[-1], plan.experiment
    mesh = experiment.accuracy.mesh
    intervals = [
        row for row in rows
        if row.get("lower", 0.0) is not None
        and not ("constant" in row and row.get("runs_with", 2) > 1)
    ]  # fmt: skip
    unmet = [row["name"] for row in intervals if not _is_met(**row["errors"])]
    texts = [] if plan.adaptive.met else [f"The rounds ended as {last.reason}"]
    texts += [f"The search for the bounds of {row['name']} ended as {row['search_end']}"
              for row in intervals if row["name"] in unmet and row.get("search_end")]  # fmt: skip
    texts = texts or ["Finer steps and meshes change bounds too much"]
    reason = ". ".join(text.removesuffix(".") for text in texts)
    if not unmet and intervals:
        row = max(intervals, key=lambda row: row["errors"]["share"] / row["errors"]["target"])
        share, target = row["errors"]["share"], row["errors"]["target"]
        reason = f"the error of {row['name']} is nearest to its target"
        reason += f", {percent(share)} of {percent(target)}"
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


def _is_met(share: float | None, target: float, **_: Any) -> bool:
    """Return whether a share meets its target, as printed with three digits."""
    return share is not None and float(f"{share:.3g}") <= target


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
    last = np.searchsorted(time, time[0] + 0.98 * (time[-1] - time[0]))
    gaps = np.array([abs(samples.curves(int(r), [number])[0, [last, -1]] - level) for r in rows])
    rates = (gaps[:, 0] - gaps[:, 1]) / (time[-1] - time[last])
    stuck = rows[rates * (time[-1] - time[0]) < gaps[:, 1]]
    names = samples.experiment.intervals
    place = (
        dict(zip(names, samples.table.values[stuck[0]].tolist(), strict=True)) if len(stuck) else {}
    )
    return {"name": response.name, "late": len(rows) - len(stuck), "stuck": len(stuck), "at": place,
            "duration": float(time[-1] - time[0])}  # fmt: skip


def decisive(row: Mapping) -> str | None:
    """Name the parameter that contributes most to the width of a quantity's interval; None if none
    does, or the campaign has one alone. row: the quantity's dict (`QuantityResults`)."""
    shares = {name: influence["share"] for name, influence in row["influence"].items()}
    return next(iter(largest(shares)), None) if len(shares) > 1 else None


def largest(shares: Mapping[str, float | None]) -> list[str]:
    """Name the parameters of the largest share, in order, and those whose share is no more than 1 %
    of it smaller; [] where all are 0. shares: by parameter, None for none."""
    most = max((share or 0.0 for share in shares.values()), default=0.0)
    return [name for name, share in shares.items() if share and share >= 0.99 * most]


def fitted_width(row: Mapping) -> float:
    """Return the width of a quantity's interval by its fit, beside which widths with one parameter
    known better stand (`influence`): no more than that of the interval, as these."""
    return min(row["surrogate_upper"] - row["surrogate_lower"], row["upper"] - row["lower"])


def has_effect(influence: Mapping, row: Mapping, key: str) -> bool:
    """Return whether fixing a parameter (`key` "fixed"), or halving its interval ("halved"),
    narrows a quantity's interval by more than the error of these widths."""
    numbers = influence[key], influence["width_error"], row["surrogate_upper"]
    if "constant" in row or None in numbers:
        return False
    return bool(fitted_width(row) - numbers[0] > numbers[1])


def gains(half: Mapping[str, float]) -> bool:
    """Return whether an interval that is half as wide raises the share of the box that meets all
    requirements by more than the error of that. half: of a parameter, in `together.halved`."""
    return half["gain"] > max(half["gain_uncertainty"], half["share_uncertainty"])


def best_halvings(halved: Mapping[str, Mapping]) -> list[str]:
    """Name the parameters whose halved interval raises most the share of the box that meets all
    requirements, as far as the errors tell; [] if none does. halved: of `together`."""
    effective = {name: half for name, half in halved.items() if gains(half)}
    least = max((x["gain"] - x["gain_uncertainty"] for x in effective.values()), default=0.0)
    return [name for name, x in effective.items() if x["gain"] + x["gain_uncertainty"] >= least]


def scarcest(limits: Iterable[Mapping]) -> Mapping | None:
    """Return the limit with the smallest margin relative to its error; None if none has both.
    limits: of the best choice, dicts with `margin` and `error` in the unit of their quantity."""
    rows = [limit for limit in limits if limit["margin"] is not None and limit.get("error")]
    return min(rows, key=lambda limit: limit["margin"] / limit["error"], default=None)


def tightest(requirements: Iterable[Mapping]) -> str | None:
    """Name the quantity of the limit with the smallest margin relative to its level, if any."""
    limits = [x for row in requirements for x in row["limits"] if x["margin"] is not None]
    least: Mapping = min(limits, key=lambda x: x["margin"] / (abs(x["level"]) or 1.0), default={})
    return least.get("quantity")


def missing_only(requirements: Iterable[Mapping], quantities: Iterable[Mapping]) -> list[str]:
    """Name the requirements that fail only where their quantity does not exist."""
    return [row["name"] for row in requirements if happens_only(row, quantities)]


def is_tight(choice: Mapping) -> bool:
    """Return whether a limit's margin is less than twice its error. choice: section of the facts"""
    limit = scarcest(choice["limits"])
    return limit is not None and limit["margin"] < 2 * limit["error"]


def happens_only(row: Mapping, quantities: Iterable[Mapping]) -> str | None:
    """Name the quantity of a requirement (`row`) that fails in part of the box only because the
    quantity does not occur there: where it occurs, its bounds keep all limits by their error. None
    for any other requirement."""
    rows = {quantity["name"]: quantity for quantity in quantities}
    limits = [limit for limit in row["limits"] if limit["kind"] != "happens"]
    names = {limit["quantity"] for limit in limits}
    if row["met"] != "some" or not row["share"] < 1 or len(names) != 1:
        return None
    quantity = rows[names.pop()]
    is_kept = all(keeps(quantity, limit["kind"], limit["level"]) for limit in limits)
    return quantity["name"] if is_kept and quantity["happens"] == row["share"] else None


def worst_case(limit: Mapping, row: Mapping, quantities: Iterable[Mapping]) -> Mapping:
    """Return a limit with the margin that summary and page show, its error, its place and the run
    there. If the requirement `row` fails only where its quantity does not happen, these are the
    values where it happens (`is_partial`); otherwise the limit is returned as it is. quantities:
    dicts of all quantities."""
    name = happens_only(row, quantities)
    if limit["margin"] is not None or limit["quantity"] != name:
        return limit
    quantity = next(quantity for quantity in quantities if quantity["name"] == name)
    end, place = ("upper", "argmax") if limit["kind"] == "at_most" else ("lower", "argmin")
    margin = abs(limit["level"] - quantity[end])  # the limit is kept where it happens
    worst = {"margin": margin, "error": whole_error(quantity), "at": quantity[place], "ran": True}
    return {**limit, **worst, "simulated": quantity[f"simulated_{end}"], "is_partial": True}


def keeps(row: Mapping, kind: str, level: float) -> bool:
    """Return whether the bounds of a quantity (its dict, `row`) keep a limit by their error. kind:
    of the limit, "at_most" or "at_least"; level: its number."""
    error = whole_error(row)
    if row["lower"] is None or error is None or (kind == "at_most" and row.get("censored_at")):
        return False
    return bool((row["lower"] - level if kind == "at_least" else level - row["upper"]) >= error)


def moments(rows: Iterable[Mapping]) -> dict[str, list[str]]:
    """Group closures of contacts by their times, written as `0.3100 s`: lists of the contacts'
    names in code font, each name once. rows: dicts of time (s) and contact."""
    contacts: dict[str, list[str]] = {}
    for row in rows:
        names = contacts.setdefault(f"{row['time']:.4f} s", [])
        kind, _, name = row["contact"].rpartition(" ")
        text = f"the {kind or 'contact'} {code(name)}"
        names += [text] * (text not in names)
    return contacts
