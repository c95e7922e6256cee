"""The study of measured curves: synthetic tests of a swinging arm, whose hidden values and lacks
are known, by scipy's solver; and a real arm, whose curves lie beside the project."""

import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from deployable import campaign
from evidence.measured.two_arms import CURVES, largest_differences
from evidence.registry import ROOT
from evidence.results import Report, table
from evidence.rows import Row, at_least, at_most, info
from fpm.structures.curves_file import CurvesFile

MASS, INERTIA, GRAVITY = 0.1476, 1.1e-4, 9.81  # as in config/measured/arm.yaml
BAND = 0.002  # rad
LACKS = ("air", "dry friction", "gear ratio", "cold", "backlash")
"""What the models of refuted tests do not have."""

INTERVALS = {"distance": {"lower": 0.14, "upper": 0.156}, "viscous": {"lower": 0.0, "upper": 6e-4}}


def config_of(name: str, intervals: Mapping, duration: float, measured: Mapping) -> dict:
    """The campaign of an arm, in which `intervals` vary, with measured tests."""
    return {
        "campaign": name,
        "scene": {"file": str(ROOT / "config/measured/arm.yaml")},
        "solver": {"duration": duration, "instants": int(200 * duration) + 1, "step": 0.0005},
        "intervals": dict(intervals),
        "design": {"method": "smolyak", "order": 2},
        "bounds": {"model": "spline"},
        "responses": {"phi": {"opening": "bearing"}},
        "measured": dict(measured),
    }


def find(config: Mapping) -> dict[str, Any]:
    """What measured.json of a campaign says, without the curves."""
    with tempfile.TemporaryDirectory() as folder:
        campaign.run(config, folder, figures=False, notify=lambda text: None)
        path = Path(folder, config["campaign"], "measured.json")
        facts = json.loads(path.read_text(encoding="utf-8"))
    for test in facts["tests"]:
        del test["curves"]
    return facts


def swing(seed: int, lack: str = "") -> tuple[np.ndarray, dict[str, float]]:
    """Instants and angles (2, T) that a sensor has of an arm, and the hidden values."""
    rng = np.random.default_rng(seed)
    truth = {name: float(rng.uniform(*ends.values())) for name, ends in INTERVALS.items()}
    start = rng.uniform([1.9, -0.2], [2.1, 0.2])
    delay, gain, offset = rng.uniform([0, 0.995, -0.005], [0.02, 1.005, 0.005])
    distance, viscous = truth.values()
    inertia = INERTIA + MASS * distance**2

    def rates(time: float, state: np.ndarray) -> list[float]:
        angle, rate = state
        damping = viscous * (4 if lack == "cold" and time > 1.5 else 1)
        moment = MASS * GRAVITY * distance * np.sin(angle) - damping * rate
        moment -= 2e-4 * rate * abs(rate) * (lack == "air")
        moment -= 2e-3 * np.tanh(rate / 1e-3) * (lack == "dry friction")
        return [rate, moment / inertia]

    times = np.arange(0.02, 3.0, 0.005)
    options = {"rtol": 1e-9, "atol": 1e-11, "max_step": 0.01}
    solution = solve_ivp(rates, (0, 3), start, dense_output=True, **options)
    angles, speeds = solution.sol(times - delay)
    if lack == "gear ratio":
        angles = 0.97 * angles
    if lack == "backlash":
        angles = angles - 0.01 * np.sign(speeds)
    noise = rng.uniform(-0.9, 0.9, len(times)) * BAND
    return np.array([times, gain * angles + offset + noise]), truth


def measure_synthetic(seed: int, lack: str = "") -> dict[str, Any]:
    """What is found of a synthetic test: whether the truth is left, or whether it is refuted."""
    curves, truth = swing(seed, lack)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "swing.csv")
        np.savetxt(path, curves.T, "%.6f", ",", header="t [s],angle [rad]", comments="")
        test = {
            "file": str(path), "columns": {"angle": "phi"}, "band": {"phi": BAND},
            "unknown": {"delay": [0, 0.02], "offset": {"phi": 0.005}, "gain": {"phi": 0.005}},
            "start": {"angle": [1.9, 2.1], "rate": [-0.2, 0.2]},
        }  # fmt: skip
        facts = find(config_of("synthetic", INTERVALS, 3.0, {"swing": test}))
    is_left = not facts["refuted"] and all(
        p["after"][0] <= truth[p["name"]] <= p["after"][1] for p in facts["parameters"]
    )
    names = ("refuted", "least", "attained", "explained", "left", "runs", "parameters")
    return {"lack": lack, "is_left": is_left, "hidden": truth, **{n: facts[n] for n in names}}


def measure_truths(quick: bool = False) -> list[dict[str, Any]]:
    """Tests whose model has all that moved the arm; one with `quick`."""
    return [measure_synthetic(seed) for seed in range(1 if quick else 50)]


def measure_lacks(quick: bool = False) -> list[dict[str, Any]]:
    """Tests whose model lacks something; one with `quick`."""
    lacks = LACKS[:1] if quick else LACKS * 4
    return [measure_synthetic(100 + i, lack) for i, lack in enumerate(lacks)]


def measure_two_arms(quick: bool = False) -> dict[str, float] | None:
    """Largest differences (rad) of two driven arms, by their authors' numbers, from what was
    measured, over 1 s (0.05 s with `quick`); None without the data."""
    return largest_differences(CURVES, 0.05 if quick else 1.0) if CURVES.exists() else None


def measure_arm(names: tuple[str, ...], swings: tuple[int, ...]) -> dict[str, Any] | None:
    """What the real arm's curves say of a model with parameters `names`; None without the data."""
    folder = Path(os.environ.get("MEASURED", ROOT.parent / "shared" / "measured"))
    ends = {
        "distance": (0.14, 0.155), "inertia": (5e-5, 2e-4), "viscous": (0.0, 6e-4),
        "dry": (0.0, 2e-3), "air": (0.0, 0.02),
    }  # fmt: skip
    tests = {}
    for kind, numbers in (("swing", swings), ("check", (1, 2) if len(swings) > 1 else ())):
        for number in numbers:
            path = folder / f"one_arm_{kind}_{number}.csv"
            if not path.exists():
                return None
            file = CurvesFile.read(path)
            angle = file.columns["angle"][:25]
            rate, start = np.polyfit(file.times[:25], angle, 2)[1:]
            tests[f"{kind}_{number}"] = {
                "file": str(path), "columns": {"angle": "phi"}, "band": {"phi": 1e-3},
                "unknown": {"offset": {"phi": 2e-3}}, "window": [0.0, DURATION],
                "start": {"angle": [start - 0.02, start + 0.02], "rate": [rate - 0.3, rate + 0.3]},
                "use": "calibrate" if kind == "swing" else "check",
            }  # fmt: skip
    intervals = {name: dict(zip(("lower", "upper"), ends[name], strict=True)) for name in names}
    facts = find(config_of("one_arm", intervals, DURATION, tests))
    return {**facts, "names": names, "swings": swings}


DURATION = 4.0
"""Seconds of the real arm's curves that are compared."""

MODELS = {
    "viscous": ("distance", "inertia", "viscous"),
    "dry": ("distance", "inertia", "viscous", "dry"),
    "air": ("distance", "inertia", "viscous", "air"),
}
PARTS = {
    "truths": measure_truths,
    "lacks": measure_lacks,
    **{
        f"arm-{name}": lambda quick=False, names=names: measure_arm(names, (1, 2, 3, 4))
        for name, names in MODELS.items()
    },
    "two-arms": measure_two_arms,
}


def report(parts: Mapping[str, Any]) -> Report:
    """What the study claims, and what was found of each test as tables."""
    rows: list[Row] = []
    text = ""
    if tests := [*parts.get("truths", ()), *parts.get("lacks", ())]:
        rows += _synthetic_rows(parts["truths"], parts["lacks"])
        lines = [
            (f"{i}, {t['lack']}" if t["lack"] else i, t["runs"], t["least"], t["attained"],
             100 * t["left"], t["is_left"] if not t["lack"] else t["refuted"])
            for i, t in enumerate(tests, 1)
        ]  # fmt: skip
        header = ("test, what the model lacks", "runs", "least band", "attained",
                  "left of the box (%)", "truth left, or refuted")  # fmt: skip
        text += "\n## Synthetic tests\n\n" + table(header, lines)
    for name in MODELS:
        facts = parts.get(f"arm-{name}")
        if facts is None:
            reason = "no measured curves; set MEASURED to their folder"
            rows.append(Row(f"least band, {name} model of the arm", None, "mrad", skipped=reason))
            continue
        rows.append(info(f"least band, {name} model of the arm", facts["attained"], "mrad"))
        lines = [(p["name"], *p["before"], p["best"], *(p["after"] or ("none", "none")))
                 for p in facts["parameters"]]  # fmt: skip
        header = ("parameter", "lower", "upper", "nearest run", "after, lower", "after, upper")
        text += f"\n## The arm, {name} model\n\n" + table(header, lines)
    for name, difference in (parts.get("two-arms") or {}).items():
        rows.append(info(f"two driven arms, largest difference of the {name}", difference, "rad"))
    return Report(rows, dict(parts), text)


def _synthetic_rows(truths: list[dict[str, Any]], lacks: list[dict[str, Any]]) -> list[Row]:
    return [
        at_least("tests whose truth is left", np.mean([t["is_left"] for t in truths]), 1.0),
        at_least("refuted, of those whose model lacks something",
                 np.mean([t["refuted"] for t in lacks]), 0.95),
        at_most("runs of a test that is explained", max(t["runs"] for t in truths), 120.0),
    ]  # fmt: skip
