"""Rigid bodies: one particle each, with points that are rigidly held at it."""

import numpy as np

from fpm.elements.bars.beam import triad
from fpm.errors import SceneError
from fpm.structures.builder import Part
from fpm.structures.keys import Direction, Number, Reference, Vector
from fpm.structures.route import Points
from fpm.structures.statement import statement


@statement(
    "bodies",
    mass=Number(unit="kg", above=0, about="its mass"),
    centre=Reference(group="points", about="its centre of mass"),
    box=Vector(
        None,
        "edges of a box filled evenly with the mass, along x, up × x and up; this or `inertia`",
        unit="m",
    ),
    inertia=Vector(
        None,
        "principal moments of inertia about its centre, about x, up × x and up",
        unit="kg m2",
    ),
    points=Points((), "points rigidly held at it", kind=Reference(group="points")),
    x=Direction(np.array([1.0, 0.0, 0.0]), "its first principal axis"),
    up=Direction(np.array([0.0, 0.0, 1.0]), "its third principal axis, normal to x"),
)
def body(build, it):
    """A rigid body, free until something joins or holds it."""
    if (it.box is None) == (it.inertia is None):
        found = None if it.box is None else [list(it.box), list(it.inertia)]
        build.refuse("box", found, "either `box` or `inertia`")
    inertia = it.inertia
    if it.box is not None:
        if not (np.all(it.box >= 0) and np.count_nonzero(it.box) >= 2):
            build.refuse("box", it.box.tolist(), "edges >= 0, at most one of them 0")
        squares = it.box**2
        inertia = it.mass / 12 * (squares.sum() - squares)
    largest, total = float(np.max(inertia)), float(np.sum(inertia))
    if not (np.min(inertia) > 0 and 2 * largest <= total * (1 + 1e-9)):
        build.refuse(
            "inertia", inertia.tolist(), "values above 0, none of them more than the sum of the "
            "other two"
        )  # fmt: skip
    if abs(it.x @ it.up) > 1e-6:
        build.refuse("up", it.up.tolist(), f"a direction normal to x, {it.x.tolist()}")
    try:
        axes = triad(it.x, it.up)
        made = build.scene.add_particles(it.centre.position, it.mass, inertia, axes)
    except SceneError as error:
        build.refuse("mass", error.value, error.allowed)
    particle = build.scene.bodies[it.name] = int(made[0])
    return Part(it.name, {point.name: particle for point in (it.centre, *it.points)})
