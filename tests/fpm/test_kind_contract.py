"""What a kind is, it states: a field of a user's kind means nothing by its name."""

import inspect
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from flaps import bare

import fpm
from fpm import declare
from fpm.elements import (
    Damper,
    Joint,
    Latch,
    Motor,
    Release,
)
from fpm.elements.kind import BATCH_ARRAYS, ElementType
from fpm.files.outcome import eventful
from fpm.kernels import hooks
from fpm.reading.responses import parts_on
from fpm.structures.describe import list_actions


@dataclass(frozen=True)
class Door(ElementType):
    """Has a field of every name that the kinds of the program have."""

    hinge: str = "hinge"
    hinges: tuple[str, ...] = ("hinge",)
    tolerance: float = 1.0
    turn: float = 1.0
    watch: float = 1.0
    references: float = 1.0
    label: str = "hinge"

    events = ("opens",)
    acts_as = "other"


@pytest.mark.parametrize(
    "element",
    [
        Latch(0, 1.0, 1.0),
        Latch(0, 1.0),
        Motor(0, 1.0, 0.0, 0.0, 1.0, -1),
        Motor(0, None, 0.0, 0.0, 0.0, -1),
        Release(0, 1.0, 0.0, 0.0, time=1.0),
        Release(0, time=1.0),
    ],
    ids=lambda element: type(element).__name__,
)
def test_what_is_alone_on_its_hinge_may_stand_beside_a_kind_with_its_fields(element):
    scene = bare()
    scene.add(Door(hinge=0))
    scene.add(element)
    assert parts_on(scene, "hinge") == [element.acts_as]
    (text,) = list_actions(scene)
    assert text.startswith(f"{element.noun} hinge (on hinge")
    with pytest.raises(fpm.SceneError, match=r"of a second|no other latch"):
        scene.add(element)


def test_a_joint_is_added_beside_it_and_its_events_are_on_no_hinge():
    scene = bare()
    scene.add(Door())
    more = [int(p) for p in scene.add_particles([(1, 0, 0), (2, 0, 0)], 1.0, 1.0)]
    scene.add_joint("ball", "spherical", more, (1, 0, 0))
    assert [joint.name for joint in Joint.find(scene)] == ["ball"]
    assert eventful(scene) == (("Door 0", ("opens",), "", None),)
    with pytest.raises(fpm.SceneError, match="a name not yet used"):
        scene.add_joint("hinge", "spherical", more, (1, 0, 0))


@pytest.mark.parametrize(
    ("add", "message"),
    [
        (lambda scene: scene.add_load(1, curve=3), "curve of load = 3 .*-1 to -1"),
        (
            lambda scene: scene.add_load(1, force=(0, np.nan, 0)),
            r"force of load .*3 finite",
        ),
        (lambda scene: scene.drive(9), "particle of drive = 9 .*0 to 1"),
        (lambda scene: scene.drive(1, curve=0), "curve of drive = 0"),
        (lambda scene: scene.add_torsion_spring(0, 1.0, np.inf), "rest of torsion spring hinge"),
        (lambda scene: scene.add(Damper(0.0, 1.0)), "hinge of damper = 0.0"),
    ],
)
def test_what_fields_say_is_checked(add, message):
    with pytest.raises(fpm.SceneError, match=message):
        add(bare())


def test_the_page_names_all_that_a_kind_may_state():
    page = (Path(fpm.__file__).parents[1] / "docs" / "mechanics.md").read_text()
    section = page.partition("## Add a kind")[2]
    own = {name for name in vars(ElementType) if not name.startswith("_")}
    makes = {
        name
        for name, made in inspect.getmembers(declare, inspect.isfunction)
        if name[0] != "_" and "_field(" in inspect.getsource(made)
    }
    assert makes >= {"number", "word", "index", "topology"}
    for name in (*own, *makes, *BATCH_ARRAYS, *hooks.NAMES):
        assert f"`{name}`" in section or f"`{name}(" in section, name
