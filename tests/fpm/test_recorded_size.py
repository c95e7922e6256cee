"""What is foretold to be kept of a run is what its arrays hold."""

import pytest

import fpm
from deployable.campaign.config.scenes import scene_type
from fpm.reading.columns import SOURCES
from fpm.reading.recording import labels, numbers, prepared
from fpm.solver.pack import pack


def kept(scene: fpm.Scene) -> int:
    """Numbers of a sample that the arrays of a run hold for each instant."""

    def size(instants: int) -> int:
        return sum(part.size for parts in pack([scene], 1, float, instants).parts()
                   for part in parts if hasattr(part, "size"))  # fmt: skip

    return size(11) - size(10)


def column(scene, variable):
    """A column of a variable that a scene has."""
    label = labels(scene, variable)[0]
    return variable, label.replace(" at ", " at 0.5 ")


@pytest.mark.parametrize("variable", SOURCES)
def test_numbers_are_those_of_the_arrays(variable):
    scene = scene_type("bennett").build(elements=3)
    if not labels(scene, variable):
        pytest.skip("the linkage has none of it")
    asked = [column(scene, variable)]
    more = kept(prepared(scene, asked)) - kept(scene)
    assert numbers(scene, asked) == more > 0
