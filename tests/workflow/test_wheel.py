"""The program as a wheel: from nothing to the report, in a folder that knows no checkout."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

from fpm.kernels.compiled_loop import cache_folder

ROOT = Path(__file__).parents[2]
SOURCES = ("deployable", "fpm", "evidence", "workflow", "config")
FILES = ("pyproject.toml", "README.md", "LICENSE", "Snakefile")


class Environment:
    """A virtual environment that sees the packages of this one, but not the program."""

    def __init__(self, folder: Path):
        self.bin = folder / "bin"
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        packages = Path(self.call("python", "-c", "import site; print(site.getsitepackages()[0])"))
        (packages / "others.pth").write_text(sysconfig.get_path("purelib"), encoding="utf-8")

    def call(self, program: str, *arguments: str | Path, folder: Path | None = None) -> str:
        """What a program of the environment prints; it must end well."""
        environment = {name: os.environ[name] for name in os.environ if name != "PYTHONPATH"}
        environment["NUMBA_CACHE_DIR"] = str(cache_folder().parent)
        done = subprocess.run(
            [self.bin / program, *arguments], cwd=folder or self.bin, env=environment,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout
        return done.stdout.strip()


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    return Environment(tmp_path_factory.mktemp("environment"))


@pytest.fixture(scope="module")
def checkout(tmp_path_factory):
    """A copy of what a wheel is made of, since building leaves files beside the sources."""
    folder = tmp_path_factory.mktemp("checkout")
    for name in SOURCES:
        nothing = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / name, folder / name, symlinks=True, ignore=nothing)
    for name in FILES:
        shutil.copy(ROOT / name, folder)
    return folder


@pytest.mark.slow
def test_an_installed_wheel_goes_from_nothing_to_the_report(small, environment, checkout, tmp_path):
    environment.call("pip", "wheel", checkout, "--no-deps", "-w", tmp_path)
    (wheel,) = tmp_path.glob("*.whl")
    names = zipfile.ZipFile(wheel).namelist()
    assert "deployable/campaign/program_data/workflow/Snakefile" in names
    assert "deployable/campaign/program_data/config/structures/scissor.yaml" in names
    assert {name.split("/")[0] for name in names if ".dist-info/" not in name} == {
        "deployable",
        "fpm",
    }
    assert not any("studies" in name for name in names)
    environment.call("pip", "install", "--no-deps", wheel)
    where = environment.call("python", "-c", "import deployable; print(deployable.__file__)")
    assert Path(where).is_relative_to(environment.bin.parent)

    mine = tmp_path / "my campaign"
    environment.call("deployable", "new", mine, "--start", "small")
    told = environment.call("python", "-m", "snakemake", "-c2", folder=mine)
    assert "Open results/small/report.html" in told
    assert (mine / "results/small/report.html").stat().st_size > 50_000
    again = ("run", "--results", "other", "--no-figures")
    environment.call("python", "-m", "deployable", *again, folder=mine)
    expected = json.loads((small.folder / "results/small/summary.json").read_text())["responses"]
    for results in ("results", "other"):
        made = json.loads((mine / results / "small/summary.json").read_text())
        assert made["responses"] == expected, results


@pytest.mark.slow
def test_an_editable_install_brings_the_workflow_too(environment, checkout, tmp_path):
    environment.call("pip", "install", "--no-deps", "-e", checkout)
    where = environment.call("python", "-c", "import deployable; print(deployable.__file__)")
    assert Path(where).is_relative_to(checkout)
    environment.call("deployable", "new", tmp_path / "mine", "--start", "mast")
    assert "results/mast" in environment.call(
        "python", "-m", "snakemake", "-n", "-p", "--quiet", "host", folder=tmp_path / "mine"
    )
