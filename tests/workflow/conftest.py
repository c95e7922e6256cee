"""The workflow in a folder of its own, so that tests leave the checkout alone."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

# Half of a dry run goes into imports: this has them done, and forks for every call.
_READY = """
import json, os, sys
import pandas  # by Snakemake, later
from snakemake.cli import main
for line in sys.stdin:
    folder, output, arguments = json.loads(line)
    if not os.fork():
        os.chdir(folder)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(os.open(output, os.O_WRONLY | os.O_CREAT), 1)
        os.dup2(1, 2)
        sys.argv[1:] = arguments
        main(arguments)  # exits
    print(os.waitstatus_to_exitcode(os.wait()[1]), flush=True)
"""


class Place:
    """A folder where Snakemake runs."""

    def __init__(self, folder: Path, ready: subprocess.Popen):
        self.folder, self.ready = folder, ready

    def command(self, *arguments: str) -> list[str]:
        return [sys.executable, "-m", "snakemake", "-c2", *arguments]

    def environment(self) -> dict[str, str]:
        return {**os.environ, "PYTHONPATH": str(ROOT)}

    def snakemake(self, *arguments: str) -> subprocess.CompletedProcess:
        """Run Snakemake to its end; stdout and stderr together in `.stdout`."""
        command = self.command(*arguments)
        output = self.folder / "output.txt"
        order = [str(self.folder), str(output), command[command.index("snakemake") + 1 :]]
        print(json.dumps(order), file=self.ready.stdin, flush=True)
        status = int(self.ready.stdout.readline())
        told = output.read_text(encoding="utf-8")
        output.unlink()
        return subprocess.CompletedProcess(command, status, told)


class Workplace(Place):
    """A folder with the Snakefile, as a checkout has it."""

    def __init__(self, folder: Path, ready: subprocess.Popen):
        super().__init__(folder, ready)
        for name in ("workflow", "config"):
            shutil.copytree(ROOT / name, folder / name)
        shutil.copy(ROOT / "Snakefile", folder)
        (folder / "profiles").symlink_to("workflow/profiles")

    def config(self, name: str, text: str) -> str:
        """Write a config and return its path for `--configfile`."""
        path = self.folder / "config" / f"{name}.yaml"
        path.write_text(text, encoding="utf-8")
        return str(path)


@pytest.fixture(scope="session")
def ready():
    """The process that calls Snakemake."""
    with subprocess.Popen(
        [sys.executable, "-c", _READY], env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        yield process


@pytest.fixture
def place_in(ready):
    """Makes a `Place` of a folder."""
    return lambda folder: Place(folder, ready)


@pytest.fixture
def workplace(tmp_path, ready) -> Workplace:
    return Workplace(tmp_path, ready)


@pytest.fixture(scope="session")
def small(tmp_path_factory, ready) -> Workplace:
    """A workplace in which the small campaign was run, once for all processes: the others have a
    copy. Tests must not change its results."""
    place, base = Workplace(tmp_path_factory.mktemp("small"), ready), tmp_path_factory.getbasetemp()
    made = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "made"
    with open(made.with_suffix(".lock"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not made.exists():
            done = place.snakemake("--configfile", "config/small.yaml")
            assert done.returncode == 0, done.stdout
            shutil.copytree(place.folder, made, symlinks=True)
            (made / "output.txt").write_text(done.stdout, encoding="utf-8")
    for name in ("results", ".snakemake"):
        shutil.copytree(made / name, place.folder / name, dirs_exist_ok=True)
    place.output = (made / "output.txt").read_text(encoding="utf-8")
    return place
