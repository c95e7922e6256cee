"""Travel: an opening is led slowly from one value to another, and what acts is told apart.

At every position the opening is held, and the rest lies in balance: all joints closed, and strain,
springs, loops, cables, weight and loads in equilibrium (fpm/assembly), without what only resists,
as friction. The way from one position to the next is that of the balance itself,

    H t + G'p = 0,   G t = e

e being one for the opening that is led and zero for all other conditions; t, the motion of all
particles per unit of the opening, starts the next position. Each element's virtual work w = F·t is
what it gives (w > 0) or takes per unit of the way, at a rate that vanishes: by its own kernels,
with friction sliding the way that its joint goes. Kinetic energy does not enter, nor what holds:
motors that prescribe the opening, releases, and latches.
"""

import math
from collections import Counter
from collections.abc import Sequence
from copy import copy
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from fpm.assembly import FARTHEST, MisfitError, linearised, masses
from fpm.assembly.conditions import NORMAL, Conditions, Places, conditions_of
from fpm.assembly.elastic import elastic_of
from fpm.elements import Beams, Kind, kinds_of
from fpm.elements.openings.opening import rate_at
from fpm.errors import SceneError
from fpm.travel.acting import Acting, acts

POSITIONS = 61
"""Positions at which the opening is held, both ends among them."""

NEAR = 1e-8
"""Last motion of the rounds at a position, as a share of the size, or turn (rad). The way on is
that before it, where bars may be strained by as much, which stiffens thin ones in bending."""

AHEAD = ([1], [3, -1], [23, -16, 5], [55, -59, 37, -9])
"""Weights of the last motions, by how many there are, in that to the next position (Adams and
Bashforth)."""

ROUNDS = 40

SOFT, STIFF = 1e-8, 1e-13
"""What decides motions that nothing stiffens, as shares of the stiffness of springs and their like,
and at least of that of bars."""

DRIFTS = 1e-9
"""Share of the largest rate of a condition, in a motion of the whole, below which it has none."""

ALIKE = 1e-3
"""By how much the rates of openings may differ, as a share of the largest, with other masses: where
they differ by more, it is not the opening alone that decides the motion."""

STRAIN, INERTIA = "strain of bars", "inertia"
"""Parts that are no elements: elastic strain, and the inertia (kg m², kg) that the opening has."""

DRAGS = ("FR", "HY")
"""Classes of what only resists (Kind.resists_as)."""


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
    positions: int = POSITIONS,
) -> Travel:
    """Lead an opening of a scene from one value to another (rad, m).

    openings: by name; of several, the others go as far from their start as the first does. stand:
    others that keep their opening at the start. SceneError where the opening does not decide the
    motion of all, MisfitError where it cannot be led there.
    """
    path = _Path(scene, [openings] if isinstance(openings, str) else openings, stand)
    spacing = (last - first) / (positions - 1)
    ahead = np.linspace(path.opening, first, 1 + math.ceil(abs((first - path.opening) / spacing)))
    for value in ahead:
        path.to(float(value))
    path.check()
    parts = {part.name: Acting(scene, [part.element]) for part in _elements(scene)}
    for acting in parts.values():  # as if it had come this way
        acting.forces(path.places.moved(-spacing * path.tangent))
    way, rows = np.linspace(first, last, positions), []
    for value in way:
        path.to(float(value))
        tangent = np.sign(spacing) * path.tangent
        row = {name: acting.forces(path.places) @ tangent for name, acting in parts.items()}
        row |= path.in_bearings()
        row[STRAIN] = path.balance.strain(path.places)
        row[INERTIA] = tangent @ (masses(scene, path.places) @ tangent)
        rows.append(row)
    work = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    energy, inertia = work.pop(STRAIN), work.pop(INERTIA)
    if scene.beams:  # at the balance it is least, so that it is more exact than its forces
        work[STRAIN] = -np.gradient(energy, abs(spacing), edge_order=2)
    return Travel(way, work, inertia)


def parts_of(scene) -> dict[str, str]:
    """The parts of the virtual work in a scene, with their classes (Kind.resists_as)."""
    found = {part.name: part.resists_as for part in _elements(scene)}
    found = {_bearing(scene, hinge): "FR" for hinge in scene.bearings} | found
    return found | ({STRAIN: "S"} if scene.beams else {})


class _Part(NamedTuple):
    """An element that acts; drags: whether it only resists."""

    name: str
    element: Kind
    resists_as: str
    drags: bool


def _elements(scene) -> list[_Part]:
    """All that acts; those with one name are told apart by numbers."""
    found, count = [], Counter()
    for kind in kinds_of([scene]):
        own = kind.resists_as
        if not own or kind is Beams or not acts(kind):
            continue
        for i, (name, element) in enumerate(zip(kind.names(scene), kind.led(scene), strict=True)):
            count[name] += 1
            name = f"{name} #{count[name]}" if count[name] > 1 else name
            found.append(_Part(name, element, scene.classes.get((kind, i), own), own in DRAGS))
    return found


def _bearing(scene, hinge: int) -> str:
    return f"bearing {scene.hinges[hinge].name}"


class _Balance:
    """Bars, and what else has no losses, for the balance of an assembly (fpm/assembly)."""

    def __init__(self, scene):
        self._bars = elastic_of(scene)
        by_kind: dict[type, list] = {}
        for part in _elements(scene):
            if not part.drags:
                by_kind.setdefault(type(part.element), []).append(part.element)
        self._others = [Acting(scene, elements) for elements in by_kind.values()]

    def strain(self, places: Places) -> float:
        """Energy (J) of the bars."""
        return self._bars.energy(places) if len(self._bars.nodes) else 0.0

    def derivatives(self, places: Places):
        """Gradient (6n,) and its derivatives, sparse (6n, 6n)."""
        gradient, stiffness = self._of_bars(places)
        for acting in self._others:
            forces, slopes = acting.tried(places)
            gradient, stiffness = gradient - forces, stiffness + slopes
        return gradient, stiffness

    def ease(self, places: Places, scales: np.ndarray) -> float:
        """What decides motions that nothing stiffens (N m)."""
        from scipy.sparse import diags

        own = diags(scales)
        soft = [acting.tried(places)[1] for acting in self._others]
        bars, *others = (abs(own @ k @ own).max() for k in (self._of_bars(places)[1], *soft))
        return max(STIFF * bars, SOFT * max(others, default=0.0)) or 1.0

    def _of_bars(self, places: Places):
        from scipy.sparse import csc_array

        if len(self._bars.nodes):
            return self._bars.derivatives(places)
        count = 2 * places.position.size
        return np.zeros(count), csc_array((count, count))

    def follow(self, places: Places) -> None:
        """Everything has come here."""
        for acting in self._others:
            acting.forces(places)


def _rows(conditions: Conditions, places: Places):
    """Derivatives, sparse (c, 6n), of conditions."""
    return conditions.derivatives(places, np.zeros(len(conditions.joint)))[0]


class _Path:
    """Where a scene is on its way, `places`, with the motion `tangent` (6n,) per unit of the
    opening."""

    def __init__(self, scene, openings: Sequence[str], stand: Sequence[str]):
        self.scene, self.name = scene, openings[0]
        by_name = {hinge.name: hinge for hinge in scene.hinges}
        self._hinges, self.balance = [by_name[name] for name in openings], _Balance(scene)
        self.opening = self._start = float(self._hinges[0].opening)
        self.places = Places(scene.position.copy(), scene.frame.copy())
        self._conditions = conditions_of(scene, [*stand, *openings])
        self._leading = len(stand) + len(openings)
        self._zeros = self._conditions.gaps(self.places)[-len(openings) :]
        self._size = float(np.ptp(scene.position, axis=0).max()) or 1.0
        self._scales = np.tile(np.repeat([self._size, 1.0], 3), len(scene.position))
        self._weight = self._conditions.weight(self._size)
        self._impulses = np.zeros(len(self._weight))
        self._free = self._moving(self.places)
        self.tangent = np.zeros(len(self._scales))
        self._tangents: list[np.ndarray] = []
        self._ease = self.balance.ease(self.places, self._scales)

    def to(self, value: float) -> None:
        """Lead the opening to a value; MisfitError where it cannot be."""
        step, conditions = value - self.opening, self._held(value)
        weights = AHEAD[len(self._tangents) - 1] if self._tangents else []
        ahead = sum(w / sum(weights) * t for w, t in zip(weights, self._tangents, strict=True))
        places = self.places.moved(step * ahead) if self._tangents else self.places
        for _ in range(ROUNDS):
            solve, gradient = self._equations(places, conditions, self._ease)
            lacks = -self._weight * conditions.gaps(places)
            motion, change = solve(-gradient, lacks)
            largest = np.abs(motion).max(initial=0.0)
            if not np.isfinite(largest):
                break
            share = min(1.0, FARTHEST / largest) if largest > 0 else 1.0
            places = places.moved(share * self._scales * motion)
            self._impulses = self._impulses + share * change
            if largest <= NEAR and np.abs(lacks).max(initial=0.0) <= NEAR:
                self.places, self.opening, self.tangent = places, value, self._motion(solve)
                self._tangents = [self.tangent, *(self._tangents[:3] if step else [])]
                self.balance.follow(places)
                return
        raise MisfitError(
            f"opening {self.name}", f"{value:.6g}", "openings to which it can be led, the joints "
            "closed and all else in balance; other openings that nothing decides may `stand`"
        )  # fmt: skip

    def in_bearings(self) -> dict[str, float]:
        """Virtual work of the friction by the forces of joints: all of a hinge's, those across a
        slide; by them without friction."""
        shift, turn = self.tangent.reshape(-1, 2, 3).transpose(1, 0, 2)
        motion, found = SimpleNamespace(velocity=shift, spin=turn), {}
        for number, lever in self.scene.bearings.items():
            hinge, of = self.scene.hinges[number], self._conditions
            own = (np.array(of.joint) == hinge.joint) & (of.how != NORMAL)
            own[-self._leading :] = False
            force = np.linalg.norm((self._weight * self._impulses)[own])
            rate = abs(rate_at(self.places, hinge, motion))
            found[_bearing(self.scene, number)] = -lever * float(force) * rate
        return found

    def check(self) -> None:
        """SceneError unless the opening decides the motion of everything else."""
        scene, uneven = self.scene, np.linspace(1.0, 3.0, len(self.scene.mass))
        self.scene = copy(scene)
        self.scene.mass, self.scene.inertia = scene.mass * uneven, scene.inertia / uneven[:, None]
        solve = self._equations(self.places, self._held(self.opening), self._ease)[0]
        self.scene = scene
        rows = _rows(conditions_of(scene, [hinge.name for hinge in scene.hinges]), self.places)
        rates = rows[-len(scene.hinges) :] @ np.stack([self.tangent, self._motion(solve)], axis=1)
        if np.abs(np.diff(rates)).max() > ALIKE * np.abs(rates).max():
            raise SceneError(
                f"opening {self.name}", "(not the only freedom)", "an opening that decides the "
                "motion of all others, by joints, springs or loops; let others `stand`"
            )  # fmt: skip

    def _moving(self, places: Places) -> np.ndarray:
        """Degrees of freedom that are not held. Where the whole may drift as it is, some of the
        heaviest particle are: what acts between parts does the same work whichever of them moves.
        """
        from scipy.linalg import qr

        held, off = self.scene.fixed.ravel().copy(), places.position - places.position.mean(axis=0)
        drift = np.zeros((len(off), 6, 6))
        drift[:, :3, :3] = drift[:, 3:, 3:] = np.eye(3)
        drift[:, :3, 3:] = np.cross(np.eye(3), off[:, None] / self._size).swapaxes(1, 2)
        drift = drift.reshape(-1, 6)  # lengths by the size
        rows = _rows(self._conditions, places).multiply(self._scales).tocsr()
        ruled_out = np.vstack([self._weight[:, None] * (rows @ drift), drift[held]])
        _, sizes, ways = np.linalg.svd(ruled_out)
        free = ways[np.sum(sizes > DRIFTS * sizes.max(initial=1.0)) :]
        if len(free):
            first = 6 * int(np.argmax(self.scene.mass))
            pivots = qr(free @ drift[first : first + 6].T, pivoting=True, mode="r")[1]
            held[first + pivots[: len(free)]] = True
        return np.flatnonzero(~held)

    def _equations(self, places, conditions, ease):
        return linearised(
            self.scene, places, conditions, self.balance, self._impulses, self._scales, self._free,
            self._weight, ease,
        )  # fmt: skip

    def _motion(self, solve) -> np.ndarray:
        """The motion (6n,) per unit of the opening."""
        lacks = np.zeros(len(self._weight))
        lacks[-len(self._hinges) :] = [-1.0 if hinge.slides else 1.0 for hinge in self._hinges]
        return self._scales * solve(np.zeros(len(self._scales)), self._weight * lacks)[0]

    def _held(self, value: float) -> Conditions:
        """The conditions, the last of which hold the openings where the first has a value."""
        found, moved, count = self._conditions, value - self._start, len(self._hinges)
        one, arms = found.one.copy(), found.arms.copy()
        for row, hinge, zero in zip(range(-count, 0), self._hinges, self._zeros, strict=True):
            axis, across = hinge.axes[0], hinge.references[0]
            if hinge.slides:
                arms[row, 0] += (moved - zero) * axis
                continue
            angle = hinge.opening + moved
            one[row] = np.cos(angle) * np.cross(axis, across) - np.sin(angle) * across
        return found._replace(one=one, arms=arms)
