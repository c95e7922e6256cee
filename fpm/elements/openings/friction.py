"""Coulomb friction on hinges that really sticks: an elastoplastic bristle, or without one.

Theory: docs/mechanics.md, "On hinges: dampers, friction" and "Openings that are held exactly"
(Dupont, Hayward, Armstrong, Altpeter, IEEE Trans. Automatic Control 47 (2002) 787).

Without a bristle, at a rate r that would fall by d in a step, what sticks does so where M brings it
to rest: the last way is the rest of the parabola, h (r - d/2)²/(2 d), or h r²/(2 d) where it is
braked only now. An impact after the share s of a step comes after 1/2 + s of its kick: friction
that stuck with M' has (1/2 + s) M' ± (1/2 - s) M in that kick."""

from dataclasses import dataclass, replace

import numpy as np

from fpm.declare import damping, number
from fpm.elements.joints.hinge import Hinge
from fpm.elements.joints.joint import Joint
from fpm.elements.joints.turn import ExactConnector
from fpm.elements.kind import Energy, Watch
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    mobility,
    moving_at_start,
    on_hinge,
    pack_past,
    start_angles,
    turning_at_start,
)
from fpm.elements.openings.table_spring import bends, check_table, table_array
from fpm.errors import SceneError

DEFLECTION = 1e-3
"""Angle (rad) by which a bristle is bent before it slips, if nothing else is said."""

SLIDE_DEFLECTION = 1e-4
"""Way (m) by which a bristle on a slide is bent before it slips, if nothing else is said."""

SWEEP_DEFLECTION = 1e-9
"""Deflection (rad, m) of bristles where openings are moved slowly (fpm/travel)."""

RATE_TOL = 1e-11
"""Rate up to which a hinge sticks at the start, as a share of the fastest spin; what joins it to
others leaves a tenth (AGREES in solver/start.py)."""

LOCKS = 20.0
"""By how many times its `bristle_deflection` a bearing's bristle may be bent on while the moment at
which it slips grows as much or more: then it never slips, and all the motion is the bristle's."""

DAMPING_RATIO = 0.3
"""Damping ratio of the bristle with the inertias of the hinge's own two particles, likewise. The
step of a scene that it limits is 0.57 of the one without."""


def _describe_imbalance(element: str) -> str:
    """Return the remedy of a bearing whose friction goes with a force that changes much in a step.
    Beyond self-locking (mu tan t > 1) the force on rigid bodies has two values or none (Painleve,
    Lecons sur le frottement, 1895); a start there may come upon the wrong one."""
    if not element.startswith("bearing"):
        return ""
    return (
        "the friction of this bearing goes with its joint's force of the step before, which jumps: "
        "begin the motion slowly, or outside of self-locking (mu tan(angle) below 1); less `mu`; a "
        "`load` near the joint's force at the start; halve solver.step"
    )


@dataclass(frozen=True)
class Friction(ExactConnector):
    """Friction in a hinge by a bristle: a spring that sticks, and slips at a moment. Without
    `bristle_deflection` it sticks exactly. angles, shares: joint coordinates (rad, m), increasing,
    and factors of the moment there, linear between, constant beyond; (): 1 everywhere. load: size
    (N) of the whole force in the joint at which it slips at `moment`, which is proportional to it;
    None: constant."""

    hinge: int = on_hinge()
    moment: float = number("N m", 0.0, text="moment at which it slips; below this it sticks")
    bristle_deflection: float | None = number(
        "rad", above=0.0, default=DEFLECTION, is_shown=False, optional=True,
        text="deflection at which it slips",
    )  # fmt: skip
    damping: float | None = damping(
        default=None,
        text="damping while it sticks; default: 0.3 of critical damping for the joint's two "
        "particles",
    )
    angles: tuple[float, ...] = ()  # increasing (rad), with the shares of `moment` there, straight
    shares: tuple[float, ...] = ()  # between; without them all of it everywhere
    load: float | None = None  # force (N) that the joint bears at `moment`, which goes with it

    stores = Energy("friction", "friction_energy", "energy of the bristles of friction")
    takes = JOINT_LOSS
    acts_as = "friction"
    noun = "friction"
    resists_as = "FR"
    watches = (
        Watch("lock", LOCKS, True, lambda values: (
            "a bearing locks itself: its friction presses its joint harder than it is pushed, and "
            f"was bent by {values['lock']:.3g} times its `bristle_deflection` without slipping",
            "no motion is possible from there on: start it at an angle below that of friction, or "
            "end it before; less `mu`; a `load` near the force of the joint, where that is far "
            "larger",
        ), remedy=_describe_imbalance),
    )  # fmt: skip

    @classmethod
    def sweep_elements(cls, scene):
        """Bristles slip at once. One with a `load` gets moment 0: Scene.bearings gives it."""
        frictions = [
            replace(friction, bristle_deflection=SWEEP_DEFLECTION, damping=0.0)
            for friction in cls.find(scene)
        ]
        return [f if f.load is None else replace(f, moment=0.0, load=None) for f in frictions]

    def add_to(self, scene):
        """One with a `load` adds moment / load (m; on slides without unit) to scene.bearings."""
        super().add_to(scene)
        if self.load is not None:
            scene.bearings[self.hinge] += self.moment / self.load

    @classmethod
    def reads_impulses(cls, scene):
        return any(friction.load is not None for friction in cls.find(scene))

    def check(self, scene):
        super().check(scene)
        if self.is_exact and (self.load is not None or self.angles):
            allowed = "a bristle, where friction goes with the angle or the force"
            raise SceneError(f"bristle_deflection of {self.title(scene)}", None, allowed)
        if self.load is not None and not (self.load > 0 and not self.angles):
            raise SceneError(f"load of {self.title(scene)}", self.load, "above 0, without a table")
        if self.angles or self.shares:
            check_table(self.angles, self.shares, "shares", self.title(scene))
            if min(self.shares) < 0:
                raise SceneError(f"shares of {self.title(scene)}", self.shares, "none below 0")

    def topology(self):
        return self.hinge, len(self.angles), self.load is None, self.is_exact

    def title(self, scene):
        noun = "hysteresis" if self.angles else self.noun if self.load is None else "bearing"
        return f"{noun} {self.label(scene)}"

    @property
    def stiffness(self) -> float | None:  # type: ignore[override]  # no field here
        """Stiffness of the bristle (N m/rad, on slides N/m): moment / bristle_deflection."""
        return self.bristle_deflection and self.moment / self.bristle_deflection

    def damping_in(self, scene) -> float:
        if self.damping is not None or self.stiffness is None:
            return self.damping or 0.0
        inverse = mobility(scene, self.hinge)
        return 2 * DAMPING_RATIO * np.sqrt(self.stiffness / inverse) if inverse else 0.0

    def held_at_start(self, scene):
        (rate,) = turning_at_start(scene, [self.hinge])
        motion = moving_at_start(scene)
        speeds = motion.velocity if scene.hinges[self.hinge].slides else motion.spin
        fastest = np.abs(speeds).max(initial=0.0)
        return scene.hinges[self.hinge].opening if abs(rate) <= RATE_TOL * fastest else None

    @classmethod
    def held_round(cls, scene):
        return float(sum(f.moment for f in cls.find(scene) if f.is_exact))

    @classmethod
    def array(cls, name, batch):
        def bristle(f, scene):
            if f.is_exact:
                return 0.0, 0.0, 0.0, 0.0, f.moment
            most = f.bristle_deflection * (f.shares or (float(f.load is None),))[0]
            inverse_bend = 0.0 if f.load is None else 1.0 / f.bristle_deflection
            return f.stiffness, most, f.damping_in(scene), inverse_bend, f.moment

        def bristles(scene):
            return [bristle(f, scene) for f in cls.find(scene)]

        if name == "bearing":
            return _bearing_force(batch, cls)
        if name in ("start", "points"):
            if not any(f.angles for f in cls.find(batch.scene)):
                return None
            return table_array(
                name, batch, cls, lambda f: f.bristle_deflection * bends(f.angles, f.shares)
            )
        if name == "numbers":
            return batch.stack(len(cls.find(batch.scene)), 5, bristles)
        array = super().array(name, batch)
        if name == "state":
            array[:, cls.kernels().FOOT] = start_angles(batch, cls)
            kernels = cls.kernels()
            array[:, [kernels.MOST, kernels.OLD_MOST, kernels.FORCE_BEND]] = batch.table(
                cls, 1, lambda f: [0.0 if f.load is None else f.bristle_deflection]
            )
            array[:, kernels.SIGN] = np.where(pack_past(batch, cls)[:, 0] < 0, -1.0, 1.0)
        return array


def _bearing_force(batch, kind):
    """Return the forces of the joints of a kind's elements; None where none goes with them."""
    from fpm.elements.openings.losses_kernels import JointForce

    scene, elements = batch.scene, kind.find(batch.scene)
    if not kind.reads_impulses(scene):
        return None
    names = [scene.hinges[friction.hinge].joint for friction in elements]
    lone, first, count = np.full((3, len(names)), [[-1], [0], [0]])
    hinges, rows, impulses = (batch.blank(0, 1) for _ in range(3))
    if lone_names := [hinge.joint for hinge in Hinge.find(scene)]:
        hinges = batch.part(Hinge).sums
        lone[:] = [lone_names.index(name) if name in lone_names else -1 for name in names]
    if joints := [joint.name for joint in Joint.find(scene)]:
        part = batch.part(Joint)
        rows, impulses = part.rows, part.sums
        row = {joints[number]: j for j, number in enumerate(part.names)}
        for i, name in enumerate(names):
            if name in row:
                first[i], count[i] = (
                    x[row[name]] for x in (part.pattern.first, part.pattern.count)
                )
    slip_deflections = batch.table(
        kind, 1, lambda f: [0.0 if f.load is None else f.bristle_deflection / f.load]
    )
    return JointForce(slip_deflections, lone, first, count, hinges, rows, impulses)
