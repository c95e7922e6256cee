"""Torsion springs on hinges: moment -k (psi - rest) on the hinge's second particle."""

from dataclasses import dataclass


@dataclass(frozen=True)
class TorsionSpring:
    """hinge index; stiffness k (N m/rad); rest opening (rad)."""

    hinge: int
    stiffness: float
    rest: float
