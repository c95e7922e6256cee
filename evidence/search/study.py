"""The study of bounds of quantities: mechanisms whose bounds are known, by whole campaigns."""

from collections.abc import Mapping
from functools import partial

from evidence.results import Report
from evidence.search import mechanisms

PARTS = {
    part: partial(mechanisms.measure, f"mechanisms_{part}")
    for part in ("carts", "slides", "chains")
}


def report(parts: Mapping[str, list]) -> Report:
    """What the study claims of all mechanisms that were measured, and all as a table."""
    return mechanisms.report([check for part in parts.values() for check in part])
