"""Campaigns outside of the checkout: folders of one's own, modules, any name of a folder."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from deployable.campaign import program_data
from deployable.campaign.cli.new import CAMPAIGN, campaign_of, list_starts, make_folder
from deployable.campaign.config.check import load_config
from deployable.campaign.errors import CampaignError

ROOT = Path(__file__).parents[2]
ODD = "with space, größe Ω and b{race}s"
ODDEST = "it's {stage} ü"
SEEN = ("--dry-run", "-p", "--quiet", "host")

MODULE = """\
configfile: "mine.yaml"

module deployable_intervals:
    snakefile: {snakefile!r}
    config: config

use rule * from deployable_intervals as bounds_*

rule mine:
    default_target: True
    input: "results/mine/summary.json"
    output: "mine.txt"
    shell: "cp {{input}} {{output}}"
"""
MINE = """\
campaign: mine
scene: {name: bennett, parameters: {elements: 2}}
solver: {duration: 0.02, instants: 41}
intervals:
  E: {nominal: 1e9, relative: 0.01}
design: {order: 1}
responses:
  BD: {distance: [B, D]}
"""


def test_every_start_makes_a_folder_with_a_campaign_that_is_accepted(tmp_path):
    assert {"small", "mast", "panel", "pendulum"} <= set(list_starts())
    for start in ("small", "mast", "panel", "pendulum"):
        folder = tmp_path / start
        make_folder(folder, start)
        assert load_config([folder / CAMPAIGN]).name == start
        for name in ("Snakefile", "profiles/default/config.yaml"):
            assert (folder / name).is_file()


def test_a_folder_starts_from_a_structure_of_ones_own(tmp_path):
    mine = tmp_path / "two bars.yaml"
    text = program_data.list_structures()["zfold"].read_text(encoding="utf-8")
    mine.write_text(text.replace("name: zfold", "name: two_bars"), encoding="utf-8")
    make_folder(tmp_path / "made", str(mine))
    made = load_config([tmp_path / "made" / CAMPAIGN])
    assert made.name == "two-bars"
    assert {"knee_speed", "tip_speed", "root_opening"} <= set(made.experiment.responses)


def test_a_structure_with_latches_starts_with_the_question_whether_they_catch(tmp_path):
    mine = tmp_path / "mine.yaml"
    mine.write_bytes(program_data.list_structures()["boom"].read_bytes())
    make_folder(tmp_path / "made", str(mine))
    made = load_config([tmp_path / "made" / CAMPAIGN])
    numbers = {quantity.name: quantity.places for quantity in made.experiment.quantity_list}
    assert numbers == {
        "t_root_latch": ("latch root_latch",),
        "t_tube1_latch": ("latch tube1.latch",),
    }
    assert set(made.requirements["latches"]) == set(numbers)


@pytest.mark.parametrize("name", ["latch", "boom", "telescope", "wing"])
def test_a_first_campaign_takes_as_long_as_a_shipped_one_and_not_ten_times_that(name):
    shipped_duration = load_config([program_data.list_campaigns()[name]]).experiment.solver.duration
    text = campaign_of(program_data.list_structures()[name], f"{name}.yaml")
    duration = float(re.search(r"duration: (\S+)", text)[1])
    assert shipped_duration / 1.5 <= duration <= 10 * shipped_duration


@pytest.mark.parametrize("start", ["nothing", "config/small.yaml", "no.yaml"])
def test_what_is_no_start_is_refused(tmp_path, start):
    with pytest.raises(
        CampaignError, match=r"allowed: .*pendulum|a campaign's file, not a structure's"
    ):
        make_folder(tmp_path / "made", start)
    assert not (tmp_path / "made").exists()


def test_what_is_there_is_not_overwritten(tmp_path):
    (tmp_path / CAMPAIGN).write_text("mine")
    with pytest.raises(CampaignError, match=r"campaign\.yaml: there already"):
        make_folder(tmp_path, "small")
    assert os.listdir(tmp_path) == [CAMPAIGN]


def test_a_folder_of_ones_own_is_planned_whatever_its_name(tmp_path, place_in):
    make_folder(tmp_path / ODD, "mast")
    done = place_in(tmp_path / ODD).snakemake(*SEEN)
    assert done.returncode == 0, done.stdout
    assert "results/mast/plan.json" in done.stdout
    assert '"file":"structures/scissor.yaml"' in done.stdout


@pytest.mark.slow
def test_files_that_are_named_as_modules_stand_for_none_of_them(tmp_path, place_in):
    make_folder(tmp_path, "pendulum")
    for name in ("random", "numpy", "deployable"):
        (tmp_path / f"{name}.py").write_text("raise RuntimeError('not asked for')")
    place = place_in(tmp_path)
    command = place.command("results/pendulum/plan.json")
    command.insert(1, "-P")  # as the command `snakemake` does, which has no module's folder
    done = subprocess.run(command, cwd=tmp_path, env=place.environment(), capture_output=True)
    assert done.returncode == 0, done.stderr


def test_the_snakefile_of_the_checkout_serves_other_folders(tmp_path, place_in):
    own = place_in(tmp_path)
    call = ("-s", str(ROOT / "Snakefile"), *SEEN)
    done = own.snakemake(*call, "--configfile", str(ROOT / "config" / "mast.yaml"))
    assert done.returncode == 0, done.stdout
    assert str(ROOT / "config" / "structures" / "scissor.yaml") in done.stdout


@pytest.mark.slow
def test_a_module_takes_the_config_of_the_including_workflow(tmp_path, place_in):
    own = place_in(tmp_path)
    (own.folder / "mine.yaml").write_text(MINE, encoding="utf-8")
    text = MODULE.format(snakefile=program_data.SNAKEFILE)
    (own.folder / "Snakefile").write_text(text, encoding="utf-8")
    asked = own.snakemake(*SEEN, "--config", "solver={duration: 0.01}")
    assert asked.returncode == 0, asked.stdout
    assert "bounds_bounds" in asked.stdout
    assert '"duration":0.01,"instants":41' in asked.stdout
    assert '"E":{"lower":990000000.0' in asked.stdout
    (own.folder / "mine.yaml").write_text(MINE.replace("1e9", "-1e9"), encoding="utf-8")
    refused = own.snakemake(*SEEN)
    assert refused.returncode != 0
    assert "the config of the module has 1 problem" in refused.stdout
    assert "Traceback" not in refused.stdout


@pytest.mark.slow
def test_a_campaign_runs_in_a_folder_of_any_name_and_as_a_module(small, tmp_path, place_in):
    expected = json.loads((small.folder / "results/small/summary.json").read_text())["responses"]
    folder = tmp_path / ODDEST
    make_folder(folder, "small")
    done = place_in(folder).snakemake("results/small/summary.json")
    assert done.returncode == 0, done.stdout
    assert json.loads((folder / "results/small/summary.json").read_text())["responses"] == expected

    place = place_in(tmp_path / "including")
    place.folder.mkdir()
    shutil.copy(ROOT / "config" / "small.yaml", place.folder / "mine.yaml")
    text = MODULE.format(snakefile=program_data.SNAKEFILE).replace("results/mine", "results/small")
    (place.folder / "Snakefile").write_text(text, encoding="utf-8")
    done = place.snakemake()
    assert done.returncode == 0, done.stdout
    assert json.loads((place.folder / "mine.txt").read_text())["responses"] == expected
