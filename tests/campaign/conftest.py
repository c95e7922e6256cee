"""Configs for the tests of `campaign`: small scenes and short runs."""

from __future__ import annotations

import copy

import pytest

import campaign
from campaign.folder import Folder

RAW = {
    "campaign": "test",
    "scene": {"name": "bennett", "parameters": {"elements_per_link": 2}},
    "solver": {"duration": 0.004, "instants": 9},
    "intervals": {"a": {"nominal": 0.035, "relative": 0.01}},
    "design": {"method": "tensor_roots", "order": 2},
    "held_out": 2,
    "responses": {"BD": {"distance": ["B", "D"]}, "vBz": {"velocity": "B", "component": "z"}},
    "jobs": {"group": 2},
}


@pytest.fixture
def raw() -> dict:
    """A config as a user writes it."""
    return copy.deepcopy(RAW)


@pytest.fixture
def config(raw) -> dict:
    """The same, checked."""
    return campaign.check_config(raw)


def silent(text: str) -> None:
    """Tell nobody."""


@pytest.fixture(scope="session")
def finished(tmp_path_factory) -> Folder:
    """The files of a campaign of five runs, simulated once."""
    results = tmp_path_factory.mktemp("campaign")
    campaign.run(copy.deepcopy(RAW), results, figures=False, tell=silent)
    return Folder(results / "test")
