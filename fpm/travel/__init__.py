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
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from itertools import pairwise, product
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from fpm.assembly import FARTHEST, MisfitError, linearised, masses
from fpm.assembly.conditions import NORMAL, Conditions, conditions_of
from fpm.assembly.conditions import Places as At
from fpm.assembly.elastic import elastic_of
from fpm.elements import (
    Beams,
    Cable,
    Contact,
    Friction,
    Kind,
    Latch,
    Load,
    RigidLatch,
    Stop,
    TableSpring,
    TorqueMotor,
    TorsionSpring,
    kinds_of,
)
from fpm.elements.openings.opening import opening_at, rate_at
from fpm.errors import SceneError
from fpm.travel.acting import Acting, acts
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

NEAR = 1e-8
"""Last motion of the rounds at a position, as a share of the size, or turn (rad). The way on is
that before it, where bars may be strained by as much, which stiffens thin ones in bending."""

AHEAD = ([1], [3, -1], [23, -16, 5], [55, -59, 37, -9])
"""Weights of the last motions, by how many there are, in that to the next position (Adams and
Bashforth)."""

ROUNDS = 40

AGREES = 0.2
"""By how much a motion between two positions may differ from the mean of the rates at both, as a
share of itself; beyond, it is halved, as it may have come upon another assembly of the same joints.
"""

MOST_HALVED = 1000
"""Motions that are halved on a whole way at most; a jump takes some 300, with those about it."""

BEHIND = 1e-4
"""Share of the way by which what only resists has come straight to a position."""

SHARES, LOCKED = 8, 1e-3
"""In how many steps the friction of bearings grows to its own, and the determinant of the forces'
equations below which it presses its joint as hard as it is pushed."""

HALVINGS = 14
"""How often a motion is halved at most: where two assemblies meet closer than that, it goes on
straight."""

SOFT, STIFF = 1e-8, 1e-13
"""What decides motions that nothing stiffens, as shares of the stiffness of springs and their like,
and at least of that of bars."""

TINY = 1e-300
"""N m, so that nothing is divided by zero where nothing acts."""

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
    positions: int | None = None,
) -> Travel:
    """Lead an opening of a scene from one value to another (rad, m).

    openings: by name; of several, the others go as far from their start as the first does. stand:
    others that keep their opening at the start. positions: as many, evenly, and no others; else
    as many as it takes, those at which something bends among them (fpm.travel.positions).
    SceneError where the opening does not decide the motion of all, MisfitError where it cannot be
    led there.
    """
    path = _Path(scene, [openings] if isinstance(openings, str) else openings, stand)
    count = positions or POSITIONS
    spacing = (last - first) / (count - 1)
    ahead = np.linspace(path.opening, first, 1 + math.ceil(abs((first - path.opening) / spacing)))
    parts = [(part.name, _Work(scene, part)) for part in _elements(scene)]
    for value in ahead:
        path.to(float(value))
        for _, part in parts:  # openings are counted from one place to the next
            part.along(path.places, path.tangent)
    path.check()
    acting = [*path.balance.acting, *(each for _, part in parts for each in part.acting)]
    names = [name for name, _ in parts] + [_bearing(scene, hinge) for hinge in scene.bearings]
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


def parts_of(scene) -> dict[str, str]:
    """The parts of the virtual work in a scene, with their classes (Kind.resists_as)."""
    found = {part.name: part.resists_as for part in _elements(scene)}
    found = {_bearing(scene, hinge): "FR" for hinge in scene.bearings} | found
    return found | ({STRAIN: "S"} if scene.beams else {})


def springs_of(scene) -> list[str]:
    """The parts that are springs on joints, by tables too."""
    return [
        part.name for part in _elements(scene)
        if isinstance(part.balanced, TorsionSpring | TableSpring) and part.resists_as == "S"
    ]  # fmt: skip


def classes_of_kinds(scene) -> dict[str, str]:
    """The classes that parts have by what they are, whatever a file says; but a table is a spring
    where it says so."""
    own = {_bearing(scene, hinge): "FR" for hinge in scene.bearings}
    for part in _elements(scene):
        own[part.name] = "FR" if part.less else type(part.balanced).resists_as
        if isinstance(part.balanced, TableSpring) and part.resists_as == "S":
            own[part.name] = "S"
    return own


def reeled(scene) -> list[str]:
    """Parts that follow a curve of time in a way that a travel cannot: cables that are reeled."""
    names = [name for c in scene.cables if c.curve >= 0 and c.reel for name in _of_cable(scene, c)]
    return [name for name in parts_of(scene) if name in names]


def _of_cable(scene, cable: Cable) -> tuple[str, ...]:
    return cable.title(scene), f"friction {cable.title(scene)}"


class _Part(NamedTuple):
    """What acts: an element, or the worst of several that stand for it, less another one; drags:
    whether it only resists."""

    name: str
    elements: tuple[Kind, ...]
    resists_as: str
    drags: bool
    less: Kind | None = None

    @property
    def balanced(self) -> Kind:
        """What stands for it in the balance."""
        return self.elements[-1]


class _Work:
    """The forces of a part, and its virtual work."""

    def __init__(self, scene, part: _Part):
        self.less, self.drags = part.less is not None, part.drags
        elements = [*part.elements, *([part.less] if self.less else [])]
        self.acting = [Acting(scene, [element]) for element in elements]

    def come(self, places: At, behind: np.ndarray) -> None:
        """Let what only resists come to places along a straight motion `behind` (6n,), so that it
        slips the way that its joint goes there, which may have turned back on the way before."""
        for share in (1.0, 0.5) if self.drags else ():
            for each in self.acting:
                each.forces(places.displace(-share * behind))

    def along(self, places: At, tangent: np.ndarray) -> float:
        """Virtual work: the least of its elements', or the difference to the other one."""
        self._forces = np.array([each.forces(places) for each in self.acting])
        found = self._forces @ tangent
        return float(found[0] - found[1] if self.less else found.min())

    def rubs(self) -> np.ndarray | float:
        """Forces and moments (6n,) as of `along` where it only resists, else 0."""
        if not self.drags:
            return 0.0
        return self._forces[0] - self._forces[1] if self.less else self._forces[0]


def _elements(scene) -> list[_Part]:
    """All that acts, named as the action of the structure's file that it is of, with what it is
    where that is of several; else by what it is, and a number where that is said twice."""
    found, count = [], Counter()
    kinds = [k for k in kinds_of([scene]) if k.resists_as and k is not Beams and acts(k)]
    several = Counter(name for (k, _), name in scene.action_names.items() if k in kinds)
    bearings = {_bearing(scene, hinge) for hinge in scene.bearings}
    for kind in kinds:
        own = kind.resists_as
        for i, (name, element) in enumerate(zip(kind.names(scene), kind.led(scene), strict=True)):
            if (action := scene.action_names.get((kind, i))) and name not in bearings:
                name = f"{action} ({name})" if several[action] > 1 else action
            count[name] += 1
            name = f"{name} #{count[name]}" if count[name] > 1 else name
            is_class = scene.classes.get((kind, i), own)
            found.append(_Part(name, _at_any_time(scene, element), is_class, own in DRAGS))
    for cable, smooth in zip(scene.cables, Cable.led(scene), strict=True):
        if cable.rubs:
            found.append(_Part(_of_cable(scene, cable)[1], (cable,), "FR", True, smooth))
    return found


def _at_any_time(scene, element: Kind) -> tuple[Kind, ...]:
    """An element; of one that a curve of time scales those with its least and largest value from
    the start on, the stronger one last."""
    if not isinstance(element, Load | TorqueMotor) or element.curve < 0:
        return (element,)
    times, values = scene.curves[element.curve]
    later = [np.interp(0.0, times, values), *np.array(values)[np.array(times) > 0]]
    factors = sorted({float(min(later)), float(max(later))}, key=abs)
    names = ("force", "moment") if isinstance(element, Load) else ("torque",)
    return tuple(
        replace(element, curve=-1, **{name: f * getattr(element, name) for name in names})
        for f in factors
    )


def _bearing(scene, hinge: int) -> str:
    return f"bearing {scene.hinges[hinge].name}"


class _Balance:
    """Bars, and what else has no losses, for the balance of an assembly (fpm/assembly)."""

    def __init__(self, scene):
        self._bars = elastic_of(scene)
        by_kind: dict[type, list] = {}
        for part in _elements(scene):
            if not part.drags:
                by_kind.setdefault(type(part.balanced), []).append(part.balanced)
        self.acting = [Acting(scene, elements) for elements in by_kind.values()]

    def strain(self, places: At) -> float:
        """Energy (J) of the bars."""
        return self._bars.energy(places) if len(self._bars.nodes) else 0.0

    def derivatives(self, places: At):
        """Gradient (6n,) and its derivatives, sparse (6n, 6n)."""
        gradient, stiffness = self._of_bars(places)
        for acting in self.acting:
            forces, slopes = acting.tried(places)
            gradient, stiffness = gradient - forces, stiffness + slopes
        return gradient, stiffness

    def ease(self, places: At, scales: np.ndarray) -> float:
        """What decides motions that nothing stiffens (N m)."""
        from scipy.sparse import diags

        own = diags(scales)
        soft = [acting.tried(places)[1] for acting in self.acting]
        bars, *others = (abs(own @ k @ own).max() for k in (self._of_bars(places)[1], *soft))
        return max(STIFF * bars, SOFT * max(others, default=0.0)) or 1.0

    def _of_bars(self, places: At):
        from scipy.sparse import csc_array

        if len(self._bars.nodes):
            return self._bars.derivatives(places)
        count = 2 * places.position.size
        return np.zeros(count), csc_array((count, count))

    def follow(self, places: At) -> None:
        """Everything has come here."""
        for acting in self.acting:
            acting.forces(places)


def _rows(conditions: Conditions, places: At):
    """Derivatives, sparse (c, 6n), of conditions."""
    return conditions.derivatives(places, np.zeros(len(conditions.joint)))[0]


def _turned(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """The rotations (n, 3) rad, below half a turn, from frames (n, 3, 3) to others."""
    turn = last @ first.transpose(0, 2, 1)
    skew = 0.5 * (turn - turn.transpose(0, 2, 1))
    axis = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
    sine, cosine = np.linalg.norm(axis, axis=1), 0.5 * (turn.trace(axis1=1, axis2=2) - 1)
    return axis * (np.arctan2(sine, cosine) / np.maximum(sine, TINY))[:, None]


def _forces_with_friction(
    base: Sequence[np.ndarray], slopes: Sequence[np.ndarray]
) -> tuple[np.ndarray, bool]:
    """The forces F (b,) N in bearings with their own friction, and whether there are such forces.

    F_i = |base_i + slopes_i F|, base_i (r,) being the force in joint i without the bearings'
    friction, slopes_i (r, b) how it goes with theirs. The solution is followed by Newton's method
    from no friction on; where its equations become singular, a bearing locks itself.
    """
    forces = np.array([np.linalg.norm(x) for x in base])
    for share in np.linspace(0.0, 1.0, 1 + SHARES)[1:]:
        for _ in range(ROUNDS):
            borne = [x + share * c @ forces for x, c in zip(base, slopes, strict=True)]
            size = np.array([np.linalg.norm(x) for x in borne])
            jacobian = np.eye(len(size)) - share * np.stack([
                x @ c / max(f, TINY) for x, c, f in zip(borne, slopes, size, strict=True)
            ])  # fmt: skip
            if np.linalg.det(jacobian) < LOCKED:
                return forces, False
            change = np.linalg.solve(jacobian, size - forces)
            forces = np.maximum(forces + change, 0.0)
            if np.abs(change).max() <= 1e-10 * forces.max(initial=TINY):
                break
        else:
            return forces, False
    return forces, True


class _Path:
    """Where a scene is on its way, `places`, with the motion `tangent` (6n,) per unit of the
    opening."""

    def __init__(self, scene, openings: Sequence[str], stand: Sequence[str]):
        self.scene, self.name = scene, openings[0]
        by_name = {hinge.name: hinge for hinge in scene.hinges}
        self._hinges, self.balance = [by_name[name] for name in openings], _Balance(scene)
        self.opening = self._start = float(self._hinges[0].opening)
        self.places = At(scene.position.copy(), scene.frame.copy())
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
        self._halved = 0
        self._jumps: list[float] = []  # openings at which it left its way
        self._opened = [float(hinge.opening) for hinge in scene.hinges]
        self._ease = self.balance.ease(self.places, self._scales)

    def to(self, value: float, depth: int = 0) -> None:
        """Lead the opening to a value, by as many steps as it takes to stay on one way;
        MisfitError where it cannot be."""
        before, tangents = self.state(), self._tangents
        jumped = any(min(before[1], value) <= place <= max(before[1], value)
                     for place in self._jumps)  # fmt: skip
        try:
            self._step(value)
            if jumped or not tangents or value == before[1] or self._stays(before, tangents):
                return
            if depth == HALVINGS:  # whatever lies between, it jumps here
                self._jumps.append(value)
                return
        except MisfitError:
            if jumped or not tangents or value == before[1] or depth == HALVINGS:
                raise
        self.restore(before)
        self._tangents = tangents
        self._halved += 1
        if self._halved > MOST_HALVED:
            raise SceneError(
                f"opening {self.name}", f"{value:.6g}", "a way on which motions agree with the "
                "rates at their ends; here they jump from place to place"
            )  # fmt: skip
        self.to(0.5 * (before[1] + value), depth + 1)
        self.to(value, depth + 1)

    def _stays(self, before: tuple, tangents: Sequence[np.ndarray]) -> bool:
        """Whether a motion agrees with the rates at both of its ends, and the assembly is the same
        one: where two meet, the conditions' derivatives have the other orientation on the other."""
        step = self.opening - before[1]
        shift = self.places.position - before[0].position
        turn = _turned(before[0].frame, self.places.frame)
        moved = np.stack([shift, turn], axis=1).ravel() / self._scales
        rates = 0.5 * step * (tangents[0] + self.tangent) / self._scales
        size = max(np.abs(moved).max(), np.abs(rates).max())
        if np.abs(moved - rates).max() > AGREES * size + NEAR:
            return False
        first, last = (self._derivatives(places) for places in (before[0], self.places))
        if first.shape[0] >= first.shape[1]:
            first, last = first.T, last.T
        sign = np.linalg.slogdet(first @ last.T)[0]
        return sign >= 0

    def _derivatives(self, places: At) -> np.ndarray:
        """Derivatives (c, f) of the conditions, scaled."""
        rows = _rows(self._conditions, places).multiply(self._scales).tocsc()[:, self._free]
        return self._weight[:, None] * rows.toarray()

    def _step(self, value: float) -> None:
        """Lead the opening to a value at once; MisfitError where it cannot be."""
        step, conditions = value - self.opening, self._held(value)
        weights = AHEAD[len(self._tangents) - 1] if self._tangents else []
        ahead = sum(w / sum(weights) * t for w, t in zip(weights, self._tangents, strict=True))
        places = self.places.displace(step * ahead) if self._tangents else self.places
        settled = False
        for _ in range(ROUNDS):
            solve, gradient = self._equations(places, conditions, self._ease)
            lacks = -self._weight * conditions.gaps(places)
            motion, change = solve(-gradient, lacks)
            largest = np.abs(motion).max(initial=0.0)
            if not np.isfinite(largest):
                break
            share = min(1.0, FARTHEST / largest) if largest > 0 else 1.0
            places = places.displace(share * self._scales * motion)
            self._impulses = self._impulses + share * change
            before, settled = settled, largest <= NEAR and np.abs(lacks).max(initial=0.0) <= NEAR
            if before and settled:
                self.places, self.opening, self.tangent = places, value, self._motion(solve)
                self._solve = solve
                self._tangents = [self.tangent, *(self._tangents[:3] if step else [])]
                self.balance.follow(places)
                return
        raise MisfitError(
            f"opening {self.name}", f"{value:.6g}", "openings to which it can be led, the joints "
            "closed and all else in balance; other openings that nothing decides may `stand`"
        )  # fmt: skip

    def state(self) -> tuple:
        """Where it is, to which `restore` brings it back."""
        return self.places, self.opening, self.tangent, self._impulses, self._opened

    def restore(self, state: tuple) -> None:
        """Go back to a state: the way on is then along its tangent."""
        self._tangents = self._tangents if state[1] == self.opening else [state[2]]
        self.places, self.opening, self.tangent, self._impulses, self._opened = state

    def opened(self) -> list[float]:
        """The openings of all hinges, on the turn that is nearest to where they were last."""
        at, found = SimpleNamespace(**self.places._asdict()), []
        for hinge, last in zip(self.scene.hinges, self._opened, strict=True):
            value = opening_at(at, hinge)
            turns = 0.0 if hinge.slides else round((last - value) / (2 * np.pi))
            found.append(value + 2 * np.pi * turns)
        for hinge in self._hinges:  # exactly
            found[self.scene.hinges.index(hinge)] = hinge.opening + self.opening - self._start
        self._opened = found
        return found

    def rates(self, hinges: Sequence[int]) -> list[float]:
        """Rates of the openings of hinges per unit of the one that is led."""
        shift, turn = self.tangent.reshape(-1, 2, 3).transpose(1, 0, 2)
        motion = SimpleNamespace(velocity=shift, spin=turn)
        return [float(rate_at(self.places, self.scene.hinges[h], motion)) for h in hinges]

    def _opens(self, hinge: Any) -> np.ndarray:
        """By how much an opening goes with each degree of freedom (6n,), as it is here."""
        way = np.zeros((len(self.scene.mass), 2, 3))
        for particle, kind, axis in product(hinge.particles, range(2), range(3)):
            unit = np.zeros_like(way)
            unit[particle, kind, axis] = 1.0
            motion = SimpleNamespace(velocity=unit[:, 0], spin=unit[:, 1])
            way[particle, kind, axis] = rate_at(self.places, hinge, motion)
        return way.ravel()

    def in_bearings(self, friction: np.ndarray) -> list[float]:
        """Virtual work of the friction by the forces of joints: all of a hinge's, those across a
        slide, in the balance with all friction; `friction` (6n,): that of what else only resists.

        SceneError where friction presses its joint harder than it is pushed: self-locking.
        """
        levers = np.array(list(self.scene.bearings.values()))
        if not len(levers):
            return []
        hinges = [self.scene.hinges[number] for number in self.scene.bearings]
        rates = np.array(self.rates(list(self.scene.bearings)))
        pushes = [-lever * np.sign(rate) * self._opens(hinge)
                  for lever, rate, hinge in zip(levers, rates, hinges, strict=True)]  # fmt: skip
        none = np.zeros(len(self._weight))
        first, *more = (self._solve(forces, none)[1] for forces in (friction, *pushes))
        joints, pushing = np.array(self._conditions.joint), self._conditions.axis_types != NORMAL
        own = [(joints == hinge.joint) & pushing for hinge in hinges]
        for rows in own:
            rows[-self._leading :] = False
        base = [(self._weight * (self._impulses + first))[rows] for rows in own]
        slopes = [np.stack([(self._weight * each)[rows] for each in more], axis=1) for rows in own]
        forces, solved = _forces_with_friction(base, slopes)
        if not solved:
            name = hinges[int(np.argmax(levers * forces))].name
            raise SceneError(
                f"bearing {name}", f"locked where opening {self.name} is {self.opening:.6g}",
                "a way on which no bearing's friction presses its joint harder than it is pushed "
                "(self-locking): less `mu`, or a way that ends before"
            )  # fmt: skip
        return [*(-levers * forces * np.abs(rates))]

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

    def _moving(self, places: At) -> np.ndarray:
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
        one, arms = found.axis1.copy(), found.arms.copy()
        for row, hinge, zero in zip(range(-count, 0), self._hinges, self._zeros, strict=True):
            axis, across = hinge.axes[0], hinge.references[0]
            if hinge.slides:
                arms[row, 0] += (moved - zero) * axis
                continue
            angle = hinge.opening + moved
            one[row] = np.cos(angle) * np.cross(axis, across) - np.sin(angle) * across
        return found._replace(axis1=one, arms=arms)
