"""The paper's linkage in Exudyn, where it is installed.

Exudyn may live in an environment of its own: the environment variable EXUDYN_PYTHON names its
interpreter."""

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import fpm
from evidence.benchmark.clock import best
from evidence.benchmark.peers.description import describe
from evidence.benchmark.scenes import beam_count, linkages, runner
from evidence.linkage.runs import curves
from evidence.rows import Row, at_least, info, skip_row

GROUP = "Exudyn"
COST = "cpu s per simulated s"
ELEMENTS = 10
"""Elements a link, as in the figures of others for this problem."""

EXUDYN = [
    {"name": "implicit, generalised-alpha, step 2e-3 s", "step": 2e-3},
    {"name": "implicit, generalised-alpha, step 1e-3 s", "step": 1e-3},
    {"name": "implicit, generalised-alpha, step 1e-4 s", "step": 1e-4},
    {"name": "explicit, velocity Verlet, step 2e-5 s", "step": 2e-5, "solver": "VelocityVerlet"},
]
EXUDYN_RATIO = "fastest flexible run of Exudyn against ours, one sample of a batch of 32"


def interpreter() -> str | None:
    """The Python that has Exudyn, as EXUDYN_PYTHON names it, or this one; else None."""
    if os.environ.get("EXUDYN_PYTHON"):
        return os.environ["EXUDYN_PYTHON"]
    return sys.executable if importlib.util.find_spec("exudyn") else None


def ask(python: str, task: dict) -> list[dict]:
    """What Exudyn answers to a task, one mapping per run."""
    script = "exudyn_script.py"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "task.json"
        path.write_text(json.dumps(task))
        command = [python, str(Path(__file__).with_name(script)), str(path)]
        # In the folder, so that what Exudyn leaves behind goes away with it.
        process = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    answers = [json.loads(line) for line in process.stdout.splitlines() if line.startswith("{")]
    if not answers:
        raise RuntimeError(f"{script} gave no answer:\n{process.stderr[-2000:]}")
    return answers


def distances(elements: int, duration: float) -> np.ndarray:
    """BD (11,) m of our run with so many elements a link."""
    return curves(fpm.simulate(linkages(1, elements), duration=duration, instants=11)[0])["BD"]


def cost_of(elements: int, duration: float, repeats: int, samples: int = 32) -> float:
    """Our cpu seconds per simulated second and sample of a batch."""
    scenes = linkages(samples, elements)
    step = 0.9 * min(fpm.find_stable_step(scenes[0]).step, fpm.find_stable_step(scenes[-1]).step)
    steps = round(duration / step)
    seconds = best({"ours": runner(scenes, steps, step)}, repeats)["ours"]
    return seconds / samples / (steps * step)


def rms(a: np.ndarray, b: np.ndarray) -> float:
    """Root mean square of the difference."""
    return float(np.sqrt(np.mean((a - b) ** 2)))


def find_equal_mesh(error: float, fine: np.ndarray, duration: float) -> tuple[int, float]:
    """Our coarsest mesh whose error is at most `error` (m), and its error; else the finest."""
    for elements in range(3, 4 * ELEMENTS):
        deviation = rms(distances(elements, duration), fine)
        if deviation <= error:
            break
    return elements, deviation


def exudyn(duration: float, repeats: int, cases=None) -> list[Row]:
    """The paper's linkage in Exudyn, from the same start, before the contacts close."""
    python = interpreter()
    if python is None:
        reason = "not installed: pip install -e '.[peer-exudyn]'"
        return [skip_row(f"Exudyn: {EXUDYN_RATIO}", reason, "x")]
    # The reference has four times as many elements, and so about a fourteenth of the step.
    fine = distances(4 * ELEMENTS, duration)
    cost, error = cost_of(ELEMENTS, duration, repeats), rms(distances(ELEMENTS, duration), fine)
    scene = linkages(1, ELEMENTS)[0]
    count = beam_count(scene)
    name = f"ours: 4 x {ELEMENTS} elements, a sample of a batch of 32"
    rows = [info(name, cost, COST, f"error of BD {error:.2g} m (rms)")]
    description = describe(scene)
    task = {"structure": description, "duration": duration, "instants": 11, "runs": EXUDYN[:cases]}
    exact = []
    for answer in ask(python, task):
        name = f"Exudyn: {answer['name']}"
        if not answer["ok"]:
            note = "breaks down: " + answer.get("error", "not finite").splitlines()[0]
            rows.append(info(name, "none", COST, note))
            continue
        b, d = (np.array(answer["points"][name]) for name in "BD")
        deviation = rms(np.linalg.norm(b - d, axis=1), fine)
        nanoseconds = 1e9 * answer["cpu"] / answer["steps"] / count
        note = f"error of BD {deviation:.2g} m (rms); {nanoseconds:.0f} ns per element and step"
        rows.append(info(name, answer["cpu"] / duration, COST, note))
        exact.append((answer["cpu"] / duration, deviation, answer["version"]))
    return rows + (_against_exudyn(exact, fine, duration, repeats, (cost, error)) if exact else [])


def _against_exudyn(
    exact: list, fine: np.ndarray, duration: float, repeats: int, result: tuple[float, float]
) -> list[Row]:
    """Our result, cost (cpu s per s) and error (m), against Exudyn's, with its version."""
    cost, error = result
    fastest, deviation, version = min(exact)
    name = f"{EXUDYN_RATIO} (Exudyn {version})"
    elements, error_ours = find_equal_mesh(deviation, fine, duration)
    ratio = fastest / cost_of(elements, duration, repeats)
    note = f"ours with 4 x {elements} elements, error {error_ours:.2g} m against {deviation:.2g} m"
    best_off, seconds = min((deviation, seconds) for seconds, deviation, _ in exact)
    return [
        at_least(f"{name}: as many elements", fastest / cost, 100.0, unit="x"),
        at_least(f"{name}: equal accuracy", ratio, 100.0, note=note, unit="x"),
        info("Exudyn's most accurate run against ours", seconds / cost, "x",
             f"error {best_off:.2g} m against {error:.2g} m"),
    ]  # fmt: skip
