"""The stable time step: a bound on the highest frequency of a scene.

Leapfrog is stable for ``step <= 2 / omega_max``. A hinge is a constraint, and constraints only
lower the highest frequency (Rayleigh's quotient on a subspace; Courant and Hilbert I, ch. VI). With
a hinge cut, the elements keep their stiffness in their own axes however the links move, so one
eigenvalue holds for the whole motion, as long as the elements' own strains are small. These cases
are looked at, and the fastest one counts:

- all that always acts, with all hinges cut;
- for a kind that acts in one position only, as contacts do at opening zero: the same with its
  elements, there, without the motions that are ruled out there (Kind.shut). To cut these hinges too
  would double the frequency of a stiff contact: the particles beside it turn about the hinge line,
  not about their own axes.
"""

from typing import NamedTuple

import numpy as np

from fpm.kinds import kinds_of
from fpm.kinds.kind import Deformations
from fpm.scene import Scene

SAFETY = 0.9
"""Share of the stable step that is taken where no step is given."""

DENSE = 100
"""Up to this many degrees of freedom the eigenvalue problem is solved as a full matrix."""


class StableStep(NamedTuple):
    """Limit of the time step (s), the highest angular frequency (rad/s), the limiting element."""

    step: float
    frequency: float
    element: str


def deformation_modes(scene: Scene) -> tuple[Deformations, np.ndarray, list[str]]:
    """Deformations of all elements, the kind (r,) of each row, and the elements' names."""
    found, kind_of, names = [], [], []
    for number, kind in enumerate(kinds_of([scene])):
        if (part := kind.deformations(scene)) is not None:
            found.append(part._replace(element=part.element + len(names)))
            kind_of.append(np.full(len(part.element), number))
            names += kind.names(scene)
    if not found:
        none, no_index = np.zeros((0, 12)), np.zeros(0, int)
        return Deformations(none.astype(int), none, none[:, 0], no_index), no_index, []
    merged = Deformations(*(np.concatenate(x) for x in zip(*found, strict=True)))
    return merged, np.concatenate(kind_of), names


def scaled_modes(scene: Scene):
    """Sparse matrix (r, dofs) of sqrt(k) times the deformation rows times M^-1/2; element (r,).

    Its singular values are the angular frequencies (rad/s) of the scene with its hinges cut. Third:
    the inverse masses (dofs,).
    """
    deformations = deformation_modes(scene)[0]
    return _scaled(scene, deformations)


def _scaled(scene: Scene, deformations: Deformations):
    from scipy.sparse import csr_matrix

    dofs, values, stiffness, element = deformations
    inverse = np.where(
        scene.fixed, 0.0, 1.0 / np.column_stack([np.tile(scene.mass, (3, 1)).T, scene.inertia])
    ).ravel()
    entries = values * np.sqrt(stiffness)[:, None] * np.sqrt(inverse)[dofs]
    rows = np.repeat(np.arange(len(dofs)), 12)
    shape = (len(dofs), len(inverse))
    return csr_matrix((entries.ravel(), (rows, dofs.ravel())), shape=shape), element, inverse


def fastest(modes) -> tuple[float, np.ndarray]:
    """Square of the highest frequency and the share (r,) of each row in its mode's energy."""
    from scipy.sparse.linalg import eigsh

    if modes.shape[0] == 0 or modes.nnz == 0:
        return 0.0, np.zeros(modes.shape[0])
    matrix = modes.T @ modes
    if matrix.shape[0] <= DENSE:
        values, vectors = np.linalg.eigh(matrix.toarray())
    else:
        start = np.ones(matrix.shape[0])  # fixed, so that the result is always the same
        values, vectors = eigsh(matrix, k=1, which="LA", v0=start, tol=1e-8)
    return values[-1], (modes @ vectors[:, -1]) ** 2


def stable_step(scene: Scene) -> StableStep:
    """Largest stable step of a scene, before any safety factor.

    A scene without stiffness (free bodies) has no limit: infinity, frequency 0, element "none".
    """
    deformations, kind_of, names = deformation_modes(scene)
    modes, element, inverse = _scaled(scene, deformations)
    kinds = kinds_of([scene])
    always = np.array([kind.always_acts for kind in kinds], bool)
    acting = always[kind_of]
    cases = [(modes[acting], element[acting])]
    for number, kind in enumerate(kinds):
        if not kind.always_acts:
            acts = acting | (kind_of == number)
            shut, there = kind.shut(scene, inverse), modes[acts]
            cases.append((there - (there @ shut) @ shut.T, element[acts]))
    found = [(*fastest(case), of) for case, of in cases]
    square, shares, element = max(found, key=lambda case: case[0])
    if not square > 0:
        return StableStep(np.inf, 0.0, "none")
    energy = np.bincount(element, shares, minlength=len(names))
    frequency = float(np.sqrt(square))
    return StableStep(2.0 / frequency, frequency, names[int(np.argmax(energy))])
