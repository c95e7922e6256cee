"""Every command and snippet of docs/export.md runs as far as it takes seconds."""

import re
import shlex
from pathlib import Path

import pytest

from deployable.campaign.cli import _parser
from deployable.campaign.export import FORMATS, choose

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/export.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^python -m deployable (export .*)$", PAGE, re.M)[1:]
PYTHON = re.findall(r"^```python\n(.*?)^```", PAGE, re.M | re.S)


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_mean_a_run(command, monkeypatch):
    monkeypatch.chdir(ROOT)
    options = _parser().parse_args(shlex.split(command))
    if options.what.startswith("config/"):
        settings = dict(pair.split("=") for pair in options.set)
        assert choose(options.what, settings=settings, duration=options.duration).instants > 1


def test_the_snippet_runs(tmp_path, monkeypatch, capsys):
    (text,) = PYTHON
    text = text.replace("config/", f"{ROOT}/config/")
    monkeypatch.chdir(tmp_path)
    exec(compile(text, "docs/export.md", "exec"), {})
    assert "exports/panel.glb" in capsys.readouterr().out


def test_all_kinds_are_told():
    told = re.search(r"--to (\S+)", PAGE).group(1).split("|")
    assert told == list(FORMATS) and len(COMMANDS) == 3
