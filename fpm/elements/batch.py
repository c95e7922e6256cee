"""Scenes of one topology to kernel arrays: numbers of several scenes side by side in SIMD lanes.

Only numbers of the scenes may differ (fpm/solver/pack.py). The last scene fills the lanes that are
left over; their results are dropped."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple, Protocol

import numpy as np

from fpm.elements.reads import SceneList
from fpm.errors import SceneError
from fpm.kernels import layout
from fpm.kernels.layout import WIDTH
from fpm.kernels.world import Log, Record, World

ROUNDINGS = 64.0
"""Error of a place (of the scene's size) and of an angle (rad) in a step, in last bits; 16
where no conditions of joints repeat each other, which the solution of a locked loop amplifies."""

BLOCK = 1 << 13
"""Number of numbers for which memory is taken at once: that of the arrays of a small scene."""

WORK = 1000.0
"""Factor by which the work of loads on such ways is scaled where nothing else has energy: the error
of that on a driven body, which the drive takes back, is ten times as large, and the balance allows
a hundredth of the scale."""

GAP_TOL = 1e-11
"""Largest gap, as a share of the scene's size, or angle (rad) of joints that is left at the start
where parts were forced together or brought into equilibrium; the first steps close it."""


PARTICLE_FIELDS = ("position", "frame", "velocity", "spin", "mass", "inertia", "fixed")
"""Arrays of a scene with a row for each particle."""


def blank(size: int) -> np.ndarray:
    """Return `size` zeros whose memory begins at a multiple of 64 bytes, for fast kernels."""
    buffer = np.zeros(8 * size + 64, np.uint8)
    offset = -buffer.ctypes.data % 64
    return buffer[offset : offset + 8 * size].view(np.float64)


class SceneData(Protocol):
    """What element types read of a scene (fpm.Scene), as a protocol for type checkers; n particles.
    position (n, 3) m; frame (n, 3, 3): axes of each as columns; unstrained: frames without strain,
    None: `frame`; velocity (n, 3) m/s and spin (n, 3) rad/s, along global axes; mass (n,) kg;
    inertia (n, 3) kg m², about own axes; fixed (n, 6): whether held along and about global axes;
    kinds: elements by type; hinges: all of them; curves: of time (fpm.scenes.curve.Curve); points:
    named ones, each as its particle and the arm to it (VirtualBeam); bearings: moment of friction
    for each N of the joint's force (m; slides: no unit), by index of the hinge."""

    position: np.ndarray
    frame: np.ndarray
    unstrained: np.ndarray | None
    velocity: np.ndarray
    spin: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    fixed: np.ndarray
    kinds: dict[type[Any], list]
    hinges: list
    curves: list
    points: dict[str, Any]
    bearings: Counter[int]


class Slices:
    """Where the rows of each key, as an element type, lie in an array that several share. sizes
    (argument): number of rows by key, in order; slices: slice of each key; count: of all rows."""

    def __init__(self, sizes: dict):
        ends = np.cumsum([0, *sizes.values()])
        self.count = int(ends[-1])
        self.slices = {key: slice(int(a), int(b)) for key, a, b in zip(sizes, ends, ends[1:])}  # noqa: B905


class Batch:
    """Scenes that differ in numbers only, while they are packed into the arrays that kernels take.

    scenes: one for each sample simulated side by side (lane); scene: the first, for what is equal
    in all; kinds: their element types, in order; instants: number of recorded ones; room: number of
    events of each scene for which there is room; moved_particles, free: indices of the particles
    that some element type moves itself, and of the others."""

    def __init__(
        self,
        scenes: Sequence[SceneData],
        kinds: Sequence[type[Any]],
        instants: int,
        room: int,
    ):
        self.scenes = SceneList(scenes)
        self.instants = instants
        self.scene = scenes[0]
        self.kinds = kinds
        self.moved_particles = {p for kind in self.kinds for p in kind.moved_particles(self.scene)}
        self.free = [p for p in range(len(self.scene.position)) if p not in self.moved_particles]
        self._blocks, self._end = [blank(BLOCK)], 0
        self._parts: dict[type, NamedTuple] = {}
        # Energies given, then taken: one account for all element types with the same.
        works = dict.fromkeys(filter(None, (kind.gives for kind in self.kinds)))
        losses = dict.fromkeys(filter(None, (kind.takes for kind in self.kinds)))
        self.givers, self.accounts = len(works), [*works, *losses]
        self.watches = Slices({kind: len(kind.watches) for kind in self.kinds})
        of_kinds = [kind for kind in self.kinds if kind.stores or kind.watches]
        self.rows = Slices({kind: len(kind.names(self.scene)) for kind in of_kinds})
        eventful = {k: len(k.eventful(self.scene)) for k in self.kinds if k.events}
        self.eventful = Slices(eventful)
        self._peaks = self.blank(1, self.watches.count)
        self._rows = self.blank(self.rows.count, 1)
        self.events = np.full((room, 3, WIDTH), np.nan)
        self.event_count = np.zeros(WIDTH, np.int64)

    # -- arrays of numbers that differ from scene to scene ----------------------------------------

    def blank(self, rows: int, columns: int) -> np.ndarray:
        """Return zeros (rows, columns, lanes), the last axis for samples side by side."""
        count, first = rows * columns * WIDTH, self._end
        if 4 * count > BLOCK:  # as what is recorded over time
            self._blocks.insert(0, blank(count))
            return self._blocks[0].reshape(rows, columns, WIDTH)
        if first + count > BLOCK:
            self._blocks.append(blank(BLOCK))
            first = 0
        line = 64 // self._blocks[-1].itemsize
        self._end = first + -(-count // line) * line
        return self._blocks[-1][first : first + count].reshape(rows, columns, WIDTH)

    def filled_blocks(self) -> list[np.ndarray]:
        """Return the memory of all arrays made so far, as few flat arrays."""
        return [*self._blocks[:-1], self._blocks[-1][: self._end]]

    def stack(self, rows: int, columns: int, function: Callable[[SceneData], object]) -> np.ndarray:
        """Return an array (rows, columns, lanes) of numbers that differ from scene to scene.
        function(scene): returns those of one, (rows, columns); further lanes repeat the last."""
        array, last = self.blank(rows, columns), len(self.scenes) - 1
        if rows:
            numbers, count = self.scenes.share(function)
            array[:, :, :count] = np.asarray(numbers)[:, :, None]
            for s in range(count, last + 1):
                array[:, :, s] = function(self.scenes[s])
            array[:, :, last + 1 :] = array[:, :, last, None]
        return array

    def table(self, kind: type[Any], columns: int, row: Callable) -> np.ndarray:
        """Return an array (elements, columns, lanes) with some numbers of every element of a type.
        kind: the element type; columns: how many of each; row(element): returns those of one."""
        count = len(kind.find(self.scene))
        return self.stack(count, columns, lambda scene: [row(e) for e in kind.find(scene)])

    # -- arrays that are the same for all lanes ---------------------------------------------------

    @staticmethod
    def integers(values: Iterable, columns: int | None = None) -> np.ndarray:
        """Return the whole numbers `values` as an array (n,), or (n, columns) if `columns` is not
        None, for kernel arrays that are the same for all samples, as indices."""
        shape = (-1,) if columns is None else (-1, columns)
        return np.array(list(values), np.int64).reshape(shape)

    # -- what kinds share -------------------------------------------------------------------------

    def part(self, kind: type[Any]) -> NamedTuple:
        """Return the arrays of an element type for its kernels, a named tuple. It is packed at the
        first call (kind.pack); later calls return the same object. kind: the element type."""
        if kind not in self._parts:
            self._parts[kind] = kind.pack(self)
        return self._parts[kind]

    def work_account(self, kind: type[Any]) -> int:
        """Return the column of World.accounts for the work (J) that elements of `kind` give."""
        return self.accounts.index(kind.gives)

    def loss_account(self, kind: type[Any]) -> int:
        """Return the column of World.accounts for the energy (J) that `kind` takes out."""
        return self.accounts.index(kind.takes)

    def peaks_of(self, kind: type) -> np.ndarray:
        """Return a view (1, criteria, lanes) of World.peaks: largest values so far of what may fail
        runs with element type `kind`, in the order of kind.watches. Kernels write to it."""
        return self._peaks[:, self.watches.slices[kind]]

    def rows_of(self, kind: type) -> np.ndarray:
        """Return a view (elements, 1, lanes) of World.rows: for each element of type `kind` its
        energy or watched quantity, which kernels write once a run has failed, to name the worst."""
        return self._rows[self.rows.slices[kind]]

    def log_of(self, kind: type) -> Log:
        """Return the log into which kernels of an element type `kind` write events: the arrays that
        all types share (time, element, number of the event), and `first`, the index of the type's
        first element among the elements of all types with events."""
        first = self.eventful.slices[kind].start
        return Log(self.events, self.event_count, first, self.blank(2, 1))

    # -- the whole --------------------------------------------------------------------------------

    def parts(self) -> tuple:
        """Return the arrays of all element types, a named tuple for each, in their order: what the
        time loop takes as `parts`. Raises TypeError for a type with an energy `stores` but no
        kernel for it, or the reverse, as the energies would stand in wrong columns."""
        from fpm.kernels.hooks import KERNELS

        for kind in self.kinds:
            has_kernel = (type(self.part(kind)), "sum_energies") in KERNELS
            if (kind.stores is None) == has_kernel:
                lack, rest = "`stores`", "a kernel for energy_of or sum_energies"
                lack, rest = (lack, rest) if has_kernel else (rest, lack)
                raise TypeError(f"kind {kind.__name__} has {rest} and not {lack}; expected: both")
        return tuple(self.part(kind) for kind in self.kinds)

    def world(self) -> World:
        """Return the state that the time loop starts with: arrays of the particles, curves of time,
        named points, and what element types share (accounts of energy, watched quantities)."""
        scene, n, points = self.scene, len(self.scene.position), self.scene.points
        state, particles = self._particle_arrays()
        lengths = [len(curve.times) for curve in scene.curves]
        count = max((curve.powers.shape[1] for curve in scene.curves), default=0)
        powers = [np.pad(c.powers, ((0, 0), (0, count - c.powers.shape[1]))) for c in scene.curves]
        watches = [(kind, watch) for kind in self.kinds for watch in kind.watches]
        rows, unity = [self.rows.slices[kind] for kind, _ in watches], np.ones(WIDTH)
        return World(
            state=state,
            start_state=self.blank(n, layout.STATE),
            particles=particles,
            free=self.integers([] if any(kind.moves_free for kind in self.kinds) else self.free),
            curve_start=self.integers(np.cumsum([0, *lengths])),
            curve_time=np.concatenate([np.zeros(0), *(curve.times for curve in scene.curves)]),
            curve_value=np.concatenate([np.zeros(0), *(curve.values for curve in scene.curves)]),
            curve_power=np.concatenate([np.zeros((0, count)), *powers]),
            curve_sum=np.concatenate([np.zeros(0), *(curve.sums for curve in scene.curves)]),
            curve_kink=np.concatenate([np.zeros(0), *(curve.kinks for curve in scene.curves)]),
            point_particle=self.integers(p.particle for p in points.values()),
            point_arm=self.stack(len(points), 3, lambda s: [p.arm for p in s.points.values()]),
            accounts=self.blank(1, len(self.accounts)),
            givers=self.givers,
            sums=self.blank(1, layout.SUMS),
            peaks=self._peaks,
            size=(size := self.stack(1, 1, lambda s: [[size_of(s)]])),
            resistance=self.stack(1, 1, lambda s: [[1.0]]),
            most=np.array(
                [w.most * (size[0, 0] if w.of_size else unity) for _, w in watches]
            ).reshape(-1, WIDTH),
            unconditional=np.array([watch.unconditional for _, watch in watches], bool),
            watch_rows=self.integers(((r.start, r.stop) for r in rows), 2),
            rows=self._rows,
            undecided=self.integers([0]),
        )

    def _particle_arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """State (n, STATE, lanes) and constants (n, PARTICLE, lanes) of all particles at their
        start: of all scenes as if they were one, with their particles one after the other."""
        is_shared = self.scenes.count_same(PARTICLE_FIELDS) == len(self.scenes)
        scenes = self.scenes[:1] if is_shared else self.scenes
        whole = join_particles(scenes)
        inertia = turns_of(whole).inertia

        def in_lanes(rows: np.ndarray) -> np.ndarray:
            values = rows.reshape(len(scenes), len(self.scene.position), rows.shape[1])
            array = self.blank(*values.shape[1:])
            array[:, :, : len(scenes)] = values.transpose(1, 2, 0)
            array[:, :, len(scenes) :] = values[-1][:, :, None]
            return array

        return in_lanes(_state(whole, inertia)), in_lanes(_particles(whole, inertia))

    def record(self, step: float, steps: int) -> Record:
        """Return the empty arrays (Record) into which the time loop records. step: time step (s);
        steps: number of steps of the run, both to estimate the energy that rounding makes."""
        rows = self.instants + 1
        energies = layout.ACCOUNTS + len(self.accounts) + sum(bool(k.stores) for k in self.kinds)
        worst = np.zeros(WIDTH)
        worst[len(self.scenes) :] = np.inf  # the lanes that only fill up are never looked at
        return Record(
            points=self.blank(rows * len(self.scene.points), layout.POINT),
            energies=self.blank(rows, energies),
            failed_step=np.full(WIDTH, -1, np.int64),
            failed_cause=np.zeros(WIDTH, np.int64),
            failed_row=np.zeros(WIDTH, np.int64),
            failed_balance=np.zeros(WIDTH),
            failed_peaks=np.zeros((self.watches.count, WIDTH)),
            failed_scale=np.zeros(WIDTH),
            failed_turns=np.zeros((len(self.scene.position), WIDTH)),
            turns=self.blank(len(self.scene.position), 1),
            quiet=np.zeros(WIDTH, np.int64),
            scale=self._least_scale(step, steps),
            worst=worst,
        )

    def _least_scale(self, step: float, steps: int) -> np.ndarray:
        """Energy (lanes,) that rounding may hold in a scene at rest. Joints close in every step
        what rounding opened, which adds up as a random walk; of so much way forces do work. At a
        stable step no spring has more energy of so much strain than masses have of such motion.
        Where all particles are held or driven no motion can grow: the balance proves nothing."""
        gap = ROUNDINGS * np.finfo(float).eps * math.sqrt(steps)

        def scale_in(scene: SceneData) -> float:
            free = ~scene.fixed.all(axis=1)
            if not free.any():
                return np.inf
            reach = np.abs(scene.position).max(initial=0.0)
            inertia = scene.mass[free].sum() * reach**2 + scene.inertia[free].max(axis=1).sum()
            moment = reach * sum(kind.held_up(scene) for kind in self.kinds)
            moment += sum(kind.held_round(scene) for kind in self.kinds)
            start_gap = gap if scene.unstrained is None else max(gap, GAP_TOL)
            return WORK * gap * moment + 0.5 * inertia * (start_gap / step) ** 2

        scale = np.zeros(WIDTH)
        scale[: len(self.scenes)] = [*self.scenes.map(scale_in)]
        return scale


def join_particles(scenes: Sequence[SceneData]) -> SimpleNamespace:
    """Return the particles of scenes, those of one after those of another, as if of one scene: a
    namespace with arrays of PARTICLE_FIELDS, and no elements as `kinds`."""
    fields = {k: np.concatenate([getattr(s, k) for s in scenes]) for k in PARTICLE_FIELDS}
    return SimpleNamespace(**fields, kinds={})


def _state(scene: SceneData, inertia: np.ndarray) -> np.ndarray:
    """Return the state (n, STATE) of particles at their start, by their effective inertias."""
    state = np.zeros((len(scene.position), layout.STATE))
    state[:, layout.X : layout.X + 3] = scene.position
    state[:, layout.D2 : layout.D2 + 3] = scene.frame[:, :, 1]
    state[:, layout.D3 : layout.D3 + 3] = scene.frame[:, :, 2]
    free = np.logical_not(scene.fixed)
    state[:, layout.V : layout.V + 3] = scene.velocity * free[:, :3]
    local = np.einsum("nji,nj->ni", scene.frame, scene.spin * free[:, 3:])
    state[:, layout.P : layout.P + 3] = np.einsum("nij,nj->ni", scene.frame, inertia * local)
    return state


def size_of(scene: SceneData) -> float:
    """Return the characteristic length (m) of a scene, to which tolerances are relative: the
    largest extent, along a global axis, of the points at joints and of particles that are not held,
    or the largest radius of gyration if that is more; 1 if both are 0."""
    free = ~scene.fixed.all(axis=1)
    joints = (e for kind in scene.kinds if kind.joins for e in scene.kinds[kind])
    beams = [beam for element in joints for beam in element.beams]
    ends = np.array([beam.end_in(scene) for beam in beams])
    places = np.concatenate([ends.reshape(-1, 3), scene.position[free]])
    extent = places.max(axis=0) - places.min(axis=0) if len(places) else 0.0
    gyration = np.sqrt(scene.inertia[free].max(axis=1) / scene.mass[free])
    return float(max(np.max(extent), gyration.max(initial=0.0))) or 1.0


def _particles(scene: SceneData, inertia: np.ndarray) -> np.ndarray:
    """Constants (n, PARTICLE) of the particles of one scene. inertia: as of `_state`."""
    rows = np.zeros((len(scene.position), layout.PARTICLE))
    rows[:, layout.MASS] = scene.mass
    rows[:, layout.IM] = np.where(scene.fixed[:, :3].all(axis=1), 0.0, 1.0 / scene.mass)
    no_turn = np.all(scene.fixed[:, 3:], axis=1, keepdims=True)
    rows[:, layout.IJ : layout.IJ + 3] = np.where(no_turn, 0.0, 1.0 / inertia)
    return rows


TOLERANCE = 1e-12
"""Share by which inertias that are alike may differ, by rounding."""


class RotationAxes(NamedTuple):
    """How supports let the n particles of a scene turn. inertia (n, 3): moments of inertia (kg m²)
    about own axes; of a particle that turns about a single global axis that about this, repeated;
    no_turn (n, 3): whether it never turns about an own axis."""

    inertia: np.ndarray
    no_turn: np.ndarray


def turns_of(scene) -> RotationAxes:
    """Return how the supports of a scene let its particles turn. Raises SceneError for one that
    turns about two axes with unequal inertias."""
    fixed = scene.fixed[:, 3:]
    count, inertia = fixed.sum(axis=1), scene.inertia.copy()
    no_turn = np.repeat(count[:, None] == 3, 3, axis=1)
    for p in np.flatnonzero(count == 2):
        squares = scene.frame[p][~fixed[p]][0] ** 2
        inertia[p] = squares @ inertia[p]
        no_turn[p] = (squares < TOLERANCE) & (squares.max() > 1 - TOLERANCE)
    is_unequal = inertia.max(axis=1) - inertia.min(axis=1) > TOLERANCE * inertia.max(axis=1)
    for p in np.flatnonzero((count == 1) & is_unequal):
        raise SceneError(
            f"rotations of particle {p}, held about {'xyz'[fixed[p].argmax()]} alone",
            inertia[p].tolist(),
            "two or three axes, the same inertia about all of its own, or a joint to the ground, "
            "as a universal one, that holds them",
        )
    return RotationAxes(inertia, no_turn)
