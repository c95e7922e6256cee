"""Face-to-face contact: the end faces of two hinged links touch where the opening is below zero.

The faces share the hinge line as an edge, so overlap grows linearly with the distance from it; its
resultant is a moment k |psi| that opens the hinge, k = K_C times the length of the hinge line.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Contact:
    """hinge index; stiffness k (N m/rad)."""

    hinge: int
    stiffness: float
