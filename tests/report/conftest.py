"""A small campaign's folder of results, and the page made of it."""

import copy

import numpy as np
import pytest

from deployable import campaign
from deployable.campaign.report import from_results, make_motions, write_page

CONFIG = {
    "campaign": "swing",
    "scene": {"name": "pendulum", "parameters": {"elements": 3, "E": 1e8}},
    "solver": {"duration": 0.4, "instants": 201},
    "intervals": {"L": {"nominal": 1.0, "relative": 0.05}, "a": {"nominal": 0.05, "relative": 0.1}},
    "design": {"method": "tensor_roots", "order": 1},
    "held_out": 3,
    "responses": {
        "x": {"position": "T", "component": "x"},
        "speed": {"velocity": "T", "component": "norm"},
    },
    "published": {"x": 0.25},
}


@pytest.fixture(scope="session")
def results(tmp_path_factory):
    """The folder of a campaign with two parameters and two responses, run once."""
    results = tmp_path_factory.mktemp("results")
    campaign.run(copy.deepcopy(CONFIG), results, figures=False, notify=lambda text: None)
    folder = results / CONFIG["campaign"]
    make_motions(folder, frames=41)
    return folder


@pytest.fixture(scope="session")
def data(results):
    """The page's data of that campaign."""
    return from_results(results)


@pytest.fixture(scope="session")
def page(results, data):
    """The page of that campaign."""
    path = results / "report.html"
    write_page(data, path)
    return path


@pytest.fixture
def bar():
    """A cantilever of 4 elements along x, damped so that it comes to rest."""
    import fpm

    scene = fpm.Scene("cantilever", damping=100.0)
    section, material = fpm.Section.rectangle(0.06, 0.04), fpm.Material(1e9, 0.3, 1000.0)
    link = scene.add_link((0, 0, 0), (1, 0, 0), (0, 0, 1), section, material, 4, "bar")
    scene.fix(link.particles[0])
    scene.add_curve([0.0, 0.2], [0.0, 1.0])
    return scene, link, section, material


@pytest.fixture
def settled(bar):
    """Function of a force (3,) at the tip: the last frame of the cantilever's motion, at rest."""
    import fpm
    from fpm.solver.motion import whole_motion

    def settle(force):
        scene, link, *_ = bar
        scene.add_load(link.particles[-1], force=np.asarray(force, float), curve=0)
        step = fpm.divide_time(0.6, 13, 0.9 * fpm.find_stable_step(scene).step).step
        (motion,) = whole_motion([scene], duration=0.6, instants=13, step=step)
        return motion.isel(time=-1)

    return settle
