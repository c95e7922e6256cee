"""`accuracy.max_runs` holds for all that makes runs, requirements and choices among them."""

from __future__ import annotations

from pathlib import Path

import pytest

from deployable import campaign
from deployable.campaign.config.check import check_config
from deployable.campaign.files import read_json
from deployable.campaign.runs import batch

FLAP = Path(__file__).parent / "designs/flap.yaml"
RAW = {
    "campaign": "limited",
    "scene": {"file": str(FLAP)},
    "solver": {"duration": 2.5, "instants": 101, "safety": 0.1},
    "intervals": {
        "k": {"lower": 0.05, "upper": 0.3},
        "dry": {"lower": 0.0, "upper": 0.08},
    },
    "responses": {"open": {"opening": "hinge"}},
    "quantities": {
        "t_lock": {"event": "latches"},
        "t_half": {"crossing": "open", "level": "45 deg"},
        "top": {"largest": "open"},
    },
    "accuracy": {"tolerance": 0.01, "max_runs": 173},
    "requirements": {"soon": {"t_lock": {"at_most": 2.77}}},
    "choose": {"parameters": {"end": [80, 100]}, "minimise": ["upper(t_lock)"]},
}


@pytest.mark.slow  # a time loop of its own
def test_no_campaign_makes_more_runs_than_its_limit(tmp_path, monkeypatch):
    made, simulate = set(), batch.simulate

    def count(plan, runs):
        made.update(run.id for run in runs)
        return simulate(plan, runs)

    monkeypatch.setattr(batch, "simulate", count)
    campaign.run(RAW, tmp_path, figures=False, notify=lambda text: None)
    told = read_json(tmp_path / "limited/summary.json")["runs"]["all"]
    assert len(made) <= told <= RAW["accuracy"]["max_runs"]


def test_a_limit_that_allows_no_check_is_refused():
    raw = {key: RAW[key] for key in RAW if key not in ("requirements", "choose")}
    raw |= {"accuracy": {"max_runs": 1}}
    with pytest.raises(campaign.ConfigError, match="allowed: at least") as refused:
        check_config(raw)
    least = int(str(refused.value).split()[-1])
    check_config(raw | {"accuracy": {"max_runs": least}})
    with pytest.raises(campaign.ConfigError, match="too few"):
        check_config(raw | {"accuracy": {"max_runs": least - 1}})
