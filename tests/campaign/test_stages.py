"""Stages: their sections, and the code by which it is known when they must run again."""

from __future__ import annotations

import ast
import inspect
import json
from itertools import chain
from pathlib import Path

import pytest

from deployable import campaign
from deployable.campaign.config.sections import as_json
from deployable.campaign.stages import STAGES

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "deployable"


def files(pattern: str) -> set[Path]:
    return set(PACKAGE.glob(pattern))


@pytest.mark.parametrize("name", STAGES)
def test_the_code_of_a_stage_is_there(name):
    for pattern in STAGES[name].code:
        assert files(pattern), f"{name}: {pattern}"


def test_no_file_that_makes_results_is_forgotten():
    known = set(chain(*(files(p) for stage in STAGES.values() for p in stage.code)))
    made = set(
        chain(
            *(
                files(f"campaign/{room}/*.py")
                for room in ("plan", "runs", "results", "answers", "report")
            )
        )
    )
    made |= files("intervals/**/*.py") - files("intervals/**/__init__.py")
    missing = {
        str(path.relative_to(PACKAGE)) for path in made - known if path.name != "__init__.py"
    }
    assert not missing


@pytest.mark.parametrize("name", STAGES)
def test_a_stage_depends_on_the_modules_that_it_calls(name):
    tree = ast.parse(inspect.getsource(STAGES[name].work))
    called = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    if not name.startswith("plan"):
        called -= {"deployable.campaign.plan.plan"}  # the plan is a file that it is given
    known = set(chain(*map(files, STAGES[name].code)))
    for module in called:
        place = ROOT.joinpath(*module.split("."))
        assert (place.with_suffix(".py") if not place.is_dir() else place / "__init__.py") in known


def test_bounds_depend_on_all_of_the_interval_side():
    known = set(chain(*map(files, STAGES["bounds"].code)))
    assert files("intervals/**/*.py") <= known


@pytest.mark.parametrize("name", STAGES)
def test_sections_of_a_stage_survive_json(raw, name):
    stage, whole = STAGES[name], campaign.check_config(raw)
    sections = stage.sections_of(whole)
    assert stage.typed(json.loads(as_json(**sections))) == sections
