"""One key for accuracy against designs and scans chosen by hand: what came of it, and its cost.

All of them are whole campaigns without figures, in one process, so that the cost of each is that of
everything: choosing runs, integrating, writing, bounds, checks."""

import copy
import json
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from deployable import campaign, intervals
from deployable.campaign.folder import Folder
from evidence.tradeoff.measure.tolerance_cases import AccuracyCase, scan

MINUTES, RUNS = 0.2, 300
"""Budget of each: minutes of one core, and runs."""


def measure_targets(case: AccuracyCase, notify: Callable[[str], object] = print) -> dict:
    """What every accuracy and every rival of a case came to, as plain numbers."""
    with tempfile.TemporaryDirectory() as folder:
        short = {"solver": {"duration": 1e-3, "instants": 2}}
        _run(case, _merge(scan(2 + 2 ** len(case.config["intervals"])), short), Path(folder))
        reference, cpu, _ = _run(case, case.reference, Path(folder))
        notify(f"{case.name}: reference, {cpu:.3g} s of cpu time")
        record = {"case": case.name, "title": case.title, "reference_cpu": cpu}
        record |= {"responses": list(case.config["responses"]), "asked": [], "rivals": []}
        for share in case.shares:
            limits = {"max_core_minutes": MINUTES, "max_runs": RUNS}
            change = {"accuracy": {"tolerance": share, **limits}}
            row = _measure(case, change, reference, Path(folder))
            record["asked"].append({"share": share, **row})
            notify(f"{case.name}: accuracy {share}, {row['cpu']:.3g} s of cpu time")
        for name, change in case.rivals.items():
            row = _measure(case, change, reference, Path(folder))
            record["rivals"].append({"name": name, **row})
            notify(f"{case.name}: {name}, {row['cpu']:.3g} s of cpu time")
    return record


def _measure(case: AccuracyCase, change: Mapping, reference: Any, folder: Path) -> dict:
    """The cost of a campaign, and its errors against the reference."""
    bounds, cpu, summary = _run(case, change, folder)
    accuracy = summary.get("accuracy", {})
    outcome = {key: accuracy.get(key) for key in ("met", "reason", "rounds", "mesh")}
    return {
        "cpu": cpu,
        "runs": accuracy.get("runs", summary["design"]["runs"]),
        **outcome,
        "errors": [judge(bounds, reference, i) for i in range(bounds.sizes["response"])],
    }


def judge(bounds: Any, reference: Any, i: int) -> dict[str, float]:
    """The true error of response `i`, integrated over time, as a `share` of the width; the
    estimate's share (`told`); the share of the instants that it `covers`; and below which share of
    the mean width the error is at 90 % of the instants (`most`)."""
    time, width = bounds["time"].values, (reference["upper"] - reference["lower"]).values[i]
    ends = (data[side].values[i] for data in (bounds, reference) for side in ("lower", "upper"))
    true, error = intervals.hausdorff(*ends), bounds["error"].values[i]
    area = float(np.trapezoid(width, time))
    return {
        "share": float(np.trapezoid(true, time)) / area,
        "told": float(np.trapezoid(error, time)) / area,
        "covers": float((true <= error + 1e-6 * width.max()).mean()),
        "most": float(np.percentile(true, 90)) * float(time[-1] - time[0]) / area,
    }


def _run(case: AccuracyCase, change: Mapping, folder: Path) -> tuple[Any, float, dict]:
    """Bounds of a campaign, its cpu time (s) and its summary; nothing of an earlier one is used."""
    config = _merge({"campaign": "asked", "jobs": {"keep": "responses"}, **case.config}, change)
    with tempfile.TemporaryDirectory(dir=folder) as results:
        start = time.process_time()
        bounds = campaign.run(config, results, figures=False, notify=lambda text: None)
        cpu = time.process_time() - start
        summary = json.loads((Folder(Path(results, "asked")) / "summary.json").read_text("utf-8"))
    return bounds, cpu, summary


def _merge(config: Mapping, change: Mapping) -> dict:
    from deployable.campaign.config.check import merge

    return merge(copy.deepcopy(dict(config)), change)
