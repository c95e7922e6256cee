"""A function of scenes is called again only where they differ in what it reads."""

import numpy as np
import pytest

from fpm import Scene
from fpm.elements import Hinge, TorsionSpring
from fpm.elements.reads import SceneList


def scene_of(stiffness=(1.0, 2.0), mass=1.0):
    scene = Scene("s")
    scene.add_particles([[0.0, 0, 0], [1.0, 0, 0]], mass, 1.0)
    scene.kinds[TorsionSpring] = [TorsionSpring(0, k, 0.0) for k in stiffness]
    return scene


def calls_of(function, scenes):
    """The values of a function, and of how many scenes it was called."""
    calls = []

    def counted(scene):
        calls.append(scene)
        return function(scene)

    return list(SceneList(scenes).map(counted)), len(calls)


FUNCTIONS = {
    "array": lambda s: s.position.sum(),
    "mass": lambda s: s.mass.sum(),
    "elements": lambda s: [e.stiffness for e in s.kinds.get(TorsionSpring, [])],
    "property": lambda s: [e.stiffness for e in s.springs],
    "items": lambda s: [(kind.__name__, len(elements)) for kind, elements in s.kinds.items()],
    "types": lambda s: [kind.__name__ for kind in s.kinds],
    "absent": lambda s: len(s.kinds.get(Hinge, [])),
    "method": lambda s: s.arm_to(1).arm.tolist(),
}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("change", ["nothing", "spring", "mass", "sign", "hinges"])
def test_values_are_those_of_each_scene(name, change):
    first, second, third = scene_of(), scene_of(), scene_of()
    for scene in (second, third):
        scene.kinds = {kind: list(elements) for kind, elements in first.kinds.items()}
    if change == "spring":
        second.kinds[TorsionSpring][1] = TorsionSpring(0, 3.0, 0.0)
    if change == "mass":
        second.mass = first.mass * 2
    if change == "sign":
        second.position = first.position * np.array([1.0, -1.0, 1.0])
    if change == "hinges":
        second.kinds[Hinge] = [object()]
    scenes, function = [first, second, third], FUNCTIONS[name]
    values, count = calls_of(function, scenes)
    assert values == [function(scene) for scene in scenes]
    reads = {
        "spring": {"elements", "property", "items"},
        "mass": {"mass"},
        "sign": {"array", "method"},
        "hinges": {"types", "absent", "items"},
        "nothing": set(),
    }
    # Once a scene differs, it is called for each.
    assert count == (3 if name in reads[change] else 1)


def test_one_scene_is_given_as_it_is():
    scene = scene_of()
    assert list(SceneList([scene]).map(lambda s: s)) == [scene]
