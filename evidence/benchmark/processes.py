"""Python in processes of their own, which find the packages of this checkout."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def environment(**variables: str) -> dict[str, str]:
    """The environment of a process that imports from this checkout, installed or not."""
    paths = filter(None, [str(ROOT), os.environ.get("PYTHONPATH")])
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths), **variables}


def python(*arguments: str, **variables: str) -> str:
    """What Python prints when called with these arguments; CalledProcessError if it fails."""
    process = subprocess.run(
        [sys.executable, *arguments],
        env=environment(**variables), check=True, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    return process.stdout


IMPORT = """
import json, time
start = time.perf_counter()
import numpy, numba, xarray, netCDF4, matplotlib, snakemake
print(json.dumps(time.perf_counter() - start))
"""


def import_seconds() -> float:
    """Seconds in which a process imports what a campaign needs, the best of three."""
    return min(float(python("-c", IMPORT)) for _ in range(3))
