"""Torsion springs on hinges: moment -k (psi - rest) on the hinge's second particle."""

from dataclasses import dataclass

from fpm.elements.kind import Energy
from fpm.elements.openings.opening import OnHinge, Opening, check_stiffness


@dataclass(frozen=True)
class TorsionSpring(OnHinge):
    """hinge index; stiffness k (N m/rad); rest opening (rad)."""

    hinge: int
    stiffness: float
    rest: float = 0.0

    stores = Energy("spring", "spring_energy", "energy of the torsion springs")
    acts_as = "spring"
    called = "torsion spring"

    def check(self, scene):
        """Hinge and stiffness."""
        check_stiffness(scene, "torsion spring", self.hinge, self.stiffness)

    @classmethod
    def names(cls, scene):
        """Those on slides are just springs."""
        hinges = [scene.hinges[spring.hinge] for spring in cls.of(scene)]
        return [f"{'spring' if h.slides else cls.called} {h.name}" for h in hinges]

    @classmethod
    def pack(cls, batch):
        from fpm.elements.openings.torsion_spring_kernels import Springs

        return Springs(
            batch.integers(s.hinge for s in cls.of(batch.one)),
            batch.table(cls, 2, lambda s: [s.stiffness, s.rest]),
            Opening.seen_by(cls, batch),
            batch.rows_of(cls),
        )
