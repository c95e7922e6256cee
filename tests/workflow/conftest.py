"""The workflow in a folder of its own, so that tests leave the checkout alone."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


class Workplace:
    """A folder with the Snakefile, where Snakemake runs."""

    def __init__(self, folder: Path):
        self.folder = folder
        for name in ("workflow", "config"):
            shutil.copytree(ROOT / name, folder / name)
        shutil.copy(ROOT / "Snakefile", folder)
        (folder / "profiles").symlink_to("workflow/profiles")

    def command(self, *arguments: str) -> list[str]:
        return [sys.executable, "-m", "snakemake", "-c2", *arguments]

    def environment(self) -> dict[str, str]:
        return {**os.environ, "PYTHONPATH": str(ROOT)}

    def snakemake(self, *arguments: str) -> subprocess.CompletedProcess:
        """Run Snakemake to its end; stdout and stderr together in `.stdout`."""
        return subprocess.run(
            self.command(*arguments),
            cwd=self.folder,
            env=self.environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=600,
            check=False,
        )

    def config(self, name: str, text: str) -> str:
        """Write a config and return its path for `--configfile`."""
        path = self.folder / "config" / f"{name}.yaml"
        path.write_text(text, encoding="utf-8")
        return str(path)


@pytest.fixture
def workplace(tmp_path) -> Workplace:
    return Workplace(tmp_path)


@pytest.fixture(scope="session")
def small(tmp_path_factory) -> Workplace:
    """A workplace in which the small campaign was run; tests must not change its results."""
    place = Workplace(tmp_path_factory.mktemp("small"))
    done = place.snakemake("--configfile", "config/small.yaml")
    assert done.returncode == 0, done.stdout
    place.output = done.stdout
    return place
