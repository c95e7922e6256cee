"""Sealed files: whatever happens to them is noticed, and told by name."""

import json
import subprocess
import sys
import time

import pytest

from fpm.files import seals
from fpm.files.seals import DamagedError, check, check_content, unseal, whole_file

CONTENT = {
    ".nc": bytes(range(256)) * 20,
    ".png": b"\x89PNG...",
    ".html": b"<html></html>",
    ".md": b"# Title\n",
    ".json": b'{\n "a": 1,\n "b": [1, 2]\n}\n',
}


@pytest.fixture(params=CONTENT)
def path(request, tmp_path):
    made = tmp_path / f"file{request.param}"
    with whole_file(made, {"name": "it", "of": "x"}) as temporary:
        temporary.write_bytes(CONTENT[request.param])
    return made


def test_a_seal_tells_what_a_file_is(path):
    facts = check(path, "it")
    assert facts["of"] == "x"
    assert facts == check_content(path, path.read_bytes(), "it")
    with pytest.raises(DamagedError, match=rf"{path.name}.*it is it, not another"):
        check(path, "another")
    assert unseal(path) == CONTENT[path.suffix]
    if path.suffix == ".json":
        assert json.loads(path.read_text())["b"] == [1, 2]


def test_every_flipped_bit_is_noticed(path):
    whole = path.read_bytes()
    for place in range(0, len(whole), max(1, len(whole) // 400)):
        path.write_bytes(
            whole[:place] + bytes([whole[place] ^ (1 << place % 8)]) + whole[place + 1 :]
        )
        for find in (check, lambda p: check_content(p, p.read_bytes())):
            with pytest.raises(DamagedError, match=path.name):
                find(path)


def test_every_cut_and_anything_added_is_noticed(path):
    whole = path.read_bytes()
    for size in {*range(0, len(whole), max(1, len(whole) // 100)), len(whole) - 1}:
        path.write_bytes(whole[:size])
        with pytest.raises(DamagedError):
            check(path)
    path.write_bytes(whole + b"\n")
    with pytest.raises(DamagedError):
        check(path)


def test_damage_to_a_large_file_is_noticed_by_who_has_checked_it_before(tmp_path, monkeypatch):
    monkeypatch.setattr(seals, "_LARGE", 1000)
    path, read = tmp_path / "large.nc", []
    with whole_file(path, {"name": "it"}) as temporary:
        temporary.write_bytes(CONTENT[".nc"])
    whole = seals._hash
    monkeypatch.setattr(seals, "_hash", lambda *args: read.append(args) or whole(*args))
    assert check(path) == check(path)
    assert len(read) == 1
    time.sleep(0.05)  # the clock of files goes by steps
    content = path.read_bytes()
    path.write_bytes(content[:500] + b"?" + content[501:])
    with pytest.raises(DamagedError):
        check(path)


def test_a_file_that_breaks_off_leaves_nothing(tmp_path):
    with (
        pytest.raises(ZeroDivisionError),
        whole_file(tmp_path / "a.nc", {"name": "a"}) as temporary,
    ):
        temporary.write_bytes(b"half")
        raise ZeroDivisionError
    assert list(tmp_path.iterdir()) == []


KILLED = """
import os, sys
from fpm.files.seals import whole_file
with whole_file(sys.argv[1]) as temporary:
    temporary.write_text("half")
    os.kill(os.getpid(), 9)
"""


def test_what_dead_processes_left_is_swept_and_nothing_else(tmp_path):
    subprocess.run([sys.executable, "-c", KILLED, tmp_path / "a.nc"], check=False)
    assert len(list(tmp_path.iterdir())) == 1
    (tmp_path / ".mine.nc").write_text("x")
    with whole_file(tmp_path / "b.nc") as temporary:
        temporary.write_text("being written")
        assert len(seals.remove_temporary(tmp_path)) == 1
        assert temporary.exists()
    assert sorted(p.name for p in tmp_path.iterdir()) == [".mine.nc", "b.nc"]
    assert seals.remove_temporary(tmp_path / "nowhere") == []
