"""Results of somebody else: opening them follows no path of theirs."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import netCDF4
import pytest

from deployable.campaign.cli import main
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import csv_text, open_dataset, open_netcdf
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.stages.workflow import run
from fpm.files.seals import DamagedError, check, seal, unseal


@pytest.fixture
def theirs(finished, tmp_path) -> Folder:
    """Results that can be changed, and sealed again."""
    shutil.copytree(finished.path, tmp_path / "theirs")
    return Folder(tmp_path / "theirs")


def changed(path: Path, change) -> None:
    """Change a sealed file: an open netCDF file, or the data of JSON."""
    facts = {k: v for k, v in check(path).items() if k != "digest"}
    content = unseal(path)
    if path.suffix == ".json":
        change(data := json.loads(content))
        path.write_text(json.dumps(data, indent=1), encoding="utf-8")
    else:
        path.write_bytes(content)
        with netCDF4.Dataset(path, "a") as file:
            change(file)
    seal(path, facts)


def test_results_of_two_campaigns_are_not_told_as_those_of_one(rich, tmp_path, raw, capsys):
    whole, sections = rich
    raw["solver"]["duration"] = 0.003
    run(raw | {"campaign": "rich"}, tmp_path / "other", figures=False, notify=lambda text: None)
    place = Folder(tmp_path / "rich")
    shutil.copytree(whole.path, place.path)
    for name in ("design_bounds.nc", "bounds.nc"):
        shutil.copy(tmp_path / "other" / "rich" / name, place / name)
    for command in ("answers", "figures", "page"):
        assert main([command, str(place.path), "--config", sections[command]]) == 1
        told = capsys.readouterr().err
        assert "bounds.nc cannot be used: it is of plan" in told
    assert main(["export", str(place.path), "--to", "csv"]) == 1
    assert "it is of plan" in capsys.readouterr().err


def test_texts_are_no_formulas_of_spreadsheets_and_no_commands_of_terminals():
    assert csv_text([["=1", "+x", "-y", "@z", -1.5, "a"]]) == "'=1,'+x,'-y,'@z,-1.5,a\n"
    assert "\x1b" not in str(CampaignError("of \x1b[31m\nred")) and "\nred" in str(
        CampaignError("of \x1b[31m\nred")
    )


def set_name(variable: str, name: str):
    def change(file) -> None:
        file[variable][0] = name

    return change


@pytest.mark.parametrize("name", ["../../../../X", "/etc/X", "", "a b", "x\ny", "<script>"])
@pytest.mark.parametrize("variable", ["run_id", "response", "parameter"])
def test_what_names_a_file_is_checked_where_it_is_read(theirs, variable, name):
    changed(theirs.samples, set_name(variable, name))
    for opened in (open_dataset, open_netcdf):
        with pytest.raises(DamagedError, match=f"not the name of a {variable}"):
            opened(theirs.samples)


@pytest.mark.parametrize(
    "change",
    [
        lambda config: config.update(name="../up"),
        lambda config: config["responses"].update({"../up": {}}),
        lambda config: config["quantities"].update({"a/b": {}}),
        lambda config: config.update(unknown=1),
        lambda config: config.pop("scene"),
        lambda config: config.update(scene=[]),
    ],
)
def test_the_config_in_results_is_checked_too(theirs, change):
    changed(theirs.plan, lambda data: change(data["config"]))
    with pytest.raises(DamagedError, match="cannot be used"):
        read_plan(theirs.plan)
