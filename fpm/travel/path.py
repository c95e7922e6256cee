"""Path of an assembly, quasi-static steps of an opening, on one branch of solutions."""

from collections.abc import Sequence
from copy import copy
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np

from fpm.assembly.conditions import NORMAL, Conditions, ParticlePoses, conditions_of
from fpm.assembly.element_forces import BalanceForces, ElementForces, displacement
from fpm.assembly.matrices import full, scale_matrix, sparse
from fpm.assembly.search import FARTHEST, MisfitError, StaticEquations
from fpm.elements.cross import cross
from fpm.elements.openings.opening import opening_at, rate_at
from fpm.errors import SceneError
from fpm.travel.components import components_of

FRICTION_STEPS, LOCKING_DETERMINANT = 8, 1e-3
"""Number of steps in which the friction of bearings is raised to its full value, and determinant of
the forces' equations below which a bearing locks itself."""

SOFT, STIFF = 1e-8, 1e-13
"""What decides motions that nothing stiffens, as shares of the stiffness of springs and their like,
and at least of that of bars."""

MAX_ITERATIONS = 40
"""Number of iterations of Newton's method, at most."""

TINY = 1e-300
"""Least force or moment (N, N m) by which is divided, so that nothing is divided by zero."""


def balance_of(scene) -> BalanceForces:
    """Return the forces in static equilibrium of a scene: those of its elastic bars and of all
    elements that store energy or load it, not of those that only resist, as friction."""
    by_kind: dict[type, list] = {}
    for part in components_of(scene):
        if not part.drags:
            by_kind.setdefault(type(part.element), []).append(part.element)
    return BalanceForces(scene, [ElementForces(scene, elements) for elements in by_kind.values()])


def forces_with_friction(
    base: Sequence[np.ndarray], slopes: Sequence[np.ndarray]
) -> tuple[np.ndarray, bool]:
    """Return forces F (b,) N in bearings whose own friction loads them further, F_i = |base_i +
    slopes_i F|, and whether there is a solution. base, slopes: by bearing (r,) N and (r, b). It is
    followed by Newton's method from no friction on; where the equations become singular, a bearing
    locks itself."""
    forces = np.array([np.linalg.norm(x) for x in base])
    for factor in np.linspace(0.0, 1.0, 1 + FRICTION_STEPS)[1:]:
        for _ in range(MAX_ITERATIONS):
            joint_forces = [x + factor * c @ forces for x, c in zip(base, slopes, strict=True)]
            size = np.array([np.linalg.norm(x) for x in joint_forces])
            rows = zip(joint_forces, slopes, size, strict=True)
            jacobian = np.eye(len(size)) - factor * np.stack(
                [x @ c / max(f, TINY) for x, c, f in rows]
            )
            if np.linalg.det(jacobian) < LOCKING_DETERMINANT:
                return forces, False
            change = np.linalg.solve(jacobian, size - forces)
            forces = np.maximum(forces + change, 0.0)
            if np.abs(change).max() <= 1e-10 * forces.max(initial=TINY):
                break
        else:
            return forces, False
    return forces, True


MOTION_TOLERANCE = 1e-8
"""Largest motion of the last round at a position, as a share of the size, or turn (rad). The way on
is that before it, where bars may be strained by as much, which stiffens thin ones in bending."""

RIGID_TOLERANCE = 1e-10
"""Largest motion of a round after which there is no other where no bars are, which have no strain.
"""

PREDICTOR_WEIGHTS = ([1], [3, -1], [23, -16, 5], [55, -59, 37, -9])
"""Weights of the last motions, by how many there are, in that to the next position (Adams and
Bashforth)."""

RATE_TOLERANCE = 0.2
"""By how much a motion between two positions may differ from the mean of the rates at both, as a
share of itself; beyond, it is halved, as it may have come upon another assembly of the same joints.
"""

MAX_DENSE = 20
"""Number of particles up to which matrices are full, not sparse."""

MAX_HALVED_MOTIONS = 1000
"""Number of motions that are halved on a whole way, at most; a jump takes some 300, with those
about it."""

MAX_HALVINGS = 14
"""How often a motion is halved at most: where two assemblies meet closer than that, it goes on
straight."""

DRIFT_TOLERANCE = 1e-9
"""Share of the largest rate of a condition, in a motion of the whole, below which it has none."""

COUPLING_TOLERANCE = 0.1
"""By how much the rate of a coupled opening may differ from that of the one that leads it."""

FREEDOM_TOLERANCE = 1e-3
"""By how much the rates of openings may differ, as a share of the largest, with other masses: where
they differ by more, it is not the opening alone that decides the motion."""


class Path(StaticEquations):
    """Moves an opening of a scene slowly, through static equilibria: `poses` of n particles, the
    `opening` (rad, m), and `tangent`, the motion (6n,) of all particles per unit of it. openings:
    hinges or slides that move together; locked: hinges held as at the start."""

    def __init__(self, scene, openings: Sequence[str], locked: Sequence[str]):
        self._key = f"opening {openings[0]}"
        conditions = conditions_of(scene, [*locked, *openings])
        form = full if len(scene.mass) <= MAX_DENSE else sparse
        super().__init__(scene, balance_of(scene), conditions, form)
        by_name = {hinge.name: hinge for hinge in scene.hinges}
        self._hinges = [by_name[name] for name in openings]
        self.opening = self._start = float(self._hinges[0].opening)
        self.poses = ParticlePoses(scene.position.copy(), scene.frame.copy())
        self._path_rows = len(locked) + len(openings)
        self._zeros = self._conditions.gaps(self.poses)[-len(openings) :]
        self._impulses = np.zeros(len(self._weight))
        self._free = self._free_rows(self.poses)
        self.tangent = np.zeros(len(self._scales))
        self._tangents: list[np.ndarray] = []
        self._halvings = 0
        self._rows: Any = None
        self._jumps: list[float] = []  # openings at which the motion left its path
        self._openings = [float(hinge.opening) for hinge in scene.hinges]
        bars, elements, _ = self.balance.sizes(self.poses, self._scales)
        self._ease = max(STIFF * bars, SOFT * elements) or 1.0

    def move_to(self, value: float, depth: int = 0) -> None:
        """Move the opening (joint coordinate) to `value` (rad, m) in static equilibrium, in smaller
        steps if one would leave the branch of solutions. depth: how often the step was halved, 0
        for callers. MisfitError if it cannot be moved, SceneError if motions jump too often."""
        state, tangents = self.state(), self._tangents
        low, high = sorted((state[1], value))
        is_past_jump = any(low <= jump <= high for jump in self._jumps)
        is_unchecked = is_past_jump or not tangents or value == state[1]
        try:
            self._step(value)
            if is_unchecked or self._stays(state, tangents):
                return
            if depth == MAX_HALVINGS:  # whatever lies between, it jumps here
                self._jumps.append(value)
                return
        except MisfitError:
            if is_unchecked or depth == MAX_HALVINGS:
                raise
        self.restore(state)
        self._tangents = tangents
        self._halvings += 1
        if self._halvings > MAX_HALVED_MOTIONS:
            allowed = "a way on which motions agree with the rates at their ends; here they jump"
            raise SceneError(self._key, f"{value:.6g}", f"{allowed} from place to place")
        self.move_to(0.5 * (state[1] + value), depth + 1)
        self.move_to(value, depth + 1)

    def _stays(self, state: tuple, tangents: Sequence[np.ndarray]) -> bool:
        """Return whether the last motion agrees with the rates at both ends, and stayed on its
        branch: where two meet, the conditions' derivatives have the other orientation on the
        other."""
        step = self.opening - state[1]
        motion = displacement(state[0], self.poses) / self._scales
        rates = 0.5 * step * (tangents[0] + self.tangent) / self._scales
        size = max(np.abs(motion).max(), np.abs(rates).max())
        if np.abs(motion - rates).max() > RATE_TOLERANCE * size + MOTION_TOLERANCE:
            return False
        first = self._derivatives(state[0]) if state[-1] is None else state[-1]
        last = self._rows = self._derivatives(self.poses)
        if first.shape[0] >= first.shape[1]:
            first, last = first.T, last.T
        sign = np.linalg.slogdet(first @ last.T)[0]
        return sign >= 0

    def _derivatives(self, poses: ParticlePoses) -> np.ndarray:
        """Return the scaled derivatives (c, f) of the conditions."""
        rows = self._conditions.jacobian(poses, full)
        return scale_matrix(rows, self._weight, self._scales)[:, self._free]

    def _step(self, value: float) -> None:
        """Lead the opening to a value (rad, m) in one step; MisfitError where that fails."""
        step, conditions = value - self.opening, self._conditions_at(value)
        weights = PREDICTOR_WEIGHTS[len(self._tangents) - 1] if self._tangents else []
        prediction: Any = sum(
            w / sum(weights) * t for w, t in zip(weights, self._tangents, strict=True)
        )
        poses = self.poses.displace(step * prediction) if self._tangents else self.poses
        was_small = False
        for _ in range(MAX_ITERATIONS):
            solve, gradient = self._equations(poses, conditions)
            gap_changes = -self._weight * conditions.gaps(poses)
            motion, change = solve(-gradient, gap_changes)
            largest = np.abs(motion).max(initial=0.0)
            if not np.isfinite(largest):
                break
            factor = min(1.0, FARTHEST / largest) if largest > 0 else 1.0
            poses = poses.displace(factor * self._scales * motion)
            self._impulses = self._impulses + factor * change
            gap = np.abs(gap_changes).max(initial=0.0)
            is_small = largest <= MOTION_TOLERANCE and gap <= MOTION_TOLERANCE
            is_exact = not self.scene.beams and largest <= RIGID_TOLERANCE
            if is_small and (was_small or is_exact):
                self.poses, self.opening, self.tangent = poses, value, self._motion(solve)
                self._solve, self._rows = solve, None
                self._tangents = [self.tangent, *(self._tangents[:3] if step else [])]
                self.balance.follow(poses)
                return
            was_small = is_small  # one more round, but where nothing is strained
        allowed = "openings that it can reach quasi-statically, with all joints closed; from"
        allowed += f" {self._start:.6g} it gets no further, so end before, unless others have to be"
        allowed += " `locked` as nothing decides them"
        raise MisfitError(self._key, f"{value:.6g}", allowed)

    def state(self) -> tuple:
        """Return the state of the path, a tuple for `restore`: poses, opening, tangent, impulses in
        the joints, openings of all hinges, and derivatives of the conditions, None: not known."""
        place = self.poses, self.opening, self.tangent
        return *place, self._impulses, self._openings, self._rows

    def restore(self, state: tuple) -> None:
        """Go back to a `state` of the path; the next step is predicted along its tangent."""
        self._tangents = self._tangents if state[1] == self.opening else [state[2]]
        self.poses, self.opening, self.tangent, self._impulses, self._openings, self._rows = state

    def update_openings(self) -> list[float]:
        """Return the joint coordinates (rad, of slides m) of all hinges at the current poses, in
        the scene's order, full turns counted on from the last call, and keep them for the next."""
        poses, openings = SimpleNamespace(**self.poses._asdict()), []
        for hinge, last in zip(self.scene.hinges, self._openings, strict=True):
            value = opening_at(poses, hinge)
            turns = 0.0 if hinge.slides else round((last - value) / (2 * np.pi))
            openings.append(value + 2 * np.pi * turns)
        for hinge in self._hinges:  # exactly
            openings[self.scene.hinges.index(hinge)] = hinge.opening + self.opening - self._start
        self._openings = openings
        return openings

    def rates(self, hinges: Sequence[int]) -> list[float]:
        """Return rates of the joint coordinates of `hinges` (indices) by the one that is moved."""
        shift, turn = self.tangent.reshape(-1, 2, 3).transpose(1, 0, 2)
        motion = SimpleNamespace(velocity=shift, spin=turn)
        return [float(rate_at(self.poses, self.scene.hinges[h], motion)) for h in hinges]

    def _opens(self, hinge: Any) -> np.ndarray:
        """Derivatives (6n,) of a hinge's opening by all particles' motions, at current poses."""
        rates = np.zeros((len(self.scene.mass), 2, 3))
        for particle, kind, axis in product(hinge.particles, range(2), range(3)):
            unit = np.zeros_like(rates)
            unit[particle, kind, axis] = 1.0
            motion = SimpleNamespace(velocity=unit[:, 0], spin=unit[:, 1])
            rates[particle, kind, axis] = rate_at(self.poses, hinge, motion)
        return rates.ravel()

    def compute_bearing_work(self, friction: np.ndarray) -> list[float]:
        """Return the virtual work (N m, N) of friction in each bearing per unit of the opening, by
        the force in its joint, in balance with all friction. friction (6n,): of other components.
        SceneError for self-locking."""
        levers = np.array(list(self.scene.bearings.values()))
        if not len(levers):
            return []
        hinges = [self.scene.hinges[number] for number in self.scene.bearings]
        rates = np.array(self.rates(list(self.scene.bearings)))
        opens = [self._opens(hinge) for hinge in hinges]
        pushes = [-b * np.sign(rate) * x for b, rate, x in zip(levers, rates, opens, strict=True)]
        gap_changes = np.zeros(len(self._weight))
        first, *changes = (self._solve(forces, gap_changes)[1] for forces in (friction, *pushes))
        joints, is_push = np.array(self._conditions.joint), self._conditions.axis_types != NORMAL
        masks = [(joints == hinge.joint) & is_push for hinge in hinges]
        for rows in masks:
            rows[-self._path_rows :] = False
        base = [(self._weight * (self._impulses + first))[rows] for rows in masks]
        slopes = [np.stack([(self._weight * x)[rows] for x in changes], axis=1) for rows in masks]
        forces, is_solved = forces_with_friction(base, slopes)
        if not is_solved:
            name = hinges[int(np.argmax(levers * forces))].name
            place = f"locks where {self._key} is {self.opening:.6g}"
            allowed = "a way on which no bearing's friction presses its joint harder than it is "
            allowed += "pushed (self-locking): less `mu`, or a way that ends before"
            raise SceneError(f"bearing {name}", place, allowed)
        return [*(-levers * forces * np.abs(rates))]

    def check(self, neighbour: float) -> None:
        """Check that the moved opening alone determines the motion of everything else; raises
        SceneError if not, or if it does so at a value `neighbour` (rad, m) only: it is singular."""
        if not self._is_decided():
            value, allowed = f"{self.opening:.6g}", "a way that begins and ends beside this value"
            allowed += ", as it is a singular position, where the motions of others are not known"
            self.move_to(neighbour)
            if not self._is_decided():
                value = "(not the only freedom)"
                allowed = "an opening that decides the motion of all others, by joints, springs or"
                allowed += " loops; let others be `locked`"
            raise SceneError(self._key, value, allowed)

    def _is_decided(self) -> bool:
        """Return whether the motion of everything does not change with the masses."""
        scene, masses = self.scene, np.linspace(1.0, 3.0, len(self.scene.mass))
        self.scene = copy(scene)
        self.scene.mass, self.scene.inertia = scene.mass * masses, scene.inertia / masses[:, None]
        solve = self._equations(self.poses, self._conditions_at(self.opening))[0]
        self.scene = scene
        rows = conditions_of(scene, [hinge.name for hinge in scene.hinges]).jacobian(self.poses)
        rates = rows[-len(scene.hinges) :] @ np.stack([self.tangent, self._motion(solve)], axis=1)
        return np.abs(np.diff(rates)).max() <= FREEDOM_TOLERANCE * np.abs(rates).max()

    def find_apart(self, openings: Sequence[str]) -> list[str]:
        """Return those of other joint coordinates, by name, that do not go as far as the one that
        is moved, at the start of the scene: no joint, spring or loop couples them to it so."""
        conditions = self._conditions_at(self.opening)
        self.tangent = self._motion(self._equations(self.poses, conditions)[0])
        rates = self.rates([[h.name for h in self.scene.hinges].index(name) for name in openings])
        pairs = zip(openings, rates, strict=True)
        return [name for name, rate in pairs if abs(rate - 1.0) > COUPLING_TOLERANCE]

    def _free_rows(self, poses: ParticlePoses) -> np.ndarray:
        """Degrees of freedom that are not held. Where the whole may drift as it is, some of the
        heaviest particle are: what acts between parts does the same work whichever moves."""
        from scipy.linalg import qr

        is_held = self.scene.fixed.ravel().copy()
        offset = poses.position - poses.position.mean(axis=0)
        drift = np.zeros((len(offset), 6, 6))
        drift[:, :3, :3] = drift[:, 3:, 3:] = np.eye(3)
        drift[:, :3, 3:] = np.cross(np.eye(3), offset[:, None] / self._size).swapaxes(1, 2)
        drift = np.reshape(drift, (-1, 6))  # lengths by the size
        rows = scale_matrix(self._conditions.jacobian(poses, full), self._weight, self._scales)
        constraints = np.vstack([rows @ drift, drift[is_held]])
        _, sizes, directions = np.linalg.svd(constraints)
        free = directions[np.sum(sizes > DRIFT_TOLERANCE * sizes.max(initial=1.0)) :]
        if len(free):
            first = 6 * int(np.argmax(self.scene.mass))
            pivots = qr(free @ drift[first : first + 6].T, pivoting=True, mode="r")[1]
            is_held[first + pivots[: len(free)]] = True
        return np.flatnonzero(~is_held)

    def _equations(self, poses, conditions):
        return self.linearise(poses, self._impulses, self._ease, conditions=conditions)

    def _motion(self, solve) -> np.ndarray:
        """Return the motion (6n,) per unit of the opening."""
        gap_changes = np.zeros(len(self._weight))
        gap_changes[-len(self._hinges) :] = [-1.0 if h.slides else 1.0 for h in self._hinges]
        return self._scales * solve(np.zeros(len(self._scales)), self._weight * gap_changes)[0]

    def _conditions_at(self, value: float) -> Conditions:
        """Conditions of all joints; the last hold prescribed openings, the first one at `value`."""
        conditions, shift, count = self._conditions, value - self._start, len(self._hinges)
        normals, arms = conditions.axis1.copy(), conditions.arms.copy()
        for row, hinge, zero in zip(range(-count, 0), self._hinges, self._zeros, strict=True):
            axis, zero_axis = hinge.axes[0], hinge.references[0]
            if hinge.slides:
                arms[row, 0] += (shift - zero) * axis
                continue
            angle = hinge.opening + shift
            normals[row] = np.cos(angle) * cross(axis, zero_axis) - np.sin(angle) * zero_axis
        return conditions._replace(axis1=normals, arms=arms)
