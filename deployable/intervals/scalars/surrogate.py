"""The surrogate of a number over the box: a fit, and where there is such a number at all."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .extremes import Extremes, extreme, extremes
from .fits import Fit, best_fit
from .occurrence import Foretold, Occurrence


@dataclass(frozen=True)
class ScalarSurrogate:
    """A number of runs as a function of the box; `fit` is None where no run has the number.

    least: what it can not be below; latest: of a time, when runs end, later than which none is.
    """

    fit: Fit | None
    occurrence: Occurrence
    least: float = -np.inf
    latest: float = np.inf

    @property
    def error(self) -> float:
        """Estimated error where there is a number; NaN where there is none."""
        return np.nan if self.fit is None else self.fit.error

    @property
    def usual_error(self) -> float:
        """The same of runs that were sought; see `Fit.usual_error`."""
        return np.nan if self.fit is None else self.fit.usual_error

    @property
    def trend(self) -> ScalarSurrogate:
        """The same without what the fit leaves of single runs, for what compares parts of the box
        with each other."""
        return self if self.fit is None else replace(self, fit=self.fit.trend)

    def foretold(self, unit: np.ndarray) -> np.ndarray:
        """What the fit tells (P) at unit coordinates (P, k), within what is possible, be there a
        number or not."""
        return np.clip(self.fit.evaluate(np.asarray(unit, dtype=float)), self.least, self.latest)

    def evaluate(self, unit: np.ndarray) -> np.ndarray:
        """Values (P) at unit coordinates (P, k), NaN where there is none."""
        if self.fit is None:
            return np.full(len(unit), np.nan)
        return np.where(self.occurrence.evaluate(unit), self.foretold(unit), np.nan)

    def range(
        self, lower: np.ndarray | None = None, upper: np.ndarray | None = None, **options: int
    ) -> Extremes:
        """The range attained over the part [lower, upper] (k each) of the unit box, by default the
        whole; NaN where there is no number anywhere. `options` are those of `extremes`."""
        lower, upper = self._part(lower, upper)
        also = None if self.fit is None else self.fit.points
        return extremes(self.evaluate, lower, upper, also, **options)

    def end(
        self, sign: float, lower: np.ndarray, upper: np.ndarray, climbs: int = 1
    ) -> tuple[float, np.ndarray]:
        """The upper (sign 1) or lower (sign -1) end of that range, and where it is (k)."""
        also = None if self.fit is None else self.fit.points
        return extreme(self.evaluate, sign, *self._part(lower, upper), also, climbs)

    def _part(
        self, lower: np.ndarray | None = None, upper: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """The part of the box, without extent along parameters that do not vary."""
        ones = np.ones(self.occurrence.points.shape[1])
        free = np.ptp(self.occurrence.points, axis=0) > 0
        lower = np.where(free, -ones if lower is None else lower, 0.0)
        return lower, np.where(free, ones if upper is None else upper, 0.0)

    def nowhere(self, lower: np.ndarray, upper: np.ndarray) -> np.ndarray | None:
        """The place (k) in the part [lower, upper] of the unit box where there is most certainly no
        number; None if there is one all over it."""
        return self._where(lower, upper, False)

    def somewhere(self, lower: np.ndarray, upper: np.ndarray) -> np.ndarray | None:
        """The place (k) in the part [lower, upper] where there most certainly is a number; None if
        there is none in it."""
        return self._where(lower, upper, True)

    def _where(self, lower: np.ndarray, upper: np.ndarray, wanted: bool) -> np.ndarray | None:
        lower, upper = self._part(lower, upper)
        if not self.occurrence.mixed:
            return (lower + upper) / 2 if self.occurrence.happens.all() == wanted else None
        certainty, points = self.occurrence.certainty, self.occurrence.points
        value, at = extreme(certainty, 1.0 if wanted else -1.0, lower, upper, points, climbs=1)
        return at if (value >= 0) == wanted else None


def fit_scalar(
    points: np.ndarray,
    values: np.ndarray,
    latest: float | None = None,
    least: float | None = None,
    margin: np.ndarray | None = None,
) -> ScalarSurrogate:
    """The surrogate of values (N) of runs at unit points (N, k), NaN where a run has none.

    latest: of a time, when runs end. Where that alone tells the runs without one from the others,
    what is fitted to those tells the border between them. least: what no value can be below.
    margin: by how much there is a number, (N), not above 0 where there is none, NaN where that is
    not known; where it is known of all runs, what is fitted to it may tell the border. What leaves
    least open does.
    """
    points, values = np.asarray(points, dtype=float), np.asarray(values, dtype=float)
    there = np.isfinite(values)
    fit = best_fit(points[there], values[there]) if there.any() else None
    if there.sum() == 1 and np.ptp(points, axis=0).any():  # which no other run tests
        fit = replace(fit, left_out=np.full(1, np.inf))
    return ScalarSurrogate(
        fit,
        _occurrence(points, there, fit, latest, margin),
        -np.inf if least is None else least,
        np.inf if latest is None else latest,
    )


def _occurrence(
    points: np.ndarray,
    there: np.ndarray,
    fit: Fit | None,
    latest: float | None,
    margin: np.ndarray | None,
) -> Occurrence:
    found = Occurrence(points, there)
    if not found.mixed:
        return found
    told = [found]
    if margin is not None and np.isfinite(margin).all():
        by_how_much = best_fit(points, margin)
        one = Foretold(points, there, by_how_much.evaluate, by_how_much.error)
        told += [one] if np.isfinite(one.error) and one.agrees(one.error) else []
    if latest is not None and np.isfinite(fit.error):
        until = Foretold(points, there, lambda unit: latest - fit.evaluate(unit), fit.error, latest)
        told += [until] if until.agrees() else []
    return min(reversed(told), key=lambda one: one.open)
