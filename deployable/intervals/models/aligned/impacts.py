"""Impacts of a run: contact events of several contacts, gathered into few collisions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

GAP = 0.02  # share of the duration


def find_impacts(
    event_time: np.ndarray,
    event_contact: np.ndarray | None = None,
    event_closing: np.ndarray | None = None,
    *,
    gap: float,
    end: float = np.inf,
) -> list[np.ndarray]:
    """Times at which each run's impacts begin.

    An impact begins when a contact closes after all contacts have been open for longer than `gap`
    s; the chatter of one collision, and hinges that close together, count once.

    Parameters
    ----------
    event_time, event_contact, event_closing
        (R, E) with NaN where a run has fewer events: the time in s, which contact, and whether it
        closes. Without the last two every event is a closing of one contact that opens at once.
    gap, end
        in s; impacts at or after `end` are left out.
    """
    found = []
    for row, times in enumerate(np.asarray(event_time, dtype=float)):
        order = np.argsort(times, kind="stable")
        order = order[np.isfinite(times[order])]
        closed: set[int] = set()
        last = -np.inf
        starts = []
        for i in order:
            contact = 0 if event_contact is None else int(event_contact[row, i])
            closing = event_closing is None or bool(event_closing[row, i])
            if closing:
                if not closed and times[i] - last > gap and times[i] < end:
                    starts.append(times[i])
                if event_closing is not None:
                    closed.add(contact)
            else:
                closed.discard(contact)
            last = times[i]
        found.append(np.array(starts))
    return found


def common_prefix(impacts: Sequence[np.ndarray]) -> tuple[np.ndarray, float]:
    """Impacts (R, J) that every run has, and the first time at which one run has another one."""
    count = min((len(x) for x in impacts), default=0)
    table = np.array([x[:count] for x in impacts]).reshape(len(impacts), count)
    later = [x[count] for x in impacts if len(x) > count]
    return table, float(min(later, default=np.inf))


def anchor_delays(impacts: np.ndarray, start: float, end: float, share: float = 0.2) -> np.ndarray:
    """Delays (J + 1) in s after which each piece's anchor follows the piece's beginning.

    They leave the last `share` of the shortest of the pieces of impacts (R, J).
    """
    ends = np.ones((len(impacts), 1))
    edges = np.concatenate([start * ends, impacts, end * ends], axis=1)
    return (1.0 - share) * np.diff(edges, axis=1).min(axis=0)


def add_anchors(impacts: np.ndarray, start: float, delays: np.ndarray) -> np.ndarray:
    """Impacts (R, J) with an anchor in each piece, (R, 2 J + 1).

    Between the beginning of a piece and its anchor, a fixed time later, all runs are aligned by
    shifting alone: a vibration that the impact excites keeps its frequency. Only the rest of the
    piece is stretched to meet the next impact.
    """
    begins = np.concatenate([np.full((len(impacts), 1), start), impacts], axis=1)
    return np.sort(np.concatenate([impacts, begins + delays], axis=1), axis=1)
