"""`order: auto`: plans of the rounds, and why they end."""

from __future__ import annotations

from itertools import pairwise

import pytest

from campaign.adaptive import _named, first_plan, is_finished, next_plan
from campaign.analyse import analyse
from campaign.config import check_config
from campaign.errors import ConfigError
from campaign.gather import gather
from campaign.run import run_batch


def rounds_of(raw, folder, **design):
    """Plans of all rounds of an adaptive campaign that is really run."""
    raw["design"] = {"method": "tensor_lobatto", "order": "auto", **design}
    config = check_config(raw)
    plans = [first_plan(config)]
    while not is_finished(plans[-1]):
        place = folder / str(len(plans))
        place.mkdir()
        runs = folder / "trajectories"
        run_batch(plans[-1], 0, 1, config["jobs"], runs, place / "0.json", lambda text: None)
        gather(plans[-1], 1, config["jobs"], runs, place / "samples.nc")
        written = (place / f"{name}.nc" for name in ("surrogate", "bounds", "sensitivities"))
        analyse(place / "samples.nc", config, *written)
        plans.append(next_plan(config, plans[-1], place / "samples.nc", place / "bounds.nc"))
    return plans


def nodes(plan):
    return {run["id"] for run in plan["runs"] if run["role"] == "node"}


def test_rounds_go_on_until_the_tolerance_is_met(raw, tmp_path):
    raw["intervals"] = {"E": {"relative": 0.3}}
    plans = rounds_of(raw, tmp_path, tolerance=1e-3, budget=65)
    assert plans[-1]["adaptive"]["met"]
    told = plans[-1]["adaptive"]["rounds"]
    assert len(told) == len(plans) - 1 > 1
    assert told[-1]["error"] <= 1e-3 < told[-2]["error"]
    assert "E is raised" in told[0]["reason"]
    for before, after in pairwise(plans[:-1]):
        assert nodes(before) < nodes(after)
        assert after["config"]["design"]["order"][0] == 2 * before["config"]["design"]["order"][0]


def test_a_spent_budget_ends_the_rounds_and_is_told(raw, tmp_path):
    raw["intervals"] = {"E": {"relative": 0.3}}
    plans = rounds_of(raw, tmp_path, tolerance=1e-12, budget=6)
    assert plans[-1]["adaptive"]["met"] is False
    last = plans[-1]["adaptive"]["rounds"][-1]
    assert last["runs"] <= 6
    assert "budget of 6 runs is spent" in last["reason"]
    assert plans[-1]["runs"] == plans[-2]["runs"]


def test_an_interval_without_width_gets_no_order(raw):
    raw["intervals"] = {"a": {"absolute": 0}, "E": {"relative": 0.1}}
    raw["design"] = {"method": "tensor_roots", "order": "auto"}
    assert first_plan(check_config(raw))["config"]["design"]["order"] == [0, 3]


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
