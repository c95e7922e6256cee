"""Bounds from event-aligned surrogates: from a samples dataset to a bounds dataset."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from . import errors, multi_indices
from .datasets import Bounds, bounds_to_dataset, match_points, other_runs, read_samples
from .designs import Design
from .elements import Element, cut_share, split_elements
from .event_bounds import event_range
from .event_enclosure import event_enclosure
from .event_model import EventModel, fit_event_model
from .exceptions import IntervalError, check_choice
from .impacts import GAP, add_anchors, anchor_delays, find_impacts
from .surrogate import Surrogate

if TYPE_CHECKING:
    import xarray as xr


def event_bounds_dataset(
    samples: xr.Dataset,
    design: Design,
    responses: Sequence[str] | None = None,
    *,
    gap: float | None = None,
    alignment: str = "stretch",
    max_impacts: int | None = None,
    window: float | None = None,
    enclose: bool = False,
) -> xr.Dataset:
    """Bounds of the responses from event-aligned surrogates.

    Like `bounds.bounds_dataset`, with the events of the runs besides: ``event_time`` (run, event)
    in s, NaN where a run has fewer, ``event_contact`` and ``event_closing``. `gap` is the time in s
    without contact after which a closing counts as a new impact (2 % of the duration by default).
    `alignment` is "stretch" (each piece is stretched as a whole) or "shift" (a piece follows its
    first impact at the same pace in every run, and only its last fifth is stretched to meet the
    next one, see `impacts.add_anchors`); `max_impacts` leaves the later impacts unaligned.

    It pays where impacts are hard, that is short against the spread of their times over the box;
    where contact is soft or a vibration is out of step with the next impact, it can be worse than
    the plain surrogate: compare the two error estimates.

    The bounds are attained by the composed model, they are not an enclosure of it. With `enclose`,
    ``lower`` and ``upper`` are guaranteed not to be left by it, and the attained ones are in
    ``inner_lower`` and ``inner_upper`` (see `event_enclosure`, for cost and gap
    docs/intervals.md). Where the number of impacts differs between runs that no split separates,
    the bounds also contain the runs themselves, and ``unresolved`` (time) tells the share of the
    box that this concerns.

    The error adds two parts: the error of held-out runs and of the coefficients in each run's own
    stretched time, and the change of the bounds within the error of the impact times.
    """
    if not isinstance(design, Design) or not len(design.multi_indices):
        raise IntervalError("design", design.method, "a design with an order, of the whole box")
    data = read_samples(samples, responses)
    if "event_time" not in samples:
        raise IntervalError("samples", list(samples.data_vars), "a dataset with event_time")
    gap = GAP * (data.time[-1] - data.time[0]) if gap is None else float(gap)
    contact, closing = (
        samples[name].values if name in samples else None
        for name in ("event_contact", "event_closing")
    )
    check_choice("alignment", alignment, ("stretch", "shift"))
    impacts = find_impacts(
        samples["event_time"].values, contact, closing, gap=gap, end=data.time[-1]
    )
    impacts = [x[:max_impacts] for x in impacts]
    nodes = match_points(design.points, data.unit)
    tested = other_runs(data.unit, design.points)
    free = np.ptp(design.points, axis=0) > 0
    own = [impacts[n] for n in nodes]
    elements = split_elements(design.points, own, free)
    unresolved = np.zeros(len(data.time))
    for element in elements:
        unresolved += element.volume * (data.time >= element.unresolved_from)

    names, instants = len(data.names), len(data.time)
    shape = (names, instants)
    lower, upper = np.full(shape, np.inf), np.full(shape, -np.inf)
    outer_lower, outer_upper = lower.copy(), upper.copy()
    argmin, argmax = np.zeros((*shape, design.dimension)), np.zeros((*shape, design.dimension))
    parts = {"held_out": np.zeros(shape), "decay": np.zeros(shape), "total": np.zeros(shape)}
    for element in elements:
        inside = tested[_inside(element, data.unit[tested])]
        runs = nodes[element.runs]
        count = element.impacts.shape[1]
        table, delays = element.impacts, None
        if alignment == "shift":
            delays = anchor_delays(table, data.time[0], data.time[-1])
            table = add_anchors(table, data.time[0], delays)
        own_tables = {
            run: _own_table(impacts[run], count, data.time[0], delays)
            for run in inside
            if len(impacts[run]) >= count
        }
        for i in range(names):
            model = _fit(design, element, table, data.time, data.values[runs, i])
            low, high, at_low, at_high = event_range(model, data.time)
            outer = event_enclosure(model, data.time, low, high) if enclose else (low, high)
            late = data.time >= element.unresolved_from
            if late.any():
                low, at_low = _with_runs(-1, low, at_low, late, data, runs, i)
                high, at_high = _with_runs(1, high, at_high, late, data, runs, i)
            outer_lower[i] = np.minimum(outer_lower[i], np.minimum(outer[0], low))
            outer_upper[i] = np.maximum(outer_upper[i], np.maximum(outer[1], high))
            found = _error(model, data, inside, i, own_tables, low, high, window)
            for name, value in found.items():
                parts[name][i] = np.maximum(parts[name][i], value)
            less, more = low < lower[i], high > upper[i]
            lower[i], upper[i] = np.where(less, low, lower[i]), np.where(more, high, upper[i])
            argmin[i] = np.where(less[:, None], at_low, argmin[i])
            argmax[i] = np.where(more[:, None], at_high, argmax[i])

    bounds = Bounds(outer_lower, outer_upper, lower, upper, argmin, argmax)
    centre = data.values[data.nominal] if data.nominal is not None else None
    attrs = {
        "design_method": design.method,
        "design_order": list(design.order),
        "design_runs": design.runs,
        "bounds_kind": ("enclosed" if enclose else "attained")
        + " range of the event-aligned surrogate",
        "impacts": [len(x) for x in own],
        "elements": len(elements),
        "unresolved_share_at_end": float(unresolved[-1]),
        "cut_share": cut_share(elements, design.points),
    }
    result = bounds_to_dataset(data, bounds, centre, errors.ErrorEstimate(**parts), tested, attrs)
    text = {
        "long_name": "share of the box with an unresolved number of impacts",
        "units": "1",
    }
    return result.assign(unresolved=("time", unresolved, text))


def _fit(design: Design, element: Element, table, time, values) -> EventModel:
    """Fit the element with the design's basis, or with the largest that its runs determine."""
    bases = []
    if len(element.runs) == design.runs:
        bases.append(design.multi_indices)
    order = np.array(design.order)
    for highest in range(int(order.max()), -1, -1):
        indices = multi_indices.total_degree(np.minimum(order, highest))
        if len(indices) <= len(element.runs):
            bases.append(indices)
    for indices in bases:
        try:
            return fit_event_model(
                design.points[element.runs],
                indices,
                time,
                values,
                table,
                element.lower,
                element.upper,
            )
        except IntervalError as error:
            if error.key != "points":  # only a basis that the runs do not determine is replaced
                raise
    raise IntervalError("points", len(element.runs), "runs that determine at least a constant")


def _own_table(times, count, start, delays) -> np.ndarray:
    """A run's own ends of the model's pieces, (J) or (2 J + 1) with anchors."""
    table = np.asarray(times)[None, :count]
    return (table if delays is None else add_anchors(table, start, delays))[0]


def _inside(element: Element, unit: np.ndarray) -> np.ndarray:
    return ((unit >= element.lower - 1e-12) & (unit <= element.upper + 1e-12)).all(axis=1)


def _with_runs(sign, bound, argument, late, data, runs, i):
    """Let the bounds contain the element's own runs at the unresolved instants."""
    values = sign * data.values[runs, i]
    at = values.argmax(axis=0)
    best = values[at, np.arange(len(bound))]
    wins = late & (best > sign * bound)
    argument = np.where(wins[:, None], data.unit[runs[at]], argument)
    return np.where(wins, sign * best, bound), argument


def _error(model, data, inside, i, own_tables, low, high, window) -> dict[str, np.ndarray]:
    """Error estimate (T) of one response on one element, in its parts."""
    time, count = data.time, model.impacts.coefficients.shape[1]
    held_out = np.zeros(len(time))
    timing = errors.decay_estimate(model.impacts) if count else np.zeros(0)
    for run in inside:
        unit = np.repeat(data.unit[run][None], len(time), axis=0)
        edges = None
        if run in own_tables:
            ends = np.concatenate([[time[0]], own_tables[run], [time[-1]]])
            told = model.edges(unit[:1])[0, 1:-1]
            timing = np.maximum(timing, np.abs(ends[1:-1] - told))
            edges = np.repeat(ends[None], len(time), axis=0)
        model_values = model.evaluate_pairs(unit, time, edges=edges)
        held_out = np.maximum(held_out, np.abs(model_values - data.values[run, i]))
    decay, shift = _decay_in_time(model, time, timing)
    aligned = errors.widen(time, np.maximum(held_out, decay), window)
    change = np.zeros(len(time))
    for bound in (low, high):
        for side in (-1, 1):
            change = np.maximum(change, np.abs(np.interp(time + side * shift, time, bound) - bound))
    return {"held_out": held_out, "decay": decay, "total": aligned + change}


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
            decay[at] = errors.decay_estimate(Surrogate(spline(s).T, indices))
        # the whole range of the impact's time is touched, also before it comes at the centre
        shift[at] = max(around[j], around[j + 1])
    return decay, errors.widen(time, shift, _spread(model, edges))


def _spread(model, edges) -> float:
    """How far an impact's time may lie from that at the centre, in s."""
    c = np.abs(model.impacts.coefficients)
    constant = ~model.impacts.multi_indices.any(axis=1)
    return float(c[~constant].sum(axis=0).max(initial=0.0))
