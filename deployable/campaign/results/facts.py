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
from deployable.campaign.results.quantity_facts import late_peaks, quantity_facts
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
from deployable.campaign.text import name_response
from deployable.campaign.text.numbers import code
from deployable.intervals.box import ROUNDING
from fpm.elements import Contact
from fpm.errors import SceneError

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
        facts |= _structure(experiment, facts["parameters"])
        facts["quantities"] = quantity_facts(folder, samples, bounds)
        if facts["overlap"] > SOFT:
            facts["contacts"] = _contact_names(experiment, facts["fixed"])
            facts["late_peaks"] = late_peaks(samples, facts["closures"], bounds.time)
    bounds_checks = int(bounds.attributes.get("check_runs", 0))
    runs = {"design": facts["design"]["runs"], "further": 0, "choice": 0, "checks": bounds_checks}
    if experiment.quantities:
        results = QuantityResults.read(folder)
        runs["further"] = results.further_runs
        runs["checks"] += results.check_runs
        failures += read_refinement(folder)[2]
    facts["failures"] = describe_failures(failures, experiment.intervals)
    for name in answers:
        answer = read_json(folder / f"{name}.json")
        keys = ("requirements", "together") if name == "requirements" else ()
        facts |= {key: answer[key] for key in keys} or {name: answer}
    if choice := facts.get("choice"):
        runs["choice"] = choice["runs"]
        facts["failures"] += choice.pop("failures")
        del choice["fitted"]
    if names := experiment.box.constant_names(plan.runs.normalized):
        facts["unvaried"] = names
    mark_constant(facts)
    rows = [*facts["responses"], *facts["quantities"]]
    for row in rows:
        if row["name"] in experiment.doubts:
            row["doubt"] = experiment.doubts[row["name"]]
    if plan.adaptive is not None:
        facts["adaptive"] = {"rounds": [asdict(r) for r in plan.adaptive.rounds]}
    if experiment.is_adaptive:
        facts["accuracy"] = _accuracy(plan, rows)
        runs["checks"] += facts["accuracy"]["runs"] - runs["design"] - bounds_checks
    runs["measured"] = facts.get("measured", {}).get("runs", 0)
    runs["failed"] = len(facts["failures"])
    facts["runs"] = {**runs, "all": sum(runs.values())}
    return facts


def mark_constant(facts: dict) -> None:
    """Mark the responses and quantities of the facts that do not vary over the box: `constant`
    becomes True, `shares` is removed, `grade` "none", the `share` of each influence 0, that of the
    errors None. Their bounds differ by rounding alone: by at most `ROUNDING` times the largest
    value that any with that unit has, at least 1 rad, 1 mm, the duration, or these over it."""
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
    if "unseen_from" in attributes:
        facts["unseen_from"] = float(attributes["unseen_from"])
    if bounds.responses[0].growth is not None:
        facts["scan"] = {key: attributes[key].item() for key in _SCAN}
    return facts


def _structure(experiment: Any, parameters: list[dict]) -> dict[str, Any]:
    """Describe the structure, its parameters that are no intervals, and the meaning of the rest."""
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
        if len(large := np.flatnonzero(bounds.error > LARGE * width[instant])):
            times = {"from": float(time[large[0]]), "to": float(time[large[-1]])}
            is_most = bool(2 * len(large) > large[-1] - large[0])
            row["times_of_large_error"] = times | {"throughout": is_most}
    row["grade"] = grade(row.get("largest_error"), row["largest_difference"])
    row["trusted"] = _largest_trusted(bounds)
    if (start := campaign.attributes.get("undivided_from", np.inf)) <= time[instant]:
        row["undivided_from"] = float(start)
    if bounds.growth is not None:
        row["largest_growth_quarter"] = float(bounds.growth.max())
    if COMPONENTS[0] in bounds.errors:
        parts = [name for name in COMPONENTS if name in bounds.errors]
        errors = {name: _mean(bounds.errors[name], time) for name in parts}
        row["errors"] = add_total_error(errors, _mean(width, time))
    if bounds.shares is not None:
        names = [parameter["name"] for parameter in campaign.parameters]
        row["shares"] = dict(zip(names, map(number, bounds.shares), strict=True))
    return row


def _mean(curve: np.ndarray, time: np.ndarray) -> float:
    """Return the mean of a curve (T) over time (T)."""
    return float(np.trapezoid(curve, time) / (time[-1] - time[0]))


def _largest_trusted(bounds: ResponseBounds) -> dict[str, float] | None:
    """Return the largest difference between the bounds of a response where their error is small,
    with the error of either and the time; None where there are no errors, or none is small."""
    width, error = bounds.width, bounds.error
    if error is None or not (is_sure := error < LARGE * width.max()).any():
        return None
    instant = int(np.where(is_sure, width, -np.inf).argmax())
    values = width[instant], error[instant], bounds.time[instant]
    return dict(zip(("difference", "error", "time"), map(float, values), strict=True))


def grade(error: float | None, width: float) -> str:
    """Return a word for the largest error of bounds beside `width`, their largest difference in its
    unit: `small`, `large` above 10 %, `unknown` for None or width 0."""
    if error is None or not width > 0:
        return "unknown"
    return "large" if error > LARGE * width else "small"


def _accuracy(plan: Plan, rows: Iterable[Mapping]) -> dict[str, Any]:
    """Return whether an accuracy is `met`, by the last errors of responses and quantities (rows,
    which get their `target`), which are `unmet`; why rounds and searches ended, as sentences; mesh,
    runs, core seconds."""
    last, experiment = plan.adaptive.rounds[-1], plan.experiment
    for row in rows:
        row["errors"]["target"] = experiment.accuracy.tolerances[row["name"]]
    mesh = experiment.accuracy.mesh
    intervals = [
        row for row in rows
        if row.get("lower", 0.0) is not None
        and not ("constant" in row and row.get("runs_with", 2) > 1)
    ]  # fmt: skip
    unmet = [  # by shares as printed
        row["name"] for row in intervals if row["errors"]["share"] is None
        or float(f"{row['errors']['share']:.3g}") > row["errors"]["target"]
    ]  # fmt: skip
    texts = [] if plan.adaptive.met else [f"The rounds ended as {last.reason}"]
    texts += [f"The search for the bounds of {row['name']} ended as {row['search_end']}"
              for row in intervals if row["name"] in unmet and row.get("search_end")]  # fmt: skip
    texts = texts or ["Finer steps and meshes change bounds too much"]
    return {
        "met": not unmet,
        "unmet": unmet,
        "others": len(intervals) - len(unmet),
        "reason": ". ".join(text.removesuffix(".") for text in texts if unmet),
        "rounds": len(plan.adaptive.rounds),
        "mesh": {mesh: experiment.scene.parameters[mesh]} if mesh else {},
        "runs": last.runs,
        "seconds": last.seconds,
    }


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


def changes(half: Mapping[str, float]) -> bool:
    """Return whether an interval that is half as wide changes the share of the box that meets all
    requirements, either way, by more than the error. half: of a parameter, in `together.halved`."""
    return abs(half["gain"]) > half["gain_uncertainty"]


def best_halvings(halved: Mapping[str, Mapping]) -> list[str]:
    """Name the parameters whose halved interval raises most the share of the box that meets all
    requirements, as far as the errors tell; [] if none does. halved: of `together`."""
    effective = {name: x for name, x in halved.items() if x["gain"] > x["gain_uncertainty"]}
    least = max((x["gain"] - x["gain_uncertainty"] for x in effective.values()), default=0.0)
    return [name for name, x in effective.items() if x["gain"] + x["gain_uncertainty"] >= least]


def scarcest(limits: Iterable[Mapping]) -> Mapping | None:
    """Return the limit with the smallest margin relative to its error; None if none has both.
    limits: of the best choice, dicts with `margin` and `error` in the unit of their quantity."""
    rows = [limit for limit in limits if limit["margin"] is not None and limit.get("error")]
    return min(rows, key=lambda limit: limit["margin"] / limit["error"], default=None)


def missing_only(requirements: Iterable[Mapping], quantities: Iterable[Mapping]) -> list[str]:
    """Name the requirements that fail only where their quantity does not exist."""
    rows = [row for row in requirements if None in [x["margin"] for x in row["limits"]]]
    return [row["name"] for row in rows if happens_only(row, quantities)]


def is_tight(choice: Mapping) -> bool:
    """Return whether a limit's margin is less than twice its error. choice: section of the facts"""
    return _room(choice) < 2


def _room(choice: Mapping) -> float:
    """Return the smallest margin of a choice relative to its error; infinite without errors."""
    limit = scarcest(choice["limits"])
    return np.inf if limit is None else limit["margin"] / limit["error"]


def roomier(choice: Mapping) -> Mapping | None:
    """Return the tried choice that is best for the first goal among those that are not tight, with
    the errors of the fit over all choices, if the best choice is tight; None if there is no such
    choice. choice: section of the facts."""
    sections = {"parameters": "values", "goals": "goals", "limits": "margins"}
    rows = [
        {section: [row | {"value": x, "margin": x, "error": row.get("fit_error")}
                   for row, x in zip(choice[section], trial[key], strict=True)]
         for section, key in sections.items()}
        for trial in choice["tried"] if trial["kept"]
    ]  # fmt: skip
    sign = -1 if choice["goals"][0]["sense"] == "minimise" else 1
    roomy = [row for row in rows if is_tight(choice) and not is_tight(row)]
    return max(roomy, key=lambda row: sign * row["goals"][0]["value"], default=None)


def worst_limit(limits: Iterable[Mapping]) -> Mapping:
    """Return the limit with the smallest margin relative to its level; one without a margin is
    better than all if it is kept, else worse."""
    return min(limits, key=lambda x: (1 if x["kept"] else -1) * np.inf if x["margin"] is None
               else x["margin"] / (abs(x["level"]) or 1.0))  # fmt: skip


def contact_bound(facts: Mapping) -> list[Mapping]:
    """Return the requirements on peaks after the first contact, which depend on its stiffness."""
    rows, peaks = facts.get("requirements", ()), facts.get("late_peaks", ())
    return [row for row in rows if any(x["quantity"] in peaks for x in row["limits"])]


def happens_only(row: Mapping, quantities: Iterable[Mapping]) -> str | None:
    """Name the quantity of a requirement (`row`) that fails in part of the box only because the
    quantity does not occur there: where it occurs, its bounds keep all limits by their error, and
    the shares of both are equal within theirs. None for any other requirement."""
    rows = {quantity["name"]: quantity for quantity in quantities}
    limits = [limit for limit in row["limits"] if limit["kind"] != "happens"]
    names = {limit["quantity"] for limit in limits}
    if row["met"] != "some" or not row["share"] < 1 or len(names) != 1:
        return None
    quantity = rows[names.pop()]
    is_kept = all(keeps(quantity, limit["kind"], limit["level"]) for limit in limits)
    errors = row["share_uncertainty"] + (quantity["happens_uncertainty"] or 0.0)
    is_equal = abs(quantity["happens"] - row["share"]) <= errors
    return quantity["name"] if is_kept and is_equal else None


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
