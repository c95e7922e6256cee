"""Errors of the bounds, estimated from runs that the surrogate has not seen and its coefficients.

If |f - s| <= e over the box, the bounds of s are within e of those of f (Hausdorff distance); how e
is estimated: docs/intervals.md. Neither a comparison of two orders nor a count of samples outside
the bounds is used: near collisions both saw nothing of errors of a tenth of the width."""

from dataclasses import dataclass

import numpy as np
import scipy

from .chebyshev import Surrogate, product_basis

WINDOW = 0.01  # share of the duration

MAX_TAIL_RATIO = 10.0
"""Largest accepted ratio of the extrapolated tail to the tail fitted to the validation runs. On the
paper's campaign, whose decay is right, it is at most 2.7 times."""

RATIOS = 2.0, 16.0
"""Least and largest ratio of two changes, as a mesh or step is halved twice, that an error is
continued by: those of the first and of the fourth order."""

MAX_DIRECTIONS = 3
"""Most directions in which the left-out errors of sought runs are averaged (see `power_mean`)."""

_INDEPENDENT = 1e-3  # least singular value, beside the largest, of what held-out runs see


def share_outside(runs: int, confidence: float | None = None) -> float:
    """Fraction of the box's volume where the model, at one instant, is outside the range of `runs`
    random runs: its mean (confidence None), or its upper limit at a confidence (0 to 1); 1 for
    fewer than two. Whatever the model (Wilks 1941), it has the beta distribution of 2 and N - 1,
    with the mean 2 / (N + 1)."""
    if runs < 2:
        return 1.0
    if confidence is None:
        return 2.0 / (runs + 1)
    return float(scipy.special.betaincinv(2, runs - 1, confidence))


def extrapolate_error(change: np.ndarray, ratio: np.ndarray | None = None) -> np.ndarray:
    """Discretization error (...) by Richardson extrapolation, from the `change` (...) of a result
    when its mesh or step is halved, with its sign. ratio (...): of successive changes, 2**p at
    order p (Phil. Trans. R. Soc. A 210 (1911) 307), clipped to 2 to 16 (RATIOS); NaN or None: 2."""
    least, most = RATIOS
    ratios = np.full_like(change, least) if ratio is None else np.nan_to_num(ratio, nan=least)
    ratio = np.clip(ratios, least, most)
    return change * ratio / (ratio - 1)


def refinement_ratio(change: np.ndarray, finer_change: np.ndarray) -> np.ndarray:
    """Ratio (...) of two successive changes of a result as its mesh or step is halved twice; NaN
    where both are zero or one is not known, infinite where only the second is zero."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.divide(change, finer_change)


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimates (..., T) of the largest error of a model over the box at each of T instants, in the
    unit of the values it is fitted to. held_out: by runs that were not fitted (of bounds by all
    runs: by their growth); decay: by the decay of the coefficients, 0 without any; total: the one
    to be used: the larger of both, of a fit the largest in a time window about the instant."""

    total: np.ndarray
    held_out: np.ndarray
    decay: np.ndarray


def estimate_error(time: np.ndarray, held_out: np.ndarray, decay: np.ndarray) -> ErrorEstimate:
    """Combine error estimates (..., T) of a surrogate: `held_out`, of runs not fitted, and `decay`,
    of coefficients. `total` is the larger, widened (`widen`)."""
    return ErrorEstimate(widen(time, np.maximum(held_out, decay)), held_out, decay)


def estimate_decay(surrogate: Surrogate, time: np.ndarray | None = None) -> np.ndarray:
    """Extrapolate the neglected tail (..., T) of a polynomial from the decay of its coefficients.

    In each direction the shells S_l = sum of |c_i| with i_j = l give the next two, S_(n+2) = S_n
    S_n / S_(n-2): two places at a time, since odd or even functions have every second coefficient
    zero. Where total degree limits the basis, its shells stand for all directions at once.

    time (T): instants (s) of the last axis, or None. With it, coefficients are widened."""
    indices, c = surrogate.multi_indices, np.abs(surrogate.coefficients)
    if time is not None:
        c = widen(time, c)
    degrees = surrogate.degrees
    if not degrees.any():
        return np.zeros(c.shape[1:])
    if len(indices) == np.prod(degrees + 1.0):
        return np.asarray(sum(_tail(indices[:, j], c) for j in np.flatnonzero(degrees)))
    fractions = indices / np.where(degrees > 0, degrees, 1)
    level = np.minimum(np.ceil(fractions.sum(axis=1) * degrees.max() - 1e-9), degrees.max())
    return _tail(level.astype(int), c)


def limit_decay(
    surrogate: Surrogate,
    points: np.ndarray,
    test_points: np.ndarray,
    residuals: np.ndarray,
    decay: np.ndarray,
    time: np.ndarray,
) -> np.ndarray:
    """Limit the extrapolated tail `decay` (..., T) of a polynomial to what validation runs allow,
    and return it. points (N, k): of the fitted runs; test_points (R, k): of the validation runs;
    residuals (R, ..., T): their values less the polynomial's; time (T): instants, s.

    The tail is at most 10 times (`MAX_TAIL_RATIO`) the larger of the largest residual and the sizes
    of the next two coefficients along each direction, as the residuals determine them; with too few
    runs for that it stays as it is (docs/intervals.md)."""
    highest = surrogate.degrees
    next_two = [
        np.where(np.arange(len(highest)) == j, highest[j] + excess, 0)
        for j in np.flatnonzero(highest)
        for excess in (1, 2)
    ]
    if not 0 < len(next_two) <= len(test_points):
        return decay
    new, terms = np.array(next_two), surrogate.multi_indices
    alias = np.linalg.lstsq(product_basis(points, terms), product_basis(points, new), rcond=None)[0]
    residual_basis = product_basis(test_points, new) - product_basis(test_points, terms) @ alias
    size = np.linalg.svd(residual_basis, compute_uv=False)
    if size[-1] < _INDEPENDENT * size[0]:
        return decay
    coefficients = np.linalg.pinv(residual_basis) @ residuals.reshape(len(test_points), -1)
    size_sum = np.abs(coefficients).sum(axis=0).reshape(decay.shape)
    size_sum = np.maximum(size_sum, np.abs(residuals).max(axis=0))
    return np.minimum(decay, MAX_TAIL_RATIO * widen(time, size_sum))


def power_mean(left_out: np.ndarray, directions: int) -> np.ndarray:
    """Error (...) of a function fitted to adaptively sampled runs: a power mean of their
    leave-one-out errors `left_out` (N, ...), the power being the number of `directions`, as any run
    may be next to the point that decides; the largest in more than 3 (`MAX_DIRECTIONS`)."""
    size = np.abs(left_out)
    if directions > MAX_DIRECTIONS:
        return size.max(axis=0)
    power = max(directions, 1)
    return (size**power).mean(axis=0) ** (1 / power)


def _tail(level: np.ndarray, c: np.ndarray) -> np.ndarray:
    n = int(level.max())
    if n == 0:
        return np.zeros(c.shape[1:])
    shells = [c[level == i].sum(axis=0) for i in range(n + 1)]
    if n == 1:
        return shells[1]  # no decay can be told
    if n == 2:
        return shells[2] * _ratio(shells[2], shells[1])
    after_next = shells[n] * _ratio(shells[n], shells[n - 2])
    # the constant term says nothing about decay, so n = 3 borrows the ratio of the other parity
    pair = (n - 1, n - 3) if n > 3 else (3, 1)
    return after_next + shells[n - 1] * _ratio(shells[pair[0]], shells[pair[1]])


def _ratio(last: np.ndarray, previous: np.ndarray) -> np.ndarray:
    """Decay from `previous` to `last`, at most 1; 1 where `previous` is nothing but rounding."""
    has_decay = previous > 1e-12 * (previous.max(initial=0.0) + last)
    return np.minimum(np.divide(last, previous, out=np.ones_like(last), where=has_decay), 1.0)


def widen(time: np.ndarray, error: np.ndarray, window: float | None = None) -> np.ndarray:
    """Return for each instant of `time` (T, s) the largest value of an error (..., T) within a time
    window about it. window: half width in s, None: 0.5 % of the duration."""
    time = np.asarray(time, dtype=float)
    if len(time) < 2:
        return error.copy()
    half = WINDOW / 2 * (time[-1] - time[0]) if window is None else float(window)
    first = np.searchsorted(time, time - half * (1 + 1e-12), side="left")
    last = np.searchsorted(time, time + half * (1 + 1e-12), side="right")
    # maxima over windows from a table of maxima over powers of two
    length = last - first
    level = np.floor(np.log2(length)).astype(int)
    table = [error]
    for p in range(int(level.max())):
        shift = 1 << p
        table.append(np.maximum(table[-1][..., :-shift], table[-1][..., shift:]))
    maxima = np.empty_like(error)
    for p, row in enumerate(table):
        cols = np.flatnonzero(level == p)
        if len(cols):
            maxima[..., cols] = np.maximum(row[..., first[cols]], row[..., last[cols] - (1 << p)])
    return maxima
