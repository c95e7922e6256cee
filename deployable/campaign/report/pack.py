"""Data as the page's script takes them, compress: JSON, and the arrays that it points to.

Bounds stay in double precision, thin lines are single. Long curves are thinned, their extremes are
kept. Each moving run is the glTF file of `pictures.glb`."""

import base64
import gzip
import json
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from deployable.campaign.pictures.glb import glb_of
from deployable.campaign.report.read import PageData
from deployable.campaign.results.quantity_results import number
from deployable.campaign.results.response_bounds import UNSURE, ResponseBounds
from deployable.campaign.text.numbers import pretty
from deployable.intervals.chebyshev import Formula
from deployable.intervals.scalars.fits import choose_fit

MOST_INSTANTS = 4001  # instants of a curve from which it is thinned

MOST_COEFFICIENTS = 150_000  # coefficients of polynomials over time up to which sliders move curves

_PARAMETER = "name", "units", "lower", "nominal", "upper", "description"
_LEAST_MISFIT = 0.01  # bands, below which it makes no difference

PAGE = 2_450_000
"""Characters of the data by which a page stays below 3 MB, with what it shows them by."""


class _Arrays:
    """Arrays one after the other."""

    def __init__(self) -> None:
        self.data = bytearray()

    def add(self, values: np.ndarray, kind: str) -> dict[str, Any]:
        """Append an array's bytes and return their place as a dict for the page's script: kind, at
        (first byte), count (of numbers). kind: numpy's little-endian type, such as `f4`."""
        raw = np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<"))
        entry = {"kind": kind, "at": len(self.data), "count": raw.size}
        self.data += raw.tobytes() + b"\0" * (-raw.nbytes % 8)
        return entry


def compress(raw: bytes) -> str:
    """Compress bytes as base64 text of gzip for the page's script; equal bytes give equal text."""
    return base64.b64encode(gzip.compress(raw, 6, mtime=0)).decode()


def pack_data(data: PageData) -> str:
    """Pack all data of the page's script as one text (base64 of gzip). Frames are left out of the
    motions until it has at most `PAGE` characters (2.45 million)."""
    count = max((motion.sizes["time"] for motion in data.moving.values()), default=0)
    text = _pack(data, None)
    while len(text) > PAGE and count > 2:
        count = max(2, int(0.97 * count * min(0.97, PAGE / len(text))))
        text = _pack(data, count)
    return text


def _pack(data: PageData, frames: int | None) -> str:
    arrays = _Arrays()
    content = json.dumps(payload(data, arrays, frames), separators=(",", ":"), allow_nan=False)
    raw = content.encode()
    return compress(np.uint32(len(raw)).tobytes() + raw + bytes(arrays.data))


def thin_curves(curves: Sequence[np.ndarray], most: int = MOST_INSTANTS) -> np.ndarray:
    """Choose about `most` instants (or all, if there are fewer) at which curves are drawn, with the
    extremes of every curve. curves: arrays (T); returns increasing indices."""
    count = len(curves[0])
    if count <= most:
        return np.arange(count)
    keep = {0, count - 1}
    for part in np.array_split(np.arange(count), max(1, most // (2 * len(curves)))):
        for curve in curves:
            keep.update((part[curve[part].argmin()], part[curve[part].argmax()]))
    for curve in curves:
        keep.update((int(curve.argmin()), int(curve.argmax())))
    return np.array(sorted(keep))


def payload(data: PageData, arrays: _Arrays, frames: int | None = None) -> dict[str, Any]:
    """Make the page's data as a dict for JSON, in which a dict of kind, offset and count stands for
    each array in `arrays`. frames: number kept of each motion; None: all."""
    bounds = [c for r in data.responses for c in (r.lower, r.upper, r.upper - r.lower)]
    keep, scales = thin_curves(bounds), [parameter["scale"] for parameter in data.parameters]
    visible_runs = {0, *data.moving}
    return {
        "unsure": UNSURE,
        "metre": data.facts["metre"],
        "time": arrays.add(data.time[keep], "f8"),
        "parameters": [
            {"unit": pretty(p["units"]), **{key: p[key] for key in _PARAMETER}}
            for p in data.parameters
        ],
        "responses": [_response(r, data, keep, arrays) for r in data.responses],
        "runs": [
            {"id": run.id, "values": (run.values * scales).tolist(),
             "events": [*run.events] if i in visible_runs else []}
            for i, run in enumerate(data.runs)
        ],
        "whatIf": _what_if(data, keep, arrays),
        "judged": {
            key: arrays.add(getattr(data.verdicts, key), kind)
            for key, kind in (("values", "f8"), ("numbers", "f8"), ("met", "u1"))
        } if data.verdicts else None,
        "lines": [_line(data, run, keep, arrays) for run in data.lines],
        "moving": [
            _line(data, i, keep, arrays) | {"label": data.runs[i].label} for i in data.moving
        ],
        "motion": _motion([*data.moving.values()], frames, arrays) if data.moving else None,
    }  # fmt: skip


def _response(
    bounds: ResponseBounds, data: PageData, keep: np.ndarray, arrays: _Arrays
) -> dict[str, Any]:
    row: dict[str, Any] = {"name": bounds.name, "longName": bounds.long_name}
    row |= {"unit": pretty(bounds.units), "along": bounds.abscissa}
    row["widest"] = float(data.time[bounds.widest])
    for key in ("least", "most"):
        row[key] = number(getattr(bounds, key))
    for key in ("lower", "upper", "nominal", "error"):
        values = getattr(bounds, key)
        row[key] = None if values is None else arrays.add(values[..., keep], "f8")
    return row


def _what_if(data: PageData, keep: np.ndarray, arrays: _Arrays) -> dict[str, Any] | None:
    """Pack the fits for the page; constants of polynomials, most of their values, as doubles."""
    if (model := data.what_if) is None:
        return None
    rows = [row for row in data.facts["quantities"] if row["name"] in model.quantities]
    body: dict[str, Any] = {
        "quantities": [_quantity(row, model.quantities[row["name"]], arrays) for row in rows]
    }
    requirements, keys = data.facts.get("requirements", ()), ("quantity", "kind", "level")
    limits = [(row["name"], limit) for row in requirements for limit in row["limits"]]
    body["limits"] = [{"of": name, **{key: limit[key] for key in keys}} for name, limit in limits]
    if model.choice_intervals:
        body["choice"] = {
            "kept": data.facts["choice"]["kept"],
            "parameters": _choice_parameters(data),
            "quantities": [
                _quantity(row | {"error": surrogate.error * row["scale"]}, surrogate, arrays)
                for row in rows
                for surrogate in [model.choice_quantities[row["name"]]]
            ],
        }
    if measured := data.facts.get("measured"):  # what the tests leave, by name, and misfits
        body["left"] = {row["name"]: row["after"] for row in measured["parameters"]}
        points, misfits = map(np.array, measured["misfits"].values())
        fit = choose_fit(points, np.log(np.maximum(misfits, _LEAST_MISFIT)))
        body["misfit"] = _table(fit.formula(), arrays)  # its logarithm
    if model.coefficients is None or model.coefficients[..., keep].size > MOST_COEFFICIENTS:
        return body
    constant = ~model.indices.any(axis=1)
    coefficients = [c * r.scale for c, r in zip(model.coefficients, data.responses, strict=True)]
    sums = [c[constant][:, keep].sum(axis=0) for c in coefficients]
    products = [c[~constant][:, keep] for c in coefficients]
    body |= {"constants": [arrays.add(row, "f8") for row in sums]}
    body |= {"slopes": [[arrays.add(row, "f4") for row in rows] for rows in products]}
    return body | {"indices": model.indices[~constant].tolist()}


def _choice_parameters(data: PageData) -> list[dict[str, Any]]:
    """Return the parameters of the sliders with a choice: those of the box, then others that are
    chosen, each with what the choice's runs span and, if it is chosen, the best `value`."""
    values = {p["name"]: p["value"] for p in data.facts["choice"]["parameters"]}
    rows = {p["name"]: p for p in (*data.facts["fixed"], *data.parameters)}
    return [
        {"name": name, "unit": pretty(rows[name]["units"]),
         "lower": lower * rows[name]["scale"], "upper": upper * rows[name]["scale"],
         "description": rows[name]["description"]}
        | {"nominal": rows[name].get("nominal", rows[name].get("value"))}
        | ({"value": values[name]} if name in values else {})
        for name, (lower, upper) in data.what_if.choice_intervals.items()
    ]  # fmt: skip


def _table(formula: Any, arrays: _Arrays) -> Any:
    if not isinstance(formula, Formula):
        return formula
    numbers = ("coefficients", "points", "scales", "weights")
    root = {"root": _table(formula.root, arrays), "root_scale": formula.root_scale}
    columns = {key: arrays.add(getattr(formula, key), "f8") for key in numbers}
    return {"indices": formula.indices.tolist(), "kernel": formula.kernel, **root, **columns}


def _quantity(row: dict[str, Any], surrogate: Any, arrays: _Arrays) -> dict[str, Any]:
    value, happens = surrogate.formulas()
    scale, least = row["scale"], surrogate.least
    if value:
        columns = {key: getattr(value, key) * scale for key in ("coefficients", "weights")}
        value = replace(value, **columns)
    least = None if least is None else least * scale
    numbers = {"least": least, "latest": surrogate.latest, "error": row["error"]}
    numbers = {k: None if x is None else number(x) for k, x in numbers.items()}
    words = {"name": row["name"], "unit": pretty(row["units"])}
    words |= {"words": row.get("words", row["long_name"]).replace("`", "")}
    return words | numbers | {"value": _table(value, arrays), "there": _table(happens, arrays)}


def _line(data: PageData, run: int, keep: np.ndarray, arrays: _Arrays) -> dict[str, Any]:
    curves = zip(data.runs[run].curves, data.responses, strict=True)
    return {"run": run, "curves": [arrays.add(c[keep] * r.scale, "f4") for c, r in curves]}


def _motion(clips: list[Any], frames: int | None, arrays: _Arrays) -> dict[str, Any]:
    """Return whole motions as glTF files, and what their colours have in common."""
    if frames:
        indices = (np.linspace(0, m.sizes["time"] - 1, frames).round().astype(int) for m in clips)
        clips = [m.isel(time=np.unique(index)) for m, index in zip(clips, indices, strict=True)]

    def largest(name: str) -> float:
        return max((float(m[name].max()) for m in clips if name in m and m[name].size), default=0.0)

    files = (np.frombuffer(glb_of(motion, small=True), np.uint8) for motion in clips)
    return {
        "largestStress": largest("stress"),
        "largestTension": largest("cable_tension"),
        "runs": [arrays.add(file, "u1") for file in files],
    }
