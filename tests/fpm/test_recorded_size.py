"""What is foretold to be kept of a run is what its arrays hold."""

import pytest

import fpm
from deployable.campaign.config.sections import scene_type
from fpm.reading.variables import VARIABLES, add_probe, count_values
from fpm.solver.pack import pack


def kept(scene: fpm.Scene) -> int:
    """Numbers of a sample that the arrays of a run hold for each instant."""

    def size(instants: int) -> int:
        return sum(part.size for parts in pack([scene], instants).parts()
                   for part in parts if hasattr(part, "size"))  # fmt: skip

    return (size(11) - size(10)) // 8


@pytest.mark.parametrize("variable", VARIABLES)
def test_numbers_are_those_of_the_arrays(variable):
    scene = scene_type("bennett").build(elements=3)
    labels = VARIABLES[variable].labels(scene)
    if not labels:
        pytest.skip("the linkage has none of it")
    asked = [(variable, labels[0])]
    more = kept(add_probe(scene, asked)) - kept(scene)
    assert count_values(scene, asked) == more > 0
