"""Materials and cross-sections of bars."""

from fpm.elements.bars.beam import Material, Section
from fpm.structures.keys import Number
from fpm.structures.statement import statement


@statement(
    "materials",
    E=Number(unit="Pa", above=0, about="Young's modulus"),
    nu=Number(0.3, "Poisson's ratio"),
    rho=Number(unit="kg/m3", above=0, about="density"),
)
def material(build, it):
    """A linear elastic material."""
    return Material(it.E, it.nu, it.rho)


@statement("sections", "square", side=Number(unit="m", above=0, about="its side"))
def square(build, it):
    """A solid square."""
    return Section.square(it.side)


@statement(
    "sections",
    "rectangle",
    width=Number(unit="m", above=0, about="across the bar's `up`"),
    height=Number(unit="m", above=0, about="along the bar's `up`"),
)
def rectangle(build, it):
    """A solid rectangle."""
    return Section.rectangle(it.width, it.height)


@statement("sections", "circle", diameter=Number(unit="m", above=0, about="its diameter"))
def circle(build, it):
    """A solid circle."""
    return Section.circle(it.diameter / 2)


@statement(
    "sections",
    "tube",
    diameter=Number(unit="m", above=0, about="outer diameter"),
    thickness=Number(unit="m", above=0, about="of the wall, at most half the diameter"),
)
def tube(build, it):
    """A round tube."""
    outer, inner = it.diameter / 2, it.diameter / 2 - it.thickness
    if inner < 0:
        build.refuse("thickness", it.thickness, f"at most half the diameter, {outer:.9g} m")
    return Section.tube(outer, inner)


@statement(
    "sections",
    "general",
    A=Number(unit="m2", above=0, about="area"),
    Iy=Number(unit="m4", above=0, about="∫ z² dA; z is the bar's `up`"),
    Iz=Number(unit="m4", above=0, about="∫ y² dA"),
    J=Number(unit="m4", above=0, about="torsion constant"),
)
def general(build, it):
    """Any section, by its four numbers."""
    return Section(it.A, it.Iy, it.Iz, it.J)
