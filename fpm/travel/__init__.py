"""Quasi-static travel of an opening, with the virtual work of each component.

Theory: docs/mechanics.md, "Quasi-static motion of an opening". The virtual work w = F·t of each
element, per unit of the opening at a vanishing rate, is actuating (w > 0) or resistive (w < 0).
Kinetic energy does not enter, nor do elements that hold.

Values are known at increasing positions; where they bend or jump, a position stands twice, and what
is between bends is interpolated by cubics through the four positions around (or fewer). Positions
are added half-way between others until the interpolant meets every tested value."""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fpm.assembly.search import mass_blocks
from fpm.elements import Contact, Friction, Latch, Stop, TableSpring
from fpm.errors import SceneError
from fpm.travel.components import STRAIN, VirtualWork, bearing_name, components_of
from fpm.travel.path import MAX_ITERATIONS, MOTION_TOLERANCE, TINY, Path

SMALLEST_DISTANCE = 1e-7
"""Distance of positions, as a fraction of the travel, between which values jump, or bend, for
good."""

MAX_POSITIONS = 1500
"""Largest number of positions."""

ROUNDING_LIMIT = 20.0
"""Largest error of the interpolant, over what is allowed, that counts as rounding of values."""

NODES = 4


def bends_after(positions: np.ndarray) -> np.ndarray:
    """Return the indices at which stretches between bends (kinks or jumps of sampled values) begin,
    and at last p. positions (p,): increasing, a bend's twice in a row, as end and as beginning."""
    return np.concatenate([[0], np.flatnonzero(np.diff(positions) == 0) + 1, [len(positions)]])


def interpolate(positions: np.ndarray, values: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return values (m, ...) at points (m,), interpolated by cubics from values (p, ...) at
    increasing positions (p,), not across bends (kinks, jumps), whose positions stand twice."""
    points = np.atleast_1d(points)
    ends = bends_after(positions)
    index = np.clip(np.searchsorted(positions, points, side="right") - 1, 0, len(positions) - 2)
    index = np.where(positions[index] == positions[index + 1], np.maximum(index - 1, 0), index)
    stretch = np.searchsorted(ends, index, side="right") - 1
    first, last = ends[stretch], ends[stretch + 1]
    count = np.minimum(last - first, NODES)
    start = np.clip(index - 1, first, last - count)
    result = np.zeros((len(points), *values.shape[1:]))
    for size in np.unique(count):
        rows = np.flatnonzero(count == size)
        nodes = positions[start[rows, None] + np.arange(size)]
        for k in range(size):
            rest = np.delete(nodes, k, axis=1)
            weight = np.prod((points[rows, None] - rest) / (nodes[:, k, None] - rest), axis=1)
            nodal = values[start[rows] + k]
            result[rows] += weight.reshape(-1, *[1] * (nodal.ndim - 1)) * nodal
    return result


def slopes(positions: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the derivatives (p,) of values (p,) by the increasing positions (p,), by cubic splines
    between bends (kinks or jumps), whose positions stand twice in a row."""
    from scipy.interpolate import CubicSpline

    ends = bends_after(positions)
    rows = [slice(*pair) for pair in pairwise(ends)]
    pieces = [CubicSpline(positions[r], values[r])(positions[r], 1) for r in rows]
    return np.concatenate(pieces)


class SampledTravel:
    """Values (k,) measured at positions of a travel (a joint coordinate moved slowly from one value
    to another), fractions of it from 0 to 1, to which `add`, `add_bend` and `refine` add further.
    measure(position, state): returns (values, new state), started from `state`, the one returned at
    the nearest sampled position not above, None if none is; states are the caller's."""

    def __init__(self, measure: Callable):
        self._measure = measure
        self.positions: list[float] = []
        self.values: list[np.ndarray] = []
        self._states: list = []
        self._bends: set[float] = set()

    def add(self, position: float) -> np.ndarray:
        """Return the values (k,) at a position (0 to 1), measured and stored unless known."""
        k = bisect_left(self.positions, position)
        if k < len(self.positions) and self.positions[k] == position:
            return self.values[k]
        values, state = self.look(position)
        self.positions.insert(k, position)
        self.values.insert(k, values)
        self._states.insert(k, state)
        return values

    def look(self, position: float) -> tuple[np.ndarray, object]:
        """Measure the values (k,) at a position, without storing them, from the state of the
        nearest sampled position not above. Returns them and the new state."""
        k = bisect_right(self.positions, position) - 1
        return self._measure(position, self._states[k] if k >= 0 else None)

    def add_bend(self, position: float) -> None:
        """Sample a position (0 to 1) of a kink or jump; nothing is interpolated across it."""
        self.add(position)
        self._bends.add(position)

    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the sampled positions (p,), fractions of the travel from 0 to 1, increasing, kinks
        or jumps between the ends twice, and the k values measured at each (p, k)."""
        inner = [
            p in self._bends and 0 < i < len(self.positions) - 1
            for i, p in enumerate(self.positions)
        ]
        index = np.repeat(np.arange(len(self.positions)), 1 + np.array(inner))
        return np.array(self.positions)[index], np.array(self.values)[index]

    def refine(self, measure_error: Callable[[np.ndarray, np.ndarray, float], float]) -> bool:
        """Sample further positions, half-way between others, until interpolated values are
        accurate; False where more than 1500 would be needed. Two positions within 1e-7 between
        which they still are not are marked as a kink or jump. measure_error(interpolated, measured,
        distance): error over the allowed one. Accurate: up to 1, or up to ROUNDING_LIMIT if halving
        does not help."""
        pairs = [(*ends, np.inf) for ends in pairwise(self.positions)]
        while pairs:
            lower, upper, previous_error = pairs.pop()
            middle = 0.5 * (lower + upper)
            expected = interpolate(*self.arrays(), np.array([middle]))[0]
            error = measure_error(expected, self.add(middle), upper - lower)
            if error <= 1.0 or ROUNDING_LIMIT >= error > 0.7 * previous_error:
                continue
            if upper - lower <= SMALLEST_DISTANCE:
                self._bends |= {lower, upper}
            elif len(self.positions) >= MAX_POSITIONS:
                return False
            else:
                pairs += [(lower, middle, error), (middle, upper, error)]
        return True


POSITIONS = 31
"""Number of positions of the opening at first, with both ends."""

TOLERANCE = 1e-6
"""Allowed error of interpolated virtual work, as a fraction of the sum of all sizes of works."""

BEARING_TOLERANCE = 1e-4
"""Allowed error of the work of bearings, as a fraction of that sum: where joints hold twice what
others hold, as out of the plane of a planar loop, their forces are known to some 1e-5 only
(rounding over the 1e-10 by which joints give)."""

SMALLEST_FRACTION = 1e-6
"""Smallest sum of works that errors relate to, as a fraction of the largest at any position."""

POSITION_TOLERANCE = 1e-9
"""Tolerance of positions at which something bends, as a fraction of the travel."""

STRAIN_DISTANCE = 5e-3
"""Distance of positions, as a fraction of the travel, above which the strain's slope is tested."""

APPROACH = 1e-4
"""Fraction of the travel by which friction is moved straight to a position."""


class Travel(NamedTuple):
    """Result of moving a joint coordinate (opening) slowly to p positions, all else in static
    balance. opening (p,): rad, of slides m; work: virtual work (p,) of each component by name, per
    unit of the opening (N m, slides N), above 0 where it drives; inertia (p,): generalized, of all
    that moves with the opening (kg m², slides kg)."""

    opening: np.ndarray
    work: dict[str, np.ndarray]
    inertia: np.ndarray


def sweep(
    scene,
    openings: str | Sequence[str],
    first: float,
    last: float,
    locked: Sequence[str] = (),
    positions: int | None = None,
) -> Travel:
    """Move an opening of a scene slowly from one value to another (Travel).

    openings: name of a hinge, or of several, the others as far from their start as the first;
    first, last: at both ends (rad, m); locked: hinges that keep their opening; positions: evenly
    spaced, None: as many as needed, with those of kinks. SceneError if the opening does not
    determine the motion, or not at an end, MisfitError if it cannot reach a value."""
    names = [openings] if isinstance(openings, str) else openings
    count = positions or POSITIONS
    path = Path(scene, names, locked)
    sweep = _Sweep(scene, path, first, last, (last - first) / (count - 1))
    samples = SampledTravel(sweep.measure)
    for position in np.linspace(0.0, 1.0, count):
        samples.add(float(position))
    path.check(last - 0.01 * (last - first))
    if positions is None:
        _add_bends(scene, samples, sweep.works + 2)
        sweep.largest = max(np.abs(values[: sweep.works]).sum() for values in samples.values) + TINY
        if not samples.refine(sweep.measure_error):
            travel = f"from {first:.6g} to {last:.6g}"
            allowed = "a way on which what acts bends or jumps at some places only: it needs more"
            allowed += f" than {MAX_POSITIONS} positions"
            raise SceneError(f"opening {names[0]}", travel, allowed)
    fractions, values = samples.arrays()
    work = dict(zip(sweep.names, values[:, : sweep.works].T, strict=True))
    energy, inertia = values[:, sweep.works : sweep.works + 2].T
    if scene.beams:  # at the balance it is least, so that it is more exact than its forces
        work[STRAIN] = -slopes(fractions, energy) / abs(last - first)
    return Travel(first + fractions * (last - first), work, inertia)


class _Sweep:
    """Measures of a scene on a path from an opening `first` to `last`, to which it moves in steps
    of `spacing`. names: of components, bearings last; works: how many; largest: work."""

    def __init__(self, scene, path: Path, first: float, last: float, spacing: float):
        self._scene, self._path, self._first, self._travel = scene, path, first, last - first
        components = components_of(scene)
        self._parts = [VirtualWork(scene, part) for part in components]
        steps = 1 + math.ceil(abs((first - path.opening) / spacing))
        for value in np.linspace(path.opening, first, steps):
            path.move_to(float(value))
            for part in self._parts:  # openings count whole turns between positions
                part.compute(path.poses, path.tangent)
        path.check(first + 0.5 * spacing)
        self._elements = [*path.balance.sources, *(s for part in self._parts for s in part.sources)]
        self.names = [part.name for part in components]
        self.names += [bearing_name(scene, hinge) for hinge in scene.bearings]
        self.works, self.largest = len(self.names), TINY
        frictions = {friction.hinge for friction in Friction.find(scene) if not friction.is_exact}
        self._friction_hinges = sorted(frictions | set(scene.bearings))

    def measure(self, position: float, state):
        """Virtual works, strain, inertia, openings, rates; position: fraction of the travel."""
        path = self._path
        if state is not None:
            path.restore(state[0])
            for elements, history in zip(self._elements, state[1], strict=True):
                elements.restore(history)
        path.move_to(float(self._first + position * self._travel))
        tangent = np.sign(self._travel) * path.tangent
        motion = APPROACH * abs(self._travel) * tangent
        poses_before = [path.poses.displace(-factor * motion) for factor in (1.0, 0.5)]
        row, friction = [], np.zeros(len(tangent))
        for part in self._parts:
            work, forces = part.compute(path.poses, tangent, poses_before)
            row.append(work)
            friction = friction + forces
        row += path.compute_bearing_work(friction)
        row.append(path.balance.bars.energy(path.poses))
        motion = tangent.reshape(-1, 2, 3)
        blocks = mass_blocks(self._scene, path.poses)
        row.append(np.einsum("nki,nkij,nkj->", motion, blocks, motion))
        row += [*path.update_openings(), *path.rates(self._friction_hinges)]
        return np.array(row), (
            path.state(),
            [elements.copy_history() for elements in self._elements],
        )

    def measure_error(self, expected: np.ndarray, values: np.ndarray, distance: float) -> float:
        """Largest error of expected values, over the error that is allowed."""
        works, errors = self.works, np.abs(values - expected)
        acts = np.abs(values[:works]).sum()
        most = TOLERANCE * max(acts, SMALLEST_FRACTION * self.largest)
        errors[len(self._parts) : works] *= TOLERANCE / BEARING_TOLERANCE
        inertia = errors[works + 1] / (10 * TOLERANCE * values[works + 1])
        strain = errors[works] / (distance * abs(self._travel) * most)
        work = errors[:works].max(initial=0.0) / most
        return max(work, inertia, strain * (distance > STRAIN_DISTANCE))


def _add_bends(scene, samples: SampledTravel, openings: int) -> None:
    """Add positions at which forces of elements bend, and at which joints with friction reverse.
    openings: first column of the samples' values with openings; rates of joints follow them."""
    angles = [(e.hinge, a) for k in (TableSpring, Friction) for e in k.find(scene)
              for a in e.angles]  # fmt: skip
    angles += [(element.hinge, element.angle) for k in (Stop, Latch) for element in k.find(scene)]
    angles += [(contact.hinge, 0.0) for contact in Contact.find(scene)]
    bends = [(openings + hinge, angle) for hinge, angle in sorted(set(angles))]
    rates = openings + len(scene.hinges)
    sizes = np.abs(np.array(samples.values)[:, rates:]).max(axis=0)
    # What rests turns by rounding.
    rows = np.flatnonzero(sizes > MOTION_TOLERANCE * sizes.max(initial=0.0))
    bends += [(rates + int(i), 0.0) for i in rows]
    for column, angle in bends:
        for ends in list(pairwise(samples.positions)):
            values = [samples.add(end)[column] - angle for end in ends]
            if values[0] * values[1] <= 0 and values[0] != values[1]:
                height: Callable = lambda x, k=column, a=angle: samples.look(x)[0][k] - a  # noqa: E731
                root = _root(height, ends, values)
                nearest = min(ends, key=lambda end: abs(end - root))
                samples.add_bend(nearest if abs(nearest - root) < POSITION_TOLERANCE else root)


def _root(function: Callable[[float], float], ends, values) -> float:
    """Root of a function between two ends with values of opposite signs (Illinois method)."""
    (a, b), (value_a, value_b) = ends, values
    if 0.0 in values:
        return a if value_a == 0.0 else b
    size = abs(value_b - value_a)
    for _ in range(MAX_ITERATIONS):
        root = (a * value_b - b * value_a) / (value_b - value_a)
        value = function(root)
        if abs(value) <= POSITION_TOLERANCE * size or abs(b - a) < POSITION_TOLERANCE:
            break
        a, value_a = (b, value_b) if value * value_b < 0 else (a, 0.5 * value_a)
        b, value_b = root, value
    return root
