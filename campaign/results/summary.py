"""The headline numbers: `summary.json` for programs and `summary.md` for people."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from campaign.files import open_netcdf, write_result
from campaign.folder import Folder
from campaign.plan.plan import read_plan
from campaign.results.answers import answer_lines, answer_rows
from campaign.results.units import pretty


def summarise(
    folder: Folder, published: Mapping[str, float], requirements: bool = False, choice: bool = False
) -> str:
    """Write both summaries and return the text; `published` are largest differences by response.

    requirements, choice: whether these were asked for, and are to be told too.
    """
    with open_netcdf(folder.bounds) as bounds, open_netcdf(folder.samples) as samples:
        summary = headline(bounds, samples, published)
        asked = "quantities" in samples.variables
    if asked:
        summary |= answer_rows(folder, requirements, choice)
    rounds = read_plan(folder.plan).adaptive
    if rounds is not None:
        summary["adaptive"] = {"rounds": [asdict(r) for r in rounds.rounds], "met": rounds.met}
    text = as_text(summary)
    write_result(folder / "summary.json", json.dumps(summary, indent=2) + "\n")
    write_result(folder / "summary.md", text)
    return text


def headline(bounds: Any, samples: Any, published: Mapping[str, float]) -> dict:
    """The headline numbers as plain numbers and text, from the open `bounds.nc`, `samples.nc`."""
    roles = list(samples["role"][:])
    names = list(bounds["response"][:])
    parameters = [
        {
            "name": name,
            "lower": float(low),
            "nominal": float(middle),
            "upper": float(high),
        }
        for name, low, middle, high in zip(
            bounds["parameter"][:],
            bounds["box_lower"][:],
            bounds["box_nominal"][:],
            bounds["box_upper"][:],
            strict=True,
        )
    ]
    return {
        "campaign": bounds.campaign,
        "scene": bounds.scene,
        "config_hash": bounds.config_hash,
        "parameters": parameters,
        "design": {
            "method": bounds.design_method,
            "order": np.atleast_1d(bounds.design_order).tolist(),
            "nodes": roles.count("node"),
            "held_out": roles.count("held_out"),
            "runs": len(set(samples["run_id"][:])),
        },
        "bounds": bounds_text(bounds),
        "time_step": float(bounds.time_step),
        "closures": closures(samples, roles.index("nominal")),
        "responses": [
            _response(bounds, i, name, published.get(name)) for i, name in enumerate(names)
        ],
    }


def bounds_text(bounds: Any) -> str:
    """What the bounds in the open `bounds.nc` are, and whether they enclose it."""
    kind = bounds.bounds_kind
    return f"{kind}, not enclosed" if kind.startswith("attained") else kind


def _response(bounds: Any, i: int, name: str, published: float | None) -> dict:
    time, lower, upper = bounds["time"][:], bounds["lower"][i], bounds["upper"][i]
    width = upper - lower
    at = int(width.argmax())
    row = {
        "name": name,
        "long_name": bounds["response_long_name"][i],
        "units": bounds["response_units"][i],
        "largest_difference": float(width[at]),
        "time_of_largest_difference": float(time[at]),
        "published": published,
        "ratio_to_published": None if not published else float(width[at] / published),
        "mean_difference": float(np.trapezoid(width, time) / (time[-1] - time[0])),
    }
    if "error" in bounds.variables:
        error = bounds["error"][i]
        worst = int(error.argmax())
        row["largest_error"] = float(error[worst])
        row["time_of_largest_error"] = float(time[worst])
        row["error_at_largest_difference"] = float(error[at])
    if "worst_violation" in bounds.variables:
        row["runs_outside_by"] = float(bounds["worst_violation"][i])
    return row


def closures(samples: Any, run: int) -> list[dict]:
    """Contacts of one run that close: time (s) and name of the contact, in order of time."""
    names = list(samples["contact"][:])
    keys = ("event_time", "event_closing", "event_contact")
    time, closing, contact = (samples[key][run] for key in keys)
    rows = [
        {"time": float(t), "contact": names[int(c)]}
        for t, shut, c in zip(time, closing, contact, strict=True)
        if np.isfinite(t) and shut == 1
    ]
    return sorted(rows, key=lambda row: row["time"])


def as_text(summary: Mapping) -> str:
    """The summary as Markdown."""
    design = summary["design"]
    order = "" if not any(design["order"]) else f" of order {max(design['order'])}"
    lines = [
        f"# {summary['campaign']}",
        "",
        f"Scene {summary['scene']}; {design['method']}{order}: {design['runs']} runs "
        f"({design['nodes']} nodes, {design['held_out']} held out, the nominal run); "
        f"time step {summary['time_step']:.4g} s.",
        "",
        f"Bounds: {summary['bounds']}.",
        "",
        "| parameter | lower | nominal | upper |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| {p['name']} | {p['lower']:.6g} | {p['nominal']:.6g} | {p['upper']:.6g} |"
        for p in summary["parameters"]
    ]
    lines += [
        "",
        "| response | largest difference of the bounds | at (s) | error estimate there | published "
        "| ours / published |",
        "|---|---|---|---|---|---|",
    ]
    for row in summary["responses"]:
        published, ratio = row["published"], row["ratio_to_published"]
        lines.append(
            f"| {row['name']} | {row['largest_difference']:.4g} {pretty(row['units'])} "
            f"| {row['time_of_largest_difference']:.4f} "
            f"| {_quantity(row, 'error_at_largest_difference')} "
            f"| {'' if published is None else f'{published:.4g} ' + pretty(row['units'])} "
            f"| {'' if ratio is None else f'{ratio:.2f}'} |"
        )
    lines += ["", _error_line(summary)]
    outside = [row for row in summary["responses"] if row.get("runs_outside_by", 0.0) > 0.0]
    if outside:
        parts = [f"{row['name']} {_quantity(row, 'runs_outside_by')}" for row in outside]
        lines += ["", f"Runs that were not fitted leave the bounds by at most: {', '.join(parts)}."]
    if "adaptive" in summary:
        rounds = summary["adaptive"]["rounds"]
        lines += ["", f"Order found in {len(rounds)} rounds: {rounds[-1]['reason']}."]
    if "quantities" in summary:
        lines += answer_lines(summary)
    if summary["closures"]:
        lines += ["", f"Contacts that close in the nominal run: {_closure_text(summary)}."]
    return "\n".join(lines) + "\n"


def _closure_text(summary: Mapping, most: int = 8) -> str:
    """`A and C at 0.3251 s, ...`, the first `most` moments."""
    moments: dict[str, list[str]] = {}
    for row in summary["closures"]:
        moments.setdefault(f"{row['time']:.4f} s", []).append(row["contact"])
    texts = [f"{' and '.join(names)} at {time}" for time, names in moments.items()]
    more = [f"and {len(texts) - most} later moments"] if len(texts) > most else []
    return ", ".join(texts[:most] + more)


def _quantity(row: Mapping, key: str) -> str:
    """The number of a row with two digits and its unit; nothing if there is none."""
    return "" if row.get(key) is None else f"{row[key]:.2g} {pretty(row['units'])}"


def _error_line(summary: Mapping) -> str:
    rows = [row for row in summary["responses"] if "largest_error" in row]
    if not rows:
        return "Error estimate: none; the bounds are the least and the largest of the samples."
    parts = [
        f"{row['name']} {row['largest_error']:.2g} {pretty(row['units'])} "
        f"(at {row['time_of_largest_error']:.3f} s)"
        for row in rows
    ]
    return "Error estimate of the bounds, largest: " + ", ".join(parts) + "."
