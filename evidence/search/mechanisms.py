"""Boxes of small structures with rigid parts, whose bounds are known from models of their own.

Each goes through the whole program: once with `accuracy`, and once by default.
"""

from __future__ import annotations

import importlib
import json
import os
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import qmc

from deployable import campaign
from evidence.results import Report, table
from evidence.rows import Row, at_least, at_most, set_group
from evidence.search.boxes import Box
from fpm.files.trajectory import read_curves

DRAWS, CHUNK = 2**18, 2**14
"""Points by which true fractions are told, and those that a model gets at once."""
OFFSETS = {-1: (-0.005,), 1: (-0.03, 0.005)}
"""Shares of the width by which limits lie outside the true bounds: of the lower and the upper."""
MAX_RUNS, TOLERANCE = 200, 0.05
FLOOR = 0.002  # share of the width that is added to every error


@dataclass(frozen=True)
class Mechanism:
    """A structure, its box and a model of it that shares nothing with the program.

    structure: text in the language of structures, whose real parameters have SI units; intervals:
    least and largest value by parameter; responses, quantities, margins: as in a config; model:
    values (P, quantities) at points (P, parameters) in SI units, in the order of `names` and
    `intervals`, NaN where a quantity does not happen; duration: of a run, s; design: in place of
    `accuracy`, where there are more than eight intervals; edges: bounds in closed form beside an
    edge, of which a search comes short, NaN for the others.
    """

    name: str
    structure: str
    intervals: Mapping[str, tuple[float, float]]
    responses: Mapping[str, Any]
    quantities: Mapping[str, Any]
    model: Callable[[np.ndarray], np.ndarray]
    duration: float = 1.0
    instants: int = 401
    design: Mapping[str, Any] | None = None
    edges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    margins: Mapping[str, Any] = field(default_factory=dict)

    @property
    def names(self) -> list[str]:
        """Names of all quantities."""
        return [*self.quantities, *(f"{name}_least" for name in self.margins)]

    def values(self, unit: np.ndarray) -> np.ndarray:
        """Values (P, quantities) of the model at points (P, k) of the unit box, from -1 to 1."""
        lower, upper = np.array(list(self.intervals.values()), dtype=float).T
        points = lower + (np.asarray(unit) + 1) / 2 * (upper - lower)
        with np.errstate(all="ignore"):
            parts = [self.model(points[i : i + CHUNK]) for i in range(0, len(points), CHUNK)]
        return np.concatenate(parts)

    def truth(self) -> dict[str, Any]:
        """True bounds and fractions in which each quantity happens and each limit is kept."""
        unit = 2 * qmc.Sobol(len(self.intervals), seed=0).random(DRAWS) - 1
        values = self.values(unit)
        bounds = {
            name: Box(len(self.intervals), lambda u, j=j: self.values(u)[:, j]).true_bounds()
            for j, name in enumerate(self.names)
        }
        for name, ends in self.edges.items():
            bounds[name] = tuple(np.where(np.isnan(ends), bounds[name], ends).tolist())
        fractions = {
            key: float(
                np.mean(np.less_equal(side * values[:, self.names.index(name)], side * level))
            )
            for key, (name, side, level, _) in limits(bounds).items()
        }
        happens = dict(zip(self.names, np.isfinite(values).mean(axis=0).tolist(), strict=True))
        return {"bounds": bounds, "happens": happens, "kept": fractions}


Bounds = Mapping[str, Sequence[float]]


def limits(bounds: Bounds) -> dict[str, tuple[str, int, float, float]]:
    """Limits by requirement: quantity, 1 for at most or -1 for at least, level, share outside."""
    answers = {}
    for name, (lower, upper) in bounds.items():
        width = upper - lower
        for side, end in ((-1, lower), (1, upper)):
            for number, share in enumerate(OFFSETS[side]):
                level = end + side * share * width
                answers[f"{name}_{'_ab'[side]}{number}"] = name, side, level, share
        answers[f"{name}_middle"] = name, 1, (lower + upper) / 2, -0.5
    return answers


def config(mechanism: Mechanism, bounds: Bounds, design: Mapping[str, Any]) -> dict[str, Any]:
    """The campaign of a mechanism, whose structure is in `box.yaml`."""
    sides = {-1: "at_least", 1: "at_most"}
    entries = {key: getattr(mechanism, key) for key in ("responses", "quantities", "margins")}
    entries["requirements"] = {
        key: {quantity: {sides[side]: level}}
        for key, (quantity, side, level, _) in limits(bounds).items()
    }
    return {
        "campaign": "box",
        "scene": {"file": "box.yaml"},
        "solver": {"duration": mechanism.duration, "instants": mechanism.instants},
        "intervals": {
            key: {"lower": ends[0], "upper": ends[1]} for key, ends in mechanism.intervals.items()
        },
        **{key: dict(value) for key, value in entries.items() if value},
        **design,
    }


def play(
    mechanism: Mechanism, truth: Mapping[str, Any], design: Mapping[str, Any]
) -> dict[str, Any]:
    """What a campaign says of a mechanism, beside the truth, in plain numbers."""
    start, folder = os.getcwd(), tempfile.TemporaryDirectory()
    with folder:
        os.chdir(folder.name)
        try:
            Path("box.yaml").write_text(mechanism.structure)
            Path("c.yaml").write_text(json.dumps(config(mechanism, truth["bounds"], design)))
            start_time = sum(os.times()[:4])
            campaign.run("c.yaml", results="r", figures=False, notify=lambda text: None)
            seconds = sum(os.times()[:4]) - start_time
            summary = json.loads(Path("r/box/summary.json").read_text())
            runs = sum(len(read_curves(x)) for x in Path("r/box/trajectories").glob("*.nc"))
        finally:
            os.chdir(start)
    answers = {quantity["name"]: quantity for quantity in summary["quantities"]}
    shares = {requirement["name"]: requirement for requirement in summary["requirements"]}
    accuracy = summary.get("accuracy") or {}
    return {
        "box": mechanism.name, "seconds": seconds, "runs": runs,
        "accuracy_met": accuracy.get("met"), "bounds": [
            bound for name in mechanism.names
            for bound in _bounds(
                answers[name], name, truth, accuracy.get("unmet", []) if accuracy else [name]
            )
        ], "shares": [
            {"requirement": name, "true": truth["kept"][name], "said": shares[name]["share"],
             "open": shares[name]["share_uncertainty"], "met": shares[name]["met"],
             "all": truth["happens"][quantity] == 1 and share > 0}
            for name, (quantity, _, _, share) in limits(truth["bounds"]).items()
        ],
    }  # fmt: skip


def _bounds(
    answer: Mapping[str, Any], name: str, truth: Mapping, unmet: list[str]
) -> Iterable[dict]:
    """Both bounds of a quantity: shares of the true width by which they are off, and the errors."""
    lower, upper = truth["bounds"][name]
    width = upper - lower
    error = answer.get("errors", {}).get("whole", answer["error"])
    for end, true in (("lower", lower), ("upper", upper)):
        value, attained = (
            np.nan if x is None else x for x in (answer[end], answer[f"simulated_{end}"])
        )
        yield {
            "bound": f"{name} {end}", "true": true, "said": value, "attained": attained,
            "off": abs(value - true) / width, "runs_off": abs(attained - true) / width,
            "error": np.inf if error is None else error / width,
            "predicted": end in answer["predicted_ends"], "partial": truth["happens"][name] < 1,
            "told_met": name not in unmet,
        }  # fmt: skip


def worst(answer: Mapping[str, Any]) -> float:
    """By how much the worst bound of an answer is off, as a share of its width."""
    return max(np.nan_to_num(bound["off"], nan=np.inf) for bound in answer["bounds"])


def check(mechanism: Mechanism, truth: Mapping[str, Any]) -> dict[str, Any]:
    """A mechanism with `accuracy` and by default; by its own design where it has one."""
    if mechanism.design:
        answer = play(mechanism, truth, {"design": dict(mechanism.design)})
        return {"accuracy": answer, "default": answer}
    goal = {"accuracy": {"tolerance": TOLERANCE, "max_runs": MAX_RUNS}}
    return {"accuracy": play(mechanism, truth, goal), "default": play(mechanism, truth, {})}


def truths(module: str) -> dict[str, Any]:
    """The stored truths of the boxes of a module of this package."""
    return json.loads(Path(__file__).with_name(f"{module}.json").read_text())


def measure(module: str, quick: bool = False) -> list[dict[str, Any]]:
    """All boxes of a module of this package, checked; the first one with `quick`."""
    references = truths(module)
    boxes = importlib.import_module(f"evidence.search.{module}").BOXES
    return [check(box, references[box.name]) for box in (boxes[:1] if quick else boxes)]


def _share(values: Iterable[bool]) -> float:
    """Share of what is true, NaN of nothing."""
    values = list(values)
    return float(np.mean(values)) if values else np.nan


def is_within(bound: Mapping[str, Any]) -> bool:
    """Whether a bound is within its error of the truth."""
    return bool(bound["off"] <= bound["error"] + FLOOR)


def rows(checks: Sequence[Mapping[str, Any]], mode: str) -> list[Row]:
    """What is asked of the campaigns of a mode, `accuracy` or `default`."""
    answers = [check[mode] for check in checks]
    bounds = [bound for answer in answers for bound in answer["bounds"]]
    shares = [share for answer in answers for share in answer["shares"]]
    wrong = [abs(share["said"] - share["true"]) for share in shares]
    ratios = [
        share["open"] / miss for share, miss in zip(shares, wrong, strict=True) if miss > 0.001
    ]
    is_covered = [miss <= s["open"] + 0.0005 for s, miss in zip(shares, wrong, strict=True)]
    is_false = [
        (share["met"] == "all" and not share["all"])
        or (share["met"] == "none" and share["true"] > 0)
        for share in shares
    ]
    is_worse = [not b["off"] <= np.nan_to_num(b["runs_off"], nan=np.inf) + 1e-4 for b in bounds]
    findings = [
        at_least("true bounds within the error", _share(map(is_within, bounds)), 0.95),
        at_least("of quantities that exist in a part of the box",
                 _share(is_within(b) for b in bounds if b["partial"]), 0.9),
        at_least("of predicted ones", _share(is_within(b) for b in bounds if b["predicted"]), 0.9),
        at_most("bounds reported that are worse than the runs'", sum(is_worse), 0),
        at_most("requirements falsely met, or by none", sum(is_false), 0),
        at_most("stated uncertainty of fractions over their errors, median",
                float(np.median(ratios)) if ratios else 0.0, 3),
        at_least("fractions within their uncertainty", _share(is_covered), 0.95),
    ]  # fmt: skip
    if mode == "accuracy":
        findings += _accuracy_rows(checks)
    return set_group(f"mechanisms, {mode}", findings)


def _accuracy_rows(checks: Sequence[Mapping[str, Any]]) -> list[Row]:
    """What is asked of campaigns with an `accuracy` alone: what is told to be met, and runs."""
    answers, limit = [check["accuracy"] for check in checks], TOLERANCE + FLOOR
    verdicts = [b for answer in answers for b in answer["bounds"] if b["told_met"]]
    whole = [answer for answer in answers if answer["accuracy_met"]]
    return [
        at_most("bounds told to be as accurate as asked that are not",
                sum(not b["off"] <= limit for b in verdicts), 0),
        at_most("campaigns told so that are not", sum(worst(a) > limit for a in whole), 0),
        at_most("runs over those that are allowed, largest",
                max(answer["runs"] for answer in answers) / MAX_RUNS, 1),
    ]  # fmt: skip


def report(checks: Sequence[Mapping[str, Any]]) -> Report:
    """Rows of all mechanisms that were checked, and each bound as a line of a table."""
    lines = [
        (check[mode]["box"], mode, check[mode]["runs"], check[mode]["seconds"], bound["bound"],
         *(f"{bound[key]:.4g}" for key in ("true", "said", "attained")), 100 * bound["off"],
         100 * bound["error"], "predicted" if bound["predicted"] else "", is_within(bound))
        for check in checks for mode in ("accuracy", "default") for bound in check[mode]["bounds"]
    ]  # fmt: skip
    header = ("box", "by", "runs", "cpu time (s)", "bound", "true", "reported", "of the runs",
              "off (%)", "error (%)", "", "within")  # fmt: skip
    text = "\n## Mechanisms\n\nOff and error: of the width.\n\n" + table(header, lines)
    findings = [row for mode in ("accuracy", "default") for row in rows(checks, mode)]
    return Report(findings, {"mechanisms": checks}, text)
