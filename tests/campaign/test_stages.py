"""Stages: their sections, and the code by which it is known when they must run again."""

from __future__ import annotations

import shutil
import subprocess
import sys
from importlib import import_module
from inspect import signature
from pathlib import Path

import pytest

from deployable import campaign
from deployable.campaign.config.sections import as_json
from deployable.campaign.stages import OPTIONS, STAGES, stages_of
from deployable.campaign.stages.workflow import Workflow

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("asked", ["nothing more", "all", "an accuracy"])
def test_stages_take_what_those_before_leave(raw, asked):
    quantities = {"quantities": {"most": {"largest": "BD"}}}
    limits = {"requirements": {"wide": {"most": {"at_most": 0.2}}}}
    choose = {"choose": {"parameters": {"a": [0.034, 0.036]}, "minimise": ["upper(most)"]}}
    if asked == "an accuracy":
        raw = {key: raw[key] for key in raw if key not in ("design", "held_out")}
    more = {"nothing more": {}, "all": quantities | limits | choose, "an accuracy": {"accuracy": 1}}
    whole, left = campaign.check_config(raw | more[asked]), set()
    for stage in stages_of(whole):
        assert left >= set(stage.inputs(whole))
        assert left.isdisjoint(stage.leaves(whole))
        left |= set(stage.leaves(whole))
    assert left >= {"plan.json", "bounds.nc", "summary.json", "report.html"}
    assert ("choice.json" in left) == (asked == "all")


@pytest.mark.parametrize("name", STAGES)
def test_the_work_of_a_stage_takes_its_sections_and_options(name):
    work = import_module(f"deployable.campaign.stages.{name}").work
    stage = STAGES[name]
    assert {*signature(work).parameters} == {"folder", "notify", *stage.sections, *stage.options}
    assert {*stage.options} <= {*OPTIONS}


@pytest.mark.parametrize("name", STAGES)
def test_sections_of_a_stage_survive_json(raw, name):
    stage, whole = STAGES[name], campaign.check_config(raw)
    sections = stage.sections_of(whole)
    assert stage.sections_in(as_json(**sections)) == sections


NOT_LOADED = {
    "plan": {"matplotlib", "xarray", "numba", "netCDF4"},
    "simulate": {"matplotlib", "xarray", "numba"},
    "bounds": {"matplotlib", "numba"},
    "answers": {"matplotlib", "xarray", "numba"},
    "figures": {"xarray", "numba", "scipy.linalg", "scipy.sparse"},
}
"""Packages that a stage does not load for its work, where no run is made for it."""


@pytest.mark.parametrize("name", NOT_LOADED)
def test_the_work_of_a_stage_loads_what_it_needs(finished, raw, tmp_path, name):
    folder = shutil.copytree(finished.path, tmp_path / "test")
    sections = Workflow(campaign.check_config(raw), tmp_path).sections(name)
    code = f"""
import sys
import deployable.__main__
from deployable.campaign.cli import main
assert main([{name!r}, {str(folder)!r}, "--config", {sections!r}]) == 0
print([name for name in {[*NOT_LOADED[name]]} if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stdout.splitlines()[-1:] == ["[]"], done.stdout + done.stderr
