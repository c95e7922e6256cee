"""Ten mechanisms as MJCF, by MuJoCo and by us."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import fpm
from deployable.campaign.convert import convert
from fpm import structures

FOLDER = Path(__file__).with_name("models")
POINTS = {
    "bricard": "apex", "cart_pendulum": "bob", "exported": "tool", "four_bar": "tip",
    "free_body": "corner", "sarrus": "deck", "scissor": "top", "slider_crank": "face",
    "solar_array": "tip", "tendon": "grip",
}  # fmt: skip
"""The models, each with the point whose motion is compared."""

DURATION, INSTANTS = 1.0, 101
TOLERANCE = 1e-3
"""How far motions may be apart at any instant, as a share of the way: bodies are rigid in both."""


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
