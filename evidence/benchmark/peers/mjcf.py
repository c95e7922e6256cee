"""Ten mechanisms as MJCF, by MuJoCo and by us: whether motions agree, and what either costs."""

from __future__ import annotations

import importlib.util
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import fpm
from deployable.campaign.convert import convert
from evidence.benchmark.clock import best
from evidence.rows import Row, at_least, at_most, info, skip_row
from fpm import structures

GROUP = "Ten mechanisms in MuJoCo"
FOLDER = Path(__file__).with_name("models")
POINTS = {
    "bricard": "apex", "cart_pendulum": "bob", "exported": "tool", "four_bar": "tip",
    "free_body": "corner", "sarrus": "deck", "scissor": "top", "slider_crank": "face",
    "solar_array": "tip", "tendon": "grip",
}  # fmt: skip
"""The models, each with the point whose motion is compared."""

DURATION, INSTANTS, SAMPLES = 1.0, 101, 32
TOLERANCE = 1e-3
"""How far motions may be apart at any instant, as a share of the way: bodies are rigid in both."""

STEPS = 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4
INTEGRATORS = "RK4", "IMPLICITFAST"


def load(path: Path) -> Any:
    """A model, compiled, with its keyframe's name: "" where it has none."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(path))
    return model, model.key(0).name if model.nkey else ""


def structure_of(path: Path, folder: Path) -> Any:
    """What the file of a model becomes, at its keyframe if it has one."""
    target = folder / f"{path.stem}.yaml"
    convert(path, target, load(path)[1])
    return structures.load(target)


def simulate(model: Any, keyframe: str = "", duration: float = DURATION) -> dict[str, np.ndarray]:
    """Places (INSTANTS, 3), m, of all sites by name, by MuJoCo, with the step that the model has
    or the next shorter one by which instants are met."""
    import mujoco

    data, pause = mujoco.MjData(model), duration / (INSTANTS - 1)
    if keyframe:
        mujoco.mj_resetDataKeyframe(model, data, model.key(keyframe).id)
    steps = int(np.ceil(pause / model.opt.timestep - 1e-9))
    model.opt.timestep = pause / steps
    mujoco.mj_kinematics(model, data)
    places = [data.site_xpos.copy()]
    for _ in range(INSTANTS - 1):
        mujoco.mj_step(model, data, steps)
        mujoco.mj_kinematics(model, data)
        places.append(data.site_xpos.copy())
    return {model.site(i).name: np.array(places)[:, i] for i in range(model.nsite)}


def distance(places: np.ndarray, reference: np.ndarray) -> float:
    """The largest distance of two motions (instants, 3) of a point, as a share of its way."""
    span = np.linalg.norm(reference - reference[0], axis=1).max()
    return float(np.linalg.norm(places - reference, axis=1).max() / span)


def motion(scene: fpm.Scene, point: str, step: float) -> np.ndarray:
    """Places (INSTANTS, 3), m, of a point by us, with at most a step (s) and the stable one."""
    step = min(step, 0.9 * fpm.find_stable_step(scene).step)
    (outcome,) = fpm.simulate([scene], duration=DURATION, instants=INSTANTS, step=step)
    if outcome.failure is not None:
        raise outcome.failure
    return outcome.points[point][0]


def compare(repeats: int, step: float = 2e-3, names: Any = POINTS, steps: Any = STEPS) -> list[Row]:
    """Rows of all models: MuJoCo's most accurate run against ours at a quarter of its step, and the
    cpu time of its fastest run that is as accurate as ours, against a sample of a batch."""
    if importlib.util.find_spec("mujoco") is None:
        return [skip_row(f"{name}: MuJoCo", "pip install -e '.[mjcf]'", "x") for name in names]
    with tempfile.TemporaryDirectory() as folder:
        return [row for name in names for row in _rows(name, Path(folder), repeats, step, steps)]


def _rows(name: str, folder: Path, repeats: int, step: float, steps: Any) -> list[Row]:
    path, point = FOLDER / f"{name}.xml", POINTS[name]
    structure = structure_of(path, folder)
    scene = structure.build()
    step = min(step, 0.9 * fpm.find_stable_step(scene).step)
    fine = motion(scene, point, step / 4)
    error = distance(motion(scene, point, step), fine)
    runs, misses = {}, {}
    for integrator in INTEGRATORS:
        for h in steps:
            key = f"{integrator}, step {h:g} s"
            runs[key] = partial(simulate, *_prepare(path, integrator, h))
            misses[key] = distance(runs[key]()[point], fine)
    first = [(name, p.default) for name, p in structure.parameters.items()][:1]
    shares = np.linspace(0.99, 1.01, SAMPLES)
    batch = structure.build_all([{name: value * x for name, value in first} for x in shares])

    run = partial(fpm.simulate, batch, duration=DURATION, instants=INSTANTS, step=0.98 * step)
    least = min(misses.values())
    right = [key for key, miss in misses.items() if miss <= max(error, least, 1e-5)]
    seconds = best({"ours": run, **{key: runs[key] for key in right}}, repeats)
    fastest = min(right, key=lambda key: seconds[key])
    note = f"its {fastest}, error {misses[fastest]:.2g}; ours with steps of {step:.2g} s, error "
    ratio = seconds[fastest] / (seconds["ours"] / SAMPLES)
    return [
        at_most(f"{name}: MuJoCo's most accurate run against ours", least, TOLERANCE,
                "ours with a quarter of the step", unit="of the way"),
        info(f"{name}: ours, a sample of a batch of {SAMPLES}", seconds["ours"] / SAMPLES, "cpu s"),
        at_least(f"{name}: MuJoCo's fastest run as accurate, against ours", ratio, 1.0, "",
                 f"{note}{error:.2g}", "x"),
    ]  # fmt: skip


def _prepare(path: Path, integrator: str, step: float) -> tuple[Any, str]:
    """A model and its keyframe, with loops and friction as stiff as the step allows."""
    import mujoco

    model, keyframe = load(path)
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator}")
    model.opt.timestep = step
    for solref in (model.eq_solref, model.dof_solref):
        solref[:] = np.maximum([2 * step, 1.0], solref)
    return model, keyframe
