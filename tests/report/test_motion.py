"""The whole motion is the trajectory's, and its strains are those of beam theory."""

from pathlib import Path

import numpy as np
import pytest
import xarray
from scipy.spatial.transform import Rotation

import fpm
from deployable.campaign.config.sections import scene_type
from fpm.solver import motion as whole
from fpm.solver.motion import shapes_of
from fpm.structures import load

TIME = {"duration": 0.02, "instants": 41}


def scenes(count=2):
    build = scene_type("bennett").build
    return [build(a=0.035 * (1 + 0.01 * i), elements=3, start=1.0) for i in range(count)]


def steps(scene):
    return fpm.divide_time(**TIME, max_step=0.9 * fpm.find_stable_step(scene).step).step


@pytest.fixture(scope="module")
def pair():
    """Motions of two linkages side by side, and their trajectories made alone."""
    two = scenes()
    step = steps(two[0])
    motions = whole.whole_motion(two, **TIME, step=step, frames=11, times=[0.0071])
    return motions, [fpm.simulate(scene, **TIME, step=step)[0] for scene in two]


def test_named_points_are_the_trajectorys_bit_for_bit(pair):
    for motion, outcome in zip(*pair, strict=True):
        kept = np.searchsorted(outcome.time, motion["time"].values)
        np.testing.assert_array_equal(motion["time"].values, outcome.time[kept])
        for i, name in enumerate(motion["point"].values):
            expected = outcome.points[str(name)][0][kept]
            assert np.array_equal(motion["point_position"].values[:, i], expected)
            on, arm = int(motion["point_particle"][i]), motion["point_arm"].values[i]
            carried = motion["position"].values[:, on] + motion["frame"].values[:, on] @ arm
            np.testing.assert_allclose(carried, expected, rtol=0, atol=1e-14)
        assert np.array_equal(motion["contact_event_time"].values, outcome.events[:, 0])
        np.testing.assert_allclose(
            motion["position"].values[-1], outcome.final.position, rtol=0, atol=0
        )


def test_frames_are_those_asked_for(pair):
    time = pair[0][0]["time"].values
    even = np.linspace(0, TIME["duration"], 11)
    assert set(np.round(even, 12)) < set(np.round(time, 12))
    assert len(time) == 12 and np.abs(time - 0.0071).min() <= 0.25e-3 + 1e-12


def test_frames_of_particles_are_rotations(pair):
    frame = pair[0][1]["frame"].values
    product = np.einsum("tpij,tpik->tpjk", frame, frame)
    np.testing.assert_allclose(product, np.broadcast_to(np.eye(3), product.shape), atol=1e-9)
    np.testing.assert_allclose(np.linalg.det(frame), 1.0, atol=1e-9)


def test_several_passes_give_the_same(monkeypatch, pair):
    two = scenes()
    monkeypatch.setattr(whole, "MAX_RECORDS", 41 * 8 * 18 * 6)
    again = whole.whole_motion(two, **TIME, step=steps(two[0]), frames=11, times=[0.0071])
    for one, other in zip(pair[0], again, strict=True):
        xarray.testing.assert_identical(one, other)


def test_a_failing_run_raises_its_failure():
    scene = scenes(1)[0]
    with pytest.raises(fpm.InstabilityError):
        whole.whole_motion([scene], duration=0.02, instants=3, step=40 * steps(scene))


def test_the_dataset_says_what_it_holds(pair):
    motion = pair[0][0]
    assert motion.attrs["Conventions"].startswith("CF-1.")
    assert motion["time"].attrs["standard_name"] == "time"
    for name, variable in motion.data_vars.items():
        assert variable.attrs["long_name"] and variable.attrs["units"], name
    assert str(motion["element"].values[4]) == "BC[1]"
    shut = motion["contact_event_contact"].values
    assert set(motion["contact"].values[shut]) <= set("ABCD")


@pytest.mark.slow
def test_rigid_bodies_without_any_bar_move_too_as_boxes_of_their_inertia():
    """A solar array on a free hub: its centre of mass stays where it is."""
    scene = load(Path(__file__).parents[2] / "config/structures/solar_array.yaml").build()
    (motion,) = whole.whole_motion([scene], duration=1.0, instants=3, step=0.002)
    place, mass = motion["position"].values, scene.mass[:, None]
    assert np.abs(place[-1] - place[0]).max() > 0.01
    np.testing.assert_allclose((mass * (place - place[0])).sum(axis=1) / mass.sum(), 0, atol=1e-9)
    assert motion["element"].values.tolist()[:2] == ["body 0", "body 1"]
    assert motion.sizes["element"] == motion.sizes["particle"]
    assert not motion["stress"].values.any()


def test_a_rigid_body_is_the_box_of_its_mass_and_inertia():
    edges, mass = np.array([0.3, 0.2, 0.1]), 2.0
    squares = edges**2
    scene = fpm.Scene("hub")
    scene.add_particles((1.0, 0, 0), mass, mass / 12 * (squares.sum() - squares))
    ground = scene.add_particles((0, 0, 0), 1.0, 1.0)
    scene.fix(ground)
    shapes = shapes_of(scene, whole.section_corners(scene))
    assert shapes.names == ["body 0"]
    corners = shapes.corners[0].reshape(8, 3)
    np.testing.assert_allclose(np.abs(corners), np.tile(edges / 2, (8, 1)))
    assert len(np.unique(np.sign(corners), axis=0)) == 8
    np.testing.assert_allclose([*shapes.length, *2 * shapes.half[0]], edges)


@pytest.mark.slow
def test_a_cantilevers_bending_stress_is_that_of_the_closed_form():
    """Of 4 elements along x, damped so that it comes to rest under a load at its tip."""
    scene, load = fpm.Scene("cantilever", damping=100.0), 2.0
    section, material = fpm.Section.rectangle(0.06, 0.04), fpm.Material(1e9, 0.3, 1000.0)
    link = scene.add_link((0, 0, 0), (1, 0, 0), (0, 0, 1), section, material, 4, "bar")
    scene.fix(link.particles[0])
    scene.add_curve([0.0, 0.2], [0.0, 1.0])
    scene.add_load(link.particles[-1], force=np.array([0, 0, load]), curve=0)
    step = fpm.divide_time(0.6, 13, 0.9 * fpm.find_stable_step(scene).step).step
    (motion,) = whole.whole_motion([scene], duration=0.6, instants=13, step=step)
    rest, end = motion.isel(time=-1), load * 1.0 * 0.02 / section.Iy  # P L (h/2) / I
    assert rest["stress"].values[0] == pytest.approx(end, rel=2e-3)
    np.testing.assert_allclose(rest["stress"].values / end, [1.0, 0.75, 0.5, 0.25], rtol=3e-3)
    assert rest["bending_strain"].values[0] == pytest.approx(end / material.E, rel=2e-3)
    assert rest["largest_stress"].values[0] >= rest["stress"].values[0]


def test_a_rigid_motion_strains_nothing_and_a_longer_one_by_its_share():
    scene = scenes(1)[0]
    turn = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix()
    position = (scene.position @ turn.T + [3.0, -2.0, 1.0])[None]
    axial, bending = whole.element_strains(scene, position, (turn @ scene.frame)[None])
    assert np.abs(axial).max() < 1e-13 and bending.max() < 1e-12
    axial, bending = whole.element_strains(scene, 1.002 * position, (turn @ scene.frame)[None])
    np.testing.assert_allclose(axial, 0.002, rtol=1e-9)


@pytest.mark.parametrize("axis", [(0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.6, 0.8)])
def test_an_element_whose_ends_turn_apart_bends_about_that_axis(axis):
    """By ±0.01 rad, 0.5 m apart: a curvature of 0.04 /m, times half the width or the height."""
    scene = fpm.Scene("bar")
    scene.add_link(
        (0, 0, 0), (0.5, 0, 0), (0, 0, 1), fpm.Section.rectangle(0.06, 0.04),
        fpm.Material(1e9, 0.3, 1000.0), 1, "bar",
    )  # fmt: skip
    turned = Rotation.from_rotvec(np.multiply.outer([-0.01, 0.01], axis)).as_matrix()
    frame = (turned @ scene.frame)[None]
    axial, bending = whole.element_strains(scene, scene.position[None], frame)
    assert abs(axial).max() < 1e-12
    # about y it bends over the height (z, 0.04), about z over the width (y, 0.06)
    expected = 0.04 * (0.02 * axis[1] + 0.03 * axis[2])
    assert bending[0, 0] == pytest.approx(expected, rel=1e-3)
