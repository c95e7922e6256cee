"""Stages: their sections, and the code by which it is known when they must run again."""

from __future__ import annotations

from importlib import import_module
from inspect import signature

import pytest

from deployable import campaign
from deployable.campaign.stages import OPTIONS, STAGES, stages_of


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
    options = {*stage.options} - {"since"}  # of the command alone, which calls stages before
    assert {*signature(work).parameters} == {"folder", "notify", *stage.sections, *options}
    assert {*stage.options} <= {*OPTIONS}
