"""Torsion springs on hinges: moment -k (psi - rest) on the hinge's second particle."""

from dataclasses import dataclass

from fpm.declare import number, stiffness
from fpm.elements.kind import Energy
from fpm.elements.openings.opening import Connector, on_hinge


@dataclass(frozen=True)
class TorsionSpring(Connector):
    """Linear spring on the opening (joint coordinate) of a hinge or slide."""

    hinge: int = on_hinge()
    stiffness: float = stiffness(text="moment per radian")
    rest: float = number("rad", default=0.0, text="opening at which it exerts no moment")

    stores = Energy("spring", "spring_energy", "energy of the torsion springs")
    acts_as = "spring"
    noun = "torsion spring"
    resists_as = "S"
    has_memory = False
    cost = 70.0

    def title(self, scene):
        hinge = scene.hinges[self.hinge]
        return f"{'spring' if hinge.slides else self.noun} {hinge.name}"
