"""Openings of slides and universal joints: what is refused, stable steps, lanes, files."""

import numpy as np
import pytest

import fpm
from evidence.extremes.stable_step import slides
from evidence.verification.slides import scene_of_all
from fpm.assembly import assemble
from fpm.elements import Contact, Damper, Friction, Latch, Stop, SyncLoop
from fpm.files import trajectory
from fpm.reading import responses
from fpm.scenes.timestep import find_stable_step

X, Y = np.eye(3)[:2]
J = (0.02, 0.03, 0.05)


def bodies(*masses, held=True) -> fpm.Scene:
    scene = fpm.Scene("bodies")
    places = [(0.3 * k, 0.1 * k, 0.0) for k in range(len(masses))]
    scene.add_particles(places, masses, J)
    if held:
        scene.fix(0)
    return scene


def test_openings_at_the_start_are_those_that_are_stated():
    scene = bodies(1.0, 2.0, 1.0)
    assert scene.add_slide("boom", (0, 1), (0.1, 0.0, 0.0), X, -0.07) == 0
    assert scene.add_universal("cross", (1, 2), (0.5, 0.0, 0.0), X, Y, (0.4, -2.0)) == 1
    scene.frame[2] = scene.frame[2].copy()
    assert [hinge.name for hinge in scene.hinges] == ["boom", "cross_axis", "cross_other"]
    from fpm.elements.openings.opening import opening_at

    found = [opening_at(scene, hinge) for hinge in scene.hinges]
    assert found == pytest.approx([-0.07, 0.4, -2.0], abs=1e-12)


def test_no_two_joints_have_one_name_in_whichever_way_they_are_stated():
    """A force asked of a joint by its name would else be another's."""
    point = (0.1, 0.0, 0.0)
    stated = {
        "slide": lambda scene: scene.add_slide("J", (0, 1), point, X),
        "universal": lambda scene: scene.add_universal("J", (0, 1), point, X, Y),
        "spherical": lambda scene: scene.add_joint("J", "spherical", (0, 1), point),
    }
    for first in stated.values():
        for second in stated.values():
            scene = fpm.Scene("twice")
            scene.add_particles([(0.0, 0.0, 0.0), (0.2, 0.0, 0.0)], 1.0, (1.0, 1.0, 1.0))
            first(scene)
            with pytest.raises(fpm.SceneError, match="not yet used"):
                second(scene)


def test_assembly_closes_a_slide_across_its_axis_and_tells_where_it_is():
    for hold, opening in (((), 0.12), (("boom",), 0.1)):
        scene = bodies(1.0, 2.0)
        scene.add_slide("boom", (0, 1), [(0.1, 0.0, 0.0), (0.12, 0.03, 0.0)], X, 0.1)
        assemble(scene, hold)
        assert scene.hinges[0].opening == pytest.approx(opening, abs=1e-9)
        assert scene.position[1] == pytest.approx((0.3 + opening - 0.12, 0.07, 0.0), abs=1e-9)


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        (lambda s: Contact(s, 1.0), "one that is revolute"),
        (lambda s: Friction(s, 1.0, None, angles=(0.0,), shares=(1.0,)), "a bristle"),
        (lambda s: SyncLoop("belt", (s, s + 1), (1.0, 1.0), 1.0), "an angle"),
        (lambda s: Damper(s, -1.0), r"N s/m"),
        (lambda s: Latch(s, np.nan, 1.0), r"\(m\)"),
        (lambda s: Latch(s, 0.0, -1.0), r"N/m"),
        (lambda s: Latch(s, 0.0, 1.0, max_capture_rate=0.0), r"m/s"),
        (lambda s: Stop(s, np.inf, "above", 1.0), r"\(m\)"),
        (lambda s: Friction(s, -1.0), r"\(N\)"),
        (lambda s: Friction(s, 1.0, 0.0), r"\(m\)"),
    ],
)
def test_what_cannot_act_on_a_slide_is_refused_in_its_units(kind, said):
    scene = bodies(1.0, 2.0, 1.0)
    slide = scene.add_slide("boom", (0, 1), (0.1, 0.0, 0.0), X)
    scene.add_hinge("hinge", (1, 2), (0.5, 0.0, 0.0), X)
    with pytest.raises(fpm.SceneError, match=said):
        scene.add(kind(slide))


def test_the_stable_step_of_a_cross_holds_wherever_it_turns():
    """A spring about the axis on the first part turns the second about its softest direction."""
    for angle in (0.0, 0.7, np.pi / 2):
        scene = bodies(1.0, 2.0)
        turned = [[np.cos(angle), 0, np.sin(angle)], Y, [-np.sin(angle), 0, np.cos(angle)]]
        scene.frame[1] = np.array(turned).T
        cross = scene.add_universal("cross", (0, 1), scene.position[1], X, Y, (0.0, angle))
        scene.add_torsion_spring(cross, 8.0)
        assert find_stable_step(scene).frequency == pytest.approx(np.sqrt(8.0 / J[0]), rel=1e-9)


@pytest.mark.slow
def test_files_have_what_slides_and_their_latches_did(tmp_path):
    (outcome,) = fpm.simulate(scene_of_all(), duration=0.8, instants=401, step=2e-4)
    data = outcome.dataset()
    assert data["slide_opening"].attrs["units"] == "m"
    assert data["opening"].attrs["units"] == "rad"
    assert data["slide_latch_impulse"].attrs["units"] == "N s"
    assert data["slide_motor_force"].sel(slide_motor="driven").attrs["units"] == "N"
    trajectory.write(trajectory.contents([outcome]), tmp_path / "run.nc")
    curves = trajectory.read_curves(tmp_path / "run.nc")["0"]
    assert curves.columns.keys() == outcome.columns.keys()
    for column, values in outcome.columns.items():
        assert np.array_equal(curves.columns[column], values)
    asked = {
        "caught": ({"latch_impact": "caught"}, "N s", 2 / 3),
        "signed": ({"latch_impact": "caught", "component": "signed"}, "N s", -2 / 3),
        "crossed": ({"latch_impact": "crossed_other"}, "N m s", 0.06),
        "rate": ({"latch_rate": "latched"}, "m s-1", 1.0),
    }
    for name, (definition, unit, value) in asked.items():
        found = responses.parse(name, definition, outcome.scene)
        assert found.unit == unit
        assert found.evaluate(curves)[-1] == pytest.approx(value, rel=1e-5)
    with pytest.raises(fpm.SceneError, match="one of caught, crossed_other"):
        responses.parse("impact", {"latch_impact": "latched"}, outcome.scene)


@pytest.mark.parametrize(("number", "limit"), [(0, 1.034372e-4), (1, 1.075014e-4)])
def test_the_stable_step_is_the_one_beyond_which_elastic_bars_break_down(number, limit):
    """Beside what bisection of runs has found (the study of extremes)."""
    name, scene, _ = list(slides(fast=True))[number]
    assert find_stable_step(scene).step == pytest.approx(limit, rel=0.02), name
    assert find_stable_step(scene).step < 1.0005 * limit, name
