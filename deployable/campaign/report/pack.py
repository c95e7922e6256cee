"""Data as the page's script takes them: JSON with arrays in base64, as small as looks the same.

Bounds stay in double precision, thin lines are single; positions and rotations are whole numbers of
16 bits (a hundredth of a millimetre on a metre). Long curves are thinned, their extremes are kept.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from deployable.campaign.report.data import MovingRun, PageData
from deployable.campaign.report.motions import MOST_NUMBERS
from deployable.fpm.bars import bar_of

MOST_INSTANTS = 4001
"""Instants of a curve from which it is thinned."""

MOST_TOLD = 300
"""Runs up to which the contact events of all are in the page, not only of those that are drawn."""

PAGE = 4_850_000
"""Characters of the data by which a page stays below 5 MB."""

LEAST_NUMBERS = 200_000
"""Numbers of the motion that a page has however large all else is."""


def packed(values: np.ndarray, kind: str) -> dict[str, Any]:
    """An array for the script; kind is a little-endian numpy type, e.g. `f4`."""
    raw = np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<"))
    return {"kind": kind, "data": base64.b64encode(raw.tobytes()).decode()}


def thinned(curves: Sequence[np.ndarray], most: int = MOST_INSTANTS) -> np.ndarray:
    """Indices of at most about `most` instants, with the extremes of all curves (t,) among them."""
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


def payload(data: PageData) -> dict[str, Any]:
    """All that the page's script needs."""
    bounds = [c for r in data.responses for c in (r.lower, r.upper, r.upper - r.lower)]
    keep = thinned(bounds)
    found = {
        "campaign": data.campaign,
        "time": packed(data.time[keep], "f8"),
        "parameters": [
            {"name": p.name, "units": p.units, "lower": p.lower, "nominal": p.nominal,
             "upper": p.upper}
            for p in data.parameters
        ],
        "responses": [
            {
                "name": r.name, "longName": r.long_name, "units": r.units,
                "widest": float(data.time[r.widest]),
                **{
                    key: None if values is None else packed(values[..., keep], "f8")
                    for key, values in (
                        ("lower", r.lower), ("upper", r.upper), ("nominal", r.nominal),
                        ("error", r.error),
                    )
                },
                "widths": None if r.widths is None else [packed(w[keep], "f4") for w in r.widths],
            }
            for r in data.responses
        ],
        "runs": _runs(data),
        "lines": [_line(data, run, keep) for run in data.lines],
        "moving": [_line(data, m.run, keep) | {"label": m.label} for m in data.moving],
    }  # fmt: skip
    room = (PAGE - len(json.dumps(found))) * 3 // 8  # numbers of 16 bits in base64
    most = int(np.clip(room, LEAST_NUMBERS, MOST_NUMBERS))
    return found | {"motion": _motion(data.moving, most) if data.moving else None}


def _runs(data: PageData) -> list[dict[str, Any]]:
    drawn = {0, *(moving.run for moving in data.moving)}
    return [
        {
            "id": run.id,
            "role": run.role,
            "values": run.values.tolist(),
            "events": [
                {"time": e.time, "contact": e.contact, "closing": e.closing}
                for e in run.events
                if len(data.runs) <= MOST_TOLD or i in drawn
            ],
        }
        for i, run in enumerate(data.runs)
    ]


def _line(data: PageData, run: int, keep: np.ndarray) -> dict[str, Any]:
    return {"run": run, "curves": [packed(c[keep], "f4") for c in data.runs[run].curves]}


def _motion(moving: Sequence[MovingRun], most: int) -> dict[str, Any]:
    """The moving runs: shared frames and connectivity, and each run's numbers, about `most`."""
    first = moving[0].motion
    numbers = len(moving) * (7 * first.sizes["particle"] + first.sizes["element"])
    count = first.sizes["time"]
    frames = np.arange(count)
    if numbers * count > most:
        wanted = max(2, most // numbers)
        frames = np.unique(np.linspace(0, count - 1, wanted).round().astype(int))
    places = np.stack([m.motion["position"].values for m in moving])
    low = places.min(axis=(0, 1, 2))
    size = float((places.max(axis=(0, 1, 2)) - low).max()) or 1.0
    stress = max((float(m.motion["largest_stress"].max()) for m in moving if numbers), default=0.0)
    return {
        "time": packed(first["time"].values[frames], "f8"),
        "particles": first.sizes["particle"],
        "elements": first.sizes["element"],
        "ends": packed(first["element_particle"].values, "i4"),
        "bar": _bars(first["element"].values),
        "points": first["point"].values.tolist(),
        "pointOn": packed(first["point_particle"].values, "i4"),
        "pointArm": packed(first["point_arm"].values, "f4"),
        "hinges": first["hinge"].values.tolist(),
        "hingeOn": packed(first["hinge_particle"].values[:, :1], "i4"),
        "hingeArm": packed(first["hinge_arm"].values, "f4"),
        "hingeAxis": packed(first["hinge_axis"].values, "f4"),
        "cables": _cables(moving),
        "low": low.tolist(),
        "unit": size / 65534,
        "largestStress": stress,
        "runs": [
            _frames(m, frames, low, size / 65534, stress) | _tensions(moving, m, frames)
            for m in moving
        ],
    }


def _cables(moving: Sequence[MovingRun]) -> dict[str, Any] | None:
    """The points of all cables one after the other, and the largest tension of all runs."""
    first = moving[0].motion
    if "cable" not in first.sizes:
        return None
    return {
        "count": first.sizes["cable"],
        "of": first["cable_point_cable"].values.tolist(),
        "on": packed(first["cable_point_particle"].values, "i4"),
        "arm": packed(first["cable_point_arm"].values, "f4"),
        "most": max(float(m.motion["cable_tension"].max()) for m in moving),
    }


def _bars(names: np.ndarray) -> list[int]:
    """For each element the index of its bar: `link AB[3]` belongs to `link AB`."""
    bars: dict[str, int] = {}
    return [bars.setdefault(bar_of(str(name)), len(bars)) for name in names]


def _tensions(moving: Sequence[MovingRun], one: MovingRun, frames: np.ndarray) -> dict[str, Any]:
    """Tension of each cable as a share of the largest of all runs; 0 is slack."""
    if "cable" not in one.motion.sizes:
        return {}
    most = max(float(m.motion["cable_tension"].max()) for m in moving) or 1.0
    share = one.motion["cable_tension"].values[frames] / most
    return {"tension": packed(np.ceil(65535 * np.clip(share, 0, 1)), "u2")}


def _frames(moving: MovingRun, frames, low, unit, stress) -> dict[str, Any]:
    from scipy.spatial.transform import Rotation

    motion = moving.motion
    turned = motion["frame"].values[frames]
    quaternion = Rotation.from_matrix(turned.reshape(-1, 3, 3)).as_quat(canonical=True)
    place = np.rint((motion["position"].values[frames] - low) / unit) - 32767
    share = motion["stress"].values[frames] / (stress or 1.0)
    return {
        "place": packed(place, "i2"),
        "turn": packed(np.rint(32767 * quaternion), "i2"),
        "stress": packed(np.rint(65535 * np.clip(share, 0, 1)), "u2"),
        "corners": packed(motion["section_corner"].values, "f4"),
        "worst": float(motion["largest_stress"].max()) if motion.sizes["element"] else 0.0,
    }
