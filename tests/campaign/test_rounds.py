"""`order: auto`: plans of the rounds, and why they end."""

from __future__ import annotations

from itertools import pairwise

import pytest

from deployable import campaign
from deployable.campaign.config.check import check_config
from deployable.campaign.errors import ConfigError
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.plan.rounds import _named, first_plan


def rounds_of(raw, folder, **design):
    """Plans of all rounds of an adaptive campaign that is really run."""
    raw["design"] = {"method": "tensor_lobatto", "order": "auto", **design}
    campaign.run(raw, folder, figures=False, tell=lambda text: None)
    rounds = sorted((folder / "test" / "rounds").iterdir())
    return [read_plan(Folder(place).plan) for place in rounds]


def nodes(plan):
    return {run.id for run in plan.runs if run.role == "node"}


def order(plan):
    return plan.experiment.design.order[0]


def test_rounds_go_on_until_the_tolerance_is_met(raw, tmp_path):
    raw["intervals"] = {"E": {"relative": 0.3}}
    plans = rounds_of(raw, tmp_path, tolerance=1e-3, budget=65)
    assert plans[-1].adaptive.met
    told = plans[-1].adaptive.rounds
    assert len(told) == len(plans) - 1 > 1
    assert told[-1].error <= 1e-3 < told[-2].error
    assert "E is raised" in told[0].reason
    for before, after in pairwise(plans[:-1]):
        assert nodes(before) < nodes(after)
        assert order(after) == 2 * order(before)


@pytest.mark.slow
def test_a_spent_budget_ends_the_rounds_and_is_told(raw, tmp_path):
    raw["intervals"] = {"E": {"relative": 0.3}}
    plans = rounds_of(raw, tmp_path, tolerance=1e-12, budget=6)
    assert plans[-1].adaptive.met is False
    last = plans[-1].adaptive.rounds[-1]
    assert last.runs <= 6
    assert "budget of 6 runs is spent" in last.reason
    assert plans[-1].runs == plans[-2].runs


def test_an_interval_without_width_gets_no_order(raw):
    raw["intervals"] = {"a": {"absolute": 0}, "E": {"relative": 0.1}}
    raw["design"] = {"method": "tensor_roots", "order": "auto"}
    assert first_plan(check_config(raw).experiment).experiment.design.order == (0, 3)


@pytest.mark.parametrize(
    "change",
    [
        {"design": {"method": "scan", "order": "auto"}},
        {"design": {"order": "auto"}, "bounds": {"align": "stretch"}},
        {"design": {"method": "scan"}, "bounds": {"align": "shift"}},
    ],
)
def test_what_does_not_go_together_is_refused(raw, change):
    with pytest.raises(ConfigError, match=r"(order|align).*is not allowed"):
        check_config({**raw, **change})


def test_reasons_name_the_parameters():
    text = "the order of direction 0, 2 is raised; direction 1 is added"
    assert _named(text, ["a", "E", "K"]) == "the order of a, K is raised; E is added"
