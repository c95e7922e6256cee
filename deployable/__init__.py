"""Bounds of a deployable structure's motion over interval parameters.

`deployable.intervals` is interval mathematics, `deployable.campaign` what joins it to `fpm`, the
mechanics. They are imported on first use, so that `__main__` can set up numerics before."""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

ROOMS = ("intervals", "campaign")


def check_fpm_module() -> str:
    """Check that the module `fpm` that Python finds is this program's, not that of Fortran's
    package manager; returns an error message with the remedy, or an empty text if it is."""
    spec = find_spec("fpm")
    place = Path(spec.origin).parent if spec and spec.origin else None
    folder = Path(__file__).parents[1] / "fpm"
    if place == folder and "Finite particle method" in (folder / "__init__.py").read_text("utf-8"):
        return ""
    return (
        f"error: the module fpm that Python finds ({place or 'nowhere'}) is not this program's; "
        "remedy: an environment of its own, or `pip uninstall fpm` and install this program again"
    )


def __getattr__(name: str) -> ModuleType:
    if name not in ROOMS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return import_module(f"{__name__}.{name}")


def __dir__() -> list[str]:
    return sorted({*globals(), *ROOMS})
