"""Bounds of a deployable structure's motion over interval parameters.

The one name under which everything is imported: `deployable.fpm` is mechanics,
`deployable.intervals` interval mathematics, `deployable.campaign` what joins the two. They are
imported when they are asked for, so that `python -m deployable` can set up numerics before.
"""

from importlib import import_module
from types import ModuleType

ROOMS = ("fpm", "intervals", "campaign")


def __getattr__(name: str) -> ModuleType:
    if name not in ROOMS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return import_module(f"{__name__}.{name}")


def __dir__() -> list[str]:
    return sorted({*globals(), *ROOMS})
