"""The calibration's plan of scans, its checks, and its files: summary.json, table.md, plots."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from functools import cache
from pathlib import Path

import numpy as np

from campaign.files import write_text
from studies.calibration import (
    CLOSE,
    DURATION,
    PAPER,
    Numbers,
    Reading,
    Scan,
    default,
    grid,
    start_of_half_angle,
)
from studies.rows import Row, save, table

STARTS = (1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0)
MESHES = (8, 16, 32)
MU_B = 22.5
NEAR = grid(4.8, 7.2, 0.05)
COINCIDE = 0.05
UNITS = {"BD": "m", "vBz": "m/s"}
PAPER_SOURCE = "paper, section 4"
RIGID_SOURCE = "rigid linkage, one degree of freedom (verification/rigid_bennett.py)"
OWN_SOURCE = "this study"


def plan() -> list[tuple[Reading, np.ndarray]]:
    """Readings and the values of K_F (N/rad) of each scan; the default comes first."""
    wide, fine = grid(3.0, 8.0, 0.1), grid(4.8, 7.2, 0.025)
    readings = [(Reading("default"), np.union1d(wide, fine))]
    mesh, start = default("elements_per_link"), default("start_deg")
    readings += [
        (Reading(f"{n} elements a link", (("elements_per_link", n),)), NEAR)
        for n in MESHES
        if n != mesh
    ]
    readings += [
        (Reading(f"start {s:g}°", (("start_deg", s),)), NEAR) for s in STARTS if s != start
    ]
    readings.append((Reading("step × 0.5", (), 0.45), grid(5.2, 5.8, 0.05)))
    readings += [
        (Reading("A and C free", (("supports", "free"),)), grid(3.0, 7.0, 0.05)),
        (Reading("A pinned", (("supports", "pinned"),)), grid(3.0, 9.0, 0.1)),
    ]
    for label, angle in (("half", MU_B), ("whole", MU_B / 2)):
        begin = round(start_of_half_angle(angle), 6)
        reading = Reading(f"start at μ_B as {label} angle at B", (("start_deg", begin),))
        readings.append((reading, grid(1.0, 7.0, 0.1)))
    return readings


def row(name, value, reference, tolerance, source, note="", share=True) -> Row:
    """A line of summary.json: passes if the value is within the tolerance of the reference.

    tolerance: a share of the reference, or in the value's unit if not `share`.
    """
    allowed = tolerance * abs(reference) if share else tolerance
    passed = bool(abs(value - reference) <= allowed)
    return Row(name, float(value), float(reference), float(allowed), passed, source, note)


@cache
def rigid_closings(stiffness: float) -> np.ndarray:
    """Closing times (s) of the rigid linkage with this K_F (N/rad) in the time of the paper."""
    from verification.rigid_bennett import RigidBennett

    run = RigidBennett(spring_stiffness=stiffness).simulate(
        default("start_deg"), np.linspace(0.0, DURATION, 11), tolerance=1e-7
    )
    return run["closings"]


def checks(scans: list[Scan]) -> list[Row]:
    """The rows of summary.json. `scans` as planned, the default reading first."""
    main, k = scans[0], default("K_F")
    now, by_label = main.at(k), {scan.reading.label: scan for scan in scans}
    shut = [len(c) for c in now.closures]
    rows = [
        row(f"{n}: largest difference of the bounds ({UNITS[n]})", now.largest[n], PAPER[n], CLOSE,
            PAPER_SOURCE, f"at {now.at[n]:.4f} s")
        for n in PAPER
    ]  # fmt: skip
    rows += [
        row(f"closures in 1 s, {word} of the samples", value, 2, 0, PAPER_SOURCE)
        for word, value in (("fewest", min(shut)), ("most", max(shut)))
    ]
    rows += [
        row(f"{n}: largest difference before the first closure, share of the curve's range",
            now.early[n] / now.span[n], 0, COINCIDE, PAPER_SOURCE,
            f"{now.early[n]:.3g} {UNITS[n]}; the paper: the bounds coincide", share=False)
        for n in PAPER
    ]  # fmt: skip
    rows.append(
        row("K_F of the scene against the least misfit of the default reading, 4.8 to 6 N/rad", k,
            min((n for n in main.numbers if 4.8 <= n.K_F <= 6), key=lambda n: n.misfit).K_F,
            0.1, OWN_SOURCE, share=False)
    )  # fmt: skip
    for label, tolerance in ((f"{max(MESHES)} elements a link", 0.1), ("step × 0.5", 0.05)):
        other = by_label.get(label)
        if other:
            rows += [
                row(f"{n}: largest difference, default against {label} ({UNITS[n]})",
                    now.largest[n], other.at(k).largest[n], tolerance, OWN_SOURCE)
                for n in PAPER
            ]  # fmt: skip
    rigid, first = rigid_closings(k), now.closure(0).mean()
    rows.append(
        row("first closure, mean of the samples (s)", first, rigid[0], 0.02, RIGID_SOURCE,
            "the real links bend, the reference's do not")
    )  # fmt: skip
    scaled = np.array([n.closure(0).mean() * np.sqrt(n.K_F) for n in main.numbers])
    rows.append(
        row("first closure times √K_F, largest relative departure over the scan",
            np.abs(scaled / (first * np.sqrt(now.K_F)) - 1).max(), 0, 0.02,
            "rigid linkage: time scales with 1/√K_F until contact", share=False)
    )  # fmt: skip
    return rows


def findings(scans: list[Scan]) -> dict:
    """How sharp the fit is, and what explains it; numbers for summary.json and table.md."""
    main, k = scans[0], default("K_F")
    now = main.at(k)
    # All starts and meshes; the default reading was scanned more finely.
    near = [s for s in scans if np.array_equal(s.K_F, NEAR)]
    near.append(Scan(main.reading, [main.at(x) for x in NEAR]))
    share = np.mean([s.fits for s in near], axis=0)
    told = np.mean([s.fits & s.at_second_closure for s in near], axis=0)
    reached = [n.K_F for n in main.numbers if all(len(c) > 1 for c in n.closures)]
    around = [n for n in main.numbers if abs(n.K_F - k) <= 0.1 + 1e-9]
    ranges = {
        f"{name} for K_F within 0.1 N/rad of the scene's ({UNITS[name]})": [
            f([n.largest[name] for n in around]) for f in (min, max)
        ]
        for name in PAPER
    }
    first, second = now.closure(0), now.closure(1)
    return {
        "K_F of the scene (N/rad)": k,
        "misfit there": now.misfit,
        "least misfit": main.best.misfit,
        "K_F of the least misfit (N/rad)": main.best.K_F,
        "K_F with a misfit within 20 % of the least (N/rad)": spans(main.K_F, main.within(0.2)),
        "K_F that fits (N/rad)": spans(main.K_F, main.fits),
        "K_F that fits, largest differences at the second closure (N/rad)": spans(
            main.K_F, main.fits & main.at_second_closure
        ),
        "K_F that fits with at least 60 % of starts and meshes (N/rad)": spans(NEAR, share >= 0.6),
        "the same, largest differences at the second closure (N/rad)": spans(NEAR, told >= 0.6),
        "largest share of starts and meshes that fit": float(share.max()),
        "K_F of that (N/rad)": float(NEAR[share.argmax()]),
        "least K_F with the second closure of all samples within 1 s (N/rad)": min(
            reached, default=None
        ),
        "first closure of the samples (s)": [float(first.min()), float(first.max())],
        "second closure of the samples (s)": [float(second.min()), float(second.max())],
        "closings of the rigid linkage (s)": rigid_closings(k).tolist(),
        **ranges,
        "share of starts and meshes that fit, by K_F": {
            f"{x:g}": round(float(y), 3) for x, y in zip(NEAR, share, strict=True)
        },
    }


def spans(values: np.ndarray, where: np.ndarray) -> list[list[float]]:
    """Runs of neighbouring values at which `where` holds, each as [first, last]."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], where.astype(int), [0]])))
    return [
        [float(values[i]), float(values[j - 1])]
        for i, j in zip(edges[::2], edges[1::2], strict=True)
    ]


def as_record(scan: Scan) -> dict:
    """One reading for summary.json: its best fit, its fit at the scene's K_F, and all numbers."""

    def plain(n: Numbers) -> dict:
        return {
            "K_F": n.K_F,
            **{f"{name}_largest": n.largest[name] for name in PAPER},
            **{f"{name}_time": n.at[name] for name in PAPER},
            "misfit": n.misfit,
            "closures": [len(c) for c in n.closures],
        }

    return {
        "reading": scan.reading.label,
        "parameters": dict(scan.reading.parameters),
        "time_step": scan.numbers[0].step,
        "K_F_fitting": spans(scan.K_F, scan.fits),
        "best": plain(scan.best),
        "numbers": [plain(n) for n in scan.numbers],
    }


def tables(rows: list[Row], facts: dict, scans: list[Scan]) -> str:
    """table.md: the checks, the findings, and one line for each reading."""
    head = ("name", "value", "reference", "tolerance", "passed", "source", "note")
    k = default("K_F")
    columns = (
        "reading", "K_F scanned", "values that fit", "fits between", "best K_F", "BD", "vBz",
        "misfit", f"BD at {k:g}", f"vBz at {k:g}", f"second closure at {k:g} (s)",
    )  # fmt: skip
    return "\n".join(
        [
            "# Calibration of K_F\n",
            "## Checks\n",
            table(head, [[getattr(r, name) for name in head] for r in rows]),
            "## Findings\n",
            table(("finding", "value"), [(name, _pretty(x)) for name, x in facts.items()]),
            "## Readings\n",
            f"K_F in N/rad, BD in m, vBz in m/s. Fits: both numbers within {CLOSE:.0%} of the "
            "paper's (0.063 m, 4.38 m/s). Misfit: distance of the logarithms.\n",
            table(columns, [_line(s, k) for s in scans]),
        ]
    )


def _line(scan: Scan, k: float) -> tuple[str, ...]:
    best, now, fitting = scan.best, scan.at(k), scan.K_F[scan.fits]
    if not scan.K_F.min() <= k <= scan.K_F.max():
        raise ValueError(f"K_F = {k} N/rad of the scene is outside the scan of {scan.reading}")
    second = now.closure(1)
    late = f"{np.nanmin(second):.3f} to {np.nanmax(second):.3f}" if any(second > 0) else "none"
    return (
        scan.reading.label, f"{scan.K_F.min():g} to {scan.K_F.max():g}",
        f"{scan.fits.sum()} of {len(scan.fits)}",
        f"{fitting[0]:g} to {fitting[-1]:g}" if len(fitting) else "none", f"{best.K_F:g}",
        f"{best.largest['BD']:.4f}", f"{best.largest['vBz']:.2f}", f"{best.misfit:.2f}",
        f"{now.largest['BD']:.4f}", f"{now.largest['vBz']:.2f}", late,
    )  # fmt: skip


def _pretty(x: object) -> str:
    if isinstance(x, dict):
        return ", ".join(f"{key}: {_pretty(y)}" for key, y in x.items())
    if isinstance(x, list) and len(x) == 2 and not isinstance(x[0], list):
        return _pretty(x[0]) if x[0] == x[1] else f"{_pretty(x[0])} to {_pretty(x[1])}"
    if isinstance(x, list):
        return ", ".join(map(_pretty, x)) or "none"
    return f"{x:.4g}" if isinstance(x, (int, float)) else "none" if x is None else str(x)


def write(scans: list[Scan], folder: Path) -> None:
    """Leave plots, table.md and, last, summary.json in `folder`."""
    from studies import calibration_figures

    folder.mkdir(parents=True, exist_ok=True)
    rows, facts = checks(scans), findings(scans)
    draw: dict[str, Callable] = {
        "numbers": calibration_figures.numbers,
        "misfit": calibration_figures.misfit,
        "closures": calibration_figures.closures,
    }
    for name, function in draw.items():
        save(function(scans), folder / name)
    write_text(folder / "table.md", tables(rows, facts, scans))
    summary = {
        "study": "calibration",
        "rows": [asdict(r) for r in rows],
        "findings": facts,
        "readings": [as_record(s) for s in scans],
    }
    write_text(folder / "summary.json", json.dumps(summary, indent=1, allow_nan=False) + "\n")
