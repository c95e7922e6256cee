"""Random structures of all kinds, and what became of them.

    PYTHONPATH=. python tests/golden/all_kinds.py [FIRST STEP]

prints what all_kinds.json is to hold: for each structure and quantity the sum of its values, with
weights, and that of what they are without sign. One that says what is left out records all else.
A change that moves them says why.
"""

import json
import sys
from pathlib import Path

import numpy as np

import fpm
from evidence.attack.metamorphic.runs import STEPS, curves_of, scene_of
from fpm.reading.variables import VARIABLES
from fpm.structures.report import redundant

CASES = json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))

BORNE = {"joint_moment", "joint_force", "joint_work", "constraint_moment", "constraint_force"}
"""What joints bear."""

GAPS = {"gap", "tilt", "joint_gap", "joint_tilt", "lock"}
"""What is left of them is rounding; of bearings there are none."""


def why(case, fails: dict) -> list:
    """When a run of a case fails that takes too long a step, which element is blamed, and why."""
    (outcome,) = fpm.simulate(
        scene_of(case["structure"]), duration=fails["duration"], instants=3, step=fails["step"]
    )
    failure = outcome.failure
    return [float(f"{failure.time:.9g}"), failure.element, failure.cause]


def sums(curves) -> dict[str, list[float]]:
    """By quantity; each value has a weight of its own, so that none can stand for another."""
    found: dict[str, list[float]] = {}
    for (what, _), (values, _) in sorted(curves.items()):
        count, total, size = found.get(what, (0, 0.0, 0.0))
        weights = np.cos(1.0 + count + np.arange(values.size))
        total += float(weights @ values.ravel())
        found[what] = [count + values.size, total, size + float(np.abs(values).sum())]
    return {what: [float(f"{x:.12g}") for x in two] for what, (_, *two) in found.items()}


def columns(scene, without: list[str]) -> list[tuple[str, str]]:
    """All that a run records, but for what rounding decides. What is led slowly takes no run.

    That is the clearance of bars that touch, and what joints bear whose conditions others imply, as
    in a loop of three bodies on two hinges and a ball: a redundant force is the gap that rounding
    and the step leave, divided by the 1e-10 by which the matrix of joints is eased. A processor
    that rounds otherwise moves it by 1e-6 of itself, and the motion by nothing.
    """
    led = {name for name, variable in VARIABLES.items() if variable.dim_suffix == "along"}
    known = VARIABLES.keys() - led - set(without)
    undetermined = {name.removeprefix("joint ") for name in redundant(scene)}
    return [
        (name, label)
        for name in sorted(known)
        for label in VARIABLES[name].labels(scene)
        if name not in BORNE or label.split()[0] not in undetermined
    ]


if __name__ == "__main__":
    first, step = map(int, sys.argv[1:] or (0, 1))
    some = CASES[first::step]
    for case in some:
        scene = scene_of(case["structure"])
        record = columns(scene, case["without"]) if "without" in case else ()
        (outcome,) = fpm.simulate(
            scene, duration=case["duration"], instants=9, step=case["duration"] / STEPS,
            energy_tolerance=1.0, record=record,
        )  # fmt: skip
        curves = curves_of(outcome)
        curves["event", ""] = outcome.events, ""
        curves["energy", "balance"] = outcome.energies["balance"], "J"
        for name in outcome.largest.keys() - GAPS:
            curves["largest", name] = np.array([outcome.largest[name]]), ""
        if "fails" in case:
            case["fails"]["why"] = why(case, case["fails"])
        case["sums"] = sums(curves)
    lines = (json.dumps(case, separators=(",", ":")) for case in some)
    print("[", ",\n".join(lines), "]", sep="\n")
