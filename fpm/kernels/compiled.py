"""The compiled time loop, cached on disk.

Numba's cache looks at the file of the cached function only; the loop is made of many files. So the
cache folder is named after a digest of all kernel sources: an edited kernel never meets old code.
"""

import hashlib
import os
from pathlib import Path

import numba

from fpm.kernels import run as loop
from fpm.kernels.vectors import OPTIONS


def source_digest() -> str:
    """Hexadecimal digest of the kernel sources and of numba's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Where compiled code is kept: where NUMBA_CACHE_DIR says, beside the sources, or at home."""
    name = f"numba-{source_digest()}"
    if numba.config.CACHE_DIR:
        return Path(numba.config.CACHE_DIR) / name
    beside = Path(__file__).parent / "__pycache__"
    try:
        beside.mkdir(exist_ok=True)
        writable = os.access(beside, os.W_OK)
    except OSError:
        writable = False
    user = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "fpm"
    return (beside if writable else user) / name


def _cached(function):
    """Compile with numba, caching in `cache_folder` without changing numba's own setting."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(cache_folder())
    try:
        return numba.njit(cache=True, **OPTIONS)(function)
    finally:
        numba.config.CACHE_DIR = before


run = _cached(loop.run.py_func)
