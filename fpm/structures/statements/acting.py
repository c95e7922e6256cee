"""What acts on a joint's opening."""

from dataclasses import dataclass

from fpm.errors import SceneError
from fpm.structures.keys import Number, Reference
from fpm.structures.statement import statement


@dataclass(frozen=True)
class RevoluteJoint(Reference):
    """The name of a revolute joint; its value is the index of the hinge."""

    group: str = "joints"
    allowed = "the name of a revolute joint"

    def value(self, read, build, key):
        hinge = super().value(read, build, key)
        if hinge is None:
            raise SceneError(key, read, self.allowed)
        return hinge


JOINT = RevoluteJoint(about="on which joint it acts")


@statement(
    "actions",
    "torsion spring",
    joint=JOINT,
    stiffness=Number(unit="N m/rad", least=0, about="moment for each radian"),
    rest=Number(0.0, "opening at which it is at rest", unit="rad"),
)
def torsion_spring(build, it):
    """Turns a revolute joint towards an opening."""
    build.scene.add_torsion_spring(it.joint, it.stiffness, it.rest)


@statement(
    "actions",
    "contact",
    joint=JOINT,
    stiffness=Number(unit="N m/rad", least=0, about="moment for each radian below zero"),
)
def contact(build, it):
    """Faces that touch where the opening of a revolute joint is below zero."""
    build.scene.add_contact(it.joint, it.stiffness)
