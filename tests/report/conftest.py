"""A small campaign's folder of results, and the page made of it."""

import copy

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
