"""In which order a config names things, and how, changes nothing else."""

from __future__ import annotations

import copy
import json
import re
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
import xarray as xr

from deployable import campaign, intervals
from deployable.campaign.config.sections import plain_data

INTERVALS = {"a": {"relative": 0.01}, "E": {"relative": 0.0}, "rho": {"relative": 0.02}}
DESIGNS = {
    "tensor_roots": {"order": 1},
    "tensor_lobatto": {"order": "auto", "budget": 9, "tolerance": 1e-9},
    "total_degree": {"order": 2},
    "smolyak": {"order": "auto", "budget": 9, "tolerance": 1e-9},
    "scan": {"samples": 8},
}


def told(raw, names):
    """The campaign whose intervals are named in an order."""
    ordered = {name: INTERVALS[name] for name in names}
    return campaign.check_config({**copy.deepcopy(raw), "intervals": ordered})


@pytest.mark.parametrize("method", DESIGNS)
def test_a_campaign_does_not_know_in_which_order_its_parameters_were_named(raw, method):
    raw["design"] = {"method": method, **DESIGNS[method]}
    first = told(raw, INTERVALS)
    for names in permutations(INTERVALS):
        other = told(raw, names)
        assert plain_data(other) == plain_data(first)
        assert list(other.experiment.intervals) == list(first.experiment.intervals)


@pytest.mark.parametrize(("order", "names"), [(2, ("a", "E")), ("auto", ("E", "a"))])
def test_an_interval_without_width_does_not_hide_another(raw, tmp_path, order, names):
    raw["design"] = {"method": "tensor_lobatto", "order": order, "budget": 5}
    raw["intervals"] = {name: INTERVALS[name] for name in names}
    both = campaign.run(raw, tmp_path / "both", figures=False, tell=lambda text: None)
    raw["intervals"] = {"a": INTERVALS["a"]}
    alone = campaign.run(raw, tmp_path / "alone", figures=False, tell=lambda text: None)
    assert float(alone["largest_width"].min()) > 0
    for side in ("lower", "upper", "error"):
        np.testing.assert_allclose(both[side], alone[side], rtol=1e-12, atol=1e-15)


def test_rounds_never_look_for_an_order_where_there_is_no_width(raw, tmp_path):
    """With a tolerance that nothing meets."""
    raw["design"] = {"method": "tensor_lobatto", "order": "auto", "budget": 9, "tolerance": 1e-12}
    raw["intervals"] = {name: INTERVALS[name] for name in ("a", "E")}
    found = campaign.run(raw, tmp_path, figures=False, tell=lambda text: None)
    place = found["parameter"].values.tolist().index("E")
    rounds = json.loads((tmp_path / "test" / "summary.json").read_text())["adaptive"]["rounds"]
    assert len(rounds) > 1
    for row in rounds:
        assert row["order"][place] == 0
        assert "E" not in re.findall(r"\w+", row["reason"])


def test_a_box_that_is_split_has_bounds_and_influences(raw, tmp_path, monkeypatch):
    """As rounds decide where a response is not smooth; here they do so at once."""
    decide = intervals.decide

    def split(progress):
        now = progress.specification
        if now.parts:
            return intervals.Decision("stop", "", now)
        halves = (((-1.0,), (0.0,)), ((0.0,), (1.0,)))
        return replace(decide(progress), action="split", specification=replace(now, parts=halves))

    monkeypatch.setattr(intervals, "decide", split)
    raw["design"] = {"method": "tensor_lobatto", "order": "auto", "budget": 9}
    halved = campaign.run(raw, tmp_path, figures=False, tell=lambda text: None)
    raw |= {"campaign": "whole", "design": {"method": "tensor_lobatto", "order": 4}}
    whole = campaign.run(raw, tmp_path, figures=False, tell=lambda text: None)
    for side in ("lower", "upper"):
        np.testing.assert_allclose(halved[side], whole[side], rtol=1e-4, atol=1e-6)
    both = [xr.open_dataset(tmp_path / n / "sensitivities.nc") for n in ("test", "whole")]
    np.testing.assert_allclose(both[0]["width"], both[1]["width"], rtol=1e-3, atol=1e-6)


def test_responses_whose_names_begin_alike_keep_their_bounds(raw, tmp_path):
    velocity, place = raw["responses"]["vBz"], {"position": "B", "component": "z"}
    bounds = {}
    for names in (("v_inner", "v"), ("v", "v_inner")):
        raw["responses"] = {names[0]: velocity, names[1]: place}
        run = campaign.run(raw, tmp_path, figures=False, tell=lambda text: None)
        for name, what in zip(names, ("velocity", "place"), strict=True):
            bounds.setdefault(what, []).append(run["upper"].sel(response=name).values)
    for first, second in bounds.values():
        np.testing.assert_array_equal(first, second)
    assert not np.array_equal(bounds["velocity"][0], bounds["place"][0])
