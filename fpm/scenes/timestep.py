"""The stable time step, a bound on the highest frequency of a scene; and what its run costs.

Theory: docs/mechanics.md, "Stable step", and for dampers "On hinges: dampers, friction". With all
hinges cut the elements keep their stiffness in their own axes, so one eigenvalue holds for the
whole motion. The fastest of two cases counts: all that always acts; and for a type that acts in one
position only, as contacts do at opening zero, the same with its elements there, without the motions
that are ruled out there (Contact.blocked_motions). To cut these hinges too would double the
frequency of a stiff contact.

What a run costs: of eight runs side by side, in nanoseconds, as measured where a register holds 256
bits (an AMD EPYC without 512), accurate to a factor of two; `machine` is the factor for this one.
Kinds of elements state theirs (`ElementType.cost`), joints solved together by their coupling."""

from collections.abc import Iterable
from functools import cache
from typing import NamedTuple

import numpy as np

from fpm.elements import Contact, Hinge, Joint, kinds_of
from fpm.elements.batch import turns_of
from fpm.elements.kind import Deformations
from fpm.scenes.scene import Scene

SAFETY = 0.9
"""Share of the stable step that is taken as time step where none is given."""

CURVE_SHARE = 0.25
"""Share of the finest feature of a curve of time that is taken as time step at most: motions over a
linear rise then have errors of up to 1 %."""

DENSE = 100
"""Up to this many degrees of freedom the eigenvalue problem is solved as a full matrix."""


class StableStep(NamedTuple):
    """Stability limit of a scene. step: largest stable time step (s), inf: none; frequency: the
    scene's highest angular frequency (rad/s); element: with most energy in its mode."""

    step: float
    frequency: float
    element: str


def deformation_modes(
    scene: Scene, step: float = np.inf
) -> tuple[Deformations, np.ndarray, list[str]]:
    """Return the r springs (Deformations) that stand for a scene's elements at the start; index
    (r,) of each one's element type among the scene's; and names of all elements, at the index in
    Deformations.element. step (s): if finite, dampers C are springs of 4 C/step, too."""
    blocks: list[Deformations] = []
    kind_of: list[np.ndarray] = []
    names: list[str] = []
    for number, kind in enumerate(kinds_of([scene])):
        springs = kind.deformations(scene)
        parts = [] if springs is None else [springs]
        if step < np.inf and (part := kind.dampings(scene)) is not None:
            parts.append(part._replace(stiffness=4.0 * part.stiffness / step))
        for part in parts:
            blocks.append(part._replace(element=part.element + len(names)))
            kind_of.append(np.full(len(part.element), number))
        if parts:
            names += kind.names(scene)
    if not blocks:
        no_rows, no_index = np.zeros((0, 12)), np.zeros(0, int)
        return Deformations(no_rows.astype(int), no_rows, no_rows[:, 0], no_index), no_index, []
    modes = Deformations(*(np.concatenate(x) for x in zip(*blocks, strict=True)))
    return modes, np.concatenate(kind_of), names


def scaled_modes(scene: Scene, deformations: Deformations):
    """Return, of a scene with its hinges cut, the sparse matrix B (r, dofs) for which B' B has the
    squares of the angular frequencies (rad/s) as eigenvalues, the element of each row, and the
    inverse masses and inertias (dofs,), 0 where held. A row is a deformation's derivative by the 12
    degrees of freedom of its element's two particles, times the root of its stiffness and the
    inverse root of their masses."""
    from scipy.sparse import csr_matrix

    dofs, values, stiffness, element = deformations
    inverse = np.where(
        np.hstack([scene.fixed[:, :3], turns_of(scene).no_turn]),
        0.0,
        1.0 / np.column_stack([np.tile(scene.mass, (3, 1)).T, scene.inertia]),
    ).ravel()
    entries = values * np.sqrt(stiffness)[:, None] * np.sqrt(inverse)[dofs]
    rows = np.repeat(np.arange(len(dofs)), 12)
    shape = (len(dofs), len(inverse))
    return csr_matrix((entries.ravel(), (rows, dofs.ravel())), shape=shape), element, inverse


def fastest(modes) -> tuple[float, np.ndarray]:
    """Return the square of the highest angular frequency (rad²/s²) of `scaled_modes`, and what each
    row contributes (r,), in proportion to its strain energy in that mode."""
    if modes.shape[0] == 0 or modes.nnz == 0:
        return 0.0, np.zeros(modes.shape[0])
    matrix = modes.T @ modes
    if matrix.shape[0] <= DENSE:
        values, vectors = np.linalg.eigh(matrix.toarray())
    else:
        from scipy.sparse.linalg import eigsh  # takes a quarter of a second

        start = np.ones(matrix.shape[0])  # fixed, so that the result is always the same
        values, vectors = eigsh(matrix, k=1, which="LA", v0=start, tol=1e-8)
    return values[-1], (modes @ vectors[:, -1]) ** 2


def find_stable_step(scene: Scene) -> StableStep:
    """Return the largest stable step of a scene at its start (StableStep), 2/ω, before any safety
    factor; infinity, element "none", without stiffness. With dampers it may be up to 1 % less."""
    limit = _limit(scene)
    if all(kind.dampings(scene) is None for kind in kinds_of([scene])):
        return limit
    # As K + 4 C/h grows at most like 1/h where h falls, the limit is not below `last` here; nor is
    # it below what is found with a step that is not above it.
    trial = min(limit.step, 1.0)
    last = min(trial, _limit(scene, trial).step ** 2 / trial)
    limit = _limit(scene, last)
    while limit.step > 1.01 * last:
        last, limit = limit.step, _limit(scene, limit.step)
    return limit


def find_curve_step(scene: Scene, duration: float) -> float:
    """Return the longest step (s) that resolves a scene's curves in a run of `duration` (s)."""
    features = [curve.find_feature(duration) for curve in scene.curves]
    return CURVE_SHARE * min(features, default=np.inf)


def _limit(scene: Scene, step: float = np.inf) -> StableStep:
    """Return the limit, if the dampers are the springs that they are at a step (s)."""
    deformations, kind_of, names = deformation_modes(scene, step)
    modes, element, inverse = scaled_modes(scene, deformations)
    kinds = kinds_of([scene])
    contacts = [n for n, kind in enumerate(kinds) if kind is Contact]
    blocked_columns = {n: Contact.blocked_motions(scene, inverse) for n in contacts}
    is_free = ~np.isin(kind_of, list(blocked_columns))
    cases = [(modes[is_free], element[is_free])]
    for number, columns in blocked_columns.items():
        acts = is_free | (kind_of == number)
        active = modes[acts]
        cases.append((active - (active @ columns) @ columns.T, element[acts]))
    candidates = [(*fastest(case), elements) for case, elements in cases]
    square, energies, element = max(candidates, key=lambda case: case[0])
    if not square > 0:
        return StableStep(np.inf, 0.0, "none")
    energy = np.bincount(element, energies, minlength=len(names))
    frequency = float(np.sqrt(square))
    return StableStep(2.0 / frequency, frequency, names[int(np.argmax(energy))])


STEP = 400.0
"""Of a step, whatever is in it."""

INSTANT = 4000.0
"""Of an instant that is recorded, with the check of the balance."""

PARTICLE = 25.0
"""Of a particle, as a rigid body that is on no beam."""

PER_SCENE, PER_STATEMENT = 0.4e-3, 0.05e-3
"""Seconds to pack a run and hand it back, and more for each thing that the scene states: a bar, a
hinge, a spring on it."""


COMPILE: dict[type | None, float] = {None: 1.2, Hinge: 2.5, Joint: 4.0}
COMPILE_OTHER = 0.6
"""Seconds to compile the time loop (None) and some kinds, and each other kind."""


def compile_seconds(kinds: Iterable[type | None]) -> float:
    """Return the estimated time (s) to compile element types once, or the time loop (None)."""
    return sum(COMPILE.get(kind, COMPILE_OTHER) for kind in kinds)


def step_seconds(scene: Scene) -> float:
    """Return the estimated core time (s) of one time step of eight runs of a scene side by side, on
    a machine with 256-bit vector units. Multiply it by `machine()` for this one."""
    on_beams = {int(p) for beams in scene.beams for p in np.unique(beams.nodes)}
    cost = STEP + PARTICLE * (len(scene.position) - len(on_beams))
    return 1e-9 * (cost + sum(kind.cost_in(scene) for kind in kinds_of([scene])))


def run_seconds(scene: Scene, steps: int, instants: int) -> float:
    """Estimate the core time (s) of one run, an eighth of eight side by side, on a machine with
    256-bit vector units; on this one, times `machine()`. steps, instants: numbers."""
    seconds = PER_SCENE + PER_STATEMENT * sum(map(len, scene.kinds.values()))
    return (steps * step_seconds(scene) + instants * 1e-9 * INSTANT) / 8 + seconds


@cache
def machine() -> float:
    """Return the factor from core times on a machine with 256-bit vector units to those on this
    one: 1/2.9 (measured) with 512 bits, 2 below 256, else 1."""
    from llvmlite.binding import get_host_cpu_features

    features = get_host_cpu_features()
    if features.get("avx512f"):
        return 1 / 2.9
    return 1.0 if features.get("avx2") else 2.0  # 128 bits: twice the instructions
