"""What a scene is made of: one kind of element per definition file, with its kernels beside it."""

from deployable.fpm.kinds.beam import Beams
from deployable.fpm.kinds.cable import Cable
from deployable.fpm.kinds.contact import Contact
from deployable.fpm.kinds.damper import Damper
from deployable.fpm.kinds.damping import Damping
from deployable.fpm.kinds.drive import Drive
from deployable.fpm.kinds.friction import Friction
from deployable.fpm.kinds.gravity import Gravity
from deployable.fpm.kinds.hinge import Hinge
from deployable.fpm.kinds.joint import Joint
from deployable.fpm.kinds.kind import Kind
from deployable.fpm.kinds.latch import Latch
from deployable.fpm.kinds.load import Load
from deployable.fpm.kinds.motor import Motor, TorqueMotor
from deployable.fpm.kinds.opening import Opening
from deployable.fpm.kinds.probe import Probe
from deployable.fpm.kinds.release import Release
from deployable.fpm.kinds.rigid_friction import RigidFriction
from deployable.fpm.kinds.rigid_latch import RigidLatch
from deployable.fpm.kinds.rigid_motor import RigidMotor
from deployable.fpm.kinds.rigid_release import RigidRelease
from deployable.fpm.kinds.stop import Stop
from deployable.fpm.kinds.support import Support
from deployable.fpm.kinds.sync_loop import SyncLoop
from deployable.fpm.kinds.table_spring import TableSpring
from deployable.fpm.kinds.torsion_spring import TorsionSpring
from deployable.fpm.kinds.turn import Turn

KINDS: tuple[type[Kind], ...] = (
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
    RigidMotor,
    RigidRelease,
    RigidLatch,
    RigidFriction,
    Drive,
    Support,
    Damping,
    Joint,
    Probe,
)
"""The registry. The order is that of sums, hence of the last digits: add new kinds at the end,
before Drive if they act with forces (drives feel them, supports take them out, damping scales
them, joints and the probe come last).
"""


def kinds_of(scenes) -> list[type[Kind]]:
    """The kinds that some of the scenes have, in the order of the registry; others follow."""
    stated = {kind for scene in scenes for kind in scene.kinds}
    own = sorted(stated.difference(KINDS), key=lambda kind: (kind.__module__, kind.__qualname__))
    return [kind for kind in (*KINDS, *own) if any(kind.of(scene) for scene in scenes)]


def energies_of(kinds) -> list:
    """The energies in the balance of a scene with these kinds, in order, besides kinetic energy and
    the balance: what is stored, given and taken. Those of the registry are always there.
    """
    kinds = [*KINDS, *(kind for kind in kinds if kind not in KINDS)]
    found = [getattr(k, role) for role in ("stores", "gives", "takes") for k in kinds]
    return list(dict.fromkeys(energy for energy in found if energy))
