"""The registry of studies, the command that runs them, and their rules in the workflow."""

import importlib
import json
import subprocess
import sys

import pytest

from evidence import registry
from evidence.__main__ import main
from evidence.registry import ROOT, STUDIES
from evidence.rows import close_to
from evidence.verification import study as verification
from fpm.kernels import sources


@pytest.mark.parametrize("study", STUDIES.values(), ids=STUDIES)
def test_a_study_has_the_parts_that_the_workflow_runs(study):
    parts = importlib.import_module(f"evidence.{study.name}.study").PARTS
    assert not study.parts or list(study.parts) == list(parts)
    assert all("/" not in part and " " not in part for part in study.parts)
    for place in (*study.uses, f"evidence/{study.name}"):
        assert (ROOT / place).exists()


def test_what_the_code_does_decides_about_running_again(tmp_path, monkeypatch):
    monkeypatch.setattr(registry, "ROOT", tmp_path)
    for place in ("fpm", "evidence/linkage", "evidence/trial", "evidence"):
        (tmp_path / place).mkdir(parents=True, exist_ok=True)
    for name in ("rows", "results", "trial/study"):
        (tmp_path / "evidence" / f"{name}.py").write_text("x = 1\n")
    (tmp_path / "fpm/a.py").write_text("x = 1\n")
    study = registry.Study("trial", "Trying", uses=("evidence/trial",))

    def codes():
        sources.digest.cache_clear()
        return study.code()

    before = codes()
    (tmp_path / "fpm/a.py").write_text("x = 2\n")
    after = codes()
    assert after[0] == before[0] and after[1] != before[1]
    (tmp_path / "evidence/results.py").write_text("x = 2\n")
    assert codes()[0] != after[0]


def broken(bench):
    bench.check("right", 1.0, 1.0, 1e-3, "book")
    bench.check("wrong", 2.0, 1.0, 1e-3, "book")


def test_failing_rows_are_told_and_fail_the_command_if_strict(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(verification.PROBLEMS, "broken", broken)
    monkeypatch.setitem(
        verification.PARTS, "broken", lambda quick: verification.solve("broken", quick)
    )
    call = ["verification", "--only", "broken", "--output", str(tmp_path)]
    assert main(call) == 0
    rows = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["rows"]
    assert [row["passed"] for row in rows] == [True, False]
    assert "failed: broken: wrong" in capsys.readouterr().out
    assert main([*call, "--strict"]) == 1


def test_parts_of_processes_of_their_own_make_the_same_report(tmp_path, monkeypatch):
    """Two parts measured one by one and told from their files, and both measured at once."""
    module = importlib.import_module("evidence.extremes.study")
    rows = {
        "stable-step": [close_to("stable step: a", 0.9, 1.0, 0.3).plain()],
        "lengths": [close_to("b", 0.1, 0.0, 0.3).plain()],
    }
    parts = {name: lambda quick, name=name: rows[name] for name in rows}
    monkeypatch.setattr(module, "PARTS", parts)
    small = registry.Study("extremes", "", (), parts=tuple(rows))
    monkeypatch.setitem(registry.STUDIES, "extremes", small)
    apart, together = tmp_path / "apart", tmp_path / "together"
    for part in rows:
        assert main(["extremes", "--part", part, "--output", str(apart)]) == 0
    assert not (apart / "summary.json").exists()
    assert main(["extremes", "--measured", "--output", str(apart)]) == 0
    assert main(["extremes", "--output", str(together)]) == 0
    for file in ("summary.json", "table.md"):
        assert (apart / file).read_bytes() == (together / file).read_bytes()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["verification", "--only", "no such problem"], "no such problem"),
        (["extremes", "--part", "nothing"], "known are: stable-step"),
        (["tradeoff", "--quick"], "no quick form"),
        (["nothing"], "verification"),
    ],
)
def test_what_there_is_not_is_refused_by_name(arguments, told, capsys):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    assert told in capsys.readouterr().err


@pytest.mark.slow
def test_every_study_is_a_target_of_the_workflow(tmp_path):
    """A dry run of all: one job for each study and one for each part."""
    command = [sys.executable, "-m", "snakemake", "-n", "-c2", "--directory", str(tmp_path)]
    command += ["--snakefile", str(ROOT / "Snakefile"), "--forceall", *STUDIES]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    jobs = dict(line.split()[:2] for line in done.stdout.splitlines() if len(line.split()) == 2)
    assert all(jobs[name] == "1" for name in STUDIES)
    assert jobs["study_part"] == str(sum(len(study.parts) for study in STUDIES.values()))
