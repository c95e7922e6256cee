"""Numbers that compare bounds with reference bounds or with runs."""

from __future__ import annotations

import numpy as np


def hausdorff(
    lower: np.ndarray, upper: np.ndarray, reference_lower: np.ndarray, reference_upper: np.ndarray
) -> np.ndarray:
    """Hausdorff distance of the intervals [lower, upper] and the reference, element by element."""
    return np.maximum(np.abs(lower - reference_lower), np.abs(upper - reference_upper))


def compare_bounds(
    time: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    reference_lower: np.ndarray,
    reference_upper: np.ndarray,
) -> dict[str, float]:
    """Compare bounds (T) with reference bounds (T) over the instants `time` (T).

    Returns
    -------
    hausdorff_largest
        in units of the response, and `hausdorff_largest_time` in s.
    hausdorff_rms
        root of the mean square over time.
    hausdorff_integrated
        integral of the distance over the integral of the reference's width; NaN for zero width.
    width_ratio
        integral of the width over that of the reference.
    """
    distance = hausdorff(lower, upper, reference_lower, reference_upper)
    width = np.trapezoid(reference_upper - reference_lower, time)
    at = int(np.argmax(distance))
    duration = float(time[-1] - time[0]) or 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        return {
            "hausdorff_largest": float(distance[at]),
            "hausdorff_largest_time": float(time[at]),
            "hausdorff_rms": float(np.sqrt(np.trapezoid(distance**2, time) / duration)),
            "hausdorff_integrated": float(np.divide(np.trapezoid(distance, time), width)),
            "width_ratio": float(np.divide(np.trapezoid(upper - lower, time), width)),
        }


def compare_runs(lower: np.ndarray, upper: np.ndarray, values: np.ndarray) -> dict[str, float]:
    """How runs (H, T) lie in bounds (T).

    Returns `coverage`, the share of the points (run, instant) within the bounds, and
    `worst_violation`, the largest distance of a point outside them; NaN and 0 without runs.
    """
    outside = np.maximum(lower - values, values - upper)
    if not outside.size:
        return {"coverage": float("nan"), "worst_violation": 0.0}
    # rounding of a run that is itself a node is not a violation
    scale = np.abs(values).max()
    return {
        "coverage": float((outside <= 1e-12 * scale).mean()),
        "worst_violation": float(max(outside.max(), 0.0)),
    }
