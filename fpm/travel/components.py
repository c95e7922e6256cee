"""Components of the virtual work over a travel, by name and class: what drives, what resists."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from fpm.assembly.conditions import ParticlePoses
from fpm.assembly.element_forces import ElementForces, acts
from fpm.elements import (
    Cable,
    ElementType,
    Gravity,
    Load,
    TableSpring,
    TorqueMotor,
    TorsionSpring,
    kinds_of,
)

STRAIN = "strain of bars"
"""The component that is not an element: the elastic strain of bars."""

DRAGS = ("FR", "HY")
"""Classes of what only resists (ElementType.resists_as)."""


def component_classes(scene) -> dict[str, str]:
    """Return the components of a scene's virtual work by name, each with its class
    (`fpm.reading.standards`), as "S": the one that the file states, else its type's."""
    classes = {part.name: part.resists_as for part in components_of(scene)}
    classes = {bearing_name(scene, hinge): "FR" for hinge in scene.bearings} | classes
    return classes | ({STRAIN: "S"} if scene.beams else {})


def springs_of(scene) -> list[str]:
    """Return names of a scene's components of virtual work that are joint springs (class "S")."""
    springs = [part for part in components_of(scene) if part.resists_as == "S"]
    return [p.name for p in springs if isinstance(p.element, TorsionSpring | TableSpring)]


def classes_of_kinds(scene) -> dict[str, str]:
    """Return the class of each component of a scene's virtual work, by name: its type's, whatever
    the file states, but "S" for a tabulated spring that is so there."""
    classes = {bearing_name(scene, hinge): "FR" for hinge in scene.bearings}
    for part in components_of(scene):
        classes[part.name] = "FR" if part.baseline else type(part.element).resists_as
        if isinstance(part.element, TableSpring) and part.resists_as == "S":
            classes[part.name] = "S"
    return classes


def find_reels(scene) -> list[str]:
    """Return the names of components of a scene that no slow motion of an opening can follow, as
    they depend on time: cables that a curve of time reels in or out, and their friction."""
    names = [name for c in scene.cables if c.curve >= 0 and c.reel for name in _of_cable(scene, c)]
    return [name for name in component_classes(scene) if name in names]


def _of_cable(scene, cable: Cable) -> tuple[str, ...]:
    return cable.title(scene), f"friction {cable.title(scene)}"


_SCALED_BY_CURVES = {Load: ("force", "moment"), TorqueMotor: ("torque",)}
_SCALED_BY_CURVES |= {Gravity: ("acceleration",)}


class Component(NamedTuple):
    """A contribution to the virtual work while a joint coordinate is moved slowly (a travel). name:
    its name; elements: the one that does the work, or several (at smallest and largest load), of
    whose works the least is taken; resists_as: its class in standards, as "S" for springs; drags:
    whether it can only resist, as friction; baseline: element whose work is subtracted, or None."""

    name: str
    elements: tuple[ElementType, ...]
    resists_as: str
    drags: bool
    baseline: ElementType | None = None

    @property
    def element(self) -> ElementType:
        """The last of `elements`, which stands for the component when equilibrium is solved: its
        only one, or, where a curve of time scales its load, the one at the largest load."""
        return self.elements[-1]


class VirtualWork:
    """Forces of one component of a scene, and their virtual work, at given poses (positions and
    frames of all n particles). scene: the scene; part: the component."""

    def __init__(self, scene, part: Component):
        self._part = part
        elements = part.elements if part.baseline is None else (*part.elements, part.baseline)
        self.sources = [ElementForces(scene, [element]) for element in elements]

    def compute(
        self, poses: ParticlePoses, tangent: np.ndarray, path: Sequence[ParticlePoses] = ()
    ) -> tuple[float, np.ndarray | float]:
        """Return the virtual work (N m, on slides N) at `poses` per unit of the opening, above 0
        where it drives; of several elements the least, with a baseline the difference. With it, if
        the component only resists, as friction does, the forces and moments (6n,), N and N m, on
        all n particles; else 0. tangent (6n,): motion by that unit; path: poses along which what
        only resists is moved there first, to bring it to steady slip."""
        for place in path if self._part.drags else ():
            for source in self.sources:
                source.forces(place)
        forces = np.array([source.forces(poses) for source in self.sources])
        works = forces @ tangent
        if self._part.baseline is None:
            work, force = works.min(), forces[0]
        else:
            work, force = works[0] - works[1], forces[0] - forces[1]
        return float(work), force if self._part.drags else 0.0


def components_of(scene) -> list[Component]:
    """Return the components of the virtual work in a scene: all elements whose type has a class in
    margin standards, and the friction of cables. Each is named as its action in the structure's
    file, and by its element too where an action has several; else by its element, with a number."""
    components: list[Component] = []
    count: Counter[str] = Counter()
    kinds = [k for k in kinds_of([scene]) if k.resists_as and acts(k)]
    action_counts = Counter(name for (k, _), name in scene.action_names.items() if k in kinds)
    bearings = {bearing_name(scene, hinge) for hinge in scene.bearings}
    for kind in kinds:
        pairs = zip(kind.names(scene), kind.sweep_elements(scene), strict=True)
        for i, (name, element) in enumerate(pairs):
            if (action := scene.action_names.get((kind, i))) and name not in bearings:
                name = f"{action} ({name})" if action_counts[action] > 1 else action
            count[name] += 1
            name = f"{name} #{count[name]}" if count[name] > 1 else name
            class_ = scene.classes.get((kind, i), kind.resists_as)
            cases, drags = _load_cases_of(scene, element), kind.resists_as in DRAGS
            components.append(Component(name, cases, class_, drags))
    for cable, smooth in zip(scene.cables, Cable.sweep_elements(scene), strict=True):
        if cable.has_friction:
            components.append(Component(_of_cable(scene, cable)[1], (cable,), "FR", True, smooth))
    return components


def _load_cases_of(scene, element: Any) -> tuple[ElementType, ...]:
    """Return the element at its least and largest load from the start on, if a curve of time scales
    it, the stronger one last; else the element alone."""
    names = _SCALED_BY_CURVES.get(type(element), ())
    if not names or element.curve < 0:
        return (element,)
    factors = sorted({*scene.curve(element.curve).extremes(0.0)}, key=abs)
    return tuple(
        replace(element, curve=-1, **{name: f * getattr(element, name) for name in names})
        for f in factors
    )


def bearing_name(scene, hinge: int) -> str:
    """Return the name of the component of friction in a bearing. hinge: the hinge's index."""
    return f"bearing {scene.hinges[hinge].name}"
