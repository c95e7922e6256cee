"""Viscous dampers on hinges: moment -c dpsi/dt on the hinge's second particle.

The rate is extrapolated from the last two steps, to second order in the step h. Leapfrog with
damper c and spring k on inertia J is stable where h² k/J + 4 h c/J <= 4 (timestep.py)."""

from dataclasses import dataclass

from fpm.declare import damping
from fpm.elements.openings.opening import JOINT_LOSS, Connector, on_hinge


@dataclass(frozen=True)
class Damper(Connector):
    """A damper, which resists the motion of a joint in proportion to its rate."""

    hinge: int = on_hinge()
    damping: float = damping(text="moment per radian per second")

    takes = JOINT_LOSS
    acts_as = "damper"
    noun = "damper"
    resists_as = ""
    cost = 70.0
