"""Results of several campaigns side by side: facts like those of cases, and their curves."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from os.path import abspath
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.models import Display
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import read_json
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.results.cases import facts_of_cases
from deployable.campaign.results.display import shown_bounds, shown_facts
from deployable.campaign.results.response_bounds import ResponseBounds, read_bounds
from deployable.campaign.results.templates import sentence
from deployable.campaign.text.numbers import quantity, spread
from fpm.structures.reading import commas, join_key

Curves = dict[str, dict[str, ResponseBounds]]
"""Bounds of responses by name, then by the label of their results."""


def compare(paths: Sequence[str | Path], is_shown: bool = False) -> tuple[dict[str, Any], Curves]:
    """Return the facts of several folders of results as plain data, with the curves of all
    responses. is_shown: whether all are in the units of the first campaign's `display`, and not SI
    units. Raises `CampaignError` for a folder without results."""
    folders = _folders(paths)
    summaries = {label: read_json(folder / "summary.json") for label, folder in folders.items()}
    experiments = [read_plan(folder.plan).experiment for folder in folders.values()]
    display = experiments[0].display if is_shown else Display()
    for (label, facts), experiment in zip(summaries.items(), experiments, strict=True):
        if display != Display():
            summaries[label] = shown_facts(facts, replace(experiment, display=display))
    states = {label: _state(facts, folders[label]) for label, facts in summaries.items()}
    names = dict.fromkeys(name for state in states.values() for name in state)
    rows = [row for facts in summaries.values() for row in facts["fixed"] + facts["parameters"]]
    for name in {row["name"] for row in rows}:
        if any(name not in state for state in states.values()):  # of another structure
            del names[name]
    differences = [n for n in names if len({state.get(n) for state in states.values()}) > 1]
    changes = {
        label: "; ".join(f"{n} {state[n]}" if n in state else f"no {n}" for n in differences)
        or "nothing" for label, state in states.items()
    }  # fmt: skip
    curves: Curves = {}
    for label, folder in folders.items():
        for response in shown_bounds(read_bounds(folder), display).responses:
            curves.setdefault(response.name, {})[label] = response
    facts = facts_of_cases(f"Comparison of {commas([*folders])}", folders, summaries, changes)
    return facts | {"curves": [_curve(rows, [*folders]) for rows in curves.values()]}, curves


def _folders(paths: Sequence[str | Path]) -> dict[str, Folder]:
    """Return folders of results by the labels that tell them apart."""
    for path in (path_by_folder := {Path(abspath(path)): str(path) for path in paths}).values():
        if len(path_by_folder) < max(len(paths), 2):
            text = "the same folder is given twice" if len(paths) > 1 else "nothing to compare"
            raise CampaignError(f"{path}: {text}; allowed: two different folders or more")
    labels = [path.name for path in path_by_folder]
    if len({*labels}) < len(labels):  # of the same campaign
        labels = [*path_by_folder.values()]
    folders = {label: Folder(Path(path)) for label, path in zip(labels, paths, strict=True)}
    for folder in folders.values():
        for name in ("summary.json", folder.plan.name, "bounds.nc"):
            if not (folder / name).exists():
                fault = f"has no {name}" if folder.path.is_dir() else "is not the path of a folder"
                text = f"{folder.path} {fault}; allowed: a folder of finished results"
                raise CampaignError(f"{text}, of a campaign with cases that of one case")
    return folders


def _state(facts: Mapping[str, Any], folder: Folder) -> dict[str, str]:
    """Describe by name what determines the results of a campaign in a folder."""
    state = {"structure": facts["scene"], "duration": quantity(facts["duration"], "s", 6)}
    for row in facts["fixed"]:
        is_number = isinstance(row["value"], int | float)
        state[row["name"]] = quantity(row["value"], row["units"], 6) if is_number else row["value"]
    for row in facts["parameters"]:
        state[row["name"]] = f"{quantity(row['nominal'], row['units'], 6)}, {spread(row)}"
    plan = read_json(folder.plan)
    sections = plan["config"] | facts.get("config", {})
    for section, keys in sections.items():
        is_said = section in ("name", "scene", "intervals", "display")  # above, or of no run
        for key, value in (keys if isinstance(keys, dict) else {"": keys}).items():
            if not is_said and key != "duration" and value not in (None, "", [], {}):
                is_file = key == "digest"  # stands beside the file's name
                name = f"checksum of {keys['file']}" if is_file else join_key(section, key)
                state[name] = re.sub("[\"'{}]", "", str(value))
    for row in facts.get("requirements", ()):
        texts = [sentence("limit", limit, escapes=False) for limit in row["limits"]]
        state[f"requirements.{row['name']}"] = " and ".join(texts)
    return state | {"bounds": facts["bounds"], "structure and code": plan["mechanics"]}


def _curve(rows: Mapping[str, ResponseBounds], labels: list[str]) -> dict[str, Any]:
    """Compare one response of several results: where its bounds are widest, and their distance from
    those of the first result that has the response."""
    first, by_case = next(iter(rows.values())), dict.fromkeys(labels, None)
    for label, response in rows.items():
        place, units = response.widest, response.units
        row = {"width": response.width[place], "time": response.time[place],
               "lower": response.lower.min(), "upper": response.upper.max()}  # fmt: skip
        if response is not first and (units, response.abscissa) == (first.units, first.abscissa):
            row |= _changes(first, response)
        by_case[label] = {name: float(value) for name, value in row.items()} | {"units": units}
    keys = {"name": first.name, "long_name": first.long_name, "units": first.units}
    return {**keys, "by_case": [*by_case.values()]}


def _changes(first: ResponseBounds, response: ResponseBounds) -> dict[str, float]:
    """Return the largest changes of both bounds at the `instants` that both have. Where that is the
    start alone, the others are interpolated, with an `interpolation_error` by second differences.
    """
    places = np.interp(first.time, response.time, np.arange(len(response.time)))
    gaps = np.abs(response.time[np.rint(places).astype(int)] - first.time)
    is_compared, row = gaps < 1e-9 * first.time[-1], {}
    if is_compared.sum() > 1:
        row["instants"] = is_compared.sum()
    else:
        is_compared = first.time <= response.time[-1]
        bends = np.diff([response.lower, response.upper], 2)
        row["interpolation_error"] = np.abs(bends).max(initial=0.0) / 8
    for end in ("lower", "upper"):
        curve = np.interp(first.time, response.time, getattr(response, end))
        change = np.abs(curve - getattr(first, end))[is_compared].max()
        row[f"{end}_change"] = change if change > 1e-12 * np.abs(curve).max() else 0.0
    return row
