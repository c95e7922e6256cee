"""Files that are none, or too much: campaigns, structures and programs are read by one function,
which refuses them at once, in words."""

from __future__ import annotations

import os
import resource
import time

import pytest
import yaml

from deployable.campaign.cli import main
from deployable.campaign.config.check import load_config
from deployable.campaign.errors import ConfigError


def keys(path) -> None:
    path.write_text("".join(f"k{i}: 1\n" for i in range(80_000)), encoding="utf-8")


def megabytes(path) -> None:
    path.write_text("a: 1 # " + 10_000_000 * "x", encoding="utf-8")


def loop(path) -> None:
    path.symlink_to(path)


ODD = {
    "absent": (lambda path: None, "No such file"),
    "dangling": (lambda path: path.symlink_to("nowhere"), "No such file"),
    "loop": (loop, "symbolic links"),
    "folder": (lambda path: path.mkdir(), "directory"),
    "device": (lambda path: path.symlink_to("/dev/zero"), "a device or a pipe"),
    "pipe": (os.mkfifo, "a device or a pipe"),
    "long": (megabytes, "at most 1048576 bytes"),
    "keys": (keys, "more than 20000 values"),
    "binary": (lambda path: path.write_bytes(b"\xff\xfe\x00"), "utf-8"),
}


@pytest.mark.parametrize("what", ["campaign.yaml", "structure.yaml", "program.py"])
@pytest.mark.parametrize("odd", ODD)
def test_odd_files_are_refused_at_once(tmp_path, monkeypatch, raw, capsys, odd, what):
    monkeypatch.chdir(tmp_path)
    make, words = ODD[odd]
    if (odd, what) == ("keys", "program.py"):
        pytest.skip("a program has no keys")
    make(tmp_path / what)
    path, before = what, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start, clock = time.process_time(), time.monotonic()
    if what != "campaign.yaml":
        assert main(["structure", what, "--no-picture"]) == 1
        assert words in capsys.readouterr().err
        path = "names.yaml"
        raw["scene"] = {"file": what}
        (tmp_path / path).write_text(yaml.safe_dump(raw), encoding="utf-8")
    for command in ("check", "run"):
        assert main([command, path]) == 1
        assert words in capsys.readouterr().err
    assert time.process_time() - start < 10.0 and time.monotonic() - clock < 60.0
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2**19  # kB


@pytest.mark.parametrize("name", ["a\0b.yaml", "a\0b.py"])
def test_a_name_with_a_nul_byte_is_no_path(raw, tmp_path, name):
    raw["scene"] = {"file": name}
    path = tmp_path / "c.yaml"
    path.write_text(yaml.safe_dump(raw), encoding="utf-8")
    with pytest.raises(ConfigError, match=r"scene.file: .* is not allowed; allowed: the path"):
        load_config([path])
