"""The stable time step: a bound on the highest frequency of a scene.

Leapfrog is stable for ``step <= 2 / omega_max``. A hinge is a constraint, and constraints only
lower the highest frequency (Rayleigh's quotient on a subspace; Courant and Hilbert I, ch. VI). With
a hinge cut, the elements keep their stiffness in their own axes however the links move, so one
eigenvalue holds for the whole motion, as long as the elements' own strains are small. Two cases are
looked at, and the faster one counts:

- contacts open, all hinges cut;
- contacts shut: their hinges are closed, at opening zero wherever the scene starts, since a contact
  acts at no other opening. To cut these too would double the frequency of a stiff contact: the
  particles beside it turn about the hinge line, not about their own axes.
"""

from typing import NamedTuple

import numpy as np

from fpm.scene import Scene

DENSE = 100
"""Up to this many degrees of freedom the eigenvalue problem is solved as a full matrix."""


class StableStep(NamedTuple):
    """Limit of the time step (s), the highest angular frequency (rad/s), the limiting element."""

    step: float
    frequency: float
    element: str


def deformation_modes(scene: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Rows of the deformations of all elements at the start, in the particles' own axes.

    Returns degrees of freedom (r, 12), values (r, 12), stiffness (r, r_e) as below and the element
    of each row (r,). Per beam the rows are stretch, two bending planes in sum and difference (so
    that their stiffness is diagonal), twist; per spring or contact the opening. The stiffness (r,)
    belongs to energy 1/2 k d². Degrees of freedom of particle p: 6 p .. 6 p + 5.
    """
    dofs, values, stiffness, element = [], [], [], []
    frame = scene.frame if scene.unstrained is None else scene.unstrained
    count = 0
    for beams in scene.beams:
        table = beams.stiffness()
        a, b = beams.nodes.T
        columns = np.concatenate(
            [6 * a[:, None] + np.arange(6), 6 * b[:, None] + np.arange(6)], axis=1
        )
        n, e2, e3 = np.moveaxis(beams.triad, 2, 0)
        length, zero = beams.length[:, None], np.zeros_like(n)

        def local(v, nodes):
            return np.einsum("mji,mj->mi", frame[nodes], v)

        def row(xa, ra, xb, rb, a=a, b=b):
            return np.concatenate([xa, local(ra, a), xb, local(rb, b)], axis=1)

        rows = [(row(-n, zero, n, zero), table[:, 1]), (row(zero, -n, zero, n), table[:, 4])]
        for axis, about, k in ((e2, np.cross(e2, n), table[:, 2]),
                               (e3, np.cross(e3, n), table[:, 3])):  # fmt: skip
            # th_a^2 + th_a th_b + th_b^2 = 3/4 (th_a + th_b)^2 + 1/4 (th_a - th_b)^2
            slope = axis / length
            rows.append((row(-2 * slope, about, 2 * slope, about), 1.5 * k))
            rows.append((row(zero, about, zero, -about), 0.5 * k))
        m = len(length)
        for r, k in rows:
            dofs.append(columns)
            values.append(r)
            stiffness.append(k)
            element.append(count + np.arange(m))
        count += m
    joints = [(s.hinge, s.stiffness) for s in scene.springs]
    joints += [(c.hinge, c.stiffness) for c in scene.contacts]
    for hinge, k in joints:
        h = scene.hinges[hinge]
        one, two = h.particles
        zero = np.zeros(3)
        dofs.append(np.concatenate([6 * one + np.arange(6), 6 * two + np.arange(6)])[None])
        values.append(np.concatenate([zero, -h.axes[0], zero, h.axes[1]])[None])
        stiffness.append(np.array([k]))
        element.append(np.array([count]))
        count += 1
    if not dofs:
        return np.zeros((0, 12), int), np.zeros((0, 12)), np.zeros(0), np.zeros(0, int)
    return tuple(np.concatenate(x) for x in (dofs, values, stiffness, element))


def closed_hinges(scene: Scene, inverse: np.ndarray):
    """Orthonormal sparse columns (dofs, c): motions that the hinges with contacts rule out, shut.

    inverse (dofs,): inverse masses; the columns are in coordinates scaled with their roots. The
    relative position of two links is that of opening zero, whatever it is at the start. Hinges
    share only particles that are held, which have no inverse mass: their columns do not overlap.
    """
    from scipy.sparse import csc_matrix

    columns, dofs = [], []
    frame = scene.frame if scene.unstrained is None else scene.unstrained
    for hinge in {c.hinge for c in scene.contacts}:
        h = scene.hinges[hinge]
        shut = [
            np.column_stack([a, r, np.cross(a, r)])
            for a, r in zip(h.axes, h.references, strict=True)
        ]
        rows = []
        for sign, beam, axes in zip((1.0, -1.0), h.beams, shut, strict=True):
            turn = -np.array([np.cross(beam.arm, e) for e in np.eye(3)]).T
            point = np.hstack([axes.T @ frame[beam.particle].T, axes.T @ turn])
            tilt = np.hstack([np.zeros((2, 3)), axes.T[1:]])
            rows.append(sign * np.vstack([point, tilt]))
        on = np.concatenate([6 * p + np.arange(6) for p in h.particles])
        u, size, _ = np.linalg.svd((np.hstack(rows) * np.sqrt(inverse[on])).T, full_matrices=False)
        u = u[:, size > 1e-10 * size.max(initial=0.0)]
        columns.append(u.T)
        dofs.append(np.tile(on, (u.shape[1], 1)))
    rows = np.concatenate(dofs)
    values = np.concatenate(columns)
    column = np.repeat(np.arange(len(rows)), 12)
    return csc_matrix((values.ravel(), (rows.ravel(), column)), shape=(len(inverse), len(rows)))


def scaled_modes(scene: Scene):
    """Sparse matrix (r, dofs) of sqrt(k) times the deformation rows times M^-1/2; element (r,).

    Its singular values are the angular frequencies (rad/s) of the scene with its hinges cut. The
    contacts' rows are the last. Third: the inverse masses (dofs,).
    """
    from scipy.sparse import csr_matrix

    dofs, values, stiffness, element = deformation_modes(scene)
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
    modes, element, inverse = scaled_modes(scene)
    cases = [modes[: modes.shape[0] - len(scene.contacts)]]
    if scene.contacts:
        shut = closed_hinges(scene, inverse)
        cases.append(modes - (modes @ shut) @ shut.T)
    square, shares = max((fastest(case) for case in cases), key=lambda found: found[0])
    if not square > 0:
        return StableStep(np.inf, 0.0, "none")
    energy = np.bincount(element[: len(shares)], shares, minlength=len(scene.elements))
    frequency = float(np.sqrt(square))
    return StableStep(2.0 / frequency, frequency, scene.elements[int(np.argmax(energy))])
