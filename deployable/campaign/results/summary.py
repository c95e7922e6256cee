"""The headline numbers: `summary.json` for programs and `summary.md` for people."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from deployable.campaign.files import open_netcdf, write_result
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.results.answers import answer_lines, answer_rows
from deployable.campaign.results.budget import (
    accuracy_facts,
    accuracy_lines,
    error_lines,
    foretold_text,
    response_errors,
)
from deployable.campaign.results.scan_words import known_error, scan_facts, scan_text
from deployable.campaign.results.units import pretty
from deployable.campaign.results.which import counts, nominal_row
from deployable.campaign.results.words import doubt_mark, doubt_texts, escaped, runs_text


def summarise(
    folder: Folder, published: Mapping[str, float], requirements: bool = False, choice: bool = False
) -> str:
    """Write both summaries and return the text; `published` are largest differences by response.

    requirements, choice: whether these were asked for, and are to be told too.
    """
    with open_netcdf(folder.bounds) as bounds, open_netcdf(folder.samples) as samples:
        summary = headline(bounds, samples, published)
        if scan := scan_facts(bounds):
            summary["scan"] = scan
        asked = "quantities" in samples.variables
    if asked:
        summary |= answer_rows(folder, requirements, choice)
    plan = read_plan(folder.plan)
    if (rounds := plan.adaptive) is not None:
        summary["adaptive"] = {"rounds": [asdict(r) for r in rounds.rounds]}
    rows = _rows(summary)
    if plan.experiment.is_sought:
        for row in rows:
            row["errors"]["asked"] = plan.experiment.accuracy.shares[row["name"]]
        summary["accuracy"] = accuracy_facts(plan, rows)
    for row in rows:
        if row["name"] in plan.experiment.doubts:
            row["doubt"] = plan.experiment.doubts[row["name"]]
    summary["runs"] = _run_counts(summary)
    text = as_text(summary)
    write_result(folder / "summary.json", json.dumps(summary, indent=2) + "\n")
    write_result(folder / "summary.md", text)
    return text


def _rows(summary: Mapping) -> list[dict]:
    """What a summary tells of responses and quantities, together."""
    return [*summary["responses"], *summary.get("quantities", [])]


def _run_counts(summary: dict) -> dict[str, int]:
    """How many runs were made, by what for, and in `all`."""
    found = {"design": summary["design"]["runs"], "further": summary.pop("further_runs", 0)}
    found["choice"] = summary.get("choice", {}).get("runs", 0)
    sought = summary.get("accuracy", {}).get("runs", 0)  # those of its checks among them
    found["checks"] = max(0, sought - found["design"] - found["further"])
    return {**found, "all": sum(found.values())}


def headline(bounds: Any, samples: Any, published: Mapping[str, float]) -> dict:
    """The headline numbers as plain numbers and text, from the open `bounds.nc`, `samples.nc`."""
    found = counts(samples)
    names = list(bounds["response"][:])
    parameters = [
        {
            "name": name,
            "units": unit,
            "lower": float(low),
            "nominal": float(middle),
            "upper": float(high),
        }
        for name, unit, low, middle, high in zip(
            bounds["parameter"][:],
            bounds["box_units"][:],
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
            "nodes": found.nodes,
            "held_out": found.held_out,
            "runs": found.runs,
            "nominal_among_them": found.nominal_among_them,
        },
        "bounds": bounds_text(bounds),
        "time_step": float(bounds.time_step),
        "overlap": float(samples["overlap"][:].max()),
        "assembly_energy": float(getattr(samples, "assembly_energy", 0.0)),
        "closures": closures(samples, nominal_row(samples)),
        "responses": [
            _response(bounds, i, name, published.get(name)) for i, name in enumerate(names)
        ],
    }


def bounds_text(bounds: Any) -> str:
    """What the bounds in the open `bounds.nc` are, and that they promise nothing of a structure."""
    return kind_text(bounds.bounds_kind)


_ESTIMATE = "an estimate of the simulated model's range"


def kind_text(kind: str) -> str:
    """The same for a kind of bounds."""
    if kind.startswith("enclosed"):
        return f"{kind.removeprefix('enclosed ')} fitted to the runs, {_ESTIMATE}"
    if kind.startswith("attained"):
        return f"{kind}, not enclosed, {_ESTIMATE}"
    return f"{kind}; runs that were not made may lie outside"


def outside_text(bounds: Any, i: int) -> str:
    """Which share of the runs that were not fitted leaves the bounds of response `i`, in words."""
    if "coverage" not in bounds.variables or not np.isfinite(bounds["coverage"][i]):
        return ""
    share = 1.0 - float(bounds["coverage"][i])
    told = "none" if share <= 0 else "less than 1 %" if share < 0.01 else f"{share:.0%}"
    return f"{told} of the instants of the runs that were not fitted lie outside"


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
        row["largest_error"] = known_error(bounds.bounds_kind, float(error[worst]))
        row["time_of_largest_error"] = float(time[worst])
        row["error_at_largest_difference"] = known_error(bounds.bounds_kind, float(error[at]))
        if foretold := foretold_text(bounds, i, at):
            row["foretold"] = foretold
    if "growth_quarter" in bounds.variables:
        row["largest_growth_quarter"] = float(bounds["growth_quarter"][i].max())
    if "worst_violation" in bounds.variables:
        row["runs_outside_by"] = float(bounds["worst_violation"][i])
        row["outside"] = outside_text(bounds, i)
    if errors := response_errors(bounds, i):
        row["errors"] = errors
    row["impossible_by"] = float(bounds["largest_impossible"][i])
    row["time_of_impossible"] = float(bounds["largest_impossible_time"][i])
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
    design, rows = summary["design"], summary["responses"]
    told = f"In all {runs_text(summary['runs'])}"
    if "accuracy" not in summary and any("step" in row.get("errors", {}) for row in rows):
        told += "; some were repeated on top to check step and mesh"
    order = "" if not any(design["order"]) else f" of order {max(design['order'])}"
    lines = [
        f"# {summary['campaign']}",
        "",
        f"Scene {escaped(summary['scene'])}; {design['method']}{order}: {design['runs']} runs "
        f"({_runs_text(design)}); time step {summary['time_step']:.4g} s.",
        *([] if told == f"In all {design['runs']} runs" else ["", f"{told}."]),
        "",
        f"Bounds: {summary['bounds']}.",
        "",
        "| parameter | lower | nominal | upper | unit |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| {escaped(p['name'])} | {p['lower']:.6g} | {p['nominal']:.6g} | {p['upper']:.6g} "
        f"| {escaped(pretty(p['units']))} |"
        for p in summary["parameters"]
    ]
    lines += ["", *_response_table(rows), "", _error_line(summary)]
    if "scan" in summary:
        parts = [(row["name"], _quantity(row, "largest_growth_quarter")) for row in rows]
        lines += ["", scan_text(summary["scan"], [" ".join(part) for part in parts])]
    if summary["assembly_energy"] > 0:
        lines += ["", (
            "Parts are forced together before the start, which leaves a strain energy of up to "
            f"{summary['assembly_energy']:.3g} J at the centre and the corners of the box."
        )]  # fmt: skip
    lines += _doubts(summary)
    if "accuracy" in summary:
        lines += accuracy_lines(summary["accuracy"], _rows(summary))
    if "quantities" in summary:
        lines += answer_lines(summary)
    lines += error_lines(_rows(summary))
    if summary["closures"]:
        what = "Contacts, stops and latches that close in the nominal run"
        lines += ["", f"{what}: {_closure_text(summary)}."]
    return "\n".join(lines) + "\n"


def _runs_text(design: Mapping) -> str:
    """`21 nodes, 3 held out, the nominal run`; they add up to the number of runs."""
    parts = [f"{design['nodes']} nodes"]
    parts += [f"{design['held_out']} held out"] * (design["held_out"] > 0)
    among = " among them" * design["nominal_among_them"]
    return ", ".join([*parts, f"the nominal run{among}"])


def _response_table(rows: list[dict]) -> list[str]:
    """The table of the responses, with the published numbers if there are any."""
    compared = any(row["published"] is not None for row in rows)
    head = ["response", "largest difference of the bounds", "at (s)", "error estimate there"]
    head += ["published", "ours / published"] * compared
    lines = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    for row in rows:
        unit, published = pretty(row["units"]), row["published"]
        cells = [
            row["name"],
            f"{row['largest_difference']:.4g} {unit}",
            f"{row['time_of_largest_difference']:.4f}",
            (_quantity(row, "error_at_largest_difference") or "unknown") + doubt_mark(row),
        ]
        if compared and published is None:
            cells += ["", ""]
        elif compared:
            ratio = row["ratio_to_published"]  # none to a published difference of 0
            cells += [f"{published:.4g} {unit}", "" if ratio is None else f"{ratio:.2f}"]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


SOFT = 0.05
"""Overlap (rad) from which faces that touch are said to pass through each other."""


def _doubts(summary: Mapping) -> list[str]:
    """What speaks against the bounds, a paragraph each."""
    rows = summary["responses"]
    own = {r["name"]: r["doubt"] for r in _rows(summary) if "doubt" in r}
    lines = [line for text in doubt_texts(own) for line in ("", f"{text}.")]
    if told := [row for row in rows if row.get("outside")]:
        parts = [
            f"{row['name']}: {row['outside']}"
            + (f", by at most {_quantity(row, 'runs_outside_by')}" * (row["runs_outside_by"] > 0))
            for row in told
        ]
        lines += ["", f"How the bounds fail: {'; '.join(parts)}."]
    for row in rows:
        if "foretold" in row:
            lines += ["", f"The error of {row['name']} where it differs most: {row['foretold']}."]
        if row["impossible_by"] > 0:
            lines += ["", (
                f"The curve fitted to {row['name']} falls up to {_quantity(row, 'impossible_by')} "
                f"below what is possible (at {row['time_of_impossible']:.4f} s); the bound is what "
                "is possible."
            )]  # fmt: skip
    if summary["overlap"] > SOFT:
        lines += ["", (
            f"Faces that touch pass through each other by up to {summary['overlap']:.2g} rad: "
            "the contacts are too soft to be contacts, and what follows a closure means little."
        )]  # fmt: skip
    return lines


def _closure_text(summary: Mapping, most: int = 8) -> str:
    """`A and C at 0.3251 s, ...`, the first `most` moments."""
    moments: dict[str, list[str]] = {}
    for row in summary["closures"]:
        names = moments.setdefault(f"{row['time']:.4f} s", [])
        names += [row["contact"]] * (row["contact"] not in names)
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
        f"{row['name']} unknown"
        if row["largest_error"] is None
        else f"{row['name']} {_quantity(row, 'largest_error')} "
        f"(at {row['time_of_largest_error']:.3f} s)"
        for row in rows
    ]
    return "Error estimate of the bounds, largest: " + ", ".join(parts) + "."
