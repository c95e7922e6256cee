"""The presets of a config in the study: what each costs, and how wrong it is."""

from __future__ import annotations

import math

from deployable.campaign.config.presets import MODEL, PRESETS
from evidence.rows import Row, at_most

LIMITS = {"draft": 0.18, "standard": 0.12, "reference": 0.05}
"""Share of the width that a preset's bounds may be off by in its worst response."""

FINEST = "this study: dense scan of the finest level"


def cost_of(record: dict) -> tuple[int, float]:
    """Runs with the held-out ones, and their cpu time (s) in whole batches, bounds included."""
    runs = record["runs"] + record["held_out"]
    return runs, math.ceil(runs / record["lanes"]) * record["cpu_batch"] + record["cpu_bounds"]


def preset_rows(cases: dict[str, dict]) -> list[Row]:
    """The presets' errors, and for comparison those of the model that they do not take."""
    rows = []
    for name, case in cases.items():
        found = {(r["preset"], r["model"]): _error(case, r) for r in case["presets"]}
        for (preset, model), (error, note) in found.items():
            if model != MODEL:
                continue
            rival, rival_note = found[preset, "polynomial"]
            text = f"{name}: preset {preset}, error of the bounds"
            share, ratio = f"{text} as a share of their width", f"{text} over the polynomial's"
            # a preset without a limit fails its row: the study has to say one
            rows.append(at_most(share, error, LIMITS.get(preset, 0.0), FINEST, note))
            rows.append(at_most(ratio, error / rival, 1.0, FINEST, rival_note))
    return rows


def missing_rows(case: dict) -> list[Row]:
    """A failing row for each preset that the case should have measured and has not."""
    measured = {record["preset"] for record in case["presets"]}
    why = "finer than the case's reference: give the case a finer level"
    return [
        Row(f"{case['case']}: preset {preset}", "not measured", passed=False, note=why)
        for preset in PRESETS
        if preset not in measured
    ]


def _error(case: dict, record: dict) -> tuple[float, str]:
    """Error of the worst response, and a note with those of all and the cost."""
    total = [row["all"] for row in record["total"]]
    runs, cost = cost_of(record)
    each = ", ".join(
        f"{name} {row['hausdorff_integrated']:.1%} of the width, rms {row['hausdorff_rms']:.2g}"
        for name, row in zip(case["responses"], total, strict=True)
    )
    note = f"{runs} runs, {cost:.2g} s of cpu time; {each}"
    return max(row["hausdorff_integrated"] for row in total), note
