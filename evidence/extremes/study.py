"""The study of extremes: every row is accurate as stated, a clear refusal, or a failing row."""

from collections.abc import Callable, Mapping
from functools import partial

from evidence.extremes import parameters, runs, stable_step
from evidence.results import Report
from evidence.rows import Row, set_group

GROUPS: dict[str, Callable[[], list[Row]]] = {
    "stable-step": stable_step.study,
    "materials": parameters.materials,
    "sections": parameters.sections,
    "lengths": parameters.lengths,
    "stiffnesses": parameters.stiffnesses,
    "starts": runs.starts,
    "durations": runs.durations,
    "damping": runs.damping,
}


def _measure(group: str, quick: bool) -> list[dict]:
    return [row.plain() for row in set_group(group.replace("-", " "), GROUPS[group]())]


PARTS = {group: partial(_measure, group) for group in GROUPS}


def report(parts: Mapping[str, list[dict]]) -> Report:
    """The rows of all groups."""
    return Report([Row(**row) for group in parts.values() for row in group])
