"""What computed a result: the program, its source files, the machine and the packages.

netCDF files have it as the attribute `provenance`; seals of all results have it with the moment, so
that the same results are the same but for their seals."""

import json
import os
import platform
import subprocess
from contextlib import suppress
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import deployable
from fpm.kernels import sources

PACKAGES = ("numpy", "scipy", "numba", "xarray", "netCDF4")
CONFIG = "DEPLOYABLE_CONFIG"
"""Environment variable by which a workflow tells its jobs which config file they are of."""

_ROOT = Path(__file__).parents[2]


def program_digest() -> str:
    """Digest (16 hex digits) of all source files of this program and of `fpm`, taken once in a
    process. Runs and results of different digests are not mixed."""
    return sources.digest(sources.PACKAGE, Path(__file__).parents[1])


@cache
def program() -> dict[str, str]:
    """Return what computes the results, as texts by name, found once in a process. `commit` ends
    with `, changed` if files differ from it, and is `unknown` without git."""
    versions = {
        "program": f"deployable-intervals {deployable.__version__}",
        "commit": _commit(),
        "processor": _processor(),
        "Python": platform.python_version(),
    }
    for package in PACKAGES:
        with suppress(PackageNotFoundError):
            versions[package] = version(package)
    return versions


def as_attribute() -> str:
    """`program` as one line of JSON, for the attribute `provenance` of netCDF files."""
    return json.dumps(program())


def stamp() -> dict[str, str]:
    """Return texts by name for a result's seal: `program`, `commit`, `processor`, `made` (now,
    UTC), and `config`, the paths of the config's files relative to the folder of all results."""
    moment = datetime.now(UTC).isoformat(timespec="seconds")
    facts = {key: program()[key] for key in ("program", "commit", "processor")}
    return facts | {"made": moment, "config": os.environ.get(CONFIG, "")}


def _commit() -> str:
    if not (_ROOT / ".git").exists():
        return "unknown"
    command = ["git", "-C", str(_ROOT), "describe", "--always", "--abbrev=40", "--exclude=*"]
    with suppress(OSError, subprocess.SubprocessError):
        return subprocess.run(
            [*command, "--dirty=, changed"], capture_output=True, text=True, check=True, timeout=10
        ).stdout.strip()
    return "unknown"


def _processor() -> str:
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
