"""Synchronising loops: closed cables over pulleys on two hinges, so that these open together.

Theory: docs/mechanics.md, "Loops, motors and releases"."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fpm.declare import index, number, stiffness, topology
from fpm.elements.kind import Deformations, Energy
from fpm.elements.openings.opening import ConnectorElement, backlashes, mobility, relative_turn
from fpm.errors import SceneError


@dataclass(frozen=True)
class SyncLoop(ConnectorElement):
    """A closed cable loop over pulleys on two hinges, which couples their openings (joint angles):
    with radii of one sign, both open together. It pulls at the rims with stiffness times slip, r1
    (psi1 - rest1) - r2 (psi2 - rest2) (m); a strand is slack above a slip of 2 preload / stiffness.
    Half of the backlash lies to either side."""

    name: str = topology()
    hinges: tuple[int, int] = index("hinges", words="hinge of {title}", only_angles=True)
    radii: tuple[float, float] = number(
        "m", count=2, text="radii of the pulleys, with opposite signs for a crossed loop"
    )
    stiffness: float = stiffness(
        "N/m", "{title} stiffness", text="force at the rims per metre of relative travel: 2 EA/l"
    )
    rest: tuple[float, float] = number(
        "rad", default=(0.0, 0.0), count=2, text="openings at which the loop exerts no force"
    )
    preload: float = number(
        "N",
        0.0,
        finite=False,
        default=np.inf,
        text="tension of each strand; default: no strand becomes slack",
    )
    backlash: float | None = number(
        "m",
        0.0,
        default=None,
        text="total play at the rims, as between teeth; only without `preload`; default: none",
    )

    stores = Energy("loop", "loop_energy", "energy of the synchronising loops")
    events = ("tightens", "slackens")
    acts_as = "loop"
    noun, name_field = "loop", "name"
    series: ClassVar = {"loop_force": ("N", "pull of the loops", "loop")}
    resists_as = "S"
    has_memory = False

    def check(self, scene):
        super().check(scene)
        title = self.title(scene)
        if self.name in [loop.name for loop in SyncLoop.find(scene)]:
            raise SceneError("loop", self.name, "a name that no other loop has")
        if len(set(self.hinges)) != 2:
            raise SceneError(f"hinges of {title}", self.hinges, "two different ones")
        if not np.all(self.radii):
            raise SceneError(f"radii of {title}", self.radii, "lengths (m) other than 0")
        if self.backlash is not None and self.preload < np.inf:
            allowed = "none, with a backlash"
            raise SceneError(f"preload of {title}", self.preload, allowed)

    def topology(self):
        return *super().topology(), self.backlash is None

    def acts_on(self):
        return self.hinges

    @property
    def tight(self) -> float:
        """Slip (m, one strand longer than at rest) at which the other turns slack; inf: never."""
        return 2 * self.preload / self.stiffness if self.stiffness > 0 else np.inf

    @classmethod
    def deformations(cls, scene):
        """One spring on each hinge of a loop, both together at least as stiff as the loop. By
        Cauchy and Schwarz (r1 psi1 - r2 psi2)² <= r1² psi1²/s1 + r2² psi2²/s2 with s1 + s2 = 1.
        With s1 : s2 as r² w, where w is each hinge's `mobility`, the bound is exact if they share
        no body."""
        hinges, stiffness, element = [], [], []
        for i, loop in enumerate(cls.find(scene)):
            soft = [mobility(scene, hinge) for hinge in loop.hinges]
            total = sum(r**2 * w for r, w in zip(loop.radii, soft, strict=True))
            for hinge, w in zip(loop.hinges, soft, strict=True):
                if w > 0:
                    hinges.append(hinge)
                    stiffness.append(loop.stiffness * total / w)
                    element.append(i)
        if not hinges:
            return None
        rows = relative_turn(scene, hinges, stiffness)
        return Deformations(*rows[:3], np.array(element)[rows.element])

    @classmethod
    def array(cls, name, batch):
        if name == "hinge":
            return batch.integers((loop.hinges for loop in cls.find(batch.scene)), 2)
        if name == "backlash":
            return backlashes(batch, cls)
        return super().array(name, batch)
