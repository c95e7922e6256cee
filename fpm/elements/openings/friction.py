"""Coulomb friction on hinges that really sticks: an elastoplastic bristle.

A bristle of stiffness k between the opening psi and its foot z gives the moment -k (psi - z). It
bears at most `moment`, M; beyond, its foot slips, so that k |psi - z| = M, and M |dz| is lost.
Below, the foot stays where it is for ever: nothing creeps. The bristle is bent by `bend` = M/k when
it begins to slip. While it sticks, a damper c on dpsi/dt brings it to rest; both together never
exceed M.
Source: Dupont, Hayward, Armstrong, Altpeter, IEEE Trans. Automatic Control 47 (2002) 787.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.kind import Energy
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    OnHinge,
    Opening,
    check_hinge,
    check_numbers,
    pack_past,
    softness,
    unit_of,
)
from fpm.errors import SceneError

BEND = 1e-3
"""Angle (rad) by which a bristle is bent before it slips, if nothing else is said."""

SLIDE_BEND = 1e-4
"""The same (m) of a slide."""

DAMPED = 0.3
"""Damping ratio of the bristle with the inertias of the hinge's own two particles, likewise. The
step of a scene that it limits is 0.57 of the one without.
"""


@dataclass(frozen=True)
class Friction(OnHinge):
    """hinge index; moment M (N m) at which it slips; bend (rad) before; damping c (N m s/rad)
    of the bristle, None: as DAMPED says.
    """

    hinge: int
    moment: float
    bend: float = BEND
    damping: float | None = None

    stores = Energy("friction", "friction_energy", "energy of the bristles of friction")
    takes = JOINT_LOSS
    acts_as = "friction"
    called = "friction"

    @property
    def stiffness(self) -> float:
        """k = M / bend (N m/rad)."""
        return self.moment / self.bend

    def check(self, scene):
        """Hinge and numbers."""
        check_hinge(scene, "friction", self.hinge)
        check_numbers("friction", scene, self.hinge, moment=(self.moment, 0.0, "N m"))
        if not 0 < self.bend < np.inf:
            unit = unit_of(scene, self.hinge, "rad")
            raise SceneError("bend of friction", self.bend, f"a finite number > 0 ({unit})")
        if self.damping is not None:
            check_numbers("friction", scene, self.hinge, damping=(self.damping, 0.0, "N m s/rad"))

    def damping_in(self, scene) -> float:
        """c (N m s/rad)."""
        if self.damping is not None:
            return self.damping
        inverse = softness(scene, self.hinge)
        return 2 * DAMPED * np.sqrt(self.stiffness / inverse) if inverse else 0.0

    @classmethod
    def pack(cls, batch):
        from fpm.elements.openings.friction_kernels import BRISTLE, STATE, Frictions

        found = cls.of(batch.one)

        def bristles(scene):
            return [[f.stiffness, f.bend, f.damping_in(scene)] for f in cls.of(scene)]

        def feet(scene):
            openings = [scene.hinges[f.hinge].opening for f in cls.of(scene)]
            return [[opening, *[0.0] * (STATE - 1)] for opening in openings]

        return Frictions(
            on=batch.integers(f.hinge for f in found),
            bristle=batch.stack(len(found), BRISTLE, bristles),
            openings=Opening.seen_by(cls, batch),
            past=pack_past(batch, cls),
            state=batch.stack(len(found), STATE, feet),
            account=batch.taken_by(cls),
            rows=batch.rows_of(cls),
        )
