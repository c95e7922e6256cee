"""Campaigns in a shell: what is checked, run and told, and with which status."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray
import yaml

from deployable.campaign.cli import EXAMPLES, GROUPS, _parser, main
from deployable.campaign.config.sections import scene_type
from deployable.campaign.export.selection import parse_values
from deployable.campaign.folder import Folder
from deployable.campaign.stages import Stage
from fpm.files.seals import unseal

ROOT = Path(__file__).parents[2]


@pytest.fixture
def file(raw, tmp_path) -> str:
    """The small config as a file."""
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(raw, sort_keys=False), encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("command", [[], ["check"]])
def test_files_are_checked_without_running_anything(file, tmp_path, capsys, command):
    assert main([*command, file]) == 0
    told = capsys.readouterr().out
    assert "test, at most 6 runs, about " in told and " cores" in told and "B on disk" in told
    (tmp_path / "bad.yaml").write_text("a: [1", encoding="utf-8")
    assert main([*command, file, str(tmp_path / "bad.yaml")]) == 1
    told = capsys.readouterr()
    assert "test, at most 6 runs" in told.out
    assert "bad.yaml" in told.err
    assert "this is not YAML" in told.err


def test_a_check_in_json_has_the_same_texts(file, tmp_path, capsys):
    (tmp_path / "bad.yaml").write_text(Path(file).read_text().replace("instants: ", "instant: "))
    assert main(["check", file, str(tmp_path / "bad.yaml")]) == 1
    out, err = capsys.readouterr()
    assert main(["check", "--json", file, str(tmp_path / "bad.yaml")]) == 1
    told = capsys.readouterr()
    right, wrong = json.loads(told.out)
    assert told.err == "" and right["file"] == file and right["problems"] == wrong["work"] == []
    lines = [f"{file}: {text}" for text in (*right["work"], *right["warnings"])]
    assert sorted(lines) == sorted(out.splitlines())
    assert all(f"  {text}\n" in err for text in wrong["problems"])
    assert any(re.match(r"line \d+: solver\.instant: there is no such key", text)
               for text in wrong["problems"])  # fmt: skip
    assert main(["check", "--quiet", file]) == 0
    assert capsys.readouterr().out.splitlines() == [f"{file}: {t}" for t in right["warnings"]]


def test_the_campaign_of_a_folder_is_checked_without_its_name(file, capsys, monkeypatch):
    Path(file).rename(Path(file).with_name("campaign.yaml"))
    monkeypatch.chdir(Path(file).parent)
    assert main(["check"]) == 0
    assert capsys.readouterr().out.startswith("campaign.yaml: test, ")


@pytest.mark.parametrize(("call", "said"), [
    (["run", "x.yaml", "--figuers", "no"], "no option --figuers (did you mean --no-figures?)"),
    (["check", "x.yaml", "--jsno"], "no option --jsno (did you mean --json?)"),
    (["page", "results/x", "--config", "x.yaml", "--frame-count", "3"], "--frame-count (did you"),
    (["schema", "campaign", "twice"], "twice is one word too many; allowed: --help, --quiet"),
])  # fmt: skip
def test_an_unknown_option_is_refused_with_the_likely_one(call, said, capsys):
    with pytest.raises(SystemExit) as refused:
        main(call)
    assert refused.value.code == 2 and said in capsys.readouterr().err


@pytest.mark.parametrize("command", [[], ["run"], ["plan"]])
def test_help_may_be_asked_for_as_a_command(command, capsys):
    for arguments in (["help", *command], [*command, "--help"]):
        with pytest.raises(SystemExit) as helped:
            main(arguments)
        assert helped.value.code == 0
    texts = capsys.readouterr().out
    assert texts[: len(texts) // 2] == texts[len(texts) // 2 :]


@pytest.mark.parametrize(
    ("option", "name"), [("--json", "check"), ("-q", "run"), ("--results=out", "run")]
)
def test_an_option_before_its_command_is_told_where_it_belongs(option, name, capsys):
    with pytest.raises(SystemExit):
        main([option, name, "x.yaml"])
    assert f"{option} belongs behind the command: `" in capsys.readouterr().err


def test_every_command_is_in_one_group_of_the_help_and_has_help_of_its_own(capsys):
    names = [name for group in GROUPS.values() for name in group]
    assert len({*names}) == len(names)
    for name in names:
        with pytest.raises(SystemExit) as helped:
            main([name, "--help"])
        text = capsys.readouterr().out
        assert helped.value.code == 0 and f" {name} [-h]" in text and "--quiet" in text


def test_examples_of_the_help_can_be_given(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    lines = [line.split("  ")[1] for line in EXAMPLES.splitlines() if line.startswith("  ")]
    commands = [shlex.split(line.rpartition("{program} ")[2]) for line in lines]
    assert [command[0] for command in commands] == ["new", "check", "run", "export", "structure"]
    assert main(commands[0]) == 0
    monkeypatch.chdir(tmp_path / "mine")
    assert main(commands[1]) == 0
    assert "panel, " in capsys.readouterr().out
    for command in commands[2:4]:
        _parser().parse_args(command)
    assert main([*commands[4], "--no-picture"]) == 0


def test_an_unknown_command_is_refused_with_the_likely_one(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["chek"])
    assert ended.value.code == 2
    assert "no command 'chek' (did you mean check?); allowed: new, check" in capsys.readouterr().err


@pytest.mark.slow
def test_quiet_and_verbose_change_what_is_printed(file, tmp_path, capsys):
    def printed(*options):
        arguments = ["run", file, "--no-figures", "--results", str(tmp_path / "_".join(options))]
        assert main([*arguments, *options]) == 0
        return capsys.readouterr().err

    assert all(": warning: " in line for line in printed("--quiet").splitlines())
    assert "test, at most 6 runs" in printed()
    assert re.search(r"stage bounds took \d+\.\d\d s", printed("-v"))


def test_the_program_tells_its_version(capsys):
    with pytest.raises(SystemExit) as told:
        main(["--version"])
    assert told.value.code == 0
    assert capsys.readouterr().out.startswith("deployable-intervals 0.")


@pytest.mark.slow
def test_a_campaign_runs_stage_by_stage_as_in_one_call(finished, file, tmp_path, capsys):
    folder, log = Folder(tmp_path / "stages"), tmp_path / "logs" / "a.log"
    for name in ("plan", "simulate", "bounds", "answers"):
        assert main([name, str(folder.path), "--config", file, "--log", str(log)]) == 0
        assert log.read_text() == capsys.readouterr().err
    assert log.read_text() == f"answers: {folder / 'summary.md'}\n"
    for path in (folder.plan, folder / "summary.json"):
        assert unseal(path) == unseal(finished / path.name)
    assert main(["figures", str(folder.path), "--config", file]) == 0
    assert (folder.figures / "vBz.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.slow
def test_the_page_moves_in_as_many_frames_as_are_asked_for(finished, file, tmp_path, capsys):
    copy = tmp_path / "copy"
    shutil.copytree(finished.path, copy)
    assert main(["page", str(copy), "--config", file, "--frames", "1"]) == 1
    assert "--frames 1: allowed: 2 and more" in capsys.readouterr().err
    assert main(["page", str(copy), "--config", file, "--frames", "5"]) == 0
    for path in (copy / "motions").glob("*.nc"):
        with xarray.open_dataset(path) as motion:
            time = motion["time"].values
        assert set(np.linspace(0, time[-1], 5).round(9)) <= set(time.round(9))
        assert 5 <= len(time) < 9  # and the nominal run's events


@pytest.mark.parametrize("name", ["bennett", "config/structures/scissor.yaml"])
def test_a_structure_is_told(capsys, name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["structure", str(ROOT / name) if "/" in name else name]) == 0
    told = capsys.readouterr().out
    for words in ("parameter ", "no interval", "points", "joints", "mass ", "redundant", "set by"):
        assert words in told
    assert "the mesh" in told


def test_a_structure_is_drawn_where_it_is_asked_for(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    structure = str(ROOT / "config/structures/panel.yaml")
    assert main(["structure", structure]) == 0
    assert "exports/panel.png" in capsys.readouterr().out
    assert (tmp_path / "exports/panel.png").read_bytes().startswith(b"\x89PNG")
    assert main(["structure", structure, "--picture", "mine/panel.svg"]) == 0
    drawn = (tmp_path / "mine/panel.svg").read_text(encoding="utf-8")
    assert "<svg" in drawn
    assert main(["structure", structure, "--picture", "panel.jpg"]) == 1
    assert ".png, .svg, .pdf" in capsys.readouterr().err
    shutil.rmtree(tmp_path / "exports")
    assert main(["structure", structure, "--no-picture"]) == 0
    assert not (tmp_path / "exports").exists()


def test_errors_of_users_have_no_traceback(finished, file, tmp_path, capsys):
    folder = Folder(tmp_path / "new")
    folder.path.mkdir()
    folder.plan.write_bytes(finished.plan.read_bytes())
    log = tmp_path / "gather.log"
    plan = json.loads(folder.plan.read_text())
    folder.plan.write_text(json.dumps(plan, indent=1))
    assert main(["bounds", str(folder.path), "--config", file, "--log", str(log)]) == 1
    for told in (capsys.readouterr().err, log.read_text()):
        assert told.startswith(f"error: {folder.plan} cannot be used: it was cut off or edited")
        assert "to have it made again" in told
        assert "Traceback" not in told
    assert main(["run", str(tmp_path / "absent.yaml")]) == 1
    told = capsys.readouterr().err
    assert "No such file" in told
    assert "Traceback" not in told


JOBS = json.dumps({"jobs": {"runs_per_job": 1, "group": 1, "keep": "responses"}})


def test_a_file_that_is_not_there_is_told_by_name(tmp_path):
    log = tmp_path / "a.log"
    assert main(["simulate", str(tmp_path), "--config", JOBS, "--log", str(log)]) == 1
    told = log.read_text()
    assert told.startswith(
        f"error: {tmp_path}/plan.json: No such file or directory; it was removed"
    )


def test_a_fault_of_the_program_is_in_the_log(tmp_path, monkeypatch):
    log = tmp_path / "a.log"
    monkeypatch.setattr(Stage, "basis", lambda *rest: 1 / 0)
    assert main(["simulate", str(tmp_path), "--config", JOBS, "--log", str(log)]) == 1
    assert "ZeroDivisionError" in log.read_text()


@pytest.mark.parametrize(
    ("call", "meant"),
    [("export latch --to glbb", "glb"), ("export latch --to gltf", "glb"),
     ("schema structur", "structure"), ("exprt latch", "export")],
)  # fmt: skip
def test_a_word_that_is_no_choice_is_answered_with_the_likely_one(call, meant, capsys):
    with pytest.raises(SystemExit):
        main(call.split())
    assert f"(did you mean {meant}?)" in capsys.readouterr().err


def test_numbers_of_a_call_may_have_units(capsys):
    texts = {"k": "200 N mm/rad", "angle": "0.5 rad", "mass": "2", "L": "2 kg"}
    values = parse_values(texts, scene_type("latch"))
    assert values == {"k": 0.2, "angle": pytest.approx(28.6478898), "mass": 2, "L": "2 kg"}
    assert main(["structure", "latch", "--no-picture", "--duration", "500 ms"]) == 0
    assert "for 0.5 s" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["structure", "latch", "--duration", "2 m"])
