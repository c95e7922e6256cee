"""Curves of runs aligned at their events, fitted over the box (docs/curves-through-events.md).

Source: Mai and Sudret, SIAM/ASA J. Uncertainty Quantification 5 (2017) 540 (arXiv 1609.09286), who
have to estimate the time scale; here the events are known."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy

from .designs import spread_points
from .errors import IntervalError
from .estimates import widen
from .spline_equations import distinct
from .splines import (
    CHUNK,
    SPACINGS,
    Spline,
    check_spline_runs,
    choose_scales,
    fit_spline,
    level_errors,
)

EVENT_NAMES = "event_time", "event_contact", "event_closing"
"""Variables (run, event) of a samples dataset: time (s), what, and which way, NaN for none."""

MAX_EVENTS = 8
"""Most events at which curves are aligned, the first ones."""

GAIN = 0.8
"""Root mean square left-out error of the parts over that of all runs, at which they are split."""

_GAP = 3  # instants that a stretch must have in a run
_NARROW = 0.05  # instants: events that follow each other sooner are one
_MOST = 0.7  # of the runs must have these
_SLACK = 1.0  # of the way from the border to the runs beyond it, where a border may be
_PAUSE = 0.02  # of the duration: what follows at once
_BLOCKS = 8  # of the last stretch, in which the same runs are known
_SMOOTH = 0.5  # of the spread: of times or margins of larger left-out error no function is smooth
_CANDIDATES = 1024  # points, beside the runs, among which extremes are sought
_RADII = 0.25 * 0.5 ** np.arange(14)  # of the search about the best of them


def name_events(events: np.ndarray) -> list[dict[tuple, float]]:
    """Return for each of R runs the times (s) of its events by what they are: (what, which way, the
    how many-th of these). events (R, e, 3): time, what, which way, of each, padded with NaN."""
    runs = []
    for table in events:
        counts: Counter = Counter()
        event_times: dict[tuple, float] = {}
        order = np.argsort(table[:, 0], kind="stable")
        for moment, source, direction in table[order[np.isfinite(table[order, 0])]]:
            event_times[source, direction, counts[source, direction]] = moment
            counts[source, direction] += 1
        runs.append(event_times)
    return runs


def shared_events(
    runs: list[dict[tuple, float]], time: np.ndarray, with_last: bool = True
) -> np.ndarray:
    """Times (R, E) of the events at which R runs can be aligned: those that all have, in one order,
    and that leave most of them three instants (`time`, s) before the end; of those within three
    instants the first and (`with_last`) last. runs: times of events by what they are
    (`name_events`)."""
    keys = [key for key in runs[0] if all(key in event_times for event_times in runs[1:])]
    columns = sorted(
        (np.array([event_times[key] for event_times in runs]) for key in keys), key=np.mean
    )
    step = (time[-1] - time[0]) / (len(time) - 1)
    groups = [(np.full(len(runs), time[0]),) * 2]  # first and last times of events that are close
    for column in columns:
        first, last = groups[-1]
        lead, is_early = column - last, time[-1] - column > _GAP * step
        if (lead < -_GAP * step).any() or np.mean(is_early) < _MOST:
            continue
        if (lead >= 0).all() and np.mean(lead > _GAP * step) >= _MOST:
            groups.append((column, column))
        elif len(groups) > 1:
            groups[-1] = np.minimum(first, column), np.maximum(last, column)
    selection = []
    for first, last in groups[1:]:
        selection.append(first)
        if with_last and np.mean(last - first) > _NARROW * step:
            selection.append(last)
    return np.array(selection[:MAX_EVENTS]).reshape(-1, len(runs)).T


def has_groups(runs: list[dict[tuple, float]], time: np.ndarray) -> bool:
    """Return whether first and last events of a group both count, as arguments of
    `shared_events`."""
    return shared_events(runs, time).shape != shared_events(runs, time, False).shape


def first_difference(runs: list[dict[tuple, float]]) -> float:
    """Return the earliest time (s) of an event that not all runs have, infinite if there is none.
    runs: times of each run's events by their names (`name_events`)."""
    common = set(runs[0]).intersection(*runs[1:])
    return min(
        (t for event_times in runs for key, t in event_times.items() if key not in common),
        default=np.inf,
    )


def unseen_difference(
    points: np.ndarray, margins: np.ndarray, time: np.ndarray, runs: list[dict[tuple, float]]
) -> float:
    """Earliest time (s) from which an event may be missed at places without a run, though all runs
    at points (R, k) in [-1, 1]^k have it; infinite if there is none. margins (R, c): by how much
    the first event of each kind occurs, NaN where not known; time (T): s; runs: times by event."""
    first = np.inf
    for source, column in enumerate(margins.T):
        if not (column > 0).all():
            continue
        with suppress(IntervalError):
            spline, values = _spread_spline(points, column)
            error = np.sqrt((spline.left_out**2).mean())
            is_near = values.min() < 0
            if error > _SMOOTH * column.std():  # a spline that predicts no run tells nothing
                is_near = column.min() < error
            if is_near:
                moments = [t for table in runs for key, t in table.items() if key[0] == source]
                first = min(first, min(moments, default=time[0]))
    return first


def earliest_time(points: np.ndarray, delays: np.ndarray) -> float:
    """Earliest time (s) over the box of an event with these delays (R), s, after the start, by a
    spline of their inverse squares, to which even forces are in proportion; 0 is never."""
    with suppress(IntervalError):
        values = _spread_spline(points, delays**-2)[1]
        return float(min(delays.min(), values.max() ** -0.5))
    return float(delays.min())


def _spread_spline(points: np.ndarray, values: np.ndarray) -> tuple[Spline, np.ndarray]:
    """Return the spline of values (R) of runs, and its own (P) at points spread over the box."""
    check_spline_runs(points)
    spline = fit_spline(points, values[:, None])
    free = spline.scales > 0
    trial = np.where(free, spread_points(free, _CANDIDATES), points[0])
    return spline, spline.evaluate(trial)


def difference_across(
    points: np.ndarray, values: np.ndarray, time: np.ndarray, runs: list[dict[tuple, float]]
) -> np.ndarray:
    """By how much values (R, n, T) of runs with and without an event differ at most (n, T), about
    the time of any event that not all runs have.

    Nearest pairs of runs with and without it count to the end, as does the run that has it last;
    else by how much the difference changes soon after. points (R, k) in [-1, 1]^k; time (T), s;
    runs: times by event, of which the first counts."""
    differences, pause = np.zeros(values.shape[1:]), _PAUSE * (time[-1] - time[0])
    gaps = scipy.spatial.distance.cdist(points, points)
    for key in {key for event_times in runs for key in event_times if key[-1] == 0}:
        moments = np.array([event_times.get(key, np.inf) for event_times in runs])
        rows, rivals = np.flatnonzero(np.isfinite(moments)), np.flatnonzero(moments == np.inf)
        if not len(rivals):
            continue
        delays = moments[rows] - time[0]
        earliest = time[0] + earliest_time(points[rows], delays)
        changes = np.zeros_like(differences)
        nearest = rows[gaps[np.ix_(rivals, rows)].argmin(axis=1)]
        for row in rows:
            moment, rival = moments[row], gaps[row, rivals].argmin()
            # Between runs, and between them and the box's end, the event may come so far off.
            neighbours = moments[rows[gaps[row, rows].argsort(kind="stable")[:3]]]
            lag = max(
                np.abs(neighbours - moment).max(), (moment - earliest) * (moment == moments.min())
            )
            if nearest[rival] == row or moment == moments[rows].max():
                change = np.abs(values[row] - values[rivals[rival]])
                change = np.maximum.accumulate(np.where(time >= moment, change, 0.0), axis=-1)
                changes = np.maximum(changes, widen(time, change, lag))
            later_rows = np.flatnonzero(moments > moment + pause)
            difference = values[row] - values[later_rows[gaps[row, later_rows].argmin()]]
            reference = difference[:, max(np.searchsorted(time, moment) - 1, 0), None]
            is_soon = (time >= moment) & (time <= moment + pause)
            change = np.where(is_soon, np.abs(difference - reference), 0.0)
            changes = np.maximum(changes, widen(time, change, lag))
        differences = np.maximum(differences, np.where(time >= earliest, changes, 0.0))
    return differences


class AlignedCurves:
    """Curves of R runs, aligned at E events, as functions of k parameters. points (R, k) in [-1,
    1]^k; values (R, n, T) at `time` (T, s); times (R, E), s. `spline`: of mapped curves (R, n, S);
    `times_spline`: of event times, or None; `end_time`: last time (s) that is known in all of the
    box."""

    def __init__(
        self, points: np.ndarray, values: np.ndarray, time: np.ndarray, times: np.ndarray,
        scales: np.ndarray | None = None, is_part: bool = False,
    ) -> None:  # fmt: skip
        self.points, self.values, self.time, self.is_part = points, values, time, is_part
        step = (time[-1] - time[0]) / (len(time) - 1)
        self.times_spline: Spline | None = None
        while times.shape[1]:  # those whose times are smooth functions
            self.times_spline = fit_spline(points, times, scales)
            error = np.sqrt((self.times_spline.left_out**2).mean(axis=0))
            smooth = error <= np.maximum(_SMOOTH * times.std(axis=0), step)
            if smooth.all():
                break
            times, self.times_spline = times[:, smooth], None
        self.times, self.end_time = times, time[-1]
        starts = np.concatenate([np.full((len(times), 1), time[0]), times], axis=1)
        self.reach = time[-1] - starts[:, -1].min()
        lengths = np.append(np.diff(starts, axis=1).mean(axis=0), self.reach)
        self.counts = np.maximum(2 * np.ceil(lengths / step).astype(int) + 1, 5)
        self.offsets = np.cumsum(self.counts) - self.counts
        pairs = list(zip(values, starts, strict=True))
        full = np.array([self._map(y, s, 0) for y, s in pairs])
        mapped_curves = np.array([self._map(y, s, 1) for y, s in pairs])
        passages = self._passages(full, mapped_curves)
        mapped_curves = np.where(np.isnan(mapped_curves), full, mapped_curves)
        for curves, (y, s), passage in zip(mapped_curves, pairs, passages, strict=True):
            self._bridge(curves, y, s, passage)
        self._fill(mapped_curves, scales)

    def _stretches(self, starts: np.ndarray) -> Iterator[tuple[slice, slice, np.ndarray]]:
        """Return for each stretch of a run the instants within it, its columns, and their times
        (s)."""
        ends = np.append(starts[1:], starts[-1] + self.reach)
        edge = 1e-6 * (self.time[1] - self.time[0])  # an instant at an event may be of either side
        first = np.searchsorted(self.time, starts + edge)
        stop = np.searchsorted(self.time, ends - edge)
        first[0], stop[-1] = 0, len(self.time)
        for i, count in enumerate(self.counts):
            columns = slice(self.offsets[i], self.offsets[i] + count)
            times = starts[i] + np.linspace(0.0, 1.0, count) * (ends[i] - starts[i])
            yield slice(first[i], stop[i]), columns, times

    def _map(self, values: np.ndarray, starts: np.ndarray, margin: int) -> np.ndarray:
        """Curves (n, T) of a run over mapped time (n, S), from one side at events; NaN where the
        run has ended, and in a stretch of less than three instants. margin: instants beside events
        that are left out, as rates there may be means of both sides."""
        mapped_curves = np.full((len(values), self.counts.sum()), np.nan)
        for span, columns, times in self._stretches(starts):
            low = span.start + margin * (columns.start > 0)
            span = slice(low, span.stop - margin * (columns.stop < self.counts.sum()))
            if span.stop - span.start >= _GAP:
                curve = scipy.interpolate.CubicSpline(self.time[span], values[:, span], axis=1)
                mapped_curves[:, columns] = np.where(self._is_known(times), curve(times), np.nan)
        return mapped_curves

    def _is_known(self, times: np.ndarray) -> np.ndarray:
        return times <= self.time[-1] + 1e-6 * (self.time[1] - self.time[0])

    def _passages(self, full: np.ndarray, inner: np.ndarray) -> np.ndarray:
        """Values (R, n, E) at events that responses pass without a jump, of the side that changes
        less; NaN at others, where both sides differ in most runs, or one has too few instants."""
        passages = np.full((*full.shape[:2], len(self.offsets) - 1), np.nan)
        changes = np.abs(inner[..., 2:] - inner[..., :-2])  # of an instant
        for i, c in enumerate(self.offsets[1:]):
            low, high = full[..., c - 1], full[..., c]
            near_changes = np.concatenate(
                [changes[..., c - 7 : c - 2], changes[..., c : c + 5]], -1
            )
            is_smooth = np.abs(high - low) <= np.nan_to_num(near_changes).max(axis=-1)
            is_short = np.isnan(inner[..., c] + inner[..., c - 1])
            passes = np.mean(is_smooth | is_short, axis=0) > 0.5
            low_change, high_change = np.nan_to_num(changes[..., [c - 3, c]], nan=np.inf).transpose(
                2, 0, 1
            )
            is_lower = np.isnan(high) | (low_change <= high_change)
            passages[:, passes, i] = np.where(is_lower, low, high)[:, passes]
        return passages

    def _bridge(
        self,
        mapped_curves: np.ndarray,
        values: np.ndarray,
        starts: np.ndarray,
        passages: np.ndarray,
    ) -> None:
        """Map the values (n, T) of a run again into mapped_curves (n, S), with the values
        `passages` (n, E) at events, because recorded instants say little about the ends of a
        stretch."""
        step = self.time[1] - self.time[0]
        ends = np.pad(passages, ((0, 0), (1, 1)), constant_values=np.nan)
        for i, (span, columns, times) in enumerate(self._stretches(starts)):
            pair = ends[:, i : i + 2]
            for flags in itertools.product((False, True), repeat=2):
                rows = (np.isfinite(pair) == flags).all(axis=1)
                if not rows.any() or not any(flags):
                    continue
                jumps = np.array([i > 0, i < len(self.counts) - 1]) & ~np.array(flags)
                inner = slice(span.start + jumps[0], span.stop - jumps[1])
                knots, y = self.time[inner], values[rows, inner]
                distances = np.abs(knots - times[[0, -1], None][list(flags)])
                is_distant = (distances > 0.25 * step).all(axis=0)
                knots = np.concatenate([knots[is_distant], times[[0, -1]][list(flags)]])
                y = np.concatenate([y[:, is_distant], pair[rows][:, flags]], axis=1)
                if len(knots) >= 2:
                    order = np.argsort(knots)
                    curve = scipy.interpolate.CubicSpline(knots[order], y[:, order], axis=1)
                    part = np.where(self._is_known(times), curve(times), np.nan)
                    mapped_curves[rows, columns] = part

    def _fill(self, mapped_curves: np.ndarray, scales: np.ndarray | None) -> None:
        """Fit curves (R, n, S), what is not known of a run (NaN) by the splines through others."""
        is_known = np.isfinite(mapped_curves).all(axis=1)
        self.fill_errors = np.zeros_like(mapped_curves)  # of what is not known
        sure = is_known.all(axis=0)
        if scales is None:
            flat = mapped_curves[:, :, sure].reshape(len(mapped_curves), -1)
            scales = choose_scales(self.points, flat)
        stretches = np.split(np.arange(is_known.shape[1]), self.offsets[1:])
        for block in (*stretches[:-1], *np.array_split(stretches[-1], _BLOCKS)):
            rows = is_known[:, block].all(axis=1)
            if rows.all() or not len(block):
                continue
            is_later = block[0] > self.offsets[-1]
            span = np.arange(block[0] - is_later, block[-1] + 1)
            part = mapped_curves[rows][:, :, span]
            try:
                check_spline_runs(self.points[rows])
                spline = fit_spline(self.points[rows], part, scales)
            except IntervalError:
                if block[0] < self.offsets[-1]:
                    raise
                last = self.times[:, -1].min() if self.times.size else self.time[0]
                share = (block[0] - 1 - self.offsets[-1]) / (self.counts[-1] - 1)
                self.end_time = min(self.end_time, last + max(share, 0.0) * self.reach)
                mapped_curves[:, :, block[0] :] = np.nan_to_num(mapped_curves[:, :, block[0] :])
                break
            # Far beyond the runs that are known a cubic is anything.
            fills = np.clip(spline.evaluate(self.points), part.min(axis=0), part.max(axis=0))
            # A curve goes on from where it is known without a jump, which fades over the block.
            is_given = is_known[:, span]
            is_given[:, 0] |= is_later
            last = is_given.sum(axis=1) - 1
            jumps = (mapped_curves[:, :, span] - fills)[np.arange(len(last)), :, last]
            jumps[last < 0] = 0.0
            fade = np.clip(1.0 - (np.arange(len(span)) - last[:, None]) / len(span), 0.0, 1.0)
            fills += jumps[:, :, None] * fade[:, None]
            jumps = np.abs(jumps)[..., None]
            for curves, part in (mapped_curves, fills), (self.fill_errors, jumps):
                curves[:, :, span] = np.where(is_given[:, None], curves[:, :, span], part)
        self.mapped_curves = mapped_curves
        self.spline = fit_spline(self.points, mapped_curves, scales)
        if len(self.spline.points) < len(self.points):
            raise IntervalError("runs", len(self.points), "runs that are farther apart")
        self.errors = np.where(is_known[:, None], self.spline.left_out, 0.0)
        self.is_known = is_known[:, None]
        low, high = mapped_curves.min(axis=0), mapped_curves.max(axis=0)
        # Far from the runs a cubic is anything: at most the range of the runs beyond it.
        self.limits = 2 * low - high, 2 * high - low

    def times_at(self, points: np.ndarray) -> np.ndarray:
        """Return the event times (P, E), s, at points (P, k)."""
        spline = self.times_spline
        return np.zeros((len(points), 0)) if spline is None else spline.evaluate(points)

    def time_ranges(self) -> np.ndarray:
        """Return the earliest and the latest times (2, E), s, of each event, over the runs and the
        box."""
        free = self.spline.scales > 0
        trial = np.where(free, spread_points(free, _CANDIDATES), self.points[0])
        times = np.concatenate([self.times, self.times_at(trial)])
        return np.array([times.min(axis=0), times.max(axis=0)])

    def place(self, times: np.ndarray, instants: np.ndarray) -> np.ndarray:
        """Return the position of instants (P, T) or (T), s, on the mapped time axis, as fractions
        (P, T) of its columns, given event times (P, E)."""
        times = np.maximum.accumulate(times, axis=1)
        starts = np.concatenate([np.full((len(times), 1), self.time[0]), times], axis=1)
        reach = np.full((len(times), 1), self.reach)
        lengths = np.concatenate([np.diff(starts, axis=1), reach], axis=1)
        instants = np.broadcast_to(instants, (len(times), np.shape(instants)[-1]))
        piece = (instants[:, :, None] >= times[:, None, :]).sum(axis=-1)
        start, length = (np.take_along_axis(x, piece, axis=1) for x in (starts, lengths))
        share = np.clip((instants - start) / np.maximum(length, 1e-12 * self.reach), 0.0, 1.0)
        return self.offsets[piece] + share * (self.counts[piece] - 1)

    def read(
        self, times: np.ndarray, mapped_curves: np.ndarray, instants: np.ndarray
    ) -> np.ndarray:
        """Return curves (P, n, T) at instants (T) of mapped ones (P, n, S) with times (P, E)."""
        place = self.place(times, instants)
        first = np.minimum(place.astype(int), mapped_curves.shape[-1] - 2)
        share = (place - first)[:, None]
        low, high = (
            np.take_along_axis(mapped_curves, c[:, None], axis=2) for c in (first, first + 1)
        )
        return low + share * (high - low)

    def evaluate(self, points: np.ndarray, instants: np.ndarray) -> np.ndarray:
        """Return the curves (P, n, T) at points (P, k) in [-1, 1]^k and instants (T), s."""
        curves = np.clip(self.spline.evaluate(points), *self.limits)
        return self.read(self.times_at(points), curves, instants)

    def values_at(
        self, points: np.ndarray, response: np.ndarray, instants: np.ndarray
    ) -> np.ndarray:
        """Return C values at C points (C, k): of responses of these indices (C) at instants (C)."""
        place = self.place(self.times_at(points), instants[:, None])[:, 0]
        first = np.minimum(place.astype(int), self.mapped_curves.shape[-1] - 2)
        share, w = place - first, self.spline.weights
        weights = w[:, response, first] * (1 - share) + w[:, response, first + 1] * share
        limits = (
            x[response, first] * (1 - share) + x[response, first + 1] * share for x in self.limits
        )
        if self.spline.on_line:
            index, factor = self.spline.line_rows(points)
            values = (factor * weights[index, np.arange(len(index))[:, None]]).sum(axis=1)
        else:
            values = np.einsum("cm,mc->c", self.spline.basis(points), weights)
        return np.clip(values, *limits)

    @cached_property
    def left_out(self) -> np.ndarray:
        """Values (R, n, T) of runs less those of the fit to all others."""
        times = self.times
        if self.times_spline is not None:
            times = times - self.times_spline.left_out
        return self.values - self.read(times, self.mapped_curves - self.errors, self.time)

    @cached_property
    def time_errors(self) -> np.ndarray:
        """Left-out errors (R, E) of event times, s, where they are at least usual."""
        if self.times_spline is None:
            return np.zeros((len(self.points), 0))
        return self._at_least_usual(level_errors(self.times_spline))

    def _at_least_usual(self, errors: np.ndarray) -> np.ndarray:
        """Return the size of errors (R, ...) of runs, where they are at least a mean, in which
        large ones count most; in a part of the box, at whose border curves bend, they are the
        largest."""
        size = np.abs(errors)
        usual = size.max(axis=0) if self.is_part else (size**4).mean(axis=0) ** 0.25
        return np.maximum(size, usual)

    def curve_errors(self, window: float) -> np.ndarray:
        """Return the largest left-out errors (R, n, S) of mapped curves of each run within a time
        `window` (s) in the same stretch, where they are at least usual."""
        errors = self._at_least_usual(
            np.where(self.is_known, level_errors(self.spline), self.fill_errors)
        )
        step = (self.time[-1] - self.time[0]) / (len(self.time) - 1)
        size = 4 * int(window / step) + 1  # columns are half an instant apart
        for i, count in zip(self.offsets, self.counts, strict=True):
            part = slice(i, i + count)
            errors[..., part] = scipy.ndimage.maximum_filter1d(
                errors[..., part], size, mode="nearest"
            )
        return errors

    def weigh_runs(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The nearest runs (P, f + 1) to points (P, k), and the shares (P, f + 1) of their left-out
        errors that count: all from halfway to the next run on, less nearer to a run."""
        scales, tree = self.spline.scales, scipy.spatial.cKDTree(self.points * self.spline.scales)
        gaps = tree.query(self.points * scales, k=2)[0][:, -1]
        count = min(int((scales > 0).sum()) + 1, len(gaps))
        distances, rows = tree.query(points * scales, k=np.arange(count) + 1)
        shares = np.minimum(2 * distances[:, :1] / gaps[rows], 1.0)
        return rows, np.ones_like(shares) if self.is_part else shares

    def shifts(self, points: np.ndarray) -> np.ndarray:
        """Return the largest errors (P), s, of the event times at points (P, k)."""
        rows, shares = self.weigh_runs(points)
        return (self.time_errors[rows] * shares[..., None]).max(axis=(1, 2), initial=0.0)


@dataclass(frozen=True)
class Part:
    """Runs of one sequence of events, and where in the box it is. rows (r): indices of the runs;
    curves: fitted to them; borders: pairs of a spline and a sign; the part is where the spline's
    value (P, 1) at a point times the sign is above 0, for each pair."""

    rows: np.ndarray
    curves: AlignedCurves
    borders: list[tuple[Spline, float]] = field(default_factory=list)

    def contains(self, points: np.ndarray, slack: float = 0.0) -> np.ndarray:
        """Return whether points (P, k) in [-1, 1]^k are in this part of the box (P), or near it:
        where splines, 1 at runs inside its borders and -1 outside, are above -`slack`."""
        is_inside = np.ones(len(points), bool)
        for spline, sign in self.borders:
            is_inside &= sign * spline.evaluate(points)[:, 0] > -slack
        return is_inside

    def maximum(
        self, sign: float, columns: np.ndarray, window: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Largest values (C) of the curves times `sign` over the part, their points (C, k), and the
        largest values (C) with the error within a time `window` (s) and near the borders, for the
        mask `columns` (n, T). A search by coordinates starts from the best of runs, spread points,
        and those of the instants beside."""
        curves, time = self.curves, self.curves.time
        free = self.curves.spline.scales > 0
        trial = spread_points(free, _CANDIDATES)
        trial[:, ~free] = curves.points[0, ~free]
        trial = np.concatenate([curves.points, trial[self.contains(trial, _SLACK)]])
        is_outside = ~self.contains(trial)
        is_outside[: len(curves.points)] = False
        instants = np.flatnonzero(columns.any(axis=0))
        errors = curves.curve_errors(window)
        best = np.full((len(columns), len(instants)), -np.inf)
        near_values, best_rows = best.copy(), np.zeros(best.shape, int)
        step = max(CHUNK // max(best.size, curves.mapped_curves[0].size), 1)
        for start in range(0, len(trial), step):
            part = slice(start, start + step)
            times = curves.times_at(trial[part])
            values = np.clip(curves.spline.evaluate(trial[part]), *curves.limits)
            values = curves.read(times, sign * values, time[instants])
            column = np.rint(curves.place(times, time[instants])).astype(int)[:, None]
            for rows, shares in zip(*(x.T for x in curves.weigh_runs(trial[part])), strict=True):
                error = np.take_along_axis(errors[rows], column, axis=2) * shares[:, None, None]
                near_values = np.maximum(near_values, (values + error).max(axis=0))
            values[is_outside[part]] = -np.inf
            top = values.argmax(axis=0)
            value = np.take_along_axis(values, top[None], axis=0)[0]
            best_rows = np.where(value > best, start + top, best_rows)
            best = np.maximum(value, best)
        choice = columns[:, instants]
        response, instant = np.nonzero(choice)
        shifted_rows = (np.roll(best_rows, shift, axis=1)[choice] for shift in (0, 1, -1))
        values, x = np.full(len(response), -np.inf), np.zeros((len(response), len(free)))
        for rows in shifted_rows:
            value, point = self._climb(sign, trial[rows], response, time[instants[instant]])
            better = value > values
            values, x = np.where(better, value, values), np.where(better[:, None], point, x)
        column = curves.place(curves.times_at(x), time[instants[instant], None])
        rows, shares = curves.weigh_runs(x)
        error = errors[rows, response[:, None], np.rint(column).astype(int)] * shares
        return values, x, np.maximum(values + error.max(axis=1), near_values[choice])

    def _climb(self, sign, x, response, instants) -> tuple[np.ndarray, np.ndarray]:
        """Larger values (C) near points (C, k), and where."""
        axes = np.diag(self.curves.spline.scales > 0).astype(float)
        axes = axes[axes.any(axis=1)]
        # Extremes may lie where an event is at just that instant, along no parameter.
        oblique = np.random.default_rng(0).uniform(-1.0, 1.0, (2 * len(axes), len(axes))) @ axes
        directions = (*axes, *-axes, *oblique, *-oblique) if len(axes) > 1 else (*axes, *-axes)
        best = self._values_at(sign, x, response, instants)
        for radius in _RADII:
            for direction in directions:
                trial = np.clip(x + radius * direction, -1.0, 1.0)
                value = self._values_at(sign, trial, response, instants)
                better = value > best
                x[better], best[better] = trial[better], value[better]
        return best, x

    def _values_at(self, sign, x, response, instants) -> np.ndarray:
        values = np.full(len(x), -np.inf)
        step = max(CHUNK // len(self.curves.points), 1)
        for start in range(0, len(x), step):
            part = slice(start, start + step)
            values[part] = sign * self.curves.values_at(x[part], response[part], instants[part])
        if self.borders:
            values[~self.contains(x)] = -np.inf
        return values


def split_runs(
    points: np.ndarray, values: np.ndarray, time: np.ndarray, events: list[dict],
    with_last: bool = True, depth: int = 2,
) -> list[Part]:  # fmt: skip
    """Fit aligned curves to runs, in parts where that predicts left-out runs better. points (R, k)
    in [-1, 1]^k; values (R, n, T) at `time` (T, s); events: of each run (`name_events`); with_last:
    which count (`shared_events`); depth: how many times parts are split."""
    for factor in SPACINGS:
        rows = distinct(points, factor)
        rows = rows[np.lexsort(points[rows].T)]  # in an order that is not that of the runs
        try:
            return _split(rows, points, values, time, events, with_last, [], None, depth)
        except IntervalError:
            if factor == SPACINGS[-1]:
                raise
    return []


def _split(rows, points, values, time, events, with_last, borders, scales, depth) -> list[Part]:
    event_times = [events[row] for row in rows]
    times = shared_events(event_times, time, with_last)
    curves = AlignedCurves(points[rows], values[rows], time, times, scales, bool(borders))
    whole, scales = [Part(rows, curves, borders)], curves.spline.scales
    for label in _labels(event_times, time) if depth else ():
        sides = []
        try:
            border = fit_spline(points[rows], np.where(label, 1.0, -1.0)[:, None])
            for sign in (1.0, -1.0):
                side = rows[label == (sign > 0)]
                check_spline_runs(points[side])
                pairs = [*borders, (border, sign)]
                sides += _split(
                    side, points, values, time, events, with_last, pairs, scales, depth - 1
                )
        except IntervalError:  # too few runs on one side
            continue
        if _loss(sides, values, time) < GAIN * _loss(whole, values, time):
            return sides
    return whole


def _labels(events: list[dict], time: np.ndarray) -> Iterator[np.ndarray]:
    """Masks (R) by which runs may be split: whether they have an event, and which of two comes
    first, where that is by more than some instants; the two that split them most evenly."""
    gap = _GAP * (time[-1] - time[0]) / (len(time) - 1)
    keys = sorted({key for event_times in events for key in event_times})
    presence = {key: np.array([key in event_times for event_times in events]) for key in keys}
    masks = [mask for mask in presence.values() if not mask.all()]
    common = [
        np.array([event_times[key] for event_times in events])
        for key in keys
        if presence[key].all()
    ]
    for i, column in enumerate(common[:MAX_EVENTS]):
        for rival in common[i + 1 : MAX_EVENTS]:
            if (column - rival).max() > gap and (rival - column).max() > gap:
                masks.append(column < rival)
    masks = [mask for mask in masks if 0 < mask.sum() < len(mask)]
    unique = {min(mask.tobytes(), (~mask).tobytes()): mask for mask in masks}
    yield from sorted(unique.values(), key=lambda mask: abs(mask.mean() - 0.5))[:2]


def _loss(parts: list[Part], values: np.ndarray, time: np.ndarray) -> float:
    """Return the root mean square left-out error of runs, relative to the spread of each
    response."""
    is_known = time <= min(part.curves.end_time for part in parts)
    spread = np.maximum(np.ptp(values, axis=(0, 2)), 1e-300)[:, None]
    errors = np.concatenate([part.curves.left_out[..., is_known] for part in parts]) / spread
    return float(np.sqrt((errors**2).mean())) if errors.size else np.inf


def change_within(time: np.ndarray, curves: np.ndarray, shifts: np.ndarray) -> np.ndarray:
    """Return by how much curves (n, T) at `time` (T, s) change within times `shifts` (n, T), s, of
    each instant, at most (n, T)."""
    counts = shifts * (len(time) - 1) / (time[-1] - time[0])
    most = np.zeros_like(curves)
    for offset in range(1, min(int(counts.max()) + 2, len(time))):
        share = np.clip(counts - (offset - 1), 0.0, 1.0)
        change = np.abs(curves[:, offset:] - curves[:, :-offset])
        most[:, offset:] = np.maximum(most[:, offset:], share[:, offset:] * change)
        most[:, :-offset] = np.maximum(most[:, :-offset], share[:, :-offset] * change)
    return most
