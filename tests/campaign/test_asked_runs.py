"""Responses that are recorded only when asked, in a campaign: what is simulated again, and told."""

import copy

import numpy as np
import pytest
from stored_runs import curves_in

from deployable import campaign
from deployable.campaign.answers.estimate import describe_work
from deployable.campaign.folder import Folder
from deployable.campaign.stages.workflow import Workflow
from fpm.reading.variables import VARIABLES

pytestmark = pytest.mark.slow  # time loops of their own

STRESS = {"stress": {"stress": "all"}}
SPIN = {"spin": {"angular_velocity": "B", "component": "norm"}}


def recorded(*runs):
    """What runs recorded on request."""
    return {column for curves in runs for column in curves.columns if column[0] in VARIABLES}


def describe(config, folder):
    """What is told of the work where all results are there, but not all runs perhaps."""
    workflow = Workflow(config, folder.path.parent)
    workflow.list_stages = lambda is_incomplete, _: ["simulate"] if is_incomplete else []
    return describe_work(workflow)


def run(raw, folder, **responses):
    """Run a campaign with further responses; what it told."""
    config, told = copy.deepcopy(raw), []
    config["responses"] |= responses
    campaign.run(config, folder, figures=False, notify=told.append)
    return campaign.check_config(config), "\n".join(told)


def test_what_was_not_recorded_is_simulated_again_once_and_keeps_the_rest(raw, tmp_path):
    folder = Folder(tmp_path / "test")
    config, told = run(raw, tmp_path)
    assert "simulated again" not in told
    assert describe(config, folder).startswith("test, nothing to be done")
    files = sorted(folder.runs("trajectories").glob("*.nc"))
    plain = curves_in(folder.runs("trajectories"))
    assert not recorded(*plain.values())

    asking = campaign.check_config({**raw, "responses": {**raw["responses"], **STRESS}})
    said = describe(asking, folder)
    assert said.endswith("; 0 of them are there, others lack stress of all")
    assert said.startswith("test, at most 6 runs, about ")
    _, told = run(raw, tmp_path, **STRESS)
    assert "lack stress of all; they are simulated again" in told
    assert describe(asking, folder).startswith("test, nothing to be done")

    _, told = run(raw, tmp_path, **SPIN)
    assert "lack angular velocity of B x, B y, B z; they" in told
    config, told = run(raw, tmp_path, **STRESS, **SPIN)  # the last had not recorded the stress
    assert "lack stress of all; they are simulated again" in told
    assert sorted(folder.runs("trajectories").glob("*.nc")) == files
    after = curves_in(folder.runs("trajectories"))
    for name, before in plain.items():
        curves = after[name]
        assert recorded(curves) == set(config.experiment.record)
        for point, tracks in before.points.items():
            assert np.array_equal(tracks, curves.points[point])


def test_their_quantities_have_intervals(raw, tmp_path):
    """The largest stress of a few milliseconds, which instants alone miss: with ends that were
    simulated."""
    raw["responses"] |= STRESS
    raw["quantities"] = {"peak": {"largest": "stress"}}
    campaign.run(raw, tmp_path, figures=False, notify=lambda text: None)
    folder = Folder(tmp_path / "test")
    import xarray

    with xarray.open_dataset(folder.quantities) as quantities:
        assert quantities["quantity_units"].values.tolist() == ["Pa"]
        assert 0 < quantities["lower"][0] < quantities["upper"][0] < 1e9
    with xarray.open_dataset(folder.samples) as samples:
        stress = samples["values"].sel(response="stress")
        peaks = stress.max("time").values
        ratios = samples["quantities"][:, 0].values / peaks  # read between the instants, too
        assert (ratios > 0.999).all() and (ratios < 3).all()


def test_with_responses_only_they_are_there_too(raw, tmp_path):
    raw["responses"] |= STRESS
    raw["jobs"] = {"group": 2, "keep": "responses"}
    bounds = campaign.run(raw, tmp_path, figures=False, notify=lambda text: None)
    assert bounds["response_units"].sel(response="stress") == "Pa"
    said = describe(campaign.check_config(raw), Folder(tmp_path / "test"))
    assert said.startswith("test, nothing to be done")


def test_memory_counts_what_responses_ask(raw):
    raw["solver"] = {"duration": 1.0, "instants": 400_000, "step": "auto"}
    campaign.check_config(raw)
    raw["responses"] |= STRESS
    with pytest.raises(campaign.ConfigError, match="what its responses ask for; allowed: at most"):
        campaign.check_config(raw)
