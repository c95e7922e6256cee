"""Campaigns of structures from text files: from the config to the page."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

from deployable import campaign
from deployable.campaign.config.check import check_config, load_config
from deployable.campaign.errors import CampaignError, ConfigError
from deployable.campaign.plan.plan import make_plan
from deployable.campaign.runs.batch import check_structure
from deployable.campaign.stages.workflow import Workflow

ROOT = Path(__file__).parents[2]

RAW = {
    "campaign": "flap",
    "scene": {"file": "structures/panel.yaml", "parameters": {"elements": 2, "E": 0.1}},
    "solver": {"duration": 2.0, "instants": 201},
    "intervals": {"k": {"lower": 0.08, "upper": 0.12}},
    "design": {"method": "tensor_roots", "order": 4},
    "held_out": 2,
    "responses": {"angle": {"opening": "hinge"}, "x": {"position": "tip", "component": "x"}},
}


@pytest.fixture
def path(tmp_path) -> Path:
    """A campaign's file, with a structure in a folder beside it."""
    shutil.copytree(ROOT / "config" / "structures", tmp_path / "structures")
    path = tmp_path / "flap.yaml"
    path.write_text(yaml.safe_dump(RAW), encoding="utf-8")
    return path


def edit(path: Path, old: str, new: str) -> None:
    """Change a panel's text."""
    panel = path.parent / "structures" / "panel.yaml"
    text = panel.read_text(encoding="utf-8")
    assert old in text
    panel.write_text(text.replace(old, new), encoding="utf-8")


def problems(raw: dict) -> str:
    """What is wrong with a config."""
    with pytest.raises(ConfigError) as refused:
        check_config(raw)
    return "\n".join(refused.value.problems)


def test_the_plan_tells_the_strain_energy_that_forcing_parts_together_leaves(path):
    """The panel's pin is two millimetres too far out, and its tip is held where it is stated."""
    edit(path, "mesh: elements", "mesh: elements\nassemble: true")
    edit(path, "  tip: [", "  seat: [2 mm, 0, 0]\n  tip: [")
    edit(path, "at: root, axis", "at: {ground: seat, panel: root}, axis")
    edit(path, "record:", "supports: {tip: {part: panel, at: tip, rotations: none}}\nrecord:")
    plan = make_plan(load_config([path]).experiment)
    scene = load_config([path]).experiment.build({"k": 0.1})
    assert scene.assembly.gap == pytest.approx(2e-3)
    assert 0 < scene.assembly.energy == pytest.approx(plan.time.assembly_energy, rel=1e-12)


@pytest.mark.slow
def test_an_interval_of_a_file_is_bounded_as_the_closed_form_says(path, tmp_path):
    said = []
    bounds = campaign.run(path, tmp_path / "results", notify=said.append)
    inertia = 1 / 3 + 0.1**2 / 12  # kg m², of length and of thickness
    time = bounds["time"].values
    for k, found in ((0.08, bounds["lower"]), (0.12, bounds["upper"])):
        exact = np.pi * (1 - np.cos(np.sqrt(k / inertia) * time))  # it rests at 180 degrees
        np.testing.assert_allclose(found.sel(response="angle"), exact, atol=2e-4)
    assert bounds.attrs["scene"] == "panel"
    folder = tmp_path / "results" / "flap"
    for name in Workflow(load_config([path])).results():
        assert (tmp_path / name).stat().st_size > 500
    assert " s of `panel`" in (folder / "summary.md").read_text(encoding="utf-8")
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "(stiffness of the spring, ±" in page  # in the headline, from the file's description
    assert len(list((folder / "motions").glob("*.nc"))) > 1


def test_the_path_is_relative_to_the_file_that_has_it(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert load_config([path]).experiment.scene.file == "structures/panel.yaml"
    over = {"scene": {"file": "structures/panel.yaml"}}
    (tmp_path / "else").mkdir()
    monkeypatch.chdir(tmp_path / "else")
    assert load_config([path]).experiment.scene.file == str(tmp_path / "structures/panel.yaml")
    with pytest.raises(ConfigError, match="cannot be read"):
        load_config([path], over)
    monkeypatch.chdir(tmp_path)
    moved = Workflow.from_files([path], over).campaign
    assert moved.experiment == load_config([path]).experiment


def test_a_structure_that_was_edited_after_the_plan_is_not_run(path):
    plan = make_plan(load_config([path]).experiment)
    check_structure(plan)
    edit(path, "nu: 0.3", "nu: 0.2")
    vars(plan.experiment).pop("scene_type")  # as another process finds it
    with pytest.raises(CampaignError, match="has changed since"):
        check_structure(plan)


def test_an_end_of_an_interval_with_other_parts_is_refused(path):
    """Straight at the nominal values, the bar has a knee at both ends."""
    raw = {**RAW, "scene": {"file": str(path.parent / "structures" / "panel.yaml")}}
    edit(path, "points:\n", "points:\n  middle: [L/2, (k/(0.1 N m/rad) - 1)*L/9, 0]\n")
    edit(path, "through: [root, tip]", "through: [root, middle, tip]")
    assert "the structure has other parts than at the nominal" in problems(raw)
