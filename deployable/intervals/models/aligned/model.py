"""Polynomials in the time between impacts: where these are hard and their times spread."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...designs import Design, SplitDesign, multi_indices
from ...errors import IntervalError, check_choice
from ...estimates import ErrorEstimate
from ...points import match_points, other_runs
from ...ranges import Range, union
from ...samples import Samples
from ..model import Model
from .composed import EventModel, fit_event_model
from .elements import Element, cut_share, split_elements
from .enclosure import event_enclosure
from .estimate import aligned_error
from .impacts import GAP, add_anchors, anchor_delays, find_impacts
from .search import event_range


@dataclass(frozen=True)
class _Fitted:
    """An element with its composed models (n), its `tested` runs, and the ends of their pieces."""

    element: Element
    models: list[EventModel]
    tested: np.ndarray
    tables: dict[int, np.ndarray]


class AlignedModel(Model):
    """Event-aligned polynomials, by element of the box.

    The samples have the events of the runs besides: ``event_time`` (run, event) in s, NaN where a
    run has fewer, ``event_contact`` and ``event_closing``. `gap` is the time in s without contact
    after which a closing counts as a new impact (2 % of the duration by default). `alignment` is
    "stretch" (each piece is stretched as a whole) or "shift" (a piece follows its first impact at
    the same pace in every run, and only its last fifth is stretched to meet the next one, see
    `impacts.add_anchors`); `max_impacts` leaves the later impacts unaligned.

    It pays where impacts are hard, that is short against the spread of their times over the box;
    where contact is soft or a vibration is out of step with the next impact, it can be worse than
    the plain polynomial: compare the two error estimates.

    The bounds are attained by the composed model, they are not an enclosure of it. With `enclose`,
    ``lower`` and ``upper`` are guaranteed not to be left by it, and the attained ones are in
    ``inner_lower`` and ``inner_upper`` (see `event_enclosure`, for cost and gap
    docs/intervals.md). Where the number of impacts differs between runs that no split separates,
    the bounds also contain the runs themselves, and ``unresolved`` (time) tells the share of the
    box that this concerns.

    The error adds two parts: the error of held-out runs and of the coefficients in each run's own
    stretched time, and the change of the bounds within the error of the impact times.
    """

    def __init__(
        self,
        samples: Samples,
        design: Design | SplitDesign,
        *,
        gap: float | None = None,
        alignment: str = "stretch",
        max_impacts: int | None = None,
        enclose: bool = False,
    ) -> None:
        if not isinstance(design, Design) or not len(design.multi_indices):
            told = "a design with an order, of the whole box"
            raise IntervalError("design", getattr(design, "method", None), told)
        check_choice("alignment", alignment, ("stretch", "shift"))
        self.kind = f"{'enclosed' if enclose else 'attained'} range of the event-aligned surrogate"
        self.samples, self.design, self.enclose = samples, design, enclose
        self.impacts = [times[:max_impacts] for times in _impacts(samples, gap)]
        self.nodes = match_points(design.points, samples.unit)
        self.tested = other_runs(samples.unit, design.points)
        own = [self.impacts[n] for n in self.nodes]
        free = np.ptp(design.points, axis=0) > 0
        elements = split_elements(design.points, own, free)
        self.fitted = [self._fit(element, alignment) for element in elements]
        self.unresolved = np.zeros(len(samples.time))
        for element in elements:
            self.unresolved += element.volume * (samples.time >= element.unresolved_from)
        self.attributes = {
            "design_runs": design.runs,
            "impacts": [len(times) for times in own],
            "elements": len(elements),
            "unresolved_share_at_end": float(self.unresolved[-1]),
            "cut_share": cut_share(elements, design.points),
        }

    def range(self) -> Range:
        return union(self._ranges)

    def error(self, found: Range, window: float | None) -> ErrorEstimate:
        rows = []
        for fitted, own in zip(self.fitted, self._ranges, strict=True):
            for i, model in enumerate(fitted.models):
                bounds = own.inner_lower[i], own.inner_upper[i]
                values = self.samples.values[fitted.tested, i]
                unit = self.samples.unit[fitted.tested]
                tables = [fitted.tables.get(run) for run in fitted.tested]
                time = self.samples.time
                rows.append(aligned_error(model, time, unit, values, tables, bounds, window))
        parts = np.array([(row.total, row.held_out, row.decay) for row in rows])
        parts = parts.reshape(len(self.fitted), -1, *parts.shape[1:])
        return ErrorEstimate(*np.moveaxis(parts.max(axis=0), 1, 0))

    def variables(self) -> dict:
        text = "share of the box with an unresolved number of impacts"
        return {"unresolved": ("time", self.unresolved, {"long_name": text, "units": "1"})}

    def _fit(self, element: Element, alignment: str) -> _Fitted:
        """The models of an element, each piece of the time from one impact to the next."""
        time, unit = self.samples.time, self.samples.unit
        count, table, delays = element.impacts.shape[1], element.impacts, None
        if alignment == "shift":
            delays = anchor_delays(table, time[0], time[-1])
            table = add_anchors(table, time[0], delays)
        tested = self.tested[element.contains(unit[self.tested])]
        tables = {}
        for run in tested:
            if len(self.impacts[run]) >= count:
                own = self.impacts[run][None, :count]
                tables[run] = (own if delays is None else add_anchors(own, time[0], delays))[0]
        values = self.samples.values[self.nodes[element.runs]]
        models = [
            _fit_element(self.design, element, table, time, values[:, i])
            for i in range(values.shape[1])
        ]
        return _Fitted(element, models, tested, tables)

    @cached_property
    def _ranges(self) -> list[Range]:
        """The range (n, T) on each element."""
        ranges = []
        for fitted in self.fitted:
            rows = [self._range(fitted.element, model, i) for i, model in enumerate(fitted.models)]
            ranges.append(Range(*(np.array(parts) for parts in zip(*rows, strict=True))))
        return ranges

    def _range(self, element: Element, model: EventModel, i: int) -> tuple[np.ndarray, ...]:
        """The range (T) of one response on one element, as the fields of a `Range`."""
        time = self.samples.time
        low, high, at_low, at_high = event_range(model, time)
        outer = event_enclosure(model, time, low, high) if self.enclose else (low, high)
        late = time >= element.unresolved_from
        if late.any():
            runs = self.nodes[element.runs]
            values, unit = self.samples.values[runs, i], self.samples.unit[runs]
            low, at_low = _with_runs(-1, low, at_low, late, values, unit)
            high, at_high = _with_runs(1, high, at_high, late, values, unit)
        lower, upper = np.minimum(outer[0], low), np.maximum(outer[1], high)
        return lower, upper, low, high, at_low, at_high


def _impacts(samples: Samples, gap: float | None) -> list[np.ndarray]:
    """The impact times of each run."""
    source = samples.source
    if "event_time" not in source:
        raise IntervalError("samples", list(source.data_vars), "a dataset with event_time")
    start, end = samples.time[0], samples.time[-1]
    events = [
        source[name].values if name in source else None
        for name in ("event_time", "event_contact", "event_closing")
    ]
    return find_impacts(*events, gap=GAP * (end - start) if gap is None else float(gap), end=end)


def _fit_element(design: Design, element: Element, table, time, values) -> EventModel:
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


def _with_runs(sign, bound, argument, late, values, unit):
    """Let the bounds contain the element's own runs at the unresolved instants."""
    values = sign * values
    at = values.argmax(axis=0)
    best = values[at, np.arange(len(bound))]
    wins = late & (best > sign * bound)
    argument = np.where(wins[:, None], unit[at], argument)
    return np.where(wins, sign * best, bound), argument
