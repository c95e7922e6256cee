"""Cables: tension only, between two points or running through several without friction.

A cable of unstrained length R and stiffness EA runs straight from each of its points to the next;
with the length L of them all,

    strain e = (L - R) / R,   tension T = EA max(e, 0),   energy EA R max(e, 0)²/2

Points between its ends are pulleys of no radius: the tension is one all along. The unstrained
length may change with a curve of time, as when a winch takes cable in; the winch gives -T (1 + e/2)
dR/dt, the pull on the strained cable less the strain energy that leaves it, at the first point.

A cable that rubs at these points has a strain and a tension in every stretch. Its material slips
over a point, where the cable turns by the angle a, as soon as T' on one side is more than T exp(mu
a) on the other (Eytelwein's law of the capstan). A metre that slips from T to T' leaves T' (1 +
e'/2) - T (1 + e/2) to friction. Cables from point to point have none."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fpm.elements.bars.virtual_beam import VirtualBeam
from fpm.elements.cables.cable_bounds import Piece, bounding_springs
from fpm.elements.fields import index, number, topology
from fpm.elements.kind import ElementType, Energy, Series, Watch
from fpm.errors import SceneError

REEL_WORK = Energy("reel", "reel_work", "work of reeling cables in")

FRICTION_LOSS = Energy("cable_friction", "cable_friction_loss", "energy lost by friction of cables")

FRICTION_COST = 300.0
"""Core time (ns) of a stretch with friction in a step."""


def _describe_crowding(values: dict[str, float]) -> tuple[str, str]:
    return (
        f"a cable is longer than at rest by {values['crowding']:.2g} times its shortest stretch",
        "points that meet under tension need a pulley's size: keep them apart",
    )


@dataclass(frozen=True)
class Cable(ElementType):
    """A cable through the free ends of two or more virtual beams (rigid arms from particles). name:
    no other cable's; beams: arms to its points; stiffness: EA (N); rest: unstrained length (m);
    reel: length (m) that a winch takes in where the curve of time of index `curve` is 1 (-1: no
    winch); friction: coefficient at points between its ends, None: none."""

    name: str = topology()
    beams: tuple[VirtualBeam, ...]
    stiffness: float = number("N", above=0.0, words="EA of {title}")
    rest: float = number("m", words="unstrained length of {title}")
    reel: float = number("m", default=0.0)
    curve: int = index("curves", -1, default=-1)
    friction: float | None = number(least=0.0, default=None)

    noun = "cable"
    resists_as = "S"
    cost = 60.0

    stores = Energy("cable", "cable_energy", "strain energy of the cables")
    gives = REEL_WORK
    takes = FRICTION_LOSS
    events = ("tightens", "slackens")
    watches = (Watch("crowding", 1.0, True, _describe_crowding),)

    @staticmethod
    def create(scene, name, points, stiffness, rest, preload, reel, curve, friction) -> "Cable":
        """Return a cable through points of a scene, as placed now; the caller adds it. name: no
        other cable's; points: pairs of a particle's index and a global position (3,) m, None: its
        own; stiffness: EA (N); rest: unstrained length before reeling (m), or preload: tension at
        the start (N), the other None; reel: length (m) taken in where the curve of index `curve` is
        1 (-1: none); friction: coefficient or None. SceneError if they do not fit."""
        count = len(scene.position)
        particles = [particle for particle, _ in points]
        if len(points) < 2 or not all(0 <= p < count for p in particles):
            raise SceneError(f"points of cable {name}", particles, "two or more, on particles")
        if (rest is None) == (preload is None):
            pair = (rest, preload)
            raise SceneError(f"rest, preload of cable {name}", pair, "one of the two")
        beams = tuple(scene.arm_to(int(p), place) for p, place in points)
        curve, reel, stiffness = int(curve), float(reel), float(stiffness)
        if rest is None:
            if not (stiffness > 0 and 0 <= preload < np.inf):
                pair, allowed = (stiffness, preload), "EA > 0 and a preload >= 0 (N)"
                raise SceneError(f"EA, preload of cable {name}", pair, allowed)
            reel_length = reel * scene.curves[curve].value(0.0) if curve >= 0 else 0.0
            rest = length_through(scene, beams) / (1 + preload / stiffness) + reel_length
        return Cable(name, beams, stiffness, float(rest), reel, curve, friction)

    def check(self, scene):
        """Check that the cable fits into a scene: its numbers, a name that no other cable has,
        points on two or more particles, an unstrained length always above 0; else SceneError."""
        super().check(scene)
        owner = f"of {self.title(scene)}"
        if self.name in Cable.names_of(scene):
            raise SceneError("cable", self.name, "a name that no other cable has")
        if self.reel and self.curve < 0:
            raise SceneError(f"reel {owner}", self.reel, "a finite length (m), with a curve")
        if self.has_friction and not self.lengths(scene).min() > 0:
            raise SceneError(f"stretches {owner}", self.lengths(scene).tolist(), "points apart")
        if len({beam.particle for beam in self.beams}) < 2:
            raise SceneError(f"points {owner}", self.beams[0].particle, "points of two particles")
        if not (shortest := self.shortest(scene)) > 0:
            raise SceneError(f"unstrained length {owner}", shortest, "above 0 m at all times")

    def title(self, scene):
        return f"cable {self.name}"

    def rest_at(self, scene, time: float) -> float:
        """Unstrained length (m) outside the winch at a `time` (s). scene: has the winch's curve."""
        factor = scene.curves[self.curve].value(time) if self.curve >= 0 else 0.0
        return float(self.rest - self.reel * factor)

    def shortest(self, scene) -> float:
        """Return the least unstrained length (m) of the cable at any time. scene: has its curve."""
        factors = scene.curves[self.curve].extremes() if self.curve >= 0 else np.zeros(1)
        return float(self.rest - np.max(self.reel * np.array(factors)))

    @property
    def has_friction(self) -> bool:
        """Whether the cable has friction, and points between its ends where it acts."""
        return self.friction is not None and len(self.beams) > 2

    def lengths(self, scene) -> np.ndarray:
        """Distances (n - 1,), m, from each of the cable's n points to the next, now in `scene`."""
        places = [scene.position[b.particle] + scene.frame[b.particle] @ b.arm for b in self.beams]
        return np.linalg.norm(np.diff(places, axis=0), axis=1)

    def pieces(self, scene) -> Iterator[Piece]:
        """Yield the parts of the cable that have one tension each, as pairs (virtual beams, N/m of
        stiffness at the least unstrained length): the whole, or with friction each stretch."""
        shortest = self.shortest(scene)
        if not self.has_friction:
            yield self.beams, self.stiffness / shortest
            return
        lengths = self.lengths(scene)
        for i, length in enumerate(lengths):
            yield self.beams[i : i + 2], self.stiffness * lengths.sum() / (shortest * length)

    def topology(self):
        """Return what must agree in scenes run side by side: name, particles, curve, friction."""
        return self.name, tuple(beam.particle for beam in self.beams), self.curve, self.has_friction

    @classmethod
    def names_of(cls, scene) -> tuple[str, ...]:
        """Names of a scene's cables as stated, in their order."""
        return tuple(cable.name for cable in cls.find(scene))

    @classmethod
    def names(cls, scene):
        return [cable.title(scene) for cable in cls.find(scene)]

    @classmethod
    def cost_in(cls, scene):
        """Return the core time (ns) of all cables of a scene in a time step, to estimate run times:
        `cost` for each stretch between two points, RUBBING with friction."""
        costs = [cls.cost if cable.friction is None else FRICTION_COST for cable in cls.find(scene)]
        counts = [len(cable.beams) - 1 for cable in cls.find(scene)]
        return float(np.dot(costs, counts))

    @classmethod
    def sweep_elements(cls, scene):
        """Return copies of a scene's cables without friction, for moving a joint coordinate slowly
        through static equilibria (fpm/travel), which counts friction by itself."""
        return [replace(cable, friction=None) for cable in cls.find(scene)]

    @classmethod
    def deformations(cls, scene):
        """Return springs (Deformations) at least as stiff as the cables of a scene can become, for
        the stable time step; None without cables, or if all their points are held."""
        return bounding_springs(scene, (cable.pieces(scene) for cable in cls.find(scene)))

    @classmethod
    def pack(cls, batch):
        from fpm.elements.cables.cable_kernels import CABLE, STATE, STRETCH, Cables

        cables = cls.find(batch.scene)
        count, ends = len(cables), np.cumsum([0, *(len(cable.beams) for cable in cables)])
        part = Cables(
            start=batch.integers(ends),
            particle=batch.integers(beam.particle for cable in cables for beam in cable.beams),
            curve=batch.integers(cable.curve for cable in cables),
            arms=batch.stack(ends[-1], 3, lambda s: [b.arm for c in cls.find(s) for b in c.beams]),
            cables=batch.table(cls, CABLE, lambda c: [c.stiffness, c.rest, c.reel]),
            stretches=batch.blank(ends[-1], STRETCH),
            state=batch.blank(count, STATE),
            account=batch.work_account(cls),
            peaks=batch.peaks_of(cls),
            rows=batch.rows_of(cls),
            log=batch.log_of(cls),
            track=batch.blank((batch.instants + 1) * count, 2),
        )
        return _with_friction(part, batch) if any(cable.has_friction for cable in cables) else part

    @classmethod
    def read_records(cls, part, scene, lane):
        """Return tension (N) and strained length (m) of all cables of one sample after a run,
        Series (t, cables) named "cable_tension", "cable_length". part: kernel arrays (Cables);
        scene: the sample's; lane: index of the sample among those simulated side by side."""
        names = cls.names_of(scene)
        tension, length = part.track[:, :, lane].T.reshape(2, -1, len(names))
        return {
            "cable_tension": Series(tension, "N", "tension of the cables", "cable", names),
            "cable_length": Series(length, "m", "length of the cables, strained", "cable", names),
        }


def _with_friction(part, batch):
    """The arrays of cables of which some rub: unstrained lengths of all stretches as well."""
    from fpm.elements.cables.cable_friction_kernels import RubbingCables
    from fpm.elements.cables.cable_kernels import UNSTRAINED
    from fpm.elements.cables.cable_slip_kernels import MATERIAL, SLIP_SIZE

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
    places = [scene.position[b.particle] + scene.frame[b.particle] @ b.arm for b in beams]
    return float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())
