"""An opening is led slowly from one value to another, and what acts is told apart."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fpm.assembly import masses
from fpm.elements import Contact, Friction, Latch, RigidLatch, Stop, TableSpring
from fpm.errors import SceneError
from fpm.travel.balance import ROUNDS, TINY
from fpm.travel.components import STRAIN, VirtualWork, bearing_name, components_of
from fpm.travel.path import NEAR, Path
from fpm.travel.positions import MOST, Places, slopes

POSITIONS = 31
"""Positions at which the opening is held at first, both ends among them."""

CLOSE = 1e-6
"""By how much what is interpolated may miss at a tested position, as a share of all that acts."""

CLOSE_IN_BEARINGS = 1e-4
"""The same of bearings: where joints hold twice what others hold, as out of the plane of a planar
loop, their forces are known to some 1e-5 only (rounding over the 1e-10 by which joints give)."""

LEAST = 1e-6
"""Share of the most that acts anywhere, below which nothing is told apart."""

ON_PLACE = 1e-9
"""How exactly positions at which something bends are hit, as a share of the way."""

RESOLVED = 5e-3
"""Distance of positions, as a share of the way, from which the strain's slope is tested."""

BEHIND = 1e-4
"""Share of the way by which what only resists has come straight to a position."""


class Travel(NamedTuple):
    """opening (p,) rad, or m of a slide; work: by part, its virtual work (p,) N m per rad, or N,
    above 0 where it drives; inertia (p,) kg m², or kg, that the opening moves."""

    opening: np.ndarray
    work: dict[str, np.ndarray]
    inertia: np.ndarray


def lead(
    scene,
    openings: str | Sequence[str],
    first: float,
    last: float,
    stand: Sequence[str] = (),
    positions: int | None = None,
) -> Travel:
    """Lead an opening of a scene from one value to another (rad, m).

    openings: by name; of several, the others go as far from their start as the first does. stand:
    others that keep their opening at the start. positions: as many, evenly, and no others; else
    as many as it takes, those at which something bends among them (fpm.travel.positions).
    SceneError where the opening does not decide the motion of all, MisfitError where it cannot be
    led there.
    """
    path = Path(scene, [openings] if isinstance(openings, str) else openings, stand)
    count = positions or POSITIONS
    spacing = (last - first) / (count - 1)
    ahead = np.linspace(path.opening, first, 1 + math.ceil(abs((first - path.opening) / spacing)))
    parts = [(part.name, VirtualWork(scene, part)) for part in components_of(scene)]
    for value in ahead:
        path.to(float(value))
        for _, part in parts:  # openings are counted from one place to the next
            part.along(path.places, path.tangent)
    path.check()
    acting = [*path.balance.acting, *(each for _, part in parts for each in part.acting)]
    names = [name for name, _ in parts] + [bearing_name(scene, hinge) for hinge in scene.bearings]
    works = len(names)
    rubbing = sorted({friction.hinge for friction in Friction.of(scene)} | set(scene.bearings))

    def measure(place: float, before):
        """Virtual works, strain, inertia, and all openings, where a share of the way is gone."""
        if before is not None:
            path.restore(before[0])
            for each, kept in zip(acting, before[1], strict=True):
                each.restore(kept)
        path.to(float(first + place * (last - first)))
        tangent = np.sign(spacing) * path.tangent
        behind = BEHIND * abs(last - first) * tangent
        for _, part in parts:
            part.come(path.places, behind)
        row = [part.along(path.places, tangent) for _, part in parts]
        row += path.in_bearings(sum((part.rubs() for _, part in parts), np.zeros(len(tangent))))
        row.append(path.balance.strain(path.places))
        row.append(tangent @ (masses(scene, path.places) @ tangent))
        row += [*path.opened(), *path.rates(rubbing)]
        return np.array(row), (path.state(), [each.kept() for each in acting])

    def missed(expected: np.ndarray, values: np.ndarray, distance: float) -> float:
        """By how much values are not as expected, in shares of what may be."""
        off, acts = np.abs(values - expected), np.abs(values[:works]).sum()
        most = CLOSE * max(acts, LEAST * largest)
        off[len(parts) : works] *= CLOSE / CLOSE_IN_BEARINGS
        heavy = off[works + 1] / (10 * CLOSE * values[works + 1])
        strained = off[works] / (distance * abs(last - first) * most)
        return max(off[:works].max(initial=0.0) / most, heavy, strained * (distance > RESOLVED))

    found = Places(measure)
    for place in np.linspace(0.0, 1.0, count):
        found.add(float(place))
    if positions is None:
        _add_bends(scene, found, works + 2)
        largest = max(np.abs(values[:works]).sum() for values in found.values) + TINY
        if not found.refine(missed):
            raise SceneError(
                f"opening {path.name}", f"from {first:.6g} to {last:.6g}", "a way on which what "
                "acts bends or jumps at some places only: it needs more than "
                f"{MOST} positions"
            )  # fmt: skip
    way, values = found.arrays()
    work = dict(zip(names, values[:, :works].T, strict=True))
    energy, inertia = values[:, works : works + 2].T
    if scene.beams:  # at the balance it is least, so that it is more exact than its forces
        work[STRAIN] = -slopes(way, energy) / abs(last - first)
    return Travel(first + way * (last - first), work, inertia)


def _add_bends(scene, found: Places, openings: int) -> None:
    """Add the places at which elements bend, and at which joints that rub turn back.

    openings: the first column of the values that is one; behind them are rates of joints that rub.
    """
    bends = [(openings + hinge, angle) for hinge, angle in sorted(set(_bends(scene)))]
    rates = openings + len(scene.hinges)
    sizes = np.abs(np.array(found.values)[:, rates:]).max(axis=0)
    moving = np.flatnonzero(sizes > NEAR * sizes.max(initial=0.0))  # what rests turns by rounding
    bends += [(rates + int(i), 0.0) for i in moving]
    for column, angle in bends:
        for ends in list(pairwise(found.at)):
            off = [found.add(place)[column] - angle for place in ends]
            if off[0] * off[1] <= 0 and off[0] != off[1]:
                place = _root(lambda at, k=column, a=angle: found.look(at)[0][k] - a, ends, off)
                near = min(ends, key=lambda end: abs(end - place))
                found.bend(near if abs(near - place) < ON_PLACE else place)


def _root(function: Callable[[float], float], ends, values) -> float:
    """Where a function vanishes between two ends with values of either sign (Illinois)."""
    (kept, last), (there, here) = ends, values
    if 0.0 in values:
        return kept if there == 0.0 else last
    size = abs(here - there)
    for _ in range(ROUNDS):
        place = (kept * here - last * there) / (here - there)
        off = function(place)
        if abs(off) <= ON_PLACE * size or abs(last - kept) < ON_PLACE:
            break
        kept, there = (last, here) if off * here < 0 else (kept, 0.5 * there)
        last, here = place, off
    return place


def _bends(scene) -> list[tuple[int, float]]:
    """Hinges by index, with openings at which what acts there bends, or catches."""
    found = [(e.hinge, a) for k in (TableSpring, Friction) for e in k.of(scene) for a in e.angles]
    found += [(e.hinge, e.angle) for k in (Stop, Latch, RigidLatch) for e in k.of(scene)]
    return found + [(contact.hinge, 0.0) for contact in Contact.of(scene)]
