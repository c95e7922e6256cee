"""Error estimate of a composed model: in each run's own stretched time, and of that time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...estimates import ErrorEstimate, decay_estimate, widen
from ...surrogate import Surrogate
from .composed import EventModel


def aligned_error(
    model: EventModel,
    time: np.ndarray,
    unit: np.ndarray,
    values: np.ndarray,
    tables: Sequence[np.ndarray | None],
    bounds: tuple[np.ndarray, np.ndarray],
    window: float | None,
) -> ErrorEstimate:
    """Error estimate (T) of one response on one element.

    `unit` (H, k), `values` (H, T) and `tables` are the runs that test it; a table has a run's own
    ends of the model's pieces, and is None where it has too few impacts. `bounds` (T) each.
    """
    count = model.impacts.coefficients.shape[1]
    held_out = np.zeros(len(time))
    timing = decay_estimate(model.impacts) if count else np.zeros(0)
    for point, own, table in zip(unit, values, tables, strict=True):
        repeated = np.repeat(point[None], len(time), axis=0)
        edges = None
        if table is not None:
            ends = np.concatenate([[time[0]], table, [time[-1]]])
            told = model.edges(point[None])[0, 1:-1]
            timing = np.maximum(timing, np.abs(ends[1:-1] - told))
            edges = np.repeat(ends[None], len(time), axis=0)
        found = model.evaluate_pairs(repeated, time, edges=edges)
        held_out = np.maximum(held_out, np.abs(found - own))
    decay, shift = _decay_in_time(model, time, timing)
    aligned = widen(time, np.maximum(held_out, decay), window)
    change = np.zeros(len(time))
    for bound in bounds:
        for side in (-1, 1):
            change = np.maximum(change, np.abs(np.interp(time + side * shift, time, bound) - bound))
    return ErrorEstimate(aligned + change, held_out, decay)


def _decay_in_time(model, time, timing) -> tuple[np.ndarray, np.ndarray]:
    """Tail of the coefficients and error of the impact times (T), along the element's centre."""
    centre = ((model.lower + model.upper) / 2)[None]
    edges = model.edges(centre)[0]
    piece = (time[:, None] >= edges[1:-1]).sum(axis=1)
    around = np.concatenate([[0.0], timing, [0.0]])
    decay, shift = np.zeros(len(time)), np.zeros(len(time))
    indices = model.impacts.multi_indices
    for j, spline in enumerate(model.pieces):
        at = np.flatnonzero(piece == j)
        if len(at):
            length = max(edges[j + 1] - edges[j], np.finfo(float).tiny)
            s = np.clip((time[at] - edges[j]) / length, 0.0, 1.0)
            decay[at] = decay_estimate(Surrogate(spline(s).T, indices))
        # the whole range of the impact's time is touched, also before it comes at the centre
        shift[at] = max(around[j], around[j + 1])
    return decay, widen(time, shift, _spread(model, edges))


def _spread(model, edges) -> float:
    """How far an impact's time may lie from that at the centre, in s."""
    c = np.abs(model.impacts.coefficients)
    constant = ~model.impacts.multi_indices.any(axis=1)
    return float(c[~constant].sum(axis=0).max(initial=0.0))
