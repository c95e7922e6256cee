"""The row in which every study tells a finding, and the ways to judge one."""

import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace


@dataclass(frozen=True)
class Row:
    """One finding. A row that fails stays a failing row.

    reference: the right value, or the target; `sense` says how the value is held against it, as
    "within" `tolerance` (in the value's unit), "at most" or "at least". passed: None where there is
    nothing to judge. source: where the reference is from; note: what a reader should know; group:
    the problem, case or table of the row; skipped: why nothing was measured, with the remedy."""

    name: str
    value: float | str | None
    unit: str = ""
    sense: str = ""
    reference: float | str | None = None
    tolerance: float | None = None
    passed: bool | None = None
    source: str = ""
    note: str = ""
    group: str = ""
    skipped: str = ""

    @property
    def is_failed(self) -> bool:
        """Whether the row was judged and found wanting."""
        return self.passed is False

    def plain(self) -> dict:
        """The row for a JSON file; numbers that are not finite become None."""
        return {
            key: None if isinstance(x, float) and not math.isfinite(x) else x
            for key, x in asdict(self).items()
        }


def info(name: str, value: float | str, unit: str = "", note: str = "") -> Row:
    """A finding that nothing is asked of."""
    return Row(name, value, unit, note=note)


def close_to(
    name: str, value: float, reference: float, tolerance: float, source: str = "", note: str = ""
) -> Row:
    """A value that may miss its reference by `tolerance`; one that is not a number fails."""
    passed = bool(abs(value - reference) <= tolerance)
    numbers = float(reference), float(tolerance)
    return Row(name, float(value), "", "within", *numbers, passed, source, note)


def at_most(
    name: str, value: float, limit: float, source: str = "", note: str = "", unit: str = ""
) -> Row:
    """A value that must not exceed a limit."""
    passed = bool(value <= limit)
    return Row(name, float(value), unit, "at most", float(limit), None, passed, source, note)


def at_least(
    name: str, value: float, limit: float, source: str = "", note: str = "", unit: str = ""
) -> Row:
    """A value that must reach a limit."""
    passed = bool(value >= limit)
    return Row(name, float(value), unit, "at least", float(limit), None, passed, source, note)


def refusal(name: str, error: object) -> Row:
    """A case that is refused by name, as it should be."""
    text = f"refused: {error}"
    return Row(name, text, "", "", "a clear refusal", None, True, "the error's message")


def skip_row(name: str, reason: str, unit: str = "") -> Row:
    """What cannot be measured here; `reason` says what would make it possible."""
    return Row(name, None, unit, skipped=reason)


def set_group(group: str, rows: Iterable[Row]) -> list[Row]:
    """The rows, as members of a group."""
    return [replace(row, group=group) for row in rows]
