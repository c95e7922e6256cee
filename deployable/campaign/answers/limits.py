"""The limits that requirements set, judged by surrogates and by runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from deployable.campaign.answers.bench import Bench
from deployable.campaign.config.models import LIMITS
from deployable.campaign.text.words import words_of
from fpm.reading.quantities import Quantity

_BEYOND = 1e-3  # by how much farther from the nominal values than the border a run is made


@dataclass(frozen=True)
class Asked:
    """One limit: of which requirement, and of which quantity, by its number."""

    requirement: str
    quantity: int
    kind: str
    level: float


def limits_of(requirements: Mapping[str, Mapping], quantities: list[str]) -> list[Asked]:
    """All limits that requirements set, in their order."""
    return [
        Asked(name, quantities.index(quantity), kind, float(kept[kind]))
        for name, limits in requirements.items()
        for quantity, kept in limits.items()
        for kind in LIMITS
        if kind in kept
    ]


@dataclass(frozen=True)
class Judged:
    """Limits (`intervals.scalars.Limit`) as asked for, the slack (l, R) of each in all runs, the
    worst (slack, place) of each over the box by surrogate, and (share, index, place) of the largest
    box that keeps all of them."""

    asked: Sequence[Asked]
    limits: list[Any]
    slack: np.ndarray
    worst: list[tuple[float, np.ndarray]]
    largest: tuple[float, int | None, np.ndarray | None]
    fails: np.ndarray | None

    @property
    def places(self) -> list[np.ndarray]:
        """Unit points (k) that decide."""
        return [at for _, at in self.worst] + ([] if self.fails is None else [self.fails])


def judged(
    bench: Bench,
    surrogates: Sequence[Any],
    asked: Sequence[Asked],
    beyond: np.ndarray | None = None,
) -> Judged:
    """What the surrogates of all quantities and the runs tell of the limits that are asked; beyond:
    errors (2, q) of the runs themselves, where they are known: of the quantities, and of where they
    happen."""
    from deployable.intervals.scalars import Limit, largest_share, share_reaching

    beyond = np.zeros((2, len(surrogates))) if beyond is None else beyond
    limits = [
        Limit(surrogates[one.quantity], one.kind, one.level, *map(float, beyond[:, one.quantity]))
        for one in asked
    ]
    upper = bench.experiment.box.free.astype(float)
    worst = [limit.worst(-upper, upper) for limit in limits]
    largest = largest_share(limits, bench.nominal)
    slack = np.array([
        limit.slack_of(bench.numbers[:, one.quantity])
        for one, limit in zip(asked, limits, strict=True)
    ])  # fmt: skip
    broken = np.flatnonzero(slack.min(axis=0) < 0)
    reached = share_reaching(bench.nominal, bench.unit[broken])
    fails = None
    if len(broken) and reached.min() < largest[0]:  # a run fails where the surrogates do not
        run = broken[reached.argmin()]
        fails = bench.unit[run]
        largest = float(reached.min()), int(slack[:, run].argmin()), fails
    elif largest[2] is not None:
        # A little beyond the border, so that the run there fails and does not only touch it.
        outward = np.clip((1 + _BEYOND) * (largest[2] - bench.nominal), -2, 2)
        fails = np.clip(bench.nominal + outward, -upper, upper)
    return Judged(asked, limits, slack, worst, largest, fails)


def is_sure(bench: Bench, found: Judged, i: int) -> bool:
    """Whether limit `i`, which no run breaks, is kept everywhere by more than the errors; and
    whether the number is there, or not, by more than that of a margin that tells so. Without one
    runs in which something happens prove nothing of others."""
    from deployable.intervals.scalars import fit_scalar

    limit, q = found.limits[i], found.asked[i].quantity
    if not bench.experiment.box.free.any():
        return True
    if limit.kind != "happens" and not found.worst[i][0] >= limit.error:
        return False
    one = bench.experiment.numbers[q]
    while isinstance(one.at, Quantity):
        one = one.at
    if one.decider is None and one.kind != "event":
        return True
    margins = bench.margins[:, q]
    if not np.isfinite(margins).all():
        return False
    by_how_much = fit_scalar(bench.unit, margins)
    ends, error = by_how_much.range(), by_how_much.error + limit.border
    absent = limit.kind == "happens" and not limit.level
    return bool(-ends.high > error if absent else ends.low > error)


def told(bench: Bench, asked: Asked) -> dict:
    """A limit as plain data."""
    quantity = bench.experiment.numbers[asked.quantity]
    level = bool(asked.level) if asked.kind == "happens" else asked.level
    named = {"quantity": quantity.name, "units": quantity.unit, **words_of(quantity)}
    return {**named, "kind": asked.kind, "level": level}
