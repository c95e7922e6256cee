"""Stages: their sections, and the code by which it is known when they must run again."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from deployable import campaign
from deployable.campaign import stages
from deployable.campaign.config.sections import as_json
from deployable.campaign.stages import STAGES

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    "file",
    [
        "deployable/campaign/report/page.html",
        "deployable/intervals/box.py",
        "fpm/reading/stress.py",
    ],
)
def test_any_change_of_the_program_counts_and_a_remark_does_not(tmp_path, monkeypatch, file):
    for room in ("deployable", "fpm"):
        nothing = shutil.ignore_patterns("__pycache__", "shipped")
        shutil.copytree(ROOT / room, tmp_path / room, ignore=nothing)
    monkeypatch.setattr(stages, "__file__", str(tmp_path / "deployable/campaign/stages.py"))
    digest = stages.program_digest.__wrapped__
    before, path = digest(), tmp_path / file
    with path.open("a") as end:
        end.write("" if path.suffix == ".html" else "\n# A remark.\n")
    assert digest() == before
    with path.open("a") as end:
        end.write("\nMORE = 1\n")
    assert digest() != before


@pytest.mark.parametrize("name", STAGES)
def test_sections_of_a_stage_survive_json(raw, name):
    stage, whole = STAGES[name], campaign.check_config(raw)
    sections = stage.sections_of(whole)
    assert stage.typed(json.loads(as_json(**sections))) == sections
