"""Configs for the tests of `campaign`: small scenes and short runs."""

from __future__ import annotations

import copy

import pytest

from deployable import campaign
from deployable.campaign.cli import main
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import make_plan
from deployable.campaign.stages.workflow import Workflow
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
    campaign.run(copy.deepcopy(RAW), results, figures=False, notify=silent)
    return Folder(results / "test")


STAGES = ("simulate", "bounds", "answers", "figures", "page")


@pytest.fixture(scope="session")
def rich(tmp_path_factory) -> tuple[Folder, dict[str, str]]:
    """A campaign with all kinds of results and its page, and the sections of its stages."""
    raw = copy.deepcopy(RAW) | {
        "campaign": "rich",
        "quantities": {"most": {"largest": "BD"}, "end": {"final": "BD"}},
        "requirements": {"wide": {"most": {"at_most": 0.2}}},
        "choose": {"parameters": {"a": [0.034, 0.036]}, "minimise": ["upper(most)"]},
    }
    results = tmp_path_factory.mktemp("rich")
    campaign.run(raw, results, figures=False, notify=silent)
    workflow = Workflow(campaign.check_config(raw), results)
    sections = {stage: workflow.sections(stage) for stage in STAGES}
    assert main(["page", str(workflow.folder.path), "--config", sections["page"]]) == 0
    return workflow.folder, sections
