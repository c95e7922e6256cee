"""Event-aligned surrogate: each smooth piece between impacts in its own stretched time.

At a fixed instant a response with impacts jumps, as a function of the parameters, where an impact
time tau_j(p) crosses that instant; polynomials in p converge slowly there. The impact times
themselves, and each piece as a function of s = (t - tau_j) / (tau_(j+1) - tau_j), are smooth in p
and are fitted instead. The composed model is evaluated at (p, t) piece by piece.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...chebyshev import product_basis
from ...errors import IntervalError
from ...surrogate import Surrogate, fit_points

_CHUNK = 1 << 22


@dataclass(frozen=True)
class EventModel:
    """Composed model of one response on one element of the unit box.

    Attributes
    ----------
    lower, upper
        (k): the element, within [-1, 1]^k.
    start, end
        First and last instant in s.
    impacts
        Surrogate of the impact times, coefficients (M, J).
    pieces
        J + 1 cubic splines over s in [0, 1] of the coefficients (M).
    """

    lower: np.ndarray
    upper: np.ndarray
    start: float
    end: float
    impacts: Surrogate
    pieces: list

    def local(self, unit: np.ndarray) -> np.ndarray:
        """Coordinates (..., k) in the element, [-1, 1], of unit coordinates (..., k)."""
        width = np.where(self.upper > self.lower, self.upper - self.lower, 1.0)
        return np.where(self.upper > self.lower, (2 * unit - self.lower - self.upper) / width, 0.0)

    def edges(self, unit: np.ndarray) -> np.ndarray:
        """Ends of the pieces (P, J + 2) in s at unit coordinates (P, k), in ascending order."""
        times = self.impacts.evaluate(self.local(unit))
        times = np.maximum.accumulate(np.clip(times, self.start, self.end), axis=1)
        ends = np.ones((len(unit), 1))
        return np.concatenate([self.start * ends, times, self.end * ends], axis=1)

    def evaluate(self, unit: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Response (P, T) at unit coordinates (P, k) and instants (T)."""
        unit, time = np.atleast_2d(unit), np.asarray(time, dtype=float)
        out = np.empty((len(unit), len(time)))
        longest = max(piece.c.shape[1] for piece in self.pieces)
        step = max(_CHUNK // (4 * max(longest, len(time))), 1)
        for first in range(0, len(unit), step):
            part = unit[first : first + step]
            basis = product_basis(self.local(part), self.impacts.multi_indices)
            edges = self.edges(part)
            piece = (time >= edges[:, 1:-1, None]).sum(axis=1)  # (p, T)
            block = np.empty((len(part), len(time)))
            for j, spline in enumerate(self.pieces):
                row, column = np.nonzero(piece == j)
                if len(row):
                    s = _stretch(time[column], edges[row, j], edges[row, j + 1])
                    block[row, column] = _spline_values(spline, basis, s, row)
            out[first : first + step] = block
        return out

    def piece_of(self, unit: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Number (P) of the piece that holds instant time (P) at unit (P, k)."""
        return (time[:, None] >= self.edges(unit)[:, 1:-1]).sum(axis=1)

    def evaluate_pairs(
        self,
        unit: np.ndarray,
        time: np.ndarray,
        piece: np.ndarray | None = None,
        edges: np.ndarray | None = None,
    ) -> np.ndarray:
        """Response (P) at the pairs unit (P, k), time (P).

        `piece` (P) forces a piece, which gives one-sided values at an impact; `edges` (P, J + 2)
        replaces the model's impact times, which compares a run in its own stretched time.
        """
        edges = self.edges(unit) if edges is None else edges
        if piece is None:
            piece = (time[:, None] >= edges[:, 1:-1]).sum(axis=1)
        basis = product_basis(self.local(unit), self.impacts.multi_indices)
        out = np.empty(len(unit))
        for j, spline in enumerate(self.pieces):
            at = np.flatnonzero(piece == j)
            if len(at):
                s = _stretch(time[at], edges[at, j], edges[at, j + 1])
                out[at] = (spline(s) * basis[at]).sum(axis=1)
        return out


def fit_event_model(
    points: np.ndarray,
    multi_indices: np.ndarray,
    time: np.ndarray,
    values: np.ndarray,
    impacts: np.ndarray,
    lower: np.ndarray | None = None,
    upper: np.ndarray | None = None,
) -> EventModel:
    """Fit the composed model.

    Parameters
    ----------
    points, multi_indices
        Unit coordinates (N, k) of the runs and basis (M, k), M <= N.
    time, values
        Instants (T) in s and responses (N, T).
    impacts
        (N, J): the impact times of each run, the same number in every run.
    lower, upper
        (k): the element of the unit box; the whole box by default.
    """
    from scipy.interpolate import CubicSpline

    points = np.asarray(points, dtype=float)
    time, impacts = np.asarray(time, dtype=float), np.asarray(impacts, dtype=float)
    k = points.shape[1]
    lower = -np.ones(k) if lower is None else np.asarray(lower, dtype=float)
    upper = np.ones(k) if upper is None else np.asarray(upper, dtype=float)
    empty = EventModel(lower, upper, float(time[0]), float(time[-1]), None, [])
    local = empty.local(points)
    times = fit_points(local, multi_indices, impacts)
    ends = np.ones((len(points), 1))
    edges = np.concatenate([time[0] * ends, impacts, time[-1] * ends], axis=1)
    pieces = []
    for j in range(impacts.shape[1] + 1):
        inside = (time >= edges[:, j, None]) & (time <= edges[:, j + 1, None])
        count = max(int(inside.sum(axis=1).max()), 4)
        s = np.linspace(0.0, 1.0, count)
        rows = [
            _resample(time[inside[n]], values[n, inside[n]], edges[n, j], edges[n, j + 1], s)
            for n in range(len(points))
        ]
        pieces.append(CubicSpline(s, fit_points(local, multi_indices, rows).coefficients.T))
    return EventModel(lower, upper, float(time[0]), float(time[-1]), times, pieces)


def _resample(time, values, start, end, s) -> np.ndarray:
    """Values at start + s (end - start) from the instants of one piece, one-sided at its ends."""
    from scipy.interpolate import make_interp_spline

    if not len(time):
        raise IntervalError(
            "impacts", (float(start), float(end)), "pieces that hold an instant; widen the gap"
        )
    degree = min(3, len(time) - 1)
    spline = make_interp_spline(time, values, k=degree)
    return spline(start + s * (end - start), extrapolate=True)


def _stretch(time, start, end):
    length = end - start
    return np.clip((time - start) / np.where(length > 0, length, 1.0), 0.0, 1.0)


def _spline_values(spline, basis, s, row):
    """Values at s (P) of the splines sum_m basis[row, m] spline_m, with few operations.

    The basis is contracted with the spline's coefficients first: a run costs one small product
    for each knot, not one for each instant and coefficient.
    """
    cubic = spline.c @ basis.T  # (4, S - 1, p)
    count = cubic.shape[1]
    cell = np.minimum((s * count).astype(int), count - 1)
    offset = s - spline.x[cell]
    value = cubic[0, cell, row]
    for power in range(1, 4):
        value = value * offset + cubic[power, cell, row]
    return value
