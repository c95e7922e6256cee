"""Peers on the same runs: chaospy and OpenTURNS fit, PyUncertainNumber bounds a few instants.

A peer is found by import in this environment, or as another Python named by an environment
variable (PEERS below), e.g. `PEER_CHAOSPY=/path/to/venv/bin/python`: their pins clash. One that is
not there becomes a skipped entry with the command that installs it."""

import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from deployable import intervals
from evidence.peers import interpreter
from evidence.search.boxes import Box, silent
from evidence.search.study import find_bounds
from evidence.tradeoff.measure.cases import CASES, Case, Choice
from evidence.tradeoff.measure.points import design_of, scan_of
from evidence.tradeoff.measure.runs import Runs, simulate

PEERS = {
    "chaospy": ("PEER_CHAOSPY", "pip install chaospy"),
    "openturns": ("PEER_OPENTURNS", "pip install openturns numpy"),
    "pyuncertainnumber": ("PEER_PUN", "pip install PyUncertainNumber"),
}
FITS = (("one", Choice("tensor_roots", 9)), ("three", Choice("sobol", 3, samples=32)))
ELEMENTS = 8
INSTANTS = 41
_TESTS = 64


def measure_peers(notify: Callable[[str], object] = print) -> dict:
    """Fits and bounds of this package and of each peer, as plain numbers."""
    fits, bounds = [], []
    for name, choice in FITS:
        case = next(case for case in CASES if case.name == name)
        design = design_of(case, choice)
        tests = scan_of(case, _TESTS)
        points = np.concatenate([design.points, tests])
        line = scan_of(case, 401) if name == "one" else points[:0]
        runs = simulate(case, ELEMENTS, 0.9, np.concatenate([points, line]))
        problem = _problem(case, choice, design, runs, tests)
        notify(f"peers: {len(problem['points'])} runs of case {name}, {choice.label}")
        fits.append({"by": "intervals", "case": name, **_fit_ours(design, problem)})
        for peer in ("chaospy", "openturns"):
            answer = run_peer(peer, problem)
            row = answer if "skipped" in answer else _fit_error(answer, problem)
            fits.append({"by": peer, "case": name, **row})
        if name == "one":
            bounds = _bounds(case, runs, line)
    return {"case": "peers", "fits": fits, "bounds": bounds}


def _problem(case: Case, choice: Choice, design, runs: Runs, tests: np.ndarray) -> dict:
    """What a peer is given, all responses side by side: values (N, n T)."""
    rows = intervals.match_points(design.points, runs.points)
    truth = runs.values[intervals.match_points(tests, runs.points)]
    return {
        "points": design.points,
        "values": runs.values[rows].reshape(len(rows), -1),
        "degree": choice.order,
        "tested": tests,
        "truth": truth.reshape(len(tests), -1),
        "scales": truth.std(axis=(0, 2)),
    }


def _fit_ours(design, problem: dict) -> dict:
    start = time.perf_counter()
    surrogate = intervals.fit(design, problem["values"])
    seconds = time.perf_counter() - start
    answer = {"seconds": seconds, "predicted": surrogate.evaluate(problem["tested"])}
    return _fit_error(answer, problem)


def _fit_error(answer: dict, problem: dict) -> dict:
    """Seconds, and rms error at the tested points as a share of each response's spread, worst."""
    shape = len(problem["truth"]), len(problem["scales"]), -1
    errors = (answer["predicted"] - problem["truth"]).reshape(shape)
    error = np.sqrt((errors**2).mean(axis=(0, 2))) / problem["scales"]
    return {
        "seconds": float(answer["seconds"]),
        "error": float(error.max()),
        "fits": int(problem["values"].shape[1]),
        "version": str(answer.get("version", "")),
    }


def _bounds(case: Case, runs: Runs, line: np.ndarray) -> list[dict]:
    """Bounds of the velocity at a few instants between the closures: error and calls of methods."""
    rows = intervals.match_points(line, runs.points)
    indices = np.linspace(0.45, 0.85, INSTANTS) * (len(runs.time) - 1)
    curves = runs.values[rows, 1][:, indices.astype(int)]
    low, high = curves.min(axis=0), curves.max(axis=0)
    width = (high - low).mean()

    def errors(bounds: np.ndarray) -> list[float]:
        n = len(bounds)
        return (intervals.hausdorff(*bounds.T, low[:n], high[:n]) / width).tolist()

    def runs_at(points: np.ndarray) -> np.ndarray:
        return np.array([np.interp(points[:, 0], line[:, 0], c) for c in curves.T]).T

    table = []
    for order in (1, 2, 4, 8, 16, 32, 64, 128, 256):
        bands, seconds = {}, {}
        if order <= 64:
            design = design_of(case, Choice("tensor_lobatto", order))
            values = runs_at(design.points)
            start = time.perf_counter()
            bands["polynomial"] = intervals.find_surrogate_range(intervals.fit(design, values))
            seconds["polynomial"] = (time.perf_counter() - start) / INSTANTS
        if order > 1:
            knots = np.linspace(-1.0, 1.0, order + 1)[:, None]
            values = runs_at(knots)
            start = time.perf_counter()
            bands["spline"] = intervals.spline_range(intervals.fit_spline(knots, values))
            seconds["spline"] = (time.perf_counter() - start) / INSTANTS
        for name, band in bands.items():
            ends = np.stack([band.lower, band.upper], axis=1)
            method = f"{name}, order {order}" if name == "polynomial" else "spline, even points"
            row = _row("intervals", method, order + 1, seconds[name], errors(ends))
            table.append({**row, "model": name})
    table.append(_search(line[:, 0], curves, errors))
    answer = run_peer("pyuncertainnumber", {"line": line[:, 0], "curves": curves})
    if "skipped" in answer:
        return [*table, {"by": "pyuncertainnumber", **answer}]
    for key in answer:
        if key.endswith("_bounds"):
            name = key.removesuffix("_bounds")
            calls, seconds = float(answer[f"{name}_calls"]), float(answer[f"{name}_seconds"])
            method = name.replace("_", " ")
            table.append(_row("pyuncertainnumber", method, calls, seconds, errors(answer[key])))
    return table


def _search(line: np.ndarray, curves: np.ndarray, errors: Callable) -> dict:
    """Our search for the bounds of a quantity, the value at each instant (curves: G, n)."""
    ends, calls, start = [], [], time.perf_counter()
    for curve in curves.T:
        function = silent(lambda u, curve=curve: np.interp(u[:, 0], line, curve))
        bounds, values = find_bounds(Box("instant", 1, function))
        ends.append((bounds.lower, bounds.upper))
        calls.append(len(values))
    seconds = (time.perf_counter() - start) / len(ends)
    row = _row("intervals", "search", float(np.mean(calls)), seconds, errors(np.array(ends)))
    return {**row, "model": "search"}


def _row(tool: str, method: str, calls: float, seconds: float, errors: list[float]) -> dict:
    """Calls and seconds an instant; errors, shares of the mean width, of the first instants."""
    return {"by": tool, "method": method, "calls": calls, "seconds": seconds, "errors": errors}


def run_peer(peer: str, problem: dict) -> dict:
    """What peer_script.py finds, or {"skipped": why}."""
    variable, command = PEERS[peer]
    python = interpreter(peer, variable)
    if python is None:
        return {"skipped": f"not installed: {command} (any environment; {variable}=its python)"}
    with tempfile.TemporaryDirectory() as folder:
        files = [str(Path(folder) / name) for name in ("given.npz", "found.npz")]
        np.savez(files[0], **problem)
        script = Path(__file__).with_name("peer_script.py")
        try:
            call = [python, str(script), peer, *files]
            process = subprocess.run(call, capture_output=True, text=True, timeout=120, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            return {"skipped": f"could not be run: {error}"}
        if process.returncode:
            return {"skipped": "failed: " + (process.stderr.strip().splitlines() or ["?"])[-1]}
        with np.load(files[1]) as answer:
            return {key: answer[key] for key in answer}
