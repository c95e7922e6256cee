"""Configs for the tests of `campaign`: small scenes and short runs."""

from __future__ import annotations

import copy

import pytest

RAW = {
    "campaign": "test",
    "scene": {"name": "bennett", "parameters": {"elements_per_link": 2}},
    "solver": {"duration": 0.004, "instants": 9},
    "intervals": {"a": {"nominal": 0.035, "relative": 0.01}},
    "design": {"method": "tensor_roots", "order": 2},
    "held_out": 2,
    "responses": {"BD": {"distance": ["B", "D"]}, "vBz": {"velocity": "B", "component": "z"}},
    "jobs": {"group": 2},
}


@pytest.fixture
def raw() -> dict:
    """A config as a user writes it."""
    return copy.deepcopy(RAW)


@pytest.fixture
def config(raw) -> dict:
    """The same, checked."""
    from campaign.config.check import check_config

    return check_config(raw)


@pytest.fixture(scope="session")
def finished(tmp_path_factory) -> dict:
    """Paths of a campaign of six runs, simulated once: plan, samples, bounds and so on."""
    from campaign.analyse import analyse
    from campaign.config.check import check_config
    from campaign.gather import gather
    from campaign.nodes import make_plan, read_plan, write_plan
    from campaign.run import run_batch

    folder = tmp_path_factory.mktemp("campaign")
    config = check_config(copy.deepcopy(RAW))
    paths = {
        name: folder / file
        for name, file in {
            "plan": "nodes.json",
            "samples": "samples.nc",
            "surrogate": "surrogate.nc",
            "bounds": "bounds.nc",
            "sensitivities": "sensitivities.nc",
            "trajectories": "trajectories",
            "manifest": "0.json",
        }.items()
    }
    write_plan(make_plan(config), paths["plan"])
    plan = read_plan(paths["plan"])
    run_batch(plan, 0, 1, config["jobs"], paths["trajectories"], paths["manifest"])
    gather(plan, 1, config["jobs"], paths["trajectories"], paths["samples"])
    written = (paths[name] for name in ("surrogate", "bounds", "sensitivities"))
    analyse(paths["samples"], config, *written)
    return paths
