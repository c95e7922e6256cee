"""Compiled afresh or loaded from the cache, the solver gives the same bits."""

import errno
import fcntl
import importlib
import os
import pkgutil
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numba
import numpy as np
import pytest

import fpm.elements
from fpm.errors import ChangedError
from fpm.kernels import compiled_loop
from fpm.kernels.hooks import KERNELS

PROGRAM = '''
import fpm
from fpm.kernels.compiled_loop import LOOPS
from fpm.structures import loads
scene = loads("""
points: {hub: [0, 0, 0], tip: [1, 0, 0]}
materials: {wood: {E: 1e10, rho: 500}}
sections: {square: {type: square, side: 0.05}}
bars: {arm: {through: [hub, tip], section: square, material: wood, elements: 2}}
initial_velocities: {whirl: {part: arm, about: hub, spin: [1, 2, 3]}}
record: {B: {part: arm, at: tip}}
""").build()
outcome = fpm.simulate(scene, duration=0.05, instants=3, step=5e-5)[0]
print(outcome.points["B"][0].tobytes().hex())
print(sum(sum(run.stats.cache_hits.values()) for run in LOOPS.values()))
'''


@pytest.mark.slow
def test_cached_code_gives_the_bits_of_fresh_code(tmp_path):
    root = str(Path(__file__).parents[2])
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": root}

    def run():
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True,
            check=True,
        )  # fmt: skip
        told.append(done.stderr)
        return done.stdout.split()

    told = []
    runs = [run(), run()]
    assert [int(hits) for _, hits in runs] == [0, 1]
    assert runs[0][0] == runs[1][0]
    # Whatever is wrong with a file of compiled code, it is not loaded but made again.
    for kind, harm in (("nbi", lambda b: b[:50]), ("nbc", lambda b: b[:-1] + bytes([b[-1] ^ 1]))):
        (path,) = tmp_path.rglob(f"*.{kind}")
        path.write_bytes(harm(path.read_bytes()))
        assert run() == [runs[0][0], "0"]
        assert f"{path}: compiled code that is not as it was written; it is made again" in told[-1]
        assert run() == [runs[0][0], "1"]
        assert "again" not in told[-1]


OWN_KIND = {
    "own_kernels": """
from typing import NamedTuple

import numpy as np
import own_functions
from fpm.kernels.hooks import hook
from own_numbers import RATE

class Own(NamedTuple):
    index: np.ndarray

@hook(Own)
def forces(part, world, timing):
    part.index[0] = RATE * own_functions.twice(part.index[0])
""",
    "own_numbers": "RATE = 1.0",
    "own_functions": """
from fpm.kernels.vectors import kernel

@kernel
def twice(x):
    return 2.0 * x
""",
    "not_imported": "RATE = 1.0",
}


@pytest.fixture
def own(tmp_path, monkeypatch):
    """The named tuple of a kind of four files in a folder."""
    for name, text in OWN_KIND.items():
        (tmp_path / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    yield importlib.import_module("own_kernels").Own
    for key in [key for key in KERNELS if key[0].__module__ == "own_kernels"]:
        del KERNELS[key]
    for name in OWN_KIND:
        sys.modules.pop(name, None)


@pytest.mark.parametrize(("name", "other"), [(name, name != "not_imported") for name in OWN_KIND])
def test_an_edit_of_what_a_kind_imports_is_refused_in_its_process(own, tmp_path, name, other):
    before = compiled_loop.cache_folder((own,))
    path = tmp_path / f"{name}.py"
    path.write_text(path.read_text().replace("1.0", "3.0").replace("2.0", "3.0") + "\nMORE = 1\n")
    compiled_loop.source_digest.cache_clear()
    if other:  # compiled code of this process is of the file as it was
        with pytest.raises(ChangedError, match=f"{name}.py changed since it was imported"):
            compiled_loop.cache_folder((own,))
    else:
        assert compiled_loop.cache_folder((own,)) == before


def test_threads_do_not_mix_up_their_caches(monkeypatch, tmp_path):
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(compiled_loop, "LOOPS", {})
    kinds = [NamedTuple(f"Kind{i}", [("index", np.ndarray)]) for i in range(16)]
    world, start = SimpleNamespace(state=np.zeros(1)), threading.Barrier(len(kinds))
    refused = []

    def ask(kind):
        start.wait()
        try:
            compiled_loop.loop_for(((kind(np.zeros(1)),), world))
        except ValueError as error:  # such a world has no type, so that nothing is compiled
            refused.append(str(error))

    threads = [threading.Thread(target=ask, args=[kind]) for kind in kinds]
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    finally:
        sys.setswitchinterval(interval)
    assert len(refused) == len(kinds)
    assert all("Cannot determine Numba type" in text for text in refused)
    assert str(tmp_path) == numba.config.CACHE_DIR
    for kind in kinds:
        folder = compiled_loop.cache_folder((kind,))
        assert Path(compiled_loop.LOOPS["loop", (kind,)].stats.cache_path).parent == folder


def test_another_processor_has_another_cache_beside(monkeypatch):
    before = compiled_loop.cache_folder()
    monkeypatch.setattr(compiled_loop, "processor", lambda: "another")
    assert compiled_loop.cache_folder() != before
    assert compiled_loop.cache_folder().parents[1] == before.parents[1]


def test_a_loop_of_all_kinds_has_a_folder_that_can_be_made(tmp_path, monkeypatch):
    """A name of more than 255 letters was none: the loop was compiled in every process again."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    for module in pkgutil.walk_packages(fpm.elements.__path__, "fpm.elements."):
        importlib.import_module(module.name)  # else a kind is known once a scene has it
    own = (arrays for arrays, _ in KERNELS if arrays.__module__.startswith("fpm."))
    every = tuple(dict.fromkeys(own))
    assert len(every) > 20
    folders = [compiled_loop.cache_folder(kinds) for kinds in (every, every[:-1])]
    with compiled_loop._one_at_a_time(folders[0]) as is_locked:
        assert is_locked
    assert folders[0] != folders[1]


def test_the_lock_is_where_the_cache_is(tmp_path):
    program = """
import sys
from pathlib import Path
from fpm.kernels.compiled_loop import _one_at_a_time
with _one_at_a_time(Path(sys.argv[1])) as is_locked:
    print(is_locked, flush=True)
    sys.stdin.read()
"""
    folder = tmp_path / "cache" / "loop"
    command = [sys.executable, "-c", program, str(folder)]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    streams = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, env=environment, **streams) as other:
        assert other.stdout.readline() == "True\n"
        with open(tmp_path / "cache" / "loop.lock") as file, pytest.raises(BlockingIOError):
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        other.communicate()
    with compiled_loop._one_at_a_time(folder) as is_locked:
        assert is_locked


class Lonely(NamedTuple):
    """What a kind has, of which there is no kernel."""

    index: np.ndarray


@pytest.mark.parametrize("reason", [errno.ENOLCK, errno.EOPNOTSUPP])
def test_without_locks_nothing_is_kept(monkeypatch, tmp_path, reason):
    def refuse(*_):
        raise OSError(reason, os.strerror(reason))

    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(compiled_loop, "LOOPS", {})
    monkeypatch.setattr(compiled_loop.fcntl, "flock", refuse)
    with pytest.raises(ValueError, match="Cannot determine Numba type"):
        compiled_loop.loop_for(((Lonely(np.zeros(1)),), SimpleNamespace(state=np.zeros(1))))
    assert compiled_loop.LOOPS["loop", (Lonely,)].stats.cache_path is None
    assert not list(tmp_path.rglob("*.nb*"))
