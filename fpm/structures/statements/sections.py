"""Materials and cross-sections of bars."""

import math

from fpm.elements.beam import Material as Elastic
from fpm.elements.beam import Section
from fpm.structures.keys import Number
from fpm.structures.statement import Statement


class Material(Statement):
    """A linear elastic material."""

    group = "materials"
    keys = {
        "E": Number(unit="Pa", above=0, about="Young's modulus"),
        "nu": Number(0.3, "Poisson's ratio"),
        "rho": Number(unit="kg/m3", above=0, about="density"),
    }

    @staticmethod
    def build(build, it):
        return Elastic(it.E, it.nu, it.rho)


class Square(Statement):
    """A solid square."""

    group, type = "sections", "square"
    keys = {"side": Number(unit="m", above=0, about="its side")}

    @staticmethod
    def build(build, it):
        return Section.square(it.side)


class Rectangle(Statement):
    """A solid rectangle."""

    group, type = "sections", "rectangle"
    keys = {
        "width": Number(unit="m", above=0, about="across the bar's `up`"),
        "height": Number(unit="m", above=0, about="along the bar's `up`"),
    }

    @staticmethod
    def build(build, it):
        return Section.rectangle(it.width, it.height)


class Circle(Statement):
    """A solid circle."""

    group, type = "sections", "circle"
    keys = {"diameter": Number(unit="m", above=0, about="its diameter")}

    @staticmethod
    def build(build, it):
        return Section.circle(it.diameter / 2)


class Tube(Statement):
    """A round tube."""

    group, type = "sections", "tube"
    keys = {
        "diameter": Number(unit="m", above=0, about="outer diameter"),
        "thickness": Number(unit="m", above=0, about="of the wall, at most half the diameter"),
    }

    @staticmethod
    def build(build, it):
        outer, inner = it.diameter / 2, it.diameter / 2 - it.thickness
        if inner < 0:
            build.refuse("thickness", it.thickness, f"at most half the diameter, {outer:.9g} m")
        inertia = math.pi / 4 * (outer**4 - inner**4)
        return Section(math.pi * (outer**2 - inner**2), inertia, inertia, 2 * inertia)


class General(Statement):
    """Any section, by its four numbers."""

    group, type = "sections", "general"
    keys = {
        "A": Number(unit="m2", above=0, about="area"),
        "Iy": Number(unit="m4", above=0, about="∫ z² dA; z is the bar's `up`"),
        "Iz": Number(unit="m4", above=0, about="∫ y² dA"),
        "J": Number(unit="m4", above=0, about="torsion constant"),
    }

    @staticmethod
    def build(build, it):
        return Section(it.A, it.Iy, it.Iz, it.J)
