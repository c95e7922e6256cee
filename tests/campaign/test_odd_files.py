"""Files that are none, or too much: campaigns, structures and programs are read by one function,
which refuses them at once, in words."""

from __future__ import annotations

import errno
import os
import resource
import shutil
import time
from pathlib import Path

import pytest
import yaml

from deployable.campaign.cli import main
from deployable.campaign.config.check import load_config
from deployable.campaign.config.loader import check_snakemake_arguments
from deployable.campaign.errors import ConfigError, error_of_files


def keys(path) -> None:
    path.write_text("".join(f"k{i}: 1\n" for i in range(80_000)), encoding="utf-8")


def megabytes(path) -> None:
    path.write_text("a: 1 # " + 10_000_000 * "x", encoding="utf-8")


def loop(path) -> None:
    path.symlink_to(path)


def sparse(path) -> None:
    with open(path, "wb") as file:
        file.truncate(1 << 40)


ODD = {
    "absent": (lambda path: None, "No such file"),
    "dangling": (lambda path: path.symlink_to("nowhere"), "No such file"),
    "loop": (loop, "symbolic links"),
    "folder": (lambda path: path.mkdir(), "folder"),
    "device": (lambda path: path.symlink_to("/dev/zero"), "a device or a pipe"),
    "pipe": (os.mkfifo, "a device or a pipe"),
    "sparse": (sparse, "at most 1048576 bytes"),
    "long": (megabytes, "at most 1048576 bytes"),
    "keys": (keys, "more than 20000 values"),
    "binary": (lambda path: path.write_bytes(b"\xff\xfe\x00"), "UTF-8"),
}


@pytest.mark.parametrize("what", ["campaign.yaml", "structure.yaml"])
@pytest.mark.parametrize("odd", ODD)
def test_odd_files_are_refused_at_once(tmp_path, monkeypatch, raw, capsys, odd, what):
    monkeypatch.chdir(tmp_path)
    make, words = ODD[odd]
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


def test_a_name_with_a_nul_byte_is_no_path(raw, tmp_path):
    raw["scene"] = {"file": "a\0b.yaml"}
    path = tmp_path / "c.yaml"
    path.write_text(yaml.safe_dump(raw), encoding="utf-8")
    with pytest.raises(ConfigError, match=r"scene.file: .* is not allowed; allowed: the path"):
        load_config([path])


@pytest.mark.parametrize(
    ("name", "make"),
    [
        ("results/test", lambda path: path.symlink_to("nowhere")),
        ("results/test", lambda path: path.touch()),
        ("results", lambda path: path.touch()),
        ("results", lambda path: path.symlink_to("nowhere")),
        ("results", loop),
    ],
)
def test_what_stands_in_the_place_of_a_folder_is_told(
    tmp_path, monkeypatch, raw, capsys, name, make
):
    monkeypatch.chdir(tmp_path)
    path = Path(name)
    path.parent.mkdir(exist_ok=True)
    make(path)
    Path("c.yaml").write_text(yaml.safe_dump(raw), encoding="utf-8")
    assert main(["run", "c.yaml"]) == 1
    told = capsys.readouterr().err
    assert f"error: {name}" in told and "in the place of a folder: remove or rename it" in told


@pytest.mark.parametrize("lost", ["", "samples.nc", "bounds.nc"])
def test_results_that_were_removed_can_be_made(finished, tmp_path, capsys, lost):
    folder = tmp_path / "test"
    if lost:
        shutil.copytree(finished.path, folder)
        (folder / lost).unlink()
    for command in (["page", str(folder), "--config", '{"figures": {}}'],
                    ["export", str(folder), "--to", "csv"]):  # fmt: skip
        assert main(command) == 1
        told = capsys.readouterr().err
        assert str(folder) in told and "python -m deployable run" in told
        assert "structure" not in told and "Traceback" not in told


@pytest.mark.parametrize(
    ("error", "limit", "words"),
    [
        (OSError(errno.ENOSPC, "No space"), None, ["no room to write in", "make room"]),
        (OSError(errno.EDQUOT, "Quota"), None, ["but for a quota", "make room"]),
        (OSError(errno.EFBIG, "File too large"), 2048, ["2 kB, `ulimit -f`", "raise the limit"]),
        (OSError(errno.EFBIG, "File too large"), None, ["the file system's", "raise the limit"]),
        (OSError(errno.EROFS, "Read-only", "results"), None, ["results: Read-only", "--results"]),
        (OSError(errno.EACCES, "Permission denied", "a"), None, ["a: Permission", "allowed: "]),
        (RuntimeError("NetCDF: HDF error"), 2048, ["2 kB, `ulimit -f`", "raise the limit"]),
        (RuntimeError("NetCDF: HDF error"), None, ["NetCDF: HDF error"]),
        (MemoryError("Unable to allocate 9 TiB"), None, ["9 TiB", "jobs.group", "are kept"]),
    ],
)
def test_trouble_with_files_has_its_remedy(tmp_path, monkeypatch, error, limit, words):
    most = resource.RLIM_INFINITY if limit is None else limit
    monkeypatch.setattr(resource, "getrlimit", lambda what: (most, most))
    told = str(error_of_files(error, tmp_path))
    assert all(word in told for word in words)
    assert ("no room" in told) == ("no room to write in" in words or "but for a quota" in words)


def test_a_folder_that_snakemake_cannot_write_to_is_refused_before_it_tries(monkeypatch, capsys):
    monkeypatch.setattr(os, "access", lambda path, how: False)
    with pytest.raises(SystemExit):
        check_snakemake_arguments(["-c2"])
    assert "cannot be written to" in capsys.readouterr().err
