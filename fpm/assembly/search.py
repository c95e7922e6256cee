"""Search of a stable static balance of a scene, the joints closed, downhill in energy.

Theory: docs/mechanics.md, "Parts that are forced together" (pseudo-transient continuation: Kelley
and Keyes, SIAM J. Numer. Anal. 35 (1998) 508; proximal method of multipliers: Rockafellar, Math.
Oper. Res. 1 (1976) 97). Joints are closed first. Then the search goes from
position to position against a drag ε M (x - x₀), and ε falls while that succeeds, so that the steps
become Newton's own. Where the end is unstable, both sides are followed downhill, and the lower end
is taken if they differ."""

from collections.abc import Mapping
from copy import copy
from dataclasses import replace
from typing import NamedTuple, NoReturn

import numpy as np

from fpm.assembly.conditions import Conditions, ParticlePoses, conditions_of, tilts
from fpm.assembly.element_forces import BalanceForces, displacement
from fpm.assembly.matrices import Form, largest_entry, saddle_solver, scale_matrix, sparse
from fpm.elements.bars.beam import BEND, STRAIN
from fpm.elements.batch import GAP_TOL
from fpm.elements.openings.opening import opening_at
from fpm.errors import SceneError

EASE = 1e-13
"""δ, where the largest entries of H, M and G are one."""


class StaticEquations:
    """Linear equations of Newton steps towards static balance of a scene's particles, the joints
    closed. balance: the forces; conditions: c that close the joints; form: of matrices, `full` for
    few particles."""

    def __init__(self, scene, balance: BalanceForces, conditions: Conditions, form: Form = sparse):
        self.scene, self.balance = scene, balance
        self._conditions, self._form = conditions, form
        self._size = float(np.ptp(scene.position, axis=0).max()) or 1.0
        self._scales = np.tile(np.repeat([self._size, 1.0], 3), len(scene.position))
        self._weight = conditions.weight(self._size)
        self._free = np.flatnonzero(~scene.fixed.ravel())

    def linearise(self, poses, impulses, ease, mass=None, convex=False, conditions=None):
        """Set up the equations of a step; returns a function solve(forces, gap_changes) and the
        gradient (6n,) of strain energy plus conditions times impulses.

        solve: from forces (6n,), N and N m, and gap_changes (c,) of the conditions times their
        weight, the motion (6n,), shifts by the size, and change (c,) of impulses, NaN where the
        matrix is singular. impulses (c,): Lagrange multipliers (N m); ease: stiffness (N m) by
        which the largest mass, others in proportion, holds back motions that strain nothing; mass:
        mass matrix, None: the scene's; convex: without what makes bars' energy concave; conditions:
        None: those of the object."""
        scales, free, weight, form = self._scales, self._free, self._weight, self._form
        conditions = conditions or self._conditions
        gradient, stiffness = self.balance.derivatives(poses, form, convex)
        rows, curvature = conditions.derivatives(poses, weight * impulses, form)
        stiffness, gradient = stiffness + curvature, gradient + rows.T @ (weight * impulses)
        stiffness = scale_matrix(stiffness, scales, scales)
        if mass is None:
            blocks = mass_blocks(self.scene, poses)
            dofs = np.arange(6 * len(blocks)).reshape(-1, 2, 3)
            lines, columns = np.broadcast_arrays(dofs[..., None], dofs[:, :, None])
            places = np.nonzero(blocks)
            entries = blocks[places], lines[places], columns[places]
            mass = scale_matrix(form(*entries, (dofs.size, dofs.size)), scales, scales)
        unit = max(largest_entry(stiffness), ease)
        inner = (stiffness / unit + mass * (ease / unit / mass.max()))[free][:, free]
        solve_system = saddle_solver(inner, scale_matrix(rows, weight, scales)[:, free], EASE)

        def solve(forces, gap_changes):
            solution = solve_system(np.concatenate([(scales * forces)[free] / unit, gap_changes]))
            step = np.zeros(len(scales))
            step[free] = solution[: len(free)]
            return step, unit * solution[len(free) :]

        return solve, gradient


def mass_blocks(scene, poses: ParticlePoses) -> np.ndarray:
    """Return the blocks (n, 2, 3, 3) of the mass matrix of all n particles of a scene at `poses`,
    in global axes: that of the mass (kg), then that of the inertia (kg m²)."""
    blocks = np.zeros((len(scene.mass), 2, 3, 3))
    blocks[:, 0] = scene.mass[:, None, None] * np.eye(3)
    blocks[:, 1] = poses.frame * scene.inertia[:, None] @ poses.frame.transpose(0, 2, 1)
    return blocks


STEP_TOL, FARTHEST = 1e-10, 0.1
"""Largest motion of the last round, and of one that closes joints, as a share of the size, or turn
(rad)."""

OPEN = 1e-6
"""Gap (m) or angle (rad) from which a joint is said to be open where nothing was found."""

MASS_SHARE, SOFT_SHARE = 1e-8, 1e-13
"""ε, as a share of the bars' stiffness, of rounds that close joints; and its least."""

FALLS, INSTABILITY, SAME_TOL = 4, 1e-12, 1e-6
"""Most times that an unstable position is left; the curvature from which it is unstable, as a share
of the largest entry of H; and the share by which two positions and their energies are the same."""

LANCZOS, HALVINGS, CLOSINGS = 60, 12, 60
"""Most vectors that look for such a curvature, halvings of a motion downhill, rounds that close."""

POSITIONS, FIRM_POSITIONS, ROUNDS, DISTANCE = 300, 60, 12, 20
"""Most positions on the way down; number of them in which ε may not fall to what differences of
forces do not resolve; most rounds of Newton's method for each; and how many times its size the
structure may move."""

REACH, AIM = 0.3, 0.2
"""Largest motion from one position to the next, as a share of the size, or turn (rad); and that at
which ε stays."""

CLOSE, SMALL = 1e-3, 1e-7
"""Share of a motion by which Newton's method may still move at its end; and motion (share of the
size, rad) by which the energy changes as little as it is rounded."""

RESOLUTION, ROUNDING, NEGATIVE = 2e-8, 1e-14, 1e-12
"""Share of the largest stiffness of elements that differences of their forces resolve, share of the
largest force that may be left, and share of the largest eigenvalue below which one is negative."""

TINY = 1e-100
"""Force (N m) from which one is told from none."""

FOLD = 0.7
"""Bend of an element (sine) on the way beyond which it might come to lie the other way round, where
its energy is none again."""

EASE_SHARE, EASE_DECREASE, EASE_INCREASE = 1e-2, 1 / 30, 10.0
"""ε at first, as a share of the largest force; its least factor after a position that was found,
and its largest after one that was not."""

STIFFER = 1e16
"""Largest ε over the stiffness at the start: stops that are met on the way are stiffer."""


class MisfitError(SceneError):
    """Raised for parts that cannot be forced together at their joints, or have no balance."""


class Words(NamedTuple):
    """What refusals say. key: of the file; parts: that strain too much; rest: what comes to rest;
    remedy: by which one of two sides is chosen."""

    key: str
    parts: str
    rest: str
    remedy: str


class RestSearch(StaticEquations):
    """Search of poses in stable balance of a scene's particles, the joints closed. targets: joint
    coordinates to which hinges are led, by name; balance: the forces; words: of refusals.
    Attributes: open_before, of the joint open most at the start; hinges, with openings."""

    def __init__(self, scene, targets: Mapping[str, float], balance: BalanceForces, words: Words):
        from scipy.sparse import diags_array

        self._words, self._targets, self._hold = words, dict(targets), list(targets)
        super().__init__(scene, balance, conditions_of(scene, self._hold))
        self._start = ParticlePoses(scene.position.copy(), scene.frame.copy())
        self._no_gaps, self._no_force = np.zeros(len(self._weight)), np.zeros(len(self._scales))
        mass = np.repeat(scene.mass, 6)
        share = np.minimum(mass / mass[self._free].max(initial=TINY), 1.0)
        self._mass = diags_array(share, format="csc")
        self._resolution = RESOLUTION if balance.sources else 0.0
        self.hinges, self.open_before = list(scene.hinges), self._worst(self._start)

    def relax(self) -> ParticlePoses:
        """Return the stable poses; else MisfitError."""
        if not len(self._free) and self._gap(self._start) <= GAP_TOL:
            return self._start
        start = self._close(self._start, relaxes=True)
        if self._gap(start) > (OPEN if len(self._free) else GAP_TOL):
            name, gap, tilt = self._worst(start)
            allowed = "parts that can be forced together, with this joint closed"
            raise MisfitError(f"joint {name}", _gap_text(gap, tilt), allowed)
        state, impulses = self._lead(*self._descend(start, self._no_gaps))
        self._check_strains(state)
        step = self._find_descent(state, impulses)
        if step is None:
            return state
        sides = [self._follow(state, direction) for direction in (step, -step)]
        sides = sorted((side for side in sides if side), key=lambda side: side[0])
        requirement = "a stable position; this one snaps, and none was found downhill of it"
        if sides:
            (low, lowest), (high, highest) = sides[0], sides[-1]
            shift = np.abs(lowest.position - highest.position).max()
            if not (high - low <= -SAME_TOL * low and shift > SAME_TOL * self._size):
                self._check_strains(lowest)
                return lowest
            # Both sides end apart with the same loss of energy.
            energy = self.balance.bars.energy(lowest)
            requirement = (
                f"a stable position; this one snaps to either of two with {energy:.4g} J, as "
                f"a straight bar pressed beyond its buckling load: {self._words.remedy} says to "
                "which"
            )
        energy = self.balance.bars.energy(state)
        raise MisfitError(self._words.key, f"{energy:.4g} J in an unstable position", requirement)

    def measure(self, poses: ParticlePoses) -> tuple[float, float, float]:
        """Return the largest residual force or moment (N, N m) at `poses`, the largest that acts
        there, and the strain energy (J) of bars."""
        impulses, sizes = self._no_gaps, self.balance.sizes(poses, self._scales)
        for _ in range(3):
            solve, gradient = self.linearise(poses, impulses, max(*sizes[:2], *sizes[2], TINY))
            impulses = impulses + solve(-gradient, self._no_gaps)[1]
        residual = np.abs(gradient[self._free]).max(initial=0.0)
        forces = self.balance.sizes(poses, np.ones_like(self._scales))[2]
        return float(residual), float(forces.max(initial=0.0)), self.balance.bars.energy(poses)

    def reopen(self, poses: ParticlePoses) -> list:
        """Return the scene's hinges with their joint coordinates at `poses`, next to the last."""
        return [replace(hinge, opening=opening_at(poses, hinge)) for hinge in self.hinges]

    def _worst(self, poses: ParticlePoses) -> tuple[str, float, float]:
        """Name, gap (m) and tilt (rad) of the joint that is open most."""
        gaps = self._conditions.gaps(poses)
        name, gap, tilt = self._conditions.worst(np.where(np.isfinite(gaps), gaps, np.inf))
        angle = tilts(self.scene, poses, self._hold).get(name, np.nan)
        return name, gap, angle if tilt > 0 and np.isfinite(angle) else tilt

    def _lacks(self, poses) -> np.ndarray:
        return -self._weight * self._conditions.gaps(poses)

    def _gap(self, poses) -> float:
        return float(np.abs(self._lacks(poses)).max(initial=0.0))

    def _close(self, poses, relaxes: bool = False) -> ParticlePoses:
        """Return poses at which the joints are closed; relaxes: whether forces are small there."""
        impulses = self._no_gaps
        for _ in range(CLOSINGS if len(self._free) else 0):
            if self._gap(poses) <= GAP_TOL:
                break
            ease = MASS_SHARE * self.balance.sizes(poses, self._scales)[0] or 1.0
            solve, gradient = self.linearise(poses, impulses, ease, convex=True)
            step, change = solve(-gradient if relaxes else self._no_force, self._lacks(poses))
            largest = float(np.abs(step).max(initial=0.0))
            if not np.isfinite(largest):
                break
            fraction = min(1.0, FARTHEST / largest) if largest > 0 else 1.0
            poses = poses.displace(fraction * self._scales * step)
            impulses = impulses + fraction * change * relaxes
            if relaxes:
                self._check_folds(poses)
        return poses

    def _lead(self, poses, impulses):
        """Return balanced poses with the held openings, and impulses there."""
        hinges = self.scene.hinges
        changes = [self._targets.get(h.name, h.opening) - h.opening for h in hinges]
        lengths = [
            abs(change) / (self._size if h.slides else 1.0)
            for h, change in zip(hinges, changes, strict=True)
        ]
        steps = int(np.ceil(max(lengths, default=0.0) / FARTHEST))
        for step in range(1, steps + 1):
            scene = copy(self.scene)
            scene.hinges = [
                replace(h, opening=h.opening + change * step / steps)
                for h, change in zip(hinges, changes, strict=True)
            ]
            self._conditions = conditions_of(scene, self._hold)
            poses, impulses = self._descend(poses, impulses, is_led=True)
        return self._descend(poses, impulses) if steps else (poses, impulses)

    def _find_descent(self, poses, impulses):
        """Return the motion (6n,) along which the energy falls to both sides, or None: the image of
        a vector on which the inverse of a round's matrix is negative beyond rounding."""
        scales, (bars, elements, forces) = self._scales, self.balance.sizes(poses, self._scales)
        if not max(bars, elements, *forces):
            return None
        ease = SOFT_SHARE * max(bars, elements) or 1.0
        steps = self._negative(self.linearise(poses, impulses, ease, self._mass)[0])
        _, stiffness = self.balance.derivatives(poses)
        _, curvature = self._conditions.derivatives(poses, self._weight * impulses)
        motions = scales[:, None] * steps
        falls = np.sum(motions * ((stiffness + curvature) @ motions), axis=0)
        least = INSTABILITY * largest_entry(scale_matrix(stiffness, scales, scales))
        least += self._resolution * max(elements, *forces)
        steps = steps[:, falls < -least * np.sum(steps**2, axis=0)]
        step = (steps / np.abs(steps).max(axis=0, initial=0.0)).sum(axis=1)
        return step / np.abs(step).max() if step.any() else None

    def _negative(self, solve, share: float = 0.0) -> np.ndarray:
        """Return directions (6n, k) in which `solve`, the inverse of a round's matrix, seems to be
        negative by a share of its largest eigenvalue. Lanczos' method from a fixed start finds
        them, each vector made normal to all before."""
        count = len(self._scales)
        basis = [np.random.default_rng(1).standard_normal(count)]
        basis[0] /= np.linalg.norm(basis[0])
        images: list[np.ndarray] = []
        while len(images) < min(count, LANCZOS):
            images.append(solve(basis[-1] / self._scales, self._no_gaps)[0])
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

    def _descend(self, poses, impulses, is_led: bool = False):
        """Descend in energy from `poses` to a balance; return its poses and impulses. is_led: make
        one step, whatever its energy."""
        bars, elements, forces = self.balance.sizes(poses, self._scales)
        force = float(forces[self._free].max(initial=0.0))
        stiffest, ease, motion = max(bars, elements, force), EASE_SHARE * force, self._no_force
        start = poses.position
        for count in range(1, POSITIONS + 1):
            share = self._resolution if count <= FIRM_POSITIONS else SOFT_SHARE
            floor = max(SOFT_SHARE * bars, share * max(elements, force)) or 1.0
            ease = max(ease, floor)
            trial, factor = self._approach(poses, impulses, ease, ROUNDING * force)
            if trial is None or not (is_led or self._falls(poses, trial, ease)):
                if ease > STIFFER * (stiffest or 1.0):
                    break
                ease *= factor
                continue
            poses, impulses, motion = trial
            self.balance.follow(poses)
            self.hinges = self.reopen(poses)
            self._check_folds(poses)
            largest = np.abs(motion).max(initial=0.0)
            is_closed = self._gap(poses) <= GAP_TOL
            if np.abs(poses.position - start).max() > DISTANCE * self._size:
                break
            if is_led or (largest <= STEP_TOL and is_closed and ease <= floor):
                return poses, impulses
            ease *= max(largest / AIM, EASE_DECREASE) if largest > SMALL else 0.0
        self._refuse_motion(motion)

    def _approach(self, poses, impulses, ease: float, rounding: float):
        """Poses of least energy with a drag `ease` (N m), impulses and the scaled motion, or None;
        and the factor of the drag to try next. Where forces are left of `rounding` (N m) only,
        nothing moves."""
        first, motion = poses, self._no_force
        for count in range(ROUNDS):
            solve, gradient = self.linearise(poses, impulses, ease, self._mass)
            lacks = self._lacks(poses)
            residual = np.abs((self._scales * gradient)[self._free]).max(initial=0.0)
            if not count and residual <= rounding and self._gap(poses) <= GAP_TOL:
                return (poses, impulses, motion), EASE_INCREASE
            step, change = solve(-gradient - ease * (self._mass @ motion) / self._scales, lacks)
            poses = poses.displace(self._scales * step)
            motion = displacement(first, poses) / self._scales
            largest, size = (np.abs(x).max(initial=0.0) for x in (step, motion))
            if not (np.isfinite(largest) and max(largest, size) <= REACH):
                # A first motion too far falls in proportion to the drag; any other needs much more.
                excess = largest / AIM if not count else np.inf
                return None, min(EASE_INCREASE, excess)
            impulses = impulses + change
            is_closed = self._gap(poses) <= max(CLOSE * size**2, GAP_TOL)
            if is_closed and largest <= max(CLOSE * size, STEP_TOL):
                if size > SMALL and self._negative(solve, NEGATIVE).shape[1]:
                    break
                return (poses, impulses, motion), EASE_INCREASE
        return None, EASE_INCREASE

    def _falls(self, first, trial, ease: float) -> bool:
        """Whether the energy falls from first to last poses, by as much as the drag takes."""
        last, _, motion = trial
        if np.abs(motion).max(initial=0.0) <= SMALL:
            return True
        return self.balance.change(first, last) + ease * motion @ (self._mass @ motion) / 2 <= 0

    def _follow(self, poses, step):
        """From unstable poses, to the side of a motion: the change of energy to stable poses
        downhill, and these; None where there are none."""
        start, hinges, memory = poses, self.hinges, self.balance.memory()
        try:
            for _ in range(FALLS):
                for halving in range(HALVINGS):
                    shift = 0.5**halving * FARTHEST * self._scales * step
                    trial = self._close(poses.displace(shift))
                    if self._gap(trial) <= GAP_TOL and self.balance.change(poses, trial) < 0:
                        poses = trial
                        break
                poses, impulses = self._descend(poses, self._no_gaps)
                step = self._find_descent(poses, impulses)
                if step is None:
                    return self.balance.change(start, poses), poses
        except MisfitError:
            pass
        finally:
            self.hinges = hinges
            self.balance.restore(memory)
        return None

    def _check_folds(self, poses) -> None:
        if self.balance.bars.largest(poses)[0] > FOLD:
            self._check_strains(poses)

    def _check_strains(self, poses) -> None:
        """Check strains against the limits of a run; raises MisfitError if they are larger."""
        name, gap, tilt = self.open_before
        pairs = zip((BEND, STRAIN), self.balance.bars.largest(poses), strict=True)
        for (watch, value), word in zip(pairs, ("bent or twisted", "strained"), strict=True):
            if not value <= watch.most:
                key, text = self._words.key, f"bars {word} by {value:.2g}"
                if max(gap, tilt) > OPEN:
                    key, text = f"joint {name}", _gap_text(gap, tilt)
                allowed = f"{self._words.parts} with bars {word} by at most {watch.most:g}"
                raise MisfitError(key, text, f"{allowed}, not {value:.2g}")

    def _refuse_motion(self, motion: np.ndarray) -> NoReturn:
        """Raise MisfitError for the part that moves most, on a way along which is no balance, or
        so little in each position, as of a stiff contact that turns far, that none was reached."""
        motions = motion.reshape(-1, 2, 3)
        sizes = np.linalg.norm(motions, axis=2)
        particle, kind = np.unravel_index(sizes.argmax(), sizes.shape)
        names = {
            int(p): f"bar {beams.name.partition(' from ')[0]}"
            for beams in self.scene.beams
            for p in beams.nodes.ravel()
        } | {p: f"body {name}" for name, p in self.scene.bodies.items()}
        direction = np.round(motions[particle, kind] / (sizes.max() or 1.0), 6) + 0.0
        part = names.get(int(particle), f"particle {particle}")
        verb = ("moves on along", "turns on about")[kind]
        text = f"{part} {verb} ({', '.join(f'{x:.3g}' for x in direction)})"
        allowed = self._words.rest
        if 0 < np.abs(motion).max() < AIM / 2:
            allowed = "a stated position nearer to the balance, or softer springs and contacts: "
            allowed += f"{POSITIONS} steps towards it were too small to reach it"
        raise MisfitError(self._words.key, text, allowed)


def _gap_text(gap: float, tilt: float) -> str:
    """Describe the gap of a joint."""
    sizes = [f"{gap:.3g} m"] * (gap > 0) + [f"{tilt:.3g} rad"] * (tilt > 0)
    return f"{' and '.join(sizes) or '0 m'} apart"
