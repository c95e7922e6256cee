"""Compiled afresh or loaded from the cache, the solver gives the same bits."""

import ctypes
import importlib
import os
import pkgutil
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from fpm import elements
from fpm.kernels import compiled_loop
from fpm.kernels.hooks import KERNELS

PROGRAM = '''
import fpm
from fpm.kernels.compiled_loop import COMPILED_NAMES
from fpm.structures import loads
scene = loads("""
points: {hub: [0, 0, 0], tip: [1, 0, 0]}
bodies: {ball: {mass: 1, centre: hub, points: [tip], inertia: [1, 2, 2.5]}}
initial_velocities: {whirl: {part: ball, about: hub, spin: [1, 2, 3]}}
gravity: [0, 0, -9.81]
record: {B: {part: ball, at: tip}}
""").build()
outcome = fpm.simulate(scene, duration=0.05, instants=3, step=5e-5)[0]
print(outcome.points["B"][0].tobytes().hex(), *COMPILED_NAMES)
'''

ALONE = "import os; os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])\n"
"""On one core, where no other process helps to compile."""

HELPED = """
from fpm.kernels import compiled_loop
start = compiled_loop._start_helper
def start_and_wait(*arguments):
    helper = start(*arguments)
    helper.wait()
    return helper
compiled_loop._start_helper = start_and_wait
"""
"""With a helper that is first everywhere."""


@pytest.mark.slow
def test_cached_code_gives_the_bits_of_fresh_code(tmp_path):
    root = str(Path(__file__).parents[2])
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": root}

    def run(start=ALONE):
        done = subprocess.run(
            [sys.executable, "-c", start + PROGRAM], env=environment, capture_output=True,
            text=True, check=True,
        )  # fmt: skip
        return done.stdout.split()

    (bits, *compiled), *later = run(), run()
    assert compiled == ["Weight", "run"]
    assert later == [[bits]]
    if len(os.sched_getaffinity(0)) > 1:
        shutil.rmtree(next(tmp_path.glob("numba-*")))
        assert run(HELPED) == [bits]


OWN_RUN = """
import sys
import numpy as np
from fpm.kernels import compiled_loop
from fpm.kernels.world import StepTime, World
from own_kernels import make

world = World(*[np.zeros((1, 1, 8))] * len(World._fields))._replace(givers=0)
for rate in map(float, sys.argv[1:]):
    own = make(rate)(np.ones(1))
    compiled_loop.prepare_call("act", [own], world, StepTime(0.0, 1.0, 1.0))()
    print(own.index[0])
"""

OWN_MADE = """
from typing import NamedTuple

import numpy as np
from fpm.kernels.hooks import hook
from numba import njit

TABLE = np.full(200_000, 3.0)

@njit
def check(x):
    assert x < 5.0
    return x

def make(rate):
    class Own(NamedTuple):
        index: np.ndarray

    @hook(Own)
    def forces(part, world, timing):
        part.index[0] = RESULT

    return Own
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("formula", "results"),
    [
        ("rate * part.index[0]", ["2.0", "4.0"]),  # one text, two kernels
        ("(lambda x: rate * x)(part.index[0])", ["2.0", "4.0"]),  # with all of numba's passes
        ("TABLE[int(rate * part.index[0])]", ["3.0", "3.0"]),  # at an address of this process
        ("check(rate * part.index[0])", []),  # raises an error
    ],
)
def test_kernels_from_outside_are_compiled_and_not_kept(tmp_path, formula, results):
    (tmp_path / "own_kernels.py").write_text(OWN_MADE.replace("RESULT", formula))
    (tmp_path / "run.py").write_text(OWN_RUN)
    paths = {"PYTHONPATH": str(Path(__file__).parents[2]), "NUMBA_CACHE_DIR": str(tmp_path)}
    for rates in (["2", "4"], ["4"]):
        done = subprocess.run(
            [sys.executable, tmp_path / "run.py", *rates], env={**os.environ, **paths},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.stdout.split() == results[-len(rates) :]
        assert ("kernels that raise no error" in done.stderr) == (not results)
    assert not list(tmp_path.rglob("Own-*.npz"))


def test_compiled_kernels_of_all_kinds_are_kept():
    for module in pkgutil.walk_packages(elements.__path__, f"{elements.__name__}."):
        importlib.import_module(module.name)
    hooks = [hook for hook in KERNELS if hook[0].__module__.startswith("fpm.")]
    assert {"Latches", "Joints"} <= {arrays.__name__ for arrays, _ in hooks}
    assert [h for h in hooks if compiled_loop._constants_of(KERNELS[h]) is None] == []


def make_ready(path: Path, compiled: list) -> float:
    """What a function gives that is compiled into a file, or loaded from it."""

    def compile_half() -> tuple[compiled_loop.Code, bool]:
        compiled.append(path)
        return {"half": compiled_loop._compile(lambda x: x[0] * 0.5, [ARRAY])[1]}, True

    address = compiled_loop._make_ready(path, compile_half)["half"]
    numbers, result = np.array([5.0]), ctypes.c_double()
    words = list(compiled_loop.words_of(numbers))
    kinds = [ctypes.c_void_p, ctypes.c_void_p, *[ctypes.c_int64] * len(words)]
    ctypes.CFUNCTYPE(ctypes.c_int32, *kinds)(address)(ctypes.addressof(result), None, *words)
    return result.value


ARRAY = compiled_loop.numba_type(np.zeros(1))


@pytest.mark.parametrize("harm", ["cut off", "flipped", "another's"])
def test_a_file_that_is_not_as_it_was_written_is_made_again(tmp_path, caplog, harm):
    compiled: list[Path] = []
    path, other = tmp_path / "x.npz", tmp_path / "y.npz"
    assert [make_ready(p, compiled) for p in (path, other, path)] == [2.5] * 3
    assert compiled == [path, other]
    content = path.read_bytes()
    middle = content.index(compiled_loop._read(path)["half"][1][:64]) + 32
    path.write_bytes({
        "cut off": content[:50],
        "flipped": content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :],
        "another's": other.read_bytes(),  # whole
    }[harm])  # fmt: skip
    assert [make_ready(path, compiled) for _ in range(2)] == [2.5, 2.5]
    assert compiled == [path, other, path]
    assert caplog.text.count(f"{path}: compiled code that is not as it was written; it is") == 1


def test_what_several_threads_need_is_compiled_once(tmp_path):
    compiled: list[Path] = []
    with ThreadPoolExecutor(8) as pool:
        results = list(pool.map(lambda _: make_ready(tmp_path / "a" / "x.npz", compiled), range(8)))
    assert results == [2.5] * 8
    assert len(compiled) == 1


def test_a_cache_that_cannot_be_written_is_done_without(tmp_path):
    (tmp_path / "folder").write_text("no folder")
    compiled: list[Path] = []
    assert [make_ready(tmp_path / "folder" / "x.npz", compiled) for _ in range(2)] == [2.5, 2.5]
    assert len(compiled) == 2


@pytest.mark.parametrize("value", [np.zeros((4, 4))[:, ::2], "text", {}, 1j])
def test_what_kernels_cannot_read_is_refused(value):
    with pytest.raises(TypeError, match="kernels take C-contiguous arrays"):
        compiled_loop.form_of((value,))
