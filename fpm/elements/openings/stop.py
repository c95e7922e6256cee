"""Stops on hinges: a spring and a damper that begin at an opening and act on one side of it.

Theory: docs/mechanics.md, "On hinges: dampers, friction". A stop never pulls. Faces of two links
that touch are a stop without a damper: they share the hinge line as an edge, so overlap grows with
the distance from it, and the resultant is a moment k |psi|, k = K_C times the line's length."""

from dataclasses import dataclass

import numpy as np

from fpm.declare import damping, number, stiffness, word
from fpm.elements.kind import Energy, Gate
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    ONSET,
    Connector,
    on_hinge,
    struck_stiffness,
)


class AnyStop(Connector):
    """Base class of stops and contacts, which act on one side of an opening. A subclass has the
    attributes angle (rad; m), side, stiffness (N m/rad; N/m) and damping (N m s/rad; N s/m)."""

    takes = JOINT_LOSS
    resists_as = "S"


@dataclass(frozen=True)
class Stop(AnyStop):
    """Stop of a hinge or slide: a spring and a damper that act beyond the opening `angle`, on the
    `side` above or below it."""

    hinge: int = on_hinge()
    angle: float = number("rad")
    side: str = word({"above": 1.0, "below": -1.0}, is_topology=True)
    stiffness: float = stiffness(text="moment per radian beyond `lower` or `upper`")
    damping: float = damping(
        default=0.0, text="moment per radian per second beyond `lower` or `upper`"
    )

    stores = Energy("stop", "stop_energy", "energy of the stops")
    events = ("leaves", "hits")
    acts_as = "stop"
    onset = ONSET
    noun = "stop"

    @classmethod
    def names(cls, scene):
        return [f"{stop.title(scene)} {stop.side}" for stop in cls.find(scene)]

    def stiffness_in(self, scene):
        return struck_stiffness(self)

    def gate(self):
        return Gate(self.angle, {"above": 1.0, "below": -1.0}[self.side])


FINER = 3.5
"""By how much the step of contacts is finer than the stable one: what strikes them comes back
within 0.2 % of its speed, and from the step after it struck the energy balances within 0.4 %."""


@dataclass(frozen=True)
class Contact(AnyStop):
    """Contact of two faces, which touch when the opening of a revolute joint is below zero."""

    hinge: int = on_hinge(types=("revolute",))
    stiffness: float = stiffness(text="moment per radian below zero")

    angle, side, damping = 0.0, -1.0, 0.0  # of the stop that it is
    stores = Energy("contact", "contact_energy", "energy of the face-to-face contacts")
    events = ("opens", "closes")
    acts_as = "contact"
    noun = "contact"
    cost = 70.0

    def stiffness_in(self, scene):
        return FINER**2 * self.stiffness

    def damping_in(self, scene):
        return None

    def gate(self):
        return Gate(0.0, -1.0)

    @classmethod
    def blocked_motions(cls, scene, inverse):
        """Return the relative motions of linked bodies that closed contacts rule out, for the
        stable time step: orthonormal columns (6n, c), a sparse matrix, in coordinates multiplied by
        the roots of masses. Contacts count as closed at joint coordinate 0, wherever the scene
        starts. inverse (6n,): inverse masses (1/kg) and inertias (1/kg m²) of its n particles.
        Columns of hinges that share a particle are made orthonormal together."""
        from scipy.sparse import csc_matrix, identity

        columns, dofs = [], []
        frame = scene.frame if scene.unstrained is None else scene.unstrained
        for hinge in {c.hinge for c in cls.find(scene)}:
            h = scene.hinges[hinge]
            triads = [
                np.column_stack([a, r, np.cross(a, r)])
                for a, r in zip(h.axes, h.references, strict=True)
            ]
            rows = []
            for sign, beam, axes in zip((1.0, -1.0), h.beams, triads, strict=True):
                turn = -np.array([np.cross(beam.arm, e) for e in np.eye(3)]).T
                point = np.hstack([axes.T @ frame[beam.particle].T, axes.T @ turn])
                tilt = np.hstack([np.zeros((2, 3)), axes.T[1:]])
                rows.append(sign * np.vstack([point, tilt]))
            indices = np.concatenate([6 * p + np.arange(6) for p in h.particles])
            matrix = (np.hstack(rows) * np.sqrt(inverse[indices])).T
            u, size, _ = np.linalg.svd(matrix, full_matrices=False)
            u = u[:, size > 1e-10 * size.max(initial=0.0)]
            columns.append(u.T)
            dofs.append(np.tile(indices, (u.shape[1], 1)))
        rows, values = np.concatenate(dofs), np.concatenate(columns)
        column = np.repeat(np.arange(len(rows)), 12)
        shape = (len(inverse), len(rows))
        result = csc_matrix((values.ravel(), (rows.ravel(), column)), shape=shape)
        if abs(result.T @ result - identity(len(rows))).max() > 1e-9:
            u, size, _ = np.linalg.svd(result.toarray(), full_matrices=False)
            result = csc_matrix(u[:, size > 1e-10])
        return result
