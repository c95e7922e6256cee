"""A motion without a simulation, and a small campaign."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from swing import CONFIG

from deployable import campaign
from deployable.campaign.config.sections import scene_type
from fpm.files.trajectory import Curves

FRAMES = 7


@pytest.fixture(scope="session")
def motion():
    """The Bennett linkage thrown into the air, every particle turning at a rate of its own."""
    from fpm.solver.motion import RecordedMotion, element_strains, section_corners, to_dataset

    scene = scene_type("bennett").build(elements=3)
    scene.name = 'a "thrown" linkage & more'
    count, time = len(scene.position), np.linspace(0.0, 0.6, FRAMES)
    rate = np.random.default_rng(1).normal(scale=4.0, size=(count, 3))
    turn = Rotation.from_rotvec((time[:, None, None] * rate).reshape(-1, 3)).as_matrix()
    frame = turn.reshape(FRAMES, count, 3, 3) @ scene.frame
    position = scene.position + time[:, None, None] * [1.0, 2.0, 3.0]
    points = {
        name: (position[:, p.particle] + frame[:, p.particle] @ p.arm, np.zeros((FRAMES, 3)))
        for name, p in scene.points.items()
    }
    outcome = Curves(time, points, {}, {}, np.zeros((0, 3)), (), 0, 0.1)
    strains = element_strains(scene, position, frame)
    shown = np.arange(FRAMES)
    found = RecordedMotion(scene, outcome, shown, position, 0.0 * position + 1.5, frame, *strains)
    return to_dataset(found, section_corners(scene), {"run_id": "abc"})


@pytest.fixture(scope="session")
def results(tmp_path_factory):
    """The folder of a campaign with one parameter and one response, run once."""
    results = tmp_path_factory.mktemp("results")
    campaign.run(CONFIG, results, figures=False, notify=lambda text: None)
    return results / CONFIG["campaign"]


@pytest.fixture(scope="session")
def strung(motion):
    """The same with two cables: one straight, and one over a point of a bar, slack at times."""
    on = np.array([0, 3, 1, 5, 9], dtype=np.int32)
    arm = np.random.default_rng(2).normal(scale=0.05, size=(5, 3))
    tension = np.stack([np.full(FRAMES, 20.0), np.maximum(0.0, 3.0 - np.arange(FRAMES))], axis=1)
    return motion.assign(
        cable_tension=(("time", "cable"), tension),
        cable_point_cable=("cable_point", np.array([0, 0, 1, 1, 1], dtype=np.int32)),
        cable_point_particle=("cable_point", on),
        cable_point_arm=(("cable_point", "axis"), arm),
    )


@pytest.fixture(scope="session")
def cable_places(strung):
    """Where the cables' points (t, 5, 3) are, by hand."""
    on, arm = strung["cable_point_particle"].values, strung["cable_point_arm"].values
    turned = [[f[p] @ a for p, a in zip(on, arm, strict=True)] for f in strung["frame"].values]
    return strung["position"].values[:, on] + np.array(turned)


@pytest.fixture(scope="session")
def hub():
    """A rigid body without any bar, thin as a rod, that turns."""
    import fpm
    from fpm.solver.motion import RecordedMotion, to_dataset

    scene = fpm.Scene("hub")
    scene.add_particles((0.5, 0, 0), 2.0, (1e-12, 2 / 12, 2 / 12))  # 1 m long
    time = np.array([0.0, 0.1])
    frame = Rotation.from_rotvec([[0, 0, 0], [0, 0, 0.5]]).as_matrix()[:, None]
    outcome = Curves(time, {}, {}, {}, np.zeros((0, 3)), (), 0, 0.1)
    position, none = np.tile([0.5, 0.0, 0.0], (2, 1, 1)), np.zeros((2, 0))
    found = RecordedMotion(
        scene, outcome, np.arange(2), position, 0.0 * position, frame, none, none
    )
    return to_dataset(found, np.zeros((0, 2, 4, 3)), {})
