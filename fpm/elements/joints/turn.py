"""Openings that are held exactly: one more condition, of a joint of its own beside the hinge.

Theory: docs/mechanics.md, "Openings that are held exactly". While it holds, psi = target is a row
of the joints solved together (joint.py); while it does not, the row is empty. Which it is is
decided in the step, when all forces are known (kernels/run.py): the joints are solved without it,
the kinds that hold are told the rate that the opening would have (`decide`), and where that changes
something, all joints are solved again."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fpm.declare import specs
from fpm.elements.joints.joint_arrays import TURN, Turns
from fpm.elements.kind import ElementType
from fpm.elements.openings.opening import Connector, Opening, relative_turn
from fpm.errors import SceneError


@dataclass(frozen=True)
class Turn(ElementType):
    """Condition by which a joint coordinate (angle of a hinge, length of a slide) is held exactly;
    there is one for every element that does so (ExactConnector), and none is stated by itself."""

    cost = 200.0

    @classmethod
    def find(cls, scene):
        """Return the elements (ExactConnector) of all types in a scene that hold a joint coordinate
        exactly. Their indices are those of the conditions in Turns.state."""
        kinds = [kind for kind in scene.kinds if issubclass(kind, ExactConnector)]
        return [element for kind in kinds for element in scene.kinds[kind] if element.is_exact]

    @classmethod
    def topology_of(cls, scene):
        return tuple((type(holder), holder.hinge) for holder in cls.find(scene))

    @classmethod
    def pack(cls, batch):
        def starts(scene):
            angles = [holder.held_at_start(scene) for holder in cls.find(scene)]
            return [
                [1.0 if opening is None else -1.0, opening or 0.0, *[0.0] * (TURN - 2)]
                for opening in angles
            ]

        state = batch.stack(len(cls.find(batch.scene)), TURN, starts)
        hinge = batch.integers(holder.hinge for holder in cls.find(batch.scene))
        return Turns(state, batch.blank(1, 1), hinge, batch.part(Opening).angles)


class ExactConnector(Connector):
    """Base class of motors, releases, latches and friction: those without `stiffness` hold a joint
    coordinate (angle of a hinge, length of a slide) exactly; `hinge` is its index."""

    resists_as: ClassVar = ""
    stiffness: Any

    @property
    def is_exact(self) -> bool:
        """Whether the element holds the joint coordinate exactly, without a spring."""
        return self.stiffness is None

    def held_at_start(self, scene) -> float | None:
        """Return the joint coordinate (rad; m on a slide) at which the element holds its hinge from
        the start of a scene's run on; None, the default: the hinge is free then."""
        return None

    def rate_at_start(self, scene) -> float | None:
        """Return the rate (rad/s; m/s on a slide) that the element imposes on the joint coordinate
        at the start of a scene's run; None, the default: it imposes none."""
        return None

    def check(self, scene):
        super().check(scene)
        for name in ("damping", "backlash", "holds") if self.is_exact else ():
            value = getattr(self, name, None)
            if value and value != specs(type(self))[name].default:
                allowed = "none without a `stiffness`"
                raise SceneError(f"{name} of {self.title(scene)}", value, allowed)

    @classmethod
    def _turns(cls, scene, values):
        springs = {i: e for i, e in enumerate(cls.find(scene)) if not e.is_exact}
        if not springs:
            return None
        hinges = [e.hinge for e in springs.values()]
        rows = relative_turn(scene, hinges, [values[i] for i in springs])
        return rows._replace(element=np.array([*springs])[rows.element])

    @classmethod
    def reads_in(cls, scene):
        return (Opening, Turn) if any(e.is_exact for e in cls.find(scene)) else cls.reads

    @classmethod
    def array(cls, name, batch):
        match name:
            case "turns":
                return batch.part(Turn)
            case "turn":
                places = {id(holder): i for i, holder in enumerate(Turn.find(batch.scene))}
                return batch.integers(places.get(id(e), -1) for e in cls.find(batch.scene))
        return super().array(name, batch)
