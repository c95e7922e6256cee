"""Peers in interpreters of their own, since their pins clash."""

import importlib.util
import os
import sys


def interpreter(module: str, variable: str) -> str | None:
    """The Python that has a peer, as an environment variable names it, or this one; else None."""
    if os.environ.get(variable):
        return os.environ[variable]
    return sys.executable if importlib.util.find_spec(module) else None
