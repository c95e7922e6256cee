"""What a scene is made of: one kind of element per definition file, with its kernels beside it."""

from fpm.elements.bars.bar_damping import BarDamping
from fpm.elements.bars.beam import Beams
from fpm.elements.cables.cable import Cable
from fpm.elements.cables.strut import Strut
from fpm.elements.joints.hinge import Hinge
from fpm.elements.joints.joint import Joint
from fpm.elements.joints.turn import Turn
from fpm.elements.kind import ElementType
from fpm.elements.openings.damper import Damper
from fpm.elements.openings.friction import Friction
from fpm.elements.openings.journal import Journal
from fpm.elements.openings.latch import Latch
from fpm.elements.openings.motor import Motor
from fpm.elements.openings.opening import Opening
from fpm.elements.openings.release import Release
from fpm.elements.openings.stop import Contact, Stop
from fpm.elements.openings.sync_loop import SyncLoop
from fpm.elements.openings.table_spring import TableSpring
from fpm.elements.openings.torque_motor import TorqueMotor
from fpm.elements.openings.torsion_spring import TorsionSpring
from fpm.elements.particles.damping import Damping
from fpm.elements.particles.drag import Drag
from fpm.elements.particles.drive import Drive
from fpm.elements.particles.load import Gravity, Load
from fpm.elements.particles.probe import Probe
from fpm.elements.particles.support import Support
from fpm.elements.reads import SceneList

KINDS: tuple[type[ElementType], ...] = (
    Gravity,
    Beams,
    Opening,
    Hinge,
    TorsionSpring,
    Contact,
    Load,
    Cable,
    SyncLoop,
    Motor,
    TorqueMotor,
    Release,
    Latch,
    Damper,
    Friction,
    Stop,
    TableSpring,
    Turn,
    Drag,
    Strut,
    Journal,
    BarDamping,
    Drive,
    Support,
    Damping,
    Joint,
    Probe,
)
"""The registry. The order is that of sums, hence of the last digits: add new kinds at the end,
before Drive if they act with forces (drives feel them, supports take them out, damping scales them,
joints and the probe come last)."""


def kinds_of(scenes) -> list[type[ElementType]]:
    """Return the element types (subclasses of ElementType) of which at least one of the scenes has
    elements: those in the registry KINDS in its order, then others by module and name."""
    scenes = SceneList(scenes)
    types = {kind for scene in scenes for kind, elements in scene.kinds.items() if elements}
    own_kinds = {kind for scene in scenes for kind in scene.kinds}.difference(KINDS)
    extras = sorted(own_kinds, key=lambda kind: (kind.__module__, kind.__qualname__))
    plain = getattr(ElementType.find, "__func__")  # noqa: B009  # which type checkers do not know
    return [
        kind
        for kind in (*KINDS, *extras)
        if (kind in types if kind.find.__func__ is plain else any(scenes.map(kind.find)))
    ]


def energies_of(kinds) -> list:
    """Return the distinct energies (Energy) in the balance of a run, as its outcome lists them
    between kinetic energy and balance: what element types store, give as work and take out, in this
    order. kinds: element types."""
    energies = [getattr(k, role) for role in ("stores", "gives", "takes") for k in kinds]
    return list(dict.fromkeys(energy for energy in energies if energy))
