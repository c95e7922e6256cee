"""Presets of a config: what they fill in, and what they leave alone."""

import inspect
import re
from pathlib import Path

import pytest

from deployable import fpm
from deployable.campaign.config.check import check_config, schema
from deployable.campaign.config.design import count_runs
from deployable.campaign.config.presets import PRESETS, mesh_of_preset
from deployable.campaign.errors import ConfigError
from deployable.campaign.plan.make import make_plan

ROOT = Path(__file__).parents[2]


@pytest.fixture
def bare(raw) -> dict:
    """A config that leaves to a preset whatever a preset can say."""
    for key in ("design", "held_out"):
        del raw[key]
    raw["scene"] = {"name": "bennett"}
    return raw


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_fills_in_what_is_absent(bare, name):
    config = check_config({**bare, "preset": name})
    preset, runs = PRESETS[name], config.experiment
    assert runs.scene.parameters["elements_per_link"] == preset["elements"]
    assert runs.design.method == "smolyak"
    assert runs.design.order == preset["order"]
    assert runs.held_out == preset["held_out"]
    assert runs.solver.safety == preset["safety"]
    assert runs.solver.duration == 0.004
    assert config.bounds.model == "spline"


def test_presets_cost_more_and_more(bare):
    runs = [count_runs(check_config({**bare, "preset": n}).experiment) for n in PRESETS]
    meshes = [preset["elements"] for preset in PRESETS.values()]
    assert runs == sorted(runs)
    assert meshes == sorted(set(meshes))


def test_what_the_config_says_wins(raw):
    with_preset = check_config({**raw, "preset": "reference"}).experiment
    assert with_preset.scene.parameters["elements_per_link"] == 2
    assert with_preset.design == check_config(raw).experiment.design
    assert with_preset.held_out == 2


@pytest.mark.parametrize(
    "bounds", [{"model": "polynomial"}, {"align": "shift"}, {"align": "stretch", "enclose": True}]
)
def test_a_presets_spline_makes_way(bare, bounds):
    config = check_config({**bare, "preset": "draft", "bounds": bounds})
    assert config.bounds.model == "polynomial"


def test_a_preset_takes_no_spline_with_another_design_or_too_many_runs(bare):
    own = check_config({**bare, "preset": "draft", "design": {"method": "scan", "samples": 50}})
    assert own.bounds.model == "polynomial"
    names = ("L", "a", "E", "rho", "K_C", "K_F")
    models = {}
    for count in (5, 6):
        bare["intervals"] = {name: {"relative": 0.001} for name in names[:count]}
        models[count] = check_config({**bare, "preset": "reference"}).bounds.model
    assert models == {5: "spline", 6: "polynomial"}  # 3,281 and 9,017 runs


def test_another_scene_gets_its_own_mesh(bare):
    bare |= {
        "scene": {"name": "pendulum"},
        "intervals": {"L": {"relative": 0.01}},
        "responses": {"x": {"position": "T", "component": "x"}},
        "preset": "draft",
    }
    parameters = check_config(bare).experiment.scene.parameters
    assert parameters == {"elements": PRESETS["draft"]["elements"]}


def test_an_unknown_preset_is_refused(bare):
    with pytest.raises(ConfigError, match=r"preset.*'quick'.*draft"):
        check_config({**bare, "preset": "quick"})


def test_the_presets_scene_may_be_unknown(bare):
    with pytest.raises(ConfigError, match="sarrus"):
        check_config({**bare, "scene": {"name": "sarrus"}, "preset": "draft"})


def test_all_say_the_same_about_a_preset():
    """The README, the trade study's page and the presets themselves."""
    readme, page = ((ROOT / name).read_text() for name in ("README.md", "docs/tradeoff.md"))
    for name, preset in PRESETS.items():
        told = re.search(rf"- `preset: {name}`: (\d+) elements[^,]*, .*?order (\d+)", readme)
        assert told, name
        assert [*map(int, told.groups())] == [preset["elements"], preset["order"]]
        row = re.search(rf"^\| `{name}` \| (\d+) \| (\d+) \| (\d+) \| (\d+) runs", page, re.M)
        assert row, name
        *numbers, runs = map(int, row.groups())
        assert numbers == [preset["elements"], preset["order"], preset["held_out"]]
        one = {"a": {"relative": 0.01}}
        raw = {"campaign": "x", "scene": {"name": "bennett"}, "preset": name, "intervals": one}
        raw["responses"] = {"BD": {"distance": ["B", "D"]}}
        plan = make_plan(check_config(raw).experiment)
        assert len(plan.unique_runs()) == runs


def test_the_safety_of_the_time_step_is_the_mechanics():
    safety = inspect.signature(fpm.simulate).parameters["safety"].default
    solver = schema()["properties"]["solver"]["properties"]
    assert solver["safety"]["default"] == safety
    assert {preset["safety"] for preset in PRESETS.values()} == {safety}
    assert schema()["properties"]["preset"]["enum"] == list(PRESETS)


def test_the_mesh_that_a_preset_brings_is_told(bare):
    raw = bare | {"preset": "reference", "scene": {"name": "bennett"}}
    told = mesh_of_preset(raw, check_config(raw))
    assert told.startswith("preset reference takes elements_per_link = 32, not the structure's own")
    own = raw | {"scene": {"name": "bennett", "parameters": {"elements_per_link": 10}}}
    assert mesh_of_preset(own, check_config(own)) == ""
    assert mesh_of_preset(bare, check_config(bare)) == ""
