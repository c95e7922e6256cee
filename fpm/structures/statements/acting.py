"""What acts on a joint's opening."""

from fpm.structures.keys import Number, Reference
from fpm.structures.statement import Statement

JOINT = Reference(group="joints", about="on which joint it acts")


class TorsionSpring(Statement):
    """Turns a revolute joint towards an opening."""

    group, type = "actions", "torsion spring"
    keys = {
        "joint": JOINT,
        "stiffness": Number(unit="N m/rad", least=0, about="moment for each radian"),
        "rest": Number(0.0, "opening at which it is at rest", unit="rad"),
    }

    @staticmethod
    def build(build, it):
        build.scene.add_torsion_spring(it.joint, it.stiffness, it.rest)


class Contact(Statement):
    """Faces that touch where the opening of a revolute joint is below zero."""

    group, type = "actions", "contact"
    keys = {
        "joint": JOINT,
        "stiffness": Number(unit="N m/rad", least=0, about="moment for each radian below zero"),
    }

    @staticmethod
    def build(build, it):
        build.scene.add_contact(it.joint, it.stiffness)
