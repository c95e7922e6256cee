"""Cables: tension only, from point to point or running through several."""

from fpm.structures.keys import Number, PointOfPart, Reference
from fpm.structures.route import Points
from fpm.structures.statement import statement


@statement(
    "cables",
    through=Points(kind=PointOfPart(ground=True), least=2, about="its points, in order"),
    EA=Number(unit="N", above=0, about="tension for a strain of one"),
    rest=Number(None, "its length without tension; this or `preload`", unit="m", above=0),
    preload=Number(None, "its tension at the start; this or `rest`", unit="N", least=0),
    reel=Number(0.0, "length that a winch at the first point takes in, times `curve`", unit="m"),
    curve=Reference(None, "of the winch", group="curves"),
    friction=Number(
        None, "coefficient of friction at the points between its ends; left out: they turn", least=0
    ),
)
def cable(build, it):
    """Pulls its points together where it is tight, and runs through those between its ends."""
    points = []
    for part, point in it.through:
        particle = part.particle(point.name)
        build.joined.setdefault(particle, [])
        points.append((particle, point.position))
    if (it.rest is None) == (it.preload is None):
        found = None if it.rest is None else [it.rest, it.preload]
        build.refuse("rest", found, "either `rest` or `preload`")
    if it.reel and it.curve is None:
        build.refuse("reel", it.reel, "a length with a `curve`")
    curve = -1 if it.curve is None else it.curve
    return build.scene.add_cable(
        it.name, points, it.EA, it.rest, it.preload, it.reel, curve, it.friction
    )
