"""Cables: tension only, between two points or running through several, which may rub.

Theory: docs/mechanics.md, "Cables": one tension all along without friction; with it one in each
stretch, by Eytelwein's law of the capstan. A winch takes cable in by a curve of time, a drum by the
opening of its joint. The point at which a cable leaves a drum does not move along with the
winding.

In the stable step are springs from each point to the ground, with shares s_i ~ |c_i|² w_i by the
inverse masses w_i, so that nothing is lost for free points. A cable that rubs is at most as stiff
as its stretches, each stuck at both ends, with their unstrained lengths at the start; where one
becomes much shorter, the balance of energies tells."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from fpm.declare import index, number, plain_field, topology
from fpm.elements.batch import turns_of
from fpm.elements.kind import (
    Deformations,
    ElementType,
    Energy,
    Eventful,
    Series,
    VirtualBeam,
    Watch,
)
from fpm.elements.openings.opening import Opening, mobility, relative_turn
from fpm.errors import SceneError

FACTOR = 2.0


class Piece(NamedTuple):
    """What has one tension: virtual beams to its points; stiffness (N/m) at its shortest; index of
    the hinge with the drum that winds it, -1: none; radius of the drum (m)."""

    beams: Sequence[VirtualBeam]
    stiffness: float
    drum: int = -1
    radius: float = 0.0


def bounding_springs(scene, cables: Iterable[Iterable[Piece]]) -> Deformations | None:
    """Return springs from the points of cables to the ground, and on the joints of drums, at least
    as stiff as the cables in any position, as Deformations for the stable time step; None if all
    points are held. scene: of the cables; cables: parts of each with one tension (Piece)."""
    rows = []
    for n, pieces in enumerate(cables):
        for beams, stiffness, drum, radius in pieces:
            factors = [1.0, *[FACTOR**2] * (len(beams) - 2), 1.0]
            motions = [(*_motion(scene, b), x) for b, x in zip(beams, factors, strict=True)]
            total = sum(square * inverse for _, inverse, square in motions)
            spin = mobility(scene, drum) if drum >= 0 else 0.0
            total += radius**2 * spin
            for beam, (values, inverse, _) in zip(beams, motions, strict=True):
                if inverse > 0:  # |c|²/s = total/w
                    dofs = np.tile(6 * beam.particle + np.arange(6), (3, 2))
                    springs = np.full(3, stiffness * total / inverse)
                    rows.append((dofs, values, springs, np.full(3, n)))
            if spin > 0:
                turns = relative_turn(scene, [drum], [stiffness * total / spin])
                rows.append((*turns[:3], np.full(len(turns.element), n)))
    return Deformations(*(np.concatenate(x) for x in zip(*rows, strict=True))) if rows else None


def _motion(scene, beam: VirtualBeam) -> tuple[np.ndarray, float]:
    """Rows (3, 12) of the motion of a beam's free end, and its largest inverse mass (1/kg)."""
    p = beam.particle
    frame = scene.frame if scene.unstrained is None else scene.unstrained
    turns = -np.array([np.cross(beam.arm, e) for e in np.eye(3)]).T
    values = np.hstack([np.eye(3), frame[p] @ turns, np.zeros((3, 6))])
    inertia = np.concatenate([np.full(3, scene.mass[p]), scene.inertia[p]])
    no_motion = np.concatenate([scene.fixed[p, :3], turns_of(scene).no_turn[p]])
    inverse = np.where(no_motion, 0.0, 1.0 / inertia)
    return values, float(np.linalg.eigvalsh((values[:, :6] * inverse) @ values[:, :6].T)[-1])


def with_arms(bounds, pulls: Iterable[tuple[int, VirtualBeam, float]]) -> Deformations | None:
    """Return `bounds` (Deformations of cables or struts, or None) with springs against turns of the
    arms at whose ends forces act, F times the arm, which bear what a force that keeps its direction
    does to a body that turns; about the arm itself it has no moment. pulls: index of the element,
    arm and force (N) of each."""
    rows = [bounds] * (bounds is not None)
    for n, beam, force in pulls:
        length = float(np.linalg.norm(beam.arm))
        if stiffness := force * length:
            dofs, turns = np.tile(6 * beam.particle + np.arange(6), (3, 2)), np.zeros((3, 12))
            turns[:, 3:6] = np.eye(3) - np.outer(beam.arm, beam.arm) / length**2
            rows.append((dofs, turns, np.full(3, stiffness), np.full(3, n)))
    return Deformations(*(np.concatenate(x) for x in zip(*rows, strict=True))) if rows else None


REEL_WORK = Energy("reel", "reel_work", "work of reeling cables in")

FRICTION_LOSS = Energy("cable_friction", "cable_friction_loss", "energy lost by friction of cables")

FRICTION_COST = 300.0
"""Core time (ns) of a stretch with friction in a step."""


SHORTEST = 0.25
"""Share of a cable's unstrained length at the start down to which a drum may wind it."""


@dataclass(frozen=True)
class Cable(ElementType):
    """A cable through the free ends of two or more virtual beams (rigid arms from particles). name:
    no other cable's; beams: arms to its points; stiffness: EA (N); rest: unstrained length (m);
    reel: length (m) that a winch takes in where the curve of time of index `curve` is 1 (-1: no
    winch); friction: coefficient at points between its ends, None: none; drum: index of the hinge
    whose opening winds it at the first point (-1: none); radius: of the drum (m), below 0 where a
    growing opening unwinds it; start: opening (rad) at which `rest` is outside the drum; least:
    unstrained length (m) outside the drum down to which it may be wound."""

    name: str = topology()
    beams: tuple[VirtualBeam, ...] = plain_field()
    stiffness: float = number("N", above=0.0, words="EA of {title}")
    rest: float = number("m", words="unstrained length of {title}")
    reel: float = number("m", default=0.0, zero=False)
    curve: int = index("curves", -1, default=-1)
    friction: float | None = number(least=0.0, default=None)
    drum: int = index("hinges", -1, default=-1)
    radius: float = number("m", default=0.0, zero=False)
    start: float = number("rad", default=0.0, is_shown=False)
    least: float = number("m", 0.0, default=0.0, zero=False)

    noun, name_field = "cable", "name"
    acts_as = "other"
    resists_as = "S"
    cost = 60.0

    stores = Energy("cable", "cable_energy", "strain energy of the cables")
    gives = REEL_WORK
    takes = FRICTION_LOSS
    events = ("tightens", "slackens")
    watches = (
        Watch("crowding", 1.0, True, lambda values: (
            f"a cable is longer than at rest by {values['crowding']:.2g} times its shortest "
            "stretch", "points that meet under tension need a pulley's size: keep them apart",
        )),
        Watch("drum", 1.0, True, lambda values: (
            f"a drum winds a cable down to {1 / values['drum']:.3g} of its `shortest`",
            "state a shorter `shortest`, for which the step is taken, or a stop on the drum's "
            "joint",
        )),
    )  # fmt: skip

    @staticmethod
    def create(scene, name, points, stiffness, rest, preload, **fields) -> "Cable":
        """Return a cable through points of a scene, as placed now; `Scene.add_cable` adds it, and
        says what the arguments are (stiffness: EA). SceneError if they do not fit."""
        count = len(scene.position)
        particles = [particle for particle, _ in points]
        if len(points) < 2 or not all(0 <= p < count for p in particles):
            raise SceneError(f"points of cable {name}", particles, "two or more, on particles")
        if (rest is None) == (preload is None):
            pair = (rest, preload)
            raise SceneError(f"rest, preload of cable {name}", pair, "one of the two")
        beams = tuple(scene.arm_to(int(p), place) for p, place in points)
        stiffness, curve = float(stiffness), int(fields.get("curve", -1))
        if rest is None:
            if not (stiffness > 0 and 0 <= preload < np.inf):
                pair, allowed = (stiffness, preload), "EA > 0 and a preload >= 0 (N)"
                raise SceneError(f"EA, preload of cable {name}", pair, allowed)
            factor = scene.curve(curve).value(0.0)
            reel_length = fields.get("reel", 0.0) * factor
            rest = length_through(scene, beams) / (1 + preload / stiffness) + reel_length
        if 0 <= (drum := fields.get("drum", -1)) < len(scene.hinges):
            fields["start"] = scene.hinges[drum].opening
        if fields.get("least") is None:
            fields["least"] = SHORTEST * rest if drum >= 0 else 0.0
        return Cable(name, beams, stiffness, float(rest), **fields)

    def check(self, scene):
        super().check(scene)
        owner = f"of {self.title(scene)}"
        if self.name in Cable.names_of(scene):
            raise SceneError("cable", self.name, "a name that no other cable has")
        if self.reel and self.curve < 0:
            raise SceneError(f"reel {owner}", self.reel, "a length with a `curve`")
        if self.drum >= 0 and scene.hinges[self.drum].slides:
            allowed = "a joint whose opening is an angle"
            raise SceneError(f"drum {owner}", scene.hinges[self.drum].name, allowed)
        if (self.drum >= 0) != (self.radius != 0):
            allowed = "a length other than 0 with a `drum`, none without"
            raise SceneError(f"radius {owner}", self.radius, allowed)
        if self.drum >= 0 and self.curve >= 0:
            allowed = "none, with a `reel` and `curve`"
            raise SceneError(f"drum {owner}", scene.hinges[self.drum].name, allowed)
        if self.drum >= 0 and not 0 < self.least < (rest := self.rest_at(scene, 0.0)):
            allowed = f"above 0 m, below the unstrained length at the start, {rest:.6g} m"
            raise SceneError(f"shortest length {owner}", self.least, allowed)
        if self.has_friction and not self.lengths(scene).min() > 0:
            raise SceneError(f"stretches {owner}", self.lengths(scene).tolist(), "points apart")
        if len({beam.particle for beam in self.beams}) < 2:
            raise SceneError(f"points {owner}", self.beams[0].particle, "points of two particles")
        if not (shortest := self.shortest(scene)) > 0:
            raise SceneError(f"unstrained length {owner}", shortest, "above 0 m at all times")

    def rest_at(self, scene, time: float) -> float:
        """Return the unstrained length (m) outside the winch at a `time` (s), or outside the drum
        at the start. scene: has the winch's curve and the drum's hinge."""
        factor = scene.curve(self.curve).value(time)
        turn = scene.hinges[self.drum].opening - self.start if self.drum >= 0 else 0.0
        return float(self.rest - self.reel * factor - self.radius * turn)

    def shortest(self, scene) -> float:
        """Return the least unstrained length (m) of the cable at any time. scene: has its curve."""
        factors = scene.curve(self.curve).extremes()
        if self.drum >= 0:
            return self.least
        return float(self.rest - np.max(self.reel * np.array(factors)))

    def acts_on(self):
        return (self.drum,) if self.drum >= 0 else ()

    @property
    def has_friction(self) -> bool:
        """Whether the cable has friction, and points between its ends where it acts."""
        return self.friction is not None and len(self.beams) > 2

    def lengths(self, scene) -> np.ndarray:
        """Distances (n - 1,), m, from each of the cable's n points to the next, now in `scene`."""
        places = [beam.end_in(scene) for beam in self.beams]
        return np.linalg.norm(np.diff(places, axis=0), axis=1)

    def pieces(self, scene) -> Iterator[Piece]:
        """Yield the parts of the cable that have one tension each, at the least unstrained length:
        the whole, or with friction each stretch; a drum winds the first."""
        shortest = self.shortest(scene)
        if not self.has_friction:
            yield Piece(self.beams, self.stiffness / shortest, self.drum, self.radius)
            return
        lengths = self.lengths(scene)
        for i, length in enumerate(lengths):
            stiffness = self.stiffness * lengths.sum() / (shortest * length)
            drum = self.drum if i == 0 else -1
            yield Piece(self.beams[i : i + 2], stiffness, drum, self.radius)

    def pulls(self, scene) -> Iterator[tuple[VirtualBeam, float]]:
        """Yield the arm to every point and the force (N) there at the start."""
        strain = self.lengths(scene).sum() / self.rest_at(scene, 0.0) - 1
        for i, beam in enumerate(self.beams):
            is_end = i in (0, len(self.beams) - 1)
            yield beam, self.stiffness * max(strain, 0.0) * (1 if is_end else 2)

    def topology(self):
        particles = tuple(beam.particle for beam in self.beams)
        return self.name, particles, self.curve, self.has_friction, self.drum

    @classmethod
    def names_of(cls, scene) -> tuple[str, ...]:
        """Names of a scene's cables as stated, in their order."""
        return tuple(cable.name for cable in cls.find(scene))

    @classmethod
    def reads_in(cls, scene):
        return (Opening,) if any(cable.drum >= 0 for cable in cls.find(scene)) else ()

    @classmethod
    def eventful(cls, scene):
        """Return all cables of a scene, then inner points of those with friction, from 2 on."""
        points = [
            Eventful(f"{cable.title(scene)} point {i}", ("sticks", "slips"))
            for cable in cls.find(scene) if cable.has_friction
            for i in range(2, len(cable.beams))
        ]  # fmt: skip
        return [*super().eventful(scene), *points]

    @classmethod
    def cost_in(cls, scene):
        costs = [cls.cost if cable.friction is None else FRICTION_COST for cable in cls.find(scene)]
        counts = [len(cable.beams) - 1 for cable in cls.find(scene)]
        return float(np.dot(costs, counts))

    @classmethod
    def sweep_elements(cls, scene):
        """Return copies without friction, which fpm/travel counts by itself."""
        return [replace(cable, friction=None) for cable in cls.find(scene)]

    @classmethod
    def deformations(cls, scene):
        """Arms bear the tension at the start; a larger one strains the cable to beyond its
        shortest arm."""
        bounds = bounding_springs(scene, (cable.pieces(scene) for cable in cls.find(scene)))
        cables = enumerate(cls.find(scene))
        return with_arms(bounds, ((i, *pull) for i, c in cables for pull in c.pulls(scene)))

    @classmethod
    def pack(cls, batch):
        from fpm.elements.cables.cable_kernels import CABLE, NUMBERS, STATE, STRETCH, Cables

        cables = cls.find(batch.scene)
        count, ends = len(cables), np.cumsum([0, *(len(cable.beams) for cable in cables)])
        part = Cables(
            start=batch.integers(ends),
            particle=batch.integers(beam.particle for cable in cables for beam in cable.beams),
            curve=batch.integers(cable.curve for cable in cables),
            arms=batch.stack(ends[-1], 3, lambda s: [b.arm for c in cls.find(s) for b in c.beams]),
            cables=batch.table(cls, CABLE, lambda c: [getattr(c, name) for name in NUMBERS]),
            stretches=batch.blank(ends[-1], STRETCH),
            state=batch.blank(count, STATE),
            account=batch.work_account(cls),
            peaks=batch.peaks_of(cls),
            rows=batch.rows_of(cls),
            log=batch.log_of(cls),
            track=batch.blank((batch.instants + 1) * count, 2),
            stretch_track=batch.blank((batch.instants + 1) * ends[-1], 2),
            drum=batch.integers(cable.drum for cable in cables),
            openings=Opening.get_arrays(cls, batch) if cls.reads_in(batch.scene) else None,
        )
        return _with_friction(part, batch) if any(cable.has_friction for cable in cables) else part

    @classmethod
    def read_records(cls, part, scene, lane):
        """`cable_slip` (m, unstrained) is what has run over each point, > 0 towards the end."""
        names = cls.names_of(scene)
        tension, length = part.track[:, :, lane].T.reshape(2, -1, len(names))
        return {
            "cable_tension": Series(tension, "N", "tension of the cables", "cable", names),
            "cable_length": Series(length, "m", "length of the cables, strained", "cable", names),
            **_stretch_records(part, cls.find(scene), lane),
        }


def _stretch_records(part, cables, lane) -> dict[str, Series]:
    """Tensions of stretches and slips over points of cables that run over points."""
    pulls, lengths = part.stretch_track[:, :, lane].T.reshape(2, -1, len(part.particle))
    columns: dict[str, dict] = {"stretch_tension": {}, "cable_slip": {}}
    for first, cable in zip(part.start, cables, strict=False):
        count = len(cable.beams) - 1
        stretches = slice(first, first + count)
        rest = lengths[:, stretches] / (1 + pulls[:, stretches] / cable.stiffness)
        remainder = np.cumsum(rest[:, ::-1], axis=1)[:, ::-1]  # unstrained, from each stretch on
        for i in range(count if count > 1 else 0):
            columns["stretch_tension"][f"{cable.name} {i + 1}"] = pulls[:, first + i]
            if i > 0:
                columns["cable_slip"][f"{cable.name} {i + 1}"] = remainder[:, i] - remainder[0, i]
    texts = {
        "stretch_tension": ("N", "tension of the stretches of cables", "stretch"),
        "cable_slip": ("m", "length of cable that ran over its points", "cable_point"),
    }
    return {
        name: Series(np.column_stack(list(values.values())), *texts[name], tuple(values))
        for name, values in columns.items()
        if values
    }


def _with_friction(part, batch):
    """Return the arrays of cables of which some rub."""
    from fpm.elements.cables.cable_friction_kernels import MATERIAL, SLIP_SIZE, RubbingCables
    from fpm.elements.cables.cable_kernels import UNSTRAINED

    def material(scene) -> np.ndarray:
        """Unstrained lengths (m) of all stretches at the start, at one strain along each cable."""
        array = np.zeros((len(part.particle), SLIP_SIZE))
        for first, cable in zip(part.start, Cable.find(scene), strict=False):
            lengths = cable.lengths(scene)
            rest = lengths * (cable.rest_at(scene, 0.0) / lengths.sum())
            array[first : first + len(rest), MATERIAL] = rest
        return array

    rests = batch.stack(len(part.state), 1, lambda s: [[c.rest_at(s, 0.0)] for c in Cable.find(s)])
    part.state[:, UNSTRAINED] = rests[:, 0]
    return RubbingCables(
        *part,
        has_friction=batch.integers(cable.has_friction for cable in Cable.find(batch.scene)),
        friction=batch.table(Cable, 1, lambda cable: [cable.friction or 0.0]),
        slip=batch.stack(len(part.particle), SLIP_SIZE, material),
        loss=batch.loss_account(Cable),
    )


def length_through(scene, beams: Sequence[VirtualBeam]) -> float:
    """Return the length (m) of the open line through the free ends of virtual beams (rigid arms),
    in their order, as placed in the scene: that of a cable through them."""
    places = [beam.end_in(scene) for beam in beams]
    return float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())
