"""The decision of an adaptive campaign: which design comes next, or why to stop.

Pure logic without files or runs: a round of the campaign makes a design, runs it, estimates its
error, and asks `decide` what to do. A specification is plain data, for JSON and YAML.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..designs import MAX_ORDER, METHODS, Design, SplitDesign, make_design, split_design
from ..errors import IntervalError
from ..points import keys

_NO_GAIN = 0.7  # a raised order that leaves more than this share of the error did not help
_MAX_PARTS = 64


@dataclass(frozen=True)
class Specification:
    """A design as plain data.

    Attributes
    ----------
    method
        As for `make_design`.
    order
        One order for each direction (k); 0 leaves a direction out.
    parts
        Boxes (lower (k), upper (k)) in unit coordinates; empty for the whole box.
    """

    method: str
    order: tuple[int, ...]
    parts: tuple[tuple[tuple[float, ...], tuple[float, ...]], ...] = ()

    def design(self, existing: np.ndarray | None = None) -> Design | SplitDesign:
        """Make the design; `existing` (R, k) are points that total_degree reuses."""
        options = {}
        if self.method == "total_degree" and existing is not None and not self.parts:
            options["existing"] = existing
        design = make_design(self.method, len(self.order), self.order, **options)
        return split_design(design, self.parts) if self.parts else design


@dataclass(frozen=True)
class Progress:
    """What a round knows.

    Attributes
    ----------
    specification
        The design that has been run.
    error
        Its estimated error as a share of the width of the bounds (largest over the responses).
    tails
        (k): how much of the error each direction causes, e.g. from `measure_round`; only
        their proportions count.
    points
        (R, k): unit coordinates of all runs so far.
    tolerance, budget
        Error to reach, and number of runs that may be spent (held-out runs not counted).
    history
        Errors of the earlier rounds, oldest first, with the same parts.
    free
        (k): directions that have a width; by default all.
    """

    specification: Specification
    error: float
    tails: Sequence[float]
    points: np.ndarray
    tolerance: float
    budget: int
    history: Sequence[float] = ()
    free: Sequence[bool] | None = None


@dataclass(frozen=True)
class Decision:
    """What to do next.

    Attributes
    ----------
    action
        ``"stop"``, ``"raise order"``, ``"add direction"`` or ``"split"``.
    reason
        Why, in a sentence for the summary.
    specification
        The next design; the present one where the action is to stop.
    new_runs
        Number of points of the next design that have not been run.
    met
        True where the tolerance is met.
    """

    action: str
    reason: str
    specification: Specification
    new_runs: int = 0
    met: bool = False
    considered: tuple[str, ...] = field(default=())


def decide(progress: Progress) -> Decision:
    """Decide on the next round.

    1. Stop where the error meets the tolerance.
    2. If raising the order left most of the error (twice, while an order is below 4), split the
       box in halves along the direction with the largest tail: the response is not smooth there.
    3. Else raise the order of the directions with the largest tails (a direction of order 0 is
       added with order 2 for nested rules, 1 otherwise), as its method says: doubled for Lobatto
       rules, which keeps their runs; by 2 for roots; by 1 for total degree.
    4. Whatever does not fit the budget is tried in a cheaper form (one direction only); if nothing
       fits, stop and say that the budget is spent.
    """
    _check(progress)
    now = progress.specification
    if progress.error <= progress.tolerance:
        reason = f"error {progress.error:.3g} of the width meets {progress.tolerance:.3g}"
        return Decision("stop", reason, now, met=True)
    raises = _raises(progress)
    splits = _splits(progress)
    stuck = _is_stuck(progress)
    options = splits + raises if stuck else raises + splits
    tried = []
    for action, candidate, why in options:
        new_runs = _new_runs(candidate, progress.points)
        if new_runs is None or len(progress.points) + new_runs > progress.budget:
            tried.append(f"{action}: {'too many' if new_runs is None else new_runs} runs")
            continue
        if new_runs == 0:
            continue
        reason = f"error {progress.error:.3g} of the width is above {progress.tolerance:.3g}; {why}"
        return Decision(action, reason, candidate, new_runs, considered=tuple(tried))
    reason = (
        f"budget of {progress.budget} runs is spent ({len(progress.points)} done) at an error of "
        f"{progress.error:.3g} of the width, above {progress.tolerance:.3g}"
        if tried
        else f"no design of {now.method} goes further at an error of {progress.error:.3g}"
    )
    return Decision("stop", reason, now, considered=tuple(tried))


def _check(progress: Progress) -> None:
    k = len(progress.specification.order)
    if not progress.tolerance > 0:
        raise IntervalError("tolerance", progress.tolerance, "a number above 0")
    if progress.budget < 1:
        raise IntervalError("budget", progress.budget, "at least one run")
    if not (np.isfinite(progress.error) and progress.error >= 0):
        raise IntervalError("error", progress.error, "a number of at least 0")
    if len(progress.tails) != k:
        raise IntervalError("tails", len(progress.tails), f"{k} numbers, one for each direction")
    if progress.specification.method == "scan":
        raise IntervalError("method", "scan", "a method with an order, to adapt it")


def _free(progress: Progress) -> np.ndarray:
    k = len(progress.specification.order)
    return np.ones(k, dtype=bool) if progress.free is None else np.asarray(progress.free, bool)


def _is_stuck(progress: Progress) -> bool:
    """Orders below 4 show too little decay to tell the worst direction, so they get two chances."""
    orders = [n for n in progress.specification.order if n]
    patience = 1 if min(orders, default=0) >= 4 else 2
    if len(progress.history) < patience:
        return False
    return progress.error > _NO_GAIN * progress.history[-patience]


def _raises(progress: Progress) -> list[tuple[str, Specification, str]]:
    """Higher orders, the most thorough first: all directions that matter, then the worst one."""
    now, free = progress.specification, _free(progress)
    tails = np.where(free, np.asarray(progress.tails, dtype=float), 0.0)
    order, higher = np.array(now.order), METHODS[now.method].higher
    missing = free & (order == 0)
    found = []
    if missing.any():
        raised = np.where(missing, higher(0), order)
        found.append(("add direction", raised, f"direction {np.flatnonzero(missing)[0]} is added"))
    worst = tails.max()
    matters = free & (order > 0) & (tails >= 0.25 * worst if worst > 0 else free)
    for mask in (matters, matters & (np.arange(len(order)) == int(np.argmax(tails)))):
        if mask.any():
            raised = np.array([higher(n) if m else n for n, m in zip(order, mask, strict=True)])
            if (raised <= MAX_ORDER).all():
                where = ", ".join(str(j) for j in np.flatnonzero(mask))
                text = f"the order of direction {where} is raised"
                found.append(("raise order", raised, text))
    return [
        (action, replace(now, order=tuple(int(n) for n in raised)), text)
        for action, raised, text in found
    ]


def _splits(progress: Progress) -> list[tuple[str, Specification, str]]:
    """Every part halved along the direction with the largest tail."""
    now, free = progress.specification, _free(progress)
    tails = np.where(free, np.asarray(progress.tails, dtype=float), -1.0)
    j = int(np.argmax(tails))
    ones = tuple(1.0 for _ in now.order)
    parts = now.parts or ((tuple(-x for x in ones), ones),)
    if 2 * len(parts) > _MAX_PARTS or not free.any():
        return []
    halves = []
    for lower, upper in parts:
        middle = (lower[j] + upper[j]) / 2
        halves.append((lower, (*upper[:j], middle, *upper[j + 1 :])))
        halves.append(((*lower[:j], middle, *lower[j + 1 :]), upper))
    text = f"the box is split in direction {j}, where a higher order does not help"
    return [("split", replace(now, parts=tuple(halves)), text)]


def _new_runs(specification: Specification, points: np.ndarray) -> int | None:
    """Points of a design that are not among `points`; None where it is refused as too large."""
    try:
        wanted = specification.design(points).points
    except IntervalError:
        return None
    known = set(keys(points, 9))
    return sum(key not in known for key in keys(wanted, 9))
