"""Results in netCDF as objects: what these have is what the files have."""

from __future__ import annotations

import copy
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from deployable import campaign
from deployable.campaign.files import read_json
from deployable.campaign.report import from_results
from deployable.campaign.results.response_bounds import ResponseBounds
from deployable.campaign.results.run_samples import (
    describe_events,
)
from evidence.attack import victim
from fpm.files.seals import DamagedError


def test_the_error_of_a_scan_that_grew_by_nothing_is_not_known():
    zero = np.zeros(3)
    bounds = ResponseBounds("x", "x", "m", zero, zero, zero, "least and largest sample", error=zero)
    assert bounds.known_error is None and bounds.is_unknown(0.0) and not bounds.is_unknown(0.1)
    assert replace(bounds, kind="enclosed range of the polynomial").known_error is zero
    assert replace(bounds, error=np.array([0.0, 1.0, 0.0])).known_error is not None


def test_events_are_told_in_the_order_of_time():
    events = np.array([[0.3, 1, 0], [0.1, 0, 1]])
    told = describe_events(events, ["a", "b"])
    assert told == [{"time": 0.1, "contact": "a", "closing": True},
                    {"time": 0.3, "contact": "b", "closing": False}]  # fmt: skip


@pytest.mark.parametrize("name", ["samples.nc", "bounds.nc", "refinement.nc"])
def test_a_page_is_made_of_whole_results_only(rich, tmp_path, name):
    folder = Path(shutil.copytree(rich[0].path, tmp_path / "rich"))
    content = (folder / name).read_bytes()
    half = len(content) // 2
    (folder / name).write_bytes(content[:half] + bytes([content[half] ^ 1]) + content[half + 1 :])
    with pytest.raises(DamagedError, match=name):
        from_results(folder)
    (folder / name).unlink()
    with pytest.raises(FileNotFoundError, match=name):
        from_results(folder)


@pytest.mark.slow
def test_a_choice_whose_goal_has_no_value_is_told(tmp_path):
    raw = copy.deepcopy(victim.RAW) | {
        "campaign": "none",
        "quantities": {"t": {"event": "closes"}},
        "requirements": {"shuts": {"t": {"happens": True}}},
        "choose": {"parameters": {"a": [0.034, 0.036]}, "minimise": ["upper(t)"]},
    }
    campaign.run(raw, tmp_path, figures=False, notify=lambda message: None)
    choice = read_json(tmp_path / "none/choice.json")
    assert not choice["kept"] and choice["goals"][0]["value"] is None
    assert choice["goals"][0]["at"] == {"a": None}
    assert from_results(tmp_path / "none").facts["choice"]["goals"][0]["value"] is None
