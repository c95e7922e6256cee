"""`accuracy.max_runs` holds for all that makes runs: drawn campaigns of a rigid panel."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from deployable import campaign
from deployable.campaign.config.check import check_config
from deployable.campaign.files import read_json
from deployable.campaign.runs import batch

FLAP = Path(__file__).parent / "designs/flap.yaml"
INTERVALS = {
    "k": {"lower": 0.05, "upper": 0.3},
    "dry": {"lower": 0.0, "upper": 0.08},
    "warm": {"relative": 0.5},
    "end": {"lower": 80, "upper": 100},
}
QUANTITIES = {
    "t_lock": {"event": "latches"},
    "t_half": {"crossing": "open", "level": "45 deg"},
    "top": {"largest": "open"},
}


def draw(seed: int) -> dict:
    """A campaign of one to four intervals and one to three quantities, with a limit of 45 to 119
    runs; some with a requirement, or a choice, for which there are 100 more."""
    rng = np.random.default_rng(seed)
    names = list(QUANTITIES)[: rng.integers(1, 4)]
    raw = {
        "campaign": "limited",
        "scene": {"file": str(FLAP)},
        "solver": {"duration": 2.5, "instants": 101, "safety": 0.1},
        "intervals": {n: INTERVALS[n] for n in list(INTERVALS)[: rng.integers(1, 5)]},
        "responses": {"open": {"opening": "hinge"}},
        "quantities": {name: QUANTITIES[name] for name in names},
        "accuracy": {"tolerance": 0.01, "max_runs": int(rng.integers(45, 120))},
    }
    if seed % 2:
        raw["requirements"] = {"soon": {"t_lock": {"at_most": float(rng.uniform(0.5, 3.0))}}}
    if seed % 3 == 0:
        raw["accuracy"]["max_runs"] += 100
        raw["choose"] = {"parameters": {"end": [80, 100]}, "minimise": ["upper(t_lock)"]}
    return raw


@pytest.mark.slow  # a time loop of its own
@pytest.mark.parametrize("seed", [33])  # with a requirement and a choice
def test_no_campaign_makes_more_runs_than_its_limit(seed, tmp_path, monkeypatch):
    made, simulate = set(), batch.simulate

    def count(plan, runs):
        made.update(run.id for run in runs)
        return simulate(plan, runs)

    monkeypatch.setattr(batch, "simulate", count)
    raw = draw(seed)
    campaign.run(raw, tmp_path, figures=False, notify=lambda text: None)
    told = read_json(tmp_path / "limited/summary.json")["runs"]["all"]
    assert len(made) <= told <= raw["accuracy"]["max_runs"]


def test_a_limit_that_allows_no_check_is_refused():
    raw = draw(2) | {"accuracy": {"max_runs": 1}}
    with pytest.raises(campaign.ConfigError, match="allowed: at least") as refused:
        check_config(raw)
    least = int(str(refused.value).split()[-1])
    check_config(raw | {"accuracy": {"max_runs": least}})
    with pytest.raises(campaign.ConfigError, match="too few"):
        check_config(raw | {"accuracy": {"max_runs": least - 1}})
