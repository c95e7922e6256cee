"""Torsion springs by a table: the moment over the opening, straight between the points given.

Beyond the ends of the table the moment keeps its last value. The energy is the exact integral, zero
where it is least within the table. Hysteresis is friction by a table beside it."""

from dataclasses import dataclass

import numpy as np

from fpm.declare import plain_field
from fpm.elements.kind import Energy
from fpm.elements.openings.opening import Connector, on_hinge
from fpm.errors import SceneError


@dataclass(frozen=True)
class TableSpring(Connector):
    """Nonlinear spring on a hinge or slide, by a table. hinge: index; angles: two or more
    increasing openings (rad; m on slides); moments: there (N m; N on slides), linear between,
    constant beyond; positive ones open the hinge."""

    hinge: int = on_hinge("hinge of spring by a table")
    angles: tuple[float, ...] = plain_field()
    moments: tuple[float, ...] = plain_field()

    stores = Energy("table_spring", "table_spring_energy", "energy of the springs by tables")
    acts_as = "spring"
    noun = "spring"
    resists_as = "HA"  # unless its `class` says that it is a spring

    def check(self, scene):
        super().check(scene)
        check_table(self.angles, self.moments, "moments", "spring by a table")

    def topology(self):
        return self.hinge, len(self.angles)

    @property
    def slopes(self) -> np.ndarray:
        """Slopes (n - 1,), N m/rad (N/m), of the moment; below 0 where it resists."""
        return np.diff(self.moments) / np.diff(self.angles)

    @property
    def lift(self) -> float:
        """Energy (J) stored at the table's first point, counted from its least within the table."""
        angles, moments = np.array(self.angles), np.array(self.moments)
        works = np.concatenate([[0.0], np.cumsum(np.diff(angles) * (moments[1:] + moments[:-1]))])
        least = [-works / 2]
        zeros = np.flatnonzero(moments[1:] * moments[:-1] < 0)
        to_zero = -moments[zeros] / self.slopes[zeros]
        least.append(-works[zeros] / 2 - moments[zeros] * to_zero / 2)
        return -float(np.concatenate(least).min())

    def stiffness_in(self, scene):
        """The steepest fall of its moment."""
        return max(0.0, -float(self.slopes.min()))

    @property
    def first(self) -> float:
        """Moment (N m) of the table's first point, which also acts at all openings below it."""
        return self.moments[0]

    @classmethod
    def array(cls, name, batch):
        if name not in ("start", "points"):
            return super().array(name, batch)
        return table_array(name, batch, cls, lambda s: bends(s.angles, s.moments))


def check_table(angles, values, noun: str, owner: str) -> None:
    """Check that a table has a finite value for each of two or more increasing angles; else
    SceneError. noun, owner: what messages call values and element."""
    is_whole = len(angles) == len(values) >= 2
    if not (is_whole and np.isfinite([angles, values]).all()):
        counts = f"{len(angles)} angles, {len(values)} {noun}"
        allowed = f"as many {noun} as angles, two or more, all finite"
        raise SceneError(f"angles of {owner}", counts, allowed)
    if not np.all(np.diff(angles) > 0):
        raise SceneError(f"angles of {owner}", list(angles), "increasing angles")


def bends(angles, values) -> np.ndarray:
    """Return the changes of slope (n,; values' unit per rad) at the points of a piecewise linear
    table that is flat beyond its ends. angles (n,): increasing (rad); values (n,): at them."""
    return np.diff(np.diff(values) / np.diff(angles), prepend=0.0, append=0.0)


def table_array(name: str, batch, kind, bends_of, places: str = "angles") -> np.ndarray:
    """Return an array of the tables of a type's elements, one after the other: "points" (p, 2,
    lanes), place and change of slope of each point; or "start" (elements + 1,), first point of
    each. bends_of(element): changes of slope; places: the field with the places."""
    ends = np.cumsum([0, *(len(getattr(e, places)) for e in kind.find(batch.scene))])
    if name == "start":
        return batch.integers(ends)

    def points(scene):
        pairs = ((getattr(element, places), element) for element in kind.find(scene))
        tables = [(angles, bends_of(element)) for angles, element in pairs if angles]
        return np.concatenate([np.column_stack(table) for table in tables])

    return batch.stack(ends[-1], 2, points)
