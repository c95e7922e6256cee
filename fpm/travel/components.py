"""The components of what acts along a travel: what drives and what resists, by name and class."""

from collections import Counter
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fpm.assembly.conditions import Places as At
from fpm.elements import (
    Beams,
    Cable,
    Kind,
    Load,
    TableSpring,
    TorqueMotor,
    TorsionSpring,
    kinds_of,
)
from fpm.travel.acting import Acting, acts

STRAIN = "strain of bars"
"""The component that is no element: the elastic strain of bars."""

DRAGS = ("FR", "HY")
"""Classes of what only resists (Kind.resists_as)."""


def parts_of(scene) -> dict[str, str]:
    """The parts of the virtual work in a scene, with their classes (Kind.resists_as)."""
    found = {part.name: part.resists_as for part in components_of(scene)}
    found = {bearing_name(scene, hinge): "FR" for hinge in scene.bearings} | found
    return found | ({STRAIN: "S"} if scene.beams else {})


def springs_of(scene) -> list[str]:
    """The parts that are springs on joints, by tables too."""
    return [
        part.name for part in components_of(scene)
        if isinstance(part.balanced, TorsionSpring | TableSpring) and part.resists_as == "S"
    ]  # fmt: skip


def classes_of_kinds(scene) -> dict[str, str]:
    """The classes that parts have by what they are, whatever a file says; but a table is a spring
    where it says so."""
    own = {bearing_name(scene, hinge): "FR" for hinge in scene.bearings}
    for part in components_of(scene):
        own[part.name] = "FR" if part.less else type(part.balanced).resists_as
        if isinstance(part.balanced, TableSpring) and part.resists_as == "S":
            own[part.name] = "S"
    return own


def reeled(scene) -> list[str]:
    """Parts that follow a curve of time in a way that a travel cannot: cables that are reeled."""
    names = [name for c in scene.cables if c.curve >= 0 and c.reel for name in _of_cable(scene, c)]
    return [name for name in parts_of(scene) if name in names]


def _of_cable(scene, cable: Cable) -> tuple[str, ...]:
    return cable.title(scene), f"friction {cable.title(scene)}"


class Component(NamedTuple):
    """What acts: an element, or the worst of several that stand for it, less another one; drags:
    whether it only resists."""

    name: str
    elements: tuple[Kind, ...]
    resists_as: str
    drags: bool
    less: Kind | None = None

    @property
    def balanced(self) -> Kind:
        """What stands for it in the balance."""
        return self.elements[-1]


class VirtualWork:
    """The forces of a part, and its virtual work."""

    def __init__(self, scene, part: Component):
        self.less, self.drags = part.less is not None, part.drags
        elements = [*part.elements, *([part.less] if self.less else [])]
        self.acting = [Acting(scene, [element]) for element in elements]

    def come(self, places: At, behind: np.ndarray) -> None:
        """Let what only resists come to places along a straight motion `behind` (6n,), so that it
        slips the way that its joint goes there, which may have turned back on the way before."""
        for share in (1.0, 0.5) if self.drags else ():
            for each in self.acting:
                each.forces(places.displace(-share * behind))

    def along(self, places: At, tangent: np.ndarray) -> float:
        """Virtual work: the least of its elements', or the difference to the other one."""
        self._forces = np.array([each.forces(places) for each in self.acting])
        found = self._forces @ tangent
        return float(found[0] - found[1] if self.less else found.min())

    def rubs(self) -> np.ndarray | float:
        """Forces and moments (6n,) as of `along` where it only resists, else 0."""
        if not self.drags:
            return 0.0
        return self._forces[0] - self._forces[1] if self.less else self._forces[0]


def components_of(scene) -> list[Component]:
    """All that acts, named as the action of the structure's file that it is of, with what it is
    where that is of several; else by what it is, and a number where that is said twice."""
    found, count = [], Counter()
    kinds = [k for k in kinds_of([scene]) if k.resists_as and k is not Beams and acts(k)]
    several = Counter(name for (k, _), name in scene.action_names.items() if k in kinds)
    bearings = {bearing_name(scene, hinge) for hinge in scene.bearings}
    for kind in kinds:
        own = kind.resists_as
        for i, (name, element) in enumerate(zip(kind.names(scene), kind.led(scene), strict=True)):
            if (action := scene.action_names.get((kind, i))) and name not in bearings:
                name = f"{action} ({name})" if several[action] > 1 else action
            count[name] += 1
            name = f"{name} #{count[name]}" if count[name] > 1 else name
            is_class = scene.classes.get((kind, i), own)
            found.append(Component(name, _at_any_time(scene, element), is_class, own in DRAGS))
    for cable, smooth in zip(scene.cables, Cable.led(scene), strict=True):
        if cable.rubs:
            found.append(Component(_of_cable(scene, cable)[1], (cable,), "FR", True, smooth))
    return found


def _at_any_time(scene, element: Kind) -> tuple[Kind, ...]:
    """An element; of one that a curve of time scales those with its least and largest value from
    the start on, the stronger one last."""
    if not isinstance(element, Load | TorqueMotor) or element.curve < 0:
        return (element,)
    times, values = scene.curves[element.curve]
    later = [np.interp(0.0, times, values), *np.array(values)[np.array(times) > 0]]
    factors = sorted({float(min(later)), float(max(later))}, key=abs)
    names = ("force", "moment") if isinstance(element, Load) else ("torque",)
    return tuple(
        replace(element, curve=-1, **{name: f * getattr(element, name) for name in names})
        for f in factors
    )


def bearing_name(scene, hinge: int) -> str:
    return f"bearing {scene.hinges[hinge].name}"
