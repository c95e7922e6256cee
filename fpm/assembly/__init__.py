"""Assembly: parts whose points do not meet are forced together, and lie in balance, at rest.

Among all positions in which every joint is closed, one is sought in which the strain energy U of
the beams is least: with the conditions g of the joints, held axes left out,

    dU + G'λ = 0,   g = 0,   G = dg,

solved by Newton's method with exact derivatives (elastic.py, conditions.py):

    (H + μ M) d + G'λ = -dU,   G d - δ λ' = -g,   H = d(dU + G'λ)

λ' being the change of λ. What strains nothing, as a mechanism's own motion, is decided by μ M, a
small share of the masses and inertias: each round moves no further than it must, the mass being the
measure, so that a free structure keeps its centre of mass. δ lets conditions be redundant, as in
loops of rigid bodies; where they contradict each other, nothing converges. (Proximal method of
multipliers: Rockafellar, Math. Oper. Res. 1 (1976) 97.)

μ M holds back all that is softer than it, and heat presses a slender bar far beyond its buckling
load before it is let go, so that H has slopes below zero. What has not come to rest after ROUNDS is
tried again: with a μ that is below the bending of a bar of 10⁴ times its height, and without what
stress adds to H (Gauss and Newton's method) until the last rounds.

Where U falls from the position that was come to, along a motion that keeps the joints closed, this
snaps: both sides are followed downhill, and the lower end is taken if they differ.

Springs, cables, gravity and loads act from the start of a run, not before."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, NoReturn

import numpy as np

from fpm.assembly.conditions import Conditions, ParticlePoses, conditions_of, tilts
from fpm.assembly.elastic import elastic_of
from fpm.assembly.matrices import Form, largest_entry, saddle_solver, scale_matrix, sparse
from fpm.elements.bars.beam_limits import BEND, STRAIN
from fpm.elements.batch import GAP_TOL
from fpm.elements.openings.opening import opening_at
from fpm.errors import SceneError

ROUNDS = 60
"""Most rounds; where the misfit is some percent it takes five to ten."""

STEP_TOL = 1e-10
"""Largest motion of the last round, as a share of the size, or turn (rad)."""

FARTHEST = 0.1
"""Largest motion of a round, as a share of the size, or turn (rad)."""

OPEN = 1e-6
"""Gap (m) or angle (rad) from which a joint is said to be open where nothing was found."""

MASS_SHARE, EASE = 1e-8, 1e-13
"""μ and δ, where the largest entries of H, M and G are one."""

FALLS, INSTABILITY, SAME_TOL = 4, 1e-12, 1e-6
"""Most times that an unstable position is left; the curvature from which it is unstable, as a share
of the largest entry of H; and the share by which two positions and their energies are the same."""

LANCZOS, HALVINGS, CLOSINGS = 60, 12, 8
"""Most vectors that look for such a curvature, halvings of a motion downhill, rounds that close."""

SOFT_ROUNDS, SOFT_SHARE, SOFT_NEAR = 120, 1e-13, 1e-3
"""Of the second try: its most rounds, its μ, and the motion of a round below which H is exact."""


class MisfitError(SceneError):
    """Raised by `assemble` for parts that cannot be forced together at their joints."""


class Assembly(NamedTuple):
    """Result of forcing the parts of a scene together (`assemble`). energy: strain energy after it
    (J); joint, gap, tilt: of the joint most open before it, name, distance of its points (m) and
    largest angle (rad) between directions that should agree; rounds: number of Newton steps;
    openings: joint coordinates of scene.hinges before (rad; m of slides)."""

    energy: float
    joint: str
    gap: float
    tilt: float
    rounds: int
    openings: tuple[float, ...]


def assemble(scene, hold: Sequence[str] = ()) -> None:
    """Force a scene's parts (changed in place) together at its joints, in static balance, at rest.

    Positions and frames become those of the assembled structure, scene.assembly the result. Beams
    keep lengths and axes without stress; points stated later refer to the scene before. hold: names
    of hinges whose joint coordinate stays as stated. MisfitError where no balance is found."""
    if not len(scene.position):
        return
    start = ParticlePoses(scene.position.copy(), scene.frame.copy())
    conditions, elastic = conditions_of(scene, hold), elastic_of(scene)
    search = _RestSearch(scene, start, conditions, elastic, hold)
    with np.errstate(over="ignore", invalid="ignore"):  # what grows beyond all numbers is refused
        poses, rounds = search.relax()
    flips = {name: angle for name, angle in tilts(scene, poses, hold).items() if angle > np.pi / 2}
    if flips:  # the residuals, cosines of right angles, are 0 there too
        allowed = "directions of both parts that agree; reverse that of one part"
        raise MisfitError(f"joint {min(flips)}", "opposite directions of its parts", allowed)
    if scene.unstrained is None:  # else it was assembled before
        scene.unstrained, scene.unstrained_position = scene.frame, scene.position
    scene.position, scene.frame = poses.position, poses.frame
    openings = tuple(hinge.opening for hinge in scene.hinges)
    scene.hinges = [_reopen(scene, hinge) for hinge in scene.hinges]
    scene.assembly = Assembly(elastic.energy(poses), *search.open_before, rounds, openings)


class _RestSearch:
    """Search of poses in stable balance of a scene's particles, the joints closed. start: where it
    begins; hold: hinges that keep openings; open_before: name, gap (m), tilt (rad) of the joint
    open most."""

    def __init__(
        self,
        scene,
        start: ParticlePoses,
        conditions: Conditions,
        elastic: Any,
        hold: Sequence[str],
    ):
        self._scene, self._start, self._hold = scene, start, hold
        self._conditions = conditions
        self._elastic, self._unstressed = elastic, elastic.unstressed
        self._can_fall, self._key = len(elastic.nodes) > 0, "assembly"
        self._remedy = "`curvature` of the bar"
        self._size = float(np.ptp(scene.position, axis=0).max()) or 1.0
        self._scales = np.tile(np.repeat([self._size, 1.0], 3), len(scene.position))
        self._free = np.flatnonzero(~scene.fixed.ravel())
        self._weight = conditions.weight(self._size)
        self._mass: Any = None
        self.open_before = self._worst(start)
        self._no_gaps, self._no_force = np.zeros(len(self._weight)), np.zeros(len(self._scales))

    def _worst(self, poses: ParticlePoses) -> tuple[str, float, float]:
        """Name, gap (m) and tilt (rad) of the joint that is open most."""
        gaps = self._conditions.gaps(poses)
        name, gap, tilt = self._conditions.worst(np.where(np.isfinite(gaps), gaps, np.inf))
        angle = tilts(self._scene, poses, self._hold).get(name, np.nan)
        return name, gap, angle if tilt > 0 and np.isfinite(angle) else tilt

    def relax(self) -> tuple[ParticlePoses, int]:
        """The stable poses, and the number of rounds; raises MisfitError where none are found."""
        if not len(self._free) and self._gap(self._start) <= GAP_TOL:
            return self._start, 0
        state, impulses, count = self._rest(self._start)
        self._check_strains(state)
        step = self._find_descent(state, impulses) if self._can_fall else None
        if step is None:
            return state, count
        sides = [self._follow(state, impulses, direction) for direction in (step, -step)]
        sides = sorted((side for side in sides if side), key=lambda side: side[0])
        if sides and not self._differ(sides):
            self._check_strains(sides[0][1])
            return sides[0][1], count + sum(side[2] for side in sides)
        requirement = "a stable position; this one snaps, and none was found downhill of it"
        if sides:
            energy = self._elastic.energy(sides[0][1])
            requirement = (
                f"a stable position; this one snaps to either of two with {energy:.4g} J, as "
                f"a straight bar pressed beyond its buckling load: {self._remedy} says to which"
            )
        energy = self._elastic.energy(state)
        raise MisfitError(self._key, f"{energy:.4g} J in an unstable position", requirement)

    def _differ(self, sides: Sequence[tuple]) -> bool:
        """Whether both sides, lower first, end in different poses and fall by the same energy."""
        (low, low_poses, _), (high, high_poses, _) = sides[0], sides[-1]
        shift = np.abs(low_poses.position - high_poses.position).max()
        return high - low <= -SAME_TOL * low and shift > SAME_TOL * self._size

    def _system(self, poses, bars, impulses, ratio):
        rules = self._scales, self._free, self._weight, None, ratio, self._mass
        return linearise(self._scene, poses, self._conditions, bars, impulses, *rules)

    def _lacks(self, poses) -> np.ndarray:
        return -self._weight * self._conditions.gaps(poses)

    def _gap(self, poses) -> float:
        return float(np.abs(self._lacks(poses)).max(initial=0.0))

    def _rest(self, poses):
        """Newton's method: poses in balance, the impulses there and the rounds."""
        tries = [(ROUNDS, MASS_SHARE, np.inf), (SOFT_ROUNDS, SOFT_SHARE, SOFT_NEAR)]
        tries = tries[: 1 + self._can_fall] if len(self._free) else []
        count, largest, state = 0, 0.0, poses
        for most, ratio, radius in tries:
            state, impulses, largest = poses, self._no_gaps, np.inf
            for _ in range(most):
                count += 1
                bars = self._elastic if largest <= radius else self._unstressed
                solve, gradient = self._system(state, bars, impulses, ratio)
                step, change = solve(-gradient, self._lacks(state))
                largest = float(np.abs(step).max(initial=0.0))
                if not np.isfinite(largest):
                    break
                fraction = min(1.0, FARTHEST / largest) if largest > 0 else 1.0
                state = state.displace(fraction * self._scales * step)
                impulses = impulses + fraction * change
                if fraction == 1.0 and largest <= STEP_TOL and self._gap(state) <= GAP_TOL:
                    return state, impulses, count
        self._refuse(state, f"moving by {largest:.2g} in round {count}")

    def _find_descent(self, poses, impulses):
        """The motion (6n,) along which the energy falls to both sides at the second order, or None:
        image of a vector on which the inverse of a round's matrix is negative beyond rounding."""
        solve, _ = self._system(poses, self._elastic, impulses, SOFT_SHARE)
        scales = self._scales
        steps = _negative(lambda force: solve(force / scales, self._no_gaps)[0], len(scales))
        _, stiffness = self._elastic.derivatives(poses)
        _, curvature = self._conditions.derivatives(poses, self._weight * impulses)
        motions = scales[:, None] * steps
        falls = np.sum(motions * ((stiffness + curvature) @ motions), axis=0)
        least = self._least_curvature(poses, stiffness)
        steps = steps[:, falls < -least * np.sum(steps**2, axis=0)]
        step = (steps / np.abs(steps).max(axis=0, initial=0.0)).sum(axis=1)
        return step if step.any() else None

    def _least_curvature(self, poses, stiffness) -> float:
        """Curvature of the energy by scaled motions (N m) that is told from zero."""
        return INSTABILITY * abs(scale_matrix(stiffness, self._scales, self._scales)).max()

    def _close(self, poses):
        """The poses next to these at which the joints are closed, or None."""
        for _ in range(CLOSINGS):
            if self._gap(poses) <= GAP_TOL:
                return poses
            solve, _ = self._system(poses, self._unstressed, self._no_gaps, MASS_SHARE)
            step, _ = solve(self._no_force, self._lacks(poses))
            if not np.abs(step).max() <= FARTHEST:
                return None
            poses = poses.displace(self._scales * step)
        return None

    def _downhill(self, poses, step):
        """From unstable poses along a motion, then by Gauss-Newton rounds of falling energy."""
        for _ in range(SOFT_ROUNDS):
            fraction = min(1.0, FARTHEST / np.abs(step).max())
            for _ in range(HALVINGS):
                trial = self._close(poses.displace(fraction * self._scales * step))
                if trial is not None and self._elastic.change(poses, trial) < 0:
                    break
                fraction /= 2
            else:
                break
            poses = trial
            solve, gradient = self._system(poses, self._unstressed, self._no_gaps, SOFT_SHARE)
            step, _ = solve(-gradient, self._no_gaps)
            if not np.abs(step).max() > SOFT_NEAR:
                break
        return poses

    def _follow(self, poses, impulses, step):
        """Stable poses downhill of unstable ones to a motion's side, by how much energy, and the
        rounds; None: none."""
        count, start = 0, poses
        for _ in range(FALLS):
            try:
                poses, impulses, rounds = self._rest(self._downhill(poses, step))
            except MisfitError:
                return None
            count += rounds
            step = self._find_descent(poses, impulses)
            if step is None:
                return self._elastic.change(start, poses), poses, count
        return None

    def _check_strains(self, poses: ParticlePoses) -> None:
        """Check strains against the limits of a run; raises MisfitError where they are larger."""
        name, gap, tilt = self.open_before
        pairs = zip((BEND, STRAIN), self._elastic.largest(poses), strict=True)
        for (watch, value), condition in zip(pairs, ("bent or twisted", "strained"), strict=True):
            if value > watch.most:
                limit = f"by {value:.2g}, at most {watch.most:g} is allowed"
                allowed = f"parts that can be forced together; beams would be {condition} {limit}"
                raise MisfitError(f"joint {name}", _gap_text(gap, tilt), allowed)

    def _refuse(self, poses: ParticlePoses, moving: str) -> NoReturn:
        """Raise MisfitError for the joint that stays open; where none does, for the one with the
        largest misfit, or for the element that is still `moving`."""
        name, gap, tilt = self._worst(poses)
        allowed = "parts that can be forced together, with this joint closed"
        if not max(gap, tilt) > OPEN:
            name, gap, tilt = self.open_before
            allowed = (
                "parts that come to rest when forced together (of their size, or rad, by "
                f"{STEP_TOL:g} in a round); a mechanism may need a joint that is held, a bar "
                "without stress that is bent far may need more elements"
            )
            if not max(gap, tilt) > 0:
                raise MisfitError("assembly", moving, allowed)
        raise MisfitError(f"joint {name}", _gap_text(gap, tilt), allowed)


def _negative(apply, count: int, share: float = 0.0) -> np.ndarray:
    """Directions (count, k) in which a symmetric matrix, `apply`, seems to be negative, by a share
    of its largest eigenvalue. Lanczos' method from a fixed start, each vector made normal to all
    before."""
    basis = [np.random.default_rng(1).standard_normal(count)]
    basis[0] /= np.linalg.norm(basis[0])
    images: list[np.ndarray] = []
    while len(images) < min(count, LANCZOS):
        images.append(apply(basis[-1]))
        rest = images[-1]
        for _ in range(2):
            rest = rest - np.array(basis).T @ (np.array(basis) @ rest)
        length = np.linalg.norm(rest)
        if not length > 1e-14 * np.linalg.norm(images[-1]):
            break
        basis.append(rest / length)
    if not np.isfinite(images[-1]).all():  # the matrix is exactly singular
        return np.zeros((count, 0))
    small = np.array(basis[: len(images)]) @ np.array(images).T
    values, vectors = np.linalg.eigh((small + small.T) / 2)
    return np.array(images).T @ vectors[:, values < -share * np.abs(values).max()]


def linearise(
    scene,
    poses,
    conditions,
    elastic,
    impulses,
    scales,
    free,
    weight,
    ease=None,
    ratio=MASS_SHARE,
    mass=None,
    form=sparse,
):
    """Set up linear equations of a Newton step to static balance; returns a function solve(forces,
    gap_changes) and the gradient (6n,) of strain energy plus conditions times impulses.

    solve: takes forces (6n,), N and N m, and gap_changes (c,), by how much the conditions, times
    `weight`, shall change; returns the motion (6n,), shifts as fractions of the size, turns (rad),
    and the change (c,) of impulses, NaN where the matrix is singular. scene: for masses; poses: of
    all n particles; conditions: the c that close joints (Conditions); elastic: Elastic or
    Unstressed; impulses (c,): Lagrange multipliers of the conditions (N m); scales (6n,): size (m)
    for shifts, 1 for turns; free: indices of degrees of freedom not held; weight (c,): factors that
    make conditions dimensionless; ease: stiffness (N m) by which the largest mass, others in
    proportion, holds back motions that strain nothing; None: `ratio` of the largest stiffness;
    mass: matrix (6n, 6n) of masses by scaled motions, None: the scene's; form: of all matrices,
    `sparse` or, several times as fast for few particles, `full`."""
    count = len(scales)
    gradient, stiffness = elastic.derivatives(poses, form)
    if ease is None:  # impulses left from what moved do not count: they have no end but zero
        ease = ratio * largest_entry(scale_matrix(stiffness, scales, scales)) or 1.0
    rows, curvature = conditions.derivatives(poses, weight * impulses, form)
    stiffness, gradient = stiffness + curvature, gradient + rows.T @ (weight * impulses)
    stiffness = scale_matrix(stiffness, scales, scales)
    if mass is None:
        mass = scale_matrix(masses(scene, poses, form), scales, scales)
    unit = max(largest_entry(stiffness), ease)
    inner = (stiffness / unit + mass * (ease / unit / mass.max()))[free][:, free]
    solve_system = saddle_solver(inner, scale_matrix(rows, weight, scales)[:, free], EASE)

    def solve(forces, gap_changes):
        solution = solve_system(np.concatenate([(scales * forces)[free] / unit, gap_changes]))
        step = np.zeros(count)
        step[free] = solution[: len(free)]
        return step, unit * solution[len(free) :]

    return solve, gradient


def masses(scene, poses: ParticlePoses, form: Form = sparse):
    """Return a mass matrix (6n, 6n) of all n particles of a scene at `poses`, in global axes: 3 by
    3 blocks of mass (kg), then inertia (kg m²), of one particle after the other. form: of the
    matrix (`sparse`, `full`)."""
    blocks = mass_blocks(scene, poses)
    dofs = np.arange(6 * len(blocks)).reshape(-1, 2, 3)
    rows, columns = np.broadcast_arrays(dofs[..., None], dofs[:, :, None])
    places = np.nonzero(blocks)
    return form(blocks[places], rows[places], columns[places], (dofs.size, dofs.size))


def mass_blocks(scene, poses: ParticlePoses) -> np.ndarray:
    """Return the blocks (n, 2, 3, 3) of the mass matrix of all n particles of a scene at `poses`,
    in global axes: that of the mass (kg), then that of the inertia (kg m²)."""
    blocks = np.zeros((len(scene.mass), 2, 3, 3))
    blocks[:, 0] = scene.mass[:, None, None] * np.eye(3)
    blocks[:, 1] = poses.frame * scene.inertia[:, None] @ poses.frame.transpose(0, 2, 1)
    return blocks


def _reopen(scene, hinge):
    """A hinge with the opening of the scene's current poses."""
    return replace(hinge, opening=opening_at(scene, hinge))


def _gap_text(gap: float, tilt: float) -> str:
    """By how much a joint is open, in words."""
    sizes = [f"{gap:.3g} m"] * (gap > 0) + [f"{tilt:.3g} rad"] * (tilt > 0)
    return f"{' and '.join(sizes) or '0 m'} apart"
