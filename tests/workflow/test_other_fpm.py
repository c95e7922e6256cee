"""Another package's module `fpm`, as Fortran's package manager brings one, is told at once."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_another_fpm_is_told_in_one_line_with_the_remedy(tmp_path):
    (tmp_path / "fpm").mkdir()
    (tmp_path / "fpm/__init__.py").write_text("VERSION = '0.12'\n", encoding="utf-8")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])}
    done = subprocess.run(
        [sys.executable, "-m", "deployable", "check", str(ROOT / "config/small.yaml")],
        cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    (line,) = done.stderr.splitlines()
    assert f"{tmp_path / 'fpm'}) is not this program's; remedy: " in line
    del environment["PYTHONPATH"]
    done = subprocess.run(
        [sys.executable, "-m", "deployable", "--version"],
        cwd=ROOT, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
