"""Viscous dampers on hinges: moment -c dpsi/dt on the hinge's second particle.

The rate is extrapolated from the two steps before, to the second order in the step h. Leapfrog with
a damper c and a spring k on an inertia J is then stable where h² k/J + 4 h c/J <= 4 (timestep.py).
"""

from dataclasses import dataclass

from fpm.elements.openings.opening import (
    JOINT_LOSS,
    OnHinge,
    Opening,
    check_hinge,
    check_numbers,
    pack_past,
)


@dataclass(frozen=True)
class Damper(OnHinge):
    """hinge index; damping c (N m s/rad)."""

    hinge: int
    damping: float

    takes = JOINT_LOSS
    acts_as = "damper"
    called = "damper"

    def check(self, scene):
        """Hinge and damping."""
        check_hinge(scene, "damper", self.hinge)
        check_numbers("damper", scene, self.hinge, damping=(self.damping, 0.0, "N m s/rad"))

    @classmethod
    def pack(cls, batch):
        from fpm.elements.openings.damper_kernels import Dampers

        return Dampers(
            batch.integers(d.hinge for d in cls.of(batch.one)),
            batch.table(cls, 1, lambda d: [d.damping]),
            Opening.seen_by(cls, batch),
            pack_past(batch, cls),
            batch.taken_by(cls),
        )
