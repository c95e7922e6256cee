"""Where the runs of a case are: the points of its designs, scans, and held-out runs."""

import numpy as np

from deployable import intervals
from deployable.campaign.config.sections import scene_type
from evidence.tradeoff.measure.cases import Case, Choice


def box_of(case: Case) -> intervals.Box:
    """The box of a case."""
    table = scene_type(case.scene).parameters
    middle = np.array([table[name].default for name in case.intervals])
    half = middle * list(case.intervals.values())
    return intervals.Box(list(case.intervals), middle - half, middle + half)


def design_of(case: Case, choice: Choice) -> intervals.Design:
    """The design of a choice; a plain scan is the one that a campaign would run."""
    options = {} if choice.samples is None else {"samples": choice.samples}
    return intervals.make_design(choice.method, box_of(case), choice.order, **options)


def held_out_of(case: Case, choice: Choice, design: intervals.Design) -> np.ndarray:
    """Points (H, k) of the runs that test the surrogate; none for a plain scan."""
    count = 0 if choice.order is None else case.held_out
    return intervals.held_out_points(box_of(case).free, count, design.points)


def scan_of(case: Case, samples: int) -> np.ndarray:
    """Points of the dense scan: evenly spaced on a line, else a Sobol sequence with the corners."""
    if samples == 0:
        return np.zeros((0, len(case.intervals)))
    if len(case.intervals) == 1:
        return np.linspace(-1.0, 1.0, samples)[:, None]
    return intervals.make_design("sobol", box_of(case), samples=samples).points


def points_of(case: Case, choices, scan: int) -> np.ndarray:
    """All points (R, k) that the choices and the dense scan need, each once."""
    points = [scan_of(case, scan)]
    for choice in choices:
        design = design_of(case, choice)
        points += [design.points, held_out_of(case, choice, design)]
    return unique_points(np.concatenate(points))


def unique_points(points: np.ndarray) -> np.ndarray:
    """The points (N, k), each once, in their order."""
    _, first = np.unique(np.round(points, 12) + 0.0, axis=0, return_index=True)
    return points[np.sort(first)]
