"""The study that fits K_F: its parts, its records, its tables."""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import partial

import numpy as np

from evidence.calibration import plan
from evidence.calibration.findings import checks, findings, spans
from evidence.calibration.scans import CLOSE, PAPER, Numbers, Scan, from_plain, scan
from evidence.linkage.runs import default
from evidence.results import Report, table


def _measure(readings: Callable[[], plan.Plan], quick: bool) -> list[dict]:
    return [asdict(scan(reading, values)) for reading, values in readings()]


PARTS = {
    "default": partial(_measure, plan.defaults),
    "meshes": partial(_measure, plan.meshes),
    "starts": partial(_measure, plan.starts),
    "supports": partial(_measure, plan.supports),
}


def report(parts: Mapping[str, list[dict]]) -> Report:
    """Checks, findings and one line and record for each reading; the default one comes first."""
    scans = [from_plain(data) for part in parts.values() for data in part]
    facts = findings(scans)
    return Report(
        checks(scans),
        {"findings": facts, "readings": [record(s) for s in scans]},
        tables(facts, scans),
    )


def record(scan: Scan) -> dict:
    """One reading for summary.json: its best fit, its fit at the scene's K_F, and all numbers."""
    return {
        "reading": scan.reading.label,
        "parameters": dict(scan.reading.parameters),
        "time_step": scan.numbers[0].step,
        "K_F_fitting": spans(scan.K_F, scan.fits),
        "best": _plain(scan.best),
        "numbers": [_plain(n) for n in scan.numbers],
    }


def _plain(n: Numbers) -> dict:
    return {
        "K_F": n.K_F,
        **{f"{name}_largest": n.largest[name] for name in PAPER},
        **{f"{name}_time": n.times[name] for name in PAPER},
        "misfit": n.misfit,
        "closures": [len(c) for c in n.closures],
    }


def tables(facts: dict, scans: list[Scan]) -> str:
    """The findings, and one line for each reading."""
    k = default("K_F")
    columns = (
        "reading", "K_F scanned", "values that fit", "fits between", "best K_F", "BD", "vBz",
        "misfit", f"BD at {k:g}", f"vBz at {k:g}", f"second closure at {k:g} (s)",
    )  # fmt: skip
    return "\n".join(
        [
            "\n## Findings\n",
            table(("finding", "value"), [(name, _pretty(x)) for name, x in facts.items()]),
            "## Readings\n",
            f"K_F in N/rad, BD in m, vBz in m/s. Fits: both numbers within {CLOSE:.0%} of the "
            "paper's (0.063 m, 4.38 m/s). Misfit: distance of the logarithms.\n",
            table(columns, [_line(s, k) for s in scans]),
        ]
    )


def _line(scan: Scan, k: float) -> tuple[str, ...]:
    best, numbers, fits = scan.best, scan.numbers_at(k), scan.K_F[scan.fits]
    if not scan.K_F.min() <= k <= scan.K_F.max():
        raise ValueError(f"K_F = {k} N/rad of the scene is outside the scan of {scan.reading}")
    second = numbers.closure(1)
    times = f"{np.nanmin(second):.3f} to {np.nanmax(second):.3f}" if any(second > 0) else "none"
    return (
        scan.reading.label, f"{scan.K_F.min():g} to {scan.K_F.max():g}",
        f"{scan.fits.sum()} of {len(scan.fits)}",
        f"{fits[0]:g} to {fits[-1]:g}" if len(fits) else "none", f"{best.K_F:g}",
        f"{best.largest['BD']:.4f}", f"{best.largest['vBz']:.2f}", f"{best.misfit:.2f}",
        f"{numbers.largest['BD']:.4f}", f"{numbers.largest['vBz']:.2f}", times,
    )  # fmt: skip


def _pretty(x: object) -> str:
    """A number, a range "first to last", or several of either."""
    if isinstance(x, list):
        if len(x) == 2 and not isinstance(x[0], list) and x[0] != x[1]:
            return f"{_pretty(x[0])} to {_pretty(x[1])}"
        return ", ".join(dict.fromkeys(map(_pretty, x))) or "none"
    return "none" if x is None else f"{x:.4g}"
