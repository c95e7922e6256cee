"""Configs for the tests of `campaign`: small scenes and short runs."""

from __future__ import annotations

import copy

import pytest

from deployable import campaign
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import make_plan
from evidence.attack import victim
from evidence.attack.victim import silent

RAW = {**victim.RAW, "campaign": "test"}


@pytest.fixture
def raw() -> dict:
    """A config as a user writes it."""
    return copy.deepcopy(RAW)


@pytest.fixture
def config(raw) -> dict:
    """The same, checked."""
    return campaign.check_config(raw)


@pytest.fixture(scope="session")
def plan():
    """The plan of the config as it is, made once."""
    return make_plan(campaign.check_config(copy.deepcopy(RAW)).experiment)


@pytest.fixture(scope="session")
def finished(tmp_path_factory) -> Folder:
    """The files of a campaign of five runs, simulated once."""
    results = tmp_path_factory.mktemp("campaign")
    campaign.run(copy.deepcopy(RAW), results, figures=False, tell=silent)
    return Folder(results / "test")
