"""Results of somebody else: opening them runs no program and follows no path of theirs."""

from __future__ import annotations

import ctypes
import json
import os
import shutil
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from deployable.campaign import program_data
from deployable.campaign.cli import main
from deployable.campaign.config import sections
from deployable.campaign.config.models import FigureChoice
from deployable.campaign.config.sections import as_json
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import csv_text, open_dataset, open_netcdf, refuse_links
from deployable.campaign.files.external_links import _library
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.results.figures import save
from deployable.campaign.stages import STAGES
from deployable.campaign.stages.workflow import Workflow, run
from fpm.files.seals import DamagedError, check, seal, unseal

PAGE = ["--config", as_json(figures=FigureChoice())]
PROGRAM = "import pathlib\npathlib.Path(__file__).with_suffix('.run').touch()\n"


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


def names_program(program: Path):
    """A change by which results are of a structure in a file."""

    def change(file) -> None:
        config = file["config"] if isinstance(file, dict) else json.loads(file.config)
        config["scene"] |= {"name": program.stem, "file": str(program)}
        if not isinstance(file, dict):
            file.config = json.dumps(config)

    return change


@pytest.mark.parametrize("command", ["export", "page", "simulate", "bounds", "answers", "figures"])
def test_a_program_that_only_results_name_is_not_run(theirs, tmp_path, capsys, command):
    program = tmp_path / "evil.py"
    program.write_text(PROGRAM, encoding="utf-8")
    for path in (theirs.plan, *theirs.path.glob("*.nc")):
        changed(path, names_program(program))
    config = str(Path(__file__).parents[2] / "config" / "small.yaml")
    arguments = ["--to", "csv"] if command == "export" else ["--config", config]
    main([command, str(theirs.path), *arguments])
    told = capsys.readouterr().err
    assert not program.with_suffix(".run").exists()
    if command != "figures":  # which needs no structure
        assert f"{program}, which is a program and was not run" in told and "Traceback" not in told
    if command == "export":
        assert f"--trust {program}" in told
        main([command, str(theirs.path), *arguments, "--trust", str(program)])
        assert program.with_suffix(".run").exists()


@pytest.mark.parametrize("command", ["export", "page", "simulate", "bounds", "answers", "figures"])
def test_a_pipe_that_results_name_is_refused(rich, tmp_path, capsys, command):
    whole, sections = rich
    place = Folder(tmp_path / "theirs")
    shutil.copytree(whole.path, place.path)
    os.mkfifo(secret := tmp_path / "secret.yaml")  # which whoever reads it waits for, or refuses
    for path in (place.plan, *place.path.glob("*.nc")):
        changed(path, names_program(secret))
    before = sorted(place.path.rglob("*"))
    arguments = ["--to", "csv"] if command == "export" else ["--config", sections.get(command)]
    assert main([command, str(place.path), *arguments]) == 1
    told = capsys.readouterr().err
    assert "no plain file" in told
    assert sorted(place.path.rglob("*")) == before  # nothing was made


def test_results_of_two_campaigns_are_not_told_as_those_of_one(rich, tmp_path, raw, capsys):
    whole, sections = rich
    raw["solver"]["duration"] = 0.003
    run(raw | {"campaign": "rich"}, tmp_path / "other", figures=False, notify=lambda text: None)
    place = Folder(tmp_path / "rich")
    shutil.copytree(whole.path, place.path)
    facts = check(place.bounds)
    place.bounds.write_bytes(unseal(tmp_path / "other" / "rich" / "bounds.nc"))
    seal(place.bounds, {key: value for key, value in facts.items() if key != "digest"})
    for command in ("answers", "figures", "page"):
        assert main([command, str(place.path), "--config", sections[command]]) == 1
        told = capsys.readouterr().err
        assert "bounds.nc cannot be used: it is of another campaign than" in told
    assert main(["export", str(place.path), "--to", "csv"]) == 1
    assert "of another campaign than samples.nc" in capsys.readouterr().err


def test_jobs_of_a_workflow_are_told_the_program_that_its_config_names(
    raw, theirs, tmp_path, monkeypatch
):
    program, linkage = tmp_path / "own.py", str(program_data.list_structures()["bennett"])
    program.write_text(
        f"from fpm import structures\nOF = structures.load({linkage!r})\n"
        "PARAMETERS, MESH = OF.parameters, OF.mesh\n"
        "def build(**parameters):\n    return OF.build(**parameters)\n",
        encoding="utf-8",
    )
    raw["scene"] = {"file": str(program)} | {"parameters": raw["scene"]["parameters"]}
    path = tmp_path / "own.yaml"
    path.write_text(json.dumps(raw), encoding="utf-8")
    jobs = Workflow.from_files([path]).sections("page")
    changed(theirs.plan, names_program(program))
    monkeypatch.setattr(sections, "_TRUSTED_FILES", set())  # as in the job's process
    with pytest.raises(CampaignError, match="was not run"):
        read_plan(theirs.plan).experiment.scene_type  # noqa: B018
    STAGES["page"].sections_in(jobs)
    assert read_plan(theirs.plan).experiment.scene_type.name == "own"


def test_texts_are_no_formulas_of_spreadsheets_and_no_commands_of_terminals():
    assert csv_text([["=1", "+x", "-y", "@z", -1.5, "a"]]) == "'=1,'+x,'-y,'@z,-1.5,a\n"
    assert "\x1b" not in str(CampaignError("of \x1b[31m\nred")) and "\nred" in str(
        CampaignError("of \x1b[31m\nred")
    )


def test_dollars_in_names_are_no_formulas_of_figures(tmp_path):
    from matplotlib.figure import Figure

    figure = Figure()
    figure.subplots().set_title(r"$\frac{$")
    save(figure, tmp_path / "a")
    assert (tmp_path / "a.pdf").exists()


def set_name(variable: str, name: str):
    def change(file) -> None:
        file[variable][0] = name

    return change


@pytest.mark.parametrize("name", ["../../../../X", "/etc/X", "", "a b", "x\ny", "<script>"])
@pytest.mark.parametrize("variable", ["run_id", "response", "parameter"])
def test_what_names_a_file_is_checked_where_it_is_read(theirs, variable, name):
    changed(theirs.samples, set_name(variable, name))
    for opened in (open_dataset, open_netcdf):
        with pytest.raises(DamagedError, match=f"no name of a {variable}"):
            opened(theirs.samples)


def test_a_page_of_a_run_with_a_path_for_a_name_writes_nothing_there(theirs, tmp_path, capsys):
    changed(theirs.samples, set_name("run_id", "../../written"))
    assert main(["page", str(theirs.path), *PAGE]) == 1
    assert "no name of a run_id" in capsys.readouterr().err
    assert not list(tmp_path.rglob("written*")) and not theirs.report.exists()


@pytest.mark.parametrize(
    "change",
    [
        lambda config: config.update(name="../up"),
        lambda config: config["responses"].update({"../up": {}}),
        lambda config: config["quantities"].update({"a/b": {}}),
        lambda config: config["scene"].update(file="a\0b"),
        lambda config: config.update(unknown=1),
        lambda config: config.pop("scene"),
        lambda config: config.update(scene=[]),
        lambda config: config["solver"].update(instants=10**9),
        lambda config: config["solver"].update(duration=1e300),
        lambda config: config["design"].update(samples=10**12),
    ],
)
def test_the_config_in_results_is_checked_too(theirs, change):
    changed(theirs.plan, lambda data: change(data["config"]))
    with pytest.raises(DamagedError, match="the results hold a config that cannot be used"):
        read_plan(theirs.plan)


def test_names_of_runs_in_a_plan_are_checked(theirs):
    changed(theirs.plan, lambda data: data["runs"][0].update(id="../up"))
    with pytest.raises(DamagedError, match="no name of a run"):
        read_plan(theirs.plan)


@pytest.mark.parametrize("name", ["figures", "samples.nc", "motions", "exports", "logs", "rounds"])
def test_links_that_lead_outside_are_not_followed(theirs, tmp_path, capsys, name):
    outside = tmp_path / "outside"
    if name == "samples.nc":
        shutil.move(theirs.samples, outside)
    else:
        outside.mkdir()
    (theirs.path / name).symlink_to(outside)
    before = sorted(tmp_path.rglob("*"))
    log = ["--log", str(theirs.path / "logs" / "page.log")] if name == "logs" else []
    assert main(["page", str(theirs.path), *PAGE, *log]) == 1
    assert main(["export", str(theirs.path), "--to", "csv"]) == 1
    told = capsys.readouterr().err
    assert told.count(f"is a link to {outside}, outside of the results") == 2
    assert sorted(tmp_path.rglob("*")) == before


def test_links_beside_a_round_are_not_followed_either(theirs, tmp_path, capsys):
    (theirs.path / "responses").symlink_to(tmp_path)
    (theirs.path / "rounds" / "0").mkdir(parents=True)
    assert main(["page", str(theirs.path / "rounds" / "0"), *PAGE]) == 1
    assert "responses is a link to" in capsys.readouterr().err


def test_a_whole_folder_may_be_a_link_and_links_may_lead_inside(theirs, tmp_path):
    (tmp_path / "link").symlink_to(theirs.path)
    (theirs.path / "again.nc").symlink_to("samples.nc")
    refuse_links(tmp_path / "link")


def test_nobody_waits_for_a_pipe(theirs, capsys):
    theirs.samples.unlink()
    os.mkfifo(theirs.samples)
    with pytest.raises(DamagedError, match="no plain file"):
        check(theirs.samples)
    assert main(["page", str(theirs.path), *PAGE]) == 1
    assert "is a pipe or a device" in capsys.readouterr().err
    theirs.plan.unlink()
    os.mkfifo(theirs.plan)
    with pytest.raises(DamagedError, match="no plain file"):
        read_plan(theirs.plan)


def test_numbers_in_other_files_are_not_read(theirs, tmp_path):
    """HDF5 would: of a dataset in external storage."""
    hdf5, ident = _library(), ctypes.c_int64
    secret, path = tmp_path / "secret", tmp_path / "samples.nc"
    secret.write_bytes(b"secret text here")

    def call(name: str, *arguments: object) -> int:
        function = getattr(hdf5, name)
        function.restype = ident
        function.argtypes = None
        return function(*arguments)

    file = call("H5Fcreate", os.fsencode(path), 2, ident(0), ident(0))
    space = call("H5Screate_simple", 1, (ctypes.c_uint64 * 1)(16), None)
    made = call("H5Pcreate", ident.in_dll(hdf5, "H5P_CLS_DATASET_CREATE_ID_g"))
    size = ctypes.c_uint64(16)
    call("H5Pset_external", ident(made), os.fsencode(secret), ctypes.c_int64(0), size)
    kind = ident.in_dll(hdf5, "H5T_NATIVE_UCHAR_g")
    data = call(
        "H5Dcreate2", ident(file), b"x", kind, ident(space), ident(0), ident(made), ident(0)
    )
    for name, which in (("H5Dclose", data), ("H5Pclose", made), ("H5Sclose", space)):
        call(name, ident(which))
    call("H5Fclose", ident(file))
    with netCDF4.Dataset(path) as there:
        assert np.asarray(there["x"][:]).tobytes() == b"secret text here"
    seal(path, {"name": "samples.nc"})
    for opened in (open_dataset, open_netcdf):
        with pytest.raises(DamagedError, match="does not lie in this file"):
            opened(path)
