"""Torsion springs on hinges: moment -k (psi - rest) on the hinge's second particle."""

from dataclasses import dataclass

from fpm.kinds.kind import Energy, Kind
from fpm.kinds.opening import Opening, check_stiffness, relative_turn


@dataclass(frozen=True)
class TorsionSpring(Kind):
    """hinge index; stiffness k (N m/rad); rest opening (rad)."""

    hinge: int
    stiffness: float
    rest: float = 0.0

    stores = Energy("spring", "spring_energy", "energy of the torsion springs")
    reads = (Opening,)
    acts_as = "spring"

    def check(self, scene):
        """Hinge and stiffness."""
        check_stiffness(scene, "torsion spring", self.hinge, self.stiffness)

    def topology(self):
        """The hinge."""
        return self.hinge

    @classmethod
    def names(cls, scene):
        return [f"torsion spring {scene.hinges[s.hinge].name}" for s in cls.of(scene)]

    @classmethod
    def deformations(cls, scene):
        """The openings of their hinges."""
        springs = cls.of(scene)
        return relative_turn(scene, [s.hinge for s in springs], [s.stiffness for s in springs])

    @classmethod
    def pack(cls, batch):
        from fpm.kinds.torsion_spring_kernels import Springs

        return Springs(
            batch.integers(s.hinge for s in cls.of(batch.one)),
            batch.table(cls, 2, lambda s: [s.stiffness, s.rest]),
            Opening.seen_by(cls, batch),
            batch.rows_of(cls),
        )
