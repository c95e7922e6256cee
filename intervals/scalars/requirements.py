"""Where in the box requirements are met: limits that numbers must keep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..designs.scan import scan_points
from .surrogate import ScalarSurrogate

_LINES, _ON_LINE, _ON_ONE_LINE = 2048, 65, 4097
_AT_ONCE = 64  # lines


@dataclass(frozen=True)
class Limit:
    """What a number must keep: `kind` "at_most" or "at_least" a `level`, or "happens", whose level
    is 1 if there must be a number and 0 if there must be none."""

    surrogate: ScalarSurrogate
    kind: str
    level: float

    def slack(self, unit: np.ndarray) -> np.ndarray:
        """By how much the limit is kept at unit coordinates (P, k): (P), below 0 where it is not.

        Where there is no number, no level is kept; "happens" is kept or broken by infinity.
        """
        return self.slack_of(self.surrogate.evaluate(unit))

    def slack_of(self, values: np.ndarray) -> np.ndarray:
        """The same for values (...) of the number, NaN where there is none."""
        values = np.asarray(values, dtype=float)
        there = np.isfinite(values)
        if self.kind == "happens":
            return np.where(there == bool(self.level), np.inf, -np.inf)
        sign = 1.0 if self.kind == "at_most" else -1.0
        return np.where(there, sign * (self.level - np.where(there, values, 0.0)), -np.inf)

    def worst(self, lower: np.ndarray, upper: np.ndarray) -> tuple[float, np.ndarray]:
        """Least slack over the part [lower, upper] (k each) of the box, and where it is (k)."""
        return self._end(lower, upper, worst=True)

    def best(self, lower: np.ndarray, upper: np.ndarray) -> tuple[float, np.ndarray]:
        """Largest slack over the part [lower, upper] (k each), and where it is (k)."""
        return self._end(lower, upper, worst=False)

    def _end(self, lower: np.ndarray, upper: np.ndarray, worst: bool) -> tuple[float, np.ndarray]:
        found, middle = self.surrogate, (lower + upper) / 2
        if self.kind == "happens":
            place = found.somewhere if bool(self.level) != worst else found.nowhere
            at = place(lower, upper)
            kept = (at is None) == worst
            return (np.inf if kept else -np.inf), middle if at is None else at
        if worst and (at := found.nowhere(lower, upper)) is not None:
            return -np.inf, at
        sign = 1.0 if (self.kind == "at_most") == worst else -1.0
        value, at = found.end(sign, lower, upper)
        if not np.isfinite(value):
            return -np.inf, middle
        return (self.level - value if self.kind == "at_most" else value - self.level), at


def sub_box(nominal: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Unit corners (k each) of the box shrunk towards a nominal point (k) to a share of itself."""
    nominal = np.asarray(nominal, dtype=float)
    return nominal + share * (-1.0 - nominal), nominal + share * (1.0 - nominal)


def share_reaching(nominal: np.ndarray, unit: np.ndarray) -> np.ndarray:
    """The least shares (P) to which the box may be shrunk towards a nominal point (k) so that it
    still holds unit points (P, k)."""
    away = np.asarray(unit, dtype=float) - nominal
    room = np.where(away > 0, 1.0 - nominal, 1.0 + nominal)
    return np.divide(np.abs(away), room, out=np.zeros_like(away), where=room > 0).max(axis=1)


def share_of_box(limits: Sequence[Limit], free: np.ndarray) -> float:
    """Share of the box, by volume, in which all limits are kept; `free` (k): directions of width.

    Along one line in one dimension, along many lines spread over the box in several; the borders on
    each are found by linear interpolation of the least slack.
    """
    free = np.asarray(free, dtype=bool)
    if not free.any():
        return float(all(limit.slack(np.zeros((1, len(free))))[0] >= 0 for limit in limits))
    # The lines go along the direction with the largest differences.
    single = free.sum() == 1
    count = _ON_ONE_LINE if single else _ON_LINE
    line = np.linspace(-1.0, 1.0, count)
    along = int(np.argmax(free)) if single else _steepest(limits, free)
    others = free.copy()
    others[along] = False
    starts = np.zeros((1, len(free))) if single else scan_points(others, _LINES, corners=False)
    slack = []
    for first in range(0, len(starts), _AT_ONCE):
        points = np.repeat(starts[first : first + _AT_ONCE, None], count, axis=1)
        points[:, :, along] = line
        flat = points.reshape(-1, len(free))
        slack.append(np.min([limit.slack(flat) for limit in limits], axis=0).reshape(-1, count))
    slack = np.concatenate(slack)
    # Infinite slack has a sign only; it changes half way between two points.
    size = np.abs(slack[np.isfinite(slack)]).max(initial=1.0)
    slack = np.clip(slack, -size, size)
    a, b = slack[:, :-1], slack[:, 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(a >= 0, a, b) / np.abs(a - b)
    kept = np.where((a >= 0) & (b >= 0), 1.0, np.where((a < 0) & (b < 0), 0.0, part))
    return float(kept.mean())


def _steepest(limits: Sequence[Limit], free: np.ndarray) -> int:
    """The direction along which the numbers change most, as shares of all their change."""
    total = np.zeros(len(free))
    for limit in limits:
        if limit.kind == "happens" or limit.surrogate.fit is None:
            continue
        change = np.zeros(len(free))
        for j in np.flatnonzero(free):
            ends = np.zeros((2, len(free)))
            ends[:, j] = -1.0, 1.0
            change[j] = abs(np.diff(limit.surrogate.fit.evaluate(ends))[0])
        total += change / (change.sum() or 1.0)
    return int(np.argmax(np.where(free, total, -1.0)))


def largest_share(
    limits: Sequence[Limit], nominal: np.ndarray, steps: int = 24
) -> tuple[float, int | None, np.ndarray | None]:
    """The largest share to which the box may be shrunk towards the nominal point (k) so that all of
    it keeps every limit; then, if that is not all of it, the limit (its index) that is the first to
    be broken beyond it, and the unit point (k) where: the nearest one, in shares of the box.
    """

    def broken(share: float) -> tuple[float, int, np.ndarray] | None:
        worst = [(*limit.worst(*sub_box(nominal, share)), i) for i, limit in enumerate(limits)]
        slack, at, i = min(worst, key=lambda row: row[0])
        return None if slack >= 0 else (slack, i, at)

    found = broken(1.0)
    if found is None:
        return 1.0, None, None
    low, high = 0.0, 1.0
    if (at_nominal := broken(0.0)) is not None:
        return 0.0, at_nominal[1], at_nominal[2]
    for _ in range(steps):
        middle = 0.5 * (low + high)
        if (there := broken(middle)) is None:
            low = middle
        else:
            high, found = middle, there
    return low, found[1], found[2]
