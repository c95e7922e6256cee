"""Static equilibrium at the start: the nearest stable one, downhill in energy from a position.

Weight, loads at t = 0, springs, stops, struts, cables, elastic motors and releases and the strain
of bars are in balance then; what holds openings exactly holds them. From position to position

    dU(x) + G'λ + ε M (x - x₀) = 0,   g(x) = 0

is solved by Newton's method: the implicit Euler step of a motion down the slope of the potential
energy U against a drag M in proportion to the masses (pseudo-transient continuation: Kelley and
Keyes, SIAM J. Numer. Anal. 35 (1998) 508). Turns, as rotation vectors, are dragged as shifts by the
size are, about all axes alike: with their inertias, a slender body that spins about its own axis,
at next to no cost, has U + ε M (x - x₀)²/2 without a minimum unless ε is large. ε falls while that
succeeds, so that the steps become Newton's own; it grows where Newton's method does not converge,
moves too far, or comes to what is no minimum of U + ε M (x - x₀)²/2 less than at x₀. What U changes
by is the strain energy of bars, less the work of all other forces on the way, which need no
potential. They come from the elements' own kernels, their stiffness from differences of these.
Friction and dampers give no force at rest; latches have not caught."""

from collections.abc import Mapping
from copy import copy
from dataclasses import replace
from typing import NamedTuple, NoReturn

import numpy as np

from fpm import assembly
from fpm.assembly.conditions import ParticlePoses, conditions_of
from fpm.assembly.element_forces import BalanceForces, ElementForces, acts
from fpm.elements import Drag, Journal, Load, Motor, Release, Stop, TorsionSpring, kinds_of
from fpm.elements.bars.beam_limits import BEND, STRAIN
from fpm.elements.openings.opening import opening_at

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
"""ε at first, as a share of the largest force; its factors after a position that was found, and
after one that was not."""

STIFFER = 1e16
"""Largest ε over the stiffness at the start: stops that are met on the way are stiffer."""

PLACES, WEIGHTS = np.polynomial.legendre.leggauss(3) * np.array([[0.5], [0.5]]) + np.array(
    [[0.5], [0.0]]
)
"""Places between 0 and 1, and weights, of three points that integrate polynomials of degree 5."""


class Equilibrium(NamedTuple):
    """Result of bringing a scene into static equilibrium (`balance`). openings: joint coordinates
    of scene.hinges before (rad; m of slides); imbalance: largest force (N) or moment (N m) left on
    a particle; largest: that elements of one type give on one; energy: strain energy of bars (J);
    motion: farthest that a particle moved (m); positions: on the way."""

    openings: tuple[float, ...]
    imbalance: float
    largest: float
    energy: float
    motion: float
    positions: int


def balance(scene, hold: Mapping[str, float]) -> None:
    """Bring a scene (changed in place) into static equilibrium, at the nearest stable position
    downhill in energy; scene.equilibrium becomes the result (Equilibrium).

    Joints stay closed, and beams keep lengths and axes without stress. hold: joint coordinates
    (rad; m of slides) of hinges, by name, that are held, to which they are led where they are
    elsewhere; what moves or keeps openings exactly has to be among them. MisfitError where nothing
    comes to rest, as a body that falls."""
    search = _EquilibriumSearch(scene, hold)
    with np.errstate(over="ignore", invalid="ignore"):
        poses, positions = search.relax()
    openings = tuple(hinge.opening for hinge in scene.hinges)
    motion = float(np.linalg.norm(poses.position - scene.position, axis=1).max(initial=0.0))
    scene.equilibrium = Equilibrium(openings, *search.measure(poses), motion, positions)
    if scene.unstrained is None:
        scene.unstrained, scene.unstrained_position = scene.frame, scene.position
    scene.position, scene.frame = poses.position, poses.frame
    scene.hinges = [
        replace(hinge, opening=hold.get(hinge.name, hinge.opening))
        for hinge in search.potential.reopen(poses)
    ]


class Potential(BalanceForces):
    """What enters the static equilibrium at the start of a scene: bars, and all elements that store
    energy or load it, but friction and latches; pins with play neither rub nor damp. Its methods
    take `poses`, positions and frames of all n particles; elements with memory, as of full turns,
    go on from the poses followed last."""

    def __init__(self, scene):
        elements = {
            kind: kind.sweep_elements(scene)
            for kind in kinds_of([scene])
            if acts(kind) and (kind.stores or kind.gives) and kind.resists_as not in ("", "FR")
        }
        for kind, springs in _springs_at_start(scene).items():
            elements[kind] = [*kind.find(scene), *springs]
        elements[Journal] = [replace(p, friction=0.0, restitution=1.0) for p in Journal.find(scene)]
        elements[Drag] = [drag for drag in Drag.find(scene) if np.any(drag.wind)]
        sources = [
            ElementForces(scene, group, _turns(group) if kind in (Load, Drag) else ())
            for kind, group in elements.items()
            if group
        ]
        super().__init__(scene, sources)
        self._hinges, self.energy = list(scene.hinges), self.bars.energy
        self.nodes, self.unstressed = self.bars.nodes, self.bars.unstressed

    def change(self, first: ParticlePoses, last: ParticlePoses) -> float:
        """Return by how much (J) the potential energy is more at the last poses than at the first:
        the strain energy of bars, less the work of elements on the straight way there."""
        motion = _motion(first, last)
        largest = float(np.abs(motion).max(initial=0.0))
        if not np.isfinite(largest):
            return np.inf
        panels, work, memory = max(1, int(np.ceil(largest / REACH))), 0.0, self.memory()
        for panel in range(panels):
            for place, weight in zip(PLACES, WEIGHTS, strict=True):
                poses = first.displace((panel + place) / panels * motion)
                forces = sum((source.forces(poses) for source in self.sources), 0.0 * motion)
                work += weight / panels * float(forces @ motion)
        self.restore(memory)
        return self.bars.change(first, last) - work

    def reopen(self, poses: ParticlePoses) -> list:
        """Return the scene's hinges with their joint coordinates at `poses`."""
        return [replace(hinge, opening=opening_at(poses, hinge)) for hinge in self._hinges]

    def follow(self, poses: ParticlePoses) -> None:
        """Move hinges and elements on to `poses`, from which full turns are counted next time."""
        self._hinges = self.reopen(poses)
        super().follow(poses)

    def memory(self) -> tuple:
        """Return the state from which hinges and elements go on, for `restore`."""
        return self._hinges, [source.copy_history() for source in self.sources]

    def restore(self, memory: tuple) -> None:
        """Set hinges and elements back to the state that `memory` returned, as after a trial
        motion: the openings from which full turns are counted, and what elements remember of their
        motion. memory: that tuple."""
        self._hinges = memory[0]
        for source, history in zip(self.sources, memory[1], strict=True):
            source.restore(history)


def _springs_at_start(scene) -> dict[type, list]:
    """By type, springs for motors and releases that give, which are nothing else at the start; with
    backlash two stops."""
    springs = [TorsionSpring(r.hinge, r.stiffness, r.hold) for r in Release.find(scene)]
    stops = []
    for motor in Motor.find(scene):
        factor = scene.curve(motor.curve).value(0.0)
        rest = motor.start + (0.0 if motor.by_rate else motor.turn * float(factor))
        if motor.backlash is None:
            springs.append(TorsionSpring(motor.hinge, motor.stiffness, rest))
        for side, sign in (("above", 0.5), ("below", -0.5)) if motor.backlash is not None else ():
            stops.append(Stop(motor.hinge, rest + sign * motor.backlash, side, motor.stiffness))
    return {TorsionSpring: springs, Stop: stops}


def _turns(elements) -> np.ndarray:
    """Degrees of freedom of turns that change what elements at the ends of arms give."""
    return (6 * np.array([element.particle for element in elements])[:, None] + (3, 4, 5)).ravel()


def _motion(first: ParticlePoses, last: ParticlePoses) -> np.ndarray:
    """Motion (6n,), m and rad, by which `first.displace` gives `last`."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_matrix(last.frame @ first.frame.transpose(0, 2, 1)).as_rotvec()
    return np.stack([last.position - first.position, turn], axis=1).ravel()


class _EquilibriumSearch(assembly._RestSearch):
    """Search of poses in stable equilibrium of a scene with hinges held at openings, by name."""

    def __init__(self, scene, hold: Mapping[str, float]):
        from scipy.sparse import diags_array

        start = ParticlePoses(scene.position.copy(), scene.frame.copy())
        self.potential, self._targets, self._is_led = Potential(scene), dict(hold), False
        conditions = conditions_of(scene, list(hold))
        super().__init__(scene, start, conditions, self.potential, list(hold))
        mass = np.repeat(scene.mass, 6)
        share = np.minimum(mass / mass[self._free].max(initial=TINY), 1.0)
        self._mass = diags_array(share, format="csc")
        self._can_fall, self._key = True, "start"
        self._remedy = "a stated position to its side, or `curvature` of the bar,"

    def measure(self, poses: ParticlePoses) -> tuple[float, float, float]:
        """Return the largest force or moment (N, N m) that is left at `poses` and that acts there,
        and the strain energy (J) of bars."""
        impulses, sizes = self._no_gaps, self.potential.sizes(poses, self._scales)
        for _ in range(3):
            solve, gradient = self._linearise(poses, impulses, max(*sizes[:2], *sizes[2], TINY))
            impulses = impulses + solve(-gradient, self._no_gaps)[1]
        residual = np.abs(gradient[self._free]).max(initial=0.0)
        forces = self.potential.sizes(poses, np.ones_like(self._scales))[2]
        return float(residual), float(forces.max(initial=0.0)), self.potential.energy(poses)

    def _rest(self, poses):
        """Poses downhill in balance, the impulses there and the number of positions."""
        poses, impulses, count = self._descend(poses, self._no_gaps)
        if self._is_led:
            return poses, impulses, count
        self._is_led, hinges = True, self._scene.hinges
        changes = {h.name: self._targets.get(h.name, h.opening) - h.opening for h in hinges}
        lengths = [abs(changes[h.name]) / (self._size if h.slides else 1.0) for h in hinges]
        steps = int(np.ceil(max(lengths, default=0.0) / assembly.FARTHEST))
        for step in range(1, steps + 1):
            scene = copy(self._scene)
            scene.hinges = [
                replace(h, opening=h.opening + changes[h.name] * step / steps) for h in hinges
            ]
            self._conditions = conditions_of(scene, self._hold)
            poses, impulses, rounds = self._descend(poses, impulses, is_led=True)
            count += rounds
        if steps:
            poses, impulses, rounds = self._descend(poses, impulses)
            count += rounds
        return poses, impulses, count

    def _descend(self, poses, impulses, is_led: bool = False):
        """Poses downhill in balance, impulses, count; is_led: one step, whatever its energy."""
        bars, elements, forces = self.potential.sizes(poses, self._scales)
        force = float(forces[self._free].max(initial=0.0))
        stiffest, ease, motion = max(bars, elements, force), EASE_SHARE * force, self._no_force
        start = poses.position
        for count in range(1, POSITIONS + 1):
            share = RESOLUTION if count <= FIRM_POSITIONS else assembly.SOFT_SHARE
            floor = max(assembly.SOFT_SHARE * bars, share * max(elements, force)) or 1.0
            ease = max(ease, floor)
            trial = self._approach(poses, impulses, ease, ROUNDING * force)
            if trial is None or not (is_led or self._falls(poses, trial, ease)):
                if ease > STIFFER * (stiffest or 1.0):
                    break
                ease *= EASE_INCREASE
                continue
            poses, impulses, motion = trial
            self.potential.follow(poses)
            if self.potential.bars.largest(poses)[0] > FOLD:
                self._check_strains(poses)
            largest = np.abs(motion).max(initial=0.0)
            is_closed = self._gap(poses) <= assembly.GAP_TOL
            if np.abs(poses.position - start).max() > DISTANCE * self._size:
                break
            if is_led or (largest <= assembly.STEP_TOL and is_closed and ease <= floor):
                return poses, impulses, count
            ease *= max(largest / AIM, EASE_DECREASE) if largest > SMALL else 0.0
        self._refuse_motion(motion)

    def _linearise(self, poses, impulses, ease: float):
        rules = self._scales, self._free, self._weight, ease, 0.0, self._mass
        return assembly.linearise(
            self._scene, poses, self._conditions, self.potential, impulses, *rules
        )

    def _approach(self, poses, impulses, ease: float, rounding: float):
        """Poses of least energy with a drag `ease` (N m), impulses and the scaled motion; or None.
        Where forces are left of `rounding` (N m) only, nothing moves."""
        first, motion = poses, self._no_force
        for count in range(ROUNDS):
            solve, gradient = self._linearise(poses, impulses, ease)
            lacks = self._lacks(poses)
            residual = np.abs((self._scales * gradient)[self._free]).max(initial=0.0)
            if not count and residual <= rounding and self._gap(poses) <= assembly.GAP_TOL:
                return poses, impulses, motion
            step, change = solve(-gradient - ease * (self._mass @ motion) / self._scales, lacks)
            poses = poses.displace(self._scales * step)
            motion = _motion(first, poses) / self._scales
            largest, size = (np.abs(x).max(initial=0.0) for x in (step, motion))
            if not (np.isfinite(largest) and max(largest, size) <= REACH):
                return None
            impulses = impulses + change
            is_closed = self._gap(poses) <= max(CLOSE * size**2, assembly.GAP_TOL)
            if is_closed and largest <= max(CLOSE * size, assembly.STEP_TOL):
                inverse = lambda force: solve(force / self._scales, self._no_gaps)[0]  # noqa: B023, E731
                if size > SMALL and assembly._negative(inverse, len(motion), NEGATIVE).shape[1]:
                    return None
                return poses, impulses, motion
        return None

    def _falls(self, first, trial, ease: float) -> bool:
        """Whether the energy falls from first to last poses, and by as much as the drag takes."""
        last, _, motion = trial
        if np.abs(motion).max(initial=0.0) <= SMALL:
            return True
        return self.potential.change(first, last) + ease * motion @ (self._mass @ motion) / 2 <= 0

    def _least_curvature(self, poses, stiffness) -> float:
        _, elements, forces = self.potential.sizes(poses, self._scales)
        least = super()._least_curvature(poses, stiffness) + RESOLUTION * max(elements, *forces)
        return least or np.inf  # nothing acts

    def _downhill(self, poses, step):
        """Poses of less energy along a motion from unstable ones."""
        for halving in range(assembly.HALVINGS):
            shift = 0.5**halving * assembly.FARTHEST * self._scales * step
            trial = self._close(poses.displace(shift))
            if trial is not None and self.potential.change(poses, trial) < 0:
                return trial
        return poses

    def _follow(self, poses, impulses, step):
        memory = self.potential.memory()
        side = super()._follow(poses, impulses, step / np.abs(step).max())
        self.potential.restore(memory)
        return side

    def _check_strains(self, poses):
        words = ("bent or twisted", "strained")
        sizes = zip((BEND, STRAIN), self.potential.bars.largest(poses), words, strict=True)
        for watch, value, word in sizes:
            if not value <= watch.most:
                allowed = f"equilibrium, of bars that it leaves {word} by at most {watch.most:g}"
                raise assembly.MisfitError("start", f"{value:.2g} in bars that are {word}", allowed)

    def _refuse_motion(self, motion: np.ndarray) -> NoReturn:
        """Raise MisfitError for the part that moves most, on a way along which is no balance, or
        so little in each position, as of a stiff contact that turns far, that none was reached."""
        motions = motion.reshape(-1, 2, 3)
        sizes = np.linalg.norm(motions, axis=2)
        particle, kind = np.unravel_index(sizes.argmax(), sizes.shape)
        names = {
            int(p): f"bar {beams.name.partition(' from ')[0]}"
            for beams in self._scene.beams
            for p in beams.nodes.ravel()
        } | {p: f"body {name}" for name, p in self._scene.bodies.items()}
        direction = np.round(motions[particle, kind] / (sizes.max() or 1.0), 6) + 0.0
        part = names.get(int(particle), f"particle {particle}")
        verb = ("moves on along", "turns on about")[kind]
        text = f"{part} {verb} ({', '.join(f'{x:.3g}' for x in direction)})"
        allowed = "what comes to rest: by a support, joint, spring or other load against that"
        if 0 < np.abs(motion).max() < AIM / 2:
            allowed = "a stated position nearer to the balance, or softer springs and contacts: "
            allowed += f"{POSITIONS} steps towards it were too small to reach it"
        raise assembly.MisfitError(self._key, text, allowed)
