"""Euler-Bernoulli beam elements between two particles.

Theory. The rigid motion of an element is taken out by a fictitious reverse motion: turned back
with the rotation of particle a, the chord n of the element shows the deflection angles of that end,
``s = n . a2`` and ``n . a3`` (a1, a2, a3: the triad carried by particle a; undeformed, a1 = n).
What is left is small, and linear Euler-Bernoulli theory holds for it::

    U = EA/(2 l0) (l - l0)^2 + GJ/(2 l0) t^2
      + sum over both planes of 2 EI/l0 (th_a^2 + th_a th_b + th_b^2),
    th = s + s^3/6 (the angle of which s is the sine),   t = (b2 . a3 - b3 . a2) / 2.

The end forces are the exact gradient of U with respect to the particles' positions and rotations.
So they vanish in any rigid motion, carry no net force or moment (momentum is kept to rounding) and
are conservative. Source of the concept: Ting, Shih, Wang, J. Mech. 20 (2004) 113 (vector form
intrinsic finite element); corotational chord frame: Crisfield, Non-linear FEA vol. 2, ch. 17.
"""

from dataclasses import dataclass

import numpy as np

from fpm.errors import SceneError


@dataclass(frozen=True)
class Material:
    """Linear elastic material: `E` Young's modulus (Pa), `nu` Poisson's ratio, `rho` (kg/m3)."""

    E: float
    nu: float
    rho: float

    def __post_init__(self):
        if not self.E > 0:
            raise SceneError("Young's modulus E", self.E, "a positive number (Pa)")
        if not -1 < self.nu <= 0.5:
            raise SceneError("Poisson's ratio nu", self.nu, "-1 < nu <= 0.5")
        if not self.rho > 0:
            raise SceneError("density rho", self.rho, "a positive number (kg/m3)")

    @property
    def G(self) -> float:
        """Shear modulus (Pa)."""
        return self.E / (2 * (1 + self.nu))


@dataclass(frozen=True)
class Section:
    """Cross-section: `A` (m2), `Iy` = ∫z² dA and `Iz` = ∫y² dA (m4), torsion constant `J` (m4)."""

    A: float
    Iy: float
    Iz: float
    J: float

    @staticmethod
    def rectangle(width: float, height: float) -> "Section":
        """Solid rectangle, `width` along the local y, `height` along the local z axis (m).

        Torsion constant by the series of Timoshenko and Goodier, Theory of Elasticity, § 109.
        """
        if not (width > 0 and height > 0):
            raise SceneError("section width, height", (width, height), "positive lengths (m)")
        long, short = max(width, height), min(width, height)
        odd = np.arange(1, 40, 2)
        series = np.sum(np.tanh(odd * np.pi * long / (2 * short)) / odd**5)
        J = long * short**3 * (1 / 3 - 64 / np.pi**5 * short / long * series)
        return Section(
            A=width * height, Iy=width * height**3 / 12, Iz=height * width**3 / 12, J=float(J)
        )

    @staticmethod
    def square(side: float) -> "Section":
        """Solid square of the given side (m)."""
        return Section.rectangle(side, side)

    @staticmethod
    def circle(radius: float) -> "Section":
        """Solid circle of the given radius (m)."""
        inertia = np.pi * radius**4 / 4
        return Section(A=np.pi * radius**2, Iy=inertia, Iz=inertia, J=2 * inertia)


@dataclass(frozen=True)
class Beams:
    """Beam elements of one section and material.

    nodes (m, 2) particle indices; length (m,) undeformed lengths (m); triad (m, 3, 3) the element's
    initial axes as columns (first along the chord); name: prefix of the elements' names.
    """

    nodes: np.ndarray
    length: np.ndarray
    triad: np.ndarray
    section: Section
    material: Material
    name: str

    def stiffness(self) -> np.ndarray:
        """Rows (m, 5): l0 (m), EA/l0 (N/m), 2 EIz/l0, 2 EIy/l0 and GJ/l0 (N m)."""
        s, m, n = self.section, self.material, len(self.length)
        rows = [1.0, m.E * s.A, 2 * m.E * s.Iz, 2 * m.E * s.Iy, m.G * s.J]
        table = np.tile(rows, (n, 1))
        table[:, 0] = self.length
        table[:, 1:] /= self.length[:, None]
        return table


def triad(direction: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Right-handed axes (3, 3) as columns: x along `direction`, z in the plane with `normal`."""
    x = np.asarray(direction, float)
    x = x / np.linalg.norm(x)
    y = np.cross(normal, x)
    size = np.linalg.norm(y)
    if size < 1e-9:
        raise SceneError("normal", tuple(normal), f"a vector not parallel to the beam, {tuple(x)}")
    y = y / size
    return np.column_stack([x, y, np.cross(x, y)])
