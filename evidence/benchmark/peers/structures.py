"""Structures of the library in Exudyn: whether the motions agree, and what either costs."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import fpm
from evidence.benchmark.clock import best
from evidence.benchmark.peers import compare
from evidence.benchmark.peers.description import describe
from evidence.rows import Row, at_least, at_most, info, skip_row
from fpm import structures
from fpm.scenes.scene_type import SceneType

GROUP = "Structures of the library in Exudyn"
FOLDER = Path(__file__).parents[3] / "config" / "structures"
SAMPLES, INSTANTS = 32, 11

RIGID, ELASTIC = 1e-3, 5e-3
"""How far motions may be apart (rms, as a share of the way): rigid bodies obey the same equations;
beams are those of two theories, Exudyn's with shear."""

SOLVERS = {
    RIGID: ({"name": "dense matrices", "linear": "EXUdense"},),
    ELASTIC: (
        {"name": "modified Newton", "radius": 0.5},
        {"name": "full Newton", "radius": 0.5, "modified": False},
    ),
}
"""Settings that were fastest among dense and sparse matrices, modified and full Newton, and
spectral radii of 0.5 and 0.9, by what may be apart."""


@dataclass(frozen=True)
class Case:
    """A structure as both run it.

    name: of its file; parameters as its campaign has them, and one that a batch varies; point whose
    motion is compared over `duration` (s); planar: in Exudyn's items for the plane; step (s) of
    ours, 0.9 of the stable one if left out; steps (s) of Exudyn, the finest last; meshes: of
    Exudyn, elements beside those of `parameters`; finest: elements of our run that all are held
    against, for rigid bodies one with a quarter of the step; ignore: kinds that do not act in
    that time, and are not described."""

    name: str
    text: str
    point: str
    duration: float
    varies: str
    steps: tuple[float, ...]
    planar: bool = True
    step: float | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)
    meshes: tuple[int, ...] = ()
    finest: int | None = None
    ignore: tuple[str, ...] = ()

    @property
    def tolerance(self) -> float:
        """How far motions may be apart, as a share of the way."""
        return ELASTIC if self.finest else RIGID

    @property
    def finer(self) -> dict[str, float]:
        """Parameters of the run that all are held against."""
        return {**self.parameters, "elements": self.finest} if self.finest else self.parameters

    def tasks(self, structure: SceneType, steps: int | None) -> list[dict]:
        """What Exudyn is asked, by mesh; steps: how many are tried, the coarsest first."""
        meshes = [self.parameters, *({**self.parameters, "elements": n} for n in self.meshes)]
        return [
            {
                "structure": describe(structure.build(**parameters), self.ignore),
                "planar": self.planar,
                "duration": self.duration,
                "instants": INSTANTS,
                "runs": [
                    {
                        **solver,
                        "step": step,
                        "name": f"step {step:g} s, {solver['name']}" + _mesh(parameters),
                    }
                    for step in self.steps[:steps]
                    for solver in SOLVERS[self.tolerance]
                ],
            }
            for parameters in meshes
        ]


def _mesh(parameters: Mapping[str, float]) -> str:
    return f", {parameters['elements']:g} elements" if "elements" in parameters else ""


CASES = (
    Case("solar_array", "solar array, 3 panels on a free hub, before a latch catches", "end", 3.0,
         "k", (0.1, 0.05, 0.025, 0.01, 0.005, 0.001), ignore=("Friction", "Latch")),
    Case("nfourbar", "two four-bars of rigid rods, through their singular position", "B0", 2.0,
         "v", (0.04, 0.02, 0.01, 0.005, 0.001), step=0.01),
    Case("scissor", "scissor mast, 3 units of elastic bars", "end", 0.6, "k",
         (0.02, 0.01, 0.005, 0.002, 0.001), parameters={"elements": 2}, meshes=(8,), finest=8),
    Case("bricard", "Bricard's six-bar of elastic rods", "C", 1.2, "rho",
         (0.03, 0.02, 0.01, 0.005, 0.001), planar=False, parameters={"E": 5.0, "elements": 2},
         meshes=(4,), finest=4),
)  # fmt: skip


def exudyn(repeats: int, cases=CASES, steps: int | None = None) -> list[Row]:
    """Rows of all cases; steps: how many of Exudyn's are tried, the coarsest first."""
    python = compare.interpreter()
    if python is None:
        reason = "not installed: pip install -e '.[peer-exudyn]'"
        return [skip_row(f"{case.text}: Exudyn against ours", reason, "x") for case in cases]
    return [row for case in cases for row in _rows(case, python, repeats, steps)]


@dataclass(frozen=True)
class Run:
    """A run, its places (instants, 3) m and how many steps it took, and seconds of cpu a sample.

    batch: one of a batch, single: by itself, set_up: packing and handing back one of a batch,
    build_time: making its scene from the file, among those of the batch."""

    places: np.ndarray
    steps: int
    batch: float
    single: float
    set_up: float
    build_time: float


def _rows(case: Case, python: str, repeats: int, steps: int | None) -> list[Row]:
    structure = structures.load(FOLDER / f"{case.name}.yaml")
    fine = _fine(case, structure)
    distance = float(np.linalg.norm(fine - fine[0], axis=1).max())
    run, answers = _measure(case, structure, python, repeats, steps)
    deviation = _deviation(run.places, fine, distance)
    note = f"{run.steps} steps{_mesh(case.parameters)}, error {deviation:.2g} of the way; "
    note += f"{run.set_up / run.batch:.0%} of it is set-up; {1e3 * run.build_time:.2g} ms more to "
    note += "build the scene from its file"
    batch = f"{case.text}: ours, a sample of a batch of {SAMPLES}"
    rows = [
        info(batch, run.batch / case.duration, compare.COST, note),
        info(f"{case.text}: ours, alone", run.single / case.duration, compare.COST),
    ]
    right = []
    for answer in answers:
        name = f"{case.text}: Exudyn, {answer['name']}"
        if not answer["ok"]:
            error = answer.get("error", "not finite").splitlines()[0]
            rows.append(info(name, "none", compare.COST, f"breaks down: {error}"))
            continue
        miss = _deviation(np.array(answer["points"][case.point]), fine, distance)
        right.append((miss, answer))
        note = f"error {miss:.2g} of the way; {1e3 * answer['building']:.2g} ms more to build it"
        rows.append(info(name, answer["cpu"] / case.duration, compare.COST, note))
    text = f"{case.text}: motion of '{case.point}', Exudyn's most accurate run against ours"
    source = f"ours with {f'{case.finest} elements' if case.finest else 'a quarter of the step'}"
    best_off = min((miss for miss, _ in right), default=np.inf)
    rows.append(at_most(text, best_off, case.tolerance, source, unit="of the way"))
    return rows + _ratios(case, run, deviation, right)


def _ratios(case: Case, run: Run, deviation: float, right: list[tuple[float, dict]]) -> list[Row]:
    """Exudyn's fastest run that agrees, and that is as accurate as ours, against ours.

    run: ours; deviation: its error; right: errors and answers of Exudyn's runs, shares of the way.
    """
    pairs = [pair for pair in right if pair[0] <= case.tolerance]
    if not pairs:
        return []
    miss, fastest = min(pairs, key=lambda pair: pair[1]["cpu"])
    name = f"{case.text}: Exudyn {fastest['version']} against ours"
    note = f"its {fastest['name']}, error {miss:.2g}, the fastest that agrees to "
    note += f"{case.tolerance:g}; ours with steps of {case.duration / run.steps:.2g} s, error "
    note += f"{deviation:.2g}"
    loops = fastest["cpu"] / max(run.batch - run.set_up, 1e-9)
    whole = (fastest["cpu"] + fastest["building"]) / (run.batch + run.build_time)
    least = min(miss for miss, _ in pairs)
    accurate = [pair for pair in pairs if pair[0] <= max(deviation, least)]
    miss, equal = min(accurate, key=lambda pair: pair[1]["cpu"])
    as_ours = f"its {equal['name']}, error {miss:.2g}"
    as_ours += "; none is as accurate as ours" if miss > deviation else ""
    return [
        at_least(f"{name}, a sample of a batch", fastest["cpu"] / run.batch, 100.0, "", note, "x"),
        info(f"{name}, the time loops alone", loops, "x"),
        info(f"{name}, with building the scenes", whole, "x"),
        info(f"{name}, a sample alone", fastest["cpu"] / run.single, "x"),
        at_least(f"{name}, as accurate", equal["cpu"] / run.batch, 100.0, "", as_ours, "x"),
    ]


def _fine(case: Case, structure: SceneType) -> np.ndarray:
    """Places (instants, 3) m of the run that all others are held against."""
    scene = structure.build(**case.finer)
    step = _step(case, [scene]) / (1 if case.finest else 4)
    (outcome,) = fpm.simulate(scene, duration=case.duration, instants=INSTANTS, step=step)
    return _places(case, outcome)


def _places(case: Case, outcome: fpm.Outcome) -> np.ndarray:
    if outcome.failure is not None:
        raise outcome.failure
    return outcome.points[case.point][0]


def _deviation(places: np.ndarray, fine: np.ndarray, distance: float) -> float:
    """Root mean square of the distance, as a share of the way."""
    return float(np.sqrt(np.mean(np.sum((places - fine) ** 2, axis=1)))) / distance


def _step(case: Case, scenes: list[fpm.Scene]) -> float:
    return case.step or 0.9 * min(fpm.find_stable_step(scene).step for scene in scenes)


def _measure(case: Case, structure: SceneType, python: str, repeats: int, steps: int | None):
    """Our run, and Exudyn's answers with the least cpu times: in turns, the best of several."""
    middle = structure.parameters[case.varies].default

    shares = np.linspace(-0.01, 0.01, SAMPLES)
    samples = [{**case.parameters, case.varies: middle * (1 + share)} for share in shares]
    scenes = structure.build_all(samples)
    step = _step(case, [scenes[0], scenes[-1]])
    plain = structure.build(**case.parameters)
    (outcome,) = fpm.simulate(plain, duration=case.duration, instants=INSTANTS, step=step)

    def run(batch: list[fpm.Scene], duration: float, instants: int) -> None:
        fpm.simulate(batch, duration=duration, instants=instants, step=step)

    calls = {
        "batch": lambda: run(scenes, case.duration, INSTANTS),
        "single": lambda: run(scenes[:1], case.duration, INSTANTS),
        "set_up": lambda: run(scenes, step, 2),
        "build_time": lambda: structure.build_all(samples),
    }
    least, answers = dict.fromkeys(calls, np.inf), []
    tasks = case.tasks(structure, steps)
    for _ in range(repeats):
        seconds_by_call = best(calls, 1)
        least = {name: min(seconds_by_call[name], seconds) for name, seconds in least.items()}
        new = [answer for task in tasks for answer in compare.ask(python, task)]
        answers = [_faster(*pair) for pair in zip(answers or new, new, strict=True)]
    for name in ("batch", "set_up", "build_time"):
        least[name] /= SAMPLES
    return Run(_places(case, outcome), outcome.steps, **least), answers


def _faster(a: dict, b: dict) -> dict:
    """The same answer, with the lesser times of both."""
    return a | {key: min(a[key], b[key]) for key in ("cpu", "building") if key in a}
