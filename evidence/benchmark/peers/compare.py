"""The same work by peers, where they are installed: Exudyn and PyElastica.

A peer may live in an environment of its own, since the peers' pins clash: the environment variables
EXUDYN_PYTHON and PYELASTICA_PYTHON name its interpreter."""

import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import fpm
from evidence.benchmark.clock import best
from evidence.benchmark.peers.description import describe
from evidence.benchmark.scenes import beam_count, linkages, runner
from evidence.linkage.runs import curves
from evidence.peers import interpreter
from evidence.rows import Row, at_least, info, skip_row

GROUP = "Peers"
COST = "cpu s per simulated s"
ELEMENTS = 10
"""Elements a link, as in the figures of others for this problem."""

EXUDYN = [
    {"name": "implicit, generalised-alpha, step 2e-3 s", "step": 2e-3},
    {"name": "implicit, generalised-alpha, step 1e-3 s", "step": 1e-3},
    {"name": "implicit, generalised-alpha, step 1e-4 s", "step": 1e-4},
    {"name": "explicit, velocity Verlet, step 2e-5 s", "step": 2e-5, "solver": "VelocityVerlet"},
    {"name": "explicit, velocity Verlet, step 1e-5 s", "step": 1e-5, "solver": "VelocityVerlet"},
]
EXUDYN_RATIO = "fastest flexible run of Exudyn against ours, one sample of a batch of 32"
ELASTICA = [
    {"name": f"{rod_text}, step {step:g} s", "rods": rods, "step": step}
    for rods, rod_text in ((1, "one rod of 40 elements"), (4, "4 rods of 10 elements, 3 hinges"))
    for step in (4e-5, 2e-5, 1e-5, 5e-6)
]


def ask(python: str, script: str, task: dict) -> list[dict]:
    """What a peer's script answers to a task, one mapping per run."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "task.json"
        path.write_text(json.dumps(task))
        command = [python, str(Path(__file__).with_name(script)), str(path)]
        # In the folder, so that what a peer leaves behind goes away with it.
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
    python = interpreter("exudyn", "EXUDYN_PYTHON")
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
    description = describe(scene, ignore=("Contact",))
    task = {"structure": description, "duration": duration, "instants": 11, "runs": EXUDYN[:cases]}
    exact = []
    for answer in ask(python, "exudyn_script.py", task):
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


def elastica(duration: float, repeats: int, cases=None) -> list[Row]:
    """Rods in PyElastica of as many elements as ours, at the largest step that holds."""
    python = interpreter("elastica", "PYELASTICA_PYTHON")
    title = "cpu per element and step, PyElastica against ours, one sample of a batch of 32"
    if python is None:
        reason = "not installed: pip install -e '.[peer-elastica]'"
        return [skip_row(f"PyElastica: {title}", reason, "x")]
    count = 4 * ELEMENTS
    task = {
        "elements": count, "length": 4 * 0.45, "side": 0.035, "E": 1e9, "nu": 0.3, "rho": 800.0,
        "duration": duration, "runs": ELASTICA[:cases],
    }  # fmt: skip
    rows, costs, complete = [], [], set()
    for answer in ask(python, "elastica_script.py", task):
        name = f"PyElastica: {answer['name']}"
        if answer["rods"] in complete:
            continue
        if not answer["ok"]:
            rows.append(info(name, "none", COST, answer.get("error", "breaks down")))
            continue
        complete.add(answer["rods"])  # the first is the largest step that holds
        costs.append(1e9 * answer["cpu"] / answer["steps"] / count)
        note = f"{costs[-1]:.0f} ns per element and step, version {answer['version']}"
        rows.append(info(name, answer["cpu"] / duration, COST, note))
    if costs:
        scenes = linkages(32, ELEMENTS)
        step = 0.85 * fpm.find_stable_step(scenes[0]).step
        seconds = best({"ours": runner(scenes, 4000, step)}, repeats)["ours"]
        cost = 1e9 * seconds / 4000 / count / 32
        name = f"{title} ({cost:.3g} ns)"
        rows.append(info(name, min(costs) / cost, "x"))
    return rows
