"""Configs that cannot be used: status not 0, a message, no traceback, no job, no results."""

from __future__ import annotations

import pytest

from deployable.campaign.config.loader import check_snakemake_arguments

GOOD = """\
campaign: mine
scene: {name: bennett}
intervals:
  a: {nominal: 0.035, relative: 0.01}
responses:
  BD: {distance: [B, D]}
"""


def test_a_bad_config_is_refused_before_any_job(workplace):
    """What else is refused is in tests/campaign/refusals.yaml and test_mistakes.py."""
    text = GOOD.replace("a: {nominal: 0.035, relative: 0.01}", "K_C: {nominal: 1, absolute: 2}")
    path = workplace.config("bad", text)
    refused = workplace.snakemake("--configfile", path)
    assert refused.returncode != 0
    for word in ["bad.yaml", "intervals.K_C", "lower end, -1"]:
        assert word in refused.stdout
    assert "Traceback" not in refused.stdout
    assert "Job stats" not in refused.stdout
    assert not (workplace.folder / "results").exists()


def test_python_in_a_config_is_not_run(workplace):
    """Snakemake would, as it reads the file: one with a syntax error is refused as early, below."""
    path = workplace.folder / "config" / "bad.yaml"
    python = "__use_yte__: true\n__definitions__: [\"open('executed', 'w')\"]\n"
    path.write_text(GOOD + python, encoding="utf-8")
    refused = workplace.snakemake("--dry-run", "--configfile", str(path), "--quiet", "host")
    assert refused.returncode == 1
    for word in (f"{path} has 1 problem", "__use_yte__: not allowed"):
        assert word in refused.stdout
    assert "Traceback" not in refused.stdout
    assert not (workplace.folder / "executed").exists()


def test_files_are_found_among_all_arguments_of_snakemake(tmp_path):
    good, bad = tmp_path / "good.yaml", tmp_path / "bad.yaml"
    good.write_text(GOOD, encoding="utf-8")
    bad.write_text("a: [", encoding="utf-8")
    options = ["-c2", "--configfile", str(good), "--config", "a=1", "-n", "--", str(bad)]
    check_snakemake_arguments(options)
    for arguments in (
        ["-c2", "--configfile", str(good), str(bad), "-n"],
        ["all", f"--configfile={bad}", "--config", "jobs={group: 1}"],
        ["--configfiles", str(bad), "--cores", "2"],
    ):
        with pytest.raises(SystemExit):
            check_snakemake_arguments(arguments)


def test_the_default_campaign_is_checked_too(workplace):
    path = workplace.folder / "config" / "paper.yaml"
    path.write_text(path.read_text().replace("[B, D]", "[B, D"), encoding="utf-8")
    refused = workplace.snakemake()
    assert refused.returncode != 0
    assert "config/paper.yaml" in refused.stdout
    assert "line " in refused.stdout
    assert "Traceback" not in refused.stdout


def test_a_campaign_does_not_mix_with_the_default_one(workplace):
    path = workplace.config("mine", GOOD.replace("a: {nominal: 0.035", "E: {nominal: 1e9"))
    planned = workplace.snakemake("--configfile", path, "--dry-run", "-p", "--quiet", "host")
    assert planned.returncode == 0, planned.stdout
    assert '"intervals":{"E":{"lower":990000000.0' in planned.stdout
    assert '"a":{"lower"' not in planned.stdout
    assert "results/mine/" in planned.stdout
