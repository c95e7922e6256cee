"""The types of joints: what each keeps together, and which openings (joint coordinates) it leaves.

A joint with several openings is as many hinges (hinge.py), the first of which stands for it; they
are called as the joint with a suffix. An opening is the angle about the joint's axis, which is in
both parts, or how far the second's point is from the first's in a direction fixed to the first: its
axis, its reference x, or y normal to both."""

from typing import NamedTuple

from fpm.elements.joints import joint_arrays as arrays
from fpm.elements.joints.joint_arrays import (
    ACROSS_AXIS,
    ACROSS_X,
    ACROSS_Y,
    CONDITIONS,
    PARALLEL,
    POINT,
    THREAD,
    TWIST,
)


class OpeningType(NamedTuple):
    """An opening of a type of joint. suffix: of its name, behind the joint's; direction: in which
    it is a length, "axis", "x" or "y"; "": it is an angle."""

    suffix: str = ""
    direction: str = ""


class JointType(NamedTuple):
    """Type of joint. bits: sum of what it keeps together, the kernels' constant for it
    (joint_arrays.py); openings: its OpeningTypes; none: users state none on it."""

    bits: int
    openings: tuple[OpeningType, ...] = ()

    @property
    def conditions(self) -> int:
        """Number of scalar constraint equations; 0: of a support, as many as it holds axes."""
        return sum(count for bit, count in CONDITIONS.items() if self.bits & bit)


ANGLE, TURN = OpeningType(), OpeningType("_turn")
IN_PLANE = TURN, OpeningType("_x", "x"), OpeningType("_y", "y")
TYPES = {
    "revolute": JointType(POINT + PARALLEL, (ANGLE,)),
    "spherical": JointType(POINT),
    "fixed": JointType(POINT + PARALLEL + TWIST),
    "universal": JointType(POINT + arrays.CROSS, (OpeningType("_axis"), OpeningType("_other"))),
    "prismatic": JointType(ACROSS_X + ACROSS_Y + PARALLEL + TWIST, (OpeningType("", "axis"),)),
    "cylindrical": JointType(ACROSS_X + ACROSS_Y + PARALLEL, (TURN, OpeningType("_slide", "axis"))),
    "planar": JointType(ACROSS_AXIS + PARALLEL, IN_PLANE),
    "pin with play": JointType(ACROSS_AXIS + PARALLEL, IN_PLANE),
    "pin in slot": JointType(ACROSS_Y + ACROSS_AXIS + PARALLEL, (TURN, OpeningType("_slide", "x"))),
    "screw": JointType(ACROSS_X + ACROSS_Y + PARALLEL + THREAD, (ANGLE,)),
    "held": JointType(arrays.SUPPORT),
    "opening": JointType(arrays.OPENING),
    "slid": JointType(arrays.SLIDE),
}
"""The types of joints, by name: those users state, and three that the program makes."""

SUFFIXES = {
    name: [opening.suffix for opening in type.openings]
    for name, type in TYPES.items()
    if len(type.openings) > 1
}
"""What the names of openings end with, by those types of joints that have several."""
